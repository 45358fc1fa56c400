"""The restart state of a run: everything that decides the bits of what comes after."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, fields, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from visviva.analysis import adaptive, arc_length
from visviva.base.errors import InputError
from visviva.output.checkpoint import Record, Records, save_state
from visviva.results import lags
from visviva.results.ledger import Bookkeeper
from visviva.results.result import Result
from visviva.system import stepper as marching
from visviva.system.memory import bring_back, memory_of
from visviva.system.system import System

VECTORS = ("x", "v", "a", "w")
PACES = ((adaptive.NAME, adaptive.VERSION), (arc_length.NAME, arc_length.VERSION))
"""Records of what chooses the steps; there is one if a run has marched so."""
VERSION = 1
"""Of the records that are written here."""


def write(path: Path, records: Sequence[Record], notes: Mapping[str, Any]) -> None:
    """Write the state of a run.

    Parameters
    ----------
    path
        The file; an older one is replaced when the new one is complete.
    records
        Of the state, see `records_of`.
    notes
        What else shall be found on resuming, by name; anything that JSON can hold.

    Raises
    ------
    RunError
        If it cannot be written; the older state is then still there.
    """
    save_state(path, [Record("notes", VERSION, values={"json": json.dumps(notes)}), *records])


def records_of(result: Result, books: Bookkeeper) -> list[Record]:
    """Records of the present state, which do not change with it."""
    system = result.system
    total0 = 0.0 if books.total0 is None else books.total0
    ledger = {
        "done": books.done,
        "entropy": books.entropy.done,
        "span": books.ledger.span,
        "spread": books.ledger.sizes.spread.span,
        "unbooked": books.ledger.sizes.unbooked.span,
        "swings": books.swings.largest,
    }
    if (missed := books.ledger.sizes.missed) is not None:
        ledger |= {"missed": missed.span, "brought": missed.brought.span}
    if (groups := books.ledger.sizes.groups) is not None:
        ledger |= groups.memory()
    if own := books.ledger.sizes.lags:
        ledger["lags"] = np.array([lag.memory for lag in own])
    records = [
        Record("system", VERSION, values={"model": signature(system), "start": start_of(system)}),
        Record("state", VERSION, {name: getattr(system.core, name) for name in VECTORS}),
        Record("ledger", VERSION, ledger, {"total0": total0}),
        Record("statistics", VERSION, values=asdict(result.statistics)),
    ]
    with suppress(Exception):  # functions of the user may raise; that keeps no state from being written
        if (forces := system.forces_of_step()) is not None:
            records.append(Record("forces", VERSION, {"residual": forces}))
    stepper = system.stepper
    records += [stepper.record(), *stepper.pace.values(), *memory_of(system)]
    return [replace(r, arrays={name: np.array(a) for name, a in r.arrays.items()}) for r in records]


def notes_of(path: Path) -> dict[str, Any]:
    """The notes in a state file."""
    notes: dict[str, Any] = json.loads(str(Records(path).take("notes", VERSION).values["json"]))
    return notes


def load(path: Path, result: Result, books: Bookkeeper, changed: bool = False) -> None:
    """Put a system, its result and its books into the state that `write` wrote.

    Parameters
    ----------
    path
        State file.
    result, books
        Fresh ones of a system that was composed as for the run that was saved.
    changed : bool
        Whether the system has other arguments than the run, on purpose. What was remembered of its last step (the kept
        tangent, active sets and tractions of contacts) may then not fit, and starts anew.

    Raises
    ------
    InputError
        If the file is unreadable, was written for another system, or has records that are unknown here or of other
        versions.
    """
    records, system, stepper = Records(path), result.system, result.system.stepper
    records.take("notes", VERSION)
    refuse_another(path, records.take("system", VERSION), system, changed)
    state, ledger, statistics = (records.take(name, VERSION) for name in ("state", "ledger", "statistics"))
    forces = records.take_if_any("forces", VERSION)
    march, paces = (
        records.take(marching.NAME, marching.VERSION),
        [records.take_if_any(*kind) for kind in PACES],
    )
    for name in VECTORS:
        getattr(system.core, name)[:] = state.arrays[name]
    bring_back(system, records, histories_alone=changed)
    stepper.recall(march)
    result.stability = stepper.stability
    if forces is not None and not changed:
        stepper.told_forces = forces.arrays["residual"]
    stepper.pace = {pace.name: pace for pace in paces if pace is not None}
    for statistic in fields(result.statistics):
        setattr(result.statistics, statistic.name, statistics.values[statistic.name])
    books.done, books.total0 = ledger.arrays["done"], float(ledger.values["total0"])
    books.entropy.done = ledger.arrays.get("entropy", books.entropy.done)
    books.ledger.span = ledger.arrays["span"]
    for name in ("spread", "unbooked"):
        own = getattr(books.ledger.sizes, name)
        own.span = ledger.arrays.get(name, own.span)
    if (missed := books.ledger.sizes.missed) is not None:
        missed.resume(ledger.arrays.get("missed"))
        missed.brought.span = ledger.arrays.get("brought", missed.brought.span)
    if (groups := books.ledger.sizes.groups) is not None:
        groups.resume(ledger.arrays)
    books.swings.resume(ledger.arrays.get("swings"), system)
    lags.resume(books.ledger.sizes.lags, ledger.arrays.get("lags"), system)


def refuse_another(path: Path, record: Record, system: System, changed: bool) -> None:
    """Refuse the state of another system; other initial values are none if arguments have changed on purpose."""
    for attribute, own in (("model", signature(system)), ("start", start_of(system))):
        if record.values[attribute] != own and not (changed and attribute == "start"):
            raise InputError(
                f"{path}: was written for another system ({record.values[attribute]}; this one: {own}); resume with "
                "the same or start the run anew"
            )


def signature(system: System) -> str:
    """A short text that tells systems apart: counts, a digest of the names and sizes of unknowns."""
    names = [f"{f.component.label}.{f.name}:{f.order}:{f.size}" for f in system.model.fields]
    return (
        f"n = {system.n_coordinates}, m = {system.n_constraints}, {len(system.components)} components, "
        f"unknowns {sha256(repr(names).encode()).hexdigest()[:12]}"
    )


def start_of(system: System) -> str:
    """A digest of the initial values of all unknowns."""
    digest = sha256()
    for f in system.model.fields:
        digest.update(f.values.tobytes() + f.rates.tobytes())
    return f"initial values {digest.hexdigest()[:12]}"
