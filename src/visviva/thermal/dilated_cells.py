"""Cells of solids with heat whose material feels another change of volume than that of each point: F-bar and mixed."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.body.element import Geometry
from visviva.body.solid_fields import FULL, components
from visviva.body.stressed_cells import StressedCells, deformation, residuals

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class DilatedCells(StressedCells):
    """Base of cells whose material feels ``Fbar = (Jbar / J)^(1/n) F`` along n directions."""

    @property
    def scaled(self) -> int:
        """Number n of these directions."""
        return 3

    @abstractmethod
    def log_volume(self, x: Array, some: slice) -> Array:
        """What their material feels, ``ln Jbar`` (m, q)."""

    @abstractmethod
    def dilating_forces(self, x: Array, pressure: Array, back: Array) -> Array:
        """Residuals (m, k, 3) of what makes ``Jbar``, by the mean stress (m, q) and ``F^-T`` (m, q, 3, 3)."""

    def strains(self, x: Array, some: slice = slice(None)) -> tuple[Array, Array]:
        """What their material feels: Fbar (m, q, 3, 3) and Cbar (m, q, 6)."""
        F, _ = super().strains(x, some)
        n, bar = self.scaled, F.copy()
        ratio = np.exp((self.log_volume(x, some) - np.log(np.linalg.det(F))) / n)
        bar[..., :n, :n] *= ratio[..., None, None]
        return bar, components(np.swapaxes(bar, -1, -2) @ bar)

    def forces(self, x: Array) -> Array:
        F, _ = super().strains(x)
        bar, C = self.strains(x)
        S, n = self.respond(x, self.nodes, C)[0][..., FULL], self.scaled
        mean = np.einsum("mqij,mqij->mq", S[..., :n, :n], C[..., FULL][..., :n, :n]) / n
        ratio = (np.linalg.det(bar) / np.linalg.det(F)) ** (1 / n)
        back = np.swapaxes(np.linalg.inv(F), -1, -2)
        P = ratio[..., None, None] * (bar @ S) - mean[..., None, None] * back
        return self.by_nodes(P) + self.dilating_forces(x, mean, back)


@dataclass(frozen=True, eq=False, kw_only=True)
class CentreCells(DilatedCells):
    """F-bar: the change of volume is that of the centre, in plane strain that of the plane.

    Attributes
    ----------
    centre : Geometry
        Gradients of the shape functions there.
    """

    centre: Geometry

    @property
    def scaled(self) -> int:
        return 2 if self.centre.chosen((False, True, False)) else 3

    def _at_centre(self, x: Array, some: slice) -> Array:
        """Deformation gradients (m, 1, 3, 3)."""
        hoop = None if self.centre.hoop is None else self.centre.hoop[some]
        return deformation(self.centre.gradients[some], self.vectors(x, some), hoop)

    def log_volume(self, x: Array, some: slice) -> Array:
        found = np.log(np.linalg.det(self._at_centre(x, some)))
        return np.repeat(found, self.volume.shape[1], axis=1)

    def dilating_forces(self, x: Array, pressure: Array, back: Array) -> Array:
        back = np.swapaxes(np.linalg.inv(self._at_centre(x, slice(None))), -1, -2)
        whole = np.einsum("mq,mq->m", self.volume, pressure)[:, None]
        return residuals(back, whole, self.centre.gradients, self.centre.hoop)


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
        return self.by_nodes(own[..., None, None] * back)
