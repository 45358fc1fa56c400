"""Rigid bodies that land tilted on each other touch where they are, or the step fails and names the cure."""

from __future__ import annotations

from contextlib import suppress
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coarse import bar, coarse_plate
from scipy.spatial.transform import Rotation

import visviva as vv
from visviva.study.run import run

SPEED, SHARE = 2.0, 0.5


def turned(axis: int, angle: float) -> Any:
    """Rotation about an axis of space."""
    c, s = np.cos(angle), np.sin(angle)
    i, k = [(1, 2), (2, 0), (0, 1)][axis]
    R = np.eye(3)
    R[i, i] = R[k, k] = c
    R[i, k], R[k, i] = -s, s
    return R


def inertia(mass: float, a: float, b: float) -> float:
    return mass * (a * a + b * b) / 12


def landing(tilt: float, step: float, **options: Any) -> tuple[float, float]:
    """Spin of a box after it has hit another one with an edge, and the deepest that a corner was in it."""
    R, corners = turned(1, tilt), [np.array(c) for c in product((-0.1, 0.1), repeat=3)]
    height = -min((R @ c)[2] for c in corners) + 0.0015
    box = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.2, 0.2)),
        density=1e3,
        position=(0, 0, height),
        rotation=R,
        velocity=(0, 0, -SPEED),
    )
    base = vv.RigidBody(shape=vv.Box(size=(1, 1, 0.4)), density=100.0, position=(0, 0, -0.2))
    contact = vv.Contact(first=box, second=base, restitution=SHARE, stiffness=1e6, **options)
    system, depths = vv.System([box, base, contact]), [0.0]
    ends, top = [vv.Position(of=box.point(tuple(c))) for c in corners], vv.Position(of=base)

    def observe(s: vv.System) -> None:
        depths.append(top(s)[2] + 0.2 - min(end(s)[2] for end in ends))

    vv.simulate(system, until=0.02, step=step, observe=observe)
    return float(vv.AngularVelocity(of=box)(system)[1]), max(depths)


@pytest.mark.parametrize("tilt", [0.2, 0.5])
def test_a_box_that_lands_on_an_edge_turns_as_two_bodies_in_impact(tilt: float) -> None:
    """By default: mortar let it sink by 33 mm and turned it the other way, at every step."""
    corner = min((turned(1, tilt) @ np.array(c) for c in product((-0.1, 0.1), repeat=3)), key=lambda p: p[2])
    arm, masses = corner[0], (8.0, 40.0)
    give = sum(
        1 / m + arm**2 / J for m, J in zip(masses, (inertia(8, 0.2, 0.2), inertia(40, 1, 0.4)), strict=True)
    )
    impulse = (1 + SHARE) * SPEED / give
    spin, depth = landing(tilt, 1e-4)
    assert spin == pytest.approx(-arm * impulse / inertia(8, 0.2, 0.2), rel=2e-3)
    assert depth <= 1.5 * SPEED * 1e-4


@pytest.mark.parametrize("tilt", [0.05, 0.5])
def test_mortar_of_tilted_rigid_bodies_fails_with_its_cure(tilt: float) -> None:
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .*take formulation='node-to-segment'"):
        landing(tilt, 5e-4, formulation="mortar")


def test_mortar_of_what_lies_flat_goes_on() -> None:
    """Newton's impact of two bodies: masses 8 and 40."""
    box = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.2, 0.2)), density=1e3, position=(0, 0, 0.101), velocity=(0, 0, -SPEED)
    )
    base = vv.RigidBody(shape=vv.Box(size=(1, 1, 0.4)), density=100.0, position=(0, 0, -0.2))
    contact = vv.Contact(first=box, second=base, restitution=SHARE, stiffness=1e6, formulation="mortar")
    system = vv.System([box, base, contact])
    vv.simulate(system, until=0.01, step=5e-4)
    centre = -SPEED * 8 / 48
    assert vv.Velocity(of=box)(system)[2] == pytest.approx(centre + SHARE * (centre + SPEED), rel=1e-9)


