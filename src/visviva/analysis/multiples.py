"""Eigenvalues that stand several times: Krylov spaces of one vector hold each once, and find the others by rounding."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

Array = NDArray[np.float64]


def beside(operator: LinearOperator, z: Array, weight: Any) -> LinearOperator:
    """An operator that is symmetric with a weight, on what is orthogonal to the vectors `z` (n, k) found so far."""
    import scipy.sparse.linalg as spl

    weighted = weight @ z
    gram = z.T @ weighted

    def product(r: Array) -> Array:
        found: Array = operator @ np.ravel(r)
        return np.asarray(found - z @ np.linalg.solve(gram, weighted.T @ found), dtype=float)

    return spl.LinearOperator(operator.shape, matvec=product, dtype=float)


def completed(
    operator: LinearOperator,
    values: Array,
    z: Array,
    weight: Any,
    distance: Callable[[Array], Array],
    more: Callable[[LinearOperator], tuple[Array, Array]],
) -> tuple[Array, Array]:
    """The `values` (k,) with vectors (n, k) of least `distance`, where some of them may have been missed.

    `more` finds the nearest few of an operator. It is asked for what lies beside those found until nothing there is
    nearer than the farthest of them.
    """
    k = len(values)
    while len(values) and len(values) < z.shape[0] // 2:
        others, y = more(beside(operator, z, weight))
        nearer = distance(others) < (1 - 1e-9) * np.sort(distance(values))[k - 1]
        if not nearer.any():
            break
        values, z = np.concatenate([values, others[nearer]]), np.concatenate([z, y[:, nearer]], axis=1)
    order = np.argsort(distance(values), kind="stable")[:k]
    return values[order], z[:, order]
