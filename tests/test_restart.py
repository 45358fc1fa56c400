"""A split run equals the whole run to the last bit, whatever ended its first part."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue import CATALOGUE
from catalogue.entry import Entry
from interrupting import at, run_until
from rubbing import thrown
from saved import saved_arrays

import visviva as vv
from visviva.examples import crane, four_bar
from visviva.output import Trajectory, load_state, read_table, save_state
from visviva.scheme.clock import Clock
from visviva.study.recorder import Recorder
from visviva.study.restart import notes_of
from visviva.study.run import run as run_study

UNTIL = 0.6
run = partial(run_study, pictures=False)
Compose = Callable[[], vv.Study]


def chain(scheme: vv.Scheme) -> vv.Study:
    """Rods hanging between two walls, a loop through the ground, with a motor and a damper at its ends."""
    ground, parts = vv.Ground(), []
    rods = [
        vv.RigidBody(
            mass=1 + k, inertia=(0.1, 0.02, 0.1), position=(k + 0.5, 0, 0), angular_velocity=(0, 0, 0)
        )
        for k in range(3)
    ]
    hinges = [vv.Revolute(a=ground, b=rods[0], at=(0, 0, 0), axis=(0, 1, 0), angle=True)]
    hinges += [
        vv.Revolute(a=a, b=b, at=(k + 1, 0, 0), axis=(0, 1, 0), angle=True)
        for k, (a, b) in enumerate(pairwise(rods))
    ]
    rope = vv.Distance(a=ground.point((4, 0, 2)), b=rods[-1].point((0.5, 0, 0)))
    parts += [
        vv.JointDamper(joint=hinges[1], damping=0.3),
        vv.Motor(joint=hinges[0], motion=lambda t: 0.5 * t**3),
    ]
    system = vv.System([ground, *rods, *hinges, rope, *parts, vv.Gravity()])
    probes = {"tip": rods[-1].point((0.5, 0, 0)).position, "torque": lambda s: vv.reaction(s, hinges[1])[1]}
    return vv.Study(system, UNTIL, 0.01, scheme, probes=probes)


def soft(formulation: Any, cell: str) -> vv.Study:
    """A damped block that a force shakes, with unknowns of single elements."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1), cell=cell)
    material = vv.NeoHooke(young=50.0, poisson=0.4)
    block = vv.Solid(
        mesh=mesh, material=material, density=1.0, formulation=formulation, stiffness_damping=0.01
    )
    shake = vv.Traction(solid=block, faces="x1", traction=(0.0, 3.0, 1.0), times="sin(9*t)")
    system = vv.System([block, vv.Fixed(solid=block, nodes="x0"), shake])
    return vv.Study(system, UNTIL, 0.01, probes={"tip": vv.Displacement(of=block.point((2, 1, 1)))})


def short(study: vv.Study) -> vv.Study:
    study.until = UNTIL
    return study


STUDIES: dict[str, Compose] = {
    "crane": lambda: short(crane.study()),
    "four_bar": lambda: short(four_bar.study()),
    "motor and damper": lambda: chain(vv.EnergyMomentum()),
    "generalised alpha": lambda: chain(vv.GeneralizedAlpha(rho=0.8)),
    "variational": lambda: chain(vv.VariationalMidpoint()),
    "enhanced strains": lambda: soft("enhanced", "hex8"),
    "pressures of elements": lambda: soft("mixed", "hex20"),
    "backward Euler": lambda: chain(vv.BackwardEuler()),
    "friction": lambda: vv.Study(vv.System(thrown()), UNTIL, 0.01),
    "elastic friction": lambda: vv.Study(vv.System(thrown(tangential="penalty", friction=0.8)), UNTIL, 0.01),
}


def assert_same(one: Path, other: Path) -> None:
    """Both directories hold the same run, bit for bit."""
    for table in ("ledger.csv", "probes.csv", "states.npy"):
        assert (one / table).read_bytes() == (other / table).read_bytes(), table
    a, b = saved_arrays(one), saved_arrays(other)
    assert a.keys() == b.keys()
    for name in a:
        assert a[name].tobytes() == b[name].tobytes(), name


@pytest.mark.parametrize("name", STUDIES)
def test_resumed_after_a_shorter_end_time(name: str, tmp_path: Path) -> None:
    whole, split = STUDIES[name](), STUDIES[name]()
    run(whole, tmp_path / "whole")
    split.until = 0.25
    run(split, tmp_path / "split")
    again = STUDIES[name]()
    result = run(again, tmp_path / "split", resume=True)
    assert again.system.x.tobytes() == whole.system.x.tobytes()
    assert again.system.v.tobytes() == whole.system.v.tobytes()
    assert result.statistics.steps == 60
    assert_same(tmp_path / "whole", tmp_path / "split")


