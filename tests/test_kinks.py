"""Tables have kinks: drives follow them with an impulse, adaptive steps end at them."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import visviva as vv
from visviva.system.instant import Instant

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


LED = [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint(), vv.BDF2(), vv.GeneralizedAlpha()]


def led(path: Any, kind: str = "motor", turns: float = 0.0) -> tuple[vv.System, Any]:
    """A body of 3 kg m^2 about its axle that is led along a path, and its drive."""
    ground = vv.Ground()
    spin: Any = {"velocity": (0, turns, 0), "angular_velocity": (0, 0, turns)}
    body = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0), **spin)
    axle = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    drive: Any = vv.Motor(joint=axle, motion=path)
    if kind == "servo":
        drive = vv.Servo(output=[axle], follows=[path], actuators=[axle])
    return vv.System([ground, body, axle, drive]), drive


def all_work(result: vv.Result) -> float:
    return sum(result.ledger.last(f"work_{name}") for name in result.ledger.works)


@pytest.mark.parametrize("kind", ["motor", "servo"])
@pytest.mark.parametrize("scheme", LED, ids=str)
def test_kinks_are_met_that_lie_behind_a_step_by_rounding(scheme: Any, kind: str) -> None:
    """They counted as met, but with the rate before: 0, 2, 0, 2 rad/s for ever, by a work of .13 J."""
    times = np.arange(0, 1, 0.1)
    assert times[3] > 0.3
    system, _ = led([[t, max(t - times[3], 0.0)] for t in times], kind)
    result = vv.simulate(system, until=0.6, step=0.01, scheme=scheme)
    assert result.ledger["kinetic"][-20:] == pytest.approx(np.full(20, 1.5), rel=1e-3)
    assert all_work(result) == pytest.approx(1.5, rel=1e-3)


@pytest.mark.parametrize("step", [0.01, 0.02])
def test_adaptive_steps_meet_kinks_that_they_end_at_by_rounding(step: float) -> None:
    """Of 19 kinks at tenths two were missed: a work of 5.9 J, and the rate went to and fro."""
    found = []
    for at in np.arange(1, 20) * 0.1:
        system, _ = led([[0, 0], [at, 0], [at + 1, 1]])
        adaptive = vv.Adaptive(tolerance=1e-4)
        found.append(all_work(vv.simulate(system, until=at + 0.2, step=step, adaptive=adaptive)))
    assert found == pytest.approx(np.full(19, 1.5), rel=1e-2)


@pytest.mark.parametrize("dt", [0.01, 1 / 128])
def test_effort_by_a_table_that_is_sampled_at_every_step(dt: float) -> None:
    """Slopes were those before or behind a point by its rounding: 10 beside an effort of 1 at .01, .004 at 1/128."""
    times = np.arange(4 / dt + 2) * dt
    system, motor = led(np.column_stack([times, np.sin(times)]), turns=np.sin(dt) / dt)
    errors: list[float] = []

    def look(now: vv.System) -> None:
        errors.append(motor.effort(now) + 3 * np.sin(now.time))

    vv.simulate(system, until=4.0, step=dt, scheme=vv.GeneralizedAlpha(), observe=look)
    assert np.abs(errors[int(1 / dt) :]).max() < 2 * dt


def test_slopes_beside_a_point_do_not_ask_for_its_last_digit() -> None:
    """Before and behind it, from one step's rounding on either side; times are far from zero, too."""
    for begin in (0.0, 1e6):
        table = vv.TimeFunction([[begin, 0], [begin + 1, 0], [begin + 2, 3]])
        for t in begin + 1 + np.array([-5e-12, 0, 5e-12]):
            assert (table.rate(t, 0.01), table.rate_after(t, 0.01)) == (0, 3)
        assert (table.rate(begin + 1.001, 0.01), table.rate_after(begin + 0.999, 0.01)) == (3, 0)


ENDS = [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha(rho=0.0), vv.GeneralizedAlpha()]
WITHIN = {
    "one": [[0, 0], [0.1037, 0], [0.5037, 0.4]],
    "two": [[0, 0], [0.101, 0], [0.104, 0.006], [0.504, 0.406]],
}


@pytest.mark.parametrize("kinks", WITHIN)
@pytest.mark.parametrize("kind", ["motor", "servo"])
@pytest.mark.parametrize("scheme", ENDS, ids=str)
def test_work_of_kinks_within_a_step(scheme: Any, kind: str, kinks: str) -> None:
    """J w^2 / 2; by a part of that more, at every step, as the step's multipliers did some of it before the impulse."""
    errors = []
    for step in (0.01, 0.005):
        result = vv.simulate(led(WITHIN[kinks], kind)[0], until=0.3, step=step, scheme=scheme)
        errors.append(all_work(result) - 1.5)
    assert abs(errors[0]) < (2e-2 if scheme.order == 1 else 1e-3)
    assert abs(errors[1]) < 0.6 * abs(errors[0]) + 1e-6


