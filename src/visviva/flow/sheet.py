"""Normals of thin bodies, by how their points lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AROUND, THIN = 2.5, 1.0
"""In edges of cells: how far around a place points of a body are looked at, and how thick a thin body is at most."""
SIGHT = 2 * AROUND
"""So many edges away points still take part in a normal."""


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
    row, k, weight = _near(points, points, AROUND * edge)
    away = points[k] - points[row]
    mean = _mean(row, weight, away, len(points))
    squares = _mean(row, weight, _square(away), len(points)).reshape(-1, d, d)
    size, axes = np.linalg.eigh(squares - mean[:, :, None] * mean[:, None, :])
    is_thin = (12 * size[:, 0] < (THIN * edge) ** 2) & (size[:, 1] > 4 * np.abs(size[:, 0]))
    own = np.where(is_thin[:, None], axes[:, :, 0], 0.0)
    row, k, weight = _near(points, at, AROUND * edge)
    share, axes = np.linalg.eigh(_mean(row, weight, _square(own[k]), len(at)).reshape(-1, d, d))
    return np.where(share[:, -1:] > 0.5, axes[:, :, -1], 0.0)


def _near(points: Array, at: Array, reach: float) -> tuple[Array, Array, Array]:
    """Places, points that are near, and smooth weights of these."""
    from scipy.spatial import cKDTree

    found = cKDTree(at).sparse_distance_matrix(cKDTree(points), reach, output_type="coo_matrix")
    return found.row, found.col, (1 - (found.data / reach) ** 2) ** 2


def _square(a: Array) -> Array:
    return np.asarray((a[:, :, None] * a[:, None, :]).reshape(len(a), -1))


def _mean(row: Array, weight: Array, values: Array, n: int) -> Array:
    """Weighed means (n, c) of values (k, c) by row; zero without any."""
    total = np.stack([np.bincount(row, weight * v, minlength=n) for v in values.T], axis=1)
    mass = np.bincount(row, weight, minlength=n)[:, None]
    return np.asarray(np.where(mass > 0, total / np.maximum(mass, 1e-300), 0.0))
