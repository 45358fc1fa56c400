"""Velocities of a fluid at places within it, as weighted sums of nodal ones: how it carries immersed solids along."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.cells import CELLS
from visviva.mesh.convert import cell_numbers
from visviva.mesh.mesh import Mesh

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.flow.location import Place
    from visviva.mesh.faces import Faces

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

EDGE = np.tan(np.radians(12.5)) ** 2
"""Walls that meet at an angle of 25 degrees, the bend halved, run along two directions from there."""


class Transfer:
    """Interpolation that is exact for quadratic velocities, on linear cells too.

    On quadratic cells these are the shape functions. On linear ones gradients at the nodes, averaged over the cells
    around, complete them: ``v(x) = sum_A N_A(x) (v_A + grad v_A . (x - x_A) / 2)``. Without that a solid thinner than
    a cell can bend no more than the cell does, which shears instead. Rigid motions and linear fields stay exact, and
    along walls where the fluid sticks velocities are zero.

    Parameters
    ----------
    grid : Mesh
    number : array (n_nodes,)
        Numbers that nodes share which stand for each other.
    unknowns : callable
        First unknowns of the velocities by number.
    walls : list of Faces
        Where the fluid sticks.
    """

    def __init__(
        self,
        grid: Mesh,
        number: NDArray[np.int64],
        unknowns: Callable[[NDArray[np.int64]], Ints],
        walls: Sequence[Faces],
    ) -> None:
        self.grid, self.number, self.walls = grid, number, walls
        self._unknowns, self._count = unknowns, int(number.max()) + 1
        self._linear = all(CELLS[name].n_nodes == CELLS[name].n_corners for name in grid.cells)

    @cached_property
    def width(self) -> int:
        """Largest number of nodes that a place refers to."""
        return int(np.diff(self._stencils.indptr).max())

    def at(self, places: Place) -> tuple[Ints, Array]:
        """First unknowns (n, width) of velocities at places, and their weights."""
        if not self._linear:
            return np.ascontiguousarray(places.unknowns), places.weights
        rows = self._rows(places)
        numbers, weights = np.zeros((2, rows.shape[0], self.width))
        numbers[:] = rows.indices[rows.indptr[:-1], None]  # what a place has less than others weighs nothing
        count = np.diff(rows.indptr)
        place, number = np.repeat(np.arange(rows.shape[0]), count), np.arange(rows.nnz)
        number -= np.repeat(rows.indptr[:-1], count)
        numbers[place, number], weights[place, number] = rows.indices, rows.data
        return np.ascontiguousarray(self._unknowns(numbers.astype(int))), weights

    def within(self, n: int, points: NDArray[np.int64], cells: NDArray[np.int64]) -> tuple[Ints, Ints]:
        """First unknowns that `n` points refer to in cells, those of one in pairs: starts (n + 1), and unknowns."""
        import scipy.sparse as sp

        shape = (n, self._stencils.shape[0])
        numbers = sp.csr_array(
            sp.coo_array((np.ones(len(cells)), (points, cells)), shape=shape) @ self._stencils
        )
        return numbers.indptr.astype(np.int32), self._unknowns(numbers.indices)

    def _rows(self, found: Place) -> sp.csr_array:
        """Weights (n, n_numbers) of nodal velocities."""
        import scipy.sparse as sp

        X, (n, k) = self.grid.points, found.nodes.shape
        place, number = np.repeat(np.arange(n), k), self.number[found.nodes].ravel()
        away = 0.5 * (
            found.of_nodes(X)[:, None, :] - X[found.nodes]
        )  # in the mesh, wherever a place itself is

        def spread(weights: Array) -> sp.csr_array:
            return sp.coo_array((weights.ravel(), (place, number)), shape=(n, self._count)).tocsr()

        rows = spread(found.weights)
        for i, gradient in enumerate(self._gradients):
            rows = rows + spread(found.weights * away[:, :, i]) @ gradient
        rows.sort_indices()
        return rows

    @cached_property
    def _stencils(self) -> sp.csr_array:
        """Nodes by number that places in a cell refer to (n_cells, n_numbers)."""
        import scipy.sparse as sp

        mesh = self.grid
        cell = np.concatenate(
            [np.repeat(k, mesh.cells[c].shape[1]) for c, k in cell_numbers(mesh.cells).items()]
        )
        node = np.concatenate([nodes.ravel() for nodes in mesh.cells.values()])
        number, shape = self.number[node], (mesh.n_cells, self._count)
        of = sp.csr_array((np.ones(len(node)), (cell, number)), shape=shape)
        return of + of @ sum(abs(g) for g in self._gradients) if self._linear else of

    @cached_property
    def _gradients(self) -> list[Any]:
        import scipy.sparse as sp

        found = nodal_gradients(self.grid, self.number)
        away = self._away_from_walls()
        return [sum(sp.diags_array(p) @ g for p, g in zip(row, found, strict=True)) for row in away.T]

    def _away_from_walls(self) -> Array:
        """Projectors (n_numbers, d, d) onto directions along which no wall runs from a node.

        Where the fluid sticks its velocity does not change along the wall. Gradients averaged over the cells around a
        node, which touch the wall there alone or stand around an edge of it, would say that it does, and move bodies
        through the wall.
        """
        n, d = self._count, self.grid.points.shape[1]
        squares = np.zeros((n, d, d))
        for faces in self.walls:
            for nodes in faces.cells.values():
                along = self.grid.points[np.roll(nodes, 1, axis=1)] - self.grid.points[nodes]
                along /= np.linalg.norm(along, axis=2, keepdims=True)
                for ends in (nodes, np.roll(nodes, 1, axis=1)):
                    np.add.at(squares, self.number[ends], along[..., :, None] * along[..., None, :])
        size, axes = np.linalg.eigh(squares)
        off = size <= EDGE * size[:, -1:]
        return np.asarray(np.einsum("nik,nk,njk->nij", axes, off.astype(float), axes))


def nodal_gradients(mesh: Mesh, number: NDArray[np.int64]) -> list[Any]:
    """Matrices (n, n), one per direction, from nodal values to their gradients, averaged by volume.

    Nodes that stand for each other have the same of `n` numbers (n_nodes,), and the cells around all of them.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 2)).build()
    >>> nodal_gradients(mesh, np.arange(9))[0] @ (3 * mesh.points[:, 0])
    array([3., 3., 3., 3., 3., 3., 3., 3., 3.])
    """
    import scipy.sparse as sp

    n, d = int(number.max()) + 1, mesh.points.shape[1]
    volume, total = np.zeros(n), [sp.csr_array((n, n)) for _ in range(d)]
    for name, cells in mesh.cells.items():
        nodes = number[cells]
        dN = CELLS[name].dN(CELLS[name].nodes)
        J = np.einsum("mkc,qkj->mqcj", mesh.points[cells], dN)
        gradients = np.einsum("qkj,mqjc->mqkc", dN, np.linalg.inv(J))
        weight = np.linalg.det(J)
        np.add.at(volume, nodes, weight)
        at = np.broadcast_to(nodes[:, :, None], gradients.shape[:3]).ravel()
        by = np.broadcast_to(nodes[:, None, :], gradients.shape[:3]).ravel()
        for c in range(d):
            values = (weight[:, :, None] * gradients[..., c]).ravel()
            total[c] = total[c] + sp.coo_array((values, (at, by)), shape=(n, n)).tocsr()
    return [sp.diags_array(1 / volume) @ g for g in total]
