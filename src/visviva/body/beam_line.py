"""The line of a beam in its reference: triads at the nodes, and where places are along it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.places import of_places
from visviva.body.beam_shapes import shape_of
from visviva.body.mesh_points import in_space
from visviva.mesh.cells import CELLS
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
ROUNDING = 1e-13
KINK = np.deg2rad(45.0)
"""Cells that meet at more than this do not make a smooth line."""
NEAR = 1e-9
"""Of the length of a cell's parameter: what is nearer to a node is there."""


class Place(NamedTuple):
    """A place on or beside a beam: nodes (k,) and their weights, and its offset (3,) in the directors there."""

    nodes: Ints
    N: Array
    offset: Array


@dataclass(frozen=True, eq=False)
class BeamLine:
    """Cells of one type with triads at their nodes.

    Attributes
    ----------
    points : array, (n, 3)
    cells : array, (m, k)
    kind : str
        Cell type.
    triads : array, (n, 3, 3)
        Directors of the nodes by rows, the third along the line.
    own : array, (m, k, 3, 3)
        Directors of the cells at their nodes: those of the nodes where the line is smooth.
    """

    points: Array
    cells: Ints
    kind: str
    triads: Array
    own: Array

    @cached_property
    def turns(self) -> Array:
        """Rotations from directors of nodes to those of cells (m, k, 3, 3); the identity where the line is smooth."""
        turns = np.einsum("mkia,mkja->mkij", self.own, self.triads[self.cells])
        turns[np.abs(turns) < ROUNDING] = 0.0  # a mass of round-off is none
        smooth = np.all(np.abs(turns - np.eye(3)) < ROUNDING, axis=(2, 3))
        turns[smooth] = np.eye(3)
        return np.asarray(turns)

    def slopes(self, xi: Array) -> tuple[Array, Array, Array]:
        """Shape functions (q, k), their derivatives by length (m, q, k), and lengths per parameter (m, q)."""
        N, dN = shape_of(self.kind).N_dN(xi)
        tangent = np.einsum("qk,mkc->mqc", dN[:, :, 0], self.points[self.cells])
        speed = np.linalg.norm(tangent, axis=2)
        return N, dN[None, :, :, 0] / speed[:, :, None], speed

    # --- places ---------------------------------------------------------------------------------------------
    def place(self, X: Array, label: str) -> Place:
        """The place of the reference position `X` (3,): the foot on the line, and the offset from there.

        Raises
        ------
        InputError
            If it lies beyond an end.
        """
        cell, xi, away = self._foot(X, label)
        N = shape_of(self.kind).N(np.array([[xi]]))[0]
        directors = np.einsum("k,kij->ij", N, self.own[cell])
        return Place(self.cells[cell], N, np.linalg.solve(directors.T, away))

    def cell_near(self, X: Array, label: str) -> tuple[int, float]:
        """The cell nearest to the reference position `X` (3,), and the share of its parameter from its first node."""
        cell, xi, _ = self._foot(X, label)
        return cell, (xi + 1) / 2

    def _foot(self, X: Array, label: str) -> tuple[int, float, Array]:
        """Cell and parameter of the nearest place, and the vector (3,) from there to `X`."""
        xi, away = self._feet(X)
        distance = np.linalg.norm(away, axis=1)
        cell = int(np.argmin(distance))
        slope = self.slopes(xi[cell : cell + 1, None])[1]
        beyond = abs(away[cell] @ (slope[cell, 0] @ self.points[self.cells[cell]]))
        if beyond > 1e-6 * max(np.linalg.norm(np.ptp(self.points, axis=0)), distance[cell]):
            raise InputError(
                f"{label}: {X.tolist()} lies {beyond:.3g} beyond its end; attach a rigid body there if an arm is meant"
            )
        return cell, float(xi[cell]), away[cell]

    def _feet(self, X: Array) -> tuple[Array, Array]:
        """Parameters (m,) of the nearest place of every cell, and the vectors (m, 3) from there to `X`."""
        cell, local = shape_of(self.kind), self.points[self.cells]
        starts = np.linspace(-1, 1, 2 * cell.n_nodes - 1)
        places = np.einsum("qk,mkc->mqc", cell.N(starts[:, None]), local)
        xi = starts[np.argmin(np.linalg.norm(places - X, axis=2), axis=1)]
        for _ in range(20):
            N, dN = cell.N_dN(xi[:, None])
            away = X - np.einsum("mk,mkc->mc", N, local)
            tangent = np.einsum("mk,mkc->mc", dN[:, :, 0], local)
            move = (away * tangent).sum(axis=1) / (tangent * tangent).sum(axis=1)
            xi = np.clip(xi + move, -1, 1)
        for at in cell.nodes[:, 0]:
            xi[np.abs(xi - at) < NEAR] = at
        return xi, X - np.einsum("mk,mkc->mc", cell.N(xi[:, None]), local)

    def at_length(self, s: float, label: str) -> Array:
        """The reference position (3,) at an arc length from the start of the line; errors as of `cell_at`."""
        cell, share = self.cell_at(s, label)
        xi = self._at_share(cell, share)
        return np.asarray(shape_of(self.kind).N(np.array([[xi]]))[0] @ self.points[self.cells[cell]])

    def cell_at(self, s: float, label: str) -> tuple[int, float]:
        """The cell at an arc length from the start of the line, and the share of its length from its first node.

        Raises
        ------
        InputError
            If the line branches, is closed, or has no such place.
        """
        order, starts = chain(self.cells, label)
        lengths = self.lengths
        along = np.concatenate([[0.0], np.cumsum(lengths[order])])
        if not -NEAR * along[-1] <= s <= (1 + NEAR) * along[-1]:
            raise InputError(f"{label}: arc length {s:g} is not between 0 and {along[-1]:.9g}")
        k = min(max(int(np.searchsorted(along, s, side="right")) - 1, 0), len(order) - 1)
        cell, part = order[k], min(max((s - along[k]) / lengths[order[k]], 0.0), 1.0)
        return cell, part if self.cells[cell, 0] == starts[k] else 1 - part

    def _at_share(self, cell: int, share: float) -> float:
        """The parameter at a share of a cell's length from its first node."""
        fine = np.linspace(-1, 1, 401)
        speed = self.slopes(fine[:, None])[2][cell]
        length = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])
        return float(np.interp(share * length[-1], length, fine))

    @property
    def lengths(self) -> Array:
        """Of the cells (m,)."""
        xi, w = np.polynomial.legendre.leggauss(6)
        return np.asarray(self.slopes(xi[:, None])[2] @ w)


