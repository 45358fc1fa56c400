"""Periodic sides of bodies on splines: which control points keep how far apart they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.spline_space import SplineSpace
from visviva.mesh.periodic import differences, partners, translation

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CLOSE = 1e-9
"""Part of the size of a body, or of a value, by which sides may differ."""


def links(space: SplineSpace, pairs: Sequence[tuple[str, str]]) -> Any:
    """Differences (k, size) of control points of periodic sides, a sparse matrix.

    Raises
    ------
    InputError
        If functions or control points of sides differ.
    """
    return differences(leaders(space, pairs), space.size)


def leaders(space: SplineSpace, pairs: Sequence[tuple[str, str]]) -> Ints:
    """Of each control point (size,) the one that it moves with, see `links`."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    edges = np.concatenate([matched(space, *pair) for pair in pairs])
    graph = sp.coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(space.size,) * 2)
    _, group = connected_components(graph, directed=False)
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    return np.asarray(first[inverse])


def matched(space: SplineSpace, first: str, second: str) -> Ints:
    """Pairs (n, 2) of control points of two sides.

    Raises
    ------
    InputError
        If they do not fit.
    """
    from scipy.spatial import cKDTree

    nodes = partners(space.grid, first, second, "splines").T
    rows = [space.samples[some] for some in nodes]
    one, two = (np.unique(part.indices[np.abs(part.data) > 1e-12]) for part in rows)
    shift = translation(space.grid, first, second)[: space.control.shape[1]]
    distance, near = cKDTree(space.control[two]).query(space.control[one] + shift)
    fits = len(one) == len(two) and distance.max() <= CLOSE * np.ptp(space.control)
    if not fits or abs(rows[0][:, one] - rows[1][:, two[near]]).max() > CLOSE:
        raise InputError(
            f"control points, weights or knots of the sides {first!r} and {second!r} do not fit; those of periodic "
            "sides are the same but for a translation or a factor"
        )
    return np.column_stack([one, two[near]])
