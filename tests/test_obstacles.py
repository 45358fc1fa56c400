"""Contact with exact shapes: distances, rebounds, forces, conservation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from point_contacts import RUBBER

import visviva as vv

G = 9.81


def probe(shape: object, place: tuple[float, float, float]) -> float:
    """Gap of a point mass to a turned obstacle, by a place in its frame."""
    axis, first = np.array([1.0, 2.0, 2.0]) / 3, np.array([2.0, 1.0, -2.0]) / 3
    axes = np.array([first, np.cross(axis, first), axis])
    at = np.array([0.3, -0.2, 0.5])
    particle = vv.PointMass(mass=1.0, position=at + np.array(place) @ axes)
    obstacle = vv.Obstacle(shape=shape, at=at, axis=axis, first=first)
    contact = vv.Contact(
        first=particle, second=obstacle, enforcement="penalty", stiffness=1e-12, initial="press"
    )
    vv.simulate(vv.System([particle, obstacle, contact]), until=0.1, step=0.1)
    return float(contact.gaps[0])


@pytest.mark.parametrize(
    ("shape", "place", "expected"),
    [
        (vv.Sphere(radius=0.5), (0.0, 3.0, 4.0), 4.5),
        (vv.Sphere(radius=0.5), (0.0, 0.0, 0.4), -0.1),
        (vv.Box(size=(2, 4, 6)), (0.3, -0.1, 3.5), 0.5),
        (vv.Box(size=(2, 4, 6)), (4.0, -6.0, 1.0), 5.0),
        (vv.Box(size=(2, 4, 6)), (3.0, 4.0, -4.0), 3.0),
        (vv.Box(size=(2, 4, 6)), (0.9, 0.0, 0.0), -0.1),
        (vv.Cylinder(radius=1, length=2), (3.0, 4.0, 0.2), 4.0),
        (vv.Cylinder(radius=1, length=2), (2.4, 3.2, 5.0), 5.0),
        (vv.Cylinder(radius=1, length=2), (0.1, 0.2, -0.8), -0.2),
        (vv.Capsule(radius=1, length=2), (3.0, 4.0, 0.2), 4.0),
        (vv.Capsule(radius=1, length=2), (0.0, 3.0, 5.0), 4.0),
    ],
)
def test_distance(shape: object, place: tuple[float, float, float], expected: float) -> None:
    assert probe(shape, place) == pytest.approx(expected, abs=1e-9)


def test_ball_on_a_spring_floor() -> None:
    """A ball that falls on a penalty comes back to its height, after the time of half an oscillation in between."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.1), density=1000.0, position=(0.2, 0, 0.3), velocity=(1, 0, 0)
    )
    m, k, floor = ball.mass_properties().mass, 1e4, vv.Plane()
    contact = vv.Contact(first=ball, second=floor, enforcement="penalty", stiffness=k)
    heights: list[float] = []
    system = vv.System([ball, floor, contact, vv.Gravity()])
    result = vv.simulate(
        system, until=0.5, step=0.001, observe=lambda s: heights.append(s.value(ball.point().position)[2])
    )
    result.assert_conserved("energy", tolerance=1e-10)
    v = np.sqrt(2 * G * 0.2)
    depth = m * G / k + np.sqrt((m * G / k) ** 2 + m * v * v / k)
    assert 0.1 - min(heights) == pytest.approx(depth, rel=2e-3)
    assert max(heights[250:]) == pytest.approx(0.3, abs=1e-4)
    assert system.value(ball.point().position)[0] == pytest.approx(0.7, abs=1e-9)


