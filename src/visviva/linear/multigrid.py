"""Aggregates of algebraic multigrid by PyAMG; what depends on the values of a matrix is made in the core."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
COARSEST = 60
"""Blocks at which the coarsest grid is solved directly."""
MOST_LEVELS = 10


def aggregates(row: Ints, col: Ints, m: int, modes: Array) -> list[tuple[int, NDArray[np.int32], Array]]:
    """Aggregates from level to level of a matrix of blocks; they follow from its pattern alone.

    Parameters
    ----------
    row, col : array of int
        Compressed rows of the blocks.
    m : int
        Rows and columns of a block.
    modes : array, (n, n_modes)
        Near-null vectors; none means one constant per row of a block.

    Returns
    -------
    list of (number, of, tentative)
        For every level but the coarsest: how many aggregates there are, to which one a block row belongs or -1 (n,),
        and the blocks of the tentative prolongation (n, rows, columns).

    Examples
    --------
    >>> aggregates(np.array([0, 1]), np.array([0]), 1, np.ones((1, 1)))  # nothing to make coarser
    []
    """
    import scipy.sparse as sp
    from pyamg.aggregation.aggregate import standard_aggregation
    from pyamg.aggregation.tentative import fit_candidates

    n = len(row) - 1
    pattern: Any = sp.csr_array((np.ones(len(col), bool), col.astype(np.int32), row.astype(np.int32)), (n, n))
    B = np.array(modes) if modes.shape[1] else np.tile(np.eye(m), (n, 1))
    levels: list[tuple[int, NDArray[np.int32], Array]] = []
    while n > COARSEST and len(levels) < MOST_LEVELS - 1:
        groups = standard_aggregation(pattern)[0]
        number = groups.shape[1]
        if groups.nnz == 0 or number == n:
            break
        Q, B = fit_candidates(groups, B)
        joined = np.flatnonzero(np.diff(groups.indptr))
        of = np.full(n, -1, np.int32)
        of[joined] = groups.indices
        tentative = np.zeros((n, *Q.blocksize))
        tentative[joined] = Q.data
        levels.append((number, of, tentative))
        way = pattern @ groups.astype(bool)
        pattern, n = sp.csr_array(way.T @ (pattern @ way)), number
    return levels