def chain(cells: Ints, label: str) -> tuple[list[int], list[int]]:
    """Cells in their order along a line that starts at a node with one cell, and the node that each starts from.

    Raises
    ------
    InputError
        If the line branches, is closed or in pieces.
    """
    at: dict[int, list[int]] = {}
    for c, (a, b) in enumerate(cells[:, :2].tolist()):
        at.setdefault(a, []).append(c)
        at.setdefault(b, []).append(c)
    free = [node for node, found in at.items() if len(found) == 1]
    if len(free) != 2 or max(map(len, at.values())) > 2:
        raise InputError(f"{label}: arc length is counted along one open line; say places by their positions")
    node = min(free, key=lambda n: (cells[at[n][0], 0] != n, n))  # the way the cells run, if they agree
    order, starts = [], []
    cell = at[node][0]
    while True:
        order.append(cell)
        starts.append(node)
        a, b = cells[cell, :2].tolist()
        node = b if a == node else a
        further = [c for c in at[node] if c != cell]
        if not further:
            return order, starts
        cell = further[0]


# --- triads -------------------------------------------------------------------------------------------------
def beam_line(
    label: str, grid: Mesh, first: Array | Callable[[Array], Array] | None, *, kinks: bool
) -> BeamLine:
    """The line of a mesh, whose directors d1 are as near to `first` as can be.

    Without `first` they are carried along the line without turning about it.

    Raises
    ------
    InputError
        If the mesh is no line in space, has kinks that were not asked for, or `first` is along it.
    """
    kind, cells, points = only_lines(label, grid)
    along = tangents(label, kind, cells, points)
    sign = directions(cells)
    if np.any(sign < 0):
        cells = cells.copy()
        cells[sign < 0, :2] = cells[sign < 0, 1::-1]
        cells[sign < 0, 2:] = cells[sign < 0, :1:-1]
        along = tangents(label, kind, cells, points)
    mean, corner = mean_tangents(cells, along, len(points))
    if corner.any() and not kinks:
        k = int(np.argmax(corner))
        raise InputError(
            f"{label}: its line has a kink or a branch at node {k}, {points[k].tolist()}; mesh a smooth line finer, or "
            "give kinks='rigid' to join the pieces there rigidly, kinks='hinged' to join them by ball joints"
        )
    return turned(label, BeamLine(points, cells, kind, np.empty(0), np.empty(0)), along, mean, corner, first)


