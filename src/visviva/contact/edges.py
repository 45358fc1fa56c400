"""Edges of two rigid bodies that cross, and corners of the second in faces of the first, beside gaps of vertices."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.rigid import RigidBody
from visviva.contact.contact_surface import Surface, skin
from visviva.contact.contact_trouble import without_tangent
from visviva.contact.sharp import Parts, sharp_parts
from visviva.contact.sinking import narrowest, rubs_by_springs, watched, whole_surface
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.contact.contact import Contact
    from visviva.contact.contact_layer import Layer
    from visviva.model.model import Model

Array = NDArray[np.float64]

AT_ONCE, OF_MANY, BY_PENALTY = 8, 24, 64
"""So many pairs of two bodies may touch at once: those of edges of two squares that lie on each other, by multipliers
of bodies with more edges than a box, and where none of them costs an unknown. Steps in which more do are refused."""
SIMPLE = 12
"""Edges of a box."""
DEEP = 0.5
"""Part of the least width of both bodies by which edges may be in each other and know it."""


class Edges:
    """Gaps of the edges of a contact and corners of its second body, multipliers, and the core's term of them.

    Parameters
    ----------
    contact : Contact
    sides : tuple of Surface
        The whole surfaces of both bodies.
    parts : tuple of Parts
        Sharp ones of both.
    """

    def __init__(self, contact: Contact, sides: tuple[Surface, Surface], parts: tuple[Parts, Parts]) -> None:
        self._contact, self._sides, self._parts = contact, sides, parts
        simple = max(len(part.edges) for part in parts) <= SIMPLE
        self._n = BY_PENALTY if contact.enforcement == "penalty" else AT_ONCE if simple else OF_MANY
        self.term: _core.ContactTerm

    def declare(self, model: Model) -> None:
        """Multipliers, as the contact has them."""
        contact, role = self._contact, Role.CONTACT_PRESSURE
        none = np.zeros(0, dtype=np.int32)
        self._multipliers = self._along = none
        if contact.enforcement == "multipliers":
            field = model.field(contact, "edge pressure", np.zeros(self._n), role=role, stage=1)
            self._multipliers = np.array(field.unknowns, dtype=np.int32)
        if contact.friction > 0 and contact.tangential == "multipliers":
            field = model.field(contact, "edge traction", np.zeros((self._n, 2)), role=role, stage=1)
            self._along = np.array(field.unknowns[::2], dtype=np.int32)

    def contribute(
        self, model: Model, stiffness: tuple[float, float], layer: Layer, reach: float, restitution: float
    ) -> None:
        """The core's term, with the stiffness across and along edges that vertices have."""
        contact, (first, second) = self._contact, self._sides
        n = len(first.forms)
        least = min(narrowest(side) for side in self._sides)
        pair = skin(first, second, sees=False)
        gaps = _core.sharp_gaps(pair, self._pairs(n), n, self._n, DEEP * least, reach)
        ones = np.ones(self._n)
        self.term = _core.ContactTerm(
            gaps,
            reach,
            self._multipliers,
            stiffness[0] * ones,
            ones,
            contact.impact == "conserving",
            True,
            restitution,
            contact._share,
            contact.initial == "press",
            contact.friction,
            self._along,
            stiffness[1] * ones,
            layer.inertia * ones,
            layer.rigid_inertia * ones,
            contact.damping * ones if contact.damping > 0 else np.zeros(0),
        )
        self.term.name = contact.label
        sticks = contact.tangential == "multipliers"
        free = contact.enforcement == "multipliers"
        work = model.account(contact, "contact", "dissipation")
        self.term.book_contact(work, -1 if free else model.account(contact, "contact", "potential"))
        if contact.friction > 0:
            work = model.account(contact, "friction", "dissipation")
            self.term.book_friction(work, -1 if sticks else model.account(contact, "friction", "potential"))
        model.batch(self.term)

    def _pairs(self, n: int) -> _core.SharpParts:
        """Edges of both, faces of the first, corners of the second, whose vertices begin with number n."""
        one, two = self._parts
        borders, beside = [face[1] for face in one.faces], [two.beside(corner) for corner in two.corners]
        return _core.SharpParts(
            _flat([one.edges, two.edges + n]),
            len(one.edges),
            _flat([face[0] for face in one.faces]),
            _flat(borders),
            _starts([2 * len(border) for border in borders]),
            np.array(two.corners, dtype=np.int32) + np.int32(n),
            _flat(beside) + np.int32(n),
            _starts([len(ends) for ends in beside]),
        )

    def add_to(self, forces: Array) -> None:
        """Add those on the edges of the first body to `forces` (n, 3) on its vertices."""
        if len(self.term.forces):
            n = len(self._sides[0].forms)
            forces[:n] += (self.term.forces + self.term.friction_forces).reshape(-1, 3)[:n]

    @property
    def feels_all(self) -> bool:
        """Whether every vertex of the second body is a corner, and nothing of it falls between those of the first."""
        return len(self._parts[1].corners) == len(self._sides[1].forms)

    @property
    def depths(self) -> Array:
        """By how much edges are in each other (n,) at the end of the last step."""
        return np.where(self.term.areas > 0, np.maximum(-self.term.gaps, 0.0), 0.0)

    def without_tangent(self, size: float) -> str:
        """Why contact cannot be linearised there."""
        gaps = np.where(self.term.areas > 0, self.term.gaps, np.nan)
        tractions = self.term.tractions.reshape(-1, 3)
        why = without_tangent(self.term.pressures, gaps, tractions, self._contact.friction, size)
        return why.replace("of its vertices", "of its edges or corners")

    def refuse_overlap(self, deep: float) -> None:
        """Refuse edges that are in each other by more than this at the start."""
        depth = float(self.depths.max())
        if depth > deep:
            contact = self._contact
            raise InputError(
                f"{contact.label}: edges or corners of {contact.first.label} and {contact._pair._opponent} overlap by "
                f"{depth:.3g} at the start; move one of them, or give initial='press' to start under the pressure "
                "that this overlap makes"
            )


