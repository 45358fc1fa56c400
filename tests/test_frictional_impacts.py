"""Impacts of points and balls that rub, against closed forms."""

from __future__ import annotations

from typing import Any

import pytest

import visviva as vv

SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint(), vv.BackwardEuler()]


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("h", [1e-2, 1e-3])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_point_that_sticks_in_an_impact_has_come_to_rest_along_the_plane(
    share: float, h: float, scheme: vv.Scheme
) -> None:
    """1 along and 2 down with mu = 0.9 > 1 / 2 (1 + e): it was thrown back with -1."""
    point, plane = vv.PointMass(mass=1.0, position=(0, 0, 0.3037), velocity=(1, 0, -2)), vv.Plane()
    contact = vv.Contact(first=point, second=plane, stiffness=1e5, friction=0.9, restitution=share)
    system = vv.System([point, plane, contact])
    result = vv.simulate(system, until=0.3, step=h, scheme=scheme)
    assert system.v[:3] == pytest.approx([0, 0, 2 * share], abs=1e-9)
    assert result.ledger["work_friction"][-1] == pytest.approx(-0.5, abs=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("stiffness", [1e3, 1e7])
def test_ball_that_sticks_in_an_impact_rolls(share: float, stiffness: float) -> None:
    """5/7 of its speed, and 1/7 of the energy along the plane are lost."""
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1e3, position=(0, 0, 0.3), velocity=(3, 0, -2))
    plane = vv.Plane()
    contact = vv.Contact(first=ball, second=plane, stiffness=stiffness, friction=0.9, restitution=share)
    system = vv.System([ball, plane, contact])
    result = vv.simulate(system, until=0.3, step=1e-3)
    assert system.v[0] == pytest.approx(15 / 7, rel=1e-5)
    lost = result.ledger["work_friction"][-1] / ball.mass_properties().mass
    assert lost == pytest.approx(-9 / 7, rel=1e-4)
    result.assert_conserved("energy", tolerance=1e-11)


@pytest.mark.parametrize("h", [1e-2, 1e-3])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_elastic_slip_rubs_in_an_impact_or_says_that_it_cannot(share: float, h: float) -> None:
    """It brakes by mu (1 + e) v; its impulse vanished with the step without a word."""
    point, plane = vv.PointMass(mass=1.0, position=(0, 0, 0.3037), velocity=(1, 0, -2)), vv.Plane()
    options = {"tangential": "penalty", "restitution": share}
    contact = vv.Contact(first=point, second=plane, stiffness=1e5, friction=0.1, **options)
    system = vv.System([point, plane, contact])
    if h > 1e-3:
        vv.simulate(system, until=0.3, step=h)
        assert system.v[0] == pytest.approx(1 - 0.1 * (1 + share) * 2, rel=1e-9)
        return
    with pytest.raises(vv.StepFailure, match=r"contact-1.*an impact rubs.*tangential='multipliers'"):
        vv.simulate(system, until=0.3, step=h)


PAIRS = ["penalty", "multipliers"]


@pytest.mark.parametrize(
    ("enforcement", "tangential", "lower_first"),
    [
        (normal, along, lower_first)
        for normal in PAIRS
        for along in PAIRS
        for lower_first in (False, True)
        if not lower_first or (normal, along) != ("multipliers", "penalty")  # by vertices alone
    ],
)
def test_what_bounces_straight_is_not_pushed_aside(
    enforcement: Any, tangential: Any, lower_first: bool
) -> None:
    """A box that comes down beside the middle of a floor's triangles: they seemed to turn, and it to slip."""
    points, triangles = vv.Box(size=(1, 1, 0.1)).surface()
    mesh = vv.SurfaceMesh(points=points, triangles=triangles)
    floor = vv.RigidBody(shape=mesh, density=1e3)
    box = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.2, 0.2)), density=1e3, position=(0.05, 0.03, 0.16), velocity=(0, 0, -3)
    )
    first, second = (floor, box) if lower_first else (box, floor)
    options: Any = {"enforcement": enforcement, "tangential": tangential}
    contact = vv.Contact(
        first=first, second=second, stiffness=1e5, friction=0.3, tangential_stiffness=1e5, **options
    )
    hold = vv.Rigid(a=vv.Ground(), b=floor, at=(0, 0, 0))
    system = vv.System([floor, hold.a, hold, box, contact])
    result = vv.simulate(system, until=0.03, step=1e-3)
    assert vv.Velocity(of=box)(system)[:2] == pytest.approx((0, 0), abs=1e-9)
    assert vv.AngularVelocity(of=box)(system) == pytest.approx((0, 0, 0), abs=1e-8)
    result.assert_conserved("energy", tolerance=1e-9)
