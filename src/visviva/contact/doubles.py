"""Surfaces that two components hold apart or together at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.component.component import Component
from visviva.contact.tying import Tie
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.contact.contact import Contact
    from visviva.model.model import Model

Keys = set[tuple[int, ...]]
Side = tuple[Component, str | Faces | Keys]
"""A body and which part of its surface."""


def refuse_doubles(contact: Contact, model: Model) -> None:
    """Refuse surfaces that are in contact twice, which doubles penalties and makes multipliers redundant, or tied."""
    number = model.index(contact)
    for other in model.announced(contact.first, type(contact)):
        if model.index(other) < number and _meet(_sides(contact), _sides(other)):
            raise InputError(
                f"{contact.label} holds surfaces of {contact.first.label} and {_sides(contact)[1][0].label} apart that "
                f"{other.label} does as well: leave one of them out, or give them other faces"
            )
    for tie in model.announced(contact.first, Tie):
        if _meet(_sides(contact), [(tie.first, _tied(tie)), (tie.second, tie.second_faces)]):
            raise InputError(
                f"{contact.label} holds faces of {tie.first.label} and {tie.second.label} apart that {tie.label} "
                "ties to each other: give the contact other faces, those that are free"
            )


def _sides(contact: Contact) -> list[Side]:
    first = (contact.first, contact.first_faces)
    return [first, first if contact.second is None else (contact.second, contact.second_faces)]


def _tied(tie: Tie) -> Keys:
    """First faces whose points are all tied."""
    points = set(tie._used[tie._tied].tolist())
    return {key for key in tie.first.skin(tie.first_faces).keys if points.issuperset(key)}


def _meet(one: list[Side], two: list[Side]) -> bool:
    """Whether two pairs of surfaces have faces in common, in either order."""
    (a, b), (c, d) = one, two
    return (_share(a, c) and _share(b, d)) or (_share(a, d) and _share(b, c))


def _share(one: Side, two: Side) -> bool:
    (body, faces), (other, others) = one, two
    if body is not other:
        return False
    if isinstance(body, MeshBody):
        return not _keys(body, faces).isdisjoint(_keys(body, others))
    return "all" in (faces, others) or faces == others


def _keys(body: MeshBody, faces: str | Faces | Keys) -> Keys:
    return faces if isinstance(faces, set) else body.skin(faces).keys
