"""Free boxes of about the same height that collide by a penalty, against two plane bodies on springs."""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

import visviva as vv

HALF, HEIGHT, MASS, STIFFNESS = 0.2, 0.1, 16.0, 1e7
INERTIA = MASS * (2 * HALF) ** 2 / 6


@cache
def plane_collision(friction: float, stiffness: float, aside: float = 0.1, step: float = 1e-6) -> Any:
    """Velocities (vx, vy, wz) of both after the collision, and the energy that it takes.

    One corner of each touches the side of the other one, by two springs above each other across it, and stiff ones
    along it.
    """
    q = np.array([[-2 * HALF, aside, 0.0], [0.0, 0.0, 0.0]])
    v = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    masses, k, stiff, slips = np.array([MASS, MASS, INERTIA]), 2 * stiffness, 100, [0.0, 0.0]
    for _ in range(int(0.01 / step)):
        force = np.zeros((2, 3))
        for own, other in ((0, 1), (1, 0)):
            sign = 1 if own == 0 else -1  # of x, towards the other one
            c, s = np.cos(q[own, 2]), np.sin(q[own, 2])
            corner = np.array([c * sign * HALF + s * sign * HALF, s * sign * HALF - c * sign * HALF])
            n = np.array([np.cos(q[other, 2]), np.sin(q[other, 2])]) * sign
            t = np.array([-n[1], n[0]])
            place = q[own, :2] + corner
            arm = place - q[other, :2]
            depth = n @ arm + HALF
            if depth <= 0:
                slips[own] = 0.0
                continue
            rate = v[own, :2] - v[other, :2]
            rate = rate + v[own, 2] * np.array([-corner[1], corner[0]])
            rate = rate - v[other, 2] * np.array([-arm[1], arm[0]])
            most = friction * depth / stiff
            slips[own] = float(np.clip(slips[own] + step * t @ rate, -most, most))
            f = -k * (depth * n + stiff * slips[own] * t)
            force[own] += [*f, corner[0] * f[1] - corner[1] * f[0]]
            force[other] -= [*f, arm[0] * f[1] - arm[1] * f[0]]
        v += step * force / masses
        q += step * v
    return v, 0.5 * MASS - 0.5 * (masses * v**2).sum()


def collide(
    step: float, up: float, rise: float, friction: float, swaps: bool, shape: str
) -> tuple[Any, Any, float]:
    """Velocities and angular velocities of both, and the energy lost. The first comes `up` lower, and rises."""
    box: Any = vv.Box(size=(2 * HALF, 2 * HALF, HEIGHT))
    if shape == "mesh":
        points, triangles = box.surface()
        box = vv.SurfaceMesh(points=points, triangles=triangles)
    way = 0.04
    one = vv.RigidBody(
        shape=box, density=1e3, position=(-2 * HALF - way, 0.1, -rise * way), velocity=(1, 0, rise)
    )
    two = vv.RigidBody(shape=box, density=1e3, position=(0, 0, up))
    first, second = (two, one) if swaps else (one, two)
    contact = vv.Contact(
        first=first, second=second, enforcement="penalty", stiffness=STIFFNESS, friction=friction
    )
    system = vv.System([one, two, contact])
    result = vv.simulate(system, until=0.07, step=step)
    result.assert_conserved("momentum_x", "momentum_z", "angular_y", "angular_z", tolerance=1e-9)
    total = result.ledger["total"]
    velocities = [np.array(vv.Velocity(of=body)(system)) for body in (one, two)]
    spins = [np.array(vv.AngularVelocity(of=body)(system)) for body in (one, two)]
    return velocities, spins, float(total[0] - total[-1])


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_boxes_of_one_height_collide_in_their_plane(step: float, friction: float) -> None:
    """Or of heights that rounding tells apart, or little more: of 8 J up to 2.5 were lost, and they tumbled."""
    expected, lost = plane_collision(friction, STIFFNESS)
    for up, swaps in product((0.0, 1e-9, 1e-7, -1e-7, 3e-7, 1e-6, -1e-5), (False, True)):
        velocities, spins, energy = collide(step, up, 0.0, friction, swaps, "box")
        for body in (0, 1):
            assert velocities[body] == pytest.approx([*expected[body, :2], 0], abs=5e-3)
            assert spins[body] == pytest.approx([0, 0, expected[body, 2]], abs=2e-2)
        assert energy == pytest.approx(lost if friction else 0, abs=1e-2 if friction else 1e-9)