@pytest.mark.parametrize("name", ["motor and damper", "generalised alpha", "pressures of elements"])
def test_resumed_after_a_step_that_the_end_cut(name: str, tmp_path: Path) -> None:
    """It goes on as one that marches on in memory does: by whole steps from that end."""
    split, again, march = (STUDIES[name]() for _ in range(3))
    split.until, again.until = 0.205, 0.3
    run(split, tmp_path / "split")
    result = run(again, tmp_path / "split", resume=True)
    parts = [vv.simulate(march.system, until=t, step=0.01, scheme=march.scheme) for t in (0.205, 0.3)]
    assert again.system.x.tobytes() == march.system.x.tobytes()
    assert np.array_equal(result.times, np.concatenate([parts[0].times, parts[1].times[1:]]))
    assert result.times[20:23] == pytest.approx([0.2, 0.205, 0.215], abs=1e-12)


def first_of_each_body() -> Iterator[Entry]:
    """Entries of the catalogue that have a body of a class that those before them have not."""
    seen: set[type] = set()
    for entry in CATALOGUE:
        kinds = {type(component) for component in entry.build() if hasattr(component, "mesh")}
        if kinds - seen:
            seen |= kinds
            yield entry


class Killed(Exception):
    pass


def test_resumed_from_the_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is moved before the first step, potentials and positions without mass, is moved once alone."""

    def composed(entry: Entry) -> vv.Study:
        return vv.Study(entry.system(), 2 * entry.h, entry.h)

    def killed(*_: object) -> None:
        raise Killed

    differ = []
    for k, entry in enumerate(first_of_each_body()):
        one, other = tmp_path / f"{k} whole", tmp_path / f"{k} killed"
        run(composed(entry), one)
        with monkeypatch.context() as patch:
            patch.setattr(Recorder, "march", killed)
            with pytest.raises(Killed):
                run(composed(entry), other)
        run(composed(entry), other, resume=True)
        try:
            assert_same(one, other)
        except AssertionError:
            differ.append(entry.name)
    assert differ == []


@pytest.mark.parametrize("name", ["crane", "generalised alpha"])
def test_saving_at_every_step_changes_nothing(name: str, tmp_path: Path) -> None:
    run(STUDIES[name](), tmp_path / "seldom")
    run(STUDIES[name](), tmp_path / "often", save_every=0.0)
    assert_same(tmp_path / "seldom", tmp_path / "often")


def test_steps_after_failures_are_halved_alike(tmp_path: Path) -> None:
    """The halved step length after a failed step is part of the state."""

    def composed() -> vv.Study:
        study = STUDIES["crane"]()
        study.system.stepper.clock = Clock(step=study.step, halvings=4)
        return study

    run(composed(), tmp_path / "whole")
    run_until(at(0.002), composed(), tmp_path / "split")
    run(STUDIES["crane"](), tmp_path / "split", resume=True)
    times = read_table(tmp_path / "whole" / "ledger.csv")["time"]
    assert np.diff(times).min() < 0.001
    assert_same(tmp_path / "whole", tmp_path / "split")


def rewritten(path: Path, part: str, /, **changes: Any) -> None:
    """Replace a record of a state file by another, or take it out."""
    records = load_state(path)
    record = records.pop(part)
    save_state(path, [*records.values(), *([replace(record, **changes)] if changes else [])])


@pytest.mark.parametrize("name", ["stepper", "state", "core: iterations", "core: flow 0", "core: tangent"])
def test_records_of_other_versions_are_refused_by_name(name: str, tmp_path: Path) -> None:
    run(streaming(), tmp_path / "run")
    path = tmp_path / "run" / "state.h5"
    again = (tmp_path / "run" / "state.h5").read_bytes()
    rewritten(path, name, version=9)
    part = name.removeprefix("core: ")
    with pytest.raises(vv.InputError, match=rf"'{part}'.*version 9.*start the run anew"):
        run(streaming(), tmp_path / "run", resume=True)
    path.write_bytes(again)
    rewritten(path, name, name="core: glue 3")
    with pytest.raises(vv.InputError, match=r"'glue 3'.*unknown|has no record|glue 3.*unknown"):
        run(streaming(), tmp_path / "run", resume=True)
    path.write_bytes(again)
    run(streaming(), tmp_path / "run", resume=True)


def test_missing_and_broken_records_are_refused_by_name(tmp_path: Path) -> None:
    run(streaming(), tmp_path / "run")
    path = tmp_path / "run" / "state.h5"
    again = path.read_bytes()
    for name, message in (("core: flow 0", "'flow 0'.*is missing"), ("stepper", "no record 'stepper'")):
        rewritten(path, name)
        with pytest.raises(vv.InputError, match=message):
            run(streaming(), tmp_path / "run", resume=True)
        path.write_bytes(again)
    longer = np.zeros(10_000)
    rewritten(path, "core: flow 0", arrays={"numbers": longer})
    with pytest.raises(vv.InputError, match=r"'flow 0'.*does not have the size"):
        run(streaming(), tmp_path / "run", resume=True)
    path.write_bytes(again)
    records = load_state(path)
    save_state(path, [*records.values(), replace(records["stepper"], name="weather")])
    with pytest.raises(vv.InputError, match=r"'weather'.*unknown to this version"):
        run(streaming(), tmp_path / "run", resume=True)


def streaming() -> vv.Study:
    """A lid drags water, whose pressures the flow's term remembers."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad4")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    walls = [vv.NoSlip(fluid=water, faces=f) for f in ("x0", "x1", "y0")]
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=(1.0, 0, 0))
    return vv.Study(vv.System([water, *walls, lid]), 0.1, 0.05, vv.Midpoint())


