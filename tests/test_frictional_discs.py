"""How rigid faces that press by multipliers share their load, which decides friction's torque as they spin."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

RADIUS, LOAD, MU, INERTIA = 0.2, 500.0, 0.3, 0.06
LEVER = (2 + np.cos(np.pi / 16)) / 4
"""Of the mean slip at a vertex of a rim of 32 triangles about its middle, by the radius; it carries two thirds."""


@pytest.mark.parametrize("step", [0.002, 0.0005])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
@pytest.mark.parametrize("other", [vv.Cylinder(radius=RADIUS, length=0.02), vv.Box(size=(1, 1, 0.02))])
def test_torque_of_pressed_discs_is_that_of_uniform_pressure(
    other: vv.Shape, scheme: vv.Scheme, step: float
) -> None:
    """In every step, but for what polygons that turn on each other lose of their rims, half a percent."""
    ground, disc = vv.Ground(), vv.Cylinder(radius=RADIUS, length=0.02)
    low = vv.RigidBody(shape=other, mass=4.0, position=(0, 0, -0.01), angular_velocity=(0, 0, 20.0))
    up = vv.RigidBody(shape=disc, mass=3.0, position=(0, 0, 0.01))
    low_bearing = vv.Revolute(a=ground, b=low, at=(0, 0, -0.01), axis=(0, 0, 1))
    guide = vv.Cylindrical(a=ground, b=up, at=(0, 0, 0.01), axis=(0, 0, 1), stroke=True)
    press = vv.JointForce(joint=guide, coordinate="stroke", force=-LOAD)
    contact = vv.Contact(
        first=up,
        first_faces="z0",
        second=low,
        second_faces="z1",
        friction=MU,
        stiffness=1e8,
        formulation="mortar",
    )
    system = vv.System([ground, low, up, low_bearing, guide, press, contact])
    until, spin = 0.024, {"spin": vv.AngularVelocity(of=up)}
    result = vv.simulate(system, until=until, step=step, scheme=scheme, record=spin)
    torque = INERTIA * np.diff(result.history("spin")[:, 2]) / step
    assert len(torque) == round(until / step)
    assert torque == pytest.approx(2 / 3 * LEVER * MU * LOAD * RADIUS, rel=0.01)
    assert contact.pressures == pytest.approx(contact.pressures.mean(), rel=0.01)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
@pytest.mark.parametrize("until", [0.05, 0.15, 0.2025])
def test_corners_of_a_box_that_spins_and_stops_share_its_weight_evenly(
    until: float, scheme: vv.Scheme
) -> None:
    """By one number that is open: opposite corners carry one half each, whatever torque friction has."""
    size, mass, motion = (0.4, 0.3, 0.1), 2.0, {"velocity": (0.2, 0.1, 0), "angular_velocity": (0, 0, 2)}
    body = vv.RigidBody(shape=vv.Box(size=size), mass=mass, position=(0, 0, 0.05), **motion)
    plane = vv.Plane()
    contact = vv.Contact(first=body, first_faces="z0", second=plane, friction=MU, stiffness=1e8)
    system = vv.System([body, plane, contact, vv.Gravity(acceleration=(0, 0, -9.81))])
    vv.simulate(system, until=until, step=0.0025, scheme=scheme)
    opposite = contact.places[:, 0] * contact.places[:, 1] > 0
    assert contact.pressures[opposite].sum() == pytest.approx(mass * 9.81 / 2, rel=1e-8)
    assert contact.pressures[~opposite].sum() == pytest.approx(mass * 9.81 / 2, rel=1e-8)
