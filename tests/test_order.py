"""The declared order of every scheme, measured on constrained motion and on a transport field."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from instances.heat import Bar
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

SCHEMES = [
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BackwardEuler(),
    vv.BDF2(),
    vv.GeneralizedAlpha(0.95),
    vv.GeneralizedAlpha(0.8),
    vv.GeneralizedAlpha(0.0),
]
STEPS = (20, 40)
FINE = 1280


def top() -> vv.System:
    """A heavy top on a ball joint with a spring to the ground; nutates and precesses."""
    ground = vv.Ground()
    body = vv.RigidBody(
        mass=1.0,
        inertia=(0.3, 0.35, 0.2),
        centre=(0.1, 0.0, 0.5),
        rotation=[[1, 0, 0], [0, np.cos(0.5), -np.sin(0.5)], [0, np.sin(0.5), np.cos(0.5)]],
        angular_velocity=(0.3, 1.0, 2.0),
    )
    spring = vv.Spring(
        a=ground.point((1.0, 0.0, 1.0)), b=body.point((0.0, 0.0, 1.0)), stiffness=3.0, free_length=0.7
    )
    joint = vv.Spherical(a=ground, b=body, at=(0, 0, 0))
    return vv.System([ground, body, joint, spring, vv.Gravity(acceleration=(0, 0, -5.0))])


def hinge() -> vv.System:
    """A pendulum of two hinged bodies, with angle, damper and torsion spring on the second hinge."""
    ground = vv.Ground()
    links = [
        vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.05), position=(x, 0, 0), angular_velocity=(0, 0, 0))
        for x in (0.5, 1.5)
    ]
    first = vv.Revolute(a=ground, b=links[0], at=(0, 0, 0), axis=(0, 1, 0))
    second = vv.Revolute(a=links[0], b=links[1], at=(1, 0, 0), axis=(0, 1, 0))
    on = [vv.JointSpring(joint=second, stiffness=2.0), vv.JointDamper(joint=second, damping=0.2)]
    return vv.System([ground, *links, first, second, *on, vv.Gravity(acceleration=(0, 0, -5.0))])


def bar() -> vv.System:
    """Heat in a bar, smooth enough that the coarsest step resolves it, also the first, which goes to its end."""
    return vv.System([Bar(temperatures=(1.0, 0.8, 0.3, 0.2))])


def block() -> vv.System:
    """A soft block that turns and is pulled at an end, its lowest frequencies resolved by the coarsest step."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)),
        material=vv.NeoHooke(young=5.0, poisson=0.3),
        density=1.0,
        angular_velocity=(0.5, 1.0, -0.7),
    )
    pull = vv.Traction(solid=solid, faces="x1", traction=(1.0, 0.5, 0.2), times="cos(2*t)")
    return vv.System([solid, pull])


def end_state(make: Callable[[], vv.System], scheme: vv.Scheme, n: int, until: float) -> tuple[Array, Array]:
    """Unknowns (without multipliers) and rates of motion after `n` steps."""
    system = make()
    vv.simulate(system, until=until, step=until / n, scheme=scheme, every=n)
    return system.x[system.order > 0].copy(), system.v[system.order == 2].copy()


@cache
def reference(make: Callable[[], vv.System], until: float) -> tuple[Array, Array]:
    """A fine run of one second-order scheme: a scheme with another limit fails, whatever its slope."""
    return end_state(make, vv.EnergyMomentum(), FINE, until)


def slope(coarse: Array, fine: Array, exact: Array) -> float:
    """Observed order of a halving."""
    return float(np.log2(np.abs(coarse - exact).max() / np.abs(fine - exact).max()))


@pytest.mark.parametrize(
    ("make", "until"),
    [(top, 0.25), (hinge, 0.25), (block, 0.25), (bar, 0.05)],
    ids=["top", "hinge", "block", "bar"],
)
@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_declared_order(scheme: vv.Scheme, make: Callable[[], vv.System], until: float) -> None:
    coarse, fine = (end_state(make, scheme, n, until) for n in STEPS)
    for what, a, b, exact in zip(
        ("positions", "velocities"), coarse, fine, reference(make, until), strict=True
    ):
        if len(exact):
            observed = slope(a, b, exact)
            assert abs(observed - scheme.order) < 0.15, f"{what} converge with order {observed:.3f}"
