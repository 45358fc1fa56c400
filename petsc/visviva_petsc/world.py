"""Processes of MPI that share one system: sums over them, and what belongs to whom."""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from visviva_petsc.failing import PATIENCE
from visviva_petsc.partition import parts_of

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class World:
    """Processes of a communicator, as `visviva.base.world.World` describes them."""

    def __init__(self, comm: Any) -> None:
        self.comm = comm
        self.rank, self.size = comm.rank, comm.size
        self.failing = comm.Dup()  # where those that fail meet

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place."""
        self.comm.Allreduce(MPI.IN_PLACE, values)

    def largest(self, value: float) -> float:
        """The largest of their numbers."""
        return float(self.comm.allreduce(value, MPI.MAX))

    def first(self, value: Any) -> Any:
        """What the first of them has."""
        return self.comm.bcast(value)

    def together(self, values: Any) -> list[Any]:
        """What they have, in their order."""
        return list(self.comm.allgather(values))

    def parts(self, grid: Any) -> Ints:
        """Number of the process that each cell (n_cells,) of a mesh belongs to."""
        return np.asarray(self.comm.bcast(parts_of(grid, self.size) if self.rank == 0 else None))

    def meets(self) -> bool:
        """Whether all of them come here, to the same error, before patience ends."""
        arrived, start = self.failing.Ibarrier(), time.monotonic()
        while not arrived.Test():
            if time.monotonic() - start > PATIENCE:
                return False
            time.sleep(0.01)
        return True

    def abort(self, code: int) -> None:
        """End all of them, whatever they wait for."""
        sys.stderr.flush()
        self.comm.Abort(code)

    def of_core(self) -> Owners:
        """What the core of a system is told of them."""
        return Owners(self.comm)

    def solver(self) -> Any:
        """Choice of linear solvers."""
        from visviva_petsc.choice import Petsc

        return Petsc()


class Owners:
    """Who owns which unknowns of one system: of those that have an equation for it the first process."""

    def __init__(self, comm: Any) -> None:
        self.comm = comm

    def own(self, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
        """Mask (n,) of the unknowns of this process, from those that have equations here."""
        owner = owners(self.comm, unknowns, n)
        self.mine = np.flatnonzero(owner == self.comm.rank)
        self.counts = np.bincount(owner, minlength=self.comm.size + 1)[:-1]
        self.order = np.argsort(owner, kind="stable")[: self.counts.sum()]
        self.found = np.empty(len(self.order))
        return (owner == self.comm.rank).astype(np.int32)

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place."""
        self.comm.Allreduce(MPI.IN_PLACE, values)

    def largest(self, value: float) -> float:
        """The largest of their numbers."""
        return float(self.comm.allreduce(value, MPI.MAX))

    def share(self, values: Array) -> None:
        """Give all processes the values (n,) that the owners have."""
        self.comm.Allgatherv(values[self.mine], (self.found, self.counts))
        values[self.order] = self.found


def owners(comm: Any, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
    """First process (n,) that has an equation for each unknown; the number of processes where none has."""
    owner = np.full(n, comm.size, dtype=np.int32)
    owner[unknowns] = comm.rank
    comm.Allreduce(MPI.IN_PLACE, owner, MPI.MIN)
    return owner
