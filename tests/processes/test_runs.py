"""Whole runs by several processes: files, errors and resumption are those of one process."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing
from visviva.output.tables import read_table

pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")
TORUS = ("-m", "visviva", "run", "torus", "--set", "counts=[12, 8, 1]", "--set", "spin=0.5", "--no-pictures")


def torus(n: int, directory: Path, *more: str) -> str:
    """Run the torus, coarse; what it prints."""
    done = launched(n, *TORUS, "--out", str(directory), *more)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("runs") / "alone"
    torus(0, directory, "--until", "0.08")
    return directory


def differences(one: Path, other: Path) -> float:
    """Largest of all columns of ledger and probes, relative to the largest of the column's kind."""
    worst = 0.0
    for name in ("ledger.csv", "probes.csv"):
        a, b = read_table(one / name), read_table(other / name)
        assert list(a) == list(b)
        size = max(float(np.abs(column).max()) for column in a.values())
        worst = max([worst, *(float(np.abs(a[k] - b[k]).max()) / size for k in a)])
    return worst


def test_a_run_by_two_processes_writes_what_one_does(alone: Path, tmp_path: Path) -> None:
    told = torus(2, tmp_path / "two", "--until", "0.08")
    assert told.count("check of torus passed") == 1
    assert told.count("degrees of freedom") == 1
    assert differences(alone, tmp_path / "two") < 1e-12
    names = {file.name for file in alone.iterdir()}
    assert {file.name for file in (tmp_path / "two").iterdir()} == names


def test_a_run_goes_on_with_another_number_of_processes(alone: Path, tmp_path: Path) -> None:
    torus(3, tmp_path / "run", "--until", "0.03")
    torus(2, tmp_path / "run", "--until", "0.05", "--resume")
    torus(0, tmp_path / "run", "--until", "0.06", "--resume")
    torus(2, tmp_path / "run", "--until", "0.08", "--resume")
    assert differences(alone, tmp_path / "run") < 1e-12


TORI = ("-m", "visviva", "run", "tori", "--set", "mesh=coarse", "--step", "0.08", "--no-pictures")


def test_an_impact_goes_on_with_another_number_of_processes(tmp_path: Path) -> None:
    """The tori touch at t = 1.02; what contact remembers is in the files."""
    for n, run, until in ((0, "alone", 1.6), (2, "run", 1.12), (0, "run", 1.36), (2, "run", 1.6)):
        more = ("--resume",) if (tmp_path / run).exists() else ()
        done = launched(n, *TORI, "--until", str(until), "--out", str(tmp_path / run), *more)
        assert done.returncode == 0, done.stderr
    assert read_table(tmp_path / "run" / "probes.csv")["active_gaps"].max() > 4
    assert differences(tmp_path / "alone", tmp_path / "run") < 1e-11


def test_what_all_processes_refuse_is_told_once() -> None:
    done = launched(2, "-m", "visviva", "run", "torus", "--set", "counts=[0, 8, 1]")
    assert done.returncode == 2
    assert done.stderr.count("counts") == 1


def test_what_several_processes_cannot_compute_is_refused_by_name(tmp_path: Path) -> None:
    done = launched(2, "-m", "visviva", "run", "cylinder", "--out", str(tmp_path / "run"))
    assert done.returncode == 2
    assert done.stderr.count("which several processes cannot compute yet") == 1
    assert not (tmp_path / "run").exists()


KEPT = """
import sys
import visviva as vv
from visviva.base.world import world
from visviva.study.follower import Follower

held = []

def watched(self, *given):
    write_all(self, *given)
    held.append((len(self.result.kept.states), len(self.books.ledger.rows)))

write_all, Follower.write_all = Follower.write_all, watched
block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                 density=1.0, angular_velocity=(0, 0, 1), name="block")
resume = sys.argv[2:] == ["resume"]
study = vv.Study(vv.System([block, vv.Gravity()]), until=0.6 if resume else 0.3, step=0.05, title="block")
result = vv.run(study, sys.argv[1], pictures=False, every=1, resume=resume)
known = result.times.tolist(), [x.tolist() for x in result.states], result.ledger.table.tolist()
those, held = world().together(known), world().together(held)
if world().rank == 0:
    print(those[0] == those[1], len(known[0]), len(known[2]), max(held[1]))
"""


def test_other_processes_keep_no_states_and_have_the_same_result(tmp_path: Path) -> None:
    """They had all of them in memory, and after a resumption those since then alone."""
    (tmp_path / "kept.py").write_text(KEPT)
    for more, n in (((), 7), (("resume",), 13)):
        done = launched(2, str(tmp_path / "kept.py"), str(tmp_path / "run"), *more)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == f"True {n} {n} (1, 0)"


FAILS = """
import visviva as vv
from visviva.base.world import world

def velocity(X):
    if world().rank == 1:
        raise KeyError("only here")
    return 0 * X

block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                 density=1.0, velocity=velocity)
vv.simulate(vv.System([block]), until=1.0, step=0.1)
"""


def test_an_error_of_one_process_ends_all(tmp_path: Path) -> None:
    (tmp_path / "fails.py").write_text(FAILS)
    done = launched(2, str(tmp_path / "fails.py"))
    assert done.returncode != 0
    assert "process 1 of 2:" in done.stderr
    assert "only here" in done.stderr
