"""Boxes that rest, slide and spin on planes and platforms with friction by multipliers, against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

G = 9.81
STIFFNESSES = [1e3, 1e4, 1e6, 1e8]


def box(**motion: Any) -> vv.RigidBody:
    """A flat box of 1.6 that stands on z = 0."""
    shape = vv.Box(size=(0.4, 0.4, 0.1))
    return vv.RigidBody(shape=shape, density=100.0, position=(0, 0, 0.05), name="box", **motion)


def on_plane(body: vv.RigidBody, **options: Any) -> vv.System:
    plane = vv.Plane()
    contact = vv.Contact(first=body, second=plane, formulation="node-to-segment", **options)
    return vv.System([body, plane, contact, vv.Gravity()])


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_box_slips_or_sticks_on_a_platform_that_accelerates(friction: float, stiffness: float) -> None:
    """By 2: it goes along with mu = 0.5, and with mu = 0.1 by mu g; the stiffness of multipliers changes nothing."""
    ground = vv.Ground()
    shape = vv.Box(size=(4, 1, 0.1))
    platform = vv.RigidBody(shape=shape, density=100.0, position=(0, 0, -0.05), name="platform")
    slide = vv.Prismatic(a=ground, b=platform, at=(0, 0, -0.05), axis=(1, 0, 0), stroke=True)
    motor, body = vv.Motor(joint=slide, motion="t**2"), box()
    options = {"formulation": "node-to-segment", "stiffness": stiffness, "friction": friction}
    contact = vv.Contact(first=body, second=platform, **options)
    system = vv.System([ground, platform, slide, motor, body, contact, vv.Gravity()])
    result = vv.simulate(system, until=1.0, step=0.005)
    assert system.value(body.point().position)[0] == pytest.approx(min(1.0, 0.5 * friction * G), abs=1e-12)
    result.assert_conserved("energy", tolerance=1e-12)


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("step", [1e-2, 1e-3])
def test_box_at_rest_that_sticks_does_no_work(step: float, stiffness: float) -> None:
    """Slips by rounding times tractions by rounding were booked as work, which the audit found wrong."""
    result = vv.simulate(on_plane(box(), friction=0.5, stiffness=stiffness), until=0.5, step=step)
    assert np.abs(result.ledger["work_friction"]).max() < 1e-12
    assert "WRONG" not in result.audit()


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("step", [1e-2, 1e-3])
def test_box_that_slides_comes_to_rest_where_coulomb_says(step: float, stiffness: float) -> None:
    """After v^2 / 2 mu g, to the order of the step in which it stops, without a turn."""
    body = box(velocity=(2, 0, 0))
    system = on_plane(body, friction=0.2, stiffness=stiffness)
    result = vv.simulate(system, until=1.2, step=step)
    place = system.value(body.point().position)
    assert place[:2] == pytest.approx([4 / (2 * 0.2 * G), 0], abs=10 * step**2)
    assert result.ledger["work_friction"][-1] == pytest.approx(-0.5 * 1.6 * 4, rel=2e-5)
    result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint()])
@pytest.mark.parametrize("speed", [0.33, 0.4, 0.5])
@pytest.mark.parametrize("step", [0.02, 0.005])
@pytest.mark.parametrize("kind", ["box", "point"])
def test_what_friction_has_stopped_is_at_rest(
    kind: str, step: float, speed: float, scheme: vv.Scheme
) -> None:
    """It kept up to mu g h, to and fro in every step, which came back as a drift of 29 mm/s once it was lifted."""
    velocity = (speed, 0.5 * speed, 0)
    body: Any = box(velocity=velocity)
    if kind == "point":
        body = vv.PointMass(mass=1.6, position=(0, 0, 0), velocity=velocity)
    plane = vv.Plane()
    contact = vv.Contact(first=body, second=plane, friction=0.3, stiffness=1e5)
    lift = vv.Force(on=body, force=lambda t, x, v: (0, 0, 20.0 if t > 0.6 else 0.0))
    system = vv.System([body, plane, contact, vv.Gravity(), lift])
    rubs = vv.ContactForce(contact=contact)
    result = vv.simulate(system, until=0.6, step=step, scheme=scheme, record=[rubs])
    assert np.abs(result.history(rubs)[-4:, :2]).max() < 1e-6
    assert result.ledger["work_friction"][-1] == pytest.approx(-0.5 * 1.6 * 1.25 * speed**2, rel=1e-9)
    vv.simulate(system, until=0.8, step=step, scheme=scheme)
    assert vv.Velocity(of=body)(system)[:2] == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("spin", [1.0, 3.0, 10.0, 30.0])
def test_box_that_slides_and_spins_does_not_fail(spin: float, stiffness: float) -> None:
    """The power of friction is mu times that of four pressures at the corners: the box slides farther than without
    spin; what four corners share of the weight, and so where it goes aside, no law of rigid bodies says."""
    body = box(velocity=(2, 0, 0), angular_velocity=(0, 0, spin))
    system = on_plane(body, friction=0.2, stiffness=stiffness)
    result = vv.simulate(system, until=0.5, step=1e-3)
    straight = 2 * 0.5 - 0.5 * 0.2 * G * 0.5**2
    assert system.value(body.point().position)[0] > straight
    assert np.all(np.diff(result.ledger["work_friction"]) <= 1e-14)
    result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("step", [1e-2, 1e-3])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("friction", [0.1, 0.9])
def test_box_that_falls_flat_obeys_both_laws_of_impact(friction: float, share: float, step: float) -> None:
    """1 along and 2 down: the impulse p_n = 2 (1 + e) m stops it along the plane where mu p_n >= m, else takes mu p_n;
    it was thrown back with up to -1. Low, so that what the edges trip over does not turn it."""
    shape = vv.Box(size=(0.4, 0.4, 1e-6))
    body = vv.RigidBody(shape=shape, density=1e7, position=(0, 0, 0.3037), velocity=(1, 0, -2))
    plane = vv.Plane()
    options = {"formulation": "node-to-segment", "friction": friction, "restitution": share, "stiffness": 1e5}
    system = vv.System([body, plane, vv.Contact(first=body, second=plane, **options)])
    result = vv.simulate(system, until=0.3, step=step)
    along = max(1 - 2 * (1 + share) * friction, 0)
    assert system.v[:3] == pytest.approx([along, 0, 2 * share], abs=1e-5)
    lost = result.ledger["work_friction"][-1] / body.mass_properties().mass
    assert lost == pytest.approx(0.5 * (along**2 - 1), abs=1e-5)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("friction", [0.3, 0.7])
@pytest.mark.parametrize("turn", [0.0, 0.4, 1.1])
def test_box_that_falls_askew_stays_in_the_cone_and_gains_nothing(
    turn: float, friction: float, share: float
) -> None:
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    shape, motion = vv.Box(size=(0.4, 0.2, 0.1)), {"velocity": (1.5, 0.5, -2), "angular_velocity": (2, -3, 1)}
    body = vv.RigidBody(shape=shape, density=100.0, position=(0, 0, 0.4), rotation=R, **motion)
    plane = vv.Plane()
    options = {"formulation": "node-to-segment", "friction": friction, "restitution": share, "stiffness": 1e5}
    contact = vv.Contact(first=body, second=plane, **options)
    system, forces = vv.System([body, plane, contact, vv.Gravity()]), []
    result = vv.simulate(system, until=0.4, step=2e-3, observe=lambda s: forces.append(contact.forces.sum(0)))
    pressed = np.array(forces)[:, 2]
    assert pressed.max() > 0
    assert np.all(np.linalg.norm(np.array(forces)[:, :2], axis=1) <= friction * pressed + 1e-6)
    taken = result.ledger["work_friction"] + result.ledger["work_contact"]
    assert np.diff(taken).max() < 1e-9 * result.ledger["kinetic"][0]
    result.assert_conserved("energy", tolerance=1e-9)


@pytest.mark.parametrize("formulation", [None, "node-to-segment"])
@pytest.mark.parametrize("height", [0.001, 0.03, 0.1, 0.2])
def test_box_is_braked_by_mu_g_however_tall_it_is(height: float, formulation: Any) -> None:
    """Its vertices are those of its sides as well, whose normals once turned pressures and made friction grow."""
    body = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.15, height)),
        density=1000.0,
        position=(0, 0, height / 2),
        velocity=(1, 0, 0),
        name="box",
    )
    ground = vv.Ground()
    platform = vv.RigidBody(
        shape=vv.Box(size=(2, 1, 0.1)), density=1000.0, position=(0, 0, -0.05), name="platform"
    )
    slide = vv.Prismatic(a=ground, b=platform, at=(0, 0, -0.05), axis=(1, 0, 0), stroke=True)
    motor = vv.Motor(joint=slide, motion="0*t")
    contact = vv.Contact(first=body, second=platform, formulation=formulation, friction=0.3, stiffness=1e5)
    system = vv.System([ground, platform, slide, motor, body, contact, vv.Gravity()])
    result = vv.simulate(system, until=0.1, step=0.002)
    expected = [0.1 - 0.5 * 0.3 * G * 0.1**2, 0, height / 2]
    assert system.value(body.point().position) == pytest.approx(expected, abs=1e-10)
    pressing = 0.2 * 0.15 * height * 1000.0 * G
    assert contact.pressures @ contact.term.areas == pytest.approx(pressing, rel=1e-9)
    result.assert_conserved("energy", tolerance=1e-12)


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e9])
@pytest.mark.parametrize("step", [2e-3, 5e-4])
def test_box_on_a_platform_to_and_fro_stays_on_its_line(step: float, stiffness: float) -> None:
    ground = vv.Ground()
    platform = vv.RigidBody(shape=vv.Box(size=(2, 1, 0.1)), density=1000.0, position=(0, 0, -0.05))
    slide = vv.Prismatic(a=ground, b=platform, at=(0, 0, -0.05), axis=(1, 0, 0), stroke=True)
    motor = vv.Motor(joint=slide, motion=lambda t: 0.05 * np.sin(15 * t) ** 2)
    body = vv.RigidBody(shape=vv.Box(size=(0.2, 0.15, 0.1)), density=1000.0, position=(0, 0, 0.05))
    contact = vv.Contact(first=body, second=platform, friction=0.3, stiffness=stiffness)
    system = vv.System([ground, platform, slide, motor, body, contact, vv.Gravity()])
    vv.simulate(system, until=0.32, step=step)
    assert system.value(body.point().position)[1:] == pytest.approx([0, 0.05], abs=1e-9)


def test_a_ball_that_rolls_off_a_box_that_friction_stops() -> None:
    """Both came with 2 m/s; the box tips as it stops, and what sticks there was found in the last iterations."""
    ground, floor = (
        vv.Ground(),
        vv.RigidBody(shape=vv.Box(size=(8, 4, 0.4)), density=1e3, position=(0, 0, -0.2)),
    )
    box = vv.RigidBody(shape=vv.Box(size=(0.6, 0.5, 0.2)), mass=4.0, position=(0, 0, 0.1), velocity=(2, 0, 0))
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.1), mass=1.0, position=(0.05, 0.02, 0.3), velocity=(2, 0.1, 0)
    )
    contacts = [
        vv.Contact(first=a, second=b, stiffness=1e5, friction=0.6)
        for a, b in ((box, floor), (ball, box), (ball, floor))
    ]
    weld = vv.Rigid(a=ground, b=floor, at=(0, 0, 0))
    system = vv.System([ground, floor, weld, box, ball, *contacts, vv.Gravity()])
    result = vv.simulate(system, until=0.6, step=0.02)
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-10 * np.abs(total).max()
    assert result.conservation()["energy"] < 1e-10
