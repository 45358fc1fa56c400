"""Contact fields in files and pictures: pressures, gaps, states and tractions at the nodes of solids."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.mesh_body import MeshBody
from visviva.component.meshed import Meshed
from visviva.contact.contact_surface import mesh_bodies, positions

if TYPE_CHECKING:
    from visviva.component.component import Component
    from visviva.contact.contact import Contact
    from visviva.mesh.faces import Faces

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FIELDS = {"contact_pressure": 1, "contact_gap": 1, "contact_state": 1, "contact_traction": 3}
"""Numbers of components of what is shown, in the order of the columns of a record."""
GAP, STATE = 1, 2


def record(contact: Contact, x: Array) -> Array:
    """Rows (n, 6) of the last step for the vertices of the first surface and those of the second, if it is a solid's.

    Pressures and tractions are by present area at the unknowns `x` of the system; on the second surface they are its
    vertices' forces by their areas. It has no gaps.
    """
    pressing = contact.pressures > 0
    state = np.where(pressing, 1.0 + contact.slipping, 0.0)
    first = np.column_stack([contact.pressures, contact.gaps, state, contact.tractions])
    if isinstance(contact.first, MeshBody):
        first = _at_nodes(contact.source, first)
    opposite, body = contact.opposite, contact.second
    if opposite is None or not isinstance(body, MeshBody):
        return first
    second = np.zeros((len(opposite.forms), 6))
    second[:, GAP] = np.nan
    if len(contact.term.forces):
        areas = replace(opposite, places=positions(opposite, x)).areas[:, None]
        forces, friction = (
            values.reshape(-1, 3)[len(contact.forms[0]) :][: len(second)] / areas
            for values in (contact.term.forces, contact.term.friction_forces)
        )
        second[:, 0] = np.linalg.norm(forces, axis=1)
        second[:, STATE], second[:, 3:] = second[:, 0] > 0, friction
    return np.vstack([first, _at_nodes(opposite.source, second)])


def _at_nodes(source: Ints | None, rows: Array) -> Array:
    """Of the vertices at a node that which presses most; the smallest gap of all."""
    if source is None:
        return rows
    order = np.argsort(rows[:, 0], kind="stable")  # the last one that is written stays
    found = np.full((source.max() + 1, rows.shape[1]), np.nan)
    found[source[order]] = rows[order]
    np.fmin.at(found[:, GAP], source, rows[:, GAP])
    return found


class Painting:
    """Indices of the records of contacts among the points of all surfaces that are drawn.

    Parameters
    ----------
    contacts : sequence of Contact
    starts : mapping
        First point of each mesh.
    n_points : int
        Points of all surfaces.
    """

    def __init__(self, contacts: Sequence[Contact], starts: Mapping[Meshed, int], n_points: int) -> None:
        self.parts = [list(sides(contact, starts)) for contact in contacts]
        width = 6 if any(contact.friction > 0 for contact in contacts) else 3
        self._blank = np.full((n_points, width), np.nan)
        for mesh in {body for c in contacts for body in mesh_bodies(c.first, c.second)}:
            points = starts[mesh] + np.arange(len(mesh.drawn().points))
            self._blank[points] = 0.0
            self._blank[points, GAP] = np.nan

    @property
    def is_blank(self) -> bool:
        """Whether no contact touches a solid."""
        return not any(self.parts)

    def values(self, records: Sequence[Array]) -> dict[str, Array]:
        """Fields over all points: no pressure where a solid does not touch, NaN where there is no solid in contact.

        Pressures and tractions of several contacts add up, of gaps the smallest counts.
        """
        found = self._blank.copy()
        width = found.shape[1]
        for parts, rows in zip(self.parts, records, strict=True):
            for points, chosen in parts:
                old, new = found[points], rows[chosen, :width]
                found[points] = old + new
                found[points, GAP] = np.fmin(old[:, GAP], new[:, GAP])
                found[points, STATE] = np.maximum(old[:, STATE], new[:, STATE])
        columns: list[Any] = [0, GAP, STATE, slice(3, 6)]
        named = list(zip(FIELDS, columns, strict=True))[: 4 if width == 6 else 3]
        return {name: found[:, chosen].copy() for name, chosen in named}


def sides(contact: Contact, starts: Mapping[Meshed, int]) -> Iterator[tuple[Ints, Ints]]:
    """Points of the bodies on either side, and the rows of the record that belong to them."""
    n = len(contact.places)
    if contact.source is not None and isinstance(contact.first, MeshBody):
        n = int(contact.source.max()) + 1
    chosen: list[tuple[Component, str | Faces, int]] = [(contact.first, contact.first_faces, 0)]
    if contact.opposite is not None and contact.second is not None:
        chosen.append((contact.second, contact.second_faces, n))
    for body, faces, begin in chosen:
        if isinstance(body, MeshBody):
            own = body.skin(faces)
            nodes, drawn = own.touched, np.arange(body.grid.n_nodes) if own.drawn is None else own.drawn
            points = np.flatnonzero(np.isin(drawn, nodes))
            yield starts[body] + points, begin + np.searchsorted(nodes, drawn[points])
