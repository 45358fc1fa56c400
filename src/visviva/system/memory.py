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


Histories = list[tuple[dict[str, NDArray[Any]], ...]]


def histories(system: System) -> Histories:
    """What terms in Python know: their history, that of the kept tangent, and that of the trial state."""
    return [
        tuple(_copies(known) for known in (term.history, term.history_at_tangent, term.trial))
        for term, _ in system.model.terms
    ]


def _copies(arrays: Arrays) -> dict[str, NDArray[Any]]:
    return {name: value.copy() for name, value in arrays.items()}


class Trial:
    """Around an increment that is tried: whatever is raised inside gives it up, for all terms.

    What users' functions raise, or the keyboard, leaves the state accepted last like steps that fail.
    """

    __slots__ = "histories", "system"

    def __init__(self, system: System) -> None:
        self.system = system
        self.histories = [_copies(t.history) for t, _ in system.model.terms] if system.model.terms else []

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            return
        self.system.core.discard()
        terms = [term for term, _ in self.system.model.terms]
        of_tangents = [term.history_at_tangent for term in terms]  # which may be kept
        _restore(self.system, [(h, t, {}) for h, t in zip(self.histories, of_tangents, strict=True)])


@contextmanager
def returning(system: System) -> Iterator[None]:
    """Inside, a system may be moved about: afterwards its vectors and its clock are as they were."""
    core, clock = system.core, system.clock
    vectors = [(u, u.copy()) for u in (core.x, core.dx, core.v, core.a, core.w)]
    try:
        yield
    finally:
        system.clock = clock
        for u, kept in vectors:
            u[:] = kept


@contextmanager
def undisturbed(system: System) -> Iterator[None]:
    """Inside, a system may be looked at in any state: afterwards it goes on to the bit as if it had not been.

    Looks begin at the present state. An increment that is tried is there again afterwards. Sums of the ledger stay as
    they are found.
    """
    if system.is_undisturbed:
        yield
        return
    core, known = system.core, histories(system)
    snapshot = core.snapshot()
    flags = {name: getattr(system, name) for name in ("_last", "is_edited", "is_given", "has_acceleration")}
    system.is_undisturbed = True
    core.dx[:] = 0.0
    try:
        yield
    finally:
        for name, flag in flags.items():
            setattr(system, name, flag)
        system.is_undisturbed = False
        try:
            _restore(system, [(at_tangent, at_tangent, {}) for _, at_tangent, _ in known])
            core.restore_snapshot(snapshot)
        finally:
            _restore(system, known)


def _restore(system: System, known: Histories) -> None:
    for (term, _), (history, at_tangent, trial) in zip(system.model.terms, known, strict=True):
        for own, kept in ((term.history, history), (term.trial, trial)):
            own.clear()
            own.update(_copies(kept))
        term.history_at_tangent = at_tangent
