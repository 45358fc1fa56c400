"""Probes of contact: its force and its area."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component import settings
from visviva.contact.contact import Contact
from visviva.measure import Reading

if TYPE_CHECKING:
    from visviva.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class ContactForce(Reading):
    """Probe: force (3,) that a contact exerts on its first body; the second one feels the opposite.

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
    >>> vv.ContactForce(contact=contact)(system).round(9).tolist()
    [0.0, 0.0, 9.81]
    """

    contact: Contact

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

    def __call__(self, system: System) -> float:
        term = self.contact.term
        return float(term.areas[term.pressures > 0].sum())
