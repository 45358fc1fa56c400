"""Equations scaled by the sizes of their unknowns, so that nothing depends on units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
VANISHING = 1e-60
"""Part of the largest entry: what cancels may leave less, whose inverse overflows."""

ROUNDING = 1e-30
"""Part of the largest energy: entries below it are what cancels, and rows without others have no size of their own."""

SWEEPS = 12
"""Each takes the root of what rows differ by; bodies of grams beside such of thousands of tons need some ten."""


def typical(values: Array) -> float:
    """Median of the positive values, 1 without any."""
    positive = values[values > 0]
    return float(np.median(positive)) if len(positive) else 1.0


def by_weight(own: Array, scale: Array) -> Array:
    """Changes (n,) of coordinates that weigh one: kg and kg m^2 do not compare.

    Those without an own mass (0 in `own`) are measured by what others weigh that move by their scales.
    """
    weight = own * scale**2
    return scale / np.sqrt(np.where(own > 0, weight, typical(weight)))


def equilibration(K: sp.csr_array, scale: Array) -> Array:
    """Factors that scale rows and columns of a symmetric matrix to largest entries near one.

    The sweeps begin where units do not count, as those of ``cpp/visviva/linear/scaled.cpp``; else directors without
    mass or stiffness, for instance, would shrink until what is tied to them does not feel them.

    Parameters
    ----------
    K : sparse array (n, n)
    scale : array (n,)
        A large change of each unknown, 0 for those that stand for forces.
    """

    K = abs(K).tocsr()
    s = by_units(K, scale)
    energy = np.repeat(s, np.diff(K.indptr)) * K.data * s[K.indices]
    K.data[energy < ROUNDING * energy.max(initial=0.0)] = 0.0
    for _ in range(SWEEPS):
        largest = s * row_maxima(K, s)
        largest[largest == 0] = 1.0
        s /= np.sqrt(largest)
        if np.abs(np.log2(largest)).max(initial=0.0) < 1:
            break
    return s


def row_maxima(K: sp.csr_array, factors: Array) -> Array:
    """Largest entry (n,) in each row of a matrix without signs whose columns are scaled by factors (n,)."""
    largest, rows = np.zeros(len(factors)), np.flatnonzero(np.diff(K.indptr))
    if len(rows):
        largest[rows] = np.maximum.reduceat(K.data * factors[K.indices], K.indptr[rows])
    return largest


def by_units(K: sp.csr_array, scale: Array) -> Array:
    """Factors that make all entries of a matrix without signs parts of one energy, each part of it that is coupled."""

    from scipy.sparse.csgraph import connected_components

    n_parts, part = connected_components(K, directed=False)
    reach, own = row_maxima(K, scale), K.diagonal()
    unit = np.sqrt(typical_of_parts(reach * scale, part, n_parts))[part]
    reach[reach < VANISHING * reach.max(initial=0.0)] = 0.0
    of_forces = np.where(
        reach > 0, unit / np.where(reach > 0, reach, 1.0), 1 / np.sqrt(np.where(own > 0, own, 1.0))
    )
    return np.where(scale > 0, scale / unit, of_forces)


def typical_of_parts(effect: Array, part: NDArray[np.int32], n_parts: int) -> Array:
    """Median (n_parts,) of those of each part that are not negligible beside its largest, 1 for parts of zeros.

    The largest of all, where a part is what cancels beside others: what only a constraint holds. Of all parts at once,
    for a diagonal matrix has as many as rows.
    """
    largest = np.zeros(n_parts)
    np.maximum.at(largest, part, effect)
    counted = np.flatnonzero(effect > 1e-8 * largest[part])
    counted = counted[np.lexsort((effect[counted], part[counted]))]
    n = np.bincount(part[counted], minlength=n_parts)
    present = np.flatnonzero(n)
    first = (np.cumsum(n) - n)[present]
    medians = np.ones(n_parts)
    lower, upper = (counted[first + k] for k in ((n[present] - 1) // 2, n[present] // 2))
    middle = 0.5 * (effect[lower] + effect[upper])
    most = middle.max(initial=0.0)
    medians[present] = np.where(middle < ROUNDING * most, most, middle)
    return medians


def asymmetry(K: sp.csr_array) -> tuple[float, int]:
    """Largest difference of entries of a matrix across the diagonal, whatever the units, and in which row it stands.

    How rows and columns are scaled for that: ``cpp/visviva/linear/asymmetry.hpp``.

    Examples
    --------
    >>> import scipy.sparse as sp
    >>> size, row = asymmetry(sp.csr_array([[4.0, 0.6], [0.0, 9.0]]))
    >>> round(size, 9), row
    (0.1, 0)
    """
    A = K.tocsr(copy=True)  # the next line brings columns into order
    A.sum_duplicates()
    return _core.asymmetry(A.indptr.astype(np.int64), A.indices.astype(np.int32), A.data)
