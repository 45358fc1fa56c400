"""Forces, torques, springs, dampers and bushings against closed forms and exact balances."""

import json
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

import visviva as vv
from visviva.base.timefunction import OfTime

SCHEMES = [vv.EnergyMomentum(), vv.Midpoint()]


def body(name="body", **more):
    return vv.RigidBody(mass=2.0, inertia=(1.0, 1.5, 2.0), name=name, **more)


EXACT = vv.Newton(tolerance=1e-15)
"""What is tested here is the discretisation, not where the iteration stops."""


def run(components, until=1.0, step=0.02, scheme=None):
    system = vv.System(components, EXACT)
    return vv.simulate(system, until=until, step=step, scheme=scheme)


def tumbling(name, position, spin):
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    return body(name, position=position, rotation=turn, velocity=(0.3, -0.1, 0.2), angular_velocity=spin)


def momentum(result, kind):
    return np.array([result.ledger[f"{kind}_{c}"] for c in "xyz"])


def tangent_error(system, scheme=None, h=0.01):
    """Largest difference between tangent and central differences of the residual, relative to its rows."""
    step = (scheme or vv.EnergyMomentum()).step(system.time, h)
    rng = np.random.default_rng(1)
    system.core.dx[: len(system.x)] = 0.03 * rng.normal(size=len(system.x))
    dx = system.core.dx.copy()
    _, K = system.tangent(step)
    unknown = system.core.csr[2]
    worst, scale = 0.0, abs(K).max()
    for column, u in enumerate(unknown):
        ends = []
        for sign in (1, -1):
            system.core.dx[:] = dx
            system.core.dx[u] += sign * 1e-5
            ends.append(system.tangent(step)[0][unknown])
        difference = (ends[0] - ends[1]) / 2e-5
        worst = max(worst, float(np.abs(difference - K[:, [column]].toarray()[:, 0]).max()))
    system.core.discard()
    return worst / scale


# --- functions of time --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "t", "value", "rate"),
    [
        (3, 1.7, 3.0, 0.0),
        ("2*sin(3*t)", 0.4, 2 * np.sin(1.2), 6 * np.cos(1.2)),
        ("-t**3 / (1 + t**2)", 2.0, -1.6, -(4 * 3 * 5 - 8 * 4) / 25),
        ("abs(t - 2) + max(t, 1) * min(t, 5)", 1.5, 0.5 + 2.25, -1 + 3.0),
        ("exp(-t) * pi", 1.0, np.pi / np.e, -np.pi / np.e),
        ("smoothstep((t - 1) / 2)", 2.0, 0.5, 1.875 / 2),
        ("sqrt(t) + step(t - 1)", 4.0, 3.0, 0.25),
        ([[0, 1], [2, 5], [3, 4]], 1.0, 3.0, 2.0),
        ([[0, 1], [2, 5], [3, 4]], 9.0, 4.0, 0.0),
        ([[0, 1], [2, 5], [3, 4]], 2.0, 5.0, 2.0),
        (lambda t: np.sin(t), 1.0, np.sin(1.0), np.cos(1.0)),
    ],
)
def test_time_function_has_value_and_rate(source, t, value, rate):
    f = vv.TimeFunction(source)
    assert f(t) == pytest.approx(value, rel=1e-14)
    assert f.rate(t) == pytest.approx(rate, rel=1e-11 if callable(source) else 1e-14, abs=1e-15)


@pytest.mark.parametrize("source", [2.5, "2*sin(3*t)", [[0.0, 1.0], [2.0, 5.0]]])
def test_time_function_survives_a_round_trip(source):
    adapter = TypeAdapter(OfTime)
    there = json.loads(adapter.dump_json(adapter.validate_python(source)))
    assert there == source
    assert adapter.validate_python(there) == vv.TimeFunction(source)


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("__import__('os').remove('x')", "not understood"),
        ("t.real", "not understood"),
        ("x + 1", "'x'"),
        ("sin(t, 2)", "one argument"),
        ("2 *", "not an expression"),
        ("lambda: 3", "not understood"),
        (float("nan"), "constant nan"),
        ([[0, 1], [0, 2]], "increase"),
        ([[0, 1, 2]], "rows"),
        ([], "finite numbers"),
        (object(), "not <object"),
    ],
)
def test_time_function_refuses(source, word):
    with pytest.raises(vv.InputError, match=word):
        vv.TimeFunction(source)


