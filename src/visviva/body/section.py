"""Cross sections of beams: stiffness against six strains, mass and its moments, and what is drawn of them.

Coordinates ``(a, b)`` are along the directors d1 and d2, from the line of the beam. The order of strains is shear
along d1 and d2, extension, bending about d1 and d2, torsion.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import ConfigDict, Field, FiniteFloat, GetPydanticSchema
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED, Validated
from visviva.base.errors import InputError, RunError
from visviva.component.component import settings
from visviva.component.values import Function as Called
from visviva.model.callback import Function

Array = NDArray[np.float64]
CONFIG = ConfigDict(extra="forbid", defer_build=True)
AROUND = 24
"""Corners of the polygon that is drawn of a circle."""


def as_data(kind: Any) -> Any:
    """Annotation of numbers that are array-like for the caller, validated and kept as tuples."""
    inner = Annotated[kind, LISTED]
    return GetPydanticSchema(lambda _, schema_of: schema_of(inner))


Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Poisson = Annotated[float, Field(gt=-1, le=0.5)]
Density = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Six = Annotated[
    tuple[FiniteFloat, ...] | tuple[tuple[FiniteFloat, ...], ...], Field(min_length=6, max_length=6)
]
Stiffness = Annotated[ArrayLike, as_data(Six)]
Pair = Annotated[ArrayLike, as_data(tuple[FiniteFloat, FiniteFloat])]
Three = Annotated[ArrayLike, as_data(tuple[FiniteFloat, FiniteFloat, FiniteFloat])]
Outline = Annotated[ArrayLike, as_data(tuple[tuple[FiniteFloat, FiniteFloat], ...])]
Factors = Annotated[ArrayLike, as_data(tuple[Length, Length])]


class SectionInertia(NamedTuple):
    """Mass per length, its centre (2,), and its second moments (2, 2) about the line of the beam."""

    mass: float
    centre: Array
    moments: Array


class Section(metaclass=Validated):
    """Base of sections of beams and shells."""

    @property
    def label(self) -> str:
        """Name used in messages."""
        return type(self).__name__


class CrossSection(Section):
    """Interface of the cross section of a beam."""

    @abstractmethod
    def stiffness_matrix(self) -> Array:
        """Forces and moments (6, 6) per strain."""

    @abstractmethod
    def inertia(self) -> SectionInertia:
        """Mass per length with its centre and second moments."""

    def damping_matrix(self) -> Array:
        """Forces and moments (6, 6) per rate of the strains."""
        return np.zeros((6, 6))

    def energy_function(self) -> Function | None:
        """The energy of the strains, if stiffness is not all of it."""
        return None

    @abstractmethod
    def contour(self) -> Array:
        """Polygon (n, 2) that is drawn, anticlockwise."""

    @property
    def round(self) -> float | None:
        """Radius of what is round about the line of the beam, by which it touches others."""
        return None


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class GivenSection(CrossSection):
    """A section by its numbers, as measured or computed elsewhere: composite blades, rolled profiles.

    Parameters
    ----------
    stiffness : six numbers, or (6, 6)
        Against shear along d1 and d2, extension, bending about d1 and d2, and torsion: GA1, GA2, EA, EI1, EI2, GJ; or
        the symmetric matrix with what couples them, such as an offset of the shear centre.
    mass : float
        Per length.
    centre : two numbers
        Centre of mass along d1 and d2.
    moments : three numbers
        Mass per length times the mean of a^2, b^2 and a b, about the centre of mass.
    outline : (n, 2), optional
        Polygon for pictures; by default an ellipse of the section's radii of gyration.
    outside : float, optional
        Radius of a round bar or rope, for pictures and contact.
    damping : six numbers, or (6, 6)
        Forces and moments per rate of the strains (Kelvin & Voigt).

    Examples
    --------
    >>> bar = GivenSection(stiffness=(1e4, 1e4, 1e4, 500, 500, 500), mass=1.0, moments=(10, 10, 0))
    >>> bar.stiffness_matrix().diagonal().tolist()
    [10000.0, 10000.0, 10000.0, 500.0, 500.0, 500.0]
    """

    stiffness: Stiffness
    mass: Density = 0.0
    centre: Pair = (0.0, 0.0)
    moments: Three = (0.0, 0.0, 0.0)
    outline: Outline | None = None
    outside: Length | None = None
    damping: Stiffness = (0.0,) * 6

    @property
    def round(self) -> float | None:
        return self.outside

    def __post_init__(self) -> None:
        C = self.stiffness_matrix()
        refuse_unsymmetric(self.label, "stiffness", C)
        d = np.sqrt(np.maximum(C.diagonal(), 0.0))
        if not np.all(d > 0) or np.linalg.eigvalsh(C / np.outer(d, d)).min() <= 1e-14:
            raise InputError(
                f"{self.label}: stiffness {C.diagonal().tolist()} is not positive against every strain; for a section "
                "that does not shear or stretch tell the beam: rigid=('shear', 'stretch')"
            )
        D = self.damping_matrix()
        refuse_unsymmetric(self.label, "damping", D)
        if np.linalg.eigvalsh(D / np.outer(d, d)).min() < -1e-12 * np.abs(D / np.outer(d, d)).max():
            raise InputError(f"{self.label}: damping {D.diagonal().tolist()} gives energy to some motion")
        about = np.linalg.eigvalsh(self._about_centre())
        if about.min() < -1e-12 * max(about.max(), 0.0) or (about.max() > 0 and self.mass == 0):
            raise InputError(f"{self.label}: moments {self.moments} belong to no distribution of its mass")
        if self.outline is not None and len(self.contour()) < 3:
            raise InputError(f"{self.label}: an outline needs three points or more")

    def stiffness_matrix(self) -> Array:
        return as_matrix(self.stiffness)

    def damping_matrix(self) -> Array:
        return as_matrix(self.damping)

    def _about_centre(self) -> Array:
        aa, bb, ab = np.array(self.moments)
        return np.array([(aa, ab), (ab, bb)])

    def inertia(self) -> SectionInertia:
        c = np.array(self.centre)
        return SectionInertia(self.mass, c, self._about_centre() + self.mass * np.outer(c, c))

    def contour(self) -> Array:
        if self.outline is not None:
            return np.array(self.outline)
        if self.outside is not None:
            return ellipse(self.outside, self.outside)
        C = self.stiffness_matrix().diagonal()
        return ellipse(2 * np.sqrt(C[4] / C[2]), 2 * np.sqrt(C[3] / C[2]))


@dataclass(frozen=True, config=settings, kw_only=True)
class UserSection(CrossSection):
    """A section whose energy is a function of the user.

    Parameters
    ----------
    energy : callable
        Maps strains (6, n), in the order of sections, to energies (n,) per length, at rest without strains. Written
        with numpy functions that take complex numbers, first derivatives are exact to round-off.
    section : CrossSection
        What gives inertia, damping and what is drawn; its stiffness is not used.

    Examples
    --------
    A rod that stiffens as it is stretched:

    >>> rod = GivenSection(stiffness=(1e4, 1e4, 1e4, 500, 500, 500), mass=1.0)
    >>> C = rod.stiffness_matrix().diagonal()
    >>> stiff = UserSection(section=rod, energy=lambda e: 0.5 * (C @ e**2) * (1 + 10 * e[2] ** 2))
    >>> stiff.stiffness_matrix().diagonal().round(6).tolist()
    [10000.0, 10000.0, 10000.0, 500.0, 500.0, 500.0]
    """

    energy: Called
    section: CrossSection

    def __post_init__(self) -> None:
        try:
            C, rest = self.stiffness_matrix(), self.energy_function().gradient(np.zeros((6, 1)))[0, :, 0]
        except RunError as error:
            raise InputError(str(error)) from error
        d = np.sqrt(np.maximum(C.diagonal(), 0.0))
        if not np.all(d > 0):
            raise InputError(
                f"{self.label}: the second derivatives {C.diagonal().tolist()} of its energy at rest are not positive"
            )
        if np.abs(rest / d).max() > 1e-6 * d.max():
            raise InputError(
                f"{self.label}: its energy has the forces and moments {rest.tolist()} without strains; take them off, "
                "and load the beam by them"
            )

    def energy_function(self) -> Function:
        return Function(self.energy, 6, 1, f"{self.label}, its energy")

    def stiffness_matrix(self) -> Array:
        """At rest."""
        return np.asarray(self.energy_function().hessian(np.zeros((6, 1)))[0, :, :, 0])

    def damping_matrix(self) -> Array:
        return self.section.damping_matrix()

    def inertia(self) -> SectionInertia:
        return self.section.inertia()

    def contour(self) -> Array:
        return self.section.contour()

    @property
    def round(self) -> float | None:
        return self.section.round


def as_matrix(given: Any) -> Array:
    """Six numbers, or (6, 6), as a matrix."""
    C = np.array(given, dtype=float)
    return np.diag(C) if C.ndim == 1 else C


def refuse_unsymmetric(label: str, what: str, C: Array) -> None:
    """Refuse what is no symmetric matrix (6, 6)."""
    if C.shape != (6, 6):
        raise InputError(f"{label}: {what} needs 6 numbers or 6 rows of 6, not shape {C.shape}")
    if np.abs(C - C.T).max() > 1e-12 * np.abs(C).max():
        raise InputError(f"{label}: the matrix of {what} is not symmetric: no energy belongs to it")


def ellipse(a: float, b: float) -> Array:
    """Polygon (n, 2) of an ellipse."""
    at = 2 * np.pi * np.arange(AROUND) / AROUND
    return np.stack([a * np.cos(at), b * np.sin(at)], axis=1)
