"""Homogeneous isotropic cross sections of beams, by their shape."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.section import (
    CONFIG,
    CrossSection,
    Density,
    Factors,
    Length,
    Poisson,
    SectionInertia,
    ellipse,
)

Array = NDArray[np.float64]
Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class Profile(CrossSection):
    """Base of homogeneous isotropic sections: what derives from it gives area, moments, torsion and shear factors.

    Parameters
    ----------
    young, poisson : float
    density : float
        Mass per volume.
    shear_factors : two numbers, optional
        Share of the area that counts in shear along d1 and d2; by default those of Cowper (1966), or of the webs.
    torsion_constant : float, optional
        In place of the section's own.
    retardation : float
        Time whose product with the stiffness is the damping (Kelvin & Voigt).
    """

    young: Length
    poisson: Poisson = 0.0
    density: Density = 0.0
    shear_factors: Factors | None = None
    torsion_constant: Length | None = None
    retardation: Time = 0.0

    @property
    @abstractmethod
    def area(self) -> float:
        """Of the section."""

    @property
    @abstractmethod
    def second_moments(self) -> tuple[float, float]:
        """Integrals of a^2 and b^2; the axes are principal and the centroid is on the line."""

    @abstractmethod
    def torsion(self) -> float:
        """Saint-Venant's constant."""

    @abstractmethod
    def shear(self) -> tuple[float, float]:
        """Factors of the area in shear along d1 and d2."""

    def stiffness_matrix(self) -> Array:
        E, G, A = self.young, self.young / (2 * (1 + self.poisson)), self.area
        aa, bb = self.second_moments
        k1, k2 = self.shear() if self.shear_factors is None else np.array(self.shear_factors)
        J = self.torsion_constant or self.torsion()
        return np.diag([k1 * G * A, k2 * G * A, E * A, E * bb, E * aa, G * J])

    def damping_matrix(self) -> Array:
        return self.retardation * self.stiffness_matrix()

    def inertia(self) -> SectionInertia:
        return SectionInertia(
            self.density * self.area, np.zeros(2), self.density * np.diag(self.second_moments)
        )


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class RectangleSection(Profile):
    """Rectangle of `width` along d1 and `height` along d2.

    Parameters
    ----------
    width, height : float
        Along d1 and d2 (length).
    young : float
        Young's modulus.
    poisson : float
        Poisson's ratio, above -1 and up to 0.5.
    density : float
        Mass per volume.
    shear_factors, torsion_constant, retardation
        See `TubeSection`.

    Examples
    --------
    >>> strip = RectangleSection(width=1.0, height=0.1, young=1.2e6)
    >>> round(float(strip.stiffness_matrix()[3, 3]), 9)
    100.0
    """

    width: Length
    height: Length

    @property
    def area(self) -> float:
        return self.width * self.height

    @property
    def second_moments(self) -> tuple[float, float]:
        return self.area * self.width**2 / 12, self.area * self.height**2 / 12

    def torsion(self) -> float:
        long, short = max(self.width, self.height), min(self.width, self.height)
        n = np.arange(1, 60, 2)
        series = (np.tanh(n * np.pi * long / (2 * short)) / n**5).sum()
        return float(long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series))

    def shear(self) -> tuple[float, float]:
        k = 10 * (1 + self.poisson) / (12 + 11 * self.poisson)
        return k, k

    def contour(self) -> Array:
        return 0.5 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (self.width, self.height)


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class TubeSection(Profile):
    """Ring of outer `radius` and wall `thickness`; without `thickness` the full circle.

    Parameters
    ----------
    radius : float
        Outer one (length).
    thickness : float, optional
        Of the wall (length), at most the radius.
    young : float
        Young's modulus.
    poisson : float
        Poisson's ratio, above -1 and up to 0.5.
    density : float
        Mass per volume.
    shear_factors : two numbers, optional
        Share of the area that counts in shear along d1 and d2; by default those of Cowper (1966), or of the webs.
    torsion_constant : float, optional
        In place of the section's own (length to the fourth).
    retardation : float
        Time whose product with the stiffness is the damping (Kelvin & Voigt).

    Examples
    --------
    >>> rod = TubeSection(radius=0.01, young=210e9, poisson=0.3)
    >>> round(rod.area, 9)
    0.000314159
    """

    radius: Length
    thickness: Length | None = None

    def __post_init__(self) -> None:
        if self.thickness is not None and self.thickness > self.radius:
            raise InputError(
                f"{self.label}: thickness = {self.thickness:g} is more than the radius {self.radius:g}"
            )

    @property
    def _inner(self) -> float:
        return 0.0 if self.thickness is None else self.radius - self.thickness

    @property
    def area(self) -> float:
        return float(np.pi * (self.radius**2 - self._inner**2))

    @property
    def second_moments(self) -> tuple[float, float]:
        half = float(np.pi / 4 * (self.radius**4 - self._inner**4))
        return half, half

    def torsion(self) -> float:
        return sum(self.second_moments)

    def shear(self) -> tuple[float, float]:
        nu, m = self.poisson, self._inner / self.radius
        s = (1 + m * m) ** 2
        k = 6 * (1 + nu) * s / ((7 + 6 * nu) * s + (20 + 12 * nu) * m * m)
        return k, k

    def contour(self) -> Array:
        return ellipse(self.radius, self.radius)

    @property
    def round(self) -> float | None:
        return self.radius


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class BoxSection(Profile):
    """Hollow rectangle of outer `width` along d1 and `height` along d2 with thin walls of one `thickness`.

    Torsion after Bredt; the two webs along a direction take the shear in it.

    Parameters
    ----------
    width, height : float
        Outer ones along d1 and d2 (length).
    thickness : float
        Of the walls (length), less than half of the width and the height.
    young, poisson, density, shear_factors, torsion_constant, retardation
        See `TubeSection`.
    """

    width: Length
    height: Length
    thickness: Length

    def __post_init__(self) -> None:
        refuse_thick(self.label, self.thickness, self.width, self.height)

    @property
    def _hole(self) -> tuple[float, float]:
        return self.width - 2 * self.thickness, self.height - 2 * self.thickness

    @property
    def area(self) -> float:
        w, h = self._hole
        return self.width * self.height - w * h

    @property
    def second_moments(self) -> tuple[float, float]:
        (W, H), (w, h) = (self.width, self.height), self._hole
        return (H * W**3 - h * w**3) / 12, (W * H**3 - w * h**3) / 12

    def torsion(self) -> float:
        w, h, t = self.width - self.thickness, self.height - self.thickness, self.thickness
        return 2 * t * (w * h) ** 2 / (w + h)

    def shear(self) -> tuple[float, float]:
        web = 2 * self.thickness / self.area
        return web * (self.width - self.thickness), web * (self.height - self.thickness)

    def contour(self) -> Array:
        return 0.5 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (self.width, self.height)


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class ISection(Profile):
    """Two equal flanges of `width` along d1 and a web between them, `height` over all along d2.

    Torsion without warping, the sum of ``b t^3 / 3``: open thin-walled sections that are kept from warping are stiffer.

    Parameters
    ----------
    width : float
        Of the flanges along d1 (length).
    height : float
        Over all along d2 (length).
    flange : float
        Thickness of the flanges (length), less than half of the height.
    web : float
        Thickness of the web (length), at most the width.
    young, poisson, density, shear_factors, torsion_constant, retardation
        See `TubeSection`.
    """

    width: Length
    height: Length
    flange: Length
    web: Length

    def __post_init__(self) -> None:
        refuse_thick(self.label, self.flange, self.height, self.height)
        if self.web > self.width:
            raise InputError(f"{self.label}: web = {self.web:g} is wider than its flanges {self.width:g}")
        warping = self.flange * self.width**3 * (self.height - self.flange) ** 2 / 24
        length = np.sqrt(2 * (1 + self.poisson) * warping / (self.torsion_constant or self.torsion()))
        tell_of_warping(self.label, float(length), max(self.width, self.height))

    @property
    def _between(self) -> float:
        return self.height - 2 * self.flange

    @property
    def area(self) -> float:
        return 2 * self.width * self.flange + self._between * self.web

    @property
    def second_moments(self) -> tuple[float, float]:
        W, H, h = self.width, self.height, self._between
        return (2 * self.flange * W**3 + h * self.web**3) / 12, (W * H**3 - (W - self.web) * h**3) / 12

    def torsion(self) -> float:
        return (2 * self.width * self.flange**3 + (self.height - self.flange) * self.web**3) / 3

    def shear(self) -> tuple[float, float]:
        flanges = 5 / 6 * 2 * self.width * self.flange
        return flanges / self.area, self.web * (self.height - self.flange) / self.area

    def contour(self) -> Array:
        W, H, w, h = self.width / 2, self.height / 2, self.web / 2, self._between / 2
        right = [(W, -H), (W, -h), (w, -h), (w, h), (W, h), (W, H)]
        return np.array(right + [(-a, -b) for a, b in right])


def tell_of_warping(label: str, length: float, size: float) -> None:
    """Warn of sections that warp so much in torsion that it matters where that is held."""
    if length > 1.5 * size:
        warnings.warn(
            f"{label}: an open thin-walled section. Warping is no unknown: within about {length:.3g} of places that "
            "hold it, such as clamped ends, the beam is stiffer in torsion than computed",
            stacklevel=2,
        )


def refuse_thick(label: str, thickness: float, *sizes: float) -> None:
    """Refuse walls that leave no hole."""
    if 2 * thickness >= min(sizes):
        raise InputError(f"{label}: walls of {thickness:g} leave nothing of {min(sizes):g} between them")
