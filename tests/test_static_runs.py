"""Statics as a study: the same as in Python, resumed to the same bits, from scene files and the command line."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from interrupting import after_rows, run_until

import visviva as vv
from visviva.cli import main
from visviva.output import Trajectory, read_table
from visviva.scene import read_scene, write_scene
from visviva.study.run import run as run_study

run = partial(run_study, pictures=False)


def console(scheme: vv.Scheme | None = None, until: float = 1.0, step: float = 0.125) -> vv.Study:
    """A bending bar whose load grows; large deflections."""
    mesh = vv.BoxMesh(size=(4, 0.5, 0.5), counts=(6, 1, 1), cell="hex20")
    bar = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=500.0, poisson=0.3), name="bar")
    clamp = vv.Fixed(solid=bar, nodes="x0", name="clamp")
    load = vv.Traction(solid=bar, faces="x1", traction=(0, 0, -3.0), times="t", name="load")
    probes = {
        "tip": vv.Displacement(of=bar.point((4, 0.25, 0.25))),
        "held": vv.SupportForce(solid=bar, nodes="x0"),
    }
    system = vv.System([bar, clamp, load])
    return vv.Study(system, until, step, scheme or vv.Static(), probes=probes)


def test_a_study_of_statics_is_quasi_static(tmp_path: Path) -> None:
    study, other = console(), console()
    result = run(study, tmp_path / "run")
    vv.quasi_static(other.system, until=1.0, step=0.125)
    assert study.system.x.tobytes() == other.system.x.tobytes()
    for file in ("probes.csv", "ledger.csv"):
        assert (tmp_path / "run" / file).read_text().startswith("load_parameter,")
    assert result.to_dataframe(end=study.probes["tip"]).index.name == "load_parameter"
    assert vv.read(tmp_path / "run").to_dataframe().index.name == "load_parameter"
    table = read_table(tmp_path / "run" / "probes.csv")
    assert table["time"] == pytest.approx(np.linspace(0, 1, 9), abs=1e-12)
    assert table["held_z"] == pytest.approx(3.0 * 0.25 * table["time"], abs=1e-8)
    assert table["tip_z"][-1] < -0.5
    assert len(Trajectory(tmp_path / "run" / "trajectory.vtkhdf").times) == 9
    assert result.statistics.steps == 8


def test_the_last_iteration_needs_no_tangent_of_its_own() -> None:
    """Load steps end as close to equilibrium as their tolerance says, by an increment of the tangent before."""
    rough, exact = console(vv.Static(tolerance=1e-8)), console(vv.Static(tolerance=1e-13))
    reports = [list(vv.march(s.system, until=1.0, step=0.125, scheme=s.scheme)) for s in (rough, exact)]
    spared = [sum(r.iterations - r.factorizations for r in steps) for steps in reports]
    assert min(spared) >= 4
    x = exact.system.x
    assert np.abs(rough.system.x - x).max() < 1e-8 * np.abs(x).max()


@pytest.mark.parametrize(
    "scheme",
    [vv.Static(), vv.Static(line_search=False, tolerance=1e-8, max_iterations=4), vv.ArcLength()],
    ids=["statics", "few iterations", "arc length"],
)
def test_statics_in_two_parts_are_the_same_bits(scheme: vv.Scheme, tmp_path: Path) -> None:
    """The second with so few iterations that load steps are cut and grow again."""
    step = 0.5 if "max_iterations=4" in str(scheme) else 0.125
    whole, first, second = (console(scheme, step=step) for _ in range(3))
    run(whole, tmp_path / "whole")
    first.until = 0.55
    run(first, tmp_path / "parts")
    assert first.system.time < 1.0
    run(second, tmp_path / "parts", resume=True)
    if isinstance(scheme, vv.ArcLength):
        assert whole.system.x.tobytes() == second.system.x.tobytes()
    if step == 0.5:
        assert whole.system.stepper.rejected > 0
    assert np.abs(whole.system.x - second.system.x).max() < 1e-7
    table = read_table(tmp_path / "parts" / "probes.csv")
    assert len(np.unique(table["time"])) == len(table["time"])


@pytest.mark.parametrize("scheme", [vv.Static(), vv.ArcLength()], ids=["statics", "arc length"])
def test_interrupted_statics_go_on_to_the_same_bits(
    scheme: vv.Scheme, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C after the fourth load step, as it comes while one is computed."""
    whole, first, second = (console(scheme) for _ in range(3))
    run(whole, tmp_path / "whole")
    run_until(after_rows(5), first, tmp_path / "parts")
    assert 0.2 < first.system.time < 0.9
    run(second, tmp_path / "parts", resume=True)
    assert second.system.x.tobytes() == whole.system.x.tobytes()
    ours, theirs = (read_table(tmp_path / d / "ledger.csv") for d in ("whole", "parts"))
    for name, values in ours.items():
        np.testing.assert_array_equal(values, theirs[name], err_msg=name)


