"""Reactions and efforts at the present instant: of second order with every scheme, exact where nothing accelerates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.scheme.schemes import Scheme
from visviva.system.memory import undisturbed
from visviva.system.present import by_the_equations, in_the_core

Array = NDArray[np.float64]
Reading = Callable[[vv.System], float]

SCHEMES = [
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BDF2(),
    vv.GeneralizedAlpha(rho=0.8),
]
END = 1.0
PRECISELY: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-12, "dense_output": True}


def motor() -> tuple[vv.System, Reading, Callable[[Array], Array]]:
    """A wheel that a motor turns, and behind a torsion spring another one: J q'' + c (q - p), J p'' = c (q - p)."""
    inertia, stiffness = 2.0, 50.0
    ground = vv.Ground()
    wheels = [vv.RigidBody(mass=1.0, inertia=(1.5, 1.5, inertia), angular_velocity=(0, 0, 4.0)) for _ in "ab"]
    axle, shaft = (
        vv.Revolute(a=a, b=b, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
        for a, b in zip([ground, wheels[0]], wheels, strict=True)
    )
    drive = vv.Motor(joint=axle, motion="2*t + sin(2*t)")
    spring = vv.JointSpring(joint=shaft, stiffness=stiffness, free=0.0)
    system = vv.System([ground, *wheels, axle, shaft, drive, spring])

    def angle(t: Array) -> Array:
        return np.asarray(2 * t + np.sin(2 * t))

    def torque(t: Array) -> Array:
        p = solve_ivp(
            lambda s, p: [p[1], stiffness / inertia * (angle(s) - p[0])], (0, 2), [0, 4], **PRECISELY
        ).sol(t)[0]
        return -inertia * 4 * np.sin(2 * t) + stiffness * (angle(t) - p)

    return system, drive.effort, torque


def pendulum() -> tuple[vv.System, Reading, Callable[[Array], Array]]:
    """The force in the rod of a pendulum that falls from the side."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    rod = vv.Distance(a=ground.point(), b=ball.point())
    system = vv.System([ground, ball, rod, vv.Gravity()])

    def force(t: Array) -> Array:
        q = solve_ivp(lambda _, q: [q[1], -9.81 * np.cos(q[0])], (0, 2), [0, 0], **PRECISELY).sol(t)
        return np.asarray(q[1] ** 2 - 9.81 * np.sin(q[0]))

    return system, lambda s: float(np.linalg.norm(vv.reaction(s, rod)[0])), force


def support() -> tuple[vv.System, Reading, Callable[[Array], Array]]:
    """A bar of one linear element, shaken at its end: masses m/3 and m/6, stiffness E A / l."""
    mass, stiffness = 3.0, 40.0
    bar = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.LinearElastic(young=stiffness, poisson=0.0),
        density=mass,
        velocity=lambda X: np.array([0.2 * 3, 0, 0]) + 0 * X,
    )
    rails = vv.Fixed(solid=bar, nodes="all", directions=(False, True, True))
    shaken = vv.Prescribed(solid=bar, nodes="x0", motion=("0.2*sin(3*t)", None, None))
    system = vv.System([bar, rails, shaken])

    def end(t: Array) -> Array:
        return np.asarray(0.2 * np.sin(3 * t))

    def accelerated(t: Array, u: Array) -> Array:
        return (stiffness * (end(t) - u) - mass / 6 * -9 * end(t)) / (mass / 3)

    def force(t: Array) -> Array:
        u = solve_ivp(lambda s, q: [q[1], accelerated(s, q[0])], (0, 2), [0, 0.6], **PRECISELY).sol(t)[0]
        return mass / 3 * -9 * end(t) + mass / 6 * accelerated(t, u) + stiffness * (end(t) - u)

    probe = vv.SupportForce(solid=bar, nodes="x0")
    return system, lambda s: float(probe(s)[0]), force


@pytest.mark.parametrize("case", [motor, pendulum, support])
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
def test_forces_are_of_second_order_at_the_end_of_the_step(case: Callable[[], Any], scheme: Scheme) -> None:
    errors = []
    for h in (0.02, 0.01):
        system, reading, exact = case()
        found: list[float] = []
        vv.simulate(
            system, until=END, step=h, scheme=scheme, observe=lambda s, f=found, r=reading: f.append(r(s))
        )
        times = END - h * np.arange(len(found))[::-1]
        late = times > END / 2  # what a start by one step of first order has left, has died out
        errors.append(np.abs(np.array(found) - exact(times))[late].max())
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5)


