"""Surfaces as a page in the browser draws them: corners with one normal each, triangles, lines and dots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.output.skin import skin
from visviva.output.surface import Surface

Ints = NDArray[np.int64]
SHARP = 35.0
"""Degrees between neighbouring faces from which on their edge is drawn, and not smoothed."""


@dataclass(frozen=True)
class Shape:
    """One surface as it is drawn.

    Attributes
    ----------
    corners : (n,) array
        Points of the corners of triangles; a point has a corner for every normal that it needs.
    triangles : (m, 3) array
        Of corners.
    edges : (k, 2) array
        Of points: lines, and sharp edges of faces.
    mesh : (k, 2) array
        Of points: edges of all faces.
    dots : (k,) array
        Points that are drawn as such.
    """

    corners: Ints
    triangles: Ints
    edges: Ints
    mesh: Ints
    dots: Ints

    @property
    def used(self) -> Ints:
        """Points that are drawn, in order."""
        return np.unique(np.concatenate([self.corners, self.edges.ravel(), self.dots]))


def shape_of(surface: Surface) -> Shape:
    """Drawable form of a surface.

    Examples
    --------
    >>> square = Surface("square", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> shape = shape_of(square)
    >>> len(shape.corners), len(shape.triangles), len(shape.edges)
    (4, 2, 4)
    """
    faces = skin(surface)
    triangles = triangulated(faces)
    corners, of_corners, sharp = smoothed(surface.points, triangles)
    lines = [block for block in surface.cells if block.shape[1] == 2]
    single = [block.ravel() for block in surface.cells if block.shape[1] == 1]
    return Shape(
        corners,
        of_corners,
        np.concatenate([sharp, *lines]),
        _edges(faces),
        np.concatenate([np.zeros(0, dtype=np.int64), *single]),
    )


def triangulated(faces: Sequence[Ints]) -> Ints:
    """Triangles (m, 3) that fill plane faces."""
    fans = [block[:, [0, k, k + 1]] for block in faces for k in range(1, block.shape[1] - 1)]
    return np.concatenate([np.zeros((0, 3), dtype=np.int64), *fans])


def smoothed(points: NDArray[np.float64], triangles: Ints) -> tuple[Ints, Ints, Ints]:
    """Give points a corner on each side of sharp edges.

    Returns
    -------
    corners : (n,) array of points
    triangles : (m, 3) array of corners
    sharp : (k, 2) array of points
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    n = triangles.size
    if not n:
        return np.zeros(0, dtype=np.int64), triangles, np.zeros((0, 2), dtype=np.int64)
    first, second, smooth, sharp = _neighbours(points, triangles)
    a, b = first[smooth], second[smooth]
    # the edge k of a triangle goes from its corner k to the next one; the neighbour runs along it either way
    ends_a, ends_b = (np.stack([k, k // 3 * 3 + (k + 1) % 3]) for k in (a, b))
    turned = triangles.ravel()[ends_a[0]] != triangles.ravel()[ends_b[0]]
    ends_b = np.where(turned, ends_b[::-1], ends_b)
    pairs = (np.ones(ends_a.size), (ends_a.ravel(), ends_b.ravel()))
    count, label = connected_components(coo_matrix(pairs, shape=(n, n)), directed=False)
    corners = np.zeros(count, dtype=np.int64)
    corners[label] = triangles.ravel()
    return corners, label.reshape(-1, 3).astype(np.int64), sharp


def _neighbours(points: NDArray[np.float64], triangles: Ints) -> tuple[Ints, Ints, NDArray[np.bool_], Ints]:
    """Pairs of equal edges of triangles, which of them are smooth, and the points of those that are sharp."""
    p = points[triangles]
    normals = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    directed = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, which, counts = np.unique(
        np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.argsort(which.ravel(), kind="stable")
    starts = np.cumsum(counts) - counts
    paired = counts == 2
    first, second = order[starts[paired]], order[starts[paired] + 1]
    straight = np.where(directed[first, 0] == directed[second, 0], -1.0, 1.0)
    cosine = straight * np.einsum("ij,ij->i", normals[first // 3], normals[second // 3])
    smooth = cosine > np.cos(np.radians(SHARP))
    sharp = ~paired
    sharp[np.flatnonzero(paired)[~smooth]] = True
    return first, second, smooth, edges[sharp]


def _edges(faces: Sequence[Ints]) -> Ints:
    """Edges (k, 2) of faces, each once."""
    sides = [np.stack([block, np.roll(block, -1, axis=1)], axis=-1).reshape(-1, 2) for block in faces]
    if not sides:
        return np.zeros((0, 2), dtype=np.int64)
    return np.unique(np.sort(np.concatenate(sides), axis=1), axis=0)