def crossing(lower: str, radius: float = 0.0, **faces: str) -> float:
    """Velocity of a cube that falls with its lowest edge across the upper edge of a body or an obstacle.

    A ball with this radius may be joined to the middle of its edge.
    """
    edge = 0.15 * np.sqrt(2) + radius + 0.0015
    upper = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.2, 0.2)),
        density=1e3,
        position=(0, 0, edge + 0.1 * np.sqrt(2)),
        rotation=turned(0, np.pi / 4),
        velocity=(0, 0, -SPEED),
    )
    cube = vv.Box(size=(0.3, 0.3, 0.3))
    base: Any = vv.Obstacle(shape=cube, axis=(1, 0, 1))
    if lower == "body":
        base = vv.RigidBody(shape=cube, density=1e3, rotation=turned(1, np.pi / 4))
    options: dict[str, Any] = {"second": base, "restitution": SHARE, "stiffness": 1e6}
    parts: list[Any] = [upper, base, vv.Contact(first=upper, **options, **faces)]
    if radius:
        ball = vv.RigidBody(
            shape=vv.Sphere(radius=radius), mass=1e-6, position=(0, 0, edge), velocity=(0, 0, -SPEED)
        )
        parts += [ball, vv.Rigid(a=upper, b=ball, at=(0, 0, edge)), vv.Contact(first=ball, **options)]
    system = vv.System(parts)
    vv.simulate(system, until=0.02, step=5e-4)
    return float(vv.Velocity(of=upper)(system)[2])


@pytest.mark.parametrize("lower", ["body", "obstacle"])
def test_edges_of_named_faces_that_cross_fail_with_their_cure(lower: str) -> None:
    """They went through each other."""
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .* leave out first_faces"):
        crossing(lower, first_faces="z0")


@pytest.mark.parametrize("radius", [0.0, 0.004])
@pytest.mark.parametrize(("lower", "mass"), [("body", 27.0), ("obstacle", 1e12)])
def test_edges_that_cross_bounce_with_a_ball_joined_to_one_or_none(
    lower: str, mass: float, radius: float
) -> None:
    """The velocities of Newton's impact with a mass of 8."""
    centre = -SPEED * 8 / (8 + mass)
    assert crossing(lower, radius) == pytest.approx(centre + SHARE * (centre + SPEED), rel=1e-5)


def test_corners_of_the_second_body_in_a_face_of_the_first_stop_it() -> None:
    """The plate falls onto the corner of a cube, between its own vertices: from then on 36 kg and 64 go together."""
    plate = vv.RigidBody(
        shape=vv.Box(size=(0.6, 0.6, 0.1)), density=1e3, position=(0, 0, 0.05), velocity=(0, 0, -SPEED)
    )
    R = turned(0, np.arctan(np.sqrt(0.5))) @ turned(1, np.pi / 4)
    size = 0.4
    top = max((R @ np.array(c))[2] for c in product((-0.5 * size, 0.5 * size), repeat=3))
    cube = vv.RigidBody(
        shape=vv.Box(size=(size,) * 3), density=1e3, position=(0, 0, -top - 0.0015), rotation=R
    )
    contact = vv.Contact(first=plate, second=cube, stiffness=1e6)
    system = vv.System([plate, cube, contact])
    vv.simulate(system, until=0.01, step=5e-4)
    for body in (plate, cube):
        assert vv.Velocity(of=body)(system) == pytest.approx([0, 0, -0.36 * SPEED], abs=1e-6 * SPEED)


def test_the_check_says_how_rigid_bodies_touch() -> None:
    box, base = (vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), mass=1.0, position=(0, 0, z)) for z in (1.1, 0))
    for formulation, words in ((None, "by node-to-segment"), ("mortar", "by mortar")):
        contact = vv.Contact(first=box, second=base, stiffness=1e4, formulation=formulation)
        assert words in str(vv.System([base, box, contact]).check())


def test_what_overlaps_from_the_start_is_not_looked_at() -> None:
    """A pin in a hole that is not drawn, with flanks that never meet."""
    pin = vv.RigidBody(
        shape=vv.Box(size=(0.2, 0.2, 1)), density=1e3, position=(0, 0, 0.5), velocity=(0, 0, -SPEED)
    )
    base = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1e3)
    contact = vv.Contact(
        first=pin, first_faces="x1", second=base, second_faces="x1", stiffness=1e4, formulation="mortar"
    )
    system = vv.System([pin, base, contact])
    vv.simulate(system, until=0.1, step=0.01)
    assert vv.Position(of=pin)(system)[2] == pytest.approx(0.5 - SPEED * 0.1, abs=1e-9)


