"""The memory of a system besides its state, which decides the bits of coming steps; and looks that leave no trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.model.term import copies
from visviva.output.checkpoint import Record, Records
from visviva.system.turn import alone

if TYPE_CHECKING:
    from visviva.model.term import Term
    from visviva.system.system import System

CORE, HISTORY = "core: ", "history: "
"""Prefixes of the names of records: those of the core's parts, and of terms in Python."""
HISTORY_VERSION = 1
INTERNAL, INTERNAL_VERSION = "histories", 1
"""Record of all internal variables of materials, which hold whatever the next steps are."""

SOLVER = "solver"
"""Name of the record of the core that tells which solver serves."""
PREDICTOR = "predictor"
"""Name of that from which steps begin to iterate."""

Arrays = Mapping[str, NDArray[Any]]


def memory_of(system: System) -> list[Record]:
    """Data that restarts need besides the state: the core's memory part by part, and histories of terms in Python."""
    records = [Record(CORE + r.name, r.version, {"numbers": r.numbers}) for r in system.core.memory()]
    records.append(Record(INTERNAL, INTERNAL_VERSION, {"numbers": system.core.histories()}))
    for name, term in _remembering(system):
        parts = ("now", term.history), ("at_tangent", term.history_at_tangent)
        arrays = {f"{when}/{key}": a.copy() for when, history in parts for key, a in history.items()}
        records.append(Record(name, HISTORY_VERSION, arrays))
    return records


def bring_back(system: System, records: Records, histories_alone: bool = False) -> None:
    """Have a system remember what `memory_of` gave, or the present histories of its materials and terms alone.

    The kept factorisation is made again from the tangent of its own time, so terms need the history of that time.

    Raises
    ------
    InputError
        If a part is missing, unknown to the system, or of another version, or if materials have another number of
        internal variables.
    """
    of_core, internal = records.take_all(CORE), records.take(INTERNAL, INTERNAL_VERSION)
    of_terms = [(term, records.take(name, HISTORY_VERSION)) for name, term in _remembering(system)]
    records.refuse_rest()
    if histories_alone:
        _recall_internal(system, records, np.ascontiguousarray(internal.arrays["numbers"]))
    else:
        _recall(of_terms, "at_tangent")
        try:
            system.core.restore(_known(system, [_in_core(record) for record in of_core]))
        except ValueError as error:
            raise InputError(
                f"{records.path}: {error}; resume with the version of visviva that wrote it, or start the run anew "
                "in another directory"
            ) from error
    _recall(of_terms, "now")


def _known(system: System, records: list[Any]) -> list[Any]:
    """Records that fit this number of processes: another one has other solvers, and predicts by other unknowns."""
    own = {record.name: record for record in system.core.memory()}
    kept = [r for r in records if r.name != SOLVER or SOLVER in own]
    kept = [own[PREDICTOR] if r.name == PREDICTOR and is_other(r, own[PREDICTOR]) else r for r in kept]
    if SOLVER in own and all(r.name != SOLVER for r in kept):
        kept.append(own[SOLVER])
    return kept


def is_other(record: Any, own: Any) -> bool:
    """Whether a record of the core is of the same version, and of another size."""
    return bool(record.version == own.version and len(record.numbers) != len(own.numbers))


def _remembering(system: System) -> list[tuple[str, Term]]:
    """Terms in Python with the names of their records."""
    terms = [term for term, _ in system.model.terms]
    return [(f"{HISTORY}{type(term).__name__} {k}", term) for k, term in enumerate(terms)]


def _in_core(record: Record) -> Any:
    return _core.Record(record.name.removeprefix(CORE), record.version, record.arrays["numbers"])


def _recall_internal(system: System, records: Records, kept: NDArray[Any]) -> None:
    own = system.core.histories().size
    if kept.size != own:
        raise InputError(
            f"{records.path}: keeps {kept.size} internal variables of materials and the changed system has {own}; "
            "start the run anew in another directory"
        )
    system.core.restore_histories(kept)


def _recall(of_terms: list[tuple[Term, Record]], when: str) -> None:
    for term, record in of_terms:
        start = f"{when}/"
        found = {n.removeprefix(start): a.copy() for n, a in record.arrays.items() if n.startswith(start)}
        term.history.update(found)
        term.trial.clear()
        if when == "at_tangent":
            term.history_at_tangent = {n: a.copy() for n, a in found.items()}


