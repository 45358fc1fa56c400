"""Initial states that do not fit: moved onto the constraints and told, refused if it is far unless that is meant."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.analysis.march import know
from visviva.output import RunDirectory
from visviva.study.run import run
from visviva.system.consistency import accelerations
from visviva.system.instant import Instant


def bob(length: float = 1.0, velocity: Any = (0, 0, 0)) -> vv.System:
    """A ball on a rod of length one, wherever it is said to be."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(length, 0, 0), velocity=velocity, name="bob")
    rod = vv.Distance(a=ground.point(), b=ball.point(), length=1.0)
    return vv.System([ground, ball, rod, vv.Gravity()])


def simulated(system: vv.System, project: bool) -> vv.Result:
    return vv.simulate(system, until=0.02, step=0.01, project=project)


def relaxed(system: vv.System, project: bool) -> vv.Result:
    return vv.equilibrium(system, project=project)


@pytest.mark.parametrize("march", [simulated, relaxed])
def test_places_far_off_are_refused(march: Callable[[vv.System, bool], vv.Result]) -> None:
    system = bob(3.0)
    x, v = system.x.copy(), system.v.copy()
    with pytest.raises(vv.InputError, match=r"moved far: position of PointMass 'bob' by 2;.*project=True"):
        march(system, False)
    np.testing.assert_array_equal((system.x, system.v), (x, v))
    result = march(system, True)
    assert "position of PointMass 'bob' by 2" in result.ledger.moves
    assert np.linalg.norm(system.x[:3]) == pytest.approx(1.0)


def test_speeds_across_constraints_are_refused() -> None:
    """Five metres per second along the rod would be lost without a word."""
    with pytest.raises(vv.InputError, match="velocity of PointMass 'bob' by 5"):
        simulated(bob(1.0, (5, 0, 1)), False)
    result = simulated(bob(1.0, (5, 0, 1)), True)
    assert "velocity of PointMass 'bob' by 5" in result.ledger.moves
    assert result.ledger.first("kinetic") == pytest.approx(0.5)


def test_small_moves_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    result = simulated(bob(1.00001), False)
    assert result.ledger.moves == ["position of PointMass 'bob' by 1e-05"]
    assert "initial state moved onto the constraints: position of PointMass 'bob'" in capsys.readouterr().err
    simulated(bob(), False)
    assert capsys.readouterr().err == ""


