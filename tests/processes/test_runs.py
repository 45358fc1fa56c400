"""Whole runs by several processes: files, errors and resumption are those of one process."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from processes.launch import launched, missing
from visviva.output.tables import read_table
from visviva.output.trajectory import Trajectory

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


TORI = """
import sys
from visviva.examples.tori import study
import visviva as vv

vv.run(study("coarse", until=float(sys.argv[2]), step=0.08), sys.argv[1], pictures=False, resume=len(sys.argv) > 3)
"""
"""They touch at t = 1.02; what contact remembers is in the files."""
CAVITY = """
import sys
import visviva as vv

water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(6, 6)), density=1.0, viscosity=0.01, name="water")
lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=("t", 0, 0))
walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
probes = {"centre": vv.FlowField(fluid=water, at=(0.5, 0.5, 0)), "force": vv.FlowForce(fluid=water, faces="y1")}
study = vv.Study(vv.System([water, lid, *walls]), float(sys.argv[2]), 0.25, probes=probes, title="cavity")
vv.run(study, sys.argv[1], pictures=False, resume=len(sys.argv) > 3)
"""

WARM = """
import sys
import visviva as vv

table = [(300, 2), (340, 2), (342, 20), (344, 2), (600, 4)]
plate = vv.ThermalBody(
    mesh=vv.BoxMesh(size=(1.2, 1, 0.3), counts=(3, 2, 2)), conductivity=4.0, capacity=table, density=1.0,
    temperature=330.0,
)
heat = vv.Heat(conductivity=2.0, capacity=3.0, expansion=1e-3, reference=300.0)
blocks = [
    vv.ThermoelasticSolid(mesh=vv.BoxMesh(size=(1, 1, 0.5), counts=(2 - k, 1, 1), origin=(0, 0, 1 + 0.499 * k)),
                          material=vv.NeoHooke(young=100, poisson=0.3), density=1.0, heat=heat,
                          temperature=300.0 + 50 * k)
    for k in range(2)
]
contact = vv.Contact(first=blocks[0], first_faces="z1", second=blocks[1], second_faces="z0", initial="press",
                     enforcement="penalty")
passes = vv.HeatContact(contact=contact, conductance=5.0)
parts = [plate, vv.HeatFlux(body=plate, faces="x0", flux="100"), *blocks, contact, passes]
probes = {"warmth": vv.TemperatureAt(body=plate, at=(0, 0.5, 0.15)), "heat": lambda system: float(passes.heat.sum())}
study = vv.Study(vv.System(parts), float(sys.argv[2]), 0.1, probes=probes, title="warm")
vv.run(study, sys.argv[1], pictures=False, resume=len(sys.argv) > 3)
"""
"""What remembers its capacity, and heat that contact conducts."""
MECHANISM = """
import sys
import visviva as vv
from visviva.examples.triple_pendulum import study

