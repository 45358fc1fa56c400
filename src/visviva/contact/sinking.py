"""Bodies that sink into each other where their gaps do not see it: steps in which they do fail."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from visviva import _core
from visviva.body.rigid import RigidBody
from visviva.body.solid import Solid
from visviva.component.point import Attachable
from visviva.contact.contact_surface import Surface, mesh_bodies, of_vectors, skin, surface_of
from visviva.contact.obstacle import Obstacle

if TYPE_CHECKING:
    from visviva.contact.contact import Contact

UNSEEN = 0.01
"""Part of the least width of both bodies by which edges may be in the other one deeper than twice what gaps see."""

FLEXIBLE = 40
"""How many times as deep solids are watched: vertices that slide over edges of theirs within a step sink that far."""
AVERAGED = 10
"""The same by mortar."""
THINNEST = 0.01
"""Part of a surface, such as facets at the tip of a cone, behind which a body may be thinner than its least width."""

Second = RigidBody | Obstacle | Solid
Pairing = tuple[RigidBody, RigidBody | Obstacle]


def watched(contact: Contact) -> Pairing | None:
    """Both sides, if they are rigid and have edges, corners or faces that gaps of the first one do not see."""
    first, second = contact.first, contact.second
    if not isinstance(first, RigidBody) or first.shape is None:
        return None
    if len(first.shape.feelers[0]) == 1 and not contact.is_mortar:  # balls are exact
        return None
    if isinstance(second, RigidBody):
        return None if second.shape is None else (first, second)
    return (first, second) if isinstance(second, Obstacle) else None


def with_solid(contact: Contact) -> tuple[Solid | RigidBody, Solid | RigidBody] | None:
    """Both sides, one of them a solid, if what touches may not see where they sink into each other.

    By vertices the second may pass between those of the first, by mortar edges and corners of what is rigid pass means
    over facets. Of a first solid, and by mortar, only where all faces may touch: what is pressed beside faces that are
    named is meant to be free.
    """
    first, second = contact.first, contact.second
    bodies = mesh_bodies(first, second)
    if first is second or not bodies or (contact.is_mortar and len(bodies) > 1):
        return None
    if isinstance(first, RigidBody) and first.shape is not None and len(first.shape.feelers[0]) == 1:
        return None  # balls are exact
    named = (contact.first_faces, contact.second_faces) != ("all", "all")
    if named and (contact.is_mortar or isinstance(first, Solid)):
        return None
    return (first, second) if _encloses(first) and _encloses(second) else None


def _encloses(body: object) -> TypeGuard[Solid | RigidBody]:
    if isinstance(body, Solid):
        return body.grid.dimension == 3
    return isinstance(body, RigidBody) and body.shape is not None


def watch(contact: Contact, term: _core.ContactTerm) -> None:
    """Let steps fail in which the bodies of a contact sink into each other unseen."""
    pairing = watched(contact) or with_solid(contact)
    if pairing is None:
        return
    first, second = pairing
    _, radius = first.feelers() or ((), 0.0)
    feels_all = contact._edges is not None and contact._edges.feels_all
    if not isinstance(second, Obstacle) and not contact.is_mortar and radius == 0 and not feels_all:
        own = surface_of(first, contact.first_faces, contact.label)
        other = surface_of(second, contact.second_faces, contact.label)
        contact._pair.check_finer(own, float(np.linalg.norm(np.ptp(other.places, axis=0))))
    sides = whole_surface(contact, first), whole_surface(contact, second)
    least = min(narrowest(side) for side in sides)
    deep = (
        AVERAGED * UNSEEN * least
        if contact.is_mortar and mesh_bodies(first, second)
        else unseen(least, first, second)
    )
    term.watch(skin(*sides, sees=False), deep, least, _cure(contact, pairing))


def unseen(least: float, *bodies: Attachable | Obstacle) -> float:
    """How deep bodies of this least width may be in each other where no gap sees it."""
    return UNSEEN * least * (FLEXIBLE if mesh_bodies(*bodies) else 1)


def rubs_by_springs(contact: Contact) -> bool:
    """Whether multipliers press and a penalty rubs, which forgets its slip where a gap at the same place takes over."""
    return contact.friction > 0 and contact.enforcement == "multipliers" and contact.tangential == "penalty"


def narrowest(surface: Surface) -> float:
    """The least width of a body, however it lies: its thickness behind a facet, but for the thinnest hundredth."""
    thick, areas = surface.sights[:, 0], surface._facet_areas()
    order = np.argsort(thick, kind="stable")
    most = int(np.searchsorted(np.cumsum(areas[order]), THINNEST * areas.sum()))
    across = float(np.ptp(surface.places, axis=0).min())
    return min(float(thick[order[min(most, len(order) - 1)]]), across) if len(order) else across


def whole_surface(contact: Contact, body: Attachable | Obstacle) -> Surface:
    """The whole surface of a side, as facets."""
    if not isinstance(body, Obstacle):
        return surface_of(body, "all", contact.label)
    points, facets = body.shape.facets()
    _, frame = body.outline()
    places = []
    for X in points:
        place = frame.position
        for x, direction in zip(X, frame.directors, strict=True):
            place = place + float(x) * direction
        places.append(place)
    return of_vectors(places, facets, points)


def _cure(contact: Contact, pairing: tuple[Second, Second]) -> str:
    first, second = (body.label for body in pairing)
    if contact.is_mortar:
        rigid = next(body.label for body in pairing if isinstance(body, RigidBody))
        return (
            f"mortar gaps are means over facets, which edges and corners of {rigid} pass by where it lies tilted: take "
            f"formulation='node-to-segment', with {rigid} as first"
        )
    if any(isinstance(body, Solid) for body in pairing):
        return (
            f"vertices of {first} alone touch {second}: exchange first and second, or take formulation='mortar' where "
            "faces lie on each other"
        )
    if (contact.first_faces, contact.second_faces) != ("all", "all"):
        return (
            f"of faces that are named vertices of {first} alone touch {second}: leave out first_faces and "
            "second_faces, or exchange first and second where corners of that meet faces"
        )
    if rubs_by_springs(contact):
        return (
            f"by multipliers that rub by a penalty vertices of {first} alone touch {second}: leave out "
            "tangential='penalty'"
        )
    return (
        f"vertices of {first} touch {second}, and where both are convex and sharp by 30 degrees edges that cross and "
        "corners in faces: exchange first and second where what is round meets edges or corners, and take "
        "formulation='mortar' where faces lie on each other beside these"
    )


def remark(contact: Contact) -> list[str]:
    """What the check says of it."""
    pairing = watched(contact)
    if pairing is None:
        return []
    first, second = pairing
    edges = "" if rubs_by_springs(contact) else " and sharp edges"
    by_points = f"those of its vertices{edges}, by node-to-segment"
    how = "means over facets, by mortar" if contact.is_mortar else by_points
    return [
        f"{contact.label}: gaps of {first.label} are {how}; steps in which it and {second.label} sink into each other "
        f"unseen by these, by {UNSEEN:.0%} of their least width, fail"
    ]
