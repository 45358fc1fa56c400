"""Rigid bodies that slide, stick and roll on exact shapes, against formulas, at several scales of length."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

G = 9.81


def facets(size: float, young: float = 1e4, density: float = 1.0) -> list[Any]:
    """A floor of facets across the ball's way."""
    mesh = vv.BoxMesh(size=(4.5, 4.2, 1), counts=(25, 12, 1), origin=(-1.5, -2.0, -1)).build()
    X, turn = mesh.points * size, np.radians(20)
    X[:, :2] = X[:, :2] @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    rubber = vv.NeoHooke(young=young, poisson=0.3)
    floor = vv.Solid(
        mesh=vv.Mesh(X, mesh.cells, face_sets=mesh.face_sets), material=rubber, density=density / size**3
    )
    return [floor, vv.Fixed(solid=floor, nodes="all")]


def ball_on_plane(
    size: float, angle: float = 0.0, speed: float = 0.0, on_facets: bool = False, **options: Any
) -> list[Any]:
    """A ball of radius `size` on a plane that falls along x, in units of time in which gravity is the same."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=size),
        density=1.0 / size**3,
        position=(0.3 * size, 0.1 * size, size),
        velocity=(speed * np.sqrt(size), 0, 0),
    )
    floor, *held = facets(size) if on_facets else [vv.Plane()]
    if on_facets:
        options |= {"second_faces": "z1", "formulation": "node-to-segment"}
    contact = vv.Contact(first=ball, second=floor, **({"stiffness": 1e4 / size, "friction": 0.2} | options))
    gravity = vv.Gravity(acceleration=(G * np.sin(angle), 0, -G * np.cos(angle)))
    return [ball, floor, contact, gravity, *held]


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("tangential", ["multipliers", "penalty"])
@pytest.mark.parametrize("on_facets", [False, True], ids=["plane", "facets"])
def test_sliding_ball_begins_to_roll(size: float, tangential: str, on_facets: bool) -> None:
    """A ball thrown with v = 1 without spin slides until t = 2 v / 7 mu g = 0.145624, over 0.1248206; then it rolls
    with 5/7 of its speed, and 2/7 of its energy are lost."""
    unit = np.sqrt(size)
    parts = ball_on_plane(
        size, speed=1.0, on_facets=on_facets, tangential=tangential, tangential_stiffness=1e6 / size
    )
    ball, _, contact, *_ = parts
    system, times, places, slips = vv.System(parts), [], [], []

    def observe(s: vv.System) -> None:
        times.append(s.time / unit)
        places.append(s.value(ball.point().position)[0] / size - 0.3)
        slips.append(bool(contact.slipping.any()))

    result = vv.simulate(system, until=0.3 * unit, step=0.001 * unit, observe=observe)
    first = slips.index(False)
    assert 0.145624 < times[first] < 0.145624 + 2 * 0.001
    assert (places[-1] - places[first]) / (times[-1] - times[first]) == pytest.approx(5 / 7, rel=5e-4)
    assert places[first] - 5 / 7 * (times[first] - 0.145624) == pytest.approx(0.1248206, rel=2e-4)
    if tangential == "multipliers":
        assert not any(slips[first:])
    lost = result.ledger["work_friction"][-1] / result.ledger["kinetic"][0]
    assert lost == pytest.approx(-2 / 7, rel=1e-3)
    result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_ball_rolls_down_a_slope(size: float) -> None:
    """At 30 degrees with mu = 0.2 > 2/7 tan it rolls, with 5/7 g sin and without loss; with mu = 0.1 it slides with
    g (sin - mu cos)."""
    unit, angle = np.sqrt(size), np.radians(30)
    for friction, expected in ((0.2, 5 / 7 * np.sin(angle)), (0.1, np.sin(angle) - 0.1 * np.cos(angle))):
        parts = ball_on_plane(size, angle, friction=friction)
        system = vv.System(parts)
        result = vv.simulate(system, until=0.5 * unit, step=0.005 * unit)
        assert system.v[0] / unit == pytest.approx(0.5 * G * expected, rel=5e-4)
        assert bool(parts[2].slipping.any()) == (friction == 0.1)
        work = result.ledger["work_friction"]
        assert work[-1] < -1e-3 * size if friction == 0.1 else abs(work).max() < 1e-10 * size
        result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("part", [0.99, 1.01])
@pytest.mark.parametrize("on_facets", [False, True], ids=["plane", "facets"])
def test_particle_at_the_limit_of_sticking(size: float, part: float, on_facets: bool) -> None:
    """On a slope of 30 degrees, with one per cent less than tan 30 degrees it slides, with one more it stays."""
    unit, angle = np.sqrt(size), np.radians(30)
    friction = part * np.tan(angle)
    floor, *held = facets(size) if on_facets else [vv.Plane()]
    more: Any = {"second_faces": "z1", "formulation": "node-to-segment"} if on_facets else {}
    particle = vv.PointMass(mass=2.0)
    contact = vv.Contact(first=particle, second=floor, stiffness=1e4 / size, friction=friction, **more)
    gravity = vv.Gravity(acceleration=(G * np.sin(angle), 0, -G * np.cos(angle)))
    system = vv.System([particle, floor, contact, gravity, *held])
    vv.simulate(system, until=unit, step=0.01 * unit)
    slides = 0.5 * G * (np.sin(angle) - friction * np.cos(angle)) * (part < 1)
    assert contact.slipping.all() == (part < 1)
    assert system.x[0] / size == pytest.approx(slides, rel=1e-9, abs=1e-13)


@pytest.mark.parametrize("part", [0.99, 1.01])
@pytest.mark.parametrize("young", [1e4, 1e12])
@pytest.mark.parametrize("density", [1e-9, 1e6])
def test_a_particle_slides_alike_on_held_floors_of_whatever_stiffness_and_mass(
    density: float, young: float, part: float
) -> None:
    angle = np.radians(30)
    friction = part * np.tan(angle)
    floor, *held = facets(1.0, young, density)
    particle = vv.PointMass(mass=2.0)
    contact = vv.Contact(
        first=particle,
        second=floor,
        second_faces="z1",
        formulation="node-to-segment",
        stiffness=1e4,
        friction=friction,
    )
    gravity = vv.Gravity(acceleration=(G * np.sin(angle), 0, -G * np.cos(angle)))
    system = vv.System([particle, floor, contact, gravity, *held])
    statistics = vv.simulate(system, until=1.0, step=0.01).statistics
    slides = 0.5 * G * (np.sin(angle) - friction * np.cos(angle)) * (part < 1)
    assert statistics.rejected == 0
    assert contact.slipping.all() == (part < 1)
    assert system.x[0] == pytest.approx(slides, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.VariationalMidpoint(), vv.Midpoint()], ids=str)
@pytest.mark.parametrize("tangential", ["multipliers", "penalty"])
def test_a_ball_that_spins_about_the_normal_rolls_straight(scheme: Any, tangential: str) -> None:
    """What rolls with v = R w turns about the normal without a force: it drifts aside by the error of the scheme."""
    drifts = []
    for step in (4e-3, 2e-3):
        ball = vv.RigidBody(
            shape=vv.Sphere(radius=0.1),
            mass=1.0,
            position=(0, 0, 0.1),
            velocity=(2, 0, 0),
            angular_velocity=(0, 20, 5),
        )
        floor = vv.Plane()
        contact = vv.Contact(
            first=ball,
            second=floor,
            friction=0.2,
            stiffness=1e6,
            tangential=tangential,
            tangential_stiffness=1e5,
        )
        system = vv.System([ball, floor, contact, vv.Gravity()])
        vv.simulate(system, until=0.4, step=step, scheme=scheme)
        place = system.value(ball.point().position)
        assert place[0] == pytest.approx(0.8, abs=1e-3)
        drifts.append(abs(place[1]))
    assert drifts[1] < 1e-6
    assert drifts[0] / drifts[1] > 3.5 or max(drifts) < 1e-12


MIDPOINTS = pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.VariationalMidpoint(), vv.Midpoint()], ids=str
)


@MIDPOINTS
def test_what_presses_on_a_spinning_ball_without_friction_does_not_brake_it(scheme: Any) -> None:
    """The force goes through the centre: the momentum about it stays."""
    ground = vv.Ground()
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.2), mass=20.0, angular_velocity=(0, 30, 0))
    axle = vv.Revolute(a=ground, b=ball, at=(0, 0, 0), axis=(0, 1, 0))
    bead = vv.PointMass(mass=1.0, position=(0, 0, 0.2))
    line = vv.PointOnLine(a=ground, b=bead, at=(0, 0, 0.2), axis=(0, 0, 1))
    contact = vv.Contact(first=bead, second=ball, stiffness=1e4)
    push = vv.Force(on=bead, force=(0, 0, -100.0))
    system = vv.System([ground, ball, axle, bead, line, contact, push])
    ledger = vv.simulate(system, until=0.3, step=0.003, scheme=scheme).ledger
    assert np.abs(ledger["angular_y"] - 9.6).max() < 1e-10


@MIDPOINTS
def test_a_bead_is_thrown_out_along_a_driven_blade(scheme: Any) -> None:
    """r = cosh t, and its drive does the work sinh^2 t; the pressure turns with the blade."""
    far, worked = [], []
    for step in (0.01, 0.005):  # what the gap sinks is of third order
        ground = vv.Ground()
        blade = vv.RigidBody(
            shape=vv.Box(size=(6.0, 0.2, 1.0)),
            mass=1.0,
            position=(0, -0.1, 0),
            velocity=(0.1, 0, 0),
            angular_velocity=(0, 0, 1),
        )
        axle = vv.Revolute(a=ground, b=blade, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
        drive = vv.Motor(joint=axle, motion="t")
        bead = vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(0, 1, 0))
        contact = vv.Contact(first=bead, second=blade, stiffness=1e3)
        system = vv.System([ground, blade, axle, drive, bead, contact])
        ledger = vv.simulate(system, until=1.0, step=step, scheme=scheme).ledger
        far.append(abs(np.linalg.norm(system.value(bead.point().position)) - np.cosh(1.0)))
        worked.append(abs(ledger.last("work_drive") - np.sinh(1.0) ** 2))
    assert max(far[1], worked[1]) < 3e-5
    assert far[0] / far[1] == pytest.approx(4.0, abs=0.2)
    assert worked[0] / worked[1] == pytest.approx(4.0, abs=0.3)
