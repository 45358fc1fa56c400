"""Edges of two rigid bodies that cross: gaps of their own, beside those of vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.rigid import RigidBody
from visviva.contact.contact_surface import Surface, skin
from visviva.contact.creases import neighbours
from visviva.contact.sinking import narrowest, watched, whole_surface
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.contact.contact import Contact
    from visviva.contact.contact_layer import Layer
    from visviva.model.model import Model

Array = NDArray[np.float64]

SHARP = 30.0
"""Degrees between facets from which on what lies between them is an edge: less is the side of something round."""
AT_ONCE = 8
"""So many pairs of edges of two bodies may touch at once: those of two squares that lie on each other."""
DEEP = 0.5
"""Part of the least width of both bodies by which edges may be in each other and know it."""


def sharp_edges(surface: Surface) -> NDArray[np.int32]:
    """Edges (k, 4) at which a closed surface is sharp and convex: ends, a corner of the left facet and of the right.

    Left is left from the first end to the second, seen from outside.
    """
    found = []
    sharp = np.cos(np.radians(SHARP))
    for f, a, g, b in neighbours(surface):
        rows = [row[row >= 0] for row in (surface.facets[f], surface.facets[g])]
        (left, right), (start, end) = rows, rows[0][a]
        corners = [row[~np.isin(row, (start, end))][0] for row in (left, right)]
        n = surface.normals[f], surface.normals[g]
        ahead = surface.places[corners[1]] - surface.places[start]
        if n[0] @ n[1] < sharp and n[0] @ ahead < 0 and len(set(rows[1][b]) & {start, end}) == 2:
            found.append((start, end, *corners))
    return np.array(found, dtype=np.int32).reshape(-1, 4)


class Edges:
    """Gaps of the edges of a contact, their multipliers, and the core's term of them.

    Parameters
    ----------
    contact : Contact
    sides : tuple of Surface
        The whole surfaces of both bodies.
    edges : tuple of array of int, (k, 4)
        Of both, as `sharp_edges` finds them.
    """

    def __init__(
        self, contact: Contact, sides: tuple[Surface, Surface], edges: tuple[NDArray[np.int32], ...]
    ) -> None:
        self._contact, self._sides, self._edges = contact, sides, edges
        self.term: _core.ContactTerm

    def declare(self, model: Model) -> None:
        """Multipliers, as the contact has them."""
        contact, role = self._contact, Role.CONTACT_PRESSURE
        none = np.zeros(0, dtype=np.int32)
        self._multipliers = self._along = none
        if contact.enforcement == "multipliers":
            field = model.field(contact, "edge pressure", np.zeros(AT_ONCE), role=role, stage=1)
            self._multipliers = np.array(field.unknowns, dtype=np.int32)
        if contact.friction > 0 and contact.tangential == "multipliers":
            field = model.field(contact, "edge traction", np.zeros((AT_ONCE, 2)), role=role, stage=1)
            self._along = np.array(field.unknowns[::2], dtype=np.int32)

    def contribute(
        self, model: Model, stiffness: tuple[float, float], layer: Layer, reach: float, restitution: float
    ) -> None:
        """The core's term, with the stiffness across and along edges that vertices have."""
        contact, (first, second) = self._contact, self._sides
        n = len(first.forms)
        edges = np.concatenate([self._edges[0], self._edges[1] + n]).astype(np.int32).ravel()
        least = min(narrowest(side) for side in self._sides)
        gaps = _core.edge_gaps(
            skin(first, second, sees=False), edges, len(self._edges[0]), n, AT_ONCE, DEEP * least, reach
        )
        ones = np.ones(AT_ONCE)
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

    def add_to(self, forces: Array) -> None:
        """Add those on the edges of the first body to `forces` (n, 3) on its vertices."""
        if len(self.term.forces):
            n = len(self._sides[0].forms)
            forces[:n] += (self.term.forces + self.term.friction_forces).reshape(-1, 3)[:n]

    @property
    def depths(self) -> Array:
        """By how much edges are in each other (AT_ONCE,) at the end of the last step."""
        return np.where(self.term.areas > 0, np.maximum(-self.term.gaps, 0.0), 0.0)

    def refuse_overlap(self, deep: float) -> None:
        """Refuse edges that are in each other by more than this at the start."""
        depth = float(self.depths.max())
        if depth > deep:
            contact = self._contact
            raise InputError(
                f"{contact.label}: edges of {contact.first.label} and {contact._pair._opponent} that cross overlap by "
                f"{depth:.3g} at the start; move one of them, or give initial='press' to start under the pressure "
                "that this overlap makes"
            )


def edges_of(contact: Contact) -> Edges | None:
    """Gaps of edges, if both bodies are rigid, have sharp ones and touch by the whole of their surfaces."""
    pairing = watched(contact)
    if pairing is None or contact.is_mortar or (contact.first_faces, contact.second_faces) != ("all", "all"):
        return None
    first, second = pairing
    feelers = first.feelers()
    if feelers is None or feelers[1] > 0 or _is_flat(first) or _is_flat(second):
        return None
    sides = whole_surface(contact, first), whole_surface(contact, second)
    edges = sharp_edges(sides[0]), sharp_edges(sides[1])
    return Edges(contact, sides, edges) if len(edges[0]) and len(edges[1]) else None


def _is_flat(body: object) -> bool:
    return isinstance(body, RigidBody) and body.is_flat
