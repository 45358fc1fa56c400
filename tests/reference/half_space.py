"""Contacts on elastic half-spaces and half-planes in closed form: pressures, and displacements everywhere.

The material lies where the last coordinate is positive; loads act on its surface, along that coordinate, into the
material. Displacements are those of point and line forces (Boussinesq; Flamant; both after Johnson, Contact
Mechanics, 1985, sections 2.2 and 3.2), summed over the pressures of the contact with Gauss points that follow
their square roots.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def of_point_force(X: Array, young: float, poisson: float) -> Array:
    """Displacements (n, 3) at places (n, 3) relative to a unit force."""
    shear = young / 2 / (1 + poisson)
    rho, z = np.linalg.norm(X, axis=1), X[:, 2]
    across = z / rho**3 - (1 - 2 * poisson) / (rho * (rho + z))
    along = z**2 / rho**3 + 2 * (1 - poisson) / rho
    u = np.column_stack([across * X[:, 0], across * X[:, 1], along])
    return np.asarray(u / (4 * np.pi * shear))


def of_line_force(X: Array, young: float, poisson: float) -> Array:
    """Displacements (n, 2) in plane strain at places (n, 2) relative to a unit force by length."""
    r, angle = np.hypot(*X.T), np.arctan2(X[:, 0], X[:, 1])
    stiff, mixed = 2 * (1 - poisson**2), (1 - 2 * poisson) * (1 + poisson)
    radial = -stiff * np.cos(angle) * np.log(r) - mixed * angle * np.sin(angle)
    around = (
        (stiff * np.log(r) + 2 * poisson * (1 + poisson) + mixed) * np.sin(angle)
        - mixed * angle * np.cos(angle)
    )  # fmt: skip
    directions = np.sin(angle), np.cos(angle)
    u = np.column_stack(
        [radial * directions[0] + around * directions[1], radial * directions[1] - around * directions[0]]
    )
    return np.asarray(u / (np.pi * young))


@dataclass(frozen=True)
class Sphere:
    """A rigid sphere pressed into a half-space (Hertz): a^2 = R d, F = 4/3 E* sqrt(R) d^1.5."""

    radius: float
    depth: float
    young: float
    poisson: float

    @property
    def half_width(self) -> float:
        return float(np.sqrt(self.radius * self.depth))

    @property
    def force(self) -> float:
        return 4 / 3 * self.young / (1 - self.poisson**2) * np.sqrt(self.radius) * self.depth**1.5

    def pressure(self, r: Array) -> Array:
        largest = 1.5 * self.force / (np.pi * self.half_width**2)
        return np.asarray(largest * np.sqrt(np.clip(1 - (r / self.half_width) ** 2, 0, None)))

    def displacement(self, X: Array) -> Array:
        """Displacements (n, 3) at places (n, 3) off the contact, at rest far away."""
        t, weight = np.polynomial.legendre.leggauss(8)
        t, weight = 0.5 * (1 + t), 1.5 * (0.5 * (1 + t)) ** 2 * weight  # p dA = 3 F t^2 dt dphi / 2 pi
        total = np.zeros_like(X)
        for s, w in zip(self.half_width * np.sqrt(1 - t**2), weight, strict=True):
            for phi in 2 * np.pi * np.arange(24) / 24:
                place = s * np.array([np.cos(phi), np.sin(phi), 0.0])
                total += w / 24 * of_point_force(X - place, self.young, self.poisson)
        return self.force * total


@dataclass(frozen=True)
class FlatPunch:
    """A rigid flat punch of half width a on a half-plane: p = P / (pi sqrt(a^2 - x^2))."""

    half_width: float
    force: float
    young: float
    poisson: float

    def pressure(self, x: Array) -> Array:
        return np.asarray(self.force / (np.pi * np.sqrt(self.half_width**2 - x**2)))

    @property
    def depth(self) -> float:
        """Displacement under the punch, of the same field."""
        nu = self.poisson
        level = 2 * (1 - nu**2) * np.log(self.half_width / 2) + 1 + nu
        return float(-self.force * level / (np.pi * self.young))

    def displacement(self, X: Array) -> Array:
        """Displacements (n, 2) at places (n, 2) off the punch."""
        n = 40
        places = self.half_width * np.cos(np.pi * (np.arange(n) + 0.5) / n)
        total = sum(of_line_force(X - [s, 0.0], self.young, self.poisson) for s in places)
        return np.asarray(self.force / n * total)
