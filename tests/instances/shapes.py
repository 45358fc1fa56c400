"""Shape functions and Gauss points of the tiny instances."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)


def hex8(xi: Array) -> tuple[Array, Array]:
    """Trilinear shape functions (8,) and their derivatives (8, 3) at `xi` in the cube from -1 to 1."""
    factors = 0.5 * (1 + CORNERS * xi)
    slopes = 0.5 * CORNERS
    gradient = np.stack([slopes[:, k] * np.delete(factors, k, axis=1).prod(axis=1) for k in range(3)], axis=1)
    return factors.prod(axis=1), gradient


def quad9(xi: Array) -> tuple[Array, Array]:
    """Biquadratic shape functions (9,) and their derivatives (9, 2) at `xi` in the square from -1 to 1."""

    def line(s: float) -> tuple[Array, Array]:
        return np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array([s - 0.5, -2 * s, s + 0.5])

    (a, da), (b, db) = line(xi[0]), line(xi[1])
    return np.outer(a, b).ravel(), np.stack([np.outer(da, b).ravel(), np.outer(a, db).ravel()], axis=1)


def gauss(n: int, dimension: int) -> tuple[Array, Array]:
    """Points (n^d, d) and weights (n^d,) on the cube from -1 to 1."""
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.stack(np.meshgrid(*[x] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    weights = (
        np.stack(np.meshgrid(*[w] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension).prod(axis=1)
    )
    return points, weights


def neo_hooke(C: Array) -> Array:
    """``(tr C - 3 - 2 ln J)/2 + (ln J)^2/2`` of (C11, C22, C33, C12, C23, C31); both Lame constants are 1."""
    det = (
        C[0] * (C[1] * C[2] - C[4] ** 2)
        - C[3] * (C[3] * C[2] - C[4] * C[5])
        + C[5] * (C[3] * C[4] - C[1] * C[5])
    )
    log_j = 0.5 * np.log(det)
    energy: Array = 0.5 * (C[0] + C[1] + C[2] - 3 - 2 * log_j) + 0.5 * log_j**2
    return energy