def test_time_function_that_cannot_be_evaluated_says_when():
    with pytest.raises(vv.InputError, match="not real at t = -1"):
        vv.TimeFunction("sqrt(t)")(-1)
    with pytest.raises(vv.InputError, match="t = 0"):
        vv.TimeFunction("1/t")(0)


# --- forces -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_dead_force_gives_its_impulse_and_moment(scheme):
    brick = tumbling("brick", (1, 2, 3), (0.5, 1.0, -0.7))
    force = np.array([1.0, -2.0, 0.5])
    result = run([brick, vv.Force(on=brick, at=(1.5, 2, 3), force=force, times="1 + t")], scheme=scheme)
    p = momentum(result, "momentum")
    # the midpoint value of a linear function is its mean: the impulse is exact
    assert np.abs(p[:, -1] - p[:, 0] - 1.5 * force).max() < 1e-12
    assert result.conservation()["energy"] < 1e-12
    point = brick.point_at((1.5, 2, 3)).position
    x = result.history(point)
    arms, t = 0.5 * (x[1:] + x[:-1]), 0.5 * (np.array(result.times)[1:] + np.array(result.times)[:-1])
    moment = 0.02 * ((1 + t)[:, None] * np.cross(arms, force)).sum(axis=0)
    L = momentum(result, "angular")
    assert np.abs(L[:, -1] - L[:, 0] - moment).max() < 1e-12 * np.abs(L).max()


def test_force_of_time_position_and_velocity_is_a_damped_oscillator():
    m, k, c = 2.0, 50.0, 1.5
    errors = []
    for h in (0.02, 0.01, 0.005):
        ball = vv.PointMass(mass=m, position=(1, 0, 0))
        law = vv.Force(on=ball, force=lambda t, x, v: -k * x - c * v)
        result = run([ball, law], until=2.0, step=h)
        decay, omega = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
        exact = np.exp(-2 * decay) * (np.cos(2 * omega) + decay / omega * np.sin(2 * omega))
        errors.append(abs(result.states[-1][0] - exact))
        assert result.conservation()["energy"] < 1e-12
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 2) < 0.05), errors


def test_follower_force_is_a_rocket_on_a_circle():
    # Thrust along d1 of a body spinning about e3 at constant rate: v = F/(m w) (sin wt, 1 - cos wt)
    w, thrust = 3.0, 4.0
    errors = []
    for h in (0.02, 0.01):
        rocket = body(angular_velocity=(0, 0, w))
        result = run([rocket, vv.FollowerForce(on=rocket, force=(thrust, 0, 0))], step=h)
        v = result.rates[-1][:3]
        errors.append(np.linalg.norm(v - thrust / (2.0 * w) * np.array([np.sin(w), 1 - np.cos(w), 0])))
        assert result.conservation()["energy"] < 1e-12
        assert (
            np.ptp(result.ledger["angular_z"] - 0) < 0.5 * thrust
        )  # lever of the centre about the origin only
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)


# --- torques ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
@pytest.mark.parametrize("step", [0.01, 0.1])
def test_torque_gives_exactly_its_angular_impulse(scheme, step):
    brick = tumbling("brick", (0, 0, 0), (2.0, -1.0, 3.0))
    m = np.array([0.7, -1.2, 2.0])
    result = run([brick, vv.Torque(on=brick, torque=m, times="2*t")], step=step, scheme=scheme)
    L, p = momentum(result, "angular"), momentum(result, "momentum")
    change = np.cross(np.array(result.states)[:, :3], p.T).T  # about the origin; the centre moves uniformly
    assert np.abs(L[:, -1] - L[:, 0] - 1.0 * m).max() < 2e-12
    assert np.abs(p[:, -1] - p[:, 0]).max() < 1e-12
    assert np.ptp(change, axis=1).max() < 1e-11
    assert result.conservation()["energy"] < 1e-12


