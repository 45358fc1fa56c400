"""The whole matrix in the first process, where no solver that processes share serves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from visviva import _core

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
T = TypeVar("T")

PIECE = 2**30
"""Numbers of a message: MPI before its fourth version counts them in 32 bits."""


def gathered(comm: Any, values: Array) -> list[Array]:
    """Arrays of all processes in the first one, in pieces of any number; nothing in the others."""
    sizes = comm.gather(len(values))
    if sizes is None:
        for k in range(0, len(values), PIECE):
            comm.Send(values[k : k + PIECE], 0)
        return []
    found = [values, *(np.empty(n) for n in sizes[1:])]
    for rank, part in enumerate(found[1:], 1):
        for k in range(0, len(part), PIECE):
            comm.Recv(part[k : k + PIECE], rank)
    return found


def by_first(comm: Any, do: Callable[[], T]) -> T:
    """What the first process gets by doing this alone, in all of them, or its error: factors may find no room."""
    found: T | Exception | None = None
    if comm.rank == 0:
        try:
            found = do()
        except Exception as error:  # whatever it is, others wait for it
            found = error
    found = comm.bcast(found)
    if isinstance(found, Exception):
        raise found
    return cast("T", found)


class Gathered:
    """Solves ``K d = -r`` in the first process by one of the core's own solvers; others send what they have of K and r.

    Attributes
    ----------
    name, message : str
        What it is, and why it failed.
    iterations : int
        Of the last solution.
    """

    def __init__(self, choice: Any, comm: Any = MPI.COMM_WORLD) -> None:
        self.name, self.message, self.iterations = "solved in the first process", "", 0
        self.choice, self.comm = choice, comm

    def analyze(self, row: Ints, col: Ints, unknown: Ints, of: dict[str, Any]) -> None:
        """Take the pattern: compressed rows, the unknowns of equations, and what is known of these."""
        self.n = len(of["multiplier"])
        rows = unknown[np.repeat(np.arange(len(unknown)), np.diff(row))]
        parts = self.comm.allgather(np.array(unknown))
        self.known = np.unique(np.concatenate(parts))
        pairs = self.comm.gather((rows, unknown[col]))
        equations = self.comm.gather(by_equation(unknown, of))
        if self.comm.rank:
            return
        i, j = (np.concatenate(part) for part in zip(*pairs, strict=True))
        n = len(self.known)
        key = np.searchsorted(self.known, i).astype(np.int64) * n + np.searchsorted(self.known, j)
        entries, self.place = np.unique(key, return_inverse=True)
        first, column = np.divmod(entries, n)
        starts = np.concatenate([[0], np.cumsum(np.bincount(first, minlength=n))]).astype(np.int64)
        self.whole = whole = merged(self.known, parts, equations)
        node = np.concatenate([np.flatnonzero(np.diff(whole["node"], prepend=-1)), [n]]).astype(np.int32)
        flags = np.ascontiguousarray(of["multiplier"][self.known], dtype=np.int32)
        more = {name: whole[name].tolist() for name in ("place", "algebraic", "scale") if name in whole}
        modes = whole.get("modes", np.zeros((n, 0)))
        self.linear = _core.Linear([self.choice], starts, column.astype(np.int32), node, modes, flags, **more)

    def factor(self, values: Array) -> bool:
        """Add up the values of all processes, and factor."""
        parts = gathered(self.comm, np.array(values))

        def factored() -> tuple[bool, str, str]:
            regular = self.linear.factor(np.bincount(self.place, np.concatenate(parts)))
            return regular, self.linear.name, self.linear.message

        regular, name, self.message = by_first(self.comm, factored)
        self.name = f"{name} in the first process"
        return bool(regular)

    def solve(self, r: Array, d: Array, tolerance: float) -> bool:
        """Solve for a residual (n,), of which every process has a part; all get d (n,)."""
        whole = np.empty(self.n if self.comm.rank == 0 else 0)
        self.comm.Reduce(np.array(r), whole)
        found = np.zeros(len(self.known))

        def done() -> tuple[bool, str, int]:
            solved = self.linear.solve(-whole[self.known], found, tolerance)
            return solved, self.linear.message, self.linear.iterations

        solved, self.message, self.iterations = by_first(self.comm, done)
        if solved:
            self.comm.Bcast(found)
            d[self.known] = found
        return bool(solved)

    def forget(self) -> None:
        """Let go of what was kept from earlier values."""
        if self.comm.rank == 0:
            self.linear.forget()


def by_equation(unknown: Ints, of: dict[str, Any]) -> dict[str, Array]:
    """What is known of the equations of a process, of nodes their first unknown; nothing if it has none."""
    starts = of["node"]
    node = np.repeat(unknown[starts[:-1]], np.diff(starts))
    found = {name: np.array(of[name]) for name in ("place", "algebraic", "scale", "modes")}
    return {"node": node, **{name: values for name, values in found.items() if len(values)}}


def merged(known: Ints, parts: Sequence[Ints], equations: Sequence[dict[str, Array]]) -> dict[str, Array]:
    """What is known of all equations, from what processes know of those with these unknowns; they do not differ."""
    whole: dict[str, Array] = {}
    for unknown, values in zip(parts, equations, strict=True):
        for name, array in values.items():
            of = whole.setdefault(name, np.zeros((len(known), *array.shape[1:]), array.dtype))
            of[np.searchsorted(known, unknown)] = array
    return whole