def test_history_of_terms_in_python(tmp_path: Path) -> None:
    run(with_memory(), tmp_path / "whole")
    split = with_memory()
    split.until = 0.2
    run(split, tmp_path / "split")
    run(with_memory(), tmp_path / "split", resume=True)
    assert_same(tmp_path / "whole", tmp_path / "split")


class Creep(vv.model.term.Term):
    """A spring to the origin whose free length creeps; tangent and force depend on the history."""

    def __init__(self, unknowns: np.ndarray) -> None:
        super().__init__()
        self.unknowns, self.order = unknowns.reshape(1, 3), np.full(3, 2, dtype=np.int32)
        self.history["slack"] = np.zeros((1, 3))

    def residual(self, s):  # type: ignore[no-untyped-def]
        return 40.0 * (1 + 5 * self.history["slack"] ** 2) * (s.x - self.history["slack"])

    def accept(self, s) -> None:  # type: ignore[no-untyped-def]
        self.history["slack"] += s.step.h * 0.5 * s.x1


class Creeping(vv.component.component.Component):
    ball = None

    def contribute(self, model) -> None:  # type: ignore[no-untyped-def]
        model.term(self, Creep(np.array(self.ball._field.unknowns, dtype=np.int32)))


def with_memory() -> vv.Study:
    ball = vv.PointMass(mass=1.0, position=(1, 0.2, 0), velocity=(0, 1, 0), name="ball")
    spring = Creeping()
    spring.ball = ball
    return vv.Study(vv.System([ball, spring]), UNTIL, 0.01, probes={"ball": ball.point().position})


def test_ctrl_c_saves_the_state_and_resumes(tmp_path: Path) -> None:
    run(STUDIES["crane"](), tmp_path / "whole")
    study = STUDIES["crane"]()
    assert threading.current_thread() is threading.main_thread()
    run_until(at(0.2), study, tmp_path / "split")
    assert study.system.time == pytest.approx(0.2)
    assert load_state(tmp_path / "split" / "state.h5")["stepper"].values["time"] == study.system.time
    run(STUDIES["crane"](), tmp_path / "split", resume=True)
    assert_same(tmp_path / "whole", tmp_path / "split")


def test_complete_run_resumed_stays_as_it_is(tmp_path: Path) -> None:
    run(STUDIES["crane"](), tmp_path / "run")
    before = load_state(tmp_path / "run" / "state.h5")
    (tmp_path / "run" / "summary.json").unlink()
    result = run(STUDIES["crane"](), tmp_path / "run", resume=True)
    assert result.statistics.steps == 60
    assert len(result.states) == 61
    assert (tmp_path / "run" / "summary.json").exists()
    after = load_state(tmp_path / "run" / "state.h5")
    assert {name: r.values for name, r in before.items()} == {name: r.values for name, r in after.items()}


def test_resume_refuses_another_system_step_or_scheme(tmp_path: Path) -> None:
    run(STUDIES["crane"](), tmp_path / "run")
    with pytest.raises(vv.InputError, match="RigidBody 'girder': angular_velocity was"):
        run(short(crane.study(omega=1.0)), tmp_path / "run", resume=True)
    with pytest.raises(vv.InputError, match=r"step was 0\.01, is 0\.02"):
        run(short(crane.study(step=0.02)), tmp_path / "run", resume=True)
    study = STUDIES["crane"]()
    study.scheme = vv.Midpoint()
    with pytest.raises(vv.InputError, match="EnergyMomentum"):
        run(study, tmp_path / "run", resume=True)
    with pytest.raises(vv.InputError, match="holds no run"):
        run(STUDIES["crane"](), tmp_path / "nothing", resume=True)