def tangents(label: str, kind: str, cells: Ints, points: Array) -> Array:
    """Unit tangents (m, k, 3) of the cells at their nodes.

    Raises
    ------
    InputError
        If a cell has no length somewhere.
    """
    cell = shape_of(kind)
    found = np.einsum("ak,mkc->mac", cell.dN(cell.nodes)[:, :, 0], points[cells])
    length = np.linalg.norm(found, axis=2)
    if not np.all(length > 1e-12 * np.linalg.norm(np.ptp(points, axis=0))):
        k = int(np.argmin(length.min(axis=1)))
        raise InputError(f"{label}: cell {k} of its mesh, nodes {cells[k].tolist()}, has no length somewhere")
    return np.asarray(found / length[:, :, None])


def mean_tangents(cells: Ints, along: Array, n: int) -> tuple[Array, NDArray[np.bool_]]:
    """Mean tangents (n, 3) at the nodes, and where cells meet at a kink or lines branch (n,)."""
    mean = np.zeros((n, 3))
    np.add.at(mean, cells, along)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    bend = np.arccos(np.clip((along * mean[cells]).sum(axis=2), -1, 1))
    corner = np.zeros(n, dtype=bool)
    corner[cells[bend > KINK / 2]] = True
    corner[np.bincount(cells[:, :2].ravel(), minlength=n) > 2] = True
    return mean, corner


def parted_at_kinks(label: str, grid: Mesh) -> tuple[Mesh, Ints]:
    """The mesh with nodes of their own for cells that meet at kinks and branches, and which nodes (k, 2) are one place.

    The first cell keeps its node; those of the others come behind all nodes.
    """
    kind, cells, points = only_lines(label, grid)
    ends = cells.copy()
    sign = directions(cells)
    ends[sign < 0, :2] = cells[sign < 0, 1::-1]
    ends[sign < 0, 2:] = cells[sign < 0, :1:-1]
    _, corner = mean_tangents(ends, tangents(label, kind, ends, points), len(points))
    seen = np.zeros(len(points), dtype=bool)
    copies: list[tuple[int, int]] = []
    own = cells.copy()
    for c, a in np.argwhere(corner[cells]).tolist():
        node = cells[c, a]
        if seen[node]:
            own[c, a] = len(points) + len(copies)
            copies.append((int(node), int(own[c, a])))
        seen[node] = True
    pairs = np.array(copies, dtype=np.int64).reshape(-1, 2)
    parted = replace(grid, points=np.concatenate([points, points[pairs[:, 0]]]), cells={kind: own})
    return parted, pairs


def only_lines(label: str, grid: Mesh) -> tuple[str, Ints, Array]:
    """Type and nodes of the cells of a mesh of lines, and its nodes (n, 3)."""
    kinds = [kind for kind, nodes in grid.cells.items() if len(nodes)]
    if len(kinds) != 1 or CELLS[kinds[0]].dimension != 1:
        raise InputError(
            f"{label}: its mesh has cells {', '.join(kinds) or 'of no type'}; a beam needs lines of one type"
        )
    points = in_space(grid)
    return kinds[0], np.asarray(grid.cells[kinds[0]]), points


