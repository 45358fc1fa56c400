"""Results in hand: histories of any probe, tables, files, pictures, and what notebooks show."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.output import Trajectory, read_table
from visviva.output.states import StateFile
from visviva.results.showing import Picture

STEEL = vv.LinearElastic(young=100.0, poisson=0.3)


def pendulum() -> tuple[vv.System, vv.Spherical]:
    ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0), name="arm")
    ball = vv.Spherical(a=ground, b=arm, at=(0, 0, 0))
    return vv.System([ground, arm, ball, vv.Gravity()], units="SI"), ball


def bar() -> vv.System:
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 1), counts=(2, 1, 1)), material=STEEL, density=1.0, name="bar"
    )
    pull = vv.Traction(solid=solid, faces="x1", traction=(1.0, 0, 0), times="sin(3*t)")
    return vv.System([solid, pull, vv.Fixed(solid=solid, nodes="x0")])


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2(), vv.VariationalMidpoint()], ids=str)
def test_reactions_looked_back_are_those_recorded(scheme: vv.Scheme) -> None:
    """Forces at an instant follow from its state; those recorded were asked for at every step."""
    system, ball = pendulum()
    before = vv.ReactionForce(joint=ball)
    result = vv.simulate(system, until=0.3, step=0.01, scheme=scheme, record=[before])
    state, time = system.x.copy(), system.time
    after = result.history(vv.ReactionForce(joint=ball))
    np.testing.assert_allclose(after[1:], result.history(before)[1:], atol=1e-9)
    assert np.abs(after).max() > 5
    np.testing.assert_array_equal(system.x, state)  # the system is where it was
    assert system.time == time


def test_fields_and_sections_looked_back() -> None:
    system = bar()
    solid: Any = system["bar"]
    probes = {
        "most": vv.Extreme(solid=solid),
        "section": vv.SectionForce(solid=solid, point=(2, 0, 0), normal=(1, 0, 0)),
        "tip": vv.Displacement(of=solid, at=(4, 0.5, 0.5)),
        "speed": vv.Velocity(of=solid, at=(4, 0.5, 0.5)),
        "own": lambda s: 2 * s.time,
    }
    result = vv.simulate(system, until=0.1, step=0.01, record=probes)
    again = {
        "most": vv.Extreme(solid=solid),
        "section": vv.SectionForce(solid=solid, point=(2, 0, 0), normal=(1, 0, 0)),
        "tip": vv.Displacement(of=solid, at=(4, 0.5, 0.5)),
        "speed": vv.Velocity(of=solid, at=(4, 0.5, 0.5)),
        "own": lambda s: 2 * s.time,
    }
    for name, probe in again.items():
        np.testing.assert_allclose(result.history(probe), result.history(name), atol=1e-12, err_msg=name)
    np.testing.assert_allclose(result.history("own"), 2 * result.recorded_times)


def test_what_states_do_not_tell_is_refused_with_the_cure() -> None:
    system = bar()
    solid: Any = system["bar"]
    held = vv.SupportForce(solid=solid, nodes="x0")
    result = vv.simulate(system, until=0.02, step=0.01, record=[held], every=2)
    assert result.history(held).shape == (3, 3)  # at every step
    assert len(result.times) == 2
    with pytest.raises(vv.InputError, match=r"SupportForce belongs to a step.*record=\[probe\]"):
        result.history(vv.SupportForce(solid=solid))
    with pytest.raises(vv.InputError, match="nothing is recorded as 'held'"):
        result.history("held")
    with pytest.raises(vv.InputError, match=r"what is a form, vector, strain, measure or probe.*not 3"):
        result.history(3)
    with pytest.raises(vv.InputError, match="record is a list of probes"):
        vv.simulate(system, until=0.1, step=0.01, record=held)
    static = vv.quasi_static(bar(), until=0.5, step=0.25)
    forces = static.history(vv.SupportForce(solid=static.system["bar"], nodes="x0"))
    np.testing.assert_allclose(forces[:, 0], -np.sin(3 * static.times), atol=1e-9)  # what the traction pulls


@pytest.mark.parametrize("every", [1, 3, 10, 20, 99])
def test_the_last_state_is_kept_whatever_is_left_out(every: int) -> None:
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    result = vv.simulate(system, until=2.0, step=0.1, every=every)
    expected = sorted({*range(0, 21, every), 20})
    np.testing.assert_allclose(result.times, 0.1 * np.array(expected), atol=1e-12)
    np.testing.assert_array_equal(result.states[-1], system.x)
    static = vv.quasi_static(bar(), until=0.5, step=0.1, every=every)
    assert static.times[-1] == 0.5


def test_states_beyond_the_budget_go_to_a_file() -> None:
    kept, spilt = (vv.simulate(bar(), until=0.2, step=0.01, memory=m) for m in (1e9, 3000.0))
    assert isinstance(spilt.kept, StateFile)
    assert not isinstance(kept.kept, StateFile)
    np.testing.assert_array_equal(np.array(spilt.states), np.array(kept.states))
    np.testing.assert_array_equal(spilt.times, kept.times)
    folder = Path(spilt.kept.path).parent
    assert folder.exists()
    del spilt
    gc.collect()
    assert not folder.exists()
    with pytest.raises(vv.InputError, match="memory = 0"):
        vv.simulate(bar(), until=0.2, step=0.01, memory=0)


def test_tables(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    system, ball = pendulum()
    force = vv.ReactionForce(joint=ball)
    result = vv.simulate(system, until=0.1, step=0.01, record={"force": force})
    frame = result.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == ["force_x", "force_y", "force_z"]
    np.testing.assert_array_equal(frame["force_z"], result.history("force")[:, 2])
    place = vv.Position(of=system["arm"])
    assert list(result.to_dataframe(place, tip=place).columns)[:4] == [
        "probe_1_x",
        "probe_1_y",
        "probe_1_z",
        "tip_x",
    ]
    np.testing.assert_array_equal(result.ledger.to_dataframe()["total"], result.ledger["total"])
    file = result.to_csv(tmp_path / "f.csv")
    assert file.read_text().splitlines()[0] == "time [s],force_x [N],force_y [N],force_z [N]"
    np.testing.assert_array_equal(read_table(file)["force_y"], frame["force_y"])
    assert result.ledger.to_csv(tmp_path / "l.csv").read_text().startswith("time [s],kinetic [J]")


def test_a_missing_pandas_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    result = vv.simulate(pendulum()[0], until=0.02, step=0.01)
    with pytest.raises(vv.InputError, match=r"pip install 'visviva\[tables\]'"):
        result.ledger.to_dataframe()


def test_files_of_a_result_are_read_back(tmp_path: Path) -> None:
    system, ball = pendulum()
    result = vv.simulate(system, until=0.1, step=0.01, record={"force": vv.ReactionForce(joint=ball)})
    result.write(tmp_path / "out")
    stored = vv.read(tmp_path / "out")
    np.testing.assert_array_equal(stored.ledger["total"], result.ledger["total"])
    np.testing.assert_array_equal(stored.probes["force_z"], result.history("force")[:, 2])
    assert stored.labels.column("force_z") == "force_z [N]"
    assert stored.summary["steps"] == 10
    assert stored.time_values == pytest.approx(result.times)
    assert "force_x" in stored.to_dataframe()
    pyvista = pytest.importorskip("pyvista")
    stored.set_active_time_value(0.1)
    meshes = stored.read()
    assert isinstance(meshes, pyvista.MultiBlock)
    with Trajectory(tmp_path / "out" / "trajectory.vtkhdf") as motion:
        np.testing.assert_array_equal(meshes["arm"].points, motion.points(10)[0])
    with pytest.raises(vv.InputError, match="has no time"):
        stored.set_active_time_value(0.2)
    with pytest.raises(vv.InputError, match="already holds a run"):
        result.write(tmp_path / "out")


def test_plots_and_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from visviva.output import plot, stage

    monkeypatch.setitem(plot.STYLE, "svg.fonttype", "none")
    monkeypatch.setattr(stage, "can_render", lambda: False)
    system, ball = pendulum()
    result = vv.simulate(system, until=0.1, step=0.01, record={"force": vv.ReactionForce(joint=ball)})
    drawn = result.plot(tmp_path / "p.svg", arm=vv.Position(of=system["arm"]))
    assert drawn.path == tmp_path / "p.svg"
    said = drawn.path.read_text()
    assert all(f">{word}<" in said for word in ("energy [J]", "time [s]", "arm", "[m]"))
    assert result.plot()._repr_mimebundle_()["image/png"][:4] == b"\x89PNG"
    shown = result.picture(tmp_path / "p.png", size=(160, 120))
    assert isinstance(shown, Picture)
    assert shown.data == (tmp_path / "p.png").read_bytes()
    assert result.movie(tmp_path / "m.gif", size=(160, 120), fps=50).stat().st_size > 500


def test_what_notebooks_show() -> None:
    system, ball = pendulum()
    result = vv.simulate(system, until=0.1, step=0.01, record={"force": vv.ReactionForce(joint=ball)})
    solid: Any = bar()["bar"]
    assert system.report is not None
    for thing in (system, result, result.ledger, system.report, solid.grid, solid, ball):
        assert len(repr(thing)) < 300
        assert "\n" not in repr(thing)
    for thing in (system, result, result.ledger, system.report, solid.grid, solid):
        html = thing._repr_html_()
        assert html.count("<table>") == html.count("</table>") >= 1
    assert "conserved" in result._repr_html_()
    assert (
        result._repr_html_().count("<svg") == 7
    )  # energies, the error of the balance, and three of the force
    assert "hex8" in solid._repr_html_()


def test_results_outlive_their_system_only_by_what_was_kept(tmp_path: Path) -> None:
    """What a reset system holds is another run, of which an earlier result knows nothing."""
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
    system, place = vv.System([ball]), vv.Position(of=ball)
    first = vv.simulate(system, until=1.0, step=0.1, record={"place": place})
    vv.simulate(system, until=2.0, step=0.1)
    assert "to t = 1 " in first.audit()
    assert "to t = 1 " in repr(first)
    assert first.history(place)[-1] == pytest.approx([1.0, 0, 0])
    ball.velocity = (3, 0, 0)
    second = vv.simulate(system, until=1.0, step=0.1, start="beginning")
    assert second.history(vv.Position(of=ball))[-1] == pytest.approx([3.0, 0, 0])
    assert first.history("place")[-1] == pytest.approx([1.0, 0, 0])
    assert first.columns()["place_x"][-1] == pytest.approx(1.0)
    for look in (
        lambda: first.history(vv.Position(of=ball)),
        first.audit,
        lambda: first.write(tmp_path / "x"),
        first.picture,
    ):
        with pytest.raises(vv.InputError, match="was reset since"):
            look()


def test_shapes_and_notebooks_of_a_reset_system() -> None:
    system = bar()
    vv.simulate(system, until=0.1, step=0.1)
    result, found = vv.simulate(system, until=0.2, step=0.1), vv.modes(bar(), 2)
    system.reset()
    assert "states kept" in result._repr_html_()
    found.system.reset()
    with pytest.raises(vv.InputError, match="was reset since"):
        found.leader(0)


def test_times_far_from_zero() -> None:
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    system.time = 1.7e9
    assert vv.simulate(system, until=1.7e9 + 1, step=0.01).statistics.steps == 100
