"""The flat boundary between two order parameters that exclude each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NotFinite
from visviva.phase.free_energy import FreeEnergy
from visviva.phase.interface import EDGE

Array = NDArray[np.float64]
Measured = Callable[[Array], tuple[float, Array]]

PIECES = 8, 16, 32
"""Of the way between two wells, which is found in few first."""
ITERATIONS = 300
"""For each of these at most."""
ASIDE = 1e-3
"""Of the values of an order parameter, by which wells are looked for off the axes, where saddles are."""
SAME = 0.01
"""Of these values, up to which two wells are one."""


@dataclass(frozen=True)
class Side:
    """An order parameter on its side of a boundary.

    Attributes
    ----------
    energy : FreeEnergy
    gradient : float
        Gradient energy across the boundary.
    present : tuple of float
        Near the values that it has where it alone is; where it is not it is near 0.
    """

    energy: FreeEnergy
    gradient: float
    present: tuple[float, ...]


def widths(sides: tuple[Side, Side], strength: float) -> Array:
    """Least width (2,) of the profile of each order parameter across their boundary; inf where they have none.

    It is the change of an order parameter over its greatest slope, as that of an `Interface`.

    Examples
    --------
    >>> from visviva.phase.free_energy import PolynomialEnergy
    >>> grain = Side(PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25)), 0.5, (1.0,))
    >>> [float(widths((grain, grain), strength).min().round(1)) for strength in (1.5, 20.0)]
    [2.0, 1.3]
    """
    least = np.full(2, np.inf)
    for present in product(*(side.present for side in sides)):
        try:
            with np.errstate(all="ignore"):
                least = np.fmin(least, Boundary(sides, strength, np.array(present)).widths())
        except NotFinite:  # of a function of the user that does not reach so far
            continue
    return least


def between(p: Array, pieces: int = PIECES[-1]) -> Array:
    """A way (2, n) from state to state in so many pieces."""
    at, before = np.linspace(0, 1, pieces + 1), np.linspace(0, 1, p.shape[1])
    return np.stack([np.interp(at, before, a) for a in p])


class Boundary:
    """The way of least tension between two wells of the energy that two order parameters have together.

    Across a flat boundary at rest the gradient energy is everywhere what the energy is above that of the wells, W, so
    that the way minimises ``integral of sqrt(2 W) ds`` with ``ds^2 = kappa_1 da_1^2 + kappa_2 da_2^2``: it does if the
    sum of ``W ds^2`` over pieces is least, which then all have the same share.
    """

    def __init__(self, sides: tuple[Side, Side], strength: float, present: Array) -> None:
        self.energies, self.strength = [side.energy for side in sides], strength
        self.gradients = np.array([[side.gradient] for side in sides])
        self.bounds = np.array([energy.domain for energy in self.energies]) + np.array([EDGE, -EDGE])
        self.present, self.size = present, np.abs(present)[:, None]

    def energy(self, p: Array) -> Array:
        """Per volume (n,), at order parameters (2, n)."""
        own = [energy.values(a) for energy, a in zip(self.energies, p, strict=True)]
        return np.asarray(own[0] + own[1] + self.strength * (p[0] * p[1]) ** 2)

    def slopes(self, p: Array) -> Array:
        """Derivatives (2, n) of this."""
        own = [energy.slopes(a) for energy, a in zip(self.energies, p, strict=True)]
        return np.asarray(own + 2 * self.strength * p * p[::-1] ** 2)

    def widths(self) -> Array:
        """Changes (2,) of order parameters over their greatest slopes."""
        starts = ASIDE * self.size + np.diag(self.present)
        unit = float(np.ptp(self.energy(between(starts)))) or 1.0
        wells = np.hstack([self.least(self.well, starts[:, [k]], unit) for k in (0, 1)])
        if np.all(np.abs(np.diff(wells)) < SAME * self.size):
            return np.full(2, np.inf)
        p = wells
        for pieces in PIECES:
            p = between(p, pieces)
            unit = self.action(wells, p[:, 1:-1])[0] or 1.0
            p[:, 1:-1] = self.least(lambda inner: self.action(wells, inner), p[:, 1:-1], unit)
        step, middle = np.diff(p), 0.5 * (p[:, 1:] + p[:, :-1])
        length = np.sqrt((self.gradients * step**2).sum(axis=0))
        slopes = np.abs(step) * np.sqrt(2 * self.above(wells, middle)[0]) / np.fmax(length, 1e-300)
        return np.asarray(np.abs(wells[:, 1] - wells[:, 0]) / slopes.max(axis=1))

    def least(self, measured: Measured, start: Array, unit: float) -> Array:
        """Where something of the size of a unit is least near a start (2, n), by its values and derivatives."""
        from scipy.optimize import minimize

        def scaled(x: Array) -> tuple[float, Array]:
            value, slopes = measured(self.size * x.reshape(start.shape))
            return value / unit, (self.size * slopes).ravel() / unit

        found = minimize(
            scaled,
            (start / self.size).ravel(),
            jac=True,
            bounds=np.repeat(self.bounds / self.size, start.shape[1], axis=0),
            method="L-BFGS-B",
            options={"maxiter": ITERATIONS, "ftol": 1e-12, "gtol": 1e-9},
        )
        return np.asarray(self.size * found.x.reshape(start.shape))

    def well(self, p: Array) -> tuple[float, Array]:
        """The energy of one state (2, 1) and its derivatives."""
        return float(self.energy(p)[0]), self.slopes(p)

    def above(self, wells: Array, p: Array) -> tuple[Array, Array]:
        """Energies above wells, and their derivatives; between wells of which one is deeper these go over smoothly."""
        depth, way = self.energy(wells), np.diff(wells) / self.size
        along = way / self.size / (way**2).sum()
        s = np.clip((along * (p - wells[:, [0]])).sum(axis=0), 0, 1)
        W = self.energy(p) - depth[0] - (depth[1] - depth[0]) * s**2 * (3 - 2 * s)
        slopes = self.slopes(p) - (depth[1] - depth[0]) * 6 * s * (1 - s) * along
        return np.maximum(W, 0.0), np.where(W > 0, slopes, 0.0)

    def action(self, wells: Array, inner: Array) -> tuple[float, Array]:
        """The sum of ``W ds^2`` over pieces of a way, and its derivatives by the states inside."""
        p = np.hstack([wells[:, [0]], inner, wells[:, [1]]])
        W, slopes = self.above(wells, p)
        step, pair = np.diff(p), W[1:] + W[:-1]
        square = (self.gradients * step**2).sum(axis=0)
        pull = 2 * self.gradients * step * pair
        return float(pair @ square), (square[1:] + square[:-1]) * slopes[:, 1:-1] + pull[:, :-1] - pull[:, 1:]
