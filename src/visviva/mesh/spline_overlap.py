"""Borders of patches of splines that lie on each other without being joined."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.spline import SplinePatch
from visviva.mesh.spline_borders import Border

Array = NDArray[np.float64]
NEAR = 1e-6
"""Part of the size of all patches within which borders that are not joined are no gap, but a mistake."""
WITHIN = np.array([0.02, 0.5, 0.98])
"""Places in each knot span where borders are compared."""
STEPS = 20
"""Of Newton's method, which is quadratic for points on a border."""


def refuse_open(
    patches: Sequence[SplinePatch],
    free: Sequence[Border],
    reasons: Mapping[tuple[int, int], str],
    size: float,
) -> None:
    """Refuse edges and sides that lie on each other, wholly or in part.

    Parameters
    ----------
    patches : sequence of SplinePatch
    free : sequence of Border
        Those that are not joined.
    reasons : mapping of pairs of numbers to str
        What sets borders apart that end in the same places.
    size : float
        Of all patches.

    Raises
    ------
    InputError
    """
    near = NEAR * size
    for a, b in candidates(patches, free, near):
        for one, other in ((a, b), (b, a)):
            points = inside(patches[one.patch], one)
            gaps = distances(patches[other.patch], other, points)
            if gaps.min() > near:
                continue
            if reason := reasons.get((a.number, b.number)):
                raise InputError(f"{a} and {b} have the same corners, but {reason}; give both the same")
            where = points[int(np.argmin(gaps))].round(6).tolist()
            raise InputError(
                f"{a} and {b} lie on each other at {where}, up to {gaps.min():.1e}, and are not the same: a crack "
                f"would stay open there; {cure(patches, a, b, near)}"
            )


def cure(patches: Sequence[SplinePatch], a: Border, b: Border, near: float) -> str:
    """Where to cut which patch."""
    for one, other in ((a, b), (b, a)):
        patch = patches[one.patch]
        points = patch.control.reshape(-1, patch.dimension)[
            one.control[np.ix_(*[[0, -1]] * one.control.ndim)].ravel()
        ]
        on = points[distances(patches[other.patch], other, points) <= near]
        ends = patches[other.patch].control.reshape(-1, patch.dimension)[
            other.control[np.ix_(*[[0, -1]] * other.control.ndim)].ravel()
        ]
        new = [p for p in on if np.linalg.norm(ends - p, axis=1).min() > near]
        if new:
            return f"cut patch {other.patch} at {new[0].round(6).tolist()} (SplinePatch.cut)"
    return "move their control points onto each other"


def candidates(
    patches: Sequence[SplinePatch], free: Sequence[Border], near: float
) -> Iterator[tuple[Border, Border]]:
    """Pairs of sides, then of edges, whose boxes have as many dimensions in common as they have."""
    for m in (2, 1):
        alike = [border for border in free if len(border.along) == m]
        if len(alike) < 2:
            continue
        points = [
            patches[b.patch].control.reshape(-1, patches[b.patch].dimension)[b.control.ravel()] for b in alike
        ]
        least, most = np.array([p.min(axis=0) for p in points]), np.array([p.max(axis=0) for p in points])
        for i, j in combinations(range(len(alike)), 2):
            common = np.minimum(most[i], most[j]) - np.maximum(least[i], least[j])
            if common.min() >= -near and np.count_nonzero(common > 2 * near) >= m:
                yield alike[i], alike[j]


def inside(patch: SplinePatch, border: Border) -> Array:
    """Points (n, d) of a border in each of its knot spans."""
    along = []
    for k in border.along:
        b = patch.breaks(k)
        along.append((b[:-1, None] + np.diff(b)[:, None] * WITHIN).ravel())
    return patch.at(parameters(patch, border, along))


def parameters(patch: SplinePatch, border: Border, along: Sequence[Array]) -> Array:
    """All parameters (n, d) of a border with given ones in its directions."""
    given = iter(along)
    every = [next(given) if end is None else patch.breaks(k)[[end]] for k, end in enumerate(border.ends)]
    return np.stack([a.ravel() for a in np.meshgrid(*every, indexing="ij")], axis=1)


def distances(patch: SplinePatch, border: Border, points: Array) -> Array:
    """Of points (n, d) from an edge or a side, (n,)."""
    from scipy.spatial import cKDTree

    P, along = patch.control.reshape(-1, patch.dimension), border.along
    ends = [patch.breaks(k) for k in along]
    fine = [
        np.interp(np.arange(4 * p * (len(b) - 1) + 1) / (4 * p), np.arange(len(b)), b)
        for b, p in zip(ends, (patch.degrees[k] for k in along), strict=True)
    ]
    grid = parameters(patch, border, fine)
    u = grid[cKDTree(patch.at(grid)).query(points)[1]]
    least, most = (np.array([b[i] for b in ends]) for i in (0, -1))
    for _ in range(STEPS):
        numbers, N, dN, _ = patch.functions(u)
        off = np.einsum("nk,nkc->nc", N, P[numbers]) - points
        J = np.einsum("nka,nkc->nca", dN[:, :, along], P[numbers])
        step = np.einsum("nac,nc->na", np.linalg.pinv(J), off)
        u[:, along] = np.clip(u[:, along] - step, least, most)
    return np.asarray(np.linalg.norm(patch.at(u) - points, axis=1))
