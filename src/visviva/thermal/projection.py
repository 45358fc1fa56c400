"""Projection of temperatures at quadrature points onto shape functions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Projected(NamedTuple):
    """Cells of one type: numbers (m, k) of their functions, values (m, q, k) or (q, k) of these, sizes (m, q)."""

    numbers: Ints
    N: Array
    sizes: Array


class Projection:
    """Projection in the mean square: what weak equations take the values at quadrature points to be.

    Parameters
    ----------
    n : int
        Number of functions.
    parts : sequence of Projected
        Cells, type by type.
    """

    def __init__(self, n: int, parts: Sequence[Projected]) -> None:
        import scipy.sparse as sp
        from scipy.sparse.linalg import splu

        self.n, self.parts, entries = n, parts, []
        for part in parts:
            weighted = part.sizes[..., None] * part.N
            block = np.einsum("mqa,mqb->mab", weighted, np.broadcast_to(part.N, weighted.shape))
            row, column = np.broadcast_arrays(part.numbers[:, :, None], part.numbers[:, None, :])
            entries.append((block.ravel(), row.ravel(), column.ravel()))
        values, rows, columns = (np.concatenate(part) for part in zip(*entries, strict=True))
        self._factors = splu(sp.csc_array((values, (rows, columns)), shape=(n, n)))

    def __call__(self, values: Sequence[Array]) -> Array:
        """Coefficients (n, ...) of the functions, from values (m, q, ...) at the points of each part."""
        total = np.zeros((self.n, *values[0].shape[2:]))
        for part, found in zip(self.parts, values, strict=True):
            weighted = part.sizes[..., None] * part.N
            np.add.at(total, part.numbers, np.einsum("mqk,mq...->mk...", weighted, found))
        return np.asarray(self._factors.solve(total))
