"""What every line of the catalogue conserves over coarse steps; options of the solver change nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from catalogue import CATALOGUE, Entry
from catalogue.entry import ENERGY, NOTHING
from numpy.typing import NDArray

import visviva as vv
from visviva import _core
from visviva.results.second_law import entropy_scale

Array = NDArray[np.float64]


def simulated(entry: Entry, steps: int, h: float, **options: object) -> vv.Result:
    """A run from the entry's initial state."""
    return vv.simulate(entry.system(**options), until=steps * h, step=h)


def test_energy_balance_momenta_and_constraints(entry: Entry) -> None:
    """Newton goes on to round-off to measure the scheme alone: an error e of x is 2 e/h of velocity."""
    result = simulated(entry, entry.steps, entry.h, tolerance=1e-14)
    figures = result.conservation()
    assert result.statistics.rejected == 0
    assert figures["energy"] <= 1e-10 or not entry.balances, "the balance of energy does not close"
    assert figures["constraints"] <= 1e-12
    wrong = {name: figures[name] for name in entry.conserves - {"energy"} if not figures[name] <= 1e-11}
    assert not wrong, f"momenta that should be conserved: {wrong}"
    if result.ledger.entropy:
        size = entropy_scale(result.ledger)
        assert result.ledger.greatest("defect_entropy") <= 1e-12 * size, "entropy fell"
        assert result.ledger.size("entropy_imbalance") <= 1e-10 * size, (
            "the balance of entropy does not close"
        )
    if "energy" in entry.conserves:
        total = result.ledger["total"]
        assert np.abs(total - total[0]).max() <= 1e-10 * result.ledger.energy_scale


def test_default_tolerance(entry: Entry) -> None:
    """What a user gets who does not ask: balance and momenta to 1e-9."""
    figures = simulated(entry, entry.steps, entry.h).conservation()
    wrong = {
        name: figures[name]
        for name in entry.conserves | {"constraints"} | (ENERGY if entry.balances else NOTHING)
        if not figures[name] <= 1e-9
    }
    assert not wrong


def reducible() -> list[Entry]:
    """Entries for which the null-space solver exists."""
    reduced = vv.System([vv.PointMass(mass=1)]).core.solver
    return [
        e
        for e in CATALOGUE
        if (system := vv.System(e.build())).core.solver == reduced and np.any(system.order == 2)
    ]


@pytest.mark.parametrize("entry", reducible(), ids=lambda e: e.name.replace(", ", "-").replace(" ", "_"))
def test_null_space_changes_nothing(entry: Entry) -> None:
    """Round-off grows in a step by the ratio of position to velocity errors, 2/h, and linearly with time."""
    steps = 25
    full, reduced = (
        simulated(entry, steps, entry.h, null_space=flag, tolerance=1e-14) for flag in (False, True)
    )
    moving = full.system.order == 2
    x, y = full.system.x[moving], reduced.system.x[moving]
    assert full.system.core.solver != reduced.system.core.solver
    assert np.abs(x - y).max() <= steps * 1e-14 / entry.h * max(1.0, np.abs(x).max())


STEPS = """
import sys
from catalogue import CATALOGUE
from visviva import _core, simulate
entry = next(e for e in CATALOGUE if e.name == "chain")
x = simulate(entry.system(), until=5 * entry.h, step=entry.h).system.x
print(_core.instruction_set(), *(float(a).hex() for a in x))
"""


def after_few_steps(instructions: str) -> tuple[str, Array]:
    """Instruction set and state of the chain after five steps in a process of its own."""
    path = [str(Path(__file__).parent), str(Path(vv.__file__).parent.parent)]
    environment = {**os.environ, "VISVIVA_ISA": instructions, "PYTHONPATH": os.pathsep.join(path)}
    run = subprocess.run(
        [sys.executable, "-c", STEPS], capture_output=True, text=True, env=environment, check=True
    )
    name, *values = run.stdout.split()
    return name, np.array([float.fromhex(v) for v in values])


@pytest.mark.parametrize("instructions", ["", "v4"], ids=["chosen", "widest"])
def test_instruction_sets_agree(instructions: str) -> None:
    if instructions not in ("", *_core.instruction_sets()) or len(_core.instruction_sets()) == 1:
        pytest.skip(f"here are only {_core.instruction_sets()}")
    (base, x), (best, y) = after_few_steps("base"), after_few_steps(instructions)
    assert best == (instructions or _core.instruction_sets()[-1]) != base
    system = vv.System(next(e for e in CATALOGUE if e.name == "chain").build())
    moving = system.order == 2
    assert np.abs(x - y)[moving].max() <= 1e-12


def test_an_unknown_instruction_set_is_refused() -> None:
    """It was taken for the narrowest."""
    environment = {**os.environ, "VISVIVA_ISA": "v9", "PYTHONPATH": str(Path(vv.__file__).parent.parent)}
    run = subprocess.run(
        [sys.executable, "-m", "visviva", "info"], capture_output=True, text=True, env=environment
    )
    assert run.returncode == 2
    assert "VISVIVA_ISA=v9 is no instruction set" in run.stderr
    assert "Traceback" not in run.stderr
