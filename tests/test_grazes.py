"""What comes in beside the border of a coarse plate is as deep as it is below the face by which it came in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.faces import Faces
from visviva.study.run import run

SOFT = vv.NeoHooke(young=1e7, poisson=0.3)
THICK, GAP, SPEED = 0.1, 0.01, 1.0


def plate(count: int) -> vv.Solid:
    """One metre wide, with so many bricks along it, its top at zero."""
    mesh = vv.BoxMesh(size=(1, 1, THICK), counts=(count, count, 1), origin=(-0.5, -0.5, -THICK))
    return vv.Solid(mesh=mesh, material=SOFT, density=1e3)


def sheet(count: int) -> vv.Shell:
    """The same of a shell a fifth as thick."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(count, count), origin=(-0.5, -0.5)).build()
    points = np.pad(flat.points[:, :2], ((0, 0), (0, 1)), constant_values=-THICK / 10)
    section = vv.HomogeneousSection(thickness=THICK / 5, young=1e7, density=1e3)
    return vv.Shell(mesh=vv.Mesh(points, flat.cells, face_sets=flat.face_sets), section=section)


def falling(
    kind: str, width: float, over: float, y: float, *, across: float = 0.0, gap: float = GAP
) -> tuple[Any, Any]:
    """What falls over the border by a part of its width, and its middle."""
    middle, velocity = (0.5 + width / 2 - over * width, y, gap + width / 2), (across, 0.0, -SPEED)
    if kind == "solid":
        corner = np.array(middle) - width / 2
        mesh = vv.BoxMesh(size=(width,) * 3, counts=(1, 1, 1), origin=tuple(corner))
        cube = vv.Solid(mesh=mesh, material=SOFT, density=1e3, velocity=velocity)
        return cube, cube.point(middle)
    shape = vv.Sphere(radius=width / 2) if kind == "ball" else vv.Box(size=(width,) * 3)
    body = vv.RigidBody(shape=shape, density=1e3, position=middle, velocity=velocity)
    return body, body


def thrown(count: int, kind: str, width: float, over: float, y: float, **options: Any) -> vv.System:
    """A plate, which is first unless `options` say otherwise, held below, and what falls on its border."""
    body, base = falling(kind, width, over, y)[0], plate(count)
    sides = {"first": base, "second": body, "formulation": "node-to-segment"} | options
    if sides["first"] == "body":
        sides |= {"first": body, "second": base}
    return vv.System([base, body, vv.Contact(**sides), vv.Fixed(solid=base, nodes="z0")])


@pytest.mark.parametrize("count", [2, 6])
@pytest.mark.parametrize("kind", ["box", "ball", "solid"])
@pytest.mark.parametrize("width", [0.05, 0.1])
@pytest.mark.parametrize("over", [0.05, 0.1])
def test_grazes_between_vertices_of_a_plate_fail(count: int, kind: str, width: float, over: float) -> None:
    """They fell past as if there were no plate, with a clean audit: the side was nearer than what is deep."""
    system = thrown(count, kind, width, over, 0.08)
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .*vertices of Solid .* alone touch"):
        vv.simulate(system, until=0.25, step=4e-3)


@pytest.mark.parametrize("count", [2, 6])
@pytest.mark.parametrize("kind", ["box", "solid"])
@pytest.mark.parametrize("over", [0.05, 0.1])
def test_grazes_between_nodes_of_a_shell_fail(count: int, kind: str, over: float) -> None:
    """Lines along it, which are in the other body between its vertices."""
    body, base = falling(kind, 0.1, over, 0.08)[0], sheet(count)
    contact = vv.Contact(first=base, second=body, formulation="node-to-segment")
    system = vv.System([base, body, contact, vv.Clamped(solid=base, nodes="x0")])
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .*vertices of Shell .* alone touch"):
        vv.simulate(system, until=0.25, step=4e-3)


@pytest.mark.parametrize("step", [5e-4, 4e-3, 0.03])
def test_grazes_fail_whatever_the_step(step: float) -> None:
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        vv.simulate(thrown(2, "box", 0.1, 0.1, 0.08), until=0.25, step=step)


