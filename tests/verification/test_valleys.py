"""What lies between facets that lean together is held by all of them, and does not sink."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.study.run import run

Array = NDArray[np.float64]
G = 9.81
R = 0.2
HELD = ["rigid", "clamped"]


def ground_of(heights: Array, x: Array, y: Array) -> vv.Mesh:
    """A layer of bricks from z = -0.5 up to these heights (y, x)."""
    nx = len(x)
    points = [
        (a, b, z)
        for b, row in zip(y, heights, strict=True)
        for a, t in zip(x, row, strict=True)
        for z in (-0.5, t)
    ]

    def node(i: int, j: int, k: int) -> int:
        return 2 * (j * nx + i) + k

    around = ((0, 0), (1, 0), (1, 1), (0, 1))
    cells = [
        [node(i + a, j + b, k) for k in (0, 1) for a, b in around]
        for j in range(len(y) - 1)
        for i in range(nx - 1)
    ]
    return vv.Mesh(np.array(points), {"hex8": np.array(cells)})


def groove(left: float, right: float) -> vv.Mesh:
    """Two walls with these slopes that lean together over x = 0."""
    return ground_of(np.array([[left, 0, right]] * 2), np.array([-1.0, 0, 1]), np.array([-0.5, 0.5]))


def pit() -> vv.Mesh:
    """Four faces, each of two triangles and more, that lean together over the origin."""
    heights = np.full((3, 3), 0.5)
    heights[1, 1] = 0.0
    return ground_of(heights, *[np.array([-1.0, 0, 1])] * 2)


def rails() -> vv.Mesh:
    """Two edges along y, at x = -0.1 and 0.1."""
    heights = np.array([[-0.3, 0.0, -0.3, 0.0, -0.3]] * 2)
    return ground_of(heights, np.array([-0.5, -0.1, 0, 0.1, 0.5]), np.array([-0.5, 0.5]))


def lain(mesh: vv.Mesh, place: Any, radius: float, held: str = "rigid", **options: Any) -> tuple[Any, ...]:
    """A point or ball of 1 kg above a solid, and where it is."""
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=100.0)
    nodes = np.flatnonzero(mesh.points[:, 2] < -0.4)
    rider: Any = (
        vv.RigidBody(shape=vv.Sphere(radius=radius), mass=1.0, position=place)
        if radius
        else vv.PointMass(mass=1.0, position=place)
    )
    contact = vv.Contact(first=rider, second=solid, formulation="node-to-segment", stiffness=1e4, **options)
    parts = [solid, vv.Fixed(solid=solid, nodes="all" if held == "rigid" else nodes), rider, contact]
    return vv.System([*parts, vv.Gravity(acceleration=(0, 0, -G))]), vv.Position(of=rider), contact


def distance_to_triangle(p: Array, corners: Array) -> float:
    """Of a point, negative behind it."""
    a, b, c = corners
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n)
    height = float((p - a) @ n)
    foot, sides = p - height * n, ((a, b), (b, c), (c, a))
    if all(np.cross(v - u, foot - u) @ n >= 0 for u, v in sides):
        return height
    shares = [np.clip((p - u) @ (v - u) / ((v - u) @ (v - u)), 0, 1) for u, v in sides]
    return min(float(np.linalg.norm(p - u - t * (v - u))) for t, (u, v) in zip(shares, sides, strict=True))


def overlaps(result: Any, solid: Any, rider: Any, radius: float, every: int) -> Array:
    """Of a ball with the top of a block, whose faces are four triangles about their mean."""
    points = np.asarray(solid.mesh.build().points)
    quads = [q for q in solid.mesh.build().boundary().cells["quad4"] if (points[q, 2] > -1e-9).all()]
    found = []
    for state, centre in list(zip(result.states, result.history(vv.Position(of=rider)), strict=True))[
        ::every
    ]:
        here = solid.positions(state)
        near = [
            distance_to_triangle(centre, np.array([q[i], q[(i + 1) % 4], q.mean(axis=0)]))
            for q in here[np.array(quads)]
            for i in range(4)
        ]
        found.append(radius - min(near))
    return np.array(found)


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("slopes", [(1.0, 1.0), (0.3, 1.0), (2.0, 0.5)])
@pytest.mark.parametrize("options", [{}, {"restitution": 0.5}, {"restitution": 1.0}], ids=str)
@pytest.mark.parametrize("held", HELD)
def test_a_point_stays_above_a_groove(held: str, options: dict[str, Any], slopes: Any, step: float) -> None:
    """It lay on one wall and sank into the other: in 2 s it had fallen by 16 m, in either kind of ground."""
    drop = 0.05
    system, position, _ = lain(groove(*slopes), (0.01, 0.13, slopes[1] * 0.01 + drop), 0.0, held, **options)
    result = vv.simulate(system, until=2.0, step=step)
    x, _, z = result.history(position).T
    above = [(z + slope * side * x) / np.hypot(slope, 1) for side, slope in zip((1, -1), slopes, strict=True)]
    speed = np.sqrt(2 * G * (drop + 0.02))
    give = 0.0 if held == "rigid" else 0.005
    assert np.min(above) > -1.5 * step * speed - give
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-13 * np.abs(total).max()


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("slopes", [(1.0, 1.0), (0.3, 1.0), (2.0, 0.5)])
def test_both_walls_carry_a_ball(slopes: Any, step: float) -> None:
    """Their forces have the ratio of the sines of the other one's angle, whatever the impacts have left."""
    angles = np.arctan(slopes)
    x, z = np.linalg.solve([(slopes[0], 1), (-slopes[1], 1)], R / np.cos(angles))
    system, _, contact = lain(groove(*slopes), (x, 0.13, z + 0.05), R)
    vv.simulate(system, until=3.0, step=step)
    np.testing.assert_allclose(contact.forces, [(0, 0, G)], atol=1e-9)
    left, right = np.sin(angles[::-1]) / np.sin(angles.sum()) * G
    assert contact.pressures == pytest.approx([left + right], rel=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("mesh", [pit, rails])
@pytest.mark.parametrize("step", [0.01, 0.005])
def test_a_ball_rests_in_a_pit_and_on_rails(step: float, mesh: Any, friction: float) -> None:
    """Where it touches eight triangles at once, or two edges: the height of its middle is a closed form."""
    high = R * np.sqrt(1 + 0.5**2 + 0.25**2) if mesh is pit else np.sqrt(R**2 - 0.1**2)
    system, position, contact = lain(
        mesh(), (0, 0.02 if mesh is rails else 0, high + 0.05), R, friction=friction
    )
    result = vv.simulate(system, until=2.0, step=step)
    z = result.history(position)[:, 2]
    assert z.min() > high - 1.5 * step * np.sqrt(2 * G * 0.05) * np.hypot(0.5, 1)
    assert np.ptp(z[len(z) // 2 :]) < 1e-9
    np.testing.assert_allclose(contact.forces, [(0, 0, G)], atol=1e-4)
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * np.abs(total).max()


@pytest.mark.parametrize(("held", "step"), [("rigid", 0.01), ("rigid", 0.005), ("clamped", 0.01)])
def test_a_box_lies_in_a_groove(held: str, step: float) -> None:
    """With an edge down, tilted a little: it went through the ground by 0.2 in 2 s."""
    angle, size, low = 0.275 * np.pi, 0.3, 0.2421
    mesh = groove(1.0, 1.0)
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=100.0)
    nodes = "all" if held == "rigid" else np.flatnonzero(mesh.points[:, 2] < -0.4)
    c, s = np.cos(angle), np.sin(angle)
    turned = ((c, 0, s), (0, 1, 0), (-s, 0, c))
    shape = vv.Box(size=(size,) * 3)
    box = vv.RigidBody(shape=shape, mass=1.0, position=(0.013, 0, low), rotation=turned)
    contact = vv.Contact(first=box, second=solid, formulation="node-to-segment", stiffness=1e4)
    gravity = vv.Gravity(acceleration=(0, 0, -G))
    system = vv.System([solid, vv.Fixed(solid=solid, nodes=nodes), box, contact, gravity])
    result = vv.simulate(system, until=2.0, step=step)
    z = result.history(vv.Position(of=box))[:, 2]
    assert z.min() > size / np.sqrt(2) - 1.5 * step * np.sqrt(2 * G * 0.03)
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * np.abs(total).max()


def spike(n: int) -> vv.SurfaceMesh:
    """A cone with its tip down at the origin and so many corners at its rim."""
    angles = 2 * np.pi * np.arange(n) / n
    points = [(0, 0, 0), *((0.1 * np.cos(a), 0.1 * np.sin(a), 0.2) for a in angles), (0, 0, 0.2)]
    around = [(1 + i, 1 + (i + 1) % n) for i in range(n)]
    triangles = [f for i, j in around for f in ((0, j, i), (n + 1, i, j))]
    return vv.SurfaceMesh(points=points, triangles=triangles)


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("n", [10, 24])
@pytest.mark.parametrize("ground", ["groove", "pit"])
def test_bodies_of_many_vertices_do_not_sink(ground: str, n: int, step: float) -> None:
    """A cone that falls on its tip and topples: in a groove it went in by all its height, 0.2."""
    mesh, steep = (groove(1.0, 1.0), 1.0) if ground == "groove" else (pit(), 0.5)
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=100.0)
    place, shape = np.array((0.011, 0.007, 0.011 * steep + 0.02)), spike(n)
    cone = vv.RigidBody(shape=shape, mass=1.0, position=tuple(place))
    contact = vv.Contact(first=cone, second=solid, formulation="node-to-segment", stiffness=1e4)
    gravity = vv.Gravity(acceleration=(0, 0, -G))
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="all"), cone, contact, gravity])
    result = vv.simulate(system, until=1.0, step=step)
    for point in shape.points:
        x, y, z = result.history(vv.Position(of=cone, at=tuple(place + point))).T
        low = np.abs(x)
        if ground == "pit":  # within its corners each face is two triangles
            low = np.maximum(low, np.abs(y)) + 0.5 * np.minimum(low, np.abs(y))
        assert ((z - steep * low) / np.hypot(steep, 1)).min() > -1.5 * step * np.sqrt(2 * G * 0.17)
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * np.abs(total).max()