def wheel() -> tuple[vv.System, vv.Motor]:
    """A balanced wheel that a motor turns at a constant rate."""
    ground = vv.Ground()
    disc = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), angular_velocity=(0, 0, 10.0))
    axle = vv.Revolute(a=ground, b=disc, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    drive = vv.Motor(joint=axle, motion="10*t")
    return vv.System([ground, disc, axle, drive]), drive


@pytest.mark.parametrize("scheme", SCHEMES[:3], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("adaptive", [None, vv.Adaptive(tolerance=1e-4)])
def test_a_balanced_wheel_needs_no_torque(scheme: Scheme, adaptive: vv.Adaptive | None) -> None:
    """Whatever the rates at the nodes do, of long steps and of those that change."""
    system, drive = wheel()
    efforts: list[float] = []
    result = vv.simulate(
        system,
        until=0.3,
        step=0.02,
        scheme=scheme,
        adaptive=adaptive,
        observe=lambda s: efforts.append(drive.effort(s)),
    )
    assert np.abs(efforts).max() < 1e-8
    assert not scheme.conserves_energy or result.ledger.size("imbalance") < 1e-10


@pytest.mark.parametrize("scheme", SCHEMES[:3], ids=lambda s: type(s).__name__)
def test_who_asks_changes_nothing(scheme: Scheme) -> None:
    ends = []
    for asks in (True, False):
        system, reading, _ = motor()
        vv.simulate(system, until=0.2, step=0.02, scheme=scheme, observe=reading if asks else None)
        ends.append((system.x.copy(), system.v.copy()))
    np.testing.assert_array_equal(ends[0], ends[1])


def test_the_start_has_its_reactions() -> None:
    """Before the first step as well."""
    system, reading, exact = motor()
    assert reading(system) == pytest.approx(exact(np.zeros(1))[0], rel=1e-9)


def test_motions_by_fine_tables_have_the_effort_of_what_they_sample() -> None:
    """M = J q'', off the start, from second differences over a step."""
    times = np.linspace(0.0, 2.0, 4001)
    ground, disc = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 2.0))
    axle = vv.Revolute(a=ground, b=disc, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    drive = vv.Motor(joint=axle, motion=np.column_stack([times, 1 - np.cos(3 * times)]).tolist())
    system = vv.System([ground, disc, axle, drive])
    vv.simulate(system, until=1.0, step=0.01)
    assert drive.effort(system) == pytest.approx(2 * 9 * np.cos(3.0), rel=1e-3)


def test_the_core_finds_what_the_equations_give() -> None:
    """Of a heavy arm that turns in space with another one on it, off all centres."""
    ground = vv.Ground()
    arms = [
        vv.RigidBody(mass=m, inertia=(0.1, 0.2, 0.3), position=(x, 0.1, 0.2), angular_velocity=(0, 0, 3.0))
        for m, x in ((2.0, 1.0), (1.0, 3.0))
    ]
    axle = vv.Revolute(a=ground, b=arms[0], at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    ball = vv.Spherical(a=arms[0], b=arms[1], at=(2, 0, 0))
    drive = vv.Motor(joint=axle, motion="3*t + 0.2*sin(4*t)")
    system = vv.System([ground, *arms, axle, ball, drive, vv.Gravity()])
    vv.simulate(system, until=0.5, step=0.01, project=True)
    (_, quick, (of, values)), (_, a, (numbers, multipliers)) = (
        look(system) for look in (looked(in_the_core), looked(by_the_equations))
    )
    known = dict(zip(numbers.tolist(), multipliers, strict=True))
    np.testing.assert_allclose(values, [known[u] for u in of.tolist()], rtol=1e-7, atol=1e-6)
    np.testing.assert_allclose(quick, a, rtol=1e-7, atol=1e-6)


def looked(solve: Callable[[vv.System], Any]) -> Callable[[vv.System], Any]:
    def look(system: vv.System) -> Any:
        with undisturbed(system):
            return solve(system)

    return look


def test_reactions_beside_rigid_contact() -> None:
    """A pad rubs on a turntable: the bearing takes mu N along the slip, and N, whatever the augmentation is."""

    def bearing(stiffness: float, h: float) -> Any:
        ground, pad = vv.Ground(), vv.PointMass(mass=1.0, position=(0.3, 0, 0))
        disc = vv.RigidBody(mass=20.0, inertia=(1, 1, 1.6), angular_velocity=(0, 0, 30.0))
        axis = vv.Revolute(a=ground, b=disc, at=(0, 0, 0), axis=(0, 0, 1))
        guide = vv.PointOnLine(a=ground, b=pad, at=(0.3, 0, 0), axis=(0, 0, 1))
        top = vv.Plane(on=disc)
        rubs = vv.Contact(first=pad, second=top, friction=0.35, stiffness=stiffness)
        press = vv.Force(on=pad, force=(0, 0, -100.0))
        system = vv.System([ground, disc, axis, pad, guide, top, rubs, press])
        vv.simulate(system, until=0.1, step=h)
        return vv.reaction(system, axis)[0]

    coarse, fine = bearing(1e4, 0.002), bearing(1e4, 0.001)
    assert bearing(1e8, 0.002) == pytest.approx(coarse, rel=1e-8)
    errors = [float(np.abs(found - (0, 35, 100)).max()) for found in (coarse, fine)]
    assert errors[1] < 0.6 * errors[0] < 0.6 * 1.2  # the tangents are those of the middle of the step