def test_statics_has_no_velocities_to_lose() -> None:
    """Velocities play no part there, so that none is refused."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1), velocity=(0, 0, 3))
    rod = vv.Distance(a=ground.point(), b=ball.point())
    springs = [vv.Spring(a=ground.point(p), b=ball.point(), stiffness=9.0) for p in ((1, 0, -1), (0, 1, -1))]
    vv.quasi_static(vv.System([ground, ball, rod, *springs]), until=1.0, step=1.0)


def test_what_rests_takes_the_speed_of_what_drives_it() -> None:
    """Bodies at rest on a driven joint gave no velocity: nothing of theirs is lost."""
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    rim = vv.PointMass(mass=1.0, position=(1, 0, 0))
    hinge = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    drive = vv.Motor(joint=hinge, motion=lambda t: 2.0 * t)
    rod = [vv.Distance(a=wheel.point(p), b=rim.point()) for p in ((0, 1, 0), (0, -1, 0), (0, 0, 1))]
    result = simulated(vv.System([ground, wheel, rim, hinge, drive, *rod]), False)
    assert any("velocity of PointMass" in move for move in result.ledger.moves)


def test_refused_runs_leave_the_earlier_one(tmp_path: Path) -> None:
    """Files are deleted when nothing is left to refuse."""
    run(vv.Study(bob(), 0.02, 0.01), tmp_path / "run", pictures=False)
    kept = (tmp_path / "run" / "ledger.csv").read_bytes()
    with pytest.raises(vv.InputError, match="moved far"):
        run(vv.Study(bob(3.0), 0.02, 0.01), tmp_path / "run", overwrite=True, pictures=False)
    assert (tmp_path / "run" / "ledger.csv").read_bytes() == kept
    for options in ({}, {"adaptive": vv.Adaptive()}, {"scheme": vv.Static()}):
        with pytest.raises(vv.InputError, match=r"step = 0\.05 is longer than the way of 0\.02"):
            run(vv.Study(bob(), 0.02, 0.05, **options), tmp_path / "run", overwrite=True, pictures=False)
        assert (tmp_path / "run" / "ledger.csv").read_bytes() == kept
    with pytest.raises(vv.InputError, match="exclude each other"):
        run(vv.Study(bob(), 0.02, 0.01), tmp_path / "run", overwrite=True, resume=True, pictures=False)
    run(vv.Study(bob(3.0), 0.03, 0.01), tmp_path / "run", overwrite=True, project=True, pictures=False)
    summary = RunDirectory.open(tmp_path / "run").read_summary()
    assert summary["initial_state_moved"] == ["position of PointMass 'bob' by 2"]


def test_states_edited_later_are_looked_at_again() -> None:
    """A ball that is pulled off its rod between two runs would be shot back."""
    system = bob()
    simulated(system, False)
    system.x[0] = 1.3
    system.invalidate()
    with pytest.raises(vv.InputError, match=r"moved far: position of PointMass 'bob' by 0\.3"):
        vv.simulate(system, until=0.04, step=0.01)
    vv.simulate(system, until=0.04, step=0.01, project=True)
    assert np.linalg.norm(system.x[:3]) == pytest.approx(1.0)
    system.v[:3] = (0, 0, 2)  # along the rod, nearly
    system.v[:3] += 5 * system.x[:3]
    system.invalidate()
    with pytest.raises(vv.InputError, match="velocity of PointMass 'bob'"):
        vv.simulate(system, until=0.06, step=0.01)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BDF2(), vv.GeneralizedAlpha(0.8)])
def test_touching_alone_changes_nothing(scheme: vv.scheme.schemes.Scheme) -> None:
    one, other = bob(), bob()
    for system in (one, other):
        vv.simulate(system, until=0.1, step=0.05, scheme=scheme)
    other.invalidate()
    for system in (one, other):
        vv.simulate(system, until=0.2, step=0.05, scheme=scheme)
    assert np.abs(one.x[:3] - other.x[:3]).max() < 1e-13


def test_statics_brings_to_rest() -> None:
    """Speeds of dynamics before it are over; dynamics after it begins with those of prescribed motion alone."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0)
    lift = vv.Prescribed(solid=solid, nodes="z0", motion=(0, 0, "0.1*t"))
    system = vv.System([solid, lift, vv.Gravity(acceleration=(1, 0, -1))])
    vv.simulate(system, until=0.5, step=0.02)
    assert np.abs(system.v).max() > 0.1
    vv.quasi_static(system, until=1.5, step=0.5)
    assert np.abs(system.v).max() == 0.0
    result = vv.simulate(system, until=1.6, step=0.1)
    bottom = np.isclose(solid.points[:, 2], 0.0)
    rates = solid.velocities(result.states[0], result.rates[0])
    np.testing.assert_allclose(rates[bottom], [[0, 0, 0.1]] * 9, atol=1e-9)
    assert np.abs(rates[~bottom]).max() == 0.0


@pytest.mark.parametrize("cell", ["quad4", "hex8", "tet4"])
def test_pressures_of_the_start_hold_nothing_that_pushes_nothing(cell: Any) -> None:
    """Equal order has such modes; rounding made them, a part in 10^3 to 10^5, and books were those of rounding."""
    d, found = 2 if cell == "quad4" else 3, []
    mesh: Any = vv.RectangleMesh if d == 2 else vv.BoxMesh
    for y in (0.0, 0.3):
        grid = mesh(size=(2, 1, 1)[:d], counts=(6, 4, 2)[:d], origin=(0, y, 0)[:d], cell=cell)
        water = vv.Fluid(mesh=grid, density=1.0, viscosity=0.05)
        inlet = vv.VelocityBoundary(
            fluid=water,
            faces="x0",
            velocity=lambda t, X, y=y: 20 * t * (X - y)[:, 1:2] * (1 + y - X)[:, 1:2] * [1, 0, 0],
        )
        walls = [vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1", "z0", "z1")[: 2 * d - 2]]
        system = vv.System([water, inlet, *walls, vv.Outlet(fluid=water, faces="x1")])
        know(system, 0.05)
        at = Instant(system)
        at.add_rate_constraints()
        at.factor()
        found.append(accelerations(system, at))
    (a, p), (b, q) = found
    assert np.allclose(b, a, rtol=0, atol=1e-12 * np.abs(a).max())
    assert np.allclose(q, p, rtol=0, atol=2e-8 * np.abs(p).max())
