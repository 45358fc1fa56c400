"""Bodies and points that come down beside an edge: they stay with the side that they came in by."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import visviva as vv
from visviva.study.run import run

HALF = 0.13
"""Of a cube that others fall on."""

EDGES = (1e-9, 1e-5, 1e-3, 0.01, 0.02)
"""Distances from an edge; the last two are less than and about a step's way."""


def cube(kind: str) -> tuple[Any, list[Any]]:
    """The cube, exact or by its facets, and what holds it."""
    shape = vv.Box(size=(2 * HALF,) * 3)
    if kind == "exact":
        obstacle = vv.Obstacle(shape=shape)
        return obstacle, [obstacle]
    points, triangles = shape.surface()
    body = vv.RigidBody(shape=vv.SurfaceMesh(points=points, triangles=triangles), density=1e3)
    ground = vv.Ground()
    return body, [ground, body, vv.Rigid(a=ground, b=body, at=(0, 0, 0))]


def falling(kind: str, x: float, y: float, gap: float, speed: float) -> Any:
    """Something whose outermost points are x and y inside of the edges, its lowest ones `gap` above the cube."""
    x, y, z, v = HALF - x, HALF - y, HALF + gap, (0, 0, -speed)
    if kind == "point":
        return vv.PointMass(mass=1.0, position=(x, y, z), velocity=v)
    if kind == "ball":
        return vv.RigidBody(shape=vv.Sphere(radius=0.02), density=1e3, position=(x, y, z + 0.02), velocity=v)
    return vv.RigidBody(
        shape=vv.Box(size=(2 * x, 2 * y, 0.2)), density=1e3, position=(0, 0, z + 0.1), velocity=v
    )


def velocity(system: vv.System, body: Any) -> Any:
    start = body.point().position[0].weights[0][0]
    return system.v[start : start + 3]


@pytest.mark.parametrize("target", ["exact", "facets"])
@pytest.mark.parametrize("kind", ["point", "ball", "box"])
@pytest.mark.parametrize(
    ("enforcement", "left"), [("multipliers", 0.5), ("penalty", 1.0)], ids=["multipliers", "penalty"]
)
def test_what_falls_beside_an_edge_bounces(kind: str, target: str, enforcement: str, left: float) -> None:
    """By its restitution, with a penalty by the energy that is conserved, at all distances from edges and corners; and
    where steps end at the surface to rounding."""
    share: dict[str, Any] = {"restitution": 0.5} if enforcement == "multipliers" else {}
    for x in EDGES:
        for y in (1e-9, 0.02):
            for gap, speed, h in ((0.05, 1, 0.01), (0.0437, 3, 0.01), (0.0437, 1, 0.002)):
                second, held = cube(target)
                body = falling(kind, x, y, gap, speed)
                contact = vv.Contact(
                    first=body,
                    second=second,
                    formulation="node-to-segment",
                    enforcement=enforcement,
                    stiffness=1e6,
                    **share,
                )
                system = vv.System([body, *held, contact])
                result = vv.simulate(system, until=0.12, step=h)
                assert velocity(system, body) == pytest.approx([0, 0, left * speed], abs=1e-6 * speed)
                result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("kind", ["box", "point", "ball"])
def test_bodies_of_equal_size_meet_face_to_face(kind: str) -> None:
    """Corners come down on corners; a point or the middle of a ball there would slide along the edge, or bounces."""
    x = 0.0 if kind != "point" else 1e-12
    for gap in (0.05, 0.0437):
        for target in ("exact", "facets"):
            second, held = cube(target)
            body = falling(kind, x, x, gap, 1)
            contact = vv.Contact(
                first=body, second=second, formulation="node-to-segment", stiffness=1e5, restitution=0.5
            )
            system = vv.System([body, *held, contact])
            vv.simulate(system, until=0.12, step=0.01)
            assert velocity(system, body) == pytest.approx([0, 0, 0.5], abs=1e-9)