@pytest.mark.parametrize("kind", ["box", "ball"])
def test_what_touches_by_its_own_vertices_is_stopped(kind: str) -> None:
    """The other order, which is the cure: what comes down on the border is slower than what falls past."""
    system = thrown(2, kind, 0.1, 0.1, 0.08, first="body")
    vv.simulate(system, until=0.1, step=4e-3)
    assert vv.Velocity(of=system.components[1])(system)[2] > -0.8


@pytest.mark.parametrize("kind", ["box", "solid"])
def test_what_falls_past_is_free(kind: str) -> None:
    body, of = falling(kind, 0.1, -0.01, 0.08)
    base = plate(2)
    contact = vv.Contact(first=base, second=body, formulation="node-to-segment")
    system = vv.System([base, body, contact, vv.Fixed(solid=base, nodes="z0")])
    start = np.array(vv.Position(of=of)(system))
    vv.simulate(system, until=0.25, step=4e-3)
    assert vv.Position(of=of)(system) == pytest.approx(start - [0, 0, 0.25 * SPEED], abs=1e-9)


def test_grazes_fail_after_a_restart(tmp_path: Path) -> None:
    """What had come in when the run was divided is known by the facet that it passed."""

    def made(until: float) -> vv.Study:
        return vv.Study(thrown(2, "box", 0.1, 0.1, 0.08), until=until, step=2e-3)

    run(made(0.03), tmp_path, pictures=False)
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        run(made(0.25), tmp_path, pictures=False, resume=True)


@pytest.mark.parametrize("kind", ["box", "ball", "solid"])
def test_one_brick_whose_top_is_named_lets_nothing_through(kind: str) -> None:
    """All of its edges are at the border of the name; what comes from beside fell through the middle."""
    body, base = falling(kind, 0.1, -2.0, 0.08, across=-3.0, gap=0.2)[0], plate(1)
    contact = vv.Contact(first=base, second=body, first_faces="z1", formulation="node-to-segment")
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        vv.simulate(vv.System([base, body, contact, vv.Fixed(solid=base, nodes="z0")]), until=0.3, step=4e-3)


def faces_of(post: vv.Solid, *names: str) -> Faces:
    """Several faces of bricks as one set."""
    sets = [post.mesh.face_sets[name] for name in names]
    joined = (
        {"quad4": np.concatenate([part["quad4"] for part in parts])}
        for parts in zip(*((faces.cells, faces.owners) for faces in sets), strict=True)
    )
    return Faces(*joined)


def post_and_bar(kind: str, side: int) -> tuple[vv.Solid, Any]:
    """A post of one brick, and a bar that moves towards one side of it, a tenth of a metre wide both."""
    mesh = vv.BoxMesh(size=(0.1, 0.2, 1.0), counts=(1, 1, 1), origin=(-0.05, -0.1, -0.5)).build()
    post = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e9, poisson=0.3), density=1e3)
    middle, velocity = np.array([0.15 * side, 0.2, 0]), (-side * SPEED, 0, 0)
    if kind == "solid":
        along = vv.BoxMesh(size=(0.1, 1.0, 0.1), counts=(1, 3, 1), origin=tuple(middle - [0.05, 0.5, 0.05]))
        return post, vv.Solid(mesh=along, material=SOFT, density=1e3, velocity=velocity)
    shape = vv.Box(size=(0.1, 1.0, 0.1))
    return post, vv.RigidBody(shape=shape, density=1e3, position=tuple(middle), velocity=velocity)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("several", [False, True])
@pytest.mark.parametrize("kind", ["rigid", "solid"])
@pytest.mark.parametrize("step", [0.01, 0.05, 0.09, 0.15, 0.2, 0.4])
def test_a_bar_does_not_pass_a_post_of_which_a_face_is_named(
    step: float, kind: str, several: bool, side: int
) -> None:
    """Only what is before its middle is as deep as its face: looks that suit both sides of that missed a fifth."""
    post, bar = post_and_bar(kind, side)
    name = "x1" if side > 0 else "x0"
    faces: Any = faces_of(post, name, "y1") if several else name
    contact = vv.Contact(first=post, second=bar, first_faces=faces, formulation="node-to-segment")
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        vv.simulate(vv.System([post, bar, contact, vv.Fixed(solid=post, nodes="z0")]), until=0.4, step=step)


