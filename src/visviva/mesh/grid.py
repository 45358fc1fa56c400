"""Grids of cells on the unit square or cube, before they are given a shape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations

import numpy as np

from visviva.mesh.cells import (
    HEXAHEDRON,
    QUADRILATERAL,
    TETRAHEDRON,
    TRIANGLE,
    WEDGE,
    Array,
    Cell,
    Ints,
    cell_type,
)
from visviva.mesh.convert import joined, welded
from visviva.mesh.faces import Faces, stacked
from visviva.mesh.mesh import Mesh

Names = Sequence[tuple[str | None, str | None]]
SIDES: Names = (("x0", "x1"), ("y0", "y1"), ("z0", "z1"))


class Grid:
    """Cells on `counts` blocks that fill [0, 1]^n, first coordinate fastest.

    Parameters
    ----------
    counts : sequence of int
        Blocks along every coordinate.
    cell : str
        Type of cell; triangles and wedges are half a block, tetrahedra a sixth of it.
    periodic : sequence of int
        Coordinates that end where they begin.

    Attributes
    ----------
    rows : array of int, (n_cells, n_nodes of the cell)
    places : array, (n_nodes, n)
        Coordinates of the nodes.
    """

    def __init__(self, counts: Sequence[int], cell: str, periodic: Sequence[int] = ()) -> None:
        self.counts, self.cell = tuple(counts), cell_type(cell)
        order = 2 if self.cell.middles else 1
        self.offsets = np.round(order * _template(self.cell)).astype(np.int64)
        extent = [order * n + (k not in periodic) for k, n in enumerate(counts)]
        rows = self._lattice_rows(order, extent)
        used = np.zeros(int(np.prod(extent)), dtype=bool)
        used[rows] = True
        self.rows = (np.cumsum(used) - 1)[rows]
        index = np.unravel_index(np.flatnonzero(used), extent[::-1])[::-1]
        self.places = np.column_stack([i / (order * n) for i, n in zip(index, counts, strict=True)])
        self.order = order

    def _lattice_rows(self, order: int, extent: Sequence[int]) -> Ints:
        """Lattice points of all cells: a sum of one summand for every coordinate."""
        shape = (*self.counts[::-1], *self.offsets.shape[:2])
        n, step = len(self.counts), 1
        rows = np.zeros(shape, dtype=np.int64)
        for k, count in enumerate(self.counts):
            along = order * np.arange(count)[:, None, None] + self.offsets[:, :, k]
            place = [1] * n
            place[n - 1 - k] = count
            rows += (along % extent[k] * step).reshape(*place, *self.offsets.shape[:2])
            step *= extent[k]
        return rows.reshape(-1, self.cell.n_nodes)

    def side(self, coordinate: int, end: int) -> Faces:
        """Faces where a coordinate is 0 or 1."""
        blocks = np.arange(np.prod(self.counts)).reshape(self.counts[::-1])
        layer = np.take(blocks, -end, axis=len(self.counts) - 1 - coordinate).ravel()
        found = []
        for k, offsets in enumerate(self.offsets):
            owner = layer * len(self.offsets) + k
            for face in self.cell.faces:
                if np.all(offsets[face.nodes, coordinate] == end * self.order):
                    nodes = self.rows[owner][:, face.nodes]
                    found.append(Faces({face.type: nodes}, {face.type: owner}))
        return stacked(found)  # a cell has one face on a side at most

    def mesh(self, points: Array, names: Names) -> Mesh:
        """The mesh with nodes at `points` and sets of faces by the names of its sides, None for no set."""
        wanted = [(name, k, end) for k, pair in enumerate(names) for end, name in enumerate(pair) if name]
        sets = {name: self.side(k, end) for name, k, end in wanted}
        return Mesh(points, {self.cell.name: self.rows}, face_sets=sets)


def _template(cell: Cell) -> Array:
    """Nodes (n, n_nodes, dim) of the cells that a unit block is divided into.

    Diagonals run from the least to the greatest coordinates, so that neighbouring blocks agree.
    """
    corners = np.array(cell.family.corners, dtype=float)
    triangles = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], dtype=float)
    if cell.family in (QUADRILATERAL, HEXAHEDRON):
        divided = (corners[None] + 1) / 2
    elif cell.family is TRIANGLE:
        divided = triangles
    elif cell.family is WEDGE:
        divided = np.concatenate([np.insert(triangles, 2, z, axis=2) for z in (0, 1)], axis=1)
    else:
        assert cell.family is TETRAHEDRON
        divided = np.array([_path(axes) for axes in permutations(range(3))])
    middles = [divided[:, list(group)].mean(axis=1, keepdims=True) for group in cell.middles]
    return np.concatenate([divided, *middles], axis=1)


def _path(axes: tuple[int, ...]) -> Array:
    """The tetrahedron whose corners lie on the way from 0 to (1, 1, 1) along the axes in this order."""
    corners = np.concatenate([np.zeros((1, 3)), np.cumsum(np.eye(3)[list(axes)], axis=0)])
    return corners if np.linalg.det(np.diff(corners, axis=0)) > 0 else corners[[0, 2, 1, 3]]


Block = tuple[Sequence[int], Callable[[Array], Array], Names]


def assembled(blocks: Sequence[Block], cell: str, distance: float) -> Mesh:
    """One mesh of several grids (counts, map to space, names of sides), welded where they touch."""
    grids = [(Grid(counts, cell), place, names) for counts, place, names in blocks]
    return welded(joined([grid.mesh(place(grid.places), names) for grid, place, names in grids]), distance)
