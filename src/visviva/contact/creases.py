"""Edges at which the normals of a surface turn, and vertices of their own for the sides of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.contact.contact_surface import Surface

Ints = NDArray[np.int64]

SMOOTH_RIGID, SMOOTH_SOLID = 15.0, 40.0
"""Facets whose normals are closer than this, in degrees, share a normal at their vertices: those of rigid bodies with
edges of 32 to the turn, and those of coarse meshes of solids that are round."""


def creased(surface: Surface, smooth: float) -> Surface:
    """The surface with a vertex of its own for each smooth part that meets at a sharp edge or corner.

    The normal at a vertex is the mean of those of its facets. Beyond a sharp edge they do not touch what these do: the
    pressure would act at an angle to them, and friction be as large as belongs to that.
    """
    if len(surface.facets) == 0:
        return surface
    old, part = _parts(surface, float(np.cos(np.radians(smooth))))
    if part.max() + 1 == len(np.unique(old)):
        return surface
    source = np.zeros(part.max() + 1, dtype=np.int64)
    source[part] = old
    order = np.argsort(source, kind="stable")
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    facets = surface.facets.copy()
    facets[facets >= 0] = number[part]
    kept = source[order]
    return replace(
        surface,
        forms=[surface.forms[v] for v in kept],
        constant=surface.constant[kept],
        places=surface.places[kept],
        facets=facets,
        source=kept if surface.source is None else surface.source[kept],
    )


def bluntest(surface: Surface) -> float:
    """The largest angle in degrees between neighbouring facets that share vertices, 0 without any."""
    along = [float(surface.normals[f] @ surface.normals[g]) for f, _, g, _ in neighbours(surface)]
    return float(np.degrees(np.arccos(np.clip(min(along, default=1.0), -1.0, 1.0))))


def _parts(surface: Surface, smooth: float) -> tuple[Ints, Ints]:
    """Of every corner of a facet: its vertex, and the number of the smooth part about that which it belongs to."""
    import scipy.sparse as sp

    facets = surface.facets
    there = facets >= 0
    size = int(there.sum())
    place = np.cumsum(there).reshape(there.shape) - 1
    same = [
        ends
        for f, a, g, b in neighbours(surface)
        if surface.normals[f] @ surface.normals[g] > smooth
        for ends in ((place[f, p], place[g, q]) for p, q in zip(a, b, strict=True))
    ]
    i, j = np.array(same, dtype=np.int64).reshape(-1, 2).T
    graph = sp.coo_array((np.ones(len(i)), (i, j)), shape=(size, size))
    return facets[there], sp.csgraph.connected_components(graph, directed=False)[1].astype(np.int64)


def neighbours(surface: Surface) -> Iterator[tuple[int, list[int], int, list[int]]]:
    """Two facets with an edge in common, in the plane a vertex, and at which of their corners that is."""
    seen: dict[tuple[int, ...], tuple[int, list[int]]] = {}
    for f, row in enumerate(surface.facets.tolist()):
        n = sum(v >= 0 for v in row)
        sides = [[a, (a + 1) % n] for a in range(n)] if surface.dimension == 3 else [[0], [1]]
        for corners in sides:
            key = tuple(sorted(row[a] for a in corners))
            if key in seen:
                g, others = seen[key]
                turned = (
                    others
                    if [row[a] for a in corners] == [surface.facets[g, b] for b in others]
                    else others[::-1]
                )
                yield f, corners, g, turned
            seen[key] = f, corners
