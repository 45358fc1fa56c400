"""Solvers by which processes solve together: what one of them fails by all fail by, or it ends all."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from petsc4py import PETSc

from visviva.base import world as base
from visviva.base.errors import RunError
from visviva_petsc.world import World

T = TypeVar("T")


class Together:
    """A solver whose calls all processes leave in the same way.

    Attributes
    ----------
    solver : Solver or Gathered
        The one that is called.
    message : str
        Why it failed.
    """

    def __init__(self, solver: Any) -> None:
        self.solver, self.message = solver, ""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.solver, name)

    def analyze(self, *given: Any) -> None:
        """Take the pattern."""
        self.all(self.solver.analyze, *given)

    def factor(self, *given: Any) -> bool:
        """Take the values of the matrix; a solver that does not suit them fails in all processes."""
        try:
            return bool(self.all(self.solver.factor, *given))
        except PETSc.Error as error:
            self.message = told(error)
            return False

    def solve(self, *given: Any) -> bool:
        """Solve for a residual."""
        return bool(self.all(self.solver.solve, *given))

    def all(self, do: Callable[..., T], *given: Any) -> T:
        """What this process gets.

        Raises
        ------
        BaseException
            That which it gets itself, if none of the processes is without, or if it is not to be handled.
        RunError
            If one gets an exception, and others do not.
        """
        error: BaseException | None = None
        try:
            found = do(*given)
        except BaseException as failure:  # whatever it is, others may be left within and wait for ever
            error = failure
        self.message = self.solver.message
        failures = told_by_all(error)
        if not any(failures):
            return found
        if error is not None and (all(failures) or not isinstance(error, Exception)):
            raise error
        k = next(k for k, failure in enumerate(failures) if failure)
        raise RunError(
            f"process {k} of {len(failures)} could not solve with the others: {failures[k]}"
        ) from error


def told_by_all(error: BaseException | None) -> list[str]:
    """What the processes have failed by, in their order; nothing of those that have not."""
    own = "" if error is None else f"{type(error).__name__}: {' '.join(str(error).split())}"
    world = base.world()
    return cast("World", world).failures(own) if world.size > 1 else [own]


def told(error: PETSc.Error) -> str:
    """What PETSc says of an error, without where."""
    lines = str(error).splitlines()[1:]  # [process] and text
    return "; ".join(line.partition("] ")[2].strip() for line in lines if "() at " not in line)
