"""A system that several processes share: solvers they do not serve, and matrices that all of them need as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import world
from visviva.linear.petsc import Petsc

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.linear.choice import LinearOptions
    from visviva.system.system import System

Array = NDArray[np.float64]
Rows = tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]


def refuse_unshared_solver(options: LinearOptions | None, null_space: bool | None) -> LinearOptions | None:
    """The options given for linear equations, if several processes can take them; PETSc's own for these if none are.

    Raises
    ------
    InputError
    """
    if world().size == 1:
        return options
    if null_space is not True and getattr(options, "is_shared", options is None):
        return options or Petsc()
    what = "null_space=True" if null_space else f"linear={type(options).__name__}(...)"
    raise InputError(f"Newton({what}) solves in one process, and there are {world().size}; leave it out")


def whole_rows(core: Any, values: Array | None = None) -> tuple[Rows, Array | None]:
    """Compressed rows, columns and unknowns of the whole tangent, and its values, from the parts of all processes.

    For looks at small systems: every process gets all of it.
    """
    if world().size == 1:
        return core.csr, values

    import scipy.sparse as sp

    row, col, unknown = (np.asarray(a) for a in core.csr)
    first = unknown[np.repeat(np.arange(len(unknown)), np.diff(row))]
    parts = world().together((first, unknown[col], np.zeros(len(col)) if values is None else values))
    i, j, value = (np.concatenate([part[k] for part in parts]) for k in range(3))
    known = np.unique(np.concatenate([i, j]))
    n = len(known)
    A = sp.coo_array((value, (np.searchsorted(known, i), np.searchsorted(known, j))), shape=(n, n)).tocsr()
    A.sum_duplicates()
    return (A.indptr.astype(np.int64), A.indices.astype(np.int32), known.astype(np.int64)), A.data


def square(values: Array, col: NDArray[np.int32], row: NDArray[np.int64]) -> sp.csr_array:
    """A square matrix by compressed rows: rows take the type of the columns, else columns are copied to theirs."""
    import scipy.sparse as sp

    n = len(row) - 1
    short = row if len(col) >= 2**31 else row.astype(col.dtype)
    return sp.csr_array((values, col, short), shape=(n, n))


def n_equations(system: System) -> int:
    """Number of equations that are solved, by all processes."""
    if world().size == 1:
        return int(system.core.n_equations)
    return sum(int(np.sum(~f.fixed)) for f in system.model.fields if not f.is_local)