def test_prescribed_nodes_do_the_work_of_a_kink_within_a_step() -> None:
    """m v^2 / 2 of a load on a rod, 1 J, by a block of hardly any mass."""
    for scheme in ENDS:
        block = vv.Solid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
            material=vv.NeoHooke(young=1e-6, poisson=0.3),
            density=1e-6,
        )
        load = vv.PointMass(mass=2.0, position=(3, 0, 0))
        push = vv.Prescribed(solid=block, nodes="x1", motion=([[0, 0], [0.1037, 0], [1.1037, 1]], 0, 0))
        rod = vv.Distance(a=block.point((1, 0, 0)), b=load.point())
        system = vv.System([block, load, push, rod])
        result = vv.simulate(system, until=0.3, step=0.01, scheme=scheme)
        assert result.ledger.last("work_prescribed motion") == pytest.approx(1.0, abs=1e-6)


def folding(at: float, elbow: tuple[float, float], until: float) -> list[float]:
    """Work of both drives of an arm of two equal links whose shoulder begins to turn by 1 rad/s, its elbow from one of
    these rates to the other: Lagrange's equations with their impulses."""
    m, J = 2.0, 1.0
    cos, sin = np.cos(at * elbow[0]), np.sin

    mixed = J + m + 2 * m * cos
    M = np.array([[2 * J + 6 * m + 4 * m * cos, mixed], [mixed, J + m]])
    before, after = np.array([0, elbow[0]]), np.array([1, elbow[1]])
    work = M @ (after - before) * (before + after) / 2

    def power(t: float, which: int) -> float:
        (a, b), bend = (before, elbow[0] * t) if t < at else (after, elbow[0] * at + elbow[1] * (t - at))
        lever = -2 * m * sin(bend)
        return float(lever * (2 * a * b + b * b) * a if which == 0 else -lever * a * a * b)

    return [work[k] + quad(power, 0, until, (k,), points=[at])[0] for k in (0, 1)]


@pytest.mark.parametrize("elbow", [(0.0, -2.0), (-2.0, -2.0)])
@pytest.mark.parametrize(("at", "far"), [(0.1, 1e-4), (0.1037, 1e-3)])
@pytest.mark.parametrize("scheme", [*LED, vv.BackwardEuler()], ids=str)
def test_each_drive_of_an_arm_does_the_work_of_its_own_impulse(
    scheme: Any, at: float, far: float, elbow: tuple[float, float]
) -> None:
    """Servo and motor had half of it each, 1.5 J and 1.8 J for 4 J and -.7 J, and one without a kink had nothing."""
    ground = vv.Ground()
    turning: Any = {"velocity": (0, elbow[0], 0), "angular_velocity": (0, 0, elbow[0])}
    upper = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    lower = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(3, 0, 0), **turning)
    shoulder = vv.Revolute(a=ground, b=upper, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    joint = vv.Revolute(a=upper, b=lower, at=(2, 0, 0), axis=(0, 0, 1), angle=True)
    bend = at * elbow[0]
    motor = vv.Motor(joint=joint, motion=[[0, 0], [at, bend], [at + 1, bend + elbow[1]]])
    servo = vv.Servo(output=[shoulder], follows=[[[0, 0], [at, 0], [at + 1, 1]]], actuators=[shoulder])
    system = vv.System([ground, upper, lower, shoulder, joint, motor, servo])
    ledger = vv.simulate(system, until=0.2, step=0.005, scheme=scheme).ledger
    found = [ledger.last("work_servo"), ledger.last("work_drive")]
    size = max(map(abs, wanted := folding(at, elbow, 0.2)))
    assert found == pytest.approx(wanted, abs=size * (5e-3 if scheme.order == 1 else far))


@pytest.mark.parametrize("at", [0.1, 0.1025, 0.105])
@pytest.mark.parametrize("scheme", [*LED, vv.GeneralizedAlpha(rho=0.0), vv.BackwardEuler()], ids=str)
def test_free_nodes_feel_what_led_ones_are_struck_by(scheme: Any, at: float) -> None:
    """A bar of two elements without stiffness, led aside at one end by 1 m/s from the kink on: its consistent mass
    gives (4 1; 1 2) v = -(1, 0) for the others."""
    mesh = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(2, 1, 1))
    bar = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e-6, poisson=0.3), density=1000)
    lead = vv.Prescribed(solid=bar, nodes="x0", motion=(0, 0, [[0, 0], [at, 0], [at + 1, 1]]))
    system = vv.System([bar, lead])
    result = vv.simulate(system, until=0.25, step=0.01, scheme=scheme)
    aside = bar.velocities(system.x, system.v)[:, 2]
    for x, v in ((0.5, -2 / 7), (1.0, 1 / 7)):
        np.testing.assert_allclose(aside[np.isclose(bar.grid.points[:, 0], x)], v, atol=1e-5)
    assert result.ledger.last("work_prescribed motion") == pytest.approx(5 / 7, abs=1e-5)


