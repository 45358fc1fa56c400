"""What a system remembers besides its state, which decides the bits of coming steps; and looks that leave no trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.system.system import System

Arrays = Mapping[str, NDArray[Any]]


def memory_of(system: System) -> dict[str, NDArray[Any]]:
    """What restarts keep besides the state: the core's memory, and histories of terms in Python."""
    arrays: dict[str, NDArray[Any]] = {"memory": system.core.memory()}
    for k, (term, _) in enumerate(system.model.terms):
        for when, history in (("now", term.history), ("at_tangent", term.history_at_tangent)):
            arrays |= {f"terms/{k}/{when}/{name}": value.copy() for name, value in history.items()}
    return arrays


def bring_back(system: System, arrays: Arrays, histories_alone: bool = False) -> None:
    """Have a system remember what `memory_of` gave, or the present histories of its terms alone.

    The kept factorisation is made again from the tangent of its own time, so terms need the history of that time.
    """
    if not histories_alone:
        _recall(system, arrays, "at_tangent")
        system.core.restore(np.ascontiguousarray(arrays["memory"]))
    _recall(system, arrays, "now")


def _recall(system: System, arrays: Arrays, when: str) -> None:
    for k, (term, _) in enumerate(system.model.terms):
        start = f"terms/{k}/{when}/"
        found = {n.removeprefix(start): a.copy() for n, a in arrays.items() if n.startswith(start)}
        term.history.update(found)
        term.trial.clear()
        if when == "at_tangent":
            term.history_at_tangent = {n: a.copy() for n, a in found.items()}


@contextmanager
def undisturbed(system: System) -> Iterator[None]:
    """Inside, a system may be looked at in any state: afterwards it goes on to the bit as if it had not been.

    Sums of the ledger stay as they are found.
    """
    if system.is_undisturbed:
        yield
        return
    core, memory = system.core, memory_of(system)
    state = [(u, u.copy()) for u in (core.x, core.v, core.a, core.w)]
    flags = {name: getattr(system, name) for name in ("_last", "is_edited", "is_given", "has_acceleration")}
    core.keep_evaluation()
    system.is_undisturbed = True
    try:
        yield
    finally:
        system.is_undisturbed = False
        for u, kept in state:
            u[:] = kept
        core.discard()
        bring_back(system, memory)
        core.restore_evaluation()
        for name, flag in flags.items():
            setattr(system, name, flag)
