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
ENDS = (signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM))
"""Signals that ask a process to end."""


def end_all_together(world: World) -> Callable[[], None]:
    """Have every error that nobody handles end all processes.

    Returns
    -------
    function
        To be called at the end of this one, which ends all if others wait for it.
    """
    before = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if is_forked():
            return before(kind, error, trace)
        together = world.meets()
        own = not together or world.differs(said(kind, error))
        if own:
            print(f"process {world.rank} of {world.size}:", file=sys.stderr)
        if own or world.rank == 0:
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
    return leave


def said(kind: type[BaseException], error: BaseException) -> str:
    """An error in words, whatever its class does where it is asked for them."""
    with suppress(Exception):
        return f"{kind.__name__}: {error}"
    return kind.__name__


def keep_forks_out(is_ours: bool) -> None:
    """Have what this process forks end as any process does: it is none of those that MPI started."""

    def leave_them() -> None:
        called = ctypes.CDLL(PETSc.__file__)
        ctypes.c_bool.in_dll(called, "PetscFinalizeCalled").value = True
        give_signals_back(every=True)
        if not is_ours:
            atexit.register(leave_mpi if keeps_sessions() else refuse_end)

    os.register_at_fork(after_in_child=leave_them)


def give_signals_back(every: bool = False) -> None:
    """Let signals do again what scripts have said they should, which PETSc knows nothing of, or what Python knows.

    By PETSc's handlers whoever ends a forked process ends all, and who is asked to end calls that an error.
    """
    for number in signal.valid_signals():
        handler = signal.getsignal(number)
        again = every or number in ENDS
        if callable(handler) or handler is signal.SIG_IGN or (again and handler is not None):
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
