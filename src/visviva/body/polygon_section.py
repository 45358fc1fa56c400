"""Sections of any polygon with holes, whose warping function is computed by the package sectionproperties."""

from __future__ import annotations

import warnings
from functools import cached_property
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, FiniteFloat
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.profiles import Time, tell_of_warping
from visviva.body.section import (
    CONFIG,
    CrossSection,
    Density,
    Length,
    Outline,
    Poisson,
    SectionInertia,
    as_data,
)

Array = NDArray[np.float64]
Places = tuple[tuple[FiniteFloat, FiniteFloat], ...]
Holes = Annotated[ArrayLike, as_data(tuple[Places, ...])]
Count = Annotated[int, Field(ge=20)]


class Constants(NamedTuple):
    """Of a section of unit modulus: about the line of the beam, but for those of warping.

    Attributes
    ----------
    area, torsion : float
    warping : float
        Vlasov's constant about the shear centre.
    first : array, (2,)
        Integrals of a and b.
    second : array, (2, 2)
        Integrals of a^2, a b, b^2.
    shear_centre : array, (2,)
    shear : array, (2, 2)
        Effective areas in shear along d1 and d2.
    """

    area: float
    torsion: float
    warping: float
    first: Array
    second: Array
    shear_centre: Array
    shear: Array


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class PolygonSection(CrossSection):
    """A homogeneous isotropic section of any outline, with holes.

    Parameters
    ----------
    outline : (n, 2)
        Corners along d1 and d2, from the line of the beam, in their order around.
    holes : sequence of (n, 2)
        Of corners likewise.
    young, poisson : float
    density : float
        Mass per volume.
    retardation : float
        Time whose product with the stiffness is the damping (Kelvin & Voigt).
    triangles : int
        About how many triangles, of second order, warping is computed with.

    Raises
    ------
    InputError
        If the polygon crosses itself, a hole is not in it, or sectionproperties is not installed.

    Notes
    -----
    Saint-Venant's torsion constant, the shear centre and the effective areas in shear follow from the warping functions
    of torsion and shear (Pilkey 2002), by finite elements of the package sectionproperties,
    ``pip install "visviva[sections]"``. Centroid and shear centre may be off the line: stiffness and inertia then
    couple what they must. Warping is no unknown of the beam. Where it is considerable, as of open thin-walled sections,
    a warning tells along which length about places that hold it the beam is stiffer in torsion than computed.

    Examples
    --------
    >>> square = PolygonSection(outline=[(0, 0), (1, 0), (1, 1), (0, 1)], young=3.0)  # the line is at a corner
    >>> C = square.stiffness_matrix()
    >>> C[2:4, 2:4].round(9).tolist(), round(float(C[5, 5] - 0.25 * (C[0, 0] + C[1, 1])), 3)
    ([[3.0, 1.5], [1.5, 1.0]], 0.211)
    """

    outline: Outline
    young: Length
    holes: Holes = ()
    poisson: Poisson = 0.0
    density: Density = 0.0
    retardation: Time = 0.0
    triangles: Count = 600

    def __post_init__(self) -> None:
        self._polygon()
        c = self.constants
        length = np.sqrt(2 * (1 + self.poisson) * c.warping / c.torsion)
        tell_of_warping(self.label, float(length), float(np.ptp(self.contour(), axis=0).max()))

    def _polygon(self) -> Any:
        try:
            import sectionproperties  # noqa: F401
            from shapely import Polygon
        except ImportError as error:
            raise InputError(
                f'{self.label} needs the package sectionproperties: pip install "visviva[sections]"'
            ) from error
        if len(self.contour()) < 3 or min(map(len, self._holes), default=3) < 3:
            raise InputError(f"{self.label}: a polygon needs three corners or more")
        found = Polygon(self.contour(), self._holes)
        if not found.is_valid or not found.area > 0:
            raise InputError(
                f"{self.label}: its outline {self.contour().tolist()} crosses itself, or a hole is not within it"
            )
        return found

    @property
    def _holes(self) -> list[Array]:
        return [np.array(hole, dtype=float) for hole in np.asarray(self.holes, dtype=object)]

    @cached_property
    def constants(self) -> Constants:
        """Of the shape."""
        from sectionproperties.analysis.section import Section
        from sectionproperties.pre.geometry import Geometry
        from sectionproperties.pre.pre import Material

        polygon = self._polygon()
        unit = Material("unit", 1.0, self.poisson, 1.0, 1.0, "w")
        shape = Geometry(polygon, material=unit)
        shape.create_mesh(mesh_sizes=[polygon.area / self.triangles])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of meshes that it finds coarse
            section = Section(shape)
            section.calculate_geometric_properties()
            section.calculate_warping_properties()
        found: Any = section.section_props
        A, c = float(section.get_ea()), np.array([found.cx, found.cy])
        bb, aa, ab = section.get_eic()
        flexibility = np.array([[1 / found.a_sx, 1 / found.a_sxy], [1 / found.a_sxy, 1 / found.a_sy]])
        return Constants(
            area=A,
            torsion=float(section.get_ej()),
            warping=float(section.get_egamma()),
            first=A * c,
            second=np.array([(aa, ab), (ab, bb)]) + A * np.outer(c, c),
            shear_centre=np.array(section.get_sc(), dtype=float),
            shear=np.linalg.inv(flexibility),
        )

    def stiffness_matrix(self) -> Array:
        c, G = self.constants, self.young / (2 * (1 + self.poisson))
        (Sa, Sb), ((aa, ab), (_, bb)) = c.first, c.second
        C = np.zeros((6, 6))
        C[2:5, 2:5] = self.young * np.array([(c.area, Sb, -Sa), (Sb, bb, -ab), (-Sa, -ab, aa)])
        a, b = c.shear_centre
        at_centre = np.array([(1.0, 0.0, -b), (0.0, 1.0, a)])  # shear there of shear and twist of the line
        C[np.ix_([0, 1, 5], [0, 1, 5])] = G * at_centre.T @ c.shear @ at_centre
        C[5, 5] += G * c.torsion
        return C

    def damping_matrix(self) -> Array:
        return self.retardation * self.stiffness_matrix()

    def inertia(self) -> SectionInertia:
        c = self.constants
        return SectionInertia(self.density * c.area, c.first / c.area, self.density * c.second)

    def contour(self) -> Array:
        return np.array(self.outline, dtype=float)
