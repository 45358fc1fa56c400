"""Sections of shells: stiffness against eight strains, and mass.

The order of strains is membrane 11, 22, 2 x 12, change of curvature 11, 22, 2 x 12, shear 1, 2, along the directions 1
and 2 of the section in the tangent plane. Heights are along the director, from the mesh.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, FiniteFloat
from pydantic.dataclasses import dataclass

from visviva.base.arguments import Validated
from visviva.base.errors import InputError
from visviva.body.section import Density, Length, Poisson, Section

Array = NDArray[np.float64]
CONFIG = ConfigDict(extra="forbid", defer_build=True)
Factor = Annotated[float, Field(gt=0, le=1)]


class ShellInertia(NamedTuple):
    """Integrals over the thickness of the density times 1, the height, and its square."""

    mass: float
    first: float
    second: float


class ShellSection(Section):
    """Interface of the section of a shell."""

    @abstractmethod
    def stiffness_matrix(self) -> Array:
        """Forces, moments and shear forces (8, 8) per length and strain."""

    @abstractmethod
    def inertia(self) -> ShellInertia:
        """Mass per area and its moments."""

    @property
    @abstractmethod
    def heights(self) -> tuple[float, float]:
        """Of the lower and the upper face."""

    def sheets(self) -> tuple[Sheet, ...]:
        """Layers from the lower to the upper face, for their stresses; none if it has no such."""
        return ()


class Sheet(NamedTuple):
    """A layer in plane stress: heights of its faces, and its moduli (3, 3) along the directions of the shell."""

    lower: float
    upper: float
    moduli: Array


class Layer(metaclass=Validated):
    """Layer of a shell between two heights."""


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class Ply(Layer):
    """A layer of one orthotropic material, in plane stress.

    Parameters
    ----------
    thickness : float
    young, across : float
        Young's moduli along the fibres and, in the plane, across them; `across` is that along them if not given.
    poisson : float
        Contraction across for a pull along the fibres.
    shear : float, optional
        In the plane; by default that of an isotropic material.
    shear_1, shear_2 : float, optional
        Across the thickness, along and across the fibres; by default `shear`.
    angle : float
        From direction 1 of the shell to the fibres, about the director, in degrees.
    density : float
        Mass per volume.
    """

    thickness: Length
    young: Length
    across: Length | None = None
    poisson: Poisson = 0.0
    shear: Length | None = None
    shear_1: Length | None = None
    shear_2: Length | None = None
    angle: FiniteFloat = 0.0
    density: Density = 0.0

    def __post_init__(self) -> None:
        if self.poisson**2 * (self.across or self.young) >= self.young:
            raise InputError(
                f"Ply: poisson = {self.poisson:g} is too large for young = {self.young:g} and across: its energy "
                "would not be positive"
            )

    def plane(self) -> Array:
        """Moduli (3, 3) of plane stress along the directions of the shell."""
        E1, E2, nu = self.young, self.across or self.young, self.poisson
        G = self.shear or self.young / (2 * (1 + nu))
        Q = np.zeros((3, 3))
        Q[:2, :2] = np.array([(E1, nu * E2), (nu * E2, E2)]) / (1 - nu**2 * E2 / E1)
        Q[2, 2] = G
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        T = np.array([(c * c, s * s, c * s), (s * s, c * c, -c * s), (-2 * c * s, 2 * c * s, c * c - s * s)])
        turned: Array = T.T @ Q @ T
        return turned

    def across_thickness(self) -> Array:
        """Shear moduli (2, 2) along the directions of the shell."""
        G = self.shear or self.young / (2 * (1 + self.poisson))
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        R = np.array([(c, s), (-s, c)])
        turned: Array = R.T @ np.diag([self.shear_1 or G, self.shear_2 or G]) @ R
        return turned


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class Laminate(ShellSection):
    """Plies from the lower to the upper face; what is bent shears and stretches if they are not symmetric.

    Parameters
    ----------
    plies : sequence of Ply
    offset : float
        Height of the middle above the mesh.
    shear_factor : float

    Examples
    --------
    >>> ply = Ply(thickness=1.0, young=2068.5, across=517.125, poisson=0.3, shear=795.6)
    >>> turned = Ply(thickness=1.0, young=2068.5, across=517.125, poisson=0.3, shear=795.6, angle=90)
    >>> laminate = Laminate(plies=(ply, turned, ply))
    >>> laminate.stiffness_matrix().shape, laminate.heights
    ((8, 8), (-1.5, 1.5))
    """

    plies: tuple[Ply, ...]
    offset: FiniteFloat = 0.0
    shear_factor: Factor = 5 / 6

    def __post_init__(self) -> None:
        if not self.plies:
            raise InputError("Laminate: it needs a ply at least")

    @property
    def heights(self) -> tuple[float, float]:
        half = sum(ply.thickness for ply in self.plies) / 2
        return self.offset - half, self.offset + half

    def sheets(self) -> tuple[Sheet, ...]:
        z = self.heights[0] + np.concatenate([[0.0], np.cumsum([ply.thickness for ply in self.plies])])
        return tuple(Sheet(z[k], z[k + 1], ply.plane()) for k, ply in enumerate(self.plies))

    def stiffness_matrix(self) -> Array:
        C = np.zeros((8, 8))
        for ply, (z, top, Q) in zip(self.plies, self.sheets(), strict=True):
            C[:3, :3] += Q * ply.thickness
            C[:3, 3:6] += Q * (top**2 - z**2) / 2
            C[3:6, 3:6] += Q * (top**3 - z**3) / 3
            C[6:, 6:] += self.shear_factor * ply.thickness * ply.across_thickness()
        C[3:6, :3] = C[:3, 3:6].T
        return C

    def inertia(self) -> ShellInertia:
        total, z = np.zeros(3), self.heights[0]
        for ply in self.plies:
            top = z + ply.thickness
            total += ply.density * np.array([top - z, (top**2 - z**2) / 2, (top**3 - z**3) / 3])
            z = top
        return ShellInertia(*total.tolist())


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class HomogeneousSection(ShellSection):
    """One isotropic material.

    Parameters
    ----------
    thickness : float
    young, poisson : float
    density : float
        Mass per volume.
    offset : float
        Height of the middle above the mesh.
    shear_factor : float

    Examples
    --------
    >>> sheet = HomogeneousSection(thickness=0.1, young=1.2e6)
    >>> round(float(sheet.stiffness_matrix()[3, 3]), 9)
    100.0
    """

    thickness: Length
    young: Length
    poisson: Poisson = 0.0
    density: Density = 0.0
    offset: FiniteFloat = 0.0
    shear_factor: Factor = 5 / 6

    @property
    def _laminate(self) -> Laminate:
        ply = Ply(thickness=self.thickness, young=self.young, poisson=self.poisson, density=self.density)
        return Laminate(plies=(ply,), offset=self.offset, shear_factor=self.shear_factor)

    @property
    def heights(self) -> tuple[float, float]:
        return self._laminate.heights

    def sheets(self) -> tuple[Sheet, ...]:
        return self._laminate.sheets()

    def stiffness_matrix(self) -> Array:
        return self._laminate.stiffness_matrix()

    def inertia(self) -> ShellInertia:
        return self._laminate.inertia()