vv.run(study(until=float(sys.argv[2]), step=0.01), sys.argv[1], pictures=False, resume=len(sys.argv) > 3)
"""
"""One process eliminates its constraints, and predicts by other unknowns."""


@pytest.mark.parametrize(
    ("script", "probe", "untils"),
    [
        (TORI, "active_gaps", (1.12, 1.36, 1.6)),
        (CAVITY, "force_x", (0.5, 1.0, 1.5)),
        (WARM, "heat", (0.5, 1.0, 1.5)),
        (MECHANISM, "end3_x", (0.1, 0.2, 0.3)),
    ],
    ids=["tori", "cavity", "warm", "mechanism"],
)
def test_what_remembers_goes_on_with_another_number_of_processes(
    script: str, probe: str, untils: tuple[float, ...], tmp_path: Path
) -> None:
    (tmp_path / "script.py").write_text(script)
    for n, name, until in ((0, "alone", untils[2]), *zip((2, 0, 2), ("run",) * 3, untils, strict=True)):
        more = ("resume",) if (tmp_path / name).exists() else ()
        done = launched(n, str(tmp_path / "script.py"), str(tmp_path / name), str(until), *more)
        assert done.returncode == 0, done.stderr
    assert np.abs(read_table(tmp_path / "run" / "probes.csv")[probe]).max() > 1e-3
    assert differences(tmp_path / "alone", tmp_path / "run") < 1e-11


def test_a_limit_of_time_counts_by_the_clock_of_the_first_process(alone: Path, tmp_path: Path) -> None:
    """It counts from the start of each process, and what was left differed: no such run began."""
    torus(2, tmp_path / "long", "--until", "0.08", "--time-limit", "1:00:00")
    assert differences(alone, tmp_path / "long") < 1e-12
    over = launched(2, *TORUS, "--until", "0.08", "--time-limit", "0:00", "--out", str(tmp_path / "short"))
    assert over.returncode == 75, over.stderr
    assert over.stderr.count("the time given is nearly over at t = ") == 1
    torus(2, tmp_path / "short", "--until", "0.08", "--resume")
    assert differences(alone, tmp_path / "short") < 1e-12


def test_what_is_shown_of_a_run_one_process_draws(alone: Path, tmp_path: Path) -> None:
    """Each wrote the same file: what one had put aside the other replaced."""
    for _ in range(3):
        done = launched(2, "-m", "visviva", "plot", str(alone), "--out", str(tmp_path))
        assert done.returncode == 0, done.stderr
        assert done.stdout.count("probes.png") == 1
    refused = launched(2, "-m", "visviva", "plot", str(tmp_path / "nothing"))
    assert refused.returncode == 2
    assert refused.stderr.count("holds no run") == 1


def test_options_of_petsc_come_from_the_command_line(alone: Path, tmp_path: Path) -> None:
    for n in (0, 2):
        told = torus(
            n, tmp_path / str(n), "--until", "0.08", "--petsc", "-ksp_rtol 1e-9 -ksp_converged_reason"
        )
        assert "solve converged due to CONVERGED_RTOL" in told
        assert differences(alone, tmp_path / str(n)) < 1e-11
    refused = launched(2, *TORUS, "--petsc", "-ksp_rtoll 1e-9", "--out", str(tmp_path / "no"))
    assert refused.returncode == 2
    assert refused.stderr.count("no solver here takes -ksp_rtoll") == 1


def test_what_all_processes_refuse_is_told_once() -> None:
    done = launched(2, "-m", "visviva", "run", "torus", "--set", "counts=[0, 8, 1]")
    assert done.returncode == 2
    assert done.stderr.count("counts") == 1


def test_solvers_of_one_process_are_refused_in_several(tmp_path: Path) -> None:
    (tmp_path / "direct.py").write_text(
        "import visviva as vv\nvv.System([vv.PointMass(mass=1.0)], newton=vv.Newton(linear=vv.Direct()))\n"
    )
    done = launched(2, str(tmp_path / "direct.py"))
    assert done.returncode != 0
    assert (
        done.stderr.count("Newton(linear=Direct(...)) solves in one process, and there are 2; leave it out")
        == 1
    )


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


CHOSEN = """
import visviva as vv
from visviva.base.world import world

mesh, rubber = vv.BoxMesh(size=(4, 0.4, 0.4), counts=(12, 2, 2)), vv.NeoHooke(young=1000.0, poisson=0.3)
turning = vv.System([vv.Solid(mesh=mesh, material=rubber, density=1.0, angular_velocity=(0, 0, 1), name="bar")])
moved = vv.simulate(turning, until=1.0, step=0.05, adaptive=vv.Adaptive(tolerance=1e-3))
beam = vv.Solid(mesh=mesh, material=rubber, density=1.0, name="beam")
hung = vv.System([beam, vv.Fixed(solid=beam, nodes="x0"), vv.Gravity(acceleration=(0, 0, -2.0))])
rested = vv.equilibrium(hung)
if world().rank == 0:
    print(*moved.times, len(rested.ledger["time"]), *turning.x, *hung.x)
"""


def test_lengths_of_steps_do_not_hinge_on_how_many_iterations_a_solver_took(tmp_path: Path) -> None:
    """Those of `Adaptive` took 8 by conjugate gradients for 9 by factors, and then grew; those downhill, too."""
    script = tmp_path / "chosen.py"
    script.write_text(CHOSEN, encoding="utf-8")
    runs = [launched(n, str(script)) for n in (0, 2)]
    assert not any(done.returncode for done in runs), runs[1].stderr
    alone, two = (np.array(done.stdout.split(), dtype=float) for done in runs)
    assert two == pytest.approx(alone, abs=1e-9)


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


DIFFER = """
import sys

