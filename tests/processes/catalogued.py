"""All entries of the catalogue stepped by one process, and again by several; the first prints what they differ in, and
how many there are.

python tests/processes/catalogued.py reference FILE
mpiexec -n 3 python tests/processes/catalogued.py FILE
"""

from __future__ import annotations

import json
import pickle
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from catalogue import CATALOGUE, Entry

import visviva as vv
from visviva.base.world import world

STEPS, LATEST = 3, 25
"""Of a run, after bodies that can touch have done so; until when they should have."""


def steps_of(entry: Entry) -> int:
    """How many steps show what an entry does."""
    system = entry.system()
    contacts = [c for c in system.components if isinstance(c, vv.Contact)]
    before = 0
    while contacts and before < LATEST and not any(c.forces.any() for c in contacts):
        system.step(entry.h)
        before += 1
    return before + STEPS


def run(entry: Entry, steps: int) -> dict[str, Any]:
    """States and books of some steps."""
    system = entry.system()
    result = vv.simulate(system, until=steps * entry.h, step=entry.h, scheme=vv.EnergyMomentum())
    moving = system.order > 0
    return {
        "x": np.array(result.states),
        "ledger": np.array(result.ledger.rows),
        "moving": moving,
        "steps": steps,
    }


def differences(known: dict[str, dict[str, Any]]) -> Iterator[tuple[str, list[float]]]:
    """Of the states, relative to the way of the run, and of the ledger, relative to its largest, in any process."""
    for entry in CATALOGUE:
        one = known[entry.name]
        found = run(entry, one["steps"])
        x, rows, moving = one["x"], one["ledger"], one["moving"]
        way = float(np.abs(x[-1] - x[0])[moving].max()) or 1.0
        apart = float(np.abs(found["x"] - x)[:, moving].max()) / way
        booked = float(np.abs(found["ledger"] - rows).max() / np.abs(rows).max())
        yield entry.name, [world().largest(apart), world().largest(booked)]


def main() -> None:
    """Write the reference, or compare with it."""
    warnings.simplefilter("ignore")
    if sys.argv[1] == "reference":
        with open(sys.argv[2], "wb") as file:
            pickle.dump({entry.name: run(entry, steps_of(entry)) for entry in CATALOGUE}, file)
        return
    with open(sys.argv[1], "rb") as file:
        found = dict(differences(pickle.load(file)))
    if world().rank == 0:
        print(json.dumps({"entries": len(CATALOGUE), "served": len(found), "differences": found}))


if __name__ == "__main__":
    main()
