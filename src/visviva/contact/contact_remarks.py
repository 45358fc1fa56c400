"""Remarks on the limits of a contact, printed by the check before the first step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from visviva.component.announcements import Conducting
from visviva.contact.contact_surface import mesh_bodies
from visviva.contact.creases import bluntest
from visviva.contact.sinking import remark
from visviva.contact.spin import least_torque

if TYPE_CHECKING:
    from visviva.contact.contact import Contact
    from visviva.contact.contact_surface import Surface
    from visviva.model.model import Model

SPREAD = "concentration", "damage"
"""Fields of bodies that spread from node to node."""
FELT = 5.0
"""Degrees of an edge below which half of it, by which friction acts askew, does not matter."""
TORQUE = 0.95
"""Part of the torque of friction as a face spins from which on what it lacks does not matter."""
DETERMINED = 3
"""So many pressures of a rigid body on a plane follow from its equilibrium."""


def remarks_of(contact: Contact, surface: Surface) -> list[str]:
    """Sentences about a contact whose first surface is this one."""
    label, first = contact.label, contact.first.label
    rigid = contact.enforcement == "multipliers" and not mesh_bodies(contact.first, contact.second)
    found = insulated(label, contact.conducts, contact.first, contact.second) + remark(contact)
    if contact.friction > 0 and (edge := bluntest(surface)) > FELT:
        found.append(
            f"{label}: edges of {first} of up to {edge:.0f} degrees count as round, so that friction beside them acts "
            f"up to {edge / 2:.0f} degrees askew; finer facets of what is round cure that, and for what is angular a "
            "contact of its own for each face, by its name"
        )
    if contact.friction > 0 and not mesh_bodies(contact.first) and (part := least_torque(surface)) < TORQUE:
        found.append(
            f"{label}: friction feels the mean slip near each vertex, so that a face of {first} that spins where it "
            f"lies is braked by {part:.2f} of the torque of its pressure; finer facets, of a vv.SurfaceMesh, cure that"
        )
    if rigid and len(surface.forms) > DETERMINED * surface.copies:
        found.append(
            f"{label}: where more than three vertices of {first} press, pressures, tractions and forces at single ones "
            "are not determined; pressures are taken as even as their sum and its torque allow, and with them the "
            "torque of friction on what spins"
        )
    if contact.collides and contact.impact == "dissipative" and not contact.restitution:
        found.append(
            f"{label}: an impact leaves {first} overlapping by up to one and a half of the way of a step, with no "
            "force once nothing presses; shorter or adaptive steps leave less, and enforcement='penalty' parts them"
        )
    if contact.friction > 0 and contact.collides and contact.tangential == "penalty":
        found.append(
            f"{label}: elastic slip has no time to rub in an impact by multipliers; steps in which that would be felt "
            "are refused. Take tangential='multipliers', or enforcement='penalty'"
        )
    return found


def insulated(label: str, conducts: bool, *bodies: Any) -> list[str]:
    """Remark that no heat passes, if more than one of the bodies carries it and nothing `conducts`."""
    carriers = [body.label for body in bodies if body is not None and body.carries_heat]
    if len(carriers) < 2 or conducts:
        return []
    return [
        f"{label}: no heat passes between {' and '.join(carriers)}, which are insulated from each other there; give "
        "them a vv.HeatTie or a vv.HeatContact"
    ]


def parted(label: str, model: Model, first: Any, second: Any) -> list[str]:
    """Remark that what spreads in both bodies ends at a tie."""
    names = [{f.name for f in model.fields if f.component is body} for body in (first, second)]
    return [
        f"{label}: the {name}s of {first.label} and {second.label} know nothing of each other, it passes on positions "
        "alone; make them one body, on meshes welded by Mesh.merged"
        for name in SPREAD
        if all(name in own for own in names)
    ]


def conducted(model: Model, first: Any, second: Any) -> bool:
    """True if some component conducts heat between the two bodies."""
    about = [body for body in (first, second) if body is not None]
    return any(c.joins(first, second) for body in about for c in model.announced(body, Conducting))
