"""Normals of thin bodies, by how their points lie."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AROUND, THIN = 2.5, 1.0
"""In edges of cells: how far around a place points of a body are looked at, and how thick a thin body is at most."""
SIGHT = 2 * AROUND
"""So many edges away points still take part in a normal."""
AT_ONCE = 1_000_000
"""So many pairs of a place and a point near it are kept at a time, or those of a single place."""
ROUNDING = 1e-9
"""Squares of extents, in edges of cells, that may be rounding."""


def normals(points: Array, at: Array, edge: float) -> Array:
    """Normals (m, d) of a thin body with `points` (n, d) near places (m, d), zero where it is thick or far away.

    A body is thin at a point if those around, nearer ones counting more, extend by less than an `edge` in one
    direction, and farther in the others.

    Examples
    --------
    >>> flap = np.stack(np.meshgrid([0.0, 0.01], np.linspace(0, 1, 21)), axis=-1).reshape(-1, 2)
    >>> np.abs(normals(flap, np.array([(0.1, 0.5), (3.0, 0.5)]), 0.1)).round(6).tolist()
    [[1.0, 0.0], [0.0, 0.0]]
    """
    d = points.shape[1]
    extents, axes = extents_around(points, edge)
    own = np.where(thin(extents, THIN * edge)[:, None], axes[:, :, 0], 0.0)
    if not own.any():
        return np.zeros((len(at), d))
    share, axes = np.linalg.eigh(_means(points, at, AROUND * edge, _square(own)).reshape(-1, d, d))
    return np.where(share[:, -1:] > 0.5, axes[:, :, -1], 0.0)


def thin(extents: Array, thickness: float) -> NDArray[np.bool_]:
    """Mask of those extents (n, d) that belong to a layer thinner than a thickness, and not to a line or point."""
    return np.asarray((extents[:, 0] < thickness) & (extents[:, 1] > 2 * extents[:, 0]))


def extents_around(points: Array, edge: float) -> tuple[Array, Array]:
    """Extents (n, d) of a body around its points, from the least, with their axes (n, d, d) in columns.

    They are those of a layer whose points have the same variance.
    """
    d = points.shape[1]
    away = (points - points.mean(axis=0)) / edge
    found = _means(points, points, AROUND * edge, np.hstack([away, _square(away)]))
    squares, axes = np.linalg.eigh(found[:, d:].reshape(-1, d, d) - _square(found[:, :d]).reshape(-1, d, d))
    return edge * np.sqrt(12 * np.where(squares < ROUNDING, 0.0, squares)), axes


def _means(points: Array, at: Array, reach: float, values: Array) -> Array:
    """Means (m, c) of values (n, c) of the points near places, by smooth weights; zero where there are none."""
    from scipy.spatial import cKDTree

    tree, means = cKDTree(points), np.zeros((len(at), values.shape[1]))
    for mine in _parts(tree.query_ball_point(at, reach, return_length=True)):
        near = cKDTree(at[mine]).sparse_distance_matrix(tree, reach, output_type="coo_matrix").tocsr()
        near.data = (1 - (near.data / reach) ** 2) ** 2
        total = near.sum(axis=1).reshape(-1, 1)
        means[mine] = np.where(total > 0, (near @ values) / np.maximum(total, 1e-300), 0.0)
    return means


def _parts(counts: NDArray[np.int64]) -> Iterator[slice]:
    """Parts of places one after the other, by how many points are near each."""
    group = np.cumsum(counts) // AT_ONCE
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    for begin, end in zip(starts, [*starts[1:], len(counts)], strict=True):
        yield slice(int(begin), int(end))


def _square(a: Array) -> Array:
    return np.asarray((a[:, :, None] * a[:, None, :]).reshape(len(a), -1))
