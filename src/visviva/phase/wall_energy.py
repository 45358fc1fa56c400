"""Energies of walls that interfaces meet at an angle."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from visviva.phase.free_energy import FreeEnergy
from visviva.phase.interface import FINE, Interface, above

Array = NDArray[np.float64]

DEGREE = 4
"""Of what the slope of a wall's energy has beside a factor for each phase: all that the core's polynomials leave."""
CLOSE = 0.005
"""Of the tension, to which energies of walls have to be those of the angle."""
ANYTHING = float(np.finfo(float).max)


class WallEnergy(FreeEnergy):
    """A polynomial between two concentrations, and constant beyond them.

    Parameters
    ----------
    polynomial : Polynomial
        Of the concentration less the centre.
    centre : float
    ends : (float, float)
    """

    def __init__(
        self, polynomial: Polynomial, centre: float, ends: tuple[float, float] = (-ANYTHING, ANYTHING)
    ) -> None:
        self.polynomial, self.centre, self.ends = polynomial, centre, ends

    def constants(self) -> list[float]:
        return [*super().constants(), *self.ends]

    def values(self, c: Array) -> Array:
        return super().values(np.clip(c, *self.ends))

    def slopes(self, c: Array) -> Array:
        return np.where(np.clip(c, *self.ends) == c, super().slopes(c), 0.0)

    def curvatures(self, c: Array) -> Array:
        return np.where(np.clip(c, *self.ends) == c, super().curvatures(c), 0.0)


def wall_at(angle: float, energy: FreeEnergy, found: Interface) -> tuple[WallEnergy, float]:
    """The energy of a wall that the interface of an energy meets at an angle in degrees, and at which it really does.

    With ``f_w' = -cos(angle) sqrt(2 kappa df)`` the interface keeps its profile up to the wall, and phases are stable
    there. The square root is fitted by a polynomial that vanishes at both phases and has the same integral, the
    tension.
    """
    half, cosine = 0.5 * (found.high - found.low), float(np.cos(np.radians(angle)))
    u = -np.cos(np.linspace(0, np.pi, FINE))  # -1 and 1 at the phases
    c = found.low + half * (1 + u)
    root = np.sqrt(np.maximum(above(c, energy.values(c)), 0.0))
    root *= found.tension / np.trapezoid(root, u)
    slope = fitted(u, root, found.tension)
    polynomial = Polynomial((-cosine * slope).integ(lbnd=-1).coef, domain=[-half, half]).convert()
    made = np.clip(made_by(u, root, cosine * slope(u)), -1, 1)
    ends = found.low, found.high
    return WallEnergy(polynomial, found.low + half, ends), float(np.degrees(np.arccos(made)))


def fitted(u: Array, root: Array, tension: float) -> Polynomial:
    """``(1 - u^2) g(u)`` with a polynomial g, nearest to values at u, whose integral from -1 to 1 is the tension."""
    one = Polynomial([1.0, 0.0, -1.0])
    parts = [one * Polynomial.basis(k) for k in range(DEGREE + 1)]
    V, areas = (
        np.stack([part(u) for part in parts], axis=1),
        [part.integ()(1) - part.integ()(-1) for part in parts],
    )
    weights = np.gradient(u)[:, None]
    K = np.block([[V.T @ (weights * V), np.array(areas)[:, None]], [np.array(areas), np.zeros(1)]])
    g = np.linalg.solve(K, [*(V * weights).T @ root, tension])[:-1]
    return one * Polynomial(g)


def made_by(u: Array, root: Array, slope: Array) -> float:
    """The cosine of the angle that a wall makes: each phase has the film there that takes the least energy (Cahn)."""

    def sums(f: Array) -> Array:
        return np.concatenate([[0.0], np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(u))])

    low, high, tension = sums(root - slope), sums(root + slope), sums(root)[-1]
    return float((sums(slope)[-1] + low.min() - (high[-1] - high).min()) / tension)
