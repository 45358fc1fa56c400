"""How a process ends that MPI started with others: none leaves them waiting for it."""

from __future__ import annotations

import atexit
import os
from collections.abc import Callable

from visviva.base.processes import end_all


class Ending:
    """What a process does at its end, known before it asks MPI for the others, which it may be interrupted in.

    Where a script has imported MPI first, MPI is finalized after all of Python, in what is forked as well.

    Attributes
    ----------
    has_come : bool
        Whether all have come together. One that ends before ends all, as others wait for it.
    leave : function
        Called before MPI ends.
    """

    def __init__(self, is_ours: bool) -> None:
        self.is_ours, self.own = is_ours, os.getpid()
        self.has_come = False
        self.leave: Callable[[], None] = lambda: None
        self.goes_first()

    def goes_first(self) -> None:
        """Come before all ends that were known until now."""
        atexit.unregister(self.end)
        atexit.register(self.end)

    def end(self) -> None:
        """Leave the others, and finalize MPI and PETSc; not in what is forked, which would wait for others."""
        if os.getpid() != self.own:
            return
        from mpi4py import MPI  # where that was interrupted, it waits for the others now

        if not self.has_come:
            end_all(1)
        self.leave()
        from petsc4py import PETSc

        PETSc.garbage_cleanup()  # PETSc's own waits for those that have nothing to let go of
        if self.is_ours:
            PETSc._finalize()
            MPI.Finalize()
