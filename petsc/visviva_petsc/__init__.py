"""PETSc and MPI for visviva: several processes share a system, and PETSc's solvers in one or in all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from visviva_petsc.choice import Petsc as Petsc
    from visviva_petsc.world import World

__version__ = "0.2.0"
SEAM = 1
"""Version of visviva's ``base/world.py`` that this package goes with."""
__all__ = ["Petsc", "join"]


def join() -> World:
    """The processes that MPI has started together; what one of them fails by ends all."""
    from mpi4py import MPI

    from visviva_petsc.choice import refuse_unfit
    from visviva_petsc.failing import end_all_together
    from visviva_petsc.world import World

    refuse_unfit()
    world = World(MPI.COMM_WORLD)
    if world.size > 1:
        end_all_together(world)
    return world


def __getattr__(name: str) -> Any:
    if name == "Petsc":
        from visviva_petsc.choice import Petsc

        return Petsc
    raise AttributeError(name)