@pytest.mark.parametrize(("thick", "step"), [(0.01, 0.002), (0.01, 0.005), (0.1, 0.002)])
def test_bars_across_each_other_do_not_pass(thick: float, step: float) -> None:
    """They fell through each other, also from one side to the other in one step of 9 or 22 mm."""
    ground = vv.Ground()
    lower, upper = (
        vv.RigidBody(shape=vv.Box(size=size), density=1000.0, position=(0, 0, z))
        for size, z in (((1, thick, thick), 0.0), ((thick, 1, thick), 1.0))
    )
    contact = vv.Contact(first=upper, second=lower, stiffness=1e6)
    bodies = [ground, lower, upper, vv.Rigid(a=ground, b=lower, at=(0, 0, 0))]
    system = vv.System([*bodies, contact, vv.Gravity()])
    vv.simulate(system, until=0.6, step=step)
    assert vv.Position(of=upper)(system)[2] > 0.75 * thick
    assert vv.ContactForce(contact=contact)(system)[2] == pytest.approx(9810 * thick**2, rel=1e-9)


@pytest.mark.parametrize(("speed", "step"), [(10.0, 0.01), (100.0, 1e-3), (3.0, 1e-3)])
def test_edges_that_pass_many_widths_in_a_step_are_seen(speed: float, step: float) -> None:
    """Bars of a millimetre: where steps were longer than 32 widths they fell through each other."""
    ground = vv.Ground()
    lower, upper = (
        vv.RigidBody(shape=vv.Box(size=size), density=1e3, position=(0, 0, z), velocity=(0, 0, v))
        for size, z, v in (((1, 1e-3, 1e-3), 0.0, 0.0), ((1e-3, 1, 1e-3), 0.3, -speed))
    )
    contact = vv.Contact(first=upper, second=lower, stiffness=1e6)
    system = vv.System([ground, lower, upper, contact, vv.Rigid(a=ground, b=lower, at=(0, 0, 0))])
    with suppress(vv.StepFailure):
        vv.simulate(system, until=0.6 / speed, step=step)
    assert vv.Position(of=upper)(system)[2] > 0.5e-3


def test_bars_that_lie_aslant_in_their_own_axes_are_as_thin() -> None:
    """A box around them along these axes is not: they fell through each other."""
    R = turned(2, 0.6) @ turned(1, 0.6) @ turned(0, 0.6)

    def bar(*size: float, **place: Any) -> vv.RigidBody:
        points, triangles = vv.Box(size=size).surface()
        shape = vv.SurfaceMesh(points=(points @ R.T).tolist(), triangles=triangles.tolist())
        return vv.RigidBody(shape=shape, density=1e3, rotation=R.T, **place)

    ground, lower = vv.Ground(), bar(1, 0.005, 0.005)
    upper = bar(0.005, 1, 0.005, position=(0, 0, 0.05), velocity=(0, 0, -1))
    contact = vv.Contact(first=upper, second=lower, stiffness=1e6)
    system = vv.System([ground, lower, upper, contact, vv.Rigid(a=ground, b=lower, at=(0, 0, 0))])
    vv.simulate(system, until=0.12, step=1e-3)
    assert vv.Position(of=upper)(system)[2] > 0.75 * 0.005


def test_what_overlaps_at_a_hinge_hides_no_other_end() -> None:
    """A rod on a hinge inside a beam falls with its free end onto that, which named faces do not see."""
    R, ground = turned(1, -0.1), vv.Ground()
    beam = vv.RigidBody(shape=vv.Box(size=(1, 0.05, 0.02)), density=1e3)
    rod = vv.RigidBody(
        shape=vv.Box(size=(1, 0.02, 0.02)), density=1e3, rotation=R, position=(0, 0, 0.5 * np.sin(0.1))
    )
    end = np.array([0, 0, 0.5 * np.sin(0.1)]) - 0.5 * R[:, 0]
    hinge = vv.Revolute(a=ground, b=rod, at=tuple(end), axis=(0, 1, 0))
    faces: dict[str, Any] = {"first_faces": "x1", "second_faces": "y1", "formulation": "mortar"}
    contact = vv.Contact(first=rod, second=beam, stiffness=1e4, **faces)
    clamp = vv.Rigid(a=ground, b=beam, at=(0, 0, 0))
    system = vv.System([ground, beam, rod, clamp, hinge, contact, vv.Gravity()])
    with pytest.raises(vv.StepFailure, match="sink into each other"):
        vv.simulate(system, until=0.3, step=1e-3)
    arm, fall = 0.9, float(vv.Position(of=rod.point((0.5, 0, -0.01)))(system)[2])
    assert system.time > 0.08 * arm
    assert -0.002 < fall - 0.01 < 0.002