import numpy as np
import visviva as vv
from visviva.base.world import world

rank, mesh = world().rank, vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2))


def bar(young=100.0, name="bar", **more):
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=young, poisson=0.3), density=1.0, name=name, **more)


def drawn(X):
    return np.random.default_rng().normal(size=X.shape)


def record(probe="place", **given):
    bars = [bar()]
    study = vv.Study(vv.System(bars), 0.1, 0.05, title="bar", probes={probe: bars[0].point((1, 0, 0)).position})
    return vv.run(study, sys.argv[1], progress=False, **given)


def run(until=0.1, moved=0.0, alike=(), newton=None, relaxed=None, modes=0, kept=1, **given):
    system = vv.System([bar(**given), *(bar(100.0 * k, f"bar {k}") for k in alike)])
    if newton is not None:
        system.newton = vv.Newton(tolerance=newton)
    if relaxed is not None:
        return vv.equilibrium(system, until=relaxed)
    if modes:
        return vv.modes(system, modes)
    system.x[0] += moved
    system.invalidate()
    return vv.simulate(system, until=until, step=0.05, every=kept)


tried = [{"young": 100.0 + rank}, {"alike": (1, 2) if rank else (2, 1)}, {"alike": (1,) * rank}, {"velocity": drawn},
         {"until": 0.1 + 0.05 * rank}, {"moved": 1e-3 * rank}, {"every": 1 + rank},
         {"newton": 1e-6 if rank else 1e-12}, {"relaxed": 1.0 + rank},
         {"modes": 8 + rank}, {"kept": 1 + rank},
         {"time_limit": 100.0 if rank else None}, {"probe": f"place {rank}"}, {}, {"time_limit": 100.0 + rank}]
for given in tried:
    try:
        (record if given.keys() & {"every", "time_limit", "probe"} else run)(**given)
        told = "went on"
    except vv.InputError as error:
        told = str(error)
    if rank == 0:
        print(told)
"""


def test_processes_that_compose_different_systems_are_refused(tmp_path: Path) -> None:
    """They computed on, each with its part of another body, or waited for each other for ever."""
    (tmp_path / "differ.py").write_text(DIFFER)
    done = launched(2, str(tmp_path / "differ.py"), str(tmp_path / "run"))
    assert done.returncode == 0, done.stderr
    told = done.stdout.splitlines()
    beginnings = (
        "Solid 'bar': material is NeoHooke(young=100,",
        "system: component 2 is Solid 'bar 2' in process 0, Solid 'bar 1' in process 1.",
        "system: component 2 is nothing in process 0, Solid 'bar 1' in process 1.",
        "Solid 'bar': rates of position (unknowns from 0 on) is ",
        "march: until is 0.1 in process 0, 0.15",
        "Solid 'bar': state of position (unknowns from 0 on) is ",
        "run: every is 1 in process 0, 2 in process 1.",
        "Newton: tolerance is 1e-12 in process 0, 1e-06 in process 1.",
        "equilibrium: until is 1 in process 0, 2 in process 1.",
        "modes: n is 8 in process 0, 9 in process 1.",
        "simulate: every is 1 in process 0, 2 in process 1.",
        "run: has_limit is False in process 0, True in process 1.",
        "run: probes is ['place 0'] in process 0, ['place 1'] in process 1.",
    )
    for line, begins in zip(told, beginnings, strict=False):
        assert line.startswith(f"processes differ: {begins}"), line
    assert told[len(beginnings) :] == ["went on"] * 2


FOUND = """
import sys
from pathlib import Path
from types import SimpleNamespace

import visviva as vv
from visviva.base.world import world
from visviva.output import compressed
from visviva.output.lock import locked
from visviva.output.tables import Table

place, is_first = Path(sys.argv[1]), world().rank == 0


def run(name, until=0.2, **given):
    block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                     density=1.0, angular_velocity=(0, 0, 1), name="block")
    study = vv.Study(vv.System([block]), until, 0.05, title="block")
    try:
        vv.run(study, place / name, pictures=False, progress=False, every=1, **given)
        told = "went on"
    except vv.VisvivaError as error:
        told = f"{type(error).__name__}: {error}"
    those = world().together(told.replace(str(place), "..."))
    if is_first:
        print(*dict.fromkeys(those), sep="; ")


