"""Processes of which one is broken off within a solver: all end, and the run goes on from its files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing
from visviva.output.tables import read_table
from visviva.output.trajectory import Trajectory

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
BROKEN_OFF = """
import os
import signal
import sys

import visviva as vv
from visviva.base.world import world

place, kind, rank = sys.argv[1], sys.argv[2], int(sys.argv[3])
block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                 density=1.0, angular_velocity=(0, 0, 1), name="block")
system = vv.System([block, vv.Gravity()])
left = {"once": 1, "twice": 2, "killed": 1, "raised": 1}.get(kind, 0) * (world().rank == rank)


def solve(self, *given):
    global left
    while left and system.time > 0.17:
        left -= 1
        if kind == "raised":
            raise KeyboardInterrupt
        os.kill(os.getpid(), signal.SIGKILL if kind == "killed" else signal.SIGINT)
    return solve_all(self, *given)


if world().size > 1:
    from visviva_petsc.solver import Solver

    solve_all, Solver.solve = Solver.solve, solve
corner = block.point((1, 1, 1)).position
study = vv.Study(system, until=0.4, step=0.05, title="block", probes={"corner": corner})
vv.run(study, place, every=1, save_every=0.0, pictures=False, progress=False, resume=kind == "resumed")
print("through")
"""


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("broken_off")
    (folder / "script.py").write_text(BROKEN_OFF)
    done = launched(0, str(folder / "script.py"), str(folder / "run"), "", "0")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize(
    ("kind", "rank"), [("once", 1), ("twice", 0), ("twice", 1), ("raised", 1), ("killed", 0), ("killed", 1)]
)
def test_a_run_that_is_broken_off_in_one_process_ends_and_goes_on(
    kind: str, rank: int, alone: Path, tmp_path: Path
) -> None:
    script, run = str(alone / "script.py"), tmp_path / "run"
    done = launched(2, script, str(run), kind, str(rank), limit=60)
    assert done.returncode != 0
    assert "through" not in done.stdout
    known = read_table(alone / "run" / "ledger.csv")
    reached = read_table(run / "ledger.csv")["time"]
    assert 0.1 < reached[-1] < 0.3
    with Trajectory(run / "trajectory.vtkhdf") as shapes:
        assert len(shapes.times) > 2
    done = launched(2, script, str(run), "resumed", "0", limit=60)
    assert done.returncode == 0, done.stderr
    found = read_table(run / "ledger.csv")
    size = max(float(np.abs(column).max()) for column in known.values())
    assert list(found) == list(known)
    assert max(float(np.abs(found[name] - known[name]).max()) for name in known) < 1e-11 * size