@pytest.mark.parametrize("named", [{}, {"first_faces": "x0"}])
@pytest.mark.parametrize("step", [0.05, 0.07, 0.09, 0.2])
def test_the_rounding_behind_a_border_hides_no_depth(step: float, named: dict[str, str]) -> None:
    """Ends of a bar are beside the face, and deep behind its border: it went on as if its gaps held that."""
    post, bar = post_and_bar("rigid", 1)
    contact = vv.Contact(first=bar, second=post, second_faces="x1", formulation="node-to-segment", **named)
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        vv.simulate(vv.System([post, bar, contact, vv.Fixed(solid=post, nodes="z0")]), until=0.4, step=step)


@pytest.mark.parametrize("step", [1e-3, 4e-3, 0.03])
@pytest.mark.parametrize("dim", [2, 3])
def test_flat_faces_that_are_both_named_let_nothing_through(dim: int, step: float) -> None:
    """A plate comes over a post between its vertices: beyond the step of that, what is named is apart."""
    up, kind = "xyz"[dim - 1], vv.BoxMesh if dim == 3 else vv.RectangleMesh
    keep = [0, 1, 2] if dim == 3 else [0, 2]

    def cut(size: tuple[float, ...], count: int, corner: tuple[float, ...]) -> vv.Solid:
        counts = (np.array([count, count, 1])[keep]).tolist()
        mesh: Any = kind(size=np.array(size)[keep], counts=counts, origin=np.array(corner)[keep])
        return vv.Solid(mesh=mesh, material=SOFT, density=1e3, velocity=velocity if count == 2 else (0, 0, 0))

    velocity = (-2.0, 0, -SPEED) if dim == 3 else (-2.0, -SPEED, 0)
    post, above = cut((0.1, 0.1, 0.3), 4, (-0.05, -0.05, -0.3)), cut((1, 1, THICK), 2, (0.15, -0.25, 0.2))
    named = {"first_faces": up + "0", "second_faces": up + "1"}
    contact = vv.Contact(first=above, second=post, formulation="node-to-segment", **named)
    with pytest.raises(vv.StepFailure, match="sink into each other by"):
        vv.simulate(
            vv.System([above, post, contact, vv.Fixed(solid=post, nodes=up + "0")]), until=0.4, step=step
        )


def pressed(shift: float, slide: float, **contact: Any) -> vv.System:
    """Two blocks of one width, the upper one that far aside, pressed by a tenth each, then slid."""
    soft = vv.NeoHooke(young=1e6, poisson=0.3)
    above, below = (
        vv.Solid(
            mesh=vv.RectangleMesh(size=(1, THICK), counts=counts, origin=origin), material=soft, density=1e3
        )
        for counts, origin in (((8, 2), (shift, 0)), ((13, 2), (0, -THICK)))
    )

    def motion(t: float, points: Any) -> Any:
        way = np.array([slide * max(t - 1, 0), -0.2 * THICK * min(t, 1), 0])
        return np.zeros(points.shape) + way[: points.shape[1]]

    touch = vv.Contact(first=above, second=below, formulation="node-to-segment", **contact)
    moved = vv.Prescribed(solid=above, nodes="y1", motion=motion)
    return vv.System([above, below, touch, moved, vv.Fixed(solid=below, nodes="y0")])


def test_flush_blocks_slide_to_where_others_were_pressed() -> None:
    """No friction: the way there is the same to them. What the corner had slid was taken for its depth."""
    places = []
    for shift, slide in ((0.0, 0.2), (0.1, 0.0)):
        system = pressed(shift, slide, enforcement="penalty", stiffness=2e6)
        vv.simulate(system, until=1.5, step=0.05, scheme=vv.Static())
        places.append(vv.Position(of=system.components[0].point((shift + 0.5, 0, 0)))(system))
    assert places[0] == pytest.approx(places[1], abs=1e-9)


@pytest.mark.parametrize("stiffness", [1e7, 3e7])
def test_flush_blocks_slide_in_time(stiffness: float) -> None:
    system = pressed(0, 0.2, enforcement="penalty", stiffness=stiffness)
    vv.simulate(system, until=1.4, step=0.02, scheme=vv.EnergyMomentum())
