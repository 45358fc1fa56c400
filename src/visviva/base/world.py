"""Processes that run the same script and share one system; alone, as long as nobody brings them together."""

from __future__ import annotations

import atexit
import importlib.util
import os
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import cache, partial
from typing import Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from visviva.base import processes
from visviva.base.errors import InputError, apart
from visviva.base.threads import crowds, here

Array = NDArray[np.float64]
T = TypeVar("T")

SEAM = 4
"""Version of what a package that brings processes together has to offer: `World`, and solvers by ``choose``."""
PACKAGE = "visviva_petsc"


class World(Protocol):
    """Processes that run the same script; all of them call these functions, in the same order.

    Attributes
    ----------
    rank, size : int
        Number of this one, and how many there are.
    """

    rank: int
    size: int

    def doing(self, what: str) -> AbstractContextManager[None]:
        """Inside, all do what these words say; who goes on with something else is refused.

        What one calls alone is seen as well, inside or outside, and nobody waits for it for ever.
        """

    def note(self, error: BaseException) -> None:
        """Remember an error of this one, to be told should it go on with something else than the others."""

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place; all get the same bits."""

    def largest(self, value: float) -> float:
        """The largest of their numbers."""

    def first(self, value: Any) -> Any:
        """The value of the first process, in all of them."""

    def together(self, values: Any) -> list[Any]:
        """The values of all processes, in the order of their ranks."""

    def parts(self, grid: Any) -> NDArray[np.int64]:
        """Number of the process that each cell (n_cells,) of a mesh belongs to."""

    def meets(self) -> bool:
        """True if all processes arrive here with an error before the time limit."""

    def differs(self, own: str) -> bool:
        """Where all have met, whether this one failed by something else than the first, but for numbers."""

    def abort(self, code: int) -> None:
        """End all of them."""

    def of_core(self) -> Any:
        """The object by which the core of a system communicates with the other processes."""


class Alone:
    """One process."""

    rank, size = 0, 1

    def doing(self, what: str) -> AbstractContextManager[None]:
        """There are no others."""
        return nullcontext()

    def note(self, error: BaseException) -> None:
        """There are no others."""

    def sum(self, values: Array) -> None:
        """Nothing is added."""

    def largest(self, value: float) -> float:
        """It is that of this one."""
        return value

    def first(self, value: Any) -> Any:
        """It is that of this one."""
        return value

    def together(self, values: Any) -> list[Any]:
        """Those of this one."""
        return [values]

    def parts(self, grid: Any) -> NDArray[np.int64]:
        """All are here."""
        return np.zeros(grid.n_cells, dtype=np.int64)

    def meets(self) -> bool:
        """Nobody else has to come."""
        return True

    def differs(self, own: str) -> bool:
        """It is the first."""
        return False

    def abort(self, code: int) -> None:
        """Nobody else has to end."""

    def of_core(self) -> Any:
        """Nothing has to be told."""
        return None


_joined: list[World] = []


def world() -> World:
    """Those that share the systems of this one; launchers such as ``mpirun`` start several.

    Raises
    ------
    InputError
        If several were started, and the package that brings them together has another seam.
    """
    if not _joined:
        _joined.append(_found())
        os.register_at_fork(after_in_child=partial(_joined.__setitem__, 0, Alone()))
    return _joined[0]


def is_joined() -> bool:
    """Whether this process has come together with all that were started: else they may wait for it."""
    return bool(_joined) and processes.world >= processes.n_told()


def joined() -> World:
    """Those that have come together so far, for who tells of errors."""
    return _joined[0] if _joined else Alone()


def by_first(to: str, do: Callable[[], T]) -> T:
    """What the first process gets by doing this alone, in all of them, or its error; all call it `to` do the same.

    So everything is written that all have evaluated: two that write one file break it.

    Examples
    --------
    >>> by_first("write box.vtu", lambda: "written")
    'written'
    """
    if world().size == 1:
        return do()
    found: T | None = None
    error: Exception | None = None
    with world().doing(to):
        if world().rank == 0:
            try:
                with apart(f"the first process, which is alone to {to},"):
                    found = do()
            except Exception as failure:  # whatever it is, others wait for it
                error = failure
        found, error = world().first((found, error))
    if error is not None:
        raise error
    return cast("T", found)


def announce(message: str) -> None:
    """A line to standard error, by the first process."""
    if world().rank == 0:
        print(message, file=sys.stderr)


def fail_for_all() -> None:
    """Have what nobody handles end all processes, from now until all have come together, which sees to it then.

    Python notes what nobody has handled before it calls hooks, which users and packages set as they like.
    """
    own = os.getpid()

    def fail() -> None:
        if hasattr(sys, "last_value") and processes.world < processes.n_told() and os.getpid() == own:
            processes.end_all(1)

    atexit.register(fail)


def _found() -> World:
    if processes.n_told() <= 1 or importlib.util.find_spec(PACKAGE) is None:
        return Alone()
    joined: World = brought("several processes").join()
    processes.world = joined.size
    return joined if joined.size > 1 else Alone()


@cache
def tell_crowds() -> None:
    """Say once, where a first system is composed, on which machines threads have to wait for each other."""
    with world().doing("count threads and cores"):
        found = crowds(world().together(here()))
    for line in found:
        announce(line)


def brought(what: str) -> Any:
    """The package that brings processes together, and PETSc.

    Raises
    ------
    InputError
        If it is missing, has another seam, or was forked from a process that speaks with others.
    """
    processes.begin_alone(what)
    if importlib.util.find_spec(PACKAGE) is None:
        raise InputError(
            f"{what}: needs visviva-petsc, which is not installed; docs/howto/many_processes.rst has its two commands"
        )
    package = importlib.import_module(PACKAGE)
    if package.SEAM != SEAM:
        raise InputError(
            f"{PACKAGE} {package.__version__} goes with another version of visviva (seam {package.SEAM}, here {SEAM}); "
            "install both of the same release"
        )
    return package
