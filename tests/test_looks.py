"""Looks leave no trace: runs that are checked, touched or split at every step have the bits of those that are not."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

import contact_parts
import flow_parts
import numpy as np
import point_contacts
import pytest

import visviva as vv
from visviva.component.component import Component
from visviva.examples import crane, four_bar

Looked = Callable[[vv.System], object]


def rolling(friction: float) -> list[Component]:
    """A spinning ball and a tilted box that fall onto a plane, and bounce."""
    turn = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.1),
        density=1e3,
        position=(0, 0, 0.12),
        velocity=(1, 0.5, -1),
        angular_velocity=(3, 4, 5),
    )
    box = vv.RigidBody(
        shape=vv.Box(size=(0.3, 0.2, 0.1)),
        density=1e3,
        position=(1, 0, 0.12),
        velocity=(0.5, 0, -1),
        rotation=turn,
    )
    plane = vv.Plane()
    touching = [
        vv.Contact(first=body, second=plane, stiffness=1e5, restitution=0.5, friction=friction)
        for body in (ball, box)
    ]
    return [ball, box, plane, *touching, vv.Gravity()]


def driven() -> list[Component]:
    """A motor that turns an arm by a table, with a load on a rope of springs."""
    ground = vv.Ground()
    arm = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    load = vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(2, 0, -0.5))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 1, 0))
    motor = vv.Motor(joint=axle, motion=[[0, 0], [0.1, 0.0], [0.2, 0.05], [1, 0.05]])
    rope = vv.Distance(a=arm.point((1, 0, 0)), b=load.point())
    return [ground, arm, load, axle, motor, rope, vv.Gravity()]


def bars() -> list[Component]:
    """A mechanism with redundant constraints: four bars with parallel axes in space."""
    return list(four_bar.study().system.components)


SYSTEMS: dict[str, tuple[Callable[[], list[Component]], float]] = {
    "rigid contact": (lambda: rolling(0.0), 0.005),
    "rigid friction": (lambda: rolling(0.3), 0.005),
    "balls": (lambda: point_contacts.balls(enforcement="multipliers", tangential="multipliers"), 0.01),
    "penalty friction": (lambda: point_contacts.balls(), 0.01),
    "mortar": (lambda: contact_parts.bricks(gap=0.01), 0.01),
    "mortar conserving": (lambda: contact_parts.bricks(gap=0.01, impact="conserving"), 0.01),
    "mortar friction": (lambda: contact_parts.plates(gap=0.01, friction=0.3), 0.01),
    "vertices": (lambda: point_contacts.blocks(), 0.01),
    "motor": (driven, 0.01),
    "redundant": (bars, 0.01),
    "ropes": (lambda: list(crane.study().system.components), 0.01),
    "flow": (lambda: flow_parts.stream("quad4"), 0.02),
}
SCHEMES = {
    "EnergyMomentum": vv.EnergyMomentum(),
    "VariationalMidpoint": vv.VariationalMidpoint(),
    "BackwardEuler": vv.BackwardEuler(),
}


def modes(system: vv.System) -> None:
    """Found, or refused where there is no equilibrium."""
    with suppress(vv.InputError):
        vv.modes(system, 2)


LOOKS: dict[str, Looked] = {"check": vv.System.check, "invalidate": vv.System.invalidate, "modes": modes}
STEPS = 24


def marched(
    make: Callable[[], list[Component]], h: float, scheme: Any, look: Looked | None
) -> tuple[Any, ...]:
    system = vv.System(make())
    contacts = [c for c in system.components if isinstance(c, vv.Contact)]
    shown = []

    def observe(s: vv.System) -> None:
        if look is not None:
            look(s)
        shown.append(
            np.concatenate(
                [s.x, s.v, *[np.ravel(u) for c in contacts for u in (c.pressures, c.forces, c.gaps)]]
            )
        )

    result = vv.simulate(system, until=STEPS * h, step=h, scheme=scheme, observe=observe)
    return np.array(shown), result.ledger.table


@cache
def plain_run(name: str, scheme: str) -> tuple[Any, ...]:
    """States and books of a run that is left alone; several tests compare with it."""
    make, h = SYSTEMS[name]
    return marched(make, h, SCHEMES[scheme], None)


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", SYSTEMS)
def test_looks_at_every_step(name: str, scheme: str, look: str) -> None:
    make, h = SYSTEMS[name]
    plain, books = plain_run(name, scheme)
    looked, other = marched(make, h, SCHEMES[scheme], LOOKS[look])
    np.testing.assert_array_equal(looked, plain)
    np.testing.assert_array_equal(other, books)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", SYSTEMS)
def test_runs_that_are_split(name: str, scheme: str) -> None:
    """At every step, as the books of each part are opened anew."""
    make, h = SYSTEMS[name]
    plain, _ = plain_run(name, scheme)
    system = vv.System(make())
    for k in range(1, STEPS + 1):
        vv.simulate(system, until=k * h, step=h, scheme=SCHEMES[scheme])
        n = len(system.x)
        np.testing.assert_array_equal(system.x, plain[k - 1][:n])
        np.testing.assert_array_equal(system.v, plain[k - 1][n : 2 * n])


def test_modes_at_rest_leave_multipliers_alone() -> None:
    """Reactions of the state are found for the modes, which is no reason to write them into it."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    rod = vv.Distance(a=ground.point(), b=ball.point())
    system = vv.System([ground, ball, rod, vv.Gravity(acceleration=(0, 0, -4))])
    before = system.x.copy()
    assert vv.modes(system).angular == pytest.approx([2.0, 2.0])
    np.testing.assert_array_equal(system.x, before)
