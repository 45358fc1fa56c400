"""The flat faces that are drawn of cells: the boundary of volumes, curved faces divided at their middle nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.cells import TYPES
from visviva.mesh.faces import boundary
from visviva.output.surface import Surface

Ints = NDArray[np.int64]

CELL_OF = {cell.vtk: cell for cell in TYPES}
"""Cell types by VTK's number."""
PIECES = {
    "tri6": ([(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],),
    "quad8": ([(0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7)], [(4, 5, 6, 7)]),
    "quad9": ([(0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)],),
}
"""Flat pieces, by nodes, of the faces that have nodes in the middle of their edges."""


def skin(surface: Surface) -> list[Ints]:
    """Blocks of triangles, quadrilaterals and polygons (m, k) that bound a component.

    Examples
    --------
    >>> from visviva import BoxMesh
    >>> mesh = BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)).build()
    >>> [block.shape for block in skin(Surface("bar", mesh.points, [mesh.cells["hex8"]], [12]))]
    [(10, 4)]
    """
    flat: list[Ints] = []
    volumes: dict[str, list[Ints]] = {}
    for number, block in zip(surface.types, surface.cells, strict=True):
        cell = CELL_OF.get(number)
        if cell is not None and cell.dimension == 3:
            volumes.setdefault(cell.name, []).append(block)
        elif block.shape[1] > 2:
            flat += pieces("" if cell is None else cell.name, block)
    if not volumes:
        return flat
    outer = boundary({name: np.concatenate(blocks) for name, blocks in volumes.items()})
    return flat + [piece for name, nodes in outer.cells.items() for piece in pieces(name, nodes)]


def pieces(name: str, faces: Ints) -> list[Ints]:
    """Faces of one type as flat pieces."""
    if name not in PIECES:
        return [faces]
    return [faces[:, np.array(group)].reshape(-1, len(group[0])) for group in PIECES[name]]
