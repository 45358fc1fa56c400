"""What each process of MPI does, for others to look at, whatever it waits for."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI

LENGTH = 240
"""Bytes of words."""
SHOWN = np.dtype([("begun", np.int64), ("is_within", np.int64), ("words", np.uint8, LENGTH)])
"""How often all were called together; whether the last time without asking; what they were to do."""


class Window:
    """Shows what this process does, and looks at what others do."""

    def __init__(self, comm: Any) -> None:
        self.size = comm.size
        self.window = MPI.Win.Allocate(SHOWN.itemsize, 1, comm=comm)
        self.own = np.frombuffer(self.window.tomemory(), dtype=SHOWN)
        self.own[0] = np.zeros(1, dtype=SHOWN)[0]

    def begin(self, what: str) -> None:
        """Show that all are called together, and asked what they are to do."""
        words = np.frombuffer(what.encode()[:LENGTH].ljust(LENGTH, b"\0"), dtype=np.uint8)
        self.own["words"][0], self.own["is_within"] = words, 0
        self.own["begun"] += 1

    def go_on(self) -> None:
        """Show that all are called together within what they do."""
        self.own["is_within"] = 1
        self.own["begun"] += 1

    def ahead(self) -> tuple[int, str] | None:
        """A process that has begun what this one takes no part in, and what it does."""
        return self._found(0)

    def left_behind(self) -> tuple[int, str] | None:
        """The same, where this one asks what all are to do: one that asks as well is not behind."""
        return self._found(1)

    def _found(self, within: int) -> tuple[int, str] | None:
        theirs = np.empty(1, dtype=SHOWN)
        for rank in range(self.size):
            self.window.Lock(rank, MPI.LOCK_SHARED)
            self.window.Get(theirs.view(np.uint8), rank)
            self.window.Unlock(rank)
            if theirs["begun"][0] + within * theirs["is_within"][0] > self.own["begun"][0]:
                return rank, bytes(theirs["words"][0]).rstrip(b"\0").decode(errors="replace")
        return None

    def free(self) -> None:
        """Nobody looks any more."""
        self.window.Free()
