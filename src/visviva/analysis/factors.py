"""Factors of the symmetric equations of an analysis, by the solver that the options of the system name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.linear.choice import Direct, Problem

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]

SINGULAR = 1e-13
"""A scaled matrix is singular if it takes a vector to less than this part of its length."""


def factored(
    A: sp.csr_array,
    n_constraints: int,
    system: System,
    unknowns: NDArray[np.int64],
    whose: str = "modes",
    cure: str = "hold it, or give it mass",
) -> Callable[[Array], Array]:
    """The inverse of a symmetric matrix, by the factors that the system's options name; constraints come last.

    Raises
    ------
    InputError
        If the factors are estimated to need more memory than there is, or the matrix is singular.
    """
    A = A.tocsr()
    A.sort_indices()
    n = A.shape[0]
    constraint = np.r_[np.zeros(n - n_constraints, np.int32), np.ones(n_constraints, np.int32)]
    options = system.newton.linear if isinstance(system.newton.linear, Direct) else Direct()
    problem = Problem(n, A.nnz, symmetric=True, definite=True, n_multipliers=n_constraints)
    choices, none = list(options.choose(problem).in_order), np.zeros(0)
    row, col = A.indptr.astype(np.int64), A.indices.astype(np.int32)
    try:
        linear = _core.Linear(choices, row, col, none.astype(np.int32), none, constraint)
        done = linear.factor(A.data)
    except MemoryError as error:
        raise InputError(f"{whose}: {error}") from error
    if not done and (lu := pivoted(A)) is not None:
        return lu
    if not done:
        component, unknown = system.describe(int(unknowns[loosest(A)]))
        raise InputError(
            f"{whose}: the equations are singular: nothing determines {unknown} of {component}; {cure}"
        )

    def solve(r: Array) -> Array:
        x = np.zeros(n)
        if not linear.solve(np.ascontiguousarray(r), x):
            raise InputError(f"{whose}: {linear.message or 'the equations could not be solved'}; {cure}")
        return x

    return solve


def loosest(A: sp.csr_array) -> int:
    """The row that moves most in what a singular symmetric matrix leaves free."""
    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    lu = spl.splu((A + 1e-10 * sp.eye_array(A.shape[0])).tocsc())
    z = np.random.default_rng(0).standard_normal(A.shape[0])
    for _ in range(3):
        z = lu.solve(z / np.linalg.norm(z))
    return int(np.argmax(np.abs(z)))


def pivoted(A: sp.csr_array) -> Callable[[Array], Array] | None:
    """The inverse by factors with exchange of rows, which some regular matrices need; None for singular ones."""
    import scipy.sparse.linalg as spl

    n = A.shape[0]
    try:
        lu = spl.splu(A.tocsc())
    except RuntimeError:
        return None
    z = np.random.default_rng(0).standard_normal(n)
    for _ in range(3):
        z = lu.solve(z / np.linalg.norm(z))
    is_singular = np.linalg.norm(A @ z) <= SINGULAR * np.linalg.norm(z) * abs(A).max()
    return None if is_singular else lu.solve