@pytest.mark.parametrize("shape", ["box", "mesh"])
@pytest.mark.parametrize("part", [0.5, 1.0, 5**0.5 / 2, 1.25])
def test_no_offset_is_one_at_which_rounding_tells_what_holds(part: float, shape: str) -> None:
    """Of what is flush up to some ten-millionth of a box's half height: at a limit both corners and edges held, or
    neither, and 0.5 of 8 J were lost there; the widest gaps between such offsets end at 1.25 of it."""
    expected, _ = plane_collision(0.0, STIFFNESS)
    limit = 2e-6 * HEIGHT / 2
    for number, beside in enumerate((0.0, 1e-16, 1e-12, -1e-12, 1e-9, -1e-9)):
        up, swaps = (-1) ** number * (part * limit + beside), number % 3 == 0
        velocities, spins, energy = collide(1e-3, up, 0.0, 0.0, swaps, shape)
        for body in (0, 1):
            assert velocities[body] == pytest.approx([*expected[body, :2], 0], abs=5e-3)
            assert spins[body] == pytest.approx([0, 0, expected[body, 2]], abs=2e-2)
        assert abs(energy) < 1e-9


@pytest.mark.parametrize("shape", ["box", "mesh"])
@pytest.mark.parametrize("up", [1e-5, 5e-5, 2e-4])
def test_corners_that_slide_over_borders_go_on_with_what_they_hold(up: float, shape: str) -> None:
    """As boxes pass each other's height while they touch: edges take over from corners and these from edges, half of
    the energy was lost between them."""
    expected, _ = plane_collision(0.0, STIFFNESS)
    for rise, step in product((0.02, 0.1), (1e-3, 5e-4)):
        velocities, spins, energy = collide(step, up, rise, 0.0, False, shape)
        for body in (0, 1):
            assert velocities[body][:2] == pytest.approx(expected[body, :2], abs=5e-3)
            assert spins[body] == pytest.approx([0, 0, expected[body, 2]], abs=2e-2)
        assert abs(energy) < 1e-9


def test_boxes_that_collide_on_one_floor_lose_what_friction_takes() -> None:
    """That of the floor, mu m g times the way that both go, and of the collision; 3.9 J were lost."""
    floor = vv.RigidBody(shape=vv.Box(size=(3, 1, 0.1)), density=1e3, position=(0, 0, -0.05))
    box, ground, friction = vv.Box(size=(0.4, 0.4, 0.1)), vv.Ground(), 0.1
    one = vv.RigidBody(shape=box, density=1e3, position=(-0.44, 0.1, 0.05), velocity=(1, 0, 0))
    two = vv.RigidBody(shape=box, density=1e3, position=(0, 0, 0.05))
    contacts = [
        vv.Contact(first=a, second=b, enforcement="penalty", stiffness=STIFFNESS, friction=friction)
        for a, b in ((one, floor), (two, floor), (one, two))
    ]
    held = vv.Rigid(a=ground, b=floor, at=(0, 0, 0))
    system = vv.System([ground, floor, one, two, held, *contacts, vv.Gravity()])
    result = vv.simulate(system, until=0.1, step=1e-3)
    (_, lost), energy = plane_collision(friction, STIFFNESS), result.ledger["total"]
    way = 0.1  # at 1 m/s first the one and then mainly the other, little less for what the friction takes
    assert energy[0] - energy[-1] == pytest.approx(lost + friction * MASS * 9.81 * way, rel=0.07)


