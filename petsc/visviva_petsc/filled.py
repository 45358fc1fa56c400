"""PETSc's matrix, filled from compressed rows of all processes without a list of their entries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

PIECE = 4096
"""Rows that are looked at together."""


@dataclass
class Rows:
    """Compressed rows (n + 1,) of what a process adds, columns among these n equations, and their numbers in the whole.

    Attributes
    ----------
    first, end, total : int
        Rows of the whole that belong to this process, and how many there are.
    """

    row: Ints
    col: Ints
    equation: Ints
    first: int
    end: int
    total: int

    def is_own(self, number: Ints) -> Mask:
        """Which numbers of the whole belong to this process."""
        return (number >= self.first) & (number < self.end)

    def entries(self, some: Ints) -> Ints:
        """Places of the entries of some rows."""
        lengths = self.row[some + 1] - self.row[some]
        before = np.cumsum(lengths) - lengths
        return np.repeat(self.row[some] - before, lengths) + np.arange(lengths.sum())

    def pairs(self, some: Ints) -> Ints:
        """Entries of some rows, each as the number of its row times the total, and that of its column."""
        first = np.repeat(self.equation[some].astype(np.int64) * self.total, np.diff(self.row)[some])
        return first + self.equation[self.col[self.entries(some)]]

    def known(self) -> tuple[Ints, Ints]:
        """Of the rows that belong to this process, how many entries are in its own columns and in others."""
        own, lengths = self.is_own(self.equation), np.diff(self.row)
        near = np.zeros(self.end - self.first, dtype=PETSc.IntType)
        far = near.copy()
        for of, rows, columns in self.pieces():
            at = self.equation[of] - self.first
            near[at] = np.bincount(rows[own[columns]], minlength=len(of))
            far[at] = lengths[of] - near[at]
        return near, far

    def lacking(self) -> Ints:
        """Rows that belong to this process, which adds nothing to their diagonal."""
        lacks = np.ones(self.end - self.first, dtype=bool)
        for of, rows, columns in self.pieces():
            lacks[self.equation[of[rows[columns == of[rows]]]] - self.first] = False
        return self.first + np.flatnonzero(lacks)

    def pieces(self) -> Iterator[tuple[Ints, Ints, Ints]]:
        """Some rows of this process at a time, with row (among these) and column of their entries.

        Arrays of all entries would stay in the heap.
        """
        own = np.flatnonzero(self.is_own(self.equation))
        for start in range(0, len(own), PIECE):
            of = own[start : start + PIECE]
            yield of, np.repeat(np.arange(len(of)), np.diff(self.row)[of]), self.col[self.entries(of)]


class Border:
    """Rows that several processes add to, which their owner puts together, and those that lack a diagonal.

    Attributes
    ----------
    number : (k,) array of int
        Of these rows, in the whole.
    row, col : arrays of int
        Compressed rows of all that is added, columns of the whole.
    """

    def __init__(self, comm: Any, rows: Rows) -> None:
        self.comm = comm
        told = self.tell(rows)
        diagonal = rows.lacking() * (rows.total + 1)  # factors want one
        others = np.concatenate([*told, diagonal])
        self.number = np.unique(others // rows.total).astype(PETSc.IntType)
        mine = np.flatnonzero(np.isin(rows.equation, self.number))
        self.taken, self.nothing = rows.entries(mine), np.zeros(len(diagonal))
        pairs, self.place = np.unique(np.concatenate([rows.pairs(mine), others]), return_inverse=True)
        of, self.col = pairs // rows.total, (pairs % rows.total).astype(PETSc.IntType)
        self.row = np.searchsorted(of, [*self.number, rows.total]).astype(PETSc.IntType)

    def tell(self, rows: Rows) -> list[Ints]:
        """Tell owners what this process adds to their rows; what others add to those of this one, in their order."""
        far = np.flatnonzero(~rows.is_own(rows.equation))
        far = far[np.argsort(rows.equation[far])]
        ends = np.searchsorted(rows.equation[far], self.comm.allgather(rows.end))
        parts = np.split(far, ends[:-1])
        told: list[Ints] = self.comm.alltoall([rows.pairs(part) for part in parts])
        self.sent, self.n_sent = rows.entries(far), [len(rows.entries(part)) for part in parts]
        self.n_received = [len(pairs) for pairs in told]
        return told

    def lengths(self, rows: Rows) -> tuple[Ints, Ints]:
        """Of its rows, in columns that belong to this process and in others."""
        until = np.concatenate([[0], np.cumsum(rows.is_own(self.col))])
        near = np.diff(until[self.row])
        return near, np.diff(self.row) - near

    def values(self, values: Array) -> Array:
        """What all add, from the values of this process."""
        others = np.empty(sum(self.n_received))
        self.comm.Alltoallv((values[self.sent], self.n_sent), (others, self.n_received))
        added = np.concatenate([values[self.taken], others, self.nothing])
        return np.bincount(self.place, added, minlength=len(self.col))


class Filled:
    """A matrix to which several processes add.

    Rows that one process alone adds to go from the core's arrays straight into PETSc's. Those at borders are put
    together by their owner, in the order of the processes: sums are the same in every run.

    Parameters
    ----------
    comm : mpi4py.MPI.Comm
        Of these processes.
    n_own : int
        Rows that belong to this one; those of earlier ones come before.
    row, col : arrays of int
        Compressed rows (n + 1,) of what this one adds, and its columns among these n.
    equation : (n,) array of int
        Their numbers in the whole.
    block : int
        Equations of every node.

    Attributes
    ----------
    A : PETSc.Mat
        The matrix.
    """

    def __init__(self, comm: Any, n_own: int, row: Ints, col: Ints, equation: Ints, block: int) -> None:
        ends = np.cumsum(comm.allgather(n_own))
        end, total = int(ends[comm.rank]), int(ends[-1])
        rows = Rows(row.astype(PETSc.IntType), col, equation, end - n_own, end, total)
        self.row, self.col, self.border = rows.row, col, Border(comm, rows)
        self.A = PETSc.Mat().create(comm)
        self.A.setSizes(((n_own, total), (n_own, total)))
        self.A.setBlockSize(block)
        self.A.setType("aij")
        self.A.setPreallocationNNZ(self.lengths(rows))
        self.A.setOption(PETSc.Mat.Option.NO_OFF_PROC_ENTRIES, True)
        # Without, a process that has no rows is asked for its pattern, and waits for those that have some.
        self.A.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
        numbers = PETSc.LGMap().create(equation.astype(PETSc.IntType), comm=comm)
        self.A.setLGMap(numbers, numbers)
        alone = rows.is_own(equation) & ~np.isin(equation, self.border.number)
        self.alone = np.where(alone, np.arange(len(equation)), -1).astype(PETSc.IntType)  # -1 is passed over

    def lengths(self, rows: Rows) -> tuple[Ints, Ints]:
        """Of all rows that belong to this process, in its own columns and in others."""
        found = rows.known()
        for all_of_them, of_border in zip(found, self.border.lengths(rows), strict=True):
            all_of_them[self.border.number - rows.first] = of_border
        return found

    def fill(self, values: Array) -> None:
        """Take what this process adds, in the order of its compressed rows."""
        self.A.setValuesLocalIJV(self.row, self.col, values, rowmap=self.alone)
        border = self.border
        self.A.setValuesIJV(border.row, border.col, border.values(values), rowmap=border.number)
        self.A.assemble()