@pytest.mark.parametrize("at", [0.1, 0.1001])
@pytest.mark.parametrize("scheme", [*LED, vv.GeneralizedAlpha(rho=0.0), vv.BackwardEuler()], ids=str)
def test_drives_do_no_work_on_spin_that_they_do_not_turn(scheme: Any, at: float) -> None:
    """(M + m) v^2 / 2 of a carriage and the gyro on it, led to and fro: rates of directors that a step leaves off
    their constraints are no work of the drive, nor is what a scheme dissipates of the spin."""
    ground, carriage = vv.Ground(), vv.RigidBody(mass=10.0, inertia=(1, 1, 1))
    rail = vv.Prismatic(a=ground, b=carriage, at=(0, 0, 0), axis=(1, 0, 0))
    saw = [[0, 0], *([at + 0.1 * k, 0.1 * (k % 2)] for k in range(9))]
    rotor = vv.RigidBody(mass=1, inertia=(1, 2, 3), angular_velocity=(20, 20.0, 1))
    parts = [carriage, rail, vv.Motor(joint=rail, motion=saw), rotor]
    system = vv.System([ground, *parts, vv.Spherical(a=carriage, b=rotor, at=(0, 0, 0))])
    ledger = vv.simulate(system, until=0.85, step=0.01, scheme=scheme).ledger
    assert ledger.last("work_drive") == pytest.approx(5.5, abs=1e-9)


@pytest.mark.parametrize("scheme", ENDS, ids=str)
def test_drives_are_not_booked_what_a_scheme_dissipates_elsewhere(scheme: Any) -> None:
    """J w^2 / 2 beside an oscillator of 320 J with a period of 20 steps, by next to no spring in one group with it."""
    parts = deepcopy(led([[0, 0], [0.1001, 0], [0.5001, 0.4]])[0].components)
    ground, body, ball = parts[0], parts[1], vv.PointMass(mass=1.0, position=(0.8, 5, 0))
    swing = vv.Spring(a=ground.point((-1, 5, 0)), b=ball.point(), stiffness=1e3, free_length=1.0)
    tie = vv.Spring(a=body.point(), b=ball.point(), stiffness=1e-9, free_length=1.0)
    system = vv.System([*parts, ball, swing, tie])
    ledger = vv.simulate(system, until=0.3, step=0.01, scheme=scheme).ledger
    assert ledger.last("work_drive") == pytest.approx(1.5, abs=2e-2 if scheme.order == 1 else 1e-3)


@pytest.mark.parametrize("at", [0.1, 0.1037])
def test_rates_hold_behind_a_kink_where_they_do_at_every_step(at: float) -> None:
    """`GeneralizedAlpha` beside a servo projects them: also in a step that ends behind a kink."""
    system, _ = led([[0, 0], [at, 0], [at + 0.4, 0.4]], "servo")
    ground, rotor = (
        system.components[0],
        vv.RigidBody(mass=1, inertia=(1, 2, 3), angular_velocity=(20, 20.0, 1)),
    )
    parts = deepcopy([*system.components, rotor, vv.Spherical(a=ground, b=rotor, at=(0, 0, 0))])
    system = vv.System(parts)
    vv.simulate(system, until=0.11 if at > 0.1 else 0.1, step=0.01, scheme=vv.GeneralizedAlpha(rho=0.5))
    equations = Instant(system)
    assert np.abs(equations.G @ system.v[equations.coordinates] + equations.drift()).max() < 1e-9


@pytest.mark.parametrize("kink", [0.0025, 0.1025])
@pytest.mark.parametrize("scheme", ENDS, ids=str)
def test_accelerations_are_not_taken_across_kinks_that_lie_ahead(scheme: Any, kink: float) -> None:
    """A brick without stiffness, led aside at one end from a kink in the first step on, or close behind another kink:
    5/4 J by its consistent mass, whose free end goes back by half as much."""
    path = [[0, 0], [kink, 0], [kink + 0.5, 0.5]]
    if kink > 0.1:
        path = [[0, 0], [0.1, 0], [kink, kink - 0.1], [0.12, kink - 0.1], [0.5, kink + 0.28]]
    mesh = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(1, 1, 1))
    brick = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e-4, poisson=0.3), density=1000)
    system = vv.System([brick, vv.Prescribed(solid=brick, nodes="x0", motion=(0, 0, path))])
    ledger = vv.simulate(system, until=0.15, step=0.01, scheme=scheme).ledger
    assert ledger.last("work_prescribed motion") == pytest.approx(
        1.25, abs=2e-2 if scheme.order == 1 else 1e-3
    )