def directions(cells: Ints) -> Array:
    """Signs (m,) by which cells that follow each other run the same way; 1 where lines branch."""
    sign = np.zeros(len(cells))
    at: dict[int, list[int]] = {}
    for c, (a, b) in enumerate(cells[:, :2].tolist()):
        at.setdefault(a, []).append(c)
        at.setdefault(b, []).append(c)
    for seed in range(len(cells)):
        if sign[seed] != 0:
            continue
        sign[seed] = 1.0
        waiting = [seed]
        while waiting:
            c = waiting.pop()
            for node in cells[c, :2].tolist():
                for d in at[node]:
                    if sign[d] == 0:
                        opposite = (cells[c, 0] == node) == (cells[d, 0] == node)
                        sign[d] = -sign[c] if opposite and len(at[node]) == 2 else sign[c]
                        waiting.append(d)
    return sign


def turned(
    label: str,
    line: BeamLine,
    tangents: Array,
    mean: Array,
    corner: NDArray[np.bool_],
    first: Array | Callable[[Array], Array] | None,
) -> BeamLine:
    """The line with triads: third directors along the mean tangents, at corners along those of each cell."""
    points, cells = line.points, line.cells
    third = np.where(corner[cells][:, :, None], tangents, mean[cells])
    if first is None:
        d1 = carried_along(cells, third, corner)
    else:
        shape = points.shape
        given = of_places(label, "first", first, points, shape) if callable(first) else first
        d1 = np.broadcast_to(given, shape)[cells]
    d1 = d1 - (d1 * third).sum(axis=2, keepdims=True) * third
    size = np.linalg.norm(d1, axis=2, keepdims=True)
    if not np.all(size > 1e-6):
        c, a = np.unravel_index(int(np.argmin(size)), size.shape[:2])
        raise InputError(
            f"{label}: first is along the line at node {cells[c, a]}, {points[cells[c, a]].tolist()}; choose a "
            "direction across it"
        )
    d1 /= size
    own = np.stack([d1, np.cross(third, d1), third], axis=2)
    triads = np.empty((len(points), 3, 3))
    triads[:] = np.eye(3)
    triads[cells[::-1]] = own[::-1]  # at corners those of the first cell
    return BeamLine(points, cells, line.kind, triads, own)


def carried_along(cells: Ints, third: Array, corner: NDArray[np.bool_]) -> Array:
    """Directors d1 (m, k, 3) that do not turn about the line from node to node; anew behind corners."""
    d1 = np.zeros_like(third)
    at: dict[int, list[tuple[int, int]]] = {}
    for c, nodes in enumerate(cells.tolist()):
        for a, node in enumerate(nodes):
            at.setdefault(node, []).append((c, a))
    done = np.zeros(len(cells), dtype=bool)
    for seed in range(len(cells)):
        if done[seed]:
            continue
        waiting = [(seed, 0, across(third[seed, 0]))]
        while waiting:
            c, a, start = waiting.pop()
            if done[c]:
                continue
            done[c] = True
            for b in sorted(range(cells.shape[1]), key=lambda b: b != a):
                d1[c, b] = transported(start, third[c, a], third[c, b])
            for b, node in enumerate(cells[c].tolist()):
                for e, f in at[node]:
                    if not done[e]:
                        waiting.append((e, f, transported(d1[c, b], third[c, b], third[e, f])))
    return d1


def across(t: Array) -> Array:
    """A direction across `t`: of the axes of space the one that is most so, made normal."""
    e = np.eye(3)[int(np.argmin(np.round(np.abs(t), 9)))]
    d: Array = e - (e @ t) * t
    return d / np.linalg.norm(d)


def transported(d: Array, s: Array, t: Array) -> Array:
    """`d` turned by the least rotation that takes the direction `s` to `t`."""
    c, w = float(s @ t), np.cross(s, t)
    if c < -1 + 1e-12:
        return np.asarray(d - 2 * (d @ s) * s)
    return np.asarray(c * d + np.cross(w, d) + ((w @ d) / (1 + c)) * w)