append, left = Table.append, [4]


def full(self, row):
    left[0] -= 1
    if left[0] < 0:
        raise vv.RunError("cannot write: the disk is full")
    append(self, row)


run("run")
run("run")
if is_first:
    (place / "file").write_text("of somebody")
run("file")
run("run", until=0.1, resume=True)
if is_first:
    with open(place / "run" / "ledger.csv", "r+") as file:
        file.write("damaged")
run("run", until=0.4, resume=True)
if is_first:
    with locked(place / "run"):
        run("run", overwrite=True)
else:
    run("run", overwrite=True)
if is_first:
    Table.append = full
run("full")
Table.append = append
run("full", resume=True)
if is_first:
    compressed.shutil = SimpleNamespace(disk_usage=lambda path: SimpleNamespace(free=0))
run("compressed", compress=True)
"""


def test_what_the_first_process_finds_in_a_directory_all_may_catch(tmp_path: Path) -> None:
    """It was raised there alone; the first one went on, and was ended for it."""
    (tmp_path / "found.py").write_text(FOUND)
    told = []
    for n in (0, 2):
        (tmp_path / str(n)).mkdir()
        done = launched(n, str(tmp_path / "found.py"), str(tmp_path / str(n)), limit=200)
        assert done.returncode == 0, done.stderr
        told.append(re.sub(r"process \d+ on \S+", "process", done.stdout).splitlines())
    words = (
        "went on",
        "already holds a run",
        "cannot be written",
        "is before t = 0.2",
        "ledger.csv",
        "is being written",
    )
    for line, word in zip(
        told[0],
        (*words, "the disk is full; the run can be resumed", "went on", "cannot be compressed"),
        strict=True,
    ):
        assert word in line
    assert told[1] == told[0]


SETS = """
import visviva as vv

bars = [vv.PointMass(mass=1.0, name=name) for name in set("abcdefghij")]
vv.simulate(vv.System(bars), until=1.0, step=0.5)
"""


def test_what_differs_is_told_once(tmp_path: Path) -> None:
    """Sets of names are ordered by hashes, whose seeds differ."""
    (tmp_path / "sets.py").write_text(SETS)
    done = launched(2, str(tmp_path / "sets.py"))
    assert done.returncode != 0
    assert done.stderr.count("take components from lists rather than sets") == 1


WRITTEN = """
import sys
from pathlib import Path

import visviva as vv
from visviva.base.world import world

place = Path(sys.argv[1])
block = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=100.0, poisson=0.3),
                 density=1.0, name="block")
centre = vv.CentreOfMass(of=block)
held = [vv.Fixed(solid=block, nodes="x0"), vv.Traction(solid=block, faces="x1", traction=(0, 0, 0.1), times="t")]
system = vv.System([block, *held])
moved = vv.simulate(system, until=0.3, step=0.1, record={"centre": centre})
moved.write(place / "moved")
moved.to_csv(place / "moved.csv", centre)
moved.plot(place / "moved.svg")
shown = moved.picture(place / "moved.png", field="von_mises")
bent = vv.simulate(system, until=1.0, step=0.5, scheme=vv.Static(), start="beginning")
bent.write(place / "bent.vtkhdf")
vv.arc_length(system, until=1.2, step=0.1, steps=20).write(place / "path")
plate = vv.Solid(mesh=block.mesh, material=block.material, density=1.0)
vv.modes(vv.System([plate, vv.Fixed(solid=plate, nodes="x0")]), 1).picture(place / "mode.png")
told = [len(shown.data) == (place / "moved.png").stat().st_size]
try:
    moved.write(place / "moved")
except vv.InputError as error:
    told.append("already holds a run" in str(error))
if world().size > 1:
    told = world().together(told)
if world().rank == 0:
    print(told)
