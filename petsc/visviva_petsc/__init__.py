"""PETSc and MPI for visviva: several processes share a system, and PETSc's solvers in one or in all of them."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

from visviva.base.errors import InputError
from visviva_petsc.ending import Ending

if TYPE_CHECKING:
    from visviva.linear.choice import Choice, Problem
    from visviva_petsc.world import World

__version__ = "0.2.0"
SEAM = 4
"""Version of visviva's ``base/world.py`` that this package goes with."""
__all__ = ["choose", "join"]


def join() -> World:
    """The processes that MPI has started together; what one of them fails by ends all."""
    refuse_thread("come together with other processes")
    import mpi4py

    if is_ours := "mpi4py.MPI" not in sys.modules:
        mpi4py.rc.finalize = False
    ending = Ending(is_ours)
    from mpi4py import MPI

    try:
        import petsc4py.PETSc  # noqa: F401  which has an end of its own, where it waits for others
    finally:
        ending.goes_first()
    from visviva_petsc.choice import refuse_unfit
    from visviva_petsc.failing import end_all_together, give_signals_back, keep_forks_out
    from visviva_petsc.world import World

    give_signals_back()
    keep_forks_out(is_ours)
    try:
        refuse_unfit()
    except InputError:  # in all of them
        ending.has_come = True
        raise
    world = World(MPI.COMM_WORLD)
    if world.size > 1:
        ending.leave = end_all_together(world)
    ending.has_come = True
    return world


def refuse_thread(what: str) -> None:
    """Refuse what threads of their own are to do with other processes.

    Raises
    ------
    InputError
    """
    if threading.current_thread() is not threading.main_thread():
        raise InputError(
            f"a thread of its own cannot {what}: in each process threads may come to that in another order, and wait "
            "for each other for ever; let the main thread do it"
        )


def choose(problem: Problem, given: dict[str, str]) -> Choice:
    """Solvers of PETSc for a problem, with options of the user."""
    from visviva_petsc.choice import choose as chosen
    from visviva_petsc.failing import give_signals_back

    give_signals_back()
    return chosen(problem, given)
