"""Geometry of solid elements in the reference configuration: what the core's kernels need of a cell type."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.cells import CELLS
from visviva.mesh.geometry import jacobians, measure
from visviva.mesh.quadrature import Rule, mass_rule, stiffness_rule

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
T = TypeVar("T")


@dataclass(frozen=True)
class Geometry:
    """Gradients of the shape functions at the quadrature points of elements of one type.

    Attributes
    ----------
    gradients : array, (m, q, k, d)
        ``dN_a/dX`` of m elements at q points for k nodes.
    volume : array, (m, q)
        Reference volume of each point: weight, Jacobian, thickness or circumference.
    hoop : array, (m, q, k) or None
        ``N_a / R``, the weights of the hoop stretch of axisymmetric elements.
    """

    gradients: Array
    volume: Array
    hoop: Array | None

    @property
    def columns(self) -> Array:
        """Weights (m, q, k, c) of what strains are made of: gradients, and behind them those of the hoop stretch."""
        if self.hoop is None:
            return self.gradients
        return np.concatenate([self.gradients, self.hoop[..., None]], axis=3)

    def chosen(self, kinds: tuple[T, T, T]) -> T:
        """What is for these elements, of what is for those in space, in a plane, and of revolution."""
        return kinds[0 if self.gradients.shape[3] == 3 else 1 if self.hoop is None else 2]


def depth(points: Array, nodes: Ints, N: Array, thickness: float, axisymmetric: bool) -> Array:
    """Extent (m, q) across the plane: the thickness, or the circumference at the radius of a point."""
    radius: Array = points[nodes, 0] @ N.T
    return 2 * np.pi * radius if axisymmetric else np.full_like(radius, thickness)


def is_curved(points: Array, nodes: Ints, cell: str) -> bool:
    """True if a mid-side node of an element lies off the midpoint of its edge, beyond rounding.

    Examples
    --------
    >>> import numpy as np
    >>> side = np.array([(0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (1.0, 0.1), (1.0, 1.0), (0.0, 1.0)])
    >>> is_curved(side, np.arange(6)[None], "tri6")
    True
    """
    X = points[nodes]
    size = np.ptp(X, axis=1).max(initial=0.0)
    middles = CELLS[cell].middles
    corners = [X[:, list(group)].mean(axis=1) for group in middles]
    first = CELLS[cell].n_corners
    off = [np.abs(X[:, first + k] - middle).max(initial=0.0) for k, middle in enumerate(corners)]
    return bool(max(off, default=0.0) > 1e-9 * size)


def solid_rule(points: Array, nodes: Ints, cell: str) -> Rule:
    """Quadrature of the internal forces of elements `nodes` among `points`."""
    return stiffness_rule(cell, is_curved(points, nodes, cell))


def geometry(
    points: Array,
    nodes: Ints,
    cell: str,
    *,
    rule: Rule | None = None,
    thickness: float = 1.0,
    axisymmetric: bool = False,
) -> Geometry:
    """Gradients and volumes of elements `nodes` (m, k) among `points` (n, d).

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    >>> float(geometry(square, np.array([[0, 1, 2, 3]]), "quad4").volume.sum())
    4.0
    """
    xi, w = rule or solid_rule(points, nodes, cell)
    kind = CELLS[cell]
    J = jacobians(points, nodes, kind.dN(xi))
    gradients = kind.dN(xi) @ np.linalg.inv(J)
    volume = w * measure(J)
    hoop = None
    if points.shape[1] == 2:
        N = kind.N(xi)
        volume = volume * depth(points, nodes, N, thickness, axisymmetric)
        if axisymmetric:
            hoop = N / (points[nodes, 0] @ N.T)[:, :, None]
    return Geometry(np.ascontiguousarray(gradients), volume, hoop)


def volumes(
    points: Array, nodes: Ints, cell: str, *, thickness: float = 1.0, axisymmetric: bool = False
) -> Array:
    """Volumes (m, q) of elements at the points of the rule of their mass."""
    xi, w = mass_rule(cell)
    volume = w * measure(jacobians(points, nodes, CELLS[cell].dN(xi)))
    if points.shape[1] == 2:
        volume = volume * depth(points, nodes, CELLS[cell].N(xi), thickness, axisymmetric)
    return volume


def masses(
    points: Array,
    nodes: Ints,
    cell: str,
    density: float,
    *,
    thickness: float = 1.0,
    axisymmetric: bool = False,
    lumped: bool = False,
) -> Array:
    """Mass matrices (m, k (k + 1) / 2) of elements, packed upper triangles by rows.

    Lumped masses scale the diagonal of the consistent matrix (Hinton, Rock & Zienkiewicz 1976), so that they stay
    positive for elements of higher order.
    """
    N = CELLS[cell].N(mass_rule(cell).points)
    volume = volumes(points, nodes, cell, thickness=thickness, axisymmetric=axisymmetric)
    a, b = np.triu_indices(N.shape[1])
    packed: Array = density * volume @ (N[:, a] * N[:, b])
    if lumped:
        diagonal = packed[:, a == b]
        scale = density * volume.sum(axis=1) / diagonal.sum(axis=1)
        packed = np.where(a == b, packed * scale[:, None], 0.0)
    return packed


def nodal_masses(n: int, masses: Iterable[tuple[Ints, Array]]) -> Array:
    """Row sums (n,) of the mass matrix of a mesh of `n` nodes, from cells (m, k) with their packed masses."""
    total = np.zeros(n)
    for nodes, packed in masses:
        for pair, (a, b) in enumerate(zip(*np.triu_indices(nodes.shape[1]), strict=True)):
            np.add.at(total, nodes[:, a], packed[:, pair])
            if a != b:
                np.add.at(total, nodes[:, b], packed[:, pair])
    return total
