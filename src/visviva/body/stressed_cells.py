"""Cells whose stresses depend on further fields: what the core's terms of solids tell of theirs, in Python."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.body.solid_fields import FULL, components
from visviva.body.solid_term import Elements
from visviva.mesh.geometry import determinant

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class StressedCells:
    """Cells of one type with what is needed to look at their strains and stresses.

    Attributes
    ----------
    nodes : array (m, k)
    gradients : array (m, q, l, d)
        Of the shape functions of `vectors`.
    volume : array (m, q)
    N : array (q, k)
        Shape functions of the nodes at the points.
    vectors : callable
        Positions (m, l, 3), and what else deforms these cells, from the unknowns and a slice of the cells.
    respond : callable
        Second Piola-Kirchhoff stresses (m, q, 6) and energies (m, q) from the unknowns, nodes (m, k) and C (m, q, 6).
    hoop : array (m, q, k), optional
        Weights of the hoop stretch of what is axisymmetric.
    """

    nodes: Ints
    gradients: Array
    volume: Array
    N: Array
    vectors: Callable[[Array, slice], Array]
    respond: Callable[[Array, Ints, Array], tuple[Array, Array]]
    hoop: Array | None = None

    def strains(self, x: Array, some: slice = slice(None)) -> tuple[Array, Array]:
        """Deformation gradients (m, q, 3, 3) and C (m, q, 6)."""
        hoop = None if self.hoop is None else self.hoop[some]
        F = deformation(self.gradients[some], self.vectors(x, some), hoop)
        return F, components(np.swapaxes(F, -1, -2) @ F)

    def ratios(self, x: Array, some: slice) -> Array:
        """Ratios of volumes (m, q) by the vectors alone, whatever the material feels."""
        hoop = None if self.hoop is None else self.hoop[some]
        return determinant(deformation(self.gradients[some], self.vectors(x, some), hoop))

    def fields(self, x: Array, start: int, stop: int) -> Array:
        """Rows (m, q, 16) of F, second Piola-Kirchhoff stresses and energies, as of the core's terms of solids."""
        some = slice(start, stop)
        F, C = self.strains(x, some)
        S, W = self.respond(x, self.nodes[some], C)
        return np.concatenate([F.reshape(*W.shape, 9), S, W[..., None]], axis=-1)

    def forces(self, x: Array) -> Array:
        """Residuals (m, k, 3) by nodes of the strained cells."""
        F, C = self.strains(x)
        S, _ = self.respond(x, self.nodes, C)
        return self.by_nodes(F @ S[..., FULL])

    def by_nodes(self, P: Array) -> Array:
        """Residuals (m, k, 3) of first Piola-Kirchhoff stresses (m, q, 3, 3)."""
        k = self.nodes.shape[1]
        hoop = None if self.hoop is None else self.hoop[:, :, :k]
        return residuals(P, self.volume, self.gradients[:, :, :k], hoop)

    def elements(self, cell: str, first: int) -> Elements:
        """These as elements of a solid, numbered from `first` on."""
        numbers = first + np.arange(len(self.nodes))
        return Elements(
            cell=cell, nodes=self.nodes, numbers=numbers, thermal=None, term=self, volume=self.volume
        )


def deformation(gradients: Array, vectors: Array, hoop: Array | None) -> Array:
    """Deformation gradients (m, q, 3, 3) of vectors (m, k, 3) by the gradients (m, q, k, d) of their functions.

    In the plane nothing stretches across, or what the weights (m, q, k) of the hoop stretch say.
    """
    d = gradients.shape[3]
    F = np.zeros((*gradients.shape[:2], 3, 3))
    F[..., :d] = np.einsum("mqkj,mki->mqij", gradients, vectors)
    if d == 2:
        F[..., 2, 2] = 1.0 if hoop is None else hoop @ vectors[:, :, :1] @ [1.0]
    return F


def residuals(P: Array, volume: Array, gradients: Array, hoop: Array | None) -> Array:
    """What stresses P (m, q, 3, 3) in volumes (m, q) exert on vectors (m, k, 3), see `deformation`."""
    found = np.einsum("mq,mqij,mqkj->mki", volume, P[..., : gradients.shape[3]], gradients)
    if hoop is not None:
        found[..., 0] += np.einsum("mq,mq,mqk->mk", volume, P[..., 2, 2], hoop)
    return np.asarray(found)