def test_torque_on_a_symmetric_body_does_the_work_of_its_spin():
    top = vv.RigidBody(mass=1.0, inertia=(1.0, 1.0, 2.0))
    result = run([top, vv.Torque(on=top, torque=(0, 0, 4.0))], step=0.05)
    ledger = result.ledger
    assert ledger["angular_z"][-1] == pytest.approx(4.0, abs=1e-13)
    assert ledger["work_torque"][-1] == pytest.approx(ledger["kinetic"][-1], rel=1e-12)
    assert ledger["kinetic"][-1] == pytest.approx(0.5 * 2.0 * 2.0**2, rel=1e-5)  # second order in h


def test_follower_torque_spins_a_body_about_its_own_axis():
    # About a principal axis that does not move a follower torque is a dead torque.
    axis = np.array([1.0, 2.0, 2.0]) / 3
    turn = np.column_stack([np.cross([0, 0, 1], axis), [0, 0, 0], axis])
    turn[:, 0] /= np.linalg.norm(turn[:, 0])
    turn[:, 1] = np.cross(axis, turn[:, 0])
    top = vv.RigidBody(mass=1.0, inertia=(1.0, 1.3, 0.5), rotation=turn)
    result = run([top, vv.FollowerTorque(on=top, torque=(0, 0, 3.0), times=[[0, 0], [1, 2]])], step=0.01)
    L = momentum(result, "angular")[:, -1]
    assert np.abs(L - 3.0 * axis).max() < 1e-12
    assert result.conservation()["energy"] < 1e-12


@pytest.mark.parametrize("carried", [False, True])
def test_torque_pair_conserves_angular_momentum(carried):
    a, b = tumbling("a", (1, 0, 0), (1, 2, 3)), tumbling("b", (-1, 0.5, 0), (-2, 0, 1))
    more = {"carrier": a} if carried else {}
    pair = vv.TorquePair(a=a, b=b, torque=(3.0, -2.0, 1.0), times="cos(5*t)", **more)
    result = run([a, b, pair])
    drift = result.conservation()
    assert max(drift[f"angular_{c}"] for c in "xyz") < 1e-12
    assert max(drift[f"momentum_{c}"] for c in "xyz") < 1e-12
    assert drift["energy"] < 1e-12
    assert np.abs(result.ledger["work_torque"]).max() > 0.1


# --- springs and dampers ------------------------------------------------------------------------------------

# Reference and errors of the table: explicit solution of order 8 to 1e-13, schemes by an independent program.
END = np.array([0.09991917576658, 1.07765681031737, 0.0])
END_VELOCITY = np.array([-1.98372231715598, 0.62278471235252, 0.0])
TABLE = {
    "energy-momentum": (vv.EnergyMomentum(), [1.6684e-2, 3.8414e-3, 9.3641e-4, 2.3256e-4]),
    "midpoint": (vv.Midpoint(), [1.6276e-2, 3.7404e-3, 9.1217e-4, 2.2657e-4]),
}
STEPS = [0.02, 0.01, 0.005, 0.0025]


def spring_pendulum(h, scheme, **law):
    ground = vv.Ground()
    ball = vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0, 2, 0))
    return run([ground, ball, vv.Spring(a=ground, b=ball, **law)], until=10.0, step=h, scheme=scheme)


@pytest.mark.parametrize("name", TABLE)
def test_spring_pendulum_digit_by_digit(name):
    scheme, errors = TABLE[name]
    for h, error in zip(STEPS, errors, strict=True):
        result = spring_pendulum(h, scheme, stiffness=100.0, free_length=1.0)
        assert np.linalg.norm(result.states[-1] - END) == pytest.approx(error, rel=5e-5)
        energy, spin = result.ledger["total"], result.ledger["angular_z"]
        assert energy[0] == pytest.approx(2.5, rel=1e-14)
        assert np.abs(spin - 2.2).max() < 1e-10
        if name == "energy-momentum":
            assert np.abs(energy - 2.5).max() < 1e-10
        elif h in (0.02, 0.0025):
            drift = {0.02: 2.35e-3, 0.0025: 3.68e-5}[h]
            assert np.abs(energy - 2.5).max() == pytest.approx(drift, rel=3e-3)


