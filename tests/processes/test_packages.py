"""What visviva-petsc does with PETSc and MPI: options that go with their solver, messages, patience."""

from __future__ import annotations

from pathlib import Path

import pytest

from processes.launch import launched, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")


def said(n: int, script: str, directory: Path) -> str:
    """What a script prints in so many processes."""
    (directory / "script.py").write_text(script)
    done = launched(n, str(directory / "script.py"))
    assert done.returncode == 0, done.stderr
    return done.stdout


OPTIONS = """
import gc
from petsc4py import PETSc
import visviva as vv
from visviva_petsc import Petsc

def run():
    rubber, mesh = vv.NeoHooke(young=1e3, poisson=0.3), vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    block = vv.Solid(mesh=mesh, material=rubber)
    pull = vv.Traction(solid=block, faces="x1", traction=(1, 0, 0), times="t")
    parts = [block, vv.Fixed(solid=block, nodes="x0"), pull]
    system = vv.System(parts, newton=vv.Newton(linear=Petsc("-ksp_rtol 1e-8")))
    vv.simulate(system, until=1.0, step=0.5, scheme=vv.Static())
    return ours()

def ours():
    return sum("visviva" in name for name in PETSc.Options().getAll())

there = run()
gc.collect()
print(there > 0, ours())
"""


def test_options_of_petsc_go_with_their_solver(tmp_path: Path) -> None:
    assert said(0, OPTIONS, tmp_path).split() == ["True", "0"]


PIECES = """
import numpy as np
from mpi4py import MPI
from visviva_petsc import gathered

gathered.PIECE = 3  # as if a message could not count any further
comm = MPI.COMM_WORLD
sizes = [4, 0, 10]
found = gathered.gathered(comm, 100.0 * comm.rank + np.arange(sizes[comm.rank]))
if comm.rank == 0:
    print([part.tolist() for part in found] == [[100.0 * k + i for i in range(n)] for k, n in enumerate(sizes)])
else:
    assert found == []
"""


def test_more_numbers_than_a_message_counts_come_in_pieces(tmp_path: Path) -> None:
    assert said(3, PIECES, tmp_path).split() == ["True"]


PATIENT = """
import time
from visviva.base.world import world
from visviva_petsc import world as together

together.PATIENCE = 0.2
those = world()
time.sleep(1.0 + 0.6 * those.rank)  # one has more to do before it comes to the same error
met = those.meets()
if those.rank == 0:
    print(met)
"""


def test_who_has_worked_long_waits_long_for_others(tmp_path: Path) -> None:
    """A fixed patience took processes that are slower for such that go on, and told of an error that all have twice."""
    assert said(2, PATIENT, tmp_path).split() == ["True"]


ALONE = """
import os
os.environ["PMIX_RANK"] = "0"
from visviva.base.world import Alone, world
print(isinstance(world(), Alone))
"""


def test_one_process_with_a_rank_of_pmix_is_alone(tmp_path: Path) -> None:
    """MPICH asked for its size ends the process where no server of PMIx answers."""
    assert said(0, ALONE, tmp_path).split() == ["True"]
