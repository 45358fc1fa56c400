"""Refusal of bodies that lie in each other at the start deeper than contact sees."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.rigid import RigidBody
from visviva.component.point import Attachable
from visviva.contact.bars import is_bar
from visviva.contact.contact_surface import mesh_bodies, positions, skin, surface_of, where_of
from visviva.contact.obstacle import Obstacle
from visviva.contact.sinking import narrowest, unseen, watched, whole_surface
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.contact.contact import Contact

Array = NDArray[np.float64]
Side = tuple[Attachable, str | Faces]
"""A body and which part of its surface."""
SEEN = 0.99
"""Part of the reach up to which facets see each other for sure."""
ROUNDING = 1e-9
"""Part of a depth that is nothing in the place where it is."""


def refuse_unseen(contact: Contact, reach: float, x: Array) -> None:
    """Refuse bodies of which one lies in the other, at the unknowns `x`, so deep that their facets see none.

    Facets in contact alone are judged, where the way out of the other body, against their normal, is through its facets
    in contact: what else overlaps may do so on purpose. Exact shapes are seen from wherever a point is within them.
    """
    first, second = contact.first, contact.second
    if not isinstance(second, Attachable) or contact._pair.outline is not None:
        return
    if first is second or is_bar(first) or is_bar(second):
        return
    for depth, told in _overlaps(contact, second, reach, x):
        bound = f"the reach of {reach:.3g}" if depth > reach else "half of their thickness"
        raise InputError(
            f"{told}, deeper than contact sees, which is no farther than {bound}, so that nothing would hold them "
            "apart; move one of them"
            + (f", or give initial='press' and a reach above {depth:.3g}" if depth > reach else "")
        )


def refuse_hidden(contact: Contact, seen: float, x: Array) -> None:
    """Refuse bodies that lie in each other, at `x`, though no gap of theirs is closed deeper than `seen`.

    Vertices and edges that lie on the sides of the other body, as of boxes that are flush, are not in it, and those of
    a rod through a plate are beside it. Surfaces that cross count from the depth on that steps may not sink by unseen.
    Those of faces that are named may do so on purpose, as at a hinge.
    """
    bodies = _closed(contact)
    if bodies and (contact.first_faces, contact.second_faces) == ("all", "all"):
        sides = [whole_surface(contact, body) for body in bodies]
        deep = unseen(min(narrowest(side) for side in sides), *bodies)
        depth, place = _core.overlap(skin(*sides, sees=False), x, 0.5 * deep)
        if depth > 0:
            told = _told(contact, bodies[0].label, bodies[1].label, 2 * depth, place)
            raise InputError(
                f"{told}, where no gap sees it, so that nothing would hold them apart; move one of them, or name "
                "first_faces and second_faces where they overlap on purpose"
            )
    pairing = watched(contact)
    if pairing is None or contact.is_mortar or not isinstance(pairing[1], RigidBody):
        return
    for _, told in _overlaps(contact, pairing[1], seen, x):
        raise InputError(
            f"{told}, where no vertex or edge of one is in the other, so that nothing would hold them apart; move one "
            "of them"
        )


def _closed(contact: Contact) -> tuple[Attachable, Attachable | Obstacle] | None:
    """Both sides, if they enclose something in space and are not exact as a ball's are."""
    first, second = contact.first, contact.second
    feelers = first.feelers()
    is_ball = feelers is not None and len(feelers[0]) == 1 and not contact.is_mortar
    if is_ball or first is second or not isinstance(second, Attachable | Obstacle):
        return None
    return (first, second) if _encloses(first) and _encloses(second) else None


def _encloses(body: Attachable | Obstacle) -> bool:
    if isinstance(body, MeshBody):
        return body.grid.dimension == 3
    return isinstance(body, Obstacle) or (isinstance(body, RigidBody) and body.shape is not None)


def _told(contact: Contact, own: str, other: str, depth: float, place: Array) -> str:
    near = ", ".join(f"{c:.4g}" for c in np.where(np.abs(place) > ROUNDING * depth, place, 0.0))
    return f"{contact.label}: {own} and {other} overlap by {depth:.3g} near ({near}) at the start"


def _overlaps(contact: Contact, second: Attachable, reach: float, x: Array) -> Iterator[tuple[float, str]]:
    """Unseen depths of either body in the other one, and the words that tell of each."""
    sides: list[Side] = [(contact.first, contact.first_faces), (second, contact.second_faces)]
    for own, other in (sides, sides[::-1]):
        depth, place = deepest(own, other, contact.label, reach, x)
        if depth > 0:
            yield depth, _told(contact, own[0].label, other[0].label, depth, place)


def deepest(own: Side, other: Side, label: str, reach: float, x: Array) -> tuple[float, Array]:
    """Unseen depth of the facets of one side in the body of the other one, and where (3,) it is deepest; 0 if none."""
    (body, faces), (holder, others) = own, other
    if not has_facets(body) or not has_facets(holder) or holder.is_thin:
        return 0.0, np.zeros(3)
    surface, touched, whole = (
        surface_of(part, which, label) for part, which in ((body, faces), (holder, others), (holder, "all"))
    )
    number = {where_of(corners): k for k, corners in enumerate(whole._corners())}
    kept = [number[where_of(corners)] for corners in touched._corners()]
    behind = np.full(len(whole.facets), np.inf)
    behind[kept] = touched.sights[:, 0]
    X = positions(surface, x)
    depths = _core.unseen(
        surface.dimension,
        X.ravel(),
        surface.facets.astype(np.int32).ravel(),
        np.ascontiguousarray(surface.sights[:, 0]),
        positions(whole, x).ravel(),
        whole.facets.astype(np.int32).ravel(),
        behind,
        np.isin(np.arange(len(whole.facets)), kept).astype(np.int32),
        SEEN * reach,
    )
    worst = int(np.argmax(depths))
    corners = surface.facets[worst]
    return float(depths[worst]), X[corners[corners >= 0]].mean(axis=0)


def has_facets(body: Attachable) -> bool:
    """Whether a body has a surface of facets: points have none."""
    return bool(mesh_bodies(body)) or (isinstance(body, RigidBody) and body.shape is not None)
