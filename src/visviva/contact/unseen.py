"""Refusal of bodies that lie in each other at the start deeper than contact sees."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.rigid import RigidBody
from visviva.component.point import Attachable
from visviva.contact.bars import is_bar
from visviva.contact.contact_surface import mesh_bodies, positions, surface_of, where_of
from visviva.contact.sinking import watched
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.contact.contact import Contact

Array = NDArray[np.float64]
Side = tuple[Attachable, str | Faces]
"""A body and which part of its surface."""
SEEN = 0.99
"""Part of the reach up to which facets see each other for sure."""


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
    """Refuse rigid bodies that lie in each other, at `x`, deeper than `seen`, the depth that their gaps have.

    Vertices and edges that lie on the sides of the other body, as of boxes that are flush, are not in it. Edges that
    pass through the other one, as of a rod through a plate, with no vertex and no facet's middle in it, count from the
    depth on that steps may not sink by unseen. Those of faces that are named may do so on purpose, as at a hinge.
    """
    pairing = watched(contact)
    if pairing is None:
        return
    if (contact.first_faces, contact.second_faces) == ("all", "all"):
        depth, place = contact.term.overlap(x)
        if depth > 0:
            told = _told(contact, contact.first.label, pairing[1].label, depth, place)
            raise InputError(
                f"{told}, where edges of one pass through the other, which no gap sees, so that nothing would hold "
                "them apart; move one of them, or name first_faces and second_faces where they overlap on purpose"
            )
    if contact.is_mortar or not isinstance(pairing[1], RigidBody):
        return
    for _, told in _overlaps(contact, pairing[1], seen, x):
        raise InputError(
            f"{told}, where no vertex or edge of one is in the other, so that nothing would hold them apart; move one "
            "of them"
        )


def _told(contact: Contact, own: str, other: str, depth: float, place: Iterable[float]) -> str:
    near = ", ".join(f"{c:.4g}" for c in place)
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