SCRIPT = """
import sys
from visviva.examples import crane
from visviva.study.run import run
study = crane.study(until=3.0, step=0.005)
run(study, sys.argv[1], resume=len(sys.argv) > 2, save_every=0.0, pictures=False)
"""


@pytest.mark.parametrize("seed", range(3))
def test_kill_9_leaves_a_run_that_resumes(seed: int, tmp_path: Path) -> None:
    """Killed at random moments twice, then resumed to the end: the same bits as the whole run."""
    rng = np.random.default_rng(seed)
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    directory = tmp_path / "killed"
    for attempt in ([], ["resume"]):
        process = subprocess.Popen([sys.executable, str(script), str(directory), *attempt])
        reference = directory / "state.h5"
        deadline = time.monotonic() + 60
        while not reference.exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        time.sleep(rng.uniform(0.0, 1.2))
        process.kill()
        process.wait()
        assert notes_of(directory / "state.h5")["step"] == 0.005
        for table in ("ledger.csv", "probes.csv"):
            if (directory / table).exists():
                read_table(directory / table)
        if (directory / "trajectory.vtkhdf").exists():
            with Trajectory(directory / "trajectory.vtkhdf") as trajectory:
                assert len(trajectory.times) > 0
    run(crane.study(until=3.0, step=0.005), directory, resume=True)
    run(crane.study(until=3.0, step=0.005), tmp_path / "whole")
    assert_same(tmp_path / "whole", directory)
    with (
        Trajectory(directory / "trajectory.vtkhdf") as a,
        Trajectory(tmp_path / "whole" / "trajectory.vtkhdf") as b,
    ):
        assert a.times.tolist() == b.times.tolist()
        last = len(a.times) - 1
        assert all((p == q).all() for p, q in zip(a.points(last), b.points(last), strict=True))


def test_memory_decides_every_bit() -> None:
    """A system that is told another's state and memory takes the same next step to the last bit."""
    one, other = (crane.study(step=0.005).system for _ in range(2))
    marching, _ = vv.march(one, until=1.5, step=0.005), next(vv.march(other, until=1.0, step=0.005))
    for _ in marching:
        for name in "xvaw":
            getattr(other.core, name)[:] = getattr(one.core, name)
        other.time = one.time
        other.core.restore(one.core.memory())
        if one.time > 1.4:
            break
        one.step(0.005)
        other.step(0.005)
        assert np.array_equal(one.x, other.x)


def falling() -> vv.Study:
    """A ball that comes down at t = 0.073 and bounces."""
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1e3, position=(0, 0, 0.2), velocity=(0, 0, -1))
    plane = vv.Plane()
    contact = vv.Contact(first=ball, second=plane, stiffness=1e4, restitution=0.5)
    return vv.Study(vv.System([ball, plane, contact, vv.Gravity()]), 0.3, 0.001)


def filling() -> vv.Study:
    """A mixture without phases that is empty until its side gives it something."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(1, 0.25), counts=(8, 2)),
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, 0.5)),
        gradient_energy=1e-6,
        concentration=0.0,
    )
    wall = vv.PrescribedConcentration(body=body, nodes="x0", value="1e-3*sin(30*t)")
    return vv.Study(vv.System([body, wall]), 0.2, 0.001, scheme=vv.BDF2())


MOVING = [(STUDIES["crane"], 0.1), (falling, 0.06), (falling, 0.0735), (filling, 0.08)]


@pytest.mark.parametrize(("make", "end"), MOVING)
def test_adaptive_steps_go_on_alike(make: Callable[[], vv.Study], end: float, tmp_path: Path) -> None:
    """What the choice of steps rests on is part of the state: length, error, rates, how deep impacts were, changes."""

    def composed() -> vv.Study:
        study = make()
        study.adaptive = vv.Adaptive(tolerance=1e-6)
        return study

    run(composed(), tmp_path / "whole")
    run_until(at(end), composed(), tmp_path / "split")
    with pytest.raises(vv.InputError, match="adaptive"):
        run(make(), tmp_path / "split", resume=True)
    run(composed(), tmp_path / "split", resume=True)
    times = read_table(tmp_path / "whole" / "ledger.csv")["time"]
    assert np.ptp(np.diff(times)) > 1e-4
    assert_same(tmp_path / "whole", tmp_path / "split")