def test_what_overlapped_at_the_start_is_known_after_a_restart(tmp_path: Path) -> None:
    """A pin that leaves its hole and falls back; measured anew, what it was given was less."""

    def made(until: float) -> vv.Study:
        pin = vv.RigidBody(
            shape=vv.Box(size=(0.2, 0.2, 1)), density=1e3, position=(0, 0, 0.9), velocity=(0, 0, SPEED)
        )
        base, ground = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1e3), vv.Ground()
        faces: dict[str, Any] = {"first_faces": "x1", "second_faces": "x1", "formulation": "mortar"}
        contact = vv.Contact(first=pin, second=base, stiffness=1e4, **faces)
        clamp = vv.Rigid(a=ground, b=base, at=(0, 0, 0))
        system = vv.System([ground, pin, base, contact, clamp, vv.Gravity(acceleration=(0, 0, -20.0))])
        return vv.Study(system, until=until, step=0.01)

    whole, again = made(0.19), made(0.19)
    run(whole, tmp_path / "whole", pictures=False)
    run(made(0.1), tmp_path / "split", pictures=False)
    run(again, tmp_path / "split", pictures=False, resume=True)
    assert again.system.x.tobytes() == whole.system.x.tobytes()


@pytest.mark.parametrize("shape", [vv.Sphere(radius=0.1), vv.Capsule(radius=0.1, length=0.1)])
def test_what_is_round_does_not_fall_through_coarse_solids(shape: Any) -> None:
    """Between the vertices of the first, half a length apart, which alone touch: it left by the other side."""
    mesh = vv.BoxMesh(size=(1, 1, 0.2), counts=(2, 2, 1))
    plate = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3)
    ball = vv.RigidBody(shape=shape, density=500.0, position=(0.25, 0.25, 0.36), velocity=(0, 0, -2))
    contact = vv.Contact(first=plate, second=ball, formulation="node-to-segment")
    system = vv.System([plate, ball, vv.Fixed(solid=plate, nodes="z0"), contact])
    with pytest.raises(
        vv.StepFailure, match=r"sink into each other.*vertices of .* alone touch.*exchange first"
    ):
        vv.simulate(system, until=0.2, step=5e-3)


STEPS = pytest.mark.parametrize("step", [0.005, 0.008, 0.01, 0.015, 0.02, 0.04])
"""Bodies come nearer by a tenth to eight tenths of a width of 0.1 in them: longer ones passed each other, freely."""


def later(first: Any, other: Any, step: float, **options: Any) -> None:
    """What starts over a vertex, and is over a facet alone when it gets there, fails with its cure."""
    parts = [first, other, vv.Contact(first=first, second=other, formulation="node-to-segment", **options)]
    if not isinstance(other, vv.Obstacle):
        parts.append(vv.Fixed(solid=first, nodes="all" if isinstance(first, vv.Shell) else "y0"))
    cure = "more cells" if isinstance(first, vv.Beam) else "finer cells"
    with pytest.raises(
        vv.StepFailure, match=f"sink into each other by .* vertices of .* alone touch .*{cure}"
    ):
        vv.simulate(vv.System(parts), until=0.4, step=step)


@STEPS
@pytest.mark.parametrize("faces", ["upper", "z1"])
@pytest.mark.parametrize("shape", [vv.Box(size=(0.1, 0.1, 0.1)), vv.Sphere(radius=0.1)])
def test_what_comes_over_a_facet_later_fails(shape: Any, faces: str, step: float) -> None:
    """Not where it starts, over a vertex of faces that are named: it fell through, freely."""
    plate = coarse_plate(faces == "upper")
    fallen = vv.RigidBody(shape=shape, density=500.0, position=(0.5, 0.5, 0.5), velocity=(-1.25, -1, -2))
    later(plate, fallen, step, first_faces=faces)


@STEPS
def test_obstacles_that_come_under_a_facet_later_fail(step: float) -> None:
    peg = vv.Obstacle(shape=vv.Sphere(radius=0.1), at=(0.75, 0.75, -0.8))
    mesh = vv.BoxMesh(size=(1, 1, 0.2), counts=(2, 2, 1), origin=(0.25, 0.25, -0.2))
    solid = vv.Solid(
        mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3, velocity=(0.8, 0.8, -2)
    )
    later(solid, peg, step)