SCENE = """
system:
  bar:
    Solid:
      mesh: {BoxMesh: {size: [4, 0.5, 0.5], counts: [6, 1, 1], cell: hex20}}
      material: {SaintVenantKirchhoff: {young: 500.0, poisson: 0.3}}
  clamp: {Fixed: {solid: bar, nodes: x0}}
  load: {Traction: {solid: bar, faces: x1, traction: [0, 0, -3.0], times: t}}
run: {until: 1.0, step: 0.125, scheme: SCHEME}
probes:
  tip: {Displacement: {of: {point: bar, X: [4, 0.25, 0.25]}}}
  held: {SupportForce: {solid: bar, nodes: x0}}
"""


@pytest.mark.parametrize(
    ("text", "scheme"),
    [
        ("Static", vv.Static()),
        ("{Static: {tolerance: 1.0e-9}}", vv.Static(tolerance=1e-9)),
        ("{ArcLength: {longest: 2.0}}", vv.ArcLength(longest=2.0)),
    ],
)
def test_scenes_of_statics_make_the_round_trip(text: str, scheme: vv.Scheme, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.replace("SCHEME", text))
    study = read_scene(tmp_path / "scene.yaml")
    assert study.scheme == scheme
    write_scene(study, tmp_path / "copy.toml")
    again = read_scene(tmp_path / "copy.toml")
    assert again.scheme == scheme
    ends = [vv.simulate(s.system, until=0.3, step=0.125, scheme=s.scheme).states[-1] for s in (study, again)]
    assert ends[0].tobytes() == ends[1].tobytes()
    assert np.abs(study.probes["tip"](study.system)).max() > 0.1  # type: ignore[operator]


def test_a_scene_of_statics_runs_and_resumes_from_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.replace("SCHEME", "Static"))
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as patched:  # a picture of the first half is drawn over
        patched.setattr("visviva.study.drawings.draw_run", lambda *_, **__: [])
        assert main(["run", "scene.yaml", "--out", "out", "--until", "0.5"]) == 0, capsys.readouterr().err
    code = main(["run", "scene.yaml", "--out", "out", "--until", "1.0", "--resume"])
    out, err = capsys.readouterr()
    assert code == 0, err
    assert "audit of 8 steps" in out
    study = read_scene(tmp_path / "scene.yaml")
    vv.quasi_static(study.system, until=1.0, step=0.125)
    tip = read_table(tmp_path / "out" / "probes.csv")
    assert tip["tip_z"][-1] == study.probes["tip"](study.system)[2]  # type: ignore[operator]
    assert (tmp_path / "out" / "picture.png").exists()


def truss() -> vv.Study:
    """Two bars of springs that snap through: the load falls after its first limit point."""
    ground, top = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 0.5), name="top")
    bars = [vv.Spring(a=ground.point((x, 0, 0)), b=top.point(), stiffness=100.0) for x in (-2.0, 2.0)]
    plane = vv.PointOnLine(a=ground.frame((0, 0, 0)), b=top.point())
    push = vv.Force(on=top, force=(0, 0, -1.0), times="10*t")
    system = vv.System([ground, top, *bars, plane, push])
    return vv.Study(system, 1.0, 0.01, vv.ArcLength(), probes={"height": top.point().position})


def test_a_path_through_limit_points_is_resumed_to_the_same_bits(tmp_path: Path) -> None:
    """The load parameter of the exact path ``10 t = 2 k z (l0 / l - 1)`` falls and rises again."""
    whole, first, second = truss(), truss(), truss()
    run(whole, tmp_path / "whole")
    first.scheme = second.scheme = vv.ArcLength()
    run_until(after_rows(19), first, tmp_path / "parts")
    run(second, tmp_path / "parts", resume=True)
    assert second.system.x.tobytes() == whole.system.x.tobytes()
    ours, theirs = (read_table(tmp_path / d / "probes.csv") for d in ("whole", "parts"))
    np.testing.assert_array_equal(ours["height_z"], theirs["height_z"])
    t, z = ours["time"], ours["height_z"]
    assert np.diff(t).min() < 0 < np.diff(t)[-1]
    length, free = np.sqrt(4 + z**2), np.sqrt(4.25)
    assert t == pytest.approx(20 * z * (free / length - 1), abs=1e-8)
    steps = read_frames(tmp_path / "parts" / "trajectory.vtkhdf")
    assert np.array_equal(steps, np.arange(len(steps)))


def test_the_last_state_of_a_path_that_ends_by_itself_is_written(tmp_path: Path) -> None:
    study = truss()
    study.scheme = vv.ArcLength(most=7)
    result = run(study, tmp_path / "run", every=5)
    table = read_table(tmp_path / "run" / "probes.csv")
    assert study.system.time < study.until
    assert len(table["time"]) == len(result.times) == 3
    assert table["time"][-1] == result.times[-1] == study.system.time
    assert read_frames(tmp_path / "run" / "trajectory.vtkhdf").tolist() == [0, 5, 7]


def read_frames(path: Path) -> Any:
    with Trajectory(path) as trajectory:
        return np.array(trajectory.times)


def test_an_unheld_scene_of_statics_is_refused(tmp_path: Path) -> None:
    study = vv.Study(vv.System([vv.PointMass(mass=1.0)]), 1.0, 0.5, vv.Static())
    with pytest.raises(vv.InputError, match=r"nothing holds PointMass .*translation along x, y, z"):
        run(study, tmp_path / "run")
