"""Servos whose actuators are not their outputs: forces of the instant and impulses push along the actuators."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.system.actuated import Actuated, leaves_rates

Array = NDArray[np.float64]
MIDPOINTS = [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint()]
UNTIL = 0.6
ANGLE, SPEED, PUSH = UNTIL**3, 3 * UNTIL**2, 6 * UNTIL
OUTWARD, ONWARD = np.array([np.cos(ANGLE), np.sin(ANGLE), 0]), np.array([-np.sin(ANGLE), np.cos(ANGLE), 0])


def arm(led_by: str) -> tuple[vv.System, vv.Revolute, vv.Servo]:
    """An arm that turns by t^3, led by what is said; of 2 kg at a radius of 1 m, and 3 kg m^2 about its axle."""
    ground, body = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1))
    height: Any = vv.Position(of=body, direction=(0, 1, 0))
    output, follows, actuator = {
        "its angle": (axle, "t**3", axle),
        "its height": (height, "sin(t**3)", axle),
        "a force at its end": (axle, "t**3", height),
    }[led_by]
    servo = vv.Servo(output=[output], follows=[follows], actuators=[actuator])
    return vv.System([ground, body, axle, servo]), axle, servo


@pytest.mark.parametrize("scheme", MIDPOINTS, ids=str)
@pytest.mark.parametrize("step", [0.05, 0.0125])
@pytest.mark.parametrize("led_by", ["its angle", "its height", "a force at its end"])
def test_axle_bears_what_accelerates_the_arm(led_by: str, step: float, scheme: Any) -> None:
    """(-4.7, -3.6) instead of (-2.3, 7.2) at every step, as inputs pushed along the outputs."""
    system, axle, servo = arm(led_by)
    vv.simulate(system, until=UNTIL, step=step, scheme=scheme)
    inertia = 2 * (-(SPEED**2) * OUTWARD + PUSH * ONWARD)
    is_torque = led_by != "a force at its end"
    given = 3 * PUSH if is_torque else 3 * PUSH / np.cos(ANGLE)
    borne = inertia if is_torque else inertia - [0, given, 0]
    assert vv.ReactionForce(joint=axle)(system) == pytest.approx(borne, rel=1e-9, abs=1e-9)
    assert system.present.x[system.field(servo, "input").start] == pytest.approx(given, rel=1e-9)


def test_input_of_the_instant_has_the_sign_of_a_motor() -> None:
    """That of a servo that leads what it turns was the opposite of the torque of a motor with the same motion."""
    system, _, servo = arm("its angle")
    ground, body = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    motor = vv.Motor(joint=axle, motion="t**3")
    other = vv.System([ground, body, axle, motor])
    for each in (system, other):
        vv.simulate(each, until=UNTIL, step=0.05)
    number = system.field(servo, "input").start
    assert system.present.x[number] == pytest.approx(motor.effort(other), rel=1e-9)


@pytest.mark.parametrize("led_by", ["its angle", "its height", "a force at its end"])
def test_variational_rule_books_the_work_of_inputs_to_the_second_order(led_by: str) -> None:
    """The part of the impulses by which rates are brought onto the path was missing: 2 % and half of that."""
    brought = 3 / 2 * SPEED**2
    errors = []
    for step in (0.05, 0.025):
        result = vv.simulate(arm(led_by)[0], until=UNTIL, step=step, scheme=vv.VariationalMidpoint())
        errors.append(result.ledger.last("work_servo") - brought)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert abs(errors[1]) < 1e-3 * brought


@pytest.mark.parametrize("led", ["the mass", "its distance"])
def test_support_bears_what_a_servo_pushes_off(led: str) -> None:
    """A mass that is pushed off from a held node along the line to it: m x'', with the sign of the push."""
    bar = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=1e3, poisson=0.3),
        density=1.0,
    )
    load = vv.PointMass(mass=2.0, position=(3, 0, 0))
    distance: Any = vv.SquaredDistance(a=bar.point((0, 0, 0)), b=load)
    output, follows = (
        (vv.Position(of=load, direction=(1, 0, 0)), "3 + t**3")
        if led == "the mass"
        else (distance, "(3 + t**3)**2")
    )
    servo = vv.Servo(output=[output], follows=[follows], actuators=[distance])
    system = vv.System([bar, load, servo, vv.Fixed(solid=bar, nodes="x0")])
    vv.simulate(system, until=UNTIL, step=0.05)
    assert vv.SupportForce(solid=bar, nodes="x0")(system)[0] == pytest.approx(2 * PUSH, rel=1e-9)


# --- a crane: its trolley of 10 kg leads the place of a load of 1 kg and 1 kg m^2 that swings 1 m below it -----

GRAVITY = 9.81


def crane(path: Any, mass: float = 10.0, inertia: float = 1.0) -> tuple[vv.System, vv.Revolute, Any]:
    ground = vv.Ground()
    trolley = vv.RigidBody(mass=mass, inertia=(1, 1, 1))
    load = vv.RigidBody(mass=1.0, inertia=(inertia,) * 3, position=(0, -1, 0))
    rail = vv.Prismatic(a=ground, b=trolley, at=(0, 0, 0), axis=(1, 0, 0))
    pin = vv.Revolute(a=trolley, b=load, at=(0, 0, 0), axis=(0, 0, 1))
    servo = vv.Servo(output=[vv.Position(of=load, direction=(1, 0, 0))], follows=[path], actuators=[rail])
    down = vv.Gravity(acceleration=(0, -GRAVITY, 0))
    system = vv.System([ground, trolley, load, rail, pin, down, servo])

    def swing() -> float:
        x, y, _ = np.asarray(vv.Position(of=load)(system)) - np.asarray(vv.Position(of=trolley)(system))
        return float(np.arctan2(x, -y))

    return system, pin, swing


def swung(t: float) -> tuple[float, Array]:
    """Angle of the load, and the force (2,) of the pin on it, where it goes by 0.2 t^3."""

    def acceleration(t: float, q: float, w: float) -> float:
        s, c = np.sin(q), np.cos(q)
        return float((-s * (GRAVITY + w * w * c) - c * 1.2 * t) / (1 + s * s))

    found = solve_ivp(lambda t, y: [y[1], acceleration(t, *y)], (0, t), [0, 0], rtol=1e-11, atol=1e-12)
    q, w = found.y[:, -1]
    lift = acceleration(t, q, w) * np.sin(q) + w * w * np.cos(q)
    return float(q), np.array([1.2 * t, GRAVITY + lift])


@pytest.mark.parametrize("scheme", MIDPOINTS, ids=str)
def test_crane_swings_and_its_pin_bears_by_the_second_order(scheme: Any) -> None:
    """The pin's force had the wrong sign; of the variational rule's load the swing was a tenth of a radian off."""
    angle, force = swung(1.0)
    errors = []
    for step in (0.05, 0.025):
        system, pin, swing = crane("0.2*t**3")
        vv.simulate(system, until=1.0, step=step, scheme=scheme)
        along, up = vv.ReactionForce(joint=pin)(system)[:2] - force
        assert along == pytest.approx(0, abs=1e-9)
        errors.append([swing() - angle, up])
    coarse, fine = np.abs(errors)
    assert np.log2(coarse / fine) == pytest.approx(2, abs=0.05)
    assert fine.max() < 3e-4


@pytest.mark.parametrize("scheme", MIDPOINTS, ids=str)
def test_kink_of_a_path_is_an_impulse_along_the_actuator(scheme: Any) -> None:
    """The load is to go by v at once: J w = -m l v about its centre; by the least change it turned the other way."""
    system, _, swing = crane([[0, 0], [0.1, 0], [0.2, 0.01]])
    vv.simulate(system, until=0.11, step=0.01, scheme=scheme)
    assert swing() / 0.01 == pytest.approx(-0.1, rel=2e-3)


def rope_crane(path: str) -> tuple[vv.System, vv.Prismatic, vv.Distance]:
    """A load of 2 kg on a rope of 1 m below a trolley that does not accelerate it along while it hangs plumb."""
    ground, load = vv.Ground(), vv.PointMass(mass=2.0, position=(0, -1, 0))
    trolley = vv.RigidBody(mass=10.0, inertia=(1, 1, 1))
    rail = vv.Prismatic(a=ground, b=trolley, at=(0, 0, 0), axis=(1, 0, 0))
    rope = vv.Distance(a=trolley.point(), b=load.point())
    servo = vv.Servo(output=[vv.Position(of=load, direction=(1, 0, 0))], follows=[path], actuators=[rail])
    down = vv.Gravity(acceleration=(0, -GRAVITY, 0))
    return vv.System([ground, trolley, load, rail, rope, down, servo]), rail, rope


def test_inputs_that_accelerate_no_output_are_the_least() -> None:
    """What hangs still is held by its weight alone."""
    system, rail, rope = rope_crane("t**5")
    at = Actuated(system)
    at.factor()
    assert at.is_open
    assert vv.reaction(system, rope)[0] == pytest.approx([0, 2 * GRAVITY, 0], abs=1e-9)
    assert vv.ReactionForce(joint=rail)(system)[1] == pytest.approx(12 * GRAVITY)


def test_rates_that_inputs_do_not_reach_are_not_projected() -> None:
    """They answered to errors of a step by as much more as the rope is near to the plumb: work 3e3 for 11 J."""
    system, _, _ = rope_crane("0.15*t**6")
    result = vv.simulate(system, until=0.6, step=0.02, scheme=vv.GeneralizedAlpha(rho=0.5))
    lacking = abs(result.ledger.last("imbalance"))
    assert lacking < 1e-2 * abs(result.ledger.last("work_servo"))
    assert "their rates: not meant" in result.audit()


@pytest.mark.parametrize(
    "scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha(rho=0.0), vv.GeneralizedAlpha()], ids=str
)
def test_drives_follow_kinks_beside_a_crane_that_its_input_does_not_accelerate(scheme: Any) -> None:
    """They were left to the scheme for all as soon as there was one: twice the work, an effort of 128 for none."""
    alone, beside = [], []
    for found in (alone, beside):
        ground, *parts, down, servo = rope_crane("0*t")[0].components
        body = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 5, 0))
        axle = vv.Revolute(a=ground, b=body, at=(0, 5, 0), axis=(0, 0, 1), angle=True)
        motor = vv.Motor(joint=axle, motion=[[0, 0], [0.1, 0], [0.5, 0.4]])
        held = vv.Force(on=body, force=(0, 2 * GRAVITY, 0))
        others = [*parts, down, servo] if found is beside else [down]
        system = vv.System([ground, body, axle, motor, held, *others])
        result = vv.simulate(system, until=0.3, step=0.01, scheme=scheme)
        found += [
            result.ledger.last("work_drive"),
            motor.effort(system),
            *vv.ReactionForce(joint=axle)(system),
        ]
    assert beside == pytest.approx(alone, rel=1e-6, abs=1e-8)
    if scheme.order == 2:
        assert alone[:2] == pytest.approx([1.5, 0], abs=1e-3)


# --- generalised alpha ----------------------------------------------------------------------------------------


def test_wheel_keeps_its_rotation_beside_a_servo_elsewhere() -> None:
    """All rates were left to the scheme as soon as there was a servo: 5 rad/s had become none after 8 s."""
    ground = vv.Ground()
    turning: Any = {"position": (1, 0, 0), "velocity": (0, 5, 0), "angular_velocity": (0, 0, 5)}
    wheel = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), **turning)
    axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    slide = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(0, 5, 0))
    rail = vv.Prismatic(a=ground, b=slide, at=(0, 5, 0), axis=(1, 0, 0))
    servo = vv.Servo(output=[rail], follows=["0*t"], actuators=[rail])
    system = vv.System([ground, wheel, axle, slide, rail, servo])
    vv.simulate(system, until=8.0, step=0.04, scheme=vv.GeneralizedAlpha())
    assert vv.AngularVelocity(of=wheel)(system)[2] == pytest.approx(5.0, rel=1e-3)


@pytest.mark.parametrize("led_by", ["its angle", "its height", "a force at its end"])
@pytest.mark.parametrize("rho", [0.0, 0.9])
def test_projected_arm_goes_and_bears_by_the_second_order(led_by: str, rho: float) -> None:
    inertia = 2 * (-(SPEED**2) * OUTWARD + PUSH * ONWARD)
    is_torque = led_by != "a force at its end"
    given = 3 * PUSH if is_torque else 3 * PUSH / np.cos(ANGLE)
    exact = [*(inertia if is_torque else inertia - [0, given, 0])[:2], given, 3 / 2 * SPEED**2]
    errors = []
    for step in (0.025, 0.0125):
        system, axle, servo = arm(led_by)
        result = vv.simulate(system, until=UNTIL, step=step, scheme=vv.GeneralizedAlpha(rho=rho))
        assert result.ledger.size("defect_velocity") < 1e-10
        found = [*vv.ReactionForce(joint=axle)(system)[:2], servo.inputs(system)[0]]
        errors.append(np.abs(np.subtract([*found, result.ledger.last("work_servo")], exact)))
    coarse, fine = errors
    assert np.all(fine[:3] < 0.3 * coarse[:3])
    assert fine[:3].max() < 2e-2
    assert fine[3] < 3e-4  # of work, which is 1.7


@pytest.mark.parametrize("kind", ["motor", "servo"])
@pytest.mark.parametrize(
    ("scheme", "far"),
    [
        (vv.GeneralizedAlpha(), 1e-4),
        (vv.GeneralizedAlpha(rho=0.0), 1e-4),
        (vv.BDF2(), 1e-3),
        (vv.BackwardEuler(), 2e-2),
    ],
    ids=str,
)
def test_schemes_with_a_history_begin_a_new_one_behind_a_kink(kind: str, scheme: Any, far: float) -> None:
    """A reaction of -6e3 N went to and fro for 0.4 N twenty steps behind it, and work was twice the energy."""
    ground, body = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    path = [[0, 0], [0.1, 0], [0.5, 0.4]]
    motor = vv.Motor(joint=axle, motion=path)
    servo = vv.Servo(output=[axle], follows=[path], actuators=[axle])
    system = vv.System([ground, body, axle, motor if kind == "motor" else servo])
    result = vv.simulate(system, until=0.3, step=0.01, scheme=scheme)
    work = sum(result.ledger.last(f"work_{name}") for name in result.ledger.works)
    assert [vv.AngularVelocity(of=body)(system)[2], work / 1.5] == pytest.approx([1, 1], abs=far)
    borne = vv.ReactionForce(joint=axle)(system)[:2]
    assert borne == pytest.approx([-2 * np.cos(0.2), -2 * np.sin(0.2)], abs=2 * far)


def hand(metre: float, tonne: float) -> tuple[vv.System, vv.RigidBody]:
    """A hand that both joints of an arm hold in its place, and a wheel that turns by 10 rad/s on its fore arm."""
    along = np.array([np.cos(1.0), np.sin(1.0), 0])
    turned = np.column_stack([along, [-along[1], along[0], 0], [0, 0, 1]])
    x, J = np.array([metre, 0, 0]), 1e3 * tonne * metre**2
    ground, wheel_at = vv.Ground(), x + 0.8 * metre * along
    upper = vv.RigidBody(mass=2e3 * tonne, inertia=(0.1 * J, 0.2 * J, 0.2 * J), position=0.5 * x)
    fore: Any = {"position": x + 0.4 * metre * along, "rotation": turned}
    lower = vv.RigidBody(mass=1.5e3 * tonne, inertia=(0.1 * J, 0.2 * J, 0.1 * J), **fore)
    spin: Any = {"position": wheel_at, "angular_velocity": (0, 0, 10)}
    wheel = vv.RigidBody(mass=2e2 * tonne, inertia=(0.02 * J,) * 3, **spin)
    shoulder = vv.Revolute(a=ground, b=upper, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    elbow = vv.Revolute(a=upper, b=lower, at=x, axis=(0, 0, 1), angle=True)
    axle = vv.Revolute(a=lower, b=wheel, at=wheel_at, axis=(0, 0, 1))
    end = lower.point((0.4 * metre, 0, 0))
    led: Any = [vv.Position(of=end, direction=d) for d in ((1, 0, 0), (0, 1, 0))]
    follows = [repr(float(value)) for value in wheel_at[:2]]
    servo = vv.Servo(output=led, follows=follows, actuators=[shoulder, elbow])
    return vv.System([ground, upper, lower, wheel, shoulder, elbow, axle, servo]), wheel


def test_what_is_projected_does_not_hang_on_units() -> None:
    """In mm rates were left to the scheme, and the wheel stopped; in m they were not."""
    turns = []
    for metre, tonne in ((1.0, 1e-3), (1e3, 1e-6)):
        system, wheel = hand(metre, tonne)
        vv.simulate(system, until=1.0, step=0.02, scheme=vv.GeneralizedAlpha())
        assert not leaves_rates(system)
        turns.append(float(vv.AngularVelocity(of=wheel)(system)[2]))
    assert turns[0] == pytest.approx(10, rel=1e-3)
    assert turns[1] == pytest.approx(turns[0], rel=1e-9)


@pytest.mark.parametrize("mass", [1.0, 10.0, 1000.0])
def test_rates_of_a_crane_are_left_by_how_much_its_input_accelerates_its_output(mass: float) -> None:
    """By half of the trolley: from 10 kg on that was left out; by a hundredth of it is left at any mass."""
    assert not leaves_rates(crane("0*t", mass)[0])
    assert leaves_rates(crane("0*t", mass, inertia=0.01)[0])
