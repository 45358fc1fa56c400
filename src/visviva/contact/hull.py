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

Ints = NDArray[np.int64]


def hull_of(body: object) -> Surface | None:
    """Both sides of what is thin, with its rim, joined at kinks; None of others.

    Where sheets branch each has a rim of its own, which goes on across the others to their middle.
    """
    if not isinstance(body, MeshBody) or not body.is_thin or is_bar(body):
        return None
    own = body.skin("all")
    surface = of_skin(body, own)
    n = len(own.points) // 2
    far = own.used >= n  # points of one side come before those of the other
    names = np.column_stack([own.nodes[own.used], far, np.zeros_like(far)])
    facets = _joined(surface.facets, names)
    if len(left := _open_edges(facets)):
        branches = np.isin(own.nodes[own.used], own.nodes[own.used[left]])
        names[branches, 2] = own.used[branches] % n  # sheets apart
        facets = _joined(surface.facets, names)
        facets = np.concatenate([facets, _rims(_open_edges(facets), _twins(own.used, n))])
    return replace(surface, facets=facets, source=None) if len(_open_edges(facets)) == 0 else None


def _joined(facets: Ints, names: Ints) -> Ints:
    """Facets between the first of all vertices that have the same name, a row each."""
    _, first, place = np.unique(names, axis=0, return_index=True, return_inverse=True)
    return np.where(facets >= 0, first[place.ravel()][facets], -1)


def _open_edges(facets: Ints) -> Ints:
    """Edges (k, 2) that no other facet passes the other way, as facets pass them; in the plane starts, each twice."""
    if (facets[:, 2:] < 0).all():
        ends, number = np.unique(facets[:, :2], return_inverse=True)
        turns = np.tile([1, -1], len(facets))
        return np.repeat(ends[np.bincount(number.ravel(), weights=turns) > 0], 2).reshape(-1, 2)
    nexts = np.where(np.roll(facets, -1, axis=1) >= 0, np.roll(facets, -1, axis=1), facets[:, :1])
    there = np.column_stack([facets[facets >= 0], nexts[facets >= 0]])
    ways, number = np.unique(np.sort(there, axis=1), axis=0, return_inverse=True)
    turns = np.where(there[:, 0] < there[:, 1], 1, -1)
    more = np.bincount(number.ravel(), weights=turns, minlength=len(ways))
    return np.asarray(np.where(more[:, None] > 0, ways, ways[:, ::-1])[more != 0])


def _twins(used: Ints, n: int) -> Ints:
    """Of each vertex the one on the other side of its sheet."""
    place = np.full(2 * n, -1)
    place[used] = np.arange(len(used))
    return np.asarray(place[(used + n) % (2 * n)])


def _rims(edges: Ints, twins: Ints) -> Ints:
    """Facets from open edges of one side of sheets to those of the other, in the plane of starts to ends."""
    a, b = edges.T
    if (a == b).all():
        return np.column_stack([twins[a], a, np.full((len(a), 2), -1)])
    a, b = edges[(edges < twins[edges]).all(axis=1)].T
    return np.column_stack([b, a, twins[a], twins[b]])


def touching(body: Any, hull: Surface, faces: str | Faces) -> NDArray[np.bool_]:
    """Which facets of a hull may touch: on both sides where one is named, as what comes in there leaves by both."""
    own = body.skin("all")
    named = np.isin(own.nodes[own.used], body.skin(faces).touched)
    return np.asarray((named[hull.facets] | (hull.facets < 0)).all(axis=1))
