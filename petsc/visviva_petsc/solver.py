"""A linear solver of PETSc, as the core of visviva calls it."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from visviva.base.world import world
from visviva_petsc.filled import Filled
from visviva_petsc.world import owners

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

PREFIX = "visviva_"
"""Of options; those of the program of other systems have none."""
DIRECT = ("lu", "cholesky")
PRODUCTS = ("matptap_via",)
"""Options of products of matrices, which have no prefix."""
_made = [0]


class Solver:
    """Solves ``K d = -r``, where each process adds what its elements give to K and to r.

    Equations are numbered anew, those of a process in a row.

    Attributes
    ----------
    name, message : str
        What it is, and why it failed.
    iterations : int
        Of the last solution.
    """

    def __init__(self, name: str, options: dict[str, str]) -> None:
        self.name, self.message, self.iterations = f"PETSc: {name}", "", 0
        # MPI may have more processes, each for itself.
        self.comm = PETSc.COMM_WORLD if world().size > 1 else PETSc.COMM_SELF
        self.prefix = f"{PREFIX}{_made[0]}_"
        _made[0] += 1
        self.options = options
        self.rtol = float(options.get("ksp_rtol", 1e-6))
        self._closing: weakref.finalize[..., Solver] | None = None

    def analyze(self, row: Ints, col: Ints, unknown: Ints, of: dict[str, Any]) -> None:
        """Take the pattern: compressed rows, the unknowns of equations, and what is known of these.

        That is, among others, the first equation of every `node`, `modes` (equations, k) of rigid motions, and which
        unknowns (n,) are forces of constraints, `multiplier`.
        """
        comm, n, node, modes = self.comm.tompi4py(), len(of["multiplier"]), of["node"], of["modes"]
        self.release()
        trim()
        PETSc.garbage_cleanup(self.comm)  # of systems that are no more, which all have to let go of together
        owner = owners(comm, unknown, n)
        order = np.argsort(owner, kind="stable")
        number = np.full(n, -1, dtype=PETSc.IntType)
        counts = np.bincount(owner, minlength=comm.size + 1)
        total = int(counts[:-1].sum())
        number[order[:total]] = np.arange(total)
        self.unknown, self.equation = np.array(unknown), number[unknown]
        own = owner[unknown] == comm.rank
        self.matrix = Filled(comm, int(counts[comm.rank]), row, col, self.equation, block_size(comm, node))
        self.A = self.matrix.A
        self.r, self.d = self.A.createVecLeft(), self.A.createVecRight()
        self.near = PETSc.Vec().createSeq(len(unknown), comm=PETSc.COMM_SELF)
        numbers = PETSc.IS().createGeneral(self.equation, comm=PETSc.COMM_SELF)
        self.bring = PETSc.Scatter().create(self.d, numbers, self.near, None)
        self.give_modes(modes[own], self.equation[own])
        self.ksp = PETSc.KSP().create(self.comm)
        self.ksp.setOptionsPrefix(self.prefix)
        self.set_options(self.options)
        self.is_direct = self.ksp.getPC().getType() in DIRECT
        trim()

    def set_options(self, options: dict[str, str]) -> None:
        """Give the solver its options, which leave PETSc's database with it."""
        if self._closing is not None:
            self._closing()
        for name, value in options.items():
            PETSc.Options().setValue(self.prefix + name, value or None)
        self._closing = weakref.finalize(self, forget_options, [self.prefix + name for name in options])
        self.ksp.setFromOptions()

    def give_modes(self, modes: Array, equation: Ints) -> None:
        """Tell the matrix what it hardly resists, rigid motions of solids."""
        if not modes.shape[1]:
            return
        vectors = []
        for k in range(modes.shape[1]):
            vector = self.A.createVecRight()
            vector.setValues(equation, modes[:, k])
            vector.assemble()
            for earlier in vectors:
                vector.axpy(-vector.dot(earlier), earlier)
            if vector.normalize() > 1e-10:
                vectors.append(vector)
        self.A.setNearNullSpace(PETSc.NullSpace().create(constant=False, vectors=vectors, comm=self.comm))

    def factor(self, values: Array) -> bool:
        """Take the values of the matrix; whatever is made of them is made before the first solution."""
        self.matrix.fill(values)
        self.ksp.setOperators(self.A)
        self.prepare()
        with of_products(self.options):
            self.ksp.setUp()
        failed = self.ksp.getPC().getFailedReason()
        self.message = f"its preconditioner failed ({failed})" if failed else ""
        return not failed

    def prepare(self) -> None:
        """Whatever has to be known before the solver is set up."""

    def solve(self, r: Array, d: Array, tolerance: float) -> bool:
        """Solve for a residual (n,), of which every process has a part; d (n,) is set where it has equations."""
        self.r.zeroEntries()
        self.r.setValues(self.equation, -r[self.unknown], addv=PETSc.InsertMode.ADD)
        self.r.assemble()
        self.ksp.setTolerances(rtol=self.rtol if self.is_direct else max(self.rtol, tolerance))
        self.ksp.solve(self.r, self.d)
        self.iterations = int(self.ksp.its)
        reason = int(self.ksp.reason)
        if reason < 0:
            self.message = f"no convergence in {self.iterations} iterations (reason {reason} of PETSc)"
            return False
        if self.iterations == 0:  # in all processes: all ask for both norms
            found, asked = (float(v.norm()) for v in (self.d, self.r))
            if found == 0 and asked > 0:  # which would be taken for a step that needs none
                self.message = f"it left all of the residual (reason {reason} of PETSc)"
                return False
        self.bring.scatter(self.d, self.near)
        d[self.unknown] = self.near.array
        return True

    def forget(self) -> None:
        """Let go of what was kept from earlier values: there is nothing."""

    def release(self) -> None:
        """Give back what PETSc holds of an earlier pattern."""
        if self._closing is not None:
            self._closing()
        for name in ("bring", "near", "r", "d", "ksp", "A"):
            if name in vars(self):
                getattr(self, name).destroy()


def trim() -> None:
    """Give free pieces of the heap back, of which patterns leave many; PETSc's large arrays lie elsewhere."""
    with suppress(AttributeError, OSError):  # of the GNU library alone
        ctypes.CDLL(None).malloc_trim(0)


@contextmanager
def of_products(options: dict[str, str]) -> Iterator[None]:
    """Have products of matrices take their options, which those of the environment go before."""
    database = PETSc.Options()
    names = [name for name in PRODUCTS if name in options and not database.hasName(name)]
    for name in names:
        database.setValue(name, options[name])
    try:
        yield
    finally:
        forget_options(names)


def forget_options(names: Sequence[str]) -> None:
    """Take options out of PETSc's database, which outlives those who put them there."""
    if not PETSc.Sys.isFinalized():
        database = PETSc.Options()
        for name in names:
            database.delValue(name)


def block_size(comm: Any, node: Ints) -> int:
    """Number of equations of every node, if all nodes of all processes have as many; else 1."""
    sizes = np.diff(node)
    least, most = (int(sizes.min()), int(sizes.max())) if len(sizes) else (2**30, 0)
    least, most = comm.allreduce(least, MPI.MIN), comm.allreduce(most, MPI.MAX)
    return most if least == most else 1