def test_spring_by_energy_is_the_spring_by_stiffness():
    linear = spring_pendulum(0.02, vv.EnergyMomentum(), stiffness=100.0, free_length=1.0)
    by_energy = spring_pendulum(0.02, vv.EnergyMomentum(), energy=lambda l: 50 * (l - 1) ** 2)
    assert np.abs(linear.states[-1] - by_energy.states[-1]).max() < 1e-9
    assert by_energy.conservation()["energy"] < 1e-10


@pytest.mark.parametrize("law", ["damping", "force"])
def test_damped_oscillator_against_its_closed_form(law):
    m, k, c, free = 1.5, 40.0, 0.8, 2.0
    given = {"damping": c} if law == "damping" else {"force": lambda l, rate: c * rate}
    errors = []
    for h in (0.02, 0.01, 0.005):
        ground, ball = vv.Ground(), vv.PointMass(mass=m, position=(free + 0.3, 0, 0))
        spring = vv.Spring(a=ground, b=ball, stiffness=k, free_length=free, **given)
        result = run([ground, ball, spring], until=2.0, step=h)
        decay, omega = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
        exact = free + 0.3 * np.exp(-2 * decay) * (np.cos(2 * omega) + decay / omega * np.sin(2 * omega))
        errors.append(abs(result.states[-1][0] - exact))
        ledger, kind = result.ledger, {"damping": "work_damper", "force": "work_spring force"}[law]
        lost = ledger["total"] - ledger["total"][0]
        assert np.abs(lost - ledger[kind]).max() < 1e-12  # dissipation is the loss of energy
        assert np.all(np.diff(ledger["total"]) <= 1e-14)
    assert np.all(np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2) < 0.05), errors


def test_damper_between_free_bodies_conserves_momentum_and_loses_energy():
    a, b = tumbling("a", (1, 0, 0), (1, 2, 3)), tumbling("b", (-1, 0.5, 0), (-2, 0, 1))
    damper = vv.Damper(
        a=a, b=b, at_a=(0.5, 0, 0), at_b=(-0.5, 0.5, 0.1), force=lambda l, rate: rate * abs(rate)
    )
    result = run([a, b, damper])
    drift = result.conservation()
    assert max(v for k, v in drift.items() if "momentum" in k or "angular" in k) < 1e-12
    assert drift["energy"] < 1e-12
    assert result.ledger["total"][-1] < result.ledger["total"][0] - 0.1


# --- bushings -----------------------------------------------------------------------------------------------


def bushing(a, b, **more):
    return vv.Bushing(
        a=a,
        b=b,
        at=(0.3, 0.2, 0.1),
        axis=(1, 1, 0),
        stiffness=(100, 200, 300),
        rotational_stiffness=(20, 30, 40),
        **more,
    )


def test_bushing_conserves_everything_at_large_deformations():
    a, b = tumbling("a", (0.5, 0, 0), (1, 2, 1)), tumbling("b", (-0.5, 0.5, 0), (-1, 0, 1))
    result = run([a, b, bushing(a, b)], until=2.0, step=0.02)
    assert max(result.conservation()[k] for k in result.conservation() if k != "constraint rates") < 1e-11
    assert np.ptp(result.ledger["potential_bushing"]) > 1.0


def test_bushing_damping_is_the_loss_of_energy():
    a, b = tumbling("a", (0.5, 0, 0), (1, 2, 1)), tumbling("b", (-0.5, 0.5, 0), (-1, 0, 1))
    result = run([a, b, bushing(a, b, damping=(2, 2, 2), rotational_damping=(1, 1, 1))], until=2.0)
    drift = result.conservation()
    assert max(v for k, v in drift.items() if "momentum" in k or "angular" in k or k == "energy") < 1e-11
    assert np.all(np.diff(result.ledger["work_damper"]) < 0)


