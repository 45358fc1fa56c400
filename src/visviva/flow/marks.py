"""Marks of a rigid body that follow a fluid: points on its surface and inside, about equally far apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva.body.shape import AnyShape

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

CORNER = np.cos(np.radians(25.0))
"""Angle above which an outline is taken to have a corner."""
NEAR = 0.6
"""Marks closer than this part of the spacing become one, in their middle: thin bodies have one layer."""
INSIDE = 0.75
"""Marks inside are at least this many spacings away from the surface."""

BLOCK = 20000
"""So many pairs of a place and a triangle are looked at together: arrays that stay in the cache."""


def marks(shape: AnyShape, spacing: float, *, plane: bool) -> Array:
    """Marks (n, 3) of a shape, of a prism along z in the plane of its centre, in coordinates of the body.

    Examples
    --------
    >>> import visviva as vv
    >>> found = marks(vv.Box(size=(4.0, 0.1, 1.0)), 1.0, plane=True)
    >>> found[np.argsort(found[:, 0]), :2].round(9).tolist()
    [[-2.0, 0.0], [-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    """
    points, triangles = shape.surface(resolution=96)
    around = outline(points, triangles, spacing) if plane else covering(points, triangles, spacing)
    within = lattice(points, spacing, plane)
    within = within[winding(points[triangles], within) > 0.5]
    if len(within):
        within = within[_distance(within, around) >= INSIDE * spacing]
    return merged(np.vstack([around, within]), NEAR * spacing)


def lattice(points: Array, spacing: float, plane: bool) -> Array:
    """Points (n, 3) of a cubic lattice about the middle of a box."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    steps = [np.arange(-n, n + 1) * spacing for n in (half // spacing).astype(int)]
    if plane:
        steps[2] = np.zeros(1)
    grid = np.meshgrid(*steps, indexing="ij")
    return np.asarray(middle + np.stack([g.ravel() for g in grid], axis=1))


def winding(corners: Array, places: Array) -> Array:
    """Winding number of a closed surface of triangles (m, 3, 3) about places (n,): 1 inside, 0 outside."""
    middle = corners.mean(axis=(0, 1))
    corners, places = (
        corners - middle,
        places - middle,
    )  # far from the origin differences of products lose digits
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    offsets = np.einsum("ni,ni->n", a, normals)
    squares = [np.einsum("ni,ni->n", e, e) for e in (b - a, c - b, a - c)]
    several = max(BLOCK // len(corners), 1)
    blocks = np.array_split(places, range(several, len(places), several))
    return np.concatenate([_winding(corners, normals, offsets, squares, some) for some in blocks])


def _winding(corners: Array, normals: Array, offsets: Array, squares: list[Array], places: Array) -> Array:
    """Winding numbers of a few places: solid angles by the distances to corners and the lengths of edges alone."""
    A, B, C = (np.sqrt(sum((corners[:, k, i] - places[:, i, None]) ** 2 for i in range(3))) for k in range(3))
    # twice the products of the vectors to two corners, by the law of cosines
    ab, bc, ca = (p * p + q * q - e for (p, q), e in zip(((A, B), (B, C), (C, A)), squares, strict=True))
    angles = np.arctan2(offsets - places @ normals.T, A * B * C + 0.5 * (ab * C + bc * A + ca * B))
    return np.asarray(angles.sum(axis=1) / (2 * np.pi))


# --- the surface --------------------------------------------------------------------------------------------
def outline(points: Array, triangles: Ints, spacing: float) -> Array:
    """Points (n, 3) on the section of a prism halfway along z: all its corners, and others between them."""
    z = points[:, 2].mean()
    found = []
    for loop in _loops(points, triangles, z):
        edge = np.roll(loop, -1, axis=0) - loop
        along = edge / np.linalg.norm(edge, axis=1)[:, None]
        corners = np.flatnonzero(np.einsum("ni,ni->n", along, np.roll(along, 1, axis=0)) < CORNER)
        first = corners if len(corners) else np.zeros(1, dtype=int)
        for start, end in zip(first, np.append(first[1:], first[0] + len(loop)), strict=True):
            found.append(_divided(loop[np.arange(start, end + 1) % len(loop)], spacing))
    xy = np.vstack(found)
    return np.column_stack([xy, np.full(len(xy), z)])


def _divided(path: Array, spacing: float) -> Array:
    """Points (n, 2) that divide a path equally, its end left out."""
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    n = max(int(np.round(length[-1] / spacing)), 1)
    at = np.arange(n) * length[-1] / n
    return np.stack([np.interp(at, length, path[:, i]) for i in (0, 1)], axis=1)


def _loops(points: Array, triangles: Ints, z: float) -> list[Array]:
    """Closed polygons (n, 2) in which a surface cuts the plane at z."""
    follows: dict[tuple[float, float], tuple[float, float]] = {}
    side = points[:, 2] - z
    for t in triangles:
        above = side[t] > 0
        if above.all() or not above.any():
            continue
        ends = {}
        for i, j in ((0, 1), (1, 2), (2, 0)):
            if above[i] != above[j]:
                p, q = points[t[i]], points[t[j]]
                cut = p + (q - p) * side[t[i]] / (side[t[i]] - side[t[j]])
                ends[bool(above[i])] = (round(float(cut[0]), 12), round(float(cut[1]), 12))
        follows[ends[True]] = ends[False]
    loops = []
    while follows:
        first, place = follows.popitem()
        loop = [first]
        while place != first:
            loop.append(place)
            place = follows.pop(place)
        loops.append(np.array(loop))
    return loops


def covering(points: Array, triangles: Ints, spacing: float) -> Array:
    """Points (n, 3) on a surface, none closer to another than 0.8 spacings: corners first."""
    fine = [points]
    for a, b, c in points[triangles]:
        n = int(np.ceil(4 * max(np.linalg.norm(e) for e in (b - a, c - b, a - c)) / spacing))
        i, j = (w.ravel() for w in np.meshgrid(np.arange(n + 1), np.arange(n + 1)))
        s, t = (w[i + j <= n, None] / n for w in (i, j))
        fine.append(a + s * (b - a) + t * (c - a))
    return thinned(np.vstack(fine), 0.8 * spacing)


def shares(shape: AnyShape, places: Array, spacing: float, *, plane: bool) -> Array:
    """Areas (n,) of the surface of a shape that are nearest to marks (n, 3); in a plane those of the sides of a prism.

    Examples
    --------
    >>> import numpy as np
    >>> import visviva as vv
    >>> bar = vv.Box(size=(4.0, 2.0, 1.0))
    >>> shares(bar, np.array([[-2.0, 0, 0], [2.0, 0, 0], [0, 0, 0]]), 0.2, plane=True).round().tolist()
    [4.0, 4.0, 4.0]
    """
    from scipy.spatial import cKDTree

    points, triangles = shape.surface(resolution=96)
    corners = points[triangles]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    if plane:
        around = np.abs(normals[:, 2]) < 0.5 * areas
        corners, areas = corners[around], areas[around]
    found, seen = np.zeros(len(places)), slice(0, 2 if plane else 3)
    tree = cKDTree(places[:, seen])
    for triangle, area in zip(corners, areas, strict=True):
        longest = max(np.linalg.norm(triangle - np.roll(triangle, 1, axis=0), axis=1))
        middles = _middles(int(np.ceil(4 * longest / spacing))) @ triangle
        np.add.at(found, tree.query(middles[:, seen])[1], area / len(middles))
    return found


def _middles(n: int) -> Array:
    """Coordinates (n^2, 3) of the middles of equal parts of a triangle."""
    i, j = (w.ravel() for w in np.meshgrid(np.arange(n), np.arange(n)))
    up, down = i + j < n, i + j < n - 1
    first = np.concatenate([i[up] + 1 / 3, i[down] + 2 / 3]) / n
    second = np.concatenate([j[up] + 1 / 3, j[down] + 2 / 3]) / n
    return np.column_stack([first, second, 1 - first - second])


# --- distances ----------------------------------------------------------------------------------------------
def _distance(places: Array, others: Array) -> Array:
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(others).query(places)[0])


def thinned(places: Array, least: float) -> Array:
    """Places (n, 3) that keep a distance, those that come first."""
    from scipy.spatial import cKDTree

    tree, kept = cKDTree(places), np.ones(len(places), dtype=bool)
    for k in range(len(places)):
        if kept[k]:
            near = [j for j in tree.query_ball_point(places[k], least * (1 - 1e-9)) if j > k]
            kept[near] = False
    return places[kept]


def merged(places: Array, near: float) -> Array:
    """Places (n, 3) of which those that are near become one in their middle."""
    from scipy.spatial import cKDTree

    tree, left, found = cKDTree(places), np.ones(len(places), dtype=bool), []
    for k in range(len(places)):
        if left[k]:
            group = [j for j in tree.query_ball_point(places[k], near * (1 - 1e-9)) if left[j]]
            left[group] = False
            found.append(places[group].mean(axis=0))
    return np.array(found)