def test_box_rests_on_a_larger_one() -> None:
    """After bounces with half of the velocity each, a box that was let go 5 cm above: it passed through."""
    box = vv.RigidBody(shape=vv.Box(size=(0.24,) * 3), density=1e3, position=(0, 0, HALF + 0.12 + 0.05))
    obstacle = vv.Obstacle(shape=vv.Box(size=(2 * HALF,) * 3))
    contact = vv.Contact(
        first=box, second=obstacle, formulation="node-to-segment", stiffness=1e5, restitution=0.5
    )
    system = vv.System([box, obstacle, contact, vv.Gravity()])
    result = vv.simulate(system, until=1.0, step=0.01)
    assert system.x[2] == pytest.approx(HALF + 0.12, abs=9.81 * 0.01**2)
    assert abs(system.v[2]) < 1e-4
    result.assert_conserved("energy", tolerance=1e-12)


def impact(place: Any, v: Any) -> tuple[int, float] | None:
    """The side that a straight way comes into the cube by, and how deep it is half way through."""
    enter, leave = (-np.sign(v) * HALF - place) / v, (np.sign(v) * HALF - place) / v
    side, begin, end = int(np.argmax(enter)), enter.max(), leave.min()
    if begin >= end:
        return None
    return side, HALF - np.abs(place + 0.5 * (begin + end) * v).max()


@pytest.mark.parametrize(("target", "n"), [("exact", 150), ("facets", 60)])
def test_points_that_cut_across_edges_bounce_off_the_side_they_met(target: str, n: int) -> None:
    """Many ways lead through an edge within a step or two; those less deep than a fiftieth of a step may be missed."""
    rng = np.random.default_rng(7)
    met = 0
    while met < n:
        side, other = rng.permutation(3)[:2]
        place, v = rng.uniform(-HALF, HALF, 3), rng.normal(size=3)
        place[side] = HALF * rng.choice((-1, 1))
        place[other] = (HALF - 10 ** rng.uniform(-5, -1.7)) * rng.choice((-1, 1))
        v[side] = -abs(v[side]) * np.sign(place[side])
        v *= 10 ** rng.uniform(-0.5, 0.7) / np.linalg.norm(v)
        h = 10 ** rng.uniform(-3, -1.7)
        n_steps = rng.integers(2, 6) + rng.uniform()
        start = place - n_steps * h * v
        found = impact(start, v)
        if found is None or found[1] < 0.02 * h * np.linalg.norm(v):
            continue
        second, held = cube(target)
        point = vv.PointMass(mass=1.0, position=start, velocity=v)
        contact = vv.Contact(
            first=point, second=second, formulation="node-to-segment", stiffness=1e5, restitution=0.5
        )
        system = vv.System([point, *held, contact])
        vv.simulate(system, until=(n_steps + 4) * h, step=h)
        v[found[0]] *= -0.5
        np.testing.assert_allclose(velocity(system, point), v, atol=1e-6 * np.linalg.norm(v))
        met += 1


@pytest.mark.parametrize("cells", [1, 2])
def test_flexible_block_does_not_pass_one_that_is_little_larger(cells: int) -> None:
    """Its corners go in by more than they are from the edges in the first step."""
    size = 0.24
    mesh = vv.BoxMesh(size=(size,) * 3, counts=(cells,) * 3, origin=(-size / 2, -size / 2, HALF + 0.0437))
    block = vv.Solid(
        mesh=mesh, material=vv.NeoHooke(young=1e7, poisson=0.3), density=1e3, velocity=(0, 0, -3)
    )
    obstacle = vv.Obstacle(shape=vv.Box(size=(2 * HALF,) * 3))
    system = vv.System([block, obstacle, vv.Contact(first=block, second=obstacle, impact="conserving")])
    result = vv.simulate(system, until=0.1, step=0.01)
    assert result.ledger["momentum_z"][-1] > 0
    result.assert_conserved("energy", tolerance=1e-10)


