"""PETSc and MPI for visviva: several processes share a system, and PETSc's solvers in one or in all of them."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visviva.linear.choice import Choice, Problem
    from visviva_petsc.world import World

__version__ = "0.2.0"
SEAM = 3
"""Version of visviva's ``base/world.py`` that this package goes with."""
__all__ = ["choose", "join"]


def join() -> World:
    """The processes that MPI has started together; what one of them fails by ends all."""
    import mpi4py

    if is_ours := "mpi4py.MPI" not in sys.modules:
        mpi4py.rc.finalize = False
    from mpi4py import MPI

    from visviva_petsc.choice import refuse_unfit
    from visviva_petsc.failing import end_all_together, finalize_here, give_signals_back
    from visviva_petsc.world import World

    give_signals_back()
    refuse_unfit()
    finalize_here(is_ours)
    world = World(MPI.COMM_WORLD)
    if world.size > 1:
        end_all_together(world)
    return world


def choose(problem: Problem, given: dict[str, str]) -> Choice:
    """Solvers of PETSc for a problem, with options of the user."""
    from visviva_petsc.choice import choose as chosen
    from visviva_petsc.failing import give_signals_back

    give_signals_back()
    return chosen(problem, given)
