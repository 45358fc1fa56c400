"""Impacts of rigid bodies that rub, and rigid boxes that stick on four corners, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

G = 9.81
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


@pytest.mark.parametrize("stiffness", [1e4, 1e6, 1e8])
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_box_slips_or_sticks_on_a_platform_that_accelerates(friction: float, stiffness: float) -> None:
    """By 2: it follows with mu = 0.5, and with mu = 0.1 mu g; the stiffness of multipliers changes nothing."""
    ground = vv.Ground()
    platform = vv.RigidBody(
        shape=vv.Box(size=(4, 1, 0.1)), density=100.0, position=(0, 0, -0.05), name="platform"
    )
    slide = vv.Prismatic(a=ground, b=platform, at=(0, 0, -0.05), axis=(1, 0, 0), stroke=True)
    motor = vv.Motor(joint=slide, motion="t**2")
    box = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 0.1)), density=100.0, position=(0, 0, 0.05), name="box")
    contact = vv.Contact(
        first=box, second=platform, formulation="node-to-segment", stiffness=stiffness, friction=friction
    )
    system = vv.System([ground, platform, slide, motor, box, contact, vv.Gravity()])
    result = vv.simulate(system, until=1.0, step=0.005)
    assert system.value(box.point().position)[0] == pytest.approx(min(1.0, 0.5 * friction * G), abs=1e-9)
    result.assert_conserved("energy", tolerance=1e-9)


def test_box_at_rest_that_sticks_does_no_work() -> None:
    """Of slips by rounding work was booked, and the audit found it wrong."""
    box = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 0.1)), density=100.0, position=(0, 0, 0.05))
    plane = vv.Plane()
    contact = vv.Contact(first=box, second=plane, formulation="node-to-segment", stiffness=1e4, friction=0.5)
    result = vv.simulate(vv.System([box, plane, contact, vv.Gravity()]), until=1.0, step=1e-3)
    assert np.abs(result.ledger["work_friction"]).max() < 1e-14
    assert "WRONG" not in result.audit()
    result.assert_conserved("energy", tolerance=1e-9)
