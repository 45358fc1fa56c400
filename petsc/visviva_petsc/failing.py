"""Errors that nobody handles end all processes, with one message; so does a process that leaves others waiting."""

from __future__ import annotations

import atexit
import ctypes
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import TYPE_CHECKING

from mpi4py import MPI
from petsc4py import PETSc

if TYPE_CHECKING:
    from visviva_petsc.world import World

PATIENCE = 5.0
"""Seconds until a process that fails believes that others go on; longer where all have met long ago."""


def end_all_together(world: World) -> None:
    """Have every error that nobody handles end all processes, and every end that others wait for."""
    before = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if is_forked():
            return before(kind, error, trace)
        together = world.meets()
        if not together:
            print(f"process {world.rank} of {world.size}:", file=sys.stderr)
        if not together or world.rank == 0:
            before(kind, error, trace)
        if not together:
            world.abort(1)

    def leave() -> None:
        if not is_forked() and (left := world.leave()) is not None:
            other, what = left
            print(
                f"process {world.rank} of {world.size} has come to its end, and process {other} waits for it, to {what}"
                ": all have to call what evaluates elements (steps, checks, fields, histories, pictures, files of "
                "results), and none may leave alone",
                file=sys.stderr,
            )
            world.abort(1)

    own = os.getpid()
    is_forked = lambda: os.getpid() != own  # noqa: E731  is none of them, and ends as any process does
    sys.excepthook = end
    atexit.register(leave)


def finalize_here(is_ours: bool) -> Callable[[], None]:
    """Have MPI and PETSc finalized at the end of this process, and not of what it forks, which would wait for others.

    Where a script has imported MPI first, MPI is finalized after all of Python, in what is forked as well.

    Returns
    -------
    function
        To be called when all have come together: one that ends before ends all, as others wait for it.
    """
    own, came = os.getpid(), [False]

    def come() -> None:
        came[0] = True

    def finalize() -> None:
        if os.getpid() != own:
            return
        if not came[0]:
            sys.stderr.flush()
            MPI.COMM_WORLD.Abort(1)
        PETSc.garbage_cleanup()  # PETSc's own waits for those that have nothing to let go of
        if is_ours:
            PETSc._finalize()
            MPI.Finalize()

    def leave_them() -> None:
        called = ctypes.CDLL(PETSc.__file__)
        ctypes.c_bool.in_dll(called, "PetscFinalizeCalled").value = True
        give_signals_back(every=True)
        if not is_ours:
            atexit.register(leave_mpi if keeps_sessions() else refuse_end)

    atexit.register(finalize)
    os.register_at_fork(after_in_child=leave_them)
    return come


def give_signals_back(every: bool = False) -> None:
    """Let signals do again what scripts have said they should, which PETSc knows nothing of, or what Python knows.

    By PETSc's handlers whoever ends a forked process ends all.
    """
    for number in signal.valid_signals():
        handler = signal.getsignal(number)
        if callable(handler) or handler is signal.SIG_IGN or (every and handler is not None):
            with suppress(OSError, ValueError):  # some cannot be handled
                signal.signal(number, handler)


def keeps_sessions() -> bool:
    """Whether MPI is known to finalize nothing as long as a session is open."""
    return MPI.get_vendor()[0] == "MPICH" and MPI.Get_version() >= (4, 0) and hasattr(MPI, "Session")


def leave_mpi() -> None:
    """Leave MPI as it is at the end of a forked process, which has its own status then."""
    MPI.Session.Init()


def refuse_end() -> None:
    """End a forked process that MPI would not let go, as one that failed: its status is not known any more here."""
    print(
        "a process that was forked comes to its end, where MPI would wait for the others: end it by os._exit(status), "
        "or import mpi4py.MPI after the first system of visviva",
        file=sys.stderr,
        flush=True,
    )
    os._exit(1)
