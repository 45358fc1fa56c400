"""Tables have kinks: drives follow them with an impulse, adaptive steps end at them."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

RAMP = [[0, 0], [1, 0], [2, 1], [3, 1]]
INERTIA = 2.1


def driven() -> tuple[vv.System, vv.Motor]:
    """A wheel whose angle rests, grows and rests."""
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1.1, 1.1, INERTIA))
    axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    motor = vv.Motor(joint=axle, motion=RAMP)
    return vv.System([ground, wheel, axle, motor]), motor


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint()])
@pytest.mark.parametrize("h", [0.01, 0.013])
def test_motors_follow_the_kinks_of_tables(scheme: vv.scheme.schemes.Scheme, h: float) -> None:
    """The kinetic energy is that of the slope, before and after, whether steps end at kinks or not."""
    system, motor = driven()
    result = vv.simulate(system, until=2.9, step=h, scheme=scheme)
    time, kinetic = result.ledger["time"], result.ledger["kinetic"]
    expected = np.where((time > 1 + h) & (time < 2 - h), INERTIA / 2, 0.0)
    clear = (np.abs(time - 1) > 2 * h) & (np.abs(time - 2) > 2 * h)
    np.testing.assert_allclose(kinetic[clear], expected[clear], atol=1e-3)
    assert abs(motor.effort(system)) < 1e-6
    assert np.abs(result.ledger["imbalance"]).max() < 1e-5
    assert result.ledger.last("work_drive") == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("motion", [RAMP, "1 - cos(t)"])
@pytest.mark.parametrize("h", [0.01, 0.013])
def test_work_of_a_drive_is_what_the_energy_changes_by(motion: object, h: float) -> None:
    """Where rates are projected, half of each impulse of the drive acts at either end of a step, along the rates there:
    m s^2 / 2 is the work so far, with the slope s of the motion."""
    ground, sledge = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1))
    rail = vv.Prismatic(a=ground, b=sledge, at=(0, 0, 0), axis=(1, 0, 0))
    system = vv.System([ground, sledge, rail, vv.Motor(joint=rail, motion=motion)])
    ledger = vv.simulate(system, until=2.9, step=h, scheme=vv.VariationalMidpoint()).ledger
    time = ledger["time"]
    slope = np.sin(time) if isinstance(motion, str) else 1.0 * ((time > 1 - 1e-9) & (time < 2 - 1e-9))
    np.testing.assert_allclose(ledger["work_drive"], slope**2, atol=1e-11)
    assert ledger.size("imbalance") < 1e-11


@pytest.mark.parametrize("h", [0.01, 0.013])
def test_work_of_a_drive_that_turns_a_wheel(h: float) -> None:
    """To rounding where steps end at kinks, else as well as directors turn with a jump within a step."""
    system, _ = driven()
    ledger = vv.simulate(system, until=2.9, step=h, scheme=vv.VariationalMidpoint()).ledger
    assert ledger.size("imbalance") < (1e-12 if h == 0.01 else 1e-4)
    time = ledger["time"]
    moves = (time > 1 - 1e-9) & (time < 2 - 1e-9)
    np.testing.assert_allclose(ledger["work_drive"], INERTIA / 2 * moves, atol=1e-4)


def test_prescribed_nodes_follow_the_kinks_of_tables() -> None:
    """A rod that is pushed by its end, without delay, from rest and at once."""
    mesh = vv.RectangleMesh(size=(1, 0.2), counts=(4, 1))
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=100.0, poisson=0.0), density=1.0)
    push = vv.Prescribed(solid=solid, nodes="x0", motion=([[0, 0], [0.5, 0], [1, 0.1], [2, 0.1]], 0, None))
    system = vv.System([solid, push])
    ends = np.isclose(solid.points[:, 0], 0.0)
    for _ in vv.march(system, until=1.5, step=0.02):
        rate = solid.velocities(system.x, system.v)[ends, 0]
        expected = 0.2 if 0.5 - 1e-9 < system.time < 1 - 1e-9 else 0.0
        np.testing.assert_allclose(rate, expected, atol=1e-9)


def test_motion_that_starts_with_a_slope() -> None:
    """The rate from the start on is that of the first piece, and not that of the time before it."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0)
    rail = vv.Prismatic(a=ground, b=vv.RigidBody(mass=1.0, inertia=(1, 1, 1)), at=(0, 0, 0), axis=(1, 0, 0))
    motor = vv.Motor(joint=rail, motion=[[0, 0], [1, 2]])
    result = vv.simulate(vv.System([ground, rail.b, ball, rail, motor]), until=0.1, step=0.01)
    np.testing.assert_allclose(result.ledger["kinetic"], 2.0, rtol=1e-9)


def test_adaptive_steps_see_pulses_of_tables() -> None:
    """A blow of four units of momentum between times that smooth motion would jump over."""
    ball = vv.PointMass(mass=1.0)
    blow = [[0, 0], [5, 0], [5.01, 100], [5.04, 100], [5.05, 0], [10, 0]]
    system = vv.System([ball, vv.Force(on=ball, force=(1, 0, 0), times=blow)])
    result = vv.simulate(system, until=10.0, step=0.01, adaptive=vv.Adaptive(tolerance=1e-5))
    assert system.v[0] == pytest.approx(4.0, rel=1e-9)
    assert set(np.round([5, 5.01, 5.04, 5.05], 9)) <= set(np.round(result.times, 9))


def test_functions_that_give_no_number() -> None:
    ball = vv.PointMass(mass=1.0)
    push = vv.Force(on=ball, force=(1, 0, 0), times=lambda t: np.array([t, t]))
    with pytest.raises(vv.InputError, match=r"a function of time gave array.* which is no number"):
        vv.simulate(vv.System([ball, push]), until=0.1, step=0.1)


def test_each_drive_books_its_own_impulses() -> None:
    """A motor that rests does no work, whichever is named first; short times are seen, fine samples are no kinks."""

    def works(order: int, unit: float) -> tuple[float, float]:
        mesh = vv.RectangleMesh(size=(1, 0.2), counts=(2, 1))
        solid = vv.Solid(
            mesh=mesh, material=vv.LinearElastic(young=100.0 / unit**2, poisson=0.0), density=1.0
        )
        push = vv.Prescribed(
            solid=solid, nodes="x0", motion=([[0, 0], [0.4 * unit, 0], [0.8 * unit, 0.1]], 0, None)
        )
        ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
        axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
        still = vv.Motor(joint=axle, motion=0.0)
        system = vv.System([solid, ground, wheel, axle, *[push, still][::order]])
        result = vv.simulate(system, until=unit, step=0.02 * unit)
        ledger = result.ledger
        return ledger.size("work_drive") * unit**2, ledger.size("work_prescribed motion") * unit**2

    seconds = works(1, 1.0)
    assert seconds[0] < 1e-12 < 1e-4 < seconds[1]
    assert works(-1, 1.0) == pytest.approx(seconds, abs=1e-12)
    assert works(1, 1e-9) == pytest.approx(seconds, rel=1e-6, abs=1e-12)
    times = np.linspace(0, 2, 2001)
    sampled = vv.TimeFunction(np.column_stack([times, 0.1 * np.sin(times)]))
    assert len(sampled.kinks) <= 2


def test_kinks_are_found_once() -> None:
    function = vv.TimeFunction(RAMP)
    assert function.kinks is function.kinks
