"""The middle of a shell in its reference: directors at the nodes, and what strains are made of at the points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.places import of_places
from visviva.body.mesh_points import in_space
from visviva.body.natural_strains import ASSUMED, AssumedStrains
from visviva.body.shell_normals import Normals
from visviva.mesh.cells import CELLS, Cell
from visviva.mesh.geometry import jacobians
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import Rule

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
BESIDE = 1e-6
"""Of half a cell: what is farther out is not on the shell."""


@dataclass(frozen=True, eq=False)
class ShellSurface:
    """Cells of one type with directors at their nodes.

    Attributes
    ----------
    kind : str
    points : array, (n, 3)
    cells : array, (m, k)
    directors : array, (n + e, 3)
        Of the nodes, then those more where nodes have several.
    turns : array, (m, k)
        Which of the directors each node of a cell has.
    first : array, (3,), or function of positions (n, 3) with values (n, 3), or None
        What direction 1 of the section is near to; else that of the cells' first coordinate.
    label : str
    """

    kind: str
    points: Array
    cells: Ints
    directors: Array
    turns: Ints
    first: Array | Callable[[Array], Array] | None
    label: str

    @property
    def assumed(self) -> AssumedStrains:
        """Sampling of its strains."""
        return ASSUMED[self.kind]

    @property
    def rule(self) -> Rule:
        """Points (q, 2) and weights (q,)."""
        return self.assumed.points

    @cached_property
    def N(self) -> Array:
        """Shape functions (q, k) at the points."""
        return CELLS[self.kind].N(self.rule.points)

    @cached_property
    def tangents(self) -> Array:
        """Derivatives (m, q, 3, 2) of positions by the cells' coordinates."""
        return self.tangents_at(self.points)

    def tangents_at(self, phi: Array) -> Array:
        """The same of other positions (n, 3) of the nodes."""
        return jacobians(phi, self.cells, CELLS[self.kind].dN(self.rule.points))

    @cached_property
    def axes(self) -> Array:
        """Orthonormal directions 1 and 2 of the section in the tangent plane, (m, q, 2, 3)."""
        g1, g2 = self.tangents[..., 0], self.tangents[..., 1]
        normal = unit(np.cross(g1, g2))
        if self.first is None:
            wanted = g1
        else:
            X = np.einsum("qk,mkc->mqc", self.N, self.points[self.cells])
            places = X.reshape(-1, 3)
            given = (
                of_places(self.label, "first", self.first, places, places.shape).reshape(X.shape)
                if callable(self.first)
                else self.first
            )
            wanted = np.broadcast_to(given, X.shape)
        e1 = wanted - (wanted * normal).sum(axis=-1, keepdims=True) * normal
        size = np.linalg.norm(e1, axis=-1)
        if not np.all(size > 1e-6 * np.linalg.norm(wanted, axis=-1)):
            cell = int(np.unravel_index(np.argmin(size), size.shape)[0])
            raise InputError(
                f"{self.label}: first is across its surface in cell {cell}; choose a direction along it"
            )
        e1 = unit(e1)
        return np.stack([e1, np.cross(normal, e1)], axis=2)

    @cached_property
    def back(self) -> Array:
        """Derivatives (m, q, 2, 2) of the cells' coordinates by lengths along the axes."""
        forward = np.einsum("mqai,mqib->mqab", self.axes, self.tangents)
        return np.linalg.inv(forward).transpose(0, 1, 3, 2)  # [a, b]: of coordinate b along axis a

    @cached_property
    def areas(self) -> Array:
        """Of the points (m, q)."""
        g1, g2 = self.tangents[..., 0], self.tangents[..., 1]
        return np.asarray(self.rule.weights * np.linalg.norm(np.cross(g1, g2), axis=2))

    # --- strains -------------------------------------------------------------------------------------------
    @property
    def plane_turns(self) -> Array:
        """Matrix to strains 11, 22, 2 x 12 along the section's directions (m, q, 3, 3) from those along coordinates."""
        (a, b), (c, d) = np.moveaxis(self.back, (2, 3), (0, 1))
        plane = np.array(
            [(a * a, b * b, a * b), (c * c, d * d, c * d), (2 * a * c, 2 * b * d, a * d + b * c)]
        )
        return np.moveaxis(plane, (0, 1), (2, 3))

    @cached_property
    def section_strains(self) -> Array:
        """Strains along the section's directions at the points (m, q, 8, n), of those sampled in the cells."""
        turn = np.zeros((*self.areas.shape, 8, 8))
        turn[..., :3, :3] = turn[..., 3:6, 3:6] = self.plane_turns
        turn[..., 6:, 6:] = self.back
        return turn @ self.assumed.shares

    def sampled(self, phi: Array, d: Array) -> Array:
        """Strains (m, n) as they are sampled of positions (n, 3) and directors (n + e, 3)."""
        return self.assumed.sampled(phi[self.cells], d[self.turns])

    @cached_property
    def reference(self) -> Array:
        """Strains of the reference (m, n)."""
        return self.sampled(self.points, self.directors)

    def change(self, phi: Array, d: Array) -> Array:
        """Strains sampled (m, n) less those of the reference."""
        return self.sampled(phi, d) - self.reference

    def relieved(self, C: Array, thickness: Array) -> Array:
        """Sections' stiffness (m, 8, 8) with that of shear that suits cells (m,) so thick."""
        corners = self.points[self.cells[:, : CELLS[self.kind].n_corners]]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        factor = thickness**2 / (thickness**2 + self.assumed.relief * sides**2)
        C = C.copy()
        C[:, 6:, 6:] *= factor[:, None, None]
        return C

    def stiffness(self, C: Array, A: Array) -> Array:
        """Of cells by the strains sampled (m, n, n), of sections (m, 8, 8) that see strains A (m, q, 8, n) of them."""
        CA = self.areas[..., None, None] * (C[:, None] @ A)
        m, n = len(A), A.shape[-1]
        total: Array = A.reshape(m, -1, n).transpose(0, 2, 1) @ CA.reshape(m, -1, n)
        return total

    # --- places --------------------------------------------------------------------------------------------
    def near(self, X: Array) -> tuple[float, float, Place]:
        """Distance of the place `X` (3,) from a cell (in its halves) and above it, and the cell's point under it."""
        cell = CELLS[self.kind]
        local = self.points[self.cells]
        centres = local.mean(axis=1)
        radii = np.linalg.norm(local - centres[:, None], axis=2).max(axis=1)
        close = np.argsort(np.linalg.norm(centres - X, axis=1) - radii)[:12]
        local, normals = local[close], self.directors[self.turns[close]]
        xi, height = np.tile(cell.centre, (len(close), 1)), np.zeros(len(close))
        for _ in range(25):  # X = phi + height d, by Newton's method in each cell
            N, dN = cell.N_dN(xi)
            phi, d = (np.einsum("mk,mkc->mc", N, of) for of in (local, normals))
            J = np.einsum("mka,mkc->mca", dN, local + height[:, None, None] * normals)
            matrix, away = np.concatenate([J, d[:, :, None]], axis=2), X - phi - height[:, None] * d
            move = np.einsum("mij,mj->mi", np.linalg.pinv(matrix), away)
            xi, height = np.clip(xi + move[:, :2], -2, 2), height + move[:, 2]
        beyond = np.maximum(outside(cell, xi), 0.0)
        best = int(np.argmin(beyond + np.abs(height) / np.linalg.norm(np.ptp(self.points, axis=0))))
        k = close[best]
        found = Place(self.cells[k], self.turns[k], cell.N(xi[best : best + 1])[0], float(height[best]))
        return float(beyond[best]), abs(found.height), found