def ball_on_rubber(n: tuple[int, int, int], **options: Any) -> tuple[vv.System, Any, Any, Any]:
    size = (1.0, 1.0, 0.3)
    mesh = vv.BoxMesh(size=size, counts=n, origin=(-0.5, -0.5, -0.3))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e4, poisson=0.3), density=100.0)
    ball = vv.RigidBody(shape=vv.Sphere(radius=R), mass=10.0, position=(0, 0, R))
    contact = vv.Contact(first=ball, second=block, second_faces="z1", **options)
    held = vv.Fixed(solid=block, nodes="z0")
    return vv.System([block, ball, contact, held, vv.Gravity(acceleration=(0, 0, -G))]), block, ball, contact


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("n", [(2, 2, 1), (4, 4, 2)], ids=str)
def test_a_ball_does_not_sink_into_soft_rubber(n: tuple[int, int, int], step: float) -> None:
    """By 0.13 it did in 2 s, and through the block in 4 s."""
    system, block, ball, _ = ball_on_rubber(n)
    result = vv.simulate(system, until=2.0, step=step)
    found = overlaps(result, block, ball, R, every=10)
    assert found.max() < 1.5 * step * 0.5  # it comes in by half a metre per second
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * np.abs(total).max()


@pytest.mark.parametrize("n", [(2, 2, 1), (4, 4, 2)], ids=str)
def test_a_ball_comes_to_rest_on_soft_rubber(n: tuple[int, int, int]) -> None:
    """Where penalties of growing stiffness k leave it, but for 1 / k."""

    def rest(**options: Any) -> tuple[float, Any]:
        system, _, ball, contact = ball_on_rubber(n, **options)
        result = vv.simulate(system, until=4.0, step=0.01, scheme=vv.BackwardEuler())
        return float(result.history(vv.Position(of=ball))[-1, 2]), contact

    soft, stiff = (rest(enforcement="penalty", stiffness=k)[0] for k in (1e4, 3e4))
    z, contact = rest()
    assert z == pytest.approx(stiff + (stiff - soft) / 2, abs=1e-3)
    np.testing.assert_allclose(contact.forces, [(0, 0, 10 * G)], atol=2e-2)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_resumed_run_is_the_same(friction: float, tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        system, *_ = lain(groove(0.5, 1.0), (0.02, 0.1, 0.32), R, "clamped", friction=friction)
        return vv.Study(system, until, 0.01)

    whole = run(study(0.6), tmp_path / "whole", pictures=False)
    for end in (0.2, 0.35):
        run(study(end), tmp_path / "parts", resume=end > 0.2, pictures=False)
    parts = run(study(0.6), tmp_path / "parts", resume=True, pictures=False)
    for name in ("x", "v"):
        np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


def room(profile: Any) -> vv.RigidBody:
    """A rigid body with this section, (x, z), whose first corner sees all others."""
    n = len(profile)
    points = [(x, y, z) for y in (-1, 1) for x, z in profile]
    front = [(0, i, i + 1) for i in range(1, n - 1)]
    sides = [f for i in range(n) for j in [(i + 1) % n] for f in ((i, n + i, j), (j, n + i, n + j))]
    triangles = [*front, *((n + a, n + c, n + b) for a, b, c in front), *sides]
    return vv.RigidBody(shape=vv.SurfaceMesh(points=points, triangles=triangles), density=1e3)


ROOMS: dict[str, Any] = {
    "corner": [(0, 0), (-2, 0), (-2, -0.5), (0.5, -0.5), (0.5, 1), (0, 1)],
    "groove": [(0, 0), (-1, 1), (-1, -1), (1, -1), (1, 1)],
}
RIDERS: dict[str, Any] = {
    "point": vv.PointMass,
    "ball": partial(vv.RigidBody, shape=vv.Sphere(radius=0.1)),
    "box": partial(vv.RigidBody, shape=vv.Box(size=(0.2, 0.2, 0.2))),
}


@pytest.mark.parametrize("step", [0.01, 0.001])
@pytest.mark.parametrize("where", ROOMS)
@pytest.mark.parametrize("rider", RIDERS)
def test_what_bounces_in_rooms_by_a_penalty_keeps_its_energy(rider: str, where: str, step: float) -> None:
    """From wall to wall penetrations jumped: balls gained 0.2 J of 5 J in a second, and nothing was refused."""
    r = {"point": 0.0, "ball": 0.1, "box": 0.1}[rider]
    in_corner, in_groove = (
        (-0.5 - r, 0.01, r + 1e-3),
        (0.1, 0.01, 0.1 + (3 if rider == "box" else np.sqrt(2)) * r + 1e-3),
    )
    place, velocity = (in_corner, (1.0, 0.1, 0)) if where == "corner" else (in_groove, (0.3, 0.1, 0))
    body, ground, walls = (
        RIDERS[rider](mass=1.0, position=place, velocity=velocity),
        vv.Ground(),
        room(ROOMS[where]),
    )
    contact = vv.Contact(
        first=body, second=walls, enforcement="penalty", formulation="node-to-segment", stiffness=1e4
    )
    weld = vv.Rigid(a=ground, b=walls, at=(0, 0, 0))
    system = vv.System([ground, walls, weld, body, contact, vv.Gravity()])
    pressed: list[float] = []
    result = vv.simulate(
        system, until=1.0, step=step, observe=lambda _: pressed.append(contact.pressures.max())
    )
    assert max(pressed) > 0
    result.assert_conserved("energy", tolerance=1e-11)


@pytest.mark.parametrize("n", [(2, 2, 1), (4, 4, 2)], ids=str)
def test_a_ball_that_rolls_in_the_dent_of_soft_rubber_by_a_penalty_keeps_its_energy(
    n: tuple[int, int, int],
) -> None:
    """It gained as much as there was."""
    system, _, ball, _ = ball_on_rubber(n, enforcement="penalty", stiffness=1e4)
    ball.position, ball.velocity = np.array([0.03, 0.01, R]), np.array([0.1, 0.05, 0])
    system.reset()
    vv.simulate(system, until=0.5, step=0.01).assert_conserved("energy", tolerance=1e-11)