@pytest.mark.parametrize("axis", range(3))
def test_bushing_has_its_stiffness_in_each_direction(axis):
    # Static deflection under a force and under a torque: F = k u, M = k sin(angle).
    ground, block = vv.Ground(), body()
    k, kr = np.array([100.0, 200, 300]), np.array([20.0, 30, 40])
    rubber = vv.Bushing(a=ground, b=block, at=(0, 0, 0), stiffness=k, rotational_stiffness=kr)
    push, turn = np.eye(3)[axis] * 5.0, np.eye(3)[axis] * 4.0
    loads = [vv.Force(on=block, force=push), vv.Torque(on=block, torque=turn)]
    system = vv.System([ground, block, rubber, *loads])
    system.step(1.0, vv.Static())
    assert system.x[:3] == pytest.approx(push / k, abs=1e-12)
    d = system.x[3:12].reshape(3, 3)
    j, l = (axis + 1) % 3, (axis + 2) % 3
    # the torque on a rotated body is not the derivative of one strain: M = k sin(angle) cos(angle)
    angle = np.arctan2(d[j, l], d[j, j])
    assert kr[axis] * np.sin(angle) * np.cos(angle) == pytest.approx(4.0, rel=1e-10)


def test_torsion_spring_and_damper_on_a_joint_are_an_oscillator():
    J, k, c = 2.0, 30.0, 0.9
    errors = []
    for h in (0.02, 0.01):
        ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1.5, 1.5, J))
        axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0))
        laws = [vv.JointSpring(joint=axle, stiffness=k, free=0.5), vv.JointDamper(joint=axle, damping=c)]
        result = run([ground, wheel, axle, *laws], until=1.0, step=h)
        decay, omega = c / (2 * J), np.sqrt(k / J - (c / (2 * J)) ** 2)
        exact = 0.5 - 0.5 * np.exp(-decay) * (np.cos(omega) + decay / omega * np.sin(omega))
        errors.append(abs(result.system.value(axle.coordinate()) - exact))
        assert result.conservation()["energy"] < 1e-12
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)


# --- tangents and refusals ----------------------------------------------------------------------------------


def pair_of_bodies():
    return tumbling("a", (1, 0, 0), (1, 2, 3)), tumbling("b", (-1, 0.5, 0), (-2, 0, 1))


LOADS = {
    "force function": lambda a, b: vv.Force(
        on=a, at=(1, 0.2, 0), force=lambda t, x, v: -x * x * 5e3 - v * 100
    ),
    "follower force": lambda a, b: vv.FollowerForce(on=a, at=(1, 0.2, 0), force=(2e4, 1e4, 3e4)),
    "torque": lambda a, b: vv.Torque(on=a, torque=(2e4, 3e4, -1e4)),
    "follower torque": lambda a, b: vv.FollowerTorque(on=a, torque=(2e4, 3e4, -1e4)),
    "pair": lambda a, b: vv.TorquePair(a=a, b=b, carrier=a, torque=(2e4, 3e4, -1e4)),
    "spring energy": lambda a, b: vv.Spring(a=a, b=b, energy=lambda l: 3e4 * (l - 1) ** 4),
    "spring force": lambda a, b: vv.Spring(a=a, b=b, force=lambda l, r: 1e4 * (l - 1) ** 3 + 10 * r * l),
    "damper": lambda a, b: vv.Damper(a=a, b=b, damping=300.0),
    "bushing": lambda a, b: bushing(a, b, damping=(20, 20, 20), rotational_damping=(10, 10, 10)),
}


@pytest.mark.parametrize("scheme", [*SCHEMES, vv.BackwardEuler()], ids=str)
@pytest.mark.parametrize("name", LOADS)
def test_tangent_is_the_derivative_of_the_residual(name, scheme):
    a, b = pair_of_bodies()
    assert tangent_error(vv.System([a, b, LOADS[name](a, b)]), scheme) < 1e-8