@pytest.mark.parametrize("damping", [5.0, 40.0])
def test_damped_impact_leaves_the_velocity_of_a_damped_spring(damping: float) -> None:
    """A body on a spring and a damper that do not pull (Schwager & Poeschel 2007); what is lost is booked."""
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.1), mass=1.0, position=(0, 0, 0.1), velocity=(0, 0, -1))
    contact = vv.Contact(first=ball, second=vv.Plane(), enforcement="penalty", stiffness=1e4, damping=damping)
    system = vv.System([ball, contact.second, contact])  # type: ignore[list-item]
    result = vv.simulate(system, until=0.05, step=5e-5)
    beta, omega0 = damping / 2, 100.0
    omega = np.sqrt(omega0**2 - beta**2)
    left = np.exp(-beta / omega * (np.pi - np.arctan2(2 * beta * omega, omega**2 - beta**2)))
    assert system.v[2] == pytest.approx(left, rel=1e-3)
    result.assert_conserved("energy", tolerance=1e-11)
    assert np.diff(result.ledger["total"]).max() < 1e-13


def test_balls_collide_head_on() -> None:
    """Equal balls exchange their velocities."""
    one, two = (
        vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1000.0, position=(x, 0.02, 0), velocity=(v, 0, 0))
        for x, v in ((0.0, 0.5), (0.25, -0.3))
    )
    contact = vv.Contact(
        first=one, second=two, formulation="node-to-segment", enforcement="penalty", stiffness=1e5
    )
    system = vv.System([one, two, contact], vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=0.2, step=0.002)
    result.assert_conserved("energy", "momentum_x", "angular_z", tolerance=1e-11)
    velocities = [system.v[b.place(np.zeros(3))[0].weights[0][0]] for b in (one, two)]
    assert velocities == pytest.approx([-0.3, 0.5], abs=1e-9)


def test_plate_pressed_onto_a_plane() -> None:
    """Multipliers on a plane keep the compression uniform, with about the stress of a logarithmic strain."""
    mesh = vv.RectangleMesh(size=(1.0, 0.5), counts=(3, 2)).build()
    plate = vv.Solid(mesh=mesh, material=RUBBER, density=2.0)
    floor = vv.Plane(normal=(0, 1, 0))
    contact = vv.Contact(first=plate, first_faces="y0", second=floor)
    side = vv.SymmetryPlane(solid=plate, nodes="x0", normal=(1, 0, 0))
    hold = vv.Prescribed(solid=plate, nodes="y1", motion=(None, "-0.01*t", None))
    system = vv.System([plate, floor, contact, side, hold])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert np.ptp(contact.pressures) < 1e-9  # uniform compression
    assert np.abs(contact.gaps).max() < 1e-12
    stretch = 1 - 0.01 / 0.5
    assert contact.pressures[0] == pytest.approx(100 / (1 - 0.09) * -np.log(stretch), rel=0.03)


def test_faces_of_a_second_that_is_none_are_refused() -> None:
    """Lips of a crack went through each other: the faces of the other one were passed over."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1.0, poisson=0.0)
    )
    with pytest.raises(vv.InputError, match=r"second_faces = 'z1' .* not given"):
        vv.Contact(first=solid, first_faces="z0", second_faces="z1")


def test_self_contact_by_mortar_needs_two_parts() -> None:
    mesh = vv.RectangleMesh(size=(1.0, 0.5), counts=(3, 2)).build()
    plate = vv.Solid(mesh=mesh, material=RUBBER, density=2.0)
    with pytest.raises(vv.InputError, match="by formulation='node-to-segment'"):
        vv.Contact(first=plate, formulation="mortar")
    with pytest.raises(vv.InputError, match="leave out second and second_faces for self-contact"):
        vv.System([plate, vv.Contact(first=plate, second=plate)])


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("way", [0.15, 0.2, 0.4])
def test_balls_do_not_pass_through_capsules(enforcement: Any, way: float) -> None:
    """Half of the way through in a step it leaves by the other side: it went by as far as the capsule is long."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.05), density=1.0, position=(-0.5, 0.003, 0.4), velocity=(20.0, 0, 0)
    )
    obstacle = vv.Obstacle(shape=vv.Capsule(radius=0.1, length=2.0))
    contact = vv.Contact(first=ball, second=obstacle, stiffness=1e5, enforcement=enforcement)
    system = vv.System([ball, obstacle, contact])
    vv.simulate(system, until=0.1, step=way / 20.0)
    assert vv.Position(of=ball)(system)[0] < 0
