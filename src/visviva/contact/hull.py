"""Closed surfaces of what is thin, which tell when something passes through it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.mesh_body import MeshBody
from visviva.contact.bars import is_bar
from visviva.contact.contact_surface import Surface, of_skin
from visviva.mesh.faces import Faces


def hull_of(body: object) -> Surface | None:
    """Both sides of what is thin, with its rim, joined at kinks; None of others, and where branches leave it open."""
    if not isinstance(body, MeshBody) or not body.is_thin or is_bar(body):
        return None
    own = body.skin("all")
    surface = of_skin(body, own)
    far = own.used >= len(own.points) // 2  # points of one side come before those of the other
    _, first, place = np.unique(
        np.column_stack([own.nodes[own.used], far]), axis=0, return_index=True, return_inverse=True
    )
    facets = np.where(surface.facets >= 0, first[place.ravel()][surface.facets], -1)
    return replace(surface, facets=facets, source=None) if _is_closed(facets) else None


def _is_closed(facets: NDArray[np.int64]) -> bool:
    """Whether every edge, in the plane every end, is left by as many facets as come to it."""
    if (facets[:, 2:] < 0).all():
        return np.array_equal(*np.sort(facets[:, :2], axis=0).T)
    nexts = np.where(np.roll(facets, -1, axis=1) >= 0, np.roll(facets, -1, axis=1), facets[:, :1])
    there = np.column_stack([facets[facets >= 0], nexts[facets >= 0]])
    ways, number = np.unique(np.sort(there, axis=1), axis=0, return_inverse=True)
    turns = np.where(there[:, 0] < there[:, 1], 1, -1)
    return not np.bincount(number.ravel(), weights=turns, minlength=len(ways)).any()


def touching(body: Any, hull: Surface, faces: str | Faces) -> NDArray[np.bool_]:
    """Which facets of a hull may touch: on both sides where one is named, as what comes in there leaves by both."""
    own = body.skin("all")
    named = np.isin(own.nodes[own.used], body.skin(faces).touched)
    return np.asarray((named[hull.facets] | (hull.facets < 0)).all(axis=1))
