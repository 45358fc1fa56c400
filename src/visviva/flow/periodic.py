"""Periodic fluids: nodes of opposite faces share their unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from visviva.errors import InputError
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def partners(mesh: Mesh, first: str, second: str, label: str) -> Ints:
    """Pairs (n, 2) of nodes of two sets of faces that a translation takes onto each other.

    Raises
    ------
    InputError
        If there is no such translation.
    """
    from scipy.spatial import cKDTree

    a, b = mesh.faces(first).nodes, mesh.faces(second).nodes
    shift = mesh.points[b].mean(axis=0) - mesh.points[a].mean(axis=0)
    size = float(np.ptp(mesh.points, axis=0).max())
    distance, near = cKDTree(mesh.points[b]).query(mesh.points[a] + shift)
    if len(a) != len(b) or distance.max() > 1e-8 * size or len(np.unique(near)) < len(b):
        raise InputError(
            f"{label}: the nodes of {first!r} ({len(a)}) moved by {shift.round(6).tolist()} do not meet those of "
            f"{second!r} ({len(b)}); a periodic fluid needs equal meshes on both faces"
        )
    return np.column_stack([a, b[near]])


def numbering(mesh: Mesh, pairs: Sequence[tuple[str, str]], label: str) -> tuple[Ints, int]:
    """Numbers (n_nodes,) that nodes standing for each other share, and how many there are.

    Examples
    --------
    >>> from visviva import RectangleMesh
    >>> numbering(RectangleMesh(size=(1, 1), counts=(2, 1)).build(), [("x0", "x1")], "mesh")[0].tolist()
    [0, 1, 0, 2, 3, 2]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not pairs:
        return np.arange(mesh.n_nodes), mesh.n_nodes
    edges = np.concatenate([partners(mesh, *pair, label) for pair in pairs])
    graph = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(mesh.n_nodes,) * 2)
    count, group = connected_components(graph, directed=False)
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))  # in the order of the nodes
    return rank[inverse].astype(np.int64), int(count)