@STEPS
@pytest.mark.parametrize("shape", [vv.Box(size=(0.1, 1, 0.1)), vv.Sphere(radius=0.05)])
def test_bars_that_come_over_a_peg_between_their_nodes_later_fail(shape: Any, step: float) -> None:
    later(bar(4, velocity=(0.375, 0, -1)), vv.Obstacle(shape=shape, at=(0, 0, -0.3)), step)


@STEPS
@pytest.mark.parametrize("faces", ["all", "y1"])
def test_what_comes_over_a_facet_later_in_the_plane_fails(faces: str, step: float) -> None:
    rubber: dict[str, Any] = {"material": vv.NeoHooke(young=1e6, poisson=0.3), "density": 1e3}
    plate = vv.Solid(mesh=vv.RectangleMesh(size=(1, 0.2), counts=(2, 1)), **rubber)
    mesh = vv.RectangleMesh(size=(0.3, 0.8), counts=(3, 8), origin=(0.35, 0.6))
    later(plate, vv.Solid(mesh=mesh, velocity=(-1.25, -2, 0), **rubber), step, first_faces=faces)


@STEPS
@pytest.mark.parametrize("formulation", [None, "node-to-segment"])
def test_a_plate_that_falls_onto_a_peg_as_wide_as_it_is_thick_fails(formulation: Any, step: float) -> None:
    """From above the peg with a vertex, to where it is under a facet: it fell on as if there were none."""
    mesh = vv.BoxMesh(size=(1, 1, 0.1), counts=(2, 2, 1), origin=(-0.5, -0.5, 1))
    rubber: dict[str, Any] = {"material": vv.NeoHooke(young=1e6, poisson=0.3), "density": 1e3}
    plate = vv.Solid(mesh=mesh, velocity=(0.5, 0.5, 0), **rubber)
    peg = vv.Obstacle(shape=vv.Box(size=(0.1, 0.1, 0.1)), at=(0, 0, 0))
    contact = vv.Contact(first=plate, second=peg, formulation=formulation)
    with pytest.raises(vv.StepFailure, match="sink into each other"):
        vv.simulate(vv.System([plate, peg, contact, vv.Gravity()]), until=0.6, step=step)


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_is_pressed_beside_named_faces_is_free(dimension: int) -> None:
    """A block goes through a side that does not touch, to beyond its middle: freely, as the faces say."""
    rubber: dict[str, Any] = {"material": vv.NeoHooke(young=1e6, poisson=0.3), "density": 1e3}
    box, size = (vv.RectangleMesh, (1, 1)) if dimension == 2 else (vv.BoxMesh, (1, 1, 1))
    floor = vv.Solid(mesh=box(size=size, counts=(2,) * dimension), **rubber)
    mesh = box(size=size, counts=(3,) * dimension, origin=(1.1, -0.3, -0.3)[:dimension])
    block = vv.Solid(mesh=mesh, velocity=(-1, 0, 0), **rubber)
    contact = vv.Contact(
        first=floor, second=block, first_faces="y1" if dimension == 2 else "z1", formulation="node-to-segment"
    )
    system = vv.System([floor, block, contact])
    vv.simulate(system, until=0.7, step=0.02)
    place = vv.Position(of=block.point((1.1, *(-0.3,) * (dimension - 1), 0)[:3]))
    assert place(system)[0] == pytest.approx(0.4, abs=1e-9)


@pytest.mark.parametrize("angles", [(0.0, np.pi / 4), (0.4, 0.4)])
def test_what_lands_tilted_on_a_solid_is_seen_by_vertices_alone(angles: tuple[float, float]) -> None:
    """Means over facets hardly see edges and corners: it sank by half of the plate's thickness, without a word."""
    mesh = vv.BoxMesh(size=(1, 1, 0.2), counts=(6, 6, 2))
    tilted = Rotation.from_euler("xy", angles[::-1]).as_matrix()
    low = 0.15 * np.abs(tilted[2]).sum()

    def fallen(**options: Any) -> float:
        plate = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3)
        cube = vv.RigidBody(
            shape=vv.Box(size=(0.3, 0.3, 0.3)),
            density=500.0,
            position=(0.5, 0.5, 0.205 + low),
            velocity=(0, 0, -2),
            rotation=tilted,
        )
        contact = vv.Contact(first=cube, second=plate, **options)
        system = vv.System([plate, cube, vv.Fixed(solid=plate, nodes="z0"), contact])
        vv.simulate(system, until=0.03, step=2e-3)
        return float(vv.Position(of=cube)(system)[2]) - low

    with pytest.raises(vv.StepFailure, match=r"mortar .* lies tilted: .*'node-to-segment', with .* as first"):
        fallen()
    assert fallen(formulation="node-to-segment") > 0.175