@pytest.mark.parametrize("target", ["exact", "facets"])
@pytest.mark.parametrize("end", [0.395, 0.405, 0.41])
def test_runs_beside_edges_are_resumed_to_the_bit(target: str, end: float, tmp_path: Path) -> None:
    """A point that is thrown up beside the cube and comes down on it knows the side that it came in by, which is not
    that on the straight way from its first place."""

    def study(until: float) -> vv.Study:
        second, held = cube(target)
        v = np.array([-0.055 / 0.4, 0, (HALF - 0.004) / 0.4 + 0.5 * 9.81 * 0.4])
        point = vv.PointMass(mass=1.0, position=(HALF + 0.05, 0.01, 0), velocity=v)
        contact = vv.Contact(first=point, second=second, formulation="node-to-segment", stiffness=1e5)
        return vv.Study(vv.System([point, *held, contact, vv.Gravity()]), until, 0.005)

    whole = run(study(0.45), tmp_path / "whole", pictures=False)
    run(study(end), tmp_path / "parts", pictures=False)
    parts = run(study(0.45), tmp_path / "parts", resume=True, pictures=False)
    assert whole.system.x[2] == pytest.approx(HALF, abs=0.01)
    for name in ("x", "v"):
        np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


@pytest.mark.parametrize("size", [0.3, 0.6, 0.7])
def test_stacked_boxes_of_equal_size_rest(size: float) -> None:
    """They overlap at the start by the rounding of their places, which is nothing beside their size."""
    one, two = (
        vv.RigidBody(shape=vv.Box(size=(size,) * 3), density=1e3, position=(0, 0, z))
        for z in (size / 2, size + size / 2)
    )
    plane = vv.Plane()
    contacts = [
        vv.Contact(first=first, second=second, formulation="node-to-segment", stiffness=1e5)
        for first, second in ((one, plane), (two, one))
    ]
    system = vv.System([plane, one, two, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.5, step=0.01)
    assert system.value(two.point().position) == pytest.approx([0, 0, 1.5 * size], abs=1e-12)


def test_overlap_of_rigid_bodies_is_refused() -> None:
    """By more than a millionth of the shape."""
    box, plane = (
        vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1e3, position=(0, 0, 0.5 - 2e-6)),
        vv.Plane(),
    )
    system = vv.System([box, plane, vv.Contact(first=box, second=plane, stiffness=1e5)])
    with pytest.raises(vv.InputError, match="overlap by 2e-06"):
        vv.simulate(system, until=0.1, step=0.01)


def test_steps_at_edges_fail_where_they_meet() -> None:
    """The failure of a pair of edges tells their place; it had taken the pair's number for one of a vertex."""
    pyramid = [*((x, y, 0.0) for x in (-0.2, 0.2) for y in (-0.2, 0.2)), (0.0, 0.0, 0.4)]
    sides = [(0, 1, 2), (1, 3, 2), (1, 0, 4), (3, 1, 4), (2, 3, 4), (0, 2, 4)]
    shape = vv.SurfaceMesh(points=pyramid, triangles=sides)
    held = vv.RigidBody(shape=shape, density=1.0, position=(100, 0, 0))
    turned = Rotation.from_rotvec((1e-3, np.pi / 4, 1e-3)).as_matrix()
    thrown = vv.RigidBody(
        shape=shape, density=1.0, position=(100, -0.55, 0), rotation=turned, velocity=(0, 1000, 0)
    )
    contact = vv.Contact(first=held, second=thrown, enforcement="penalty", stiffness=5.0)
    with pytest.raises(vv.StepFailure) as failure:
        vv.simulate(vv.System([held, thrown, contact]), until=0.01, step=1e-3)
    place = re.search(r"near \(([-\d.e+, ]+)\)", str(failure.value))
    assert place is not None
    assert np.linalg.norm(np.array(place[1].split(","), float) - (100, 0, 0)) < 1.0
