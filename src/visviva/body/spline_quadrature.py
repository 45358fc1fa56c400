"""Gauss points of knot spans, and how many a rational patch needs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.geometry import determinant
from visviva.mesh.spline import SplinePatch

Array = NDArray[np.float64]
CLOSE = 1e-6
"""Part of a knot span's volume that more points may change."""
MOST = 12
"""So many points more than of a patch that is not rational."""
PIECE = 20_000
"""Points evaluated at once."""


def gauss_points(patch: SplinePatch, counts: Sequence[int]) -> tuple[Array, Array]:
    """Parameters (m q, d) of Gauss points, some in each direction, and weights (m, q)."""
    places, weights = [], []
    for k, n in enumerate(counts):
        x, w = np.polynomial.legendre.leggauss(n)
        b = patch.breaks(k)
        half = 0.5 * np.diff(b)
        places.append(b[:-1, None] + half[:, None] * (1 + x))
        weights.append(half[:, None] * w)
    d = patch.dimension

    def spread(parts: Sequence[Array], k: int) -> Array:
        """Of direction k on all spans, then all points."""
        spans, n = patch.counts, [len(a[0]) for a in parts]
        shape = [1] * (2 * d)
        shape[k], shape[d + k] = spans[k], n[k]
        return np.broadcast_to(parts[k].reshape(shape), (*spans, *n)).reshape(int(np.prod(spans)), -1)

    xi = np.stack([spread(places, k) for k in range(d)], axis=-1)
    w = np.prod([spread(weights, k) for k in range(d)], axis=0)
    return xi.reshape(-1, d), np.asarray(w)


def points_needed(patch: SplinePatch) -> list[int]:
    """Points by direction: the degree and one, and on rational patches as many more as volumes take to stand.

    Raises
    ------
    InputError
        If weights are too uneven for that.
    """
    counts = [p + 1 for p in patch.degrees]
    if patch.weights is None or np.ptp(patch.weights) == 0 or volumes(patch, counts).min() <= 0:
        return counts  # exact, or folded
    for k, p in enumerate(patch.degrees):
        while not stands(patch, counts, k):
            counts[k] += 1
            if counts[k] > p + 1 + MOST:
                raise InputError(
                    f"weights from {patch.weights.min():g} to {patch.weights.max():g} of a patch of splines are too "
                    f"uneven along direction {k} to be integrated; divide its knot spans by refined(2)"
                )
    return counts


def stands(patch: SplinePatch, counts: Sequence[int], k: int) -> bool:
    """Whether two more points of direction k leave the volumes of all knot spans."""
    more = [n + 2 * (a == k) for a, n in enumerate(counts)]
    some, exact = volumes(patch, counts), volumes(patch, more)
    return bool(np.all(np.abs(some - exact) <= CLOSE * np.abs(exact)))


def volumes(patch: SplinePatch, counts: Sequence[int]) -> Array:
    """Of all knot spans (m,)."""
    xi, w = gauss_points(patch, counts)
    P = patch.control.reshape(-1, patch.dimension)
    parts = []
    for piece in np.split(xi, np.arange(PIECE, len(xi), PIECE)):
        numbers, _, dN, _ = patch.functions(piece)
        parts.append(determinant(np.einsum("nka,nkc->nca", dN, P[numbers])))
    return np.asarray((np.concatenate(parts).reshape(w.shape) * w).sum(axis=1))
