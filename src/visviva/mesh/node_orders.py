"""Orders in which files have the nodes of a cell, where these are others than VTK's, which meshio takes them for."""

from __future__ import annotations

import numpy as np

from visviva.mesh.cells import CELLS, Array, Ints

EXODUS_ENDINGS = (".e", ".ex2", ".exo")
HEX20 = (*range(12), 16, 17, 18, 19, 12, 13, 14, 15)
EXODUS = {"hex20": HEX20, "hex27": (*HEX20, 23, 24, 25, 26, 21, 22, 20)}
MED = {
    "tet4": (0, 2, 1, 3),
    "tet10": (0, 2, 1, 3, 6, 5, 4, 7, 9, 8),
    "wedge6": (0, 2, 1, 3, 5, 4),
    "hex8": (0, 3, 2, 1, 4, 7, 6, 5),
    "hex20": (0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17),
}
ORDERS = {**dict.fromkeys(EXODUS_ENDINGS, EXODUS), ".med": MED}
"""By endings of files: which of the file's nodes each node of a cell is."""


def read_order(ending: str, kind: str, rows: Ints, points: Array) -> Ints:
    """Cells (m, k) of a file, their nodes in order; those of MED that meshio has written are so already."""
    order = ORDERS.get(ending, {}).get(kind)
    if order is None or (ending == ".med" and is_right_handed(kind, rows, points)):
        return rows
    return rows[:, order]


def written_order(ending: str, kind: str, rows: Ints) -> Ints:
    """Cells (m, k) with their nodes as the file wants them."""
    order = ORDERS.get(ending, {}).get(kind)
    return rows if order is None else rows[:, np.argsort(order)]


def is_right_handed(kind: str, rows: Ints, points: Array) -> bool:
    """Whether most cells are not inside out, by the middle of their first face and that of all nodes."""
    face = CELLS[kind].faces[0].nodes[:3]
    a, b, c = (points[rows[:, k]] for k in face)
    inward = points[rows].mean(axis=1) - a
    return bool(np.median(np.einsum("ij,ij->i", np.cross(b - a, c - a), inward)) < 0)
