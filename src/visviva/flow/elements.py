"""Elements of fluids: which pairs of velocity and pressure there are, and what the core's kernels need of them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.element import geometry
from visviva.body.solid_fields import linear
from visviva.mesh.cells import CELLS, TETRAHEDRON, TRIANGLE
from visviva.mesh.geometry import jacobians
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import Rule, rule

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

PAIRS = {
    "Q2Q1": ("quad9", "hex27"),
    "P2P1": ("tri6", "tet10"),
    "Q1Q1": ("quad4", "hex8"),
    "P1P1": ("tri3", "tet4"),
}
"""Cells of each pair: pressures are linear and continuous, at the corners."""
STABILISED = ("quad4", "hex8", "tri3", "tet4")
"""Cells whose velocities and pressures are of equal order."""
SIMPLICES = (TRIANGLE, TETRAHEDRON)


def adapted(mesh: Mesh, elements: str | None, label: str) -> Mesh:
    """The mesh with the cells of a pair of elements, for which linear cells become quadratic.

    Raises
    ------
    InputError
        For pairs that are unstable or do not exist, and for cells that do not fit.
    """
    if elements is None:
        return fitting(mesh, label)
    if elements not in PAIRS:
        unstable = re.fullmatch(r"[QP]([0-9])[QP]([0-9])", elements) is not None
        why = "is unstable: its pressures oscillate or lock" if unstable else "does not exist"
        raise InputError(f"{label}: the pair of elements {elements!r} {why}; take one of {', '.join(PAIRS)}")
    wanted = [c for c in PAIRS[elements] if CELLS[c].dimension == mesh.dimension]
    if list(mesh.cells) == wanted:
        return fitting(mesh, label)
    simple = linear(CELLS[wanted[0]]).name
    if list(mesh.cells) == [simple]:
        return fitting(mesh.quadratic(wanted[0]), label)
    raise InputError(
        f"{label}: {elements} elements are built on {wanted[0]} or {simple}, and its mesh has {', '.join(mesh.cells)}"
    )


def fitting(mesh: Mesh, label: str) -> Mesh:
    """The mesh, if all its cells carry fluid elements that fit to each other."""
    known = [cell for cells in PAIRS.values() for cell in cells]
    for cell in mesh.cells:
        if cell not in known:
            raise InputError(
                f"{label}: there are no fluid elements on {cell}; make the mesh of {', '.join(known)}, "
                "by Mesh.quadratic for instance"
            )
    kinds = {cell in STABILISED for cell in mesh.cells}
    if len(kinds) > 1:
        raise InputError(
            f"{label}: cells of first and second order ({', '.join(mesh.cells)}) do not fit together; convert the "
            "linear ones by Mesh.quadratic"
        )
    return mesh


def flow_rule(cell: str) -> Rule:
    """Quadrature of a fluid element: exact for its mass, and on straight cells for its convection in the plane."""
    simplex = CELLS[cell].family in SIMPLICES
    quadratic = bool(CELLS[cell].middles)
    return rule(cell, (5 if quadratic else 2) if simplex else (5 if quadratic else 3))


def flow_face_rule(cell: str, face: str) -> Rule:
    """Quadrature on faces of a cell that goes with `flow_rule`: what convection and outflow leave cancels.

    That takes exact rules on simplices, and on others the points of the same lines.
    """
    quadratic = bool(CELLS[cell].middles)
    if CELLS[cell].family in SIMPLICES:
        return rule(face, 6 if quadratic else 3)
    return rule(face, 5 if quadratic else 3)


@dataclass(frozen=True)
class Batch:
    """Elements of one cell type.

    Attributes
    ----------
    cell : str
    points : array (n_nodes, d)
        Of the mesh.
    nodes : int array (m, k)
    """

    cell: str
    points: Array
    nodes: Ints

    @cached_property
    def rule(self) -> Rule:
        """Quadrature."""
        return flow_rule(self.cell)

    @cached_property
    def N(self) -> Array:
        """Shape functions (q, k) of the velocities."""
        return np.ascontiguousarray(CELLS[self.cell].N(self.rule.points))

    @cached_property
    def M(self) -> Array:
        """Shape functions (q, p) of the pressures."""
        return np.ascontiguousarray(linear(CELLS[self.cell]).N(self.rule.points))

    def geometry(self, part: slice = slice(None)) -> tuple[Array, Array]:
        """Gradients (m, q, k, d) of the velocities' shape functions and volumes (m, q)."""
        g = geometry(self.points, self.nodes[part], self.cell, rule=self.rule)
        return g.gradients, g.volume

    @property
    def places(self) -> Array:
        """Positions (m, q, d) of the points."""
        return np.asarray(np.einsum("qk,mkd->mqd", self.N, self.points[self.nodes]))

    @cached_property
    def middles(self) -> Array:
        """Middles (m, d) of the elements."""
        return np.asarray(self.points[self.nodes].mean(axis=1))

    @cached_property
    def edges(self) -> Array:
        """Edges (m,) of squares or cubes as large."""
        return np.asarray(self.geometry()[1].sum(axis=1) ** (1 / self.points.shape[1]))

    @cached_property
    def inverse(self) -> Array:
        """Derivatives (m, d, d) of the reference coordinates by the positions, in the middle of the elements."""
        cell = CELLS[self.cell]
        middle = cell.dN(cell.centre[None, :])
        return np.asarray(np.linalg.inv(jacobians(self.points, self.nodes, middle))[:, 0])

    @property
    def shape(self) -> Array:
        """Metric (d, d) of the reference element, 4 / l^2 in the end for edges of length l.

        Of simplices it is that of the regular one, so that no corner is special; a leg counts as the edge of a square.
        """
        d = self.points.shape[1]
        return 2 * (np.eye(d) + 1) if CELLS[self.cell].family in SIMPLICES else np.eye(d)

    def metric(self) -> Array | None:
        """Packed metric of the reference element and its square (m, q, d (d + 1) / 2 + 1); None without need."""
        if self.cell not in STABILISED:
            return None
        J = jacobians(self.points, self.nodes, CELLS[self.cell].dN(self.rule.points))
        back = np.linalg.inv(J)
        d = back.shape[-1]
        G = np.swapaxes(back, -1, -2) @ self.shape @ back
        a, b = np.triu_indices(d)
        square = np.sum(G**2, axis=(-2, -1))
        return np.ascontiguousarray(np.concatenate([G[..., a, b], square[..., None]], axis=2))


def pressure_numbers(grid: Mesh, number: Ints) -> tuple[dict[str, Ints], int]:
    """Numbers (m, p) of the pressures of each cell type's elements, and how many there are.

    `number` (n_nodes,) is equal for nodes that stand for each other.
    """
    corners = {cell: number[nodes[:, : CELLS[cell].n_corners]] for cell, nodes in grid.cells.items()}
    used, inverse = np.unique(np.concatenate([c.ravel() for c in corners.values()]), return_inverse=True)
    ends = np.cumsum([c.size for c in corners.values()])[:-1]
    parts = np.split(inverse, ends)
    return {cell: p.reshape(c.shape) for (cell, c), p in zip(corners.items(), parts, strict=True)}, len(used)