@pytest.mark.parametrize("step", [0.002, 0.0005, 0.0002])
def test_faces_that_meet_upright_push_nothing_down(step: float) -> None:
    """Edges deep in each other, as the smaller box turns, held it from there: it went down at 0.7 m/s."""
    large = vv.RigidBody(
        shape=vv.Box(size=(0.4, 0.25, 0.17)), density=1000.0, position=(-0.29, 0, 0.1), velocity=(1, 0, 0)
    )
    small = vv.RigidBody(shape=vv.Box(size=(0.16, 0.13, 0.12)), density=1000.0, position=(0, 0, 0))
    contact = vv.Contact(first=large, second=small, enforcement="penalty", stiffness=1e7)
    system = vv.System([large, small, contact])
    vv.simulate(system, until=0.05, step=step)
    velocity, spin = (np.array(of(of=small)(system)) for of in (vv.Velocity, vv.AngularVelocity))
    assert velocity == pytest.approx([1.5, 0, 0], abs=0.15)
    assert abs(velocity[2]) < 0.1  # across the faces nothing pushes
    assert spin[1] > 5  # it was hit above its centre


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
@pytest.mark.parametrize("swaps", [False, True])
@pytest.mark.parametrize("size", [(0.175, 0.385), (0.4, 0.3)])
def test_boxes_that_meet_head_on_on_one_floor(size: tuple[float, float], swaps: bool, step: float) -> None:
    """As points of their masses, each braked by the floor before and after. They sink into that by different depths:
    upper ends of edges below tops beside them passed for lower ends of what lies on these, and 1.9 J were lost."""
    floor = vv.RigidBody(shape=vv.Box(size=(3, 1, 0.1)), density=1e3, position=(0, 0, -0.05))
    gap, friction, until, ground = 1e-3, 0.1, 0.07, vv.Ground()
    shapes = vv.Box(size=(*size, HEIGHT)), vv.Box(size=(0.4, 0.4, HEIGHT))
    place = -0.2 - size[0] / 2 - gap
    one = vv.RigidBody(shape=shapes[0], density=1e3, position=(place, 0, HEIGHT / 2), velocity=(1, 0, 0))
    two = vv.RigidBody(shape=shapes[1], density=1e3, position=(0, 0, HEIGHT / 2))
    pair = (two, one) if swaps else (one, two)
    contacts = [
        vv.Contact(first=a, second=b, enforcement="penalty", stiffness=STIFFNESS, friction=friction)
        for a, b in ((one, floor), (two, floor), pair)
    ]
    system = vv.System(
        [ground, floor, one, two, vv.Rigid(a=ground, b=floor, at=(0, 0, 0)), *contacts, vv.Gravity()]
    )
    vv.simulate(system, until=until, step=step)
    masses, braked = np.array([1e3 * size[0] * size[1] * HEIGHT, MASS]), friction * 9.81 * (until - gap)
    share = masses[0] / masses.sum()
    after = (2 * share - 1) + (braked if 2 * share < 1 else -braked), 2 * share - braked
    for body, expected in zip((one, two), after, strict=True):
        assert vv.Velocity(of=body)(system) == pytest.approx([expected, 0, 0], abs=1.5e-2)
        assert vv.AngularVelocity(of=body)(system) == pytest.approx([0, 0, 0], abs=0.1)


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
def test_an_upper_box_that_hits_the_upper_one_of_another_stack_stops(step: float) -> None:
    """Equal boxes exchange their velocities, and nothing below moves: 2 of 8 J were lost at one of the steps."""
    floor = vv.RigidBody(shape=vv.Box(size=(3, 1, 0.1)), density=1e3, position=(0, 0, -0.05))
    box, ground = vv.Box(size=(0.4, 0.4, HEIGHT)), vv.Ground()
    places = [(x, 0, z) for x in (-0.42, 0.0) for z in (HEIGHT / 2, 3 * HEIGHT / 2)]
    speeds = (0, 1, 0, 0)
    bodies = [
        vv.RigidBody(shape=box, density=1e3, position=place, velocity=(speed, 0, 0))
        for place, speed in zip(places, speeds, strict=True)
    ]
    low, thrown, under, hit = bodies
    pairs = ((low, floor), (under, floor), (thrown, low), (hit, under), (low, under), (thrown, hit))
    contacts = [vv.Contact(first=a, second=b, enforcement="penalty", stiffness=STIFFNESS) for a, b in pairs]
    held = vv.Rigid(a=ground, b=floor, at=(0, 0, 0))
    system = vv.System([ground, floor, *bodies, held, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.06, step=step)
    for body, expected in zip(bodies, (0, 0, 0, 1), strict=True):
        assert vv.Velocity(of=body)(system)[0] == pytest.approx(expected, abs=1e-2)