def lie_beside(contact: Contact, others: Sequence[Contact]) -> None:
    """Let a contact and others, which are before it, know how deep the rest lie in each other."""
    own = _terms(contact)
    beside = [term for other in others for term in _terms(other)]
    for one, two in product(own, beside):
        one.lie_beside(two)
        two.lie_beside(one)


def cover(contact: Contact, others: Sequence[Contact], model: Model) -> None:
    """Let rigid bodies of a contact and others, which are before it, cover each other where they touch the same one.

    Those that touch each other, too, come and go, and are no parts of one face.
    """
    for one, two in [pair for other in others for pair in ((contact, other), (other, contact))]:
        if one.is_mortar or watched(one) is None or watched(two) is None:
            continue
        bodies, named = (one.first, one.second), (two.first_faces, two.second_faces)
        for side, (body, faces) in product((0, 1), zip((two.first, two.second), named, strict=True)):
            touched = bodies[1 - side] in (two.first, two.second) and body not in bodies
            if touched and faces == "all" and not _touch(type(contact), bodies[side], body, model):
                for term in _terms(one):
                    term.cover(side, _cover_of(one, bodies[side], model), _cover_of(two, body, model))


def _touch(kind: type[Contact], one: Any, two: Any, model: Model) -> bool:
    """Whether there is a contact of two bodies."""
    return any({id(c.first), id(c.second)} == {id(one), id(two)} for c in model.announced(one, kind))


def _cover_of(contact: Contact, body: Any, model: Model) -> _core.Cover:
    if not model.announced(body, _core.Cover):
        whole = skin(whole_surface(contact, body), None, sees=False)
        model.announce(body, _core.Cover(whole))
    return model.announced(body, _core.Cover)[0]


def _terms(contact: Contact) -> list[_core.ContactTerm]:
    return [contact.term, contact._edges.term] if contact._edges else [contact.term]


def edges_of(contact: Contact) -> Edges | None:
    """Gaps of edges and corners, if both bodies are rigid, sharp, and touch by the whole of their surfaces."""
    pairing = watched(contact)
    if pairing is None or contact.is_mortar or (contact.first_faces, contact.second_faces) != ("all", "all"):
        return None
    first, second = pairing
    if rubs_by_springs(contact):
        return None
    feelers = first.feelers()
    if feelers is None or feelers[1] > 0 or _is_flat(first) or _is_flat(second):
        return None
    sides = whole_surface(contact, first), whole_surface(contact, second)
    parts = sharp_parts(sides[0]), sharp_parts(sides[1])
    meet = len(parts[0].edges) and len(parts[1].edges)
    return Edges(contact, sides, parts) if meet or parts[1].corners else None


def _flat(rows: Sequence[ArrayLike]) -> NDArray[np.int32]:
    return np.concatenate([np.zeros(0), *(np.ravel(row) for row in rows)]).astype(np.int32)


def _starts(lengths: list[int]) -> NDArray[np.int32]:
    return np.cumsum([0, *lengths]).astype(np.int32)


def _is_flat(body: object) -> bool:
    return isinstance(body, RigidBody) and body.is_flat