class Place(NamedTuple):
    """Nodes (k,) and numbers of directors (k,) with weights (k,) of a point of the middle, and a height above it."""

    nodes: Ints
    turns: Ints
    N: Array
    height: float


def outside(cell: Cell, xi: Array) -> Array:
    """Distance of points (m, 2) from the reference cell, in halves of it."""
    if cell.n_corners == 4:
        return np.asarray(np.abs(xi).max(axis=1) - 1)
    return np.asarray(2 * np.max([-xi[:, 0], -xi[:, 1], xi.sum(axis=1) - 1], axis=0))


def place(parts: Sequence[ShellSurface], X: Array) -> Place:
    """Nodes and weights of the point of the middle under the place `X` (3,).

    Raises
    ------
    InputError
        If it lies beside the shell.
    """
    beyond, _, found = min((part.near(X) for part in parts), key=lambda near: (max(near[0], BESIDE), near[1]))
    if beyond > BESIDE:
        raise InputError(
            f"{parts[0].label}: {X.tolist()} lies beside it; give a place on the shell or above it"
        )
    return found


def shell_surfaces(
    label: str, grid: Mesh, first: Array | Callable[[Array], Array] | None, kinks: bool
) -> tuple[tuple[ShellSurface, ...], Ints]:
    """The surfaces of a mesh in space type by type, and the nodes (e,) of directors beyond one for each node.

    Raises
    ------
    InputError
        If cells are of another type, without area or folded, do not agree in their sides, or meet in kinks.
    """
    cells = {kind: np.asarray(nodes) for kind, nodes in grid.cells.items() if len(nodes)}
    if not cells or not set(cells) <= set(ASSUMED):
        raise InputError(
            f"{label}: its mesh has cells {', '.join(cells) or 'of no type'}; a shell needs {', '.join(ASSUMED)}"
        )
    normals = Normals(in_space(grid), cells, label)
    _ = normals.weighed  # refuses cells that are folded
    normals.refuse_turned(kinks)
    if kinks:
        directors, turns, extra = normals.several()
    else:
        directors, turns, extra = normals.smooth(), normals.nodes, np.zeros(0, dtype=np.int64)
    parts = []
    for kind, nodes in cells.items():
        own = turns[normals.starts[kind] :][: nodes.size].reshape(nodes.shape)
        parts.append(ShellSurface(kind, normals.points, nodes, directors, own, first, label))
        _ = parts[-1].axes  # refuses a direction across it
    return tuple(parts), extra


def unit(v: Array) -> Array:
    """Vectors (..., 3) of length one."""
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
