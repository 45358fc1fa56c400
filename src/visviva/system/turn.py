"""One thread at a time works on a system."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from visviva.base.errors import InputError
from visviva.base.world import joined

if TYPE_CHECKING:
    from visviva.system.system import System

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def alone(system: System) -> Iterator[None]:
    """Inside, no other thread may step, look at or reset a system; this one may, again and again.

    Raises
    ------
    InputError
        If another thread is at it.
    """
    if not system.turn.acquire(blocking=False):
        raise InputError(
            "System: another thread works on it; wait for that one, or give each thread a system of its own: "
            "system.copy()"
        )
    try:
        yield
    except BaseException as error:
        joined().note(error)
        raise
    finally:
        system.turn.release()


def by_one_thread(analysis: Callable[P, R]) -> Callable[P, R]:
    """An analysis of its first argument, a system, that no other thread may work on from its begin to its end."""

    @functools.wraps(analysis)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> R:
        system: Any = args[0] if args else kwargs.get("system")
        if not hasattr(getattr(system, "turn", None), "acquire"):  # no system, as the analysis will say
            return analysis(*args, **kwargs)
        with alone(system):
            return analysis(*args, **kwargs)

    return guarded
