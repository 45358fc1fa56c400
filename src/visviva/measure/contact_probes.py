"""Probes of contact: its force, its area, pressures and gaps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.values import Vector3
from visviva.contact.contact import Contact
from visviva.measure.measures import Reading

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class ContactForce(Reading):
    """Probe: force (3,) that a contact exerts on its first body, friction included; the second one feels the opposite.

    It is that of the last step: of the midpoint schemes, what acted in its middle. Zero before the first step.

    Parameters
    ----------
    contact : Contact

    Examples
    --------
    The weight of a block on another one:

    >>> import visviva as vv
    >>> rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    >>> lower = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=rubber)
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().moved((0, 0, 1))
    >>> upper = vv.Solid(mesh=mesh, material=rubber, density=1.0)
    >>> contact = vv.Contact(first=upper, first_faces="z0", second=lower, second_faces="z1")
    >>> guide = vv.Fixed(solid=upper, nodes="z1", directions=(1, 1, 0))
    >>> system = vv.System([lower, upper, contact, vv.Fixed(solid=lower, nodes="z0"), guide, vv.Gravity()])
    >>> result = vv.quasi_static(system, until=1.0, step=1.0)
    >>> float(vv.ContactForce(contact=contact)(system)[2].round(9))
    9.81
    """

    contact: Contact

    def told_by_state(self, system: System) -> bool:
        return False

    @property
    def quantity(self) -> str:
        return "force"

    def __call__(self, system: System) -> Array:
        forces: Array = self.contact.forces.sum(axis=0)
        return forces


@dataclass(config=settings, frozen=True, kw_only=True)
class ContactArea(Reading):
    """Probe: area under pressure (length, in the plane) at the end of the last step.

    It is the sum of the areas that belong to the vertices of the first surface that feel a pressure, as far as the
    second surface faces them, so it goes in steps of about one facet.

    Parameters
    ----------
    contact : Contact
    """

    contact: Contact

    def told_by_state(self, system: System) -> bool:
        return False

    @property
    def quantity(self) -> str:
        return "area"

    def __call__(self, system: System) -> float:
        pressed = self.contact.pressures > 0
        return float(self.contact.term.areas[: len(pressed)][pressed].sum())


@dataclass(config=settings, frozen=True, kw_only=True)
class ContactPressure(Reading):
    """Probe: the largest pressure in the last step, or that of the vertex of the first surface nearest to a place.

    Force by length in plane problems, and force at the points of rigid bodies.

    Parameters
    ----------
    contact : Contact
    at : array (3,), optional
        Place in the reference configuration; in own coordinates of a rigid body.

    Examples
    --------
    A layer that is compressed by a hundredth, E = 100:

    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    >>> layer = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=100.0, poisson=0.0))
    >>> floor = vv.Plane()
    >>> contact = vv.Contact(first=layer, first_faces="z0", second=floor)
    >>> press = vv.Prescribed(solid=layer, nodes="z1", motion=(None, None, "-0.01*t"))
    >>> side = vv.Fixed(solid=layer, nodes="all", directions=(1, 1, 0))
    >>> system = vv.System([layer, floor, contact, press, side])
    >>> result = vv.quasi_static(system, until=1.0, step=1.0)
    >>> round(vv.ContactPressure(contact=contact)(system), 9)
    1.0
    """

    contact: Contact
    at: Vector3 | None = None

    def told_by_state(self, system: System) -> bool:
        return False

    @property
    def quantity(self) -> str:
        return "stress"

    def __call__(self, system: System) -> float:
        values = self.contact.pressures
        chosen = slice(None) if self.at is None else nearest(self.contact, self.at)
        return float(values[chosen].max(initial=0.0))


@dataclass(config=settings, frozen=True, kw_only=True)
class ContactGap(Reading):
    """Probe: the smallest gap at the end of the last step, or that of the vertex nearest to a place.

    A mean over what the vertex sees of the second surface; nan where it sees nothing.

    Parameters
    ----------
    contact : Contact
    at : array (3,), optional
        Place in the reference configuration; in own coordinates of a rigid body.
    """

    contact: Contact
    at: Vector3 | None = None

    def told_by_state(self, system: System) -> bool:
        return False

    @property
    def quantity(self) -> str:
        return "length"

    def __call__(self, system: System) -> float:
        gaps = self.contact.gaps
        if self.at is not None:
            gaps = gaps[nearest(self.contact, self.at)]
        return float(np.nanmin(gaps)) if np.isfinite(gaps).any() else np.nan


def nearest(contact: Contact, place: Array) -> NDArray[np.int64]:
    """The vertex of the first surface nearest to a place in the reference configuration; several at a sharp edge."""
    places = contact.places
    first = np.argmin(np.linalg.norm(places - place, axis=1))
    return np.flatnonzero((places == places[first]).all(axis=1))