def test_loads_say_what_is_wrong():
    ground, ball, brick = vv.Ground(), vv.PointMass(mass=1.0), body()
    with pytest.raises(ValueError, match=r"Force: on: expected a component, .* not 3"):
        vv.Force(on=3, force=(1, 0, 0))
    with pytest.raises(ValueError, match="both a point of"):
        vv.Force(on=brick.point((1, 0, 0)), at=(1, 0, 0), force=(1, 0, 0))
    with pytest.raises(ValueError, match="list of 3 numbers"):
        vv.Force(on=ball, force=(1, 0))
    with pytest.raises(ValueError, match="not understood"):
        vv.Force(on=ball, force=(1, 0, 0), times="sinus(t)")
    with pytest.raises(ValueError, match="drop times"):
        vv.Force(on=ball, force=lambda t, x, v: x, times="t")
    with pytest.raises(ValueError, match="does not move"):
        vv.System([ground, ball, vv.Force(on=ground, force=(1, 0, 0))])
    with pytest.raises(ValueError, match="no directions"):
        vv.System([ball, vv.Torque(on=ball, torque=(1, 0, 0))])
    with pytest.raises(ValueError, match="negative"):
        vv.Spring(a=ground, b=ball, stiffness=-1.0)
    with pytest.raises(ValueError, match="energy replaces"):
        vv.Spring(a=ground, b=ball, stiffness=1.0, energy=lambda l: l)
    with pytest.raises(ValueError, match="does nothing"):
        vv.Spring(a=ground, b=ball)
    with pytest.raises(ValueError, match="coincide"):
        vv.System([ground, ball, vv.Spring(a=ground, b=ball, stiffness=1.0)])
    with pytest.raises(ValueError, match="negative entry"):
        vv.Bushing(a=ground, b=brick, at=(0, 0, 0), stiffness=(-1, 0, 0))
    with pytest.raises(ValueError, match="say where"):
        vv.Bushing(a=ground, b=brick)
    with pytest.raises(ValueError, match="itself"):
        vv.System([brick, vv.TorquePair(a=brick, b=brick, torque=(1, 0, 0))])


def test_springs_between_points_that_coincide() -> None:
    """Without a length of its own a spring pulls as one along each axis does: z'' = -10 z - t from rest."""

    def ball(**options: Any) -> vv.System:
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 0))
        spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=10.0, **options)
        return vv.System([ground, ball, spring, vv.Force(on=ball, force=(0, 0, -1), times="t")])

    still = vv.quasi_static(ball(free_length=0.0), until=1.0, step=0.5).states[-1]
    assert still[:3] == pytest.approx([0, 0, -0.1], abs=1e-14)
    moved = vv.simulate(ball(free_length=0.0), until=1.0, step=1e-3).states[-1]
    w = np.sqrt(10.0)
    assert moved[:3] == pytest.approx([0, 0, -(1.0 - np.sin(w) / w) / 10], abs=1e-6)
    for options in ({"free_length": 0.0, "damping": 1.0}, {"free_length": 0.1}, {}):
        with pytest.raises(
            vv.InputError, match="no direction; move them apart, take a Bushing, or free_length=0"
        ):
            ball(**options)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2(), vv.GeneralizedAlpha(), vv.Static()])
def test_loads_are_asked_for_times_of_steps_alone(scheme: vv.Scheme) -> None:
    """A history that was measured over the run need not be known outside of it."""
    asked: list[float] = []

    def measured(t: float) -> float:
        asked.append(t)
        if not 0 <= t <= 0.1:
            raise ValueError(f"not measured at {t}")
        return 3 * t

    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=10.0, poisson=0.3), density=1.0)
    pull = vv.Traction(solid=block, faces="x1", traction=(1, 0, 0), times=measured)
    run([block, vv.Fixed(solid=block, nodes="x0"), pull], until=0.1, step=0.02, scheme=scheme)
    assert min(asked) == 0.0
    assert max(asked) == pytest.approx(0.1, rel=1e-12)
