"""What a system remembers of its last steps, beside its state: it decides the last bits of those to come."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visviva.system import System

Arrays = Mapping[str, NDArray[Any]]


def memory_of(system: System) -> dict[str, NDArray[Any]]:
    """The core's memory, and the histories of terms in Python, now and when the kept tangent was made."""
    arrays: dict[str, NDArray[Any]] = {"memory": np.array(system.core.memory())}
    for k, (term, _) in enumerate(system.model.terms):
        for when, history in (("now", term.history), ("at_tangent", term.history_at_tangent)):
            arrays |= {f"terms/{k}/{when}/{name}": value.copy() for name, value in history.items()}
    return arrays


def bring_back(system: System, arrays: Arrays, histories_alone: bool = False) -> None:
    """Remember what `memory_of` gave, of terms in Python the `histories_alone` if so.

    The kept factorisation is made again from the tangent of its own time, so terms need the history of that time.
    """
    for when, restore in (("at_tangent", True), ("now", False)):
        for k, (term, _) in enumerate(system.model.terms):
            found = {n.split("/")[-1]: a for n, a in arrays.items() if n.startswith(f"terms/{k}/{when}/")}
            term.history.update({name: value.copy() for name, value in found.items()})
        if restore and not histories_alone:
            system.core.remember(np.ascontiguousarray(arrays["memory"]))


@contextmanager
def undisturbed(system: System) -> Iterator[None]:
    """Forget what is evaluated within, if the state is still the one that the last step has left."""
    if not system.core.is_as_left:
        yield
        return
    kept = memory_of(system)
    try:
        yield
    finally:
        now = memory_of(system)
        if system.core.is_as_left and any(not np.array_equal(kept[name], now[name]) for name in kept):
            bring_back(system, kept)
