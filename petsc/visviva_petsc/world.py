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
        # where those meet that fail, or come to their end
        self.failing, self.leaving = comm.Dup(), comm.Dup()
        self.met = time.monotonic()  # when all were together last
        self.window = MPI.Win.Allocate(8, 8, comm=comm)  # others look into it
        # how often all were called together
        self.begun = np.frombuffer(self.window.tomemory(), dtype=np.int64)
        self.begun[0] = 0
        comm.Barrier()

    @property
    def joint(self) -> Any:
        """The communicator, for what all do together now."""
        self.met = time.monotonic()
        self.begun[0] += 1
        return self.comm

    def waiting(self) -> int | None:
        """A process that waits for this one: it has begun what this one takes no part in."""
        theirs = np.empty(1, dtype=np.int64)
        for rank in range(self.size):
            self.window.Lock(rank, MPI.LOCK_SHARED)
            self.window.Get(theirs, rank)
            self.window.Unlock(rank)
            if theirs[0] > self.begun[0]:
                return rank
        return None

    def leave(self) -> int | None:
        """Wait until all have come to their end; or until one waits for this one, which is its number."""
        arrived = self.leaving.Ibarrier()
        while not arrived.Test():
            if (other := self.waiting()) is not None:
                return other
            time.sleep(0.05)
        self.window.Free()
        return None

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place."""
        self.joint.Allreduce(MPI.IN_PLACE, values)

    def largest(self, value: float) -> float:
        """The largest of their numbers."""
        return float(self.joint.allreduce(value, MPI.MAX))

    def first(self, value: Any) -> Any:
        """What the first of them has."""
        return self.joint.bcast(value)

    def together(self, values: Any) -> list[Any]:
        """What they have, in their order."""
        return list(self.joint.allgather(values))

    def parts(self, grid: Any) -> Ints:
        """Number of the process that each cell (n_cells,) of a mesh belongs to."""
        return np.asarray(self.first(parts_of(grid, self.size) if self.rank == 0 else None))

    def meets(self) -> bool:
        """Whether all of them come here, to the same error, before patience ends.

        Who has worked for a minute since all were together waits for another: others may have had more to do.
        """
        arrived, start = self.failing.Ibarrier(), time.monotonic()
        patience = max(PATIENCE, start - self.met)
        while not arrived.Test():
            if time.monotonic() - start > patience:
                return False
            time.sleep(0.01)
        return True

    def abort(self, code: int) -> None:
        """End all of them, whatever they wait for."""
        sys.stderr.flush()
        time.sleep(0.5)  # launchers may drop what they have not passed on yet
        self.comm.Abort(code)

    def of_core(self) -> Owners:
        """What the core of a system is told of them."""
        return Owners(self)


class Owners:
    """Who owns which unknowns of one system: of those that have an equation for it the first process."""

    def __init__(self, world: World) -> None:
        self.world, self.sum, self.largest = world, world.sum, world.largest

    def own(self, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
        """Mask (n,) of the unknowns of this process, from those that have equations here."""
        rank, size = self.world.rank, self.world.size
        owner = owners(self.world.joint, unknowns, n)
        self.mine = np.flatnonzero(owner == rank)
        self.counts = np.bincount(owner, minlength=size + 1)[:-1]
        self.order = np.argsort(owner, kind="stable")[: self.counts.sum()]
        self.found = np.empty(len(self.order))
        return (owner == rank).astype(np.int32)

    def share(self, values: Array) -> None:
        """Give all processes the values (n,) that the owners have."""
        self.world.joint.Allgatherv(values[self.mine], (self.found, self.counts))
        values[self.order] = self.found


def owners(comm: Any, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
    """First process (n,) that has an equation for each unknown; the number of processes where none has."""
    owner = np.full(n, comm.size, dtype=np.int32)
    owner[unknowns] = comm.rank
    comm.Allreduce(MPI.IN_PLACE, owner, MPI.MIN)
    return owner
