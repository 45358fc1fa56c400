"""Cells of solids with heat whose material feels another change of volume than that of each point: F-bar and mixed."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.body.solid_fields import FULL, components
from visviva.body.stressed_cells import StressedCells

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class DilatedCells(StressedCells):
    """Base of cells whose material feels ``Fbar = (Jbar / J)^(1/3) F``."""

    @abstractmethod
    def log_volume(self, x: Array, some: slice) -> Array:
        """What their material feels, ``ln Jbar`` (m, q)."""

    @abstractmethod
    def dilating_forces(self, x: Array, pressure: Array, back: Array) -> Array:
        """Residuals (m, k, 3) of what makes ``Jbar``, by the mean stress (m, q) and ``F^-T`` (m, q, 3, 3)."""

    def strains(self, x: Array, some: slice = slice(None)) -> tuple[Array, Array]:
        """What their material feels: Fbar (m, q, 3, 3) and Cbar (m, q, 6)."""
        F, _ = super().strains(x, some)
        ratio = np.exp((self.log_volume(x, some) - np.log(np.linalg.det(F))) / 3)
        bar = ratio[..., None, None] * F
        return bar, components(np.swapaxes(bar, -1, -2) @ bar)

    def forces(self, x: Array) -> Array:
        F, _ = super().strains(x)
        bar, C = self.strains(x)
        S = self.respond(x, self.nodes, C)[0][..., FULL]
        mean = np.einsum("mqij,mqij->mq", S, C[..., FULL]) / 3
        ratio, back = np.cbrt(np.linalg.det(bar) / np.linalg.det(F)), np.swapaxes(np.linalg.inv(F), -1, -2)
        P = ratio[..., None, None] * (bar @ S) - mean[..., None, None] * back
        return np.asarray(self._by_nodes(P) + self.dilating_forces(x, mean, back))

    def _by_nodes(self, P: Array) -> Array:
        of_nodes = self.gradients[:, :, : self.nodes.shape[1]]
        return np.asarray(np.einsum("mq,mqij,mqkj->mki", self.volume, P, of_nodes))


@dataclass(frozen=True, eq=False, kw_only=True)
class CentreCells(DilatedCells):
    """F-bar: the change of volume is that of the centre.

    Attributes
    ----------
    centre : array (m, k, 3)
        Gradients of the shape functions there.
    """

    centre: Array

    def _at_centre(self, x: Array, some: slice) -> Array:
        return np.asarray(np.einsum("mkj,mki->mij", self.centre[some], self.vectors(x, some)))

    def log_volume(self, x: Array, some: slice) -> Array:
        found = np.log(np.linalg.det(self._at_centre(x, some)))
        return np.repeat(found[:, None], self.volume.shape[1], axis=1)

    def dilating_forces(self, x: Array, pressure: Array, back: Array) -> Array:
        back = np.swapaxes(np.linalg.inv(self._at_centre(x, slice(None))), -1, -2)
        whole = np.einsum("mq,mq->m", self.volume, pressure)
        return np.asarray(np.einsum("m,mij,mkj->mki", whole, back, self.centre))


@dataclass(frozen=True, eq=False, kw_only=True)
class PressedCells(DilatedCells):
    """Mixed: the change of volume is a field of its own, and so is the pressure that makes it that of the points.

    Attributes
    ----------
    shapes : array (m, q, p)
        Of both fields.
    numbers : int array (m, p)
        Of the unknowns of the change of volume; behind each follows that of the pressure.
    """

    shapes: Array
    numbers: Ints

    def log_volume(self, x: Array, some: slice) -> Array:
        return np.asarray(np.einsum("mqp,mp->mq", self.shapes[some], x[self.numbers[some]]))

    def dilating_forces(self, x: Array, pressure: Array, back: Array) -> Array:
        own = np.einsum("mqp,mp->mq", self.shapes, x[self.numbers + 1])
        return self._by_nodes(own[..., None, None] * back)
