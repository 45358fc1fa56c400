"""Finding the cells that many places lie in, and the unknowns of a fluid with weights that interpolate there."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.solid_fields import linear
from visviva.mesh.cells import CELLS, TETRAHEDRON, TRIANGLE, WEDGE, Cell
from visviva.mesh.convert import cell_numbers
from visviva.mesh.mesh import Mesh

if TYPE_CHECKING:
    from visviva.flow.fluid import Fluid

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

TOLERANCE = 1e-8
"""Distance outside a cell, in its reference coordinates, up to which a place counts as inside."""
NEAREST = 12
"""So many cells whose centres are nearest are tried before all whose boxes hold a place."""
STRAIGHT = 8 * np.finfo(float).eps
"""Part of the largest coordinate by which nodes may be off where a linear map of the reference cell puts them."""
BULGE = 0.5
"""Cells do not reach further out of the box of their nodes than by this share of their size, however curved."""


def inverse(cell: Cell, corners: Array, x: Array) -> Array:
    """Reference coordinates (n, d) of places (n, d) in cells with nodes (n, k, d); NaN where Newton fails."""
    xi, on_way = np.tile(cell.centre, (len(x), 1)), np.ones(len(x), dtype=bool)
    for _ in range(30):
        here, nodes = xi[on_way], corners[on_way]
        N, dN = cell.N_dN(here)
        gap = x[on_way] - np.einsum("nk,nkd->nd", N, nodes)
        J = np.swapaxes(nodes, 1, 2) @ dN
        lost = ~(np.abs(np.linalg.det(J)) > 0) | (np.abs(here).max(axis=1) > 10)
        if lost.any():
            J[lost] = np.eye(x.shape[1])
        step = np.linalg.solve(J, gap[:, :, None])[:, :, 0]
        xi[on_way] = np.where(lost[:, None], np.nan, here + step)
        on_way[on_way] = ~lost  # what is lost stays out: its numbers are none
        if not np.any(np.abs(step[~lost]) > 1e-13 * np.maximum(1.0, np.abs(here[~lost]))):
            break
    return xi


class Straight:
    """Cells of one type that are linear images of the reference cell, whose places need no iteration.

    Attributes
    ----------
    are : bool array (m,)
        Which are; nodes of the others are off by more than rounding.
    """

    def __init__(self, cell: Cell, corners: Array) -> None:
        self._centre = cell.centre
        N, dN = cell.N_dN(cell.centre[None])
        self._middles = np.einsum("k,mkd->md", N[0], corners)
        J = np.swapaxes(corners, 1, 2) @ dN[0]
        images = self._middles[:, None, :] + (cell.nodes - cell.centre) @ np.swapaxes(J, 1, 2)
        off = np.abs(corners - images).max(axis=(1, 2))
        self.are = (off <= STRAIGHT * np.abs(corners).max()) & (np.abs(np.linalg.det(J)) > 0)
        self._inverses = np.linalg.inv(np.where(self.are[:, None, None], J, np.eye(J.shape[1])))

    def inverse(self, rows: Ints, x: Array) -> Array:
        """Reference coordinates (n, d) of places (n, d) in cells by number."""
        away = x - self._middles[rows]
        return np.asarray(self._centre + (self._inverses[rows] @ away[:, :, None])[:, :, 0])


def outside(cell: Cell, xi: Array) -> Array:
    """Distance of reference coordinates (n, d) from the cell (n,); negative inside."""
    corners = np.array(cell.family.corners, dtype=float)
    excess = np.maximum(corners.min(axis=0) - xi, xi - corners.max(axis=0)).max(axis=1)
    flat = {id(TRIANGLE): 2, id(WEDGE): 2, id(TETRAHEDRON): 3}.get(id(cell.family), 0)
    found: Array = np.maximum(excess, xi[:, :flat].sum(axis=1) - 1) if flat else excess
    return found


class Location:
    """Search for cells of a mesh by places.

    Examples
    --------
    >>> import visviva as vv
    >>> search = Location(vv.RectangleMesh(size=(2, 1), counts=(2, 1)).build())
    >>> search.find(np.array([(0.5, 0.5), (1.5, 0.25)]))[0].tolist()
    [0, 1]
    """

    def __init__(self, mesh: Mesh) -> None:
        from scipy.spatial import cKDTree

        self.mesh = mesh
        self._tree = cKDTree(mesh.centres)
        self._first = {name: int(rows[0]) for name, rows in cell_numbers(mesh.cells).items() if len(rows)}

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        corners = [self.mesh.points[rows] for rows in self.mesh.cells.values()]
        low = np.concatenate([c.min(axis=1) for c in corners])
        high = np.concatenate([c.max(axis=1) for c in corners])
        margin = BULGE * (high - low).max(axis=1, keepdims=True)
        return low - margin, high + margin

    @cached_property
    def _reach(self) -> float:
        """No cell has a place farther away from its centre."""
        low, high = self._boxes
        return float(np.linalg.norm(high - low, axis=1).max())

    @cached_property
    def _straight(self) -> dict[str, Straight]:
        return {name: Straight(CELLS[name], self.mesh.points[self.mesh.cells[name]]) for name in self._first}

    def find(self, places: Array) -> tuple[Ints, Array]:
        """Cells (n,), -1 outside of all, and reference coordinates (n, d) of places (n, d)."""
        cells, xi = np.full(len(places), -1), np.full(places.shape, np.nan)
        away, near = self._tree.query(places)
        known = np.flatnonzero(np.isfinite(away))  # farther than a square of numbers can say is outside
        self._try(places, known, near[known], cells, xi)
        lost, k = np.flatnonzero((cells < 0) & (away <= self._reach)), min(NEAREST, self.mesh.n_cells)
        if len(lost) == 0:
            return cells, xi
        _, near = self._tree.query(places[lost], k=k)
        near = np.reshape(near, (len(lost), k))
        for j in range(1, k):
            open_ = cells[lost] < 0
            self._try(places, lost[open_], near[open_, j], cells, xi)
            if np.all(cells[lost] >= 0):
                return cells, xi
        low, high = self._boxes
        for row, tried in zip(lost, near, strict=True):
            inside = np.flatnonzero(np.all((low <= places[row]) & (places[row] <= high), axis=1))
            for cell in np.setdiff1d(inside, tried) if cells[row] < 0 else ():
                if cells[row] < 0:
                    self._try(places, np.array([row]), np.array([cell]), cells, xi)
        return cells, xi

    def _try(self, places: Array, rows: Ints, candidates: Ints, cells: Ints, xi: Array) -> None:
        """Enter the places `rows` that lie in their candidate."""
        low, high = self._boxes
        near = np.all((low[candidates] <= places[rows]) & (places[rows] <= high[candidates]), axis=1)
        rows, candidates = rows[near], candidates[near]
        for name, first in self._first.items():
            mine = (candidates >= first) & (candidates < first + len(self.mesh.cells[name]))
            chosen = rows[mine]
            if len(chosen) == 0:
                continue
            found = self._inverse(name, candidates[mine] - first, places[chosen])
            hit = outside(CELLS[name], found) <= TOLERANCE
            cells[chosen[hit]], xi[chosen[hit]] = candidates[mine][hit], found[hit]

    def _inverse(self, name: str, rows: Ints, x: Array) -> Array:
        """Reference coordinates (n, d) of places (n, d) in cells of a type."""
        straight = self._straight[name]
        found, bent = straight.inverse(rows, x), ~straight.are[rows]
        if bent.any():
            corners = self.mesh.points[self.mesh.cells[name][rows[bent]]]
            found[bent] = inverse(CELLS[name], corners, x[bent])
        return found

    def parts(self, cells: Ints) -> list[tuple[str, Ints, Ints]]:
        """For each cell type: its name, which of the places lie in it, and the rows of their cells."""
        found = []
        for name, first in self._first.items():
            mine = np.flatnonzero((cells >= first) & (cells < first + len(self.mesh.cells[name])))
            found.append((name, mine, cells[mine] - first))
        return found


class Place:
    """Places in a fluid; `found` is what `Fluid.find` gave, if it was asked before.

    Attributes
    ----------
    cells : int array (n,)
        Cells they lie in, numbered through all types.
    nodes, weights : arrays (n, k)
        Nodes of these and the velocities' shape functions; what a type has less than another weighs nothing.
    gradients : array (n, k, d)
        Gradients of the same shape functions in space.
    unknowns : int array (n, k)
        First unknown of the velocity of each node.
    pressure_unknowns, pressure_weights : arrays (n, p)
        The same of the pressure.

    Raises
    ------
    InputError
        If a place is outside of the fluid.
    """

    def __init__(self, fluid: Fluid, places: Array, found: tuple[Ints, Array] | None = None) -> None:
        self.fluid = fluid
        self.cells, xi = found or fluid.find(places)
        if np.any(self.cells < 0):
            k = int(np.argmin(self.cells))
            raise InputError(f"{fluid.label}: the place {places[k].tolist()} lies outside of its mesh")
        n, d = places.shape
        kinds = [CELLS[name] for name in fluid.grid.cells]
        k, p = max(c.n_nodes for c in kinds), max(c.n_corners for c in kinds)
        self.nodes, self.weights, self.gradients = (
            np.zeros((n, k), int),
            np.zeros((n, k)),
            np.zeros((n, k, d)),
        )
        self.pressure_weights, self._pressures = np.zeros((n, p)), np.zeros((n, p), int)
        for name, mine, rows in fluid.location.parts(self.cells):
            self._fill(name, mine, rows, xi[mine])

    def _fill(self, name: str, mine: Ints, rows: Ints, xi: Array) -> None:
        cell, nodes = CELLS[name], self.fluid.grid.cells[name][rows]
        k, p = nodes.shape[1], cell.n_corners
        N, dN = cell.N_dN(xi)
        J = np.swapaxes(self.fluid.grid.points[nodes], 1, 2) @ dN
        self.nodes[mine, :k], self.weights[mine, :k] = nodes, N
        self.gradients[mine, :k] = dN @ np.linalg.inv(J)
        self.pressure_weights[mine, :p] = linear(cell).N(xi)
        self._pressures[mine, :p] = self.fluid.pressure_number[name][rows]

    @property
    def unknowns(self) -> NDArray[np.int32]:
        """First unknown (n, k) of the velocity of each node."""
        return self.fluid.node_unknowns(self.nodes)

    @property
    def pressure_unknowns(self) -> NDArray[np.int32]:
        """Unknowns (n, p) of the pressures."""
        return np.asarray(self.fluid.pressure.start + self._pressures, dtype=np.int32)

    def of_nodes(self, values: Array) -> Array:
        """Values (n, ...) of nodal ones (n_nodes, ...)."""
        return np.asarray(np.einsum("nk,nk...->n...", self.weights, values[self.nodes]))

    def velocities(self, x: Array) -> Array:
        """Velocities (n, 3) at the unknowns `x` of the system."""
        return self.of_nodes(self.fluid.by_node(x))

    def pressures(self, x: Array) -> Array:
        """Pressures (n,) at the unknowns `x` of the system."""
        p = np.einsum("np,np->n", self.pressure_weights, x[self.pressure_unknowns])
        return np.asarray(p - self.fluid.level(x))