Histories = list[tuple[dict[str, NDArray[Any]], ...]]


def histories(system: System) -> Histories:
    """Histories of terms in Python: of the trial state, the kept tangent, and the start of the last step."""
    return [
        tuple(
            copies(term.label, known)
            for known in (term.history, term.trial, term.history_at_tangent, term.history_before)
        )
        for term, _ in system.model.terms
    ]


class Trial:
    """Around an increment that is tried: whatever is raised inside gives it up, for all terms.

    What users' functions raise, or the keyboard, leaves the state accepted last like steps that fail.
    """

    __slots__ = "known", "system"

    def __init__(self, system: System) -> None:
        self.system = system
        self.known = histories(system) if system.model.terms else []

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            return
        self.system.core.discard()
        terms = [term for term, _ in self.system.model.terms]
        for (now, _trial, _tangent, before), term in zip(self.known, terms, strict=True):
            _give(term, now, {}, term.history_at_tangent, before)  # the tangent may be kept


@contextmanager
def returning(system: System) -> Iterator[None]:
    """Inside, a system may be moved about: afterwards its vectors and its stepper are as they were."""
    core, stepper = system.core, system.stepper
    vectors = [(u, u.copy()) for u in (core.x, core.dx, core.v, core.a, core.w)]
    system.stepper = stepper.copy()
    try:
        yield
    finally:
        system.stepper = stepper
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
    with alone(system):
        yield from _undisturbed(system)


def _undisturbed(system: System) -> Iterator[None]:
    core, known = system.core, histories(system)
    snapshot = core.snapshot()
    stepper, system.stepper = system.stepper, system.stepper.copy()
    system.is_undisturbed = True
    core.dx[:] = 0.0
    try:
        yield
    finally:
        system.stepper = stepper
        system.is_undisturbed = False
        try:
            for (term, _), (*_now, at_tangent, before) in zip(system.model.terms, known, strict=True):
                _give(term, at_tangent, {}, at_tangent, before)
            core.restore_snapshot(snapshot)
        finally:
            for (term, _), kept in zip(system.model.terms, known, strict=True):
                _give(term, *kept)


@contextmanager
def before_last_step(system: System) -> Iterator[None]:
    """Inside, terms in Python know what they knew when the step accepted last began, as the core's forces want it."""
    known = histories(system)
    try:
        for (term, _), (*_now, at_tangent, before) in zip(system.model.terms, known, strict=True):
            _give(term, before, {}, at_tangent, before)
        yield
    finally:
        for (term, _), kept in zip(system.model.terms, known, strict=True):
            _give(term, *kept)


def take_over(system: System, other: System) -> None:
    """Put a system into the state of another one that is composed alike, with all that it remembers."""
    for name in ("x", "v", "a", "w"):
        getattr(system.core, name)[:] = getattr(other.core, name)
    bring_back(system, Records.of(memory_of(other)))
    told = None
    with suppress(Exception):  # functions of the user may raise; then nobody knows the forces
        told = other.forces_of_step()
    system.stepper = other.stepper.copy()
    system.stepper.last, system.stepper.told_forces = None, told


def _give(term: Term, history: Arrays, trial: Arrays, at_tangent: Arrays, before: Arrays) -> None:
    for own, kept in ((term.history, history), (term.trial, trial)):
        own.clear()
        own.update({name: value.copy() for name, value in kept.items()})
    term.history_at_tangent, term.history_before = dict(at_tangent), dict(before)


def holds(system: System, composition: object) -> bool:
    """Whether a system was not reset since this composition of it was noted."""
    return system.composition is composition


def refuse_recomposed(whose: str, system: System, composition: object) -> None:
    """Refuse to go on with a system that was reset since this composition of it was noted.

    Raises
    ------
    InputError
        With the cure.
    """
    if not holds(system, composition):
        raise InputError(
            f"{whose}: its system was reset since (start='beginning' does so) and holds another run; look at "
            "earlier results before that, or go on with a system.copy(). Arrays that were kept can still be read"
        )
