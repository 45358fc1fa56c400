"""Sharp parts of closed surfaces: convex edges, corners where these meet, and flat faces with their borders."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva.contact.creases import neighbours

if TYPE_CHECKING:
    from visviva.contact.contact_surface import Surface

Ints = NDArray[np.int32]

SHARP = 30.0
"""Degrees between facets from which on what lies between them is an edge: less is the side of something round."""
ALONG = 1e-6
"""Sine of the angle up to which pieces of an edge are one."""
FLAT = 0.1
"""Degrees between facets up to which they are one face."""


class Parts(NamedTuple):
    """Sharp parts of a surface, by numbers of its vertices.

    Attributes
    ----------
    edges : array of int, (k, 4)
        Ends, a corner of the facet to the left, seen from outside from the first end to the second, and one of the
        facet to the right; the body is convex there.
    corners : list of int
        At which three convex edges meet or more, and none that is not.
    faces : list of tuple
        Of each flat face three of its corners, anticlockwise from outside, and the edges (b, 2) of its border.
    """

    edges: Ints
    corners: list[int]
    faces: list[tuple[Ints, Ints]]

    def beside(self, corner: int) -> list[int]:
        """The other ends of the edges of a corner."""
        return [int(b if a == corner else a) for a, b in self.edges[:, :2] if corner in (a, b)]


def sharp_parts(surface: Surface) -> Parts:
    """What a closed surface has."""
    sharp, flat = (np.cos(np.radians(angle)) for angle in (SHARP, FLAT))
    normals, facets = surface.normals, [row[row >= 0] for row in surface.facets]
    edges: list[tuple[int, ...]] = []
    dented: set[int] = set()
    joined: list[tuple[int, int]] = []
    for f, a, g, _ in neighbours(surface):
        start, end = facets[f][a]
        left, right = (next(v for v in facets[k] if v not in (start, end)) for k in (f, g))
        along = normals[f] @ normals[g]
        if along > flat:
            joined.append((f, g))
        elif along < sharp and normals[f] @ (surface.places[right] - surface.places[start]) < 0:
            edges.append((start, end, left, right))
        elif along < sharp:
            dented.update((int(start), int(end)))
    found = np.array(_straight(edges, surface.places), dtype=np.int32).reshape(-1, 4)
    meet = np.bincount(found[:, :2].ravel(), minlength=len(surface.forms))
    corners = [v for v in np.nonzero(meet >= 3)[0].tolist() if v not in dented]
    return Parts(found, corners, _faces(facets, joined, surface))


def _straight(edges: list[tuple[int, ...]], places: NDArray[np.float64]) -> list[tuple[int, ...]]:
    """Edges without the vertices that cut straight ones into pieces: at the end of a piece an edge goes on."""
    whole: dict[int, tuple[int, ...]] = dict(enumerate(edges))
    at: dict[int, list[int]] = {}
    for k, edge in whole.items():
        for v in edge[:2]:
            at.setdefault(int(v), []).append(k)
    for v, meeting in at.items():
        if len(meeting) != 2 or meeting[0] == meeting[1]:
            continue
        one, two = (whole[k] for k in meeting)
        a, _, left, right = one if one[1] == v else (one[1], one[0], one[3], one[2])
        c = two[1] if two[0] == v else two[0]
        ahead, behind = places[v] - places[a], places[c] - places[v]
        if np.linalg.norm(np.cross(ahead, behind)) > ALONG * np.linalg.norm(ahead) * np.linalg.norm(behind):
            continue
        kept, gone = meeting
        whole[kept] = (a, c, left, right)
        del whole[gone]
        at[int(c)][at[int(c)].index(gone)] = kept
    return list(whole.values())


def _faces(facets: list[Ints], joined: list[tuple[int, int]], surface: Surface) -> list[tuple[Ints, Ints]]:
    import scipy.sparse as sp

    i, j = np.array(joined, dtype=np.int64).reshape(-1, 2).T
    graph = sp.coo_array((np.ones(len(i)), (i, j)), shape=(len(facets),) * 2)
    group = sp.csgraph.connected_components(graph, directed=False)[1]
    areas = np.linalg.norm(surface._area_vectors(), axis=1)
    faces = []
    for number in range(group.max(initial=-1) + 1):
        members = np.nonzero(group == number)[0]
        sides = {(int(a), int(b)) for k in members for a, b in pairwise([*facets[k], facets[k][0]])}
        border = [(a, b) for a, b in sorted(sides) if (b, a) not in sides]
        largest = facets[members[np.argmax(areas[members])]]
        faces.append((largest[:3].astype(np.int32), np.array(border, dtype=np.int32).reshape(-1, 2)))
    return faces