"""


def test_results_are_written_once(tmp_path: Path) -> None:
    """Processes that wrote the same files at once broke them, and ended each other."""
    (tmp_path / "written.py").write_text(WRITTEN)
    for n, name in ((0, "alone"), (2, "two")):
        (tmp_path / name).mkdir()
        done = launched(n, str(tmp_path / "written.py"), str(tmp_path / name))
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == str([[True, True]] * n or [True, True])
    one, two = tmp_path / "alone", tmp_path / "two"
    names = {file.relative_to(one).as_posix() for file in one.rglob("*")}
    assert {file.relative_to(two).as_posix() for file in two.rglob("*")} == names
    assert {"moved/trajectory.vtkhdf", "moved.csv", "moved.svg", "moved.png", "mode.png"} <= names
    assert differences(one / "moved", two / "moved") < 1e-11
    assert differences(one / "path", two / "path") < 1e-6
    for name in ("moved/trajectory.vtkhdf", "bent.vtkhdf", "path/trajectory.vtkhdf"):
        with Trajectory(one / name) as a, Trajectory(two / name) as b:
            assert len(a.times) == len(b.times) > 2


LEAVES = """
import sys
import time

import visviva as vv
from visviva.base.world import world

rank, kind = world().rank, sys.argv[1]
block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 2, 2)), material=vv.NeoHooke(young=1.0, poisson=0.3),
                 density=1.0, angular_velocity=(0, 0, 1), name="block")
system = vv.System([block])


def look(system):
    if kind == "exit" and rank == 1 and system.time > 0.12:
        sys.exit("drifted too far")


result = vv.simulate(system, until=0.2, step=0.05, observe=look)
if rank == 0:
    if kind == "check":
        system.check()
    if kind == "history":
        result.history(lambda s: float(block.mean("energy", s.x).sum()))
    if kind == "picture":
        result.picture(field="von_mises")
    if kind == "forces":
        block.nodal_forces(system.x)
    if kind == "step":
        system.step(0.01)
    if kind == "slow":
        time.sleep(8.0)
        print("through")
"""


@pytest.mark.parametrize("kind", ["exit", "check", "history", "picture", "forces", "step"])
def test_a_process_that_others_wait_for_ends_all(kind: str, tmp_path: Path) -> None:
    """They waited for ever."""
    (tmp_path / "leaves.py").write_text(LEAVES)
    done = launched(2, str(tmp_path / "leaves.py"), kind)
    assert done.returncode != 0
    assert done.stderr.count("process 1 of 2 has come to its end, and process 0 waits for it") == 1
    assert ("drifted too far" in done.stderr) == (kind == "exit")


def test_a_process_may_take_longer_than_others(tmp_path: Path) -> None:
    """Such as the first, which draws."""
    (tmp_path / "leaves.py").write_text(LEAVES)
    done = launched(2, str(tmp_path / "leaves.py"), "slow")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "through\n"


OLD = """
from types import SimpleNamespace

import visviva as vv
from visviva_petsc import choice

choice.PETSc = SimpleNamespace(ScalarType=float, Mat=object, Sys=SimpleNamespace(getVersion=lambda: (3, 18, 5)))
try:
    choice.refuse_unfit()
except vv.InputError as error:
    print(error)
"""


def test_an_old_petsc_is_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "old.py").write_text(OLD)
    done = launched(0, str(tmp_path / "old.py"))
    assert done.stdout.startswith("petsc4py 3.18.5 is too old"), done.stderr


@pytest.mark.parametrize("n", [1, 2])
def test_more_threads_than_cores_are_said(n: int, tmp_path: Path) -> None:
    script = tmp_path / "threads.py"
    script.write_text(
        "import visviva as vv\nfrom visviva.base.threads import n_cores\n"
        "vv.use_threads(n_cores())\n"
        "for _ in range(2):\n    vv.System([vv.PointMass(mass=1.0, position=(0, 0, 0))])\n"
    )
    done = launched(n, str(script))
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("they wait for each other: ") == n - 1


def test_threads_given_on_the_command_line_are_counted(tmp_path: Path) -> None:
    """Processes come together before the command is read."""
    run = ("-m", "visviva", "run", "pendulum", "--until", "0.01", "--no-movie", "--no-pictures", "--out")
    for threads, told in ((1, 0), (8, 1)):
        done = launched(2, *run, str(tmp_path / f"{threads}"), "--threads", f"{threads}")
        assert done.returncode == 0, done.stderr
        assert (done.stdout + done.stderr).count("they wait for each other: ") == told