def with_rings(radius: float, length: float, corners: int, pieces: int) -> vv.SurfaceMesh:
    """A cylinder along its third axis with rings of vertices, one of its corners on the first axis."""
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    points = [
        (radius * np.cos(a), radius * np.sin(a), z)
        for z in np.linspace(-length / 2, length / 2, pieces + 1)
        for a in angles
    ]
    bottom, top, last = len(points), len(points) + 1, pieces * corners
    triangles = []
    for i in range(corners):
        j = (i + 1) % corners
        triangles += [(bottom, j, i), (top, last + i, last + j)]
        for k in range(0, last, corners):
            triangles += [(k + i, k + j, k + corners + j), (k + i, k + corners + j, k + corners + i)]
    return vv.SurfaceMesh(points=[*points, (0, 0, -length / 2), (0, 0, length / 2)], triangles=triangles)


@pytest.mark.parametrize("meshed", [False, True])
def test_a_box_across_a_lying_cylinder_is_held_by_vertices_along_that(meshed: bool) -> None:
    """Neither order sees it where the cylinder has vertices on its rims alone; steps fail with what helps."""
    shape = with_rings(0.3, 2.0, 16, 8) if meshed else vv.Cylinder(radius=0.3, length=2.0)
    ground, lying = vv.Ground(), Rotation.from_euler("y", 90, degrees=True).as_matrix()
    below = vv.RigidBody(shape=shape, density=1e3, position=(0, 0, -0.3), rotation=lying, name="cylinder")
    box = vv.RigidBody(
        shape=vv.Box(size=(0.3, 0.3, 0.3)), density=1e3, position=(0, 0, 0.151), velocity=(0, 0, -0.5)
    )
    first, second = (below, box) if meshed else (box, below)
    contact = vv.Contact(first=first, second=second, stiffness=1e6)
    clamp = vv.Rigid(a=ground, b=below, at=(0, 0, -0.3))
    system = vv.System([ground, below, box, clamp, contact])
    if meshed:
        vv.simulate(system, until=0.01, step=1e-3)
        assert vv.Position(of=box)(system)[2] == pytest.approx(0.15, abs=1e-3)
        return
    with pytest.raises(vv.StepFailure, match=r"across RigidBody 'cylinder' .*SurfaceMesh with close rings"):
        vv.simulate(system, until=0.1, step=5e-3)


@pytest.mark.parametrize(("width", "speed"), [(0.01, 5.0), (0.01, 60.0), (0.005, 1.0)])
@pytest.mark.parametrize("exchanged", [False, True])
def test_needles_that_cover_little_of_a_facet_do_not_pass_it_by_mortar(
    width: float, speed: float, exchanged: bool
) -> None:
    """A gap is held from a thousandth of its vertex' area on: solid needles fell through, without a word."""
    rubber: dict[str, Any] = {"material": vv.NeoHooke(young=1e6, poisson=0.3), "density": 1e3}
    plate = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 0.05), counts=(4, 4, 1), origin=(0, 0, -0.05)), **rubber)
    mesh = vv.BoxMesh(size=(width, width, 0.1), counts=(1, 1, 2), origin=(0.63, 0.59, 0.011))
    needle = vv.Solid(mesh=mesh, velocity=(0, 0, -speed), name="needle", **rubber)
    first, second = (needle, plate) if exchanged else (plate, needle)
    held = vv.Fixed(solid=plate, nodes="z0")
    system = vv.System([plate, needle, held, vv.Contact(first=first, second=second)])
    if not exchanged:
        with pytest.raises(vv.StepFailure, match=r"'needle' covers too little .*exchange first and second"):
            vv.simulate(system, until=0.03 / speed, step=0.01 / speed)
        return
    with suppress(vv.StepFailure):  # fast ones squash to nothing
        vv.simulate(system, until=0.03 / speed, step=1e-3 / speed)
    assert vv.CentreOfMass(of=needle)(system)[2] > 0
