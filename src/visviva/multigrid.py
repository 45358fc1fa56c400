"""Grids of algebraic multigrid by smoothed aggregation, from PyAMG; the cycle itself runs in the core."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
COARSEST = 60
"""Blocks at which the coarsest grid is solved directly."""


def grids(row: Ints, col: Ints, values: Array, modes: Array) -> list[tuple[Any, Any, Any]]:
    """Grids for a matrix of blocks.

    Parameters
    ----------
    row, col : array of int
        Compressed rows of the blocks.
    values : array, (n_blocks, m, m)
        Blocks, each by columns.
    modes : array, (n, n_modes)
        Near-null vectors; none means one constant per row of a block.

    Returns
    -------
    list of (matrix, prolongation, restriction)
        Each a tuple (row, col, values by rows); the first matrix and the last ways down are None.
    """
    import pyamg
    import scipy.sparse as sp

    n = (len(row) - 1) * values.shape[1]
    blocks = np.ascontiguousarray(values.transpose(0, 2, 1))
    matrix = sp.bsr_matrix((blocks, np.array(col), np.array(row)), shape=(n, n))
    state = np.random.get_state()  # noqa: NPY002 - PyAMG draws from the global generator
    np.random.seed(0)  # noqa: NPY002
    try:
        hierarchy = pyamg.smoothed_aggregation_solver(
            matrix,
            B=np.array(modes) if modes.shape[1] else None,
            strength=("symmetric", {"theta": 0.0}),
            improve_candidates=None,
            max_coarse=COARSEST,
            presmoother=None,
            postsmoother=None,
        )
    finally:
        np.random.set_state(state)  # noqa: NPY002
    return [
        (
            _parts(level.A) if k > 0 else None,
            _parts(getattr(level, "P", None)),
            _parts(getattr(level, "R", None)),
        )
        for k, level in enumerate(hierarchy.levels)
    ]


def _parts(matrix: Any) -> tuple[Ints, Ints, Array] | None:
    if matrix is None:
        return None
    blocks = matrix if matrix.format == "bsr" else matrix.tobsr((1, 1))
    blocks.sort_indices()
    return (
        blocks.indptr.astype(np.int64),
        blocks.indices.astype(np.int64),
        np.ascontiguousarray(blocks.data, dtype=float),
    )
