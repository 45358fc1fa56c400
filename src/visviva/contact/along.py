"""Places along a surface that touches itself: which of two parts that meet has the vertices that touch the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.contact.contact_surface import Surface

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

WAY = np.array([0.48, 0.69, 0.54])
"""Any direction that is none of those that models have."""
TURNED = 0.25
"""Part of the length of a surface by which parts that look along that direction or against it lie apart: what closes
like a mouth may be as far from where distances begin on both sides."""


def order(surface: Surface) -> tuple[Array, Array]:
    """Of each vertex (n,) from where on, and of each facet (m,) up to where, what lies there may touch the other.

    Held from both sides, what meets would be held twice: as often as there are nodes on both, though surfaces that lie
    on each other move as one. The finer of two parts touches the other, whose facets would pass between its vertices.
    """
    places = _distances(surface)
    length = np.ptp(places)
    places += TURNED * length * (_normals(surface) @ WAY)
    places -= (1 + 2 * TURNED) * length * _halvings(surface)
    there = surface.facets >= 0
    ends = np.where(there, places[surface.facets], -np.inf).max(axis=1)
    return places, ends


def everywhere(surface: Surface) -> tuple[Array, Array]:
    """The same where all of a surface may touch all of it."""
    return np.full(len(surface.places), -np.inf), np.zeros(len(surface.facets))


def _sides(surface: Surface) -> Ints:
    """Edges (k, 2) of all facets; in the plane these are the facets."""
    if surface.dimension == 2:
        return surface.facets[:, :2]
    facets, n = surface.facets, (surface.facets >= 0).sum(axis=1)
    rows = np.arange(len(facets))
    return np.concatenate(
        [np.column_stack([facets[rows, i], facets[rows, (i + 1) % n]])[n > i] for i in range(facets.shape[1])]
    )


def _halvings(surface: Surface) -> Array:
    """How often (n,) the longest sides of facets are to be halved to be as those at each vertex; whole numbers."""
    a, b = _sides(surface).T
    length = np.linalg.norm(surface.places[a] - surface.places[b], axis=1)
    n = len(surface.places)
    at = np.concatenate([a, b])
    sizes = np.bincount(at, np.tile(length, 2), minlength=n) / np.bincount(at, minlength=n)
    return np.asarray(np.round(np.log2(sizes.max() / sizes)))


def _distances(surface: Surface) -> Array:
    """Distance (n,) of each vertex along the surface from one that is far out, part after part."""
    import scipy.sparse as sp

    n = len(surface.places)
    a, b = np.unique(np.sort(_sides(surface), axis=1), axis=0).T
    length = np.linalg.norm(surface.places[a] - surface.places[b], axis=1)
    graph = sp.csr_array((length, (a, b)), shape=(n, n))
    count, part = sp.csgraph.connected_components(graph, directed=False)
    distances = np.zeros(n)
    begin = 0.0
    for own in (np.flatnonzero(part == k) for k in range(count)):
        inner = graph[own][:, own]
        far = int(np.argmax(sp.csgraph.dijkstra(inner, directed=False, indices=0)))
        found = sp.csgraph.dijkstra(inner, directed=False, indices=far)
        distances[own] = found + begin
        begin = distances[own].max() + surface.size
    return distances


def _normals(surface: Surface) -> Array:
    """Mean (n, 3) of the unit normals of the facets about each vertex."""
    there = surface.facets >= 0
    at = surface.facets[there]
    normals = np.repeat(surface.normals, there.sum(axis=1), axis=0)
    n = len(surface.places)
    sums = np.column_stack([np.bincount(at, c, minlength=n) for c in normals.T])
    return np.asarray(sums / np.bincount(at, minlength=n)[:, None])
