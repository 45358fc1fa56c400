"""The restart state of a run: everything that decides the bits of what comes after."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, fields
from hashlib import sha256
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.checkpoint import load_state, save_state
from visviva.results.ledger import Bookkeeper
from visviva.results.result import Result
from visviva.system.memory import bring_back, memory_of
from visviva.system.system import System

Notes = Mapping[str, float | str]

STATE = ("x", "v", "a", "w")


def save(path: Path, result: Result, books: Bookkeeper, notes: Mapping[str, Any]) -> None:
    """Write the state of a run.

    Parameters
    ----------
    path
        The file; an older one is replaced when the new one is complete.
    result, books
        Of the run so far.
    notes
        What else shall be found on resuming, by name; anything that JSON can hold.

    Raises
    ------
    RunError
        If it cannot be written; the older state is then still there.
    """
    system = result.system
    arrays: dict[str, NDArray[Any]] = {name: getattr(system.core, name) for name in STATE}
    arrays |= memory_of(system) | {"books/done": books.done, "books/span": books.ledger.span}
    arrays |= {f"pace/{name}": value for name, value in system.pace.items()}
    attributes: dict[str, float | str] = {
        "time": system.time,
        "rejected": system.rejected,
        "has_acceleration": int(system.has_acceleration),
        "total0": 0.0 if books.total0 is None else books.total0,
        "model": signature(system),
        "start": start_of(system),
        "notes": json.dumps(notes),
    }
    attributes |= {f"clock.{name}": value for name, value in asdict(system.clock).items()}
    attributes |= {f"statistics.{name}": value for name, value in asdict(result.statistics).items()}
    attributes |= {f"stability.{name}": value for name, value in asdict(system.stability).items()}
    save_state(path, arrays, attributes)


def notes_of(path: Path) -> dict[str, Any]:
    """The notes in a state file."""
    _, attributes = load_state(path)
    notes: dict[str, Any] = json.loads(str(attributes["notes"]))
    return notes


def load(path: Path, result: Result, books: Bookkeeper, changed: bool = False) -> None:
    """Put a system, its result and its books into the state that `save` wrote.

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
        If the file is unreadable or was written for another system.
    """
    arrays, attributes = load_state(path)
    system = result.system
    for attribute, own in (("model", signature(system)), ("start", start_of(system))):
        if attributes[attribute] != own and not (changed and attribute == "start"):
            raise InputError(
                f"{path}: was written for another system ({attributes[attribute]}; this one: {own}); resume with the "
                "same or start the run anew"
            )
    for name in STATE:
        getattr(system.core, name)[:] = arrays[name]
    bring_back(system, arrays, histories_alone=changed)
    system.is_given = False
    for part in fields(system.clock):
        setattr(system.clock, part.name, attributes[f"clock.{part.name}"])
    system.rejected = int(attributes["rejected"])
    system.pace = {n.removeprefix("pace/"): a.copy() for n, a in arrays.items() if n.startswith("pace/")}
    system.has_acceleration = bool(attributes["has_acceleration"])
    for statistic in fields(result.statistics):
        setattr(result.statistics, statistic.name, attributes[f"statistics.{statistic.name}"])
    for known in fields(system.stability):
        setattr(system.stability, known.name, attributes[f"stability.{known.name}"])
    books.done, books.total0 = arrays["books/done"], float(attributes["total0"])
    books.ledger.span = arrays["books/span"]


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
