"""Bodies that lie in each other at the start, deeper than contact sees, are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

RUBBER = vv.NeoHooke(young=1e6, poisson=0.3)


def block(size: tuple[float, ...], counts: tuple[int, ...], origin: tuple[float, ...]) -> vv.Solid:
    plane = len(size) == 2
    mesh: Any = vv.RectangleMesh if plane else vv.BoxMesh
    return vv.Solid(mesh=mesh(size=size, counts=counts, origin=origin), material=RUBBER, density=1000.0)


def started(*bodies: vv.Component, **given: Any) -> vv.Result:
    """One step of contact of the first of the bodies with the second."""
    contact = vv.Contact(first=bodies[0], second=bodies[1], **given)
    return vv.simulate(vv.System([*bodies, contact]), until=1e-3, step=1e-3)


@pytest.mark.parametrize("initial", ["touch", "press", "resolve"])
@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("depth", [0.2, 0.3, 0.8])
def test_blocks_deeper_in_each_other_than_the_reach(initial: str, formulation: str, depth: float) -> None:
    """Of 0.2, the size of a facet; they fell through each other."""
    given = {"initial": initial, "formulation": formulation}
    upper, lower = block((1, 0.5), (6, 3), (-0.5, -depth)), block((2, 1), (10, 5), (-1, -1))
    with pytest.raises(vv.InputError, match="overlap"):
        started(upper, lower, first_faces="y0", second_faces="y1", **given)


@pytest.mark.parametrize("faces", ["named", "all"])
@pytest.mark.parametrize("exchanged", [False, True])
def test_a_small_block_in_a_large_one(faces: str, exchanged: bool) -> None:
    """Whichever of them is first; by half of it, between nodes of the large one."""
    small, large = block((0.2,) * 3, (1, 1, 1), (0.1, 0.1, 0.5)), block((1,) * 3, (2, 2, 2), (0, 0, 0))
    which = {"first_faces": "z0", "second_faces": "z1"} if faces == "named" else {}
    bodies = [small, large]
    if exchanged:
        bodies, which = bodies[::-1], dict(zip(which, reversed(which.values()), strict=True))
    with pytest.raises(
        vv.InputError, match=r"'solid-\d' and Solid 'solid-\d' overlap by .*the reach of 0\.1"
    ):
        started(*bodies, reach=0.1, **which)


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("exchanged", [False, True])
def test_a_block_wholly_in_another_is_refused(formulation: str, exchanged: bool) -> None:
    """Their surfaces do not meet anywhere; it flew freely there."""
    bodies = [block((0.1,) * 3, (1, 1, 1), (0.4, 0.4, 0.4)), block((1,) * 3, (2, 2, 2), (0, 0, 0))]
    with pytest.raises(vv.InputError, match="overlap by"):
        started(*(bodies[::-1] if exchanged else bodies), formulation=formulation)


@pytest.mark.parametrize("shape", [vv.Sphere(radius=0.25), vv.Box(size=(1, 1, 0.5))])
def test_rigid_bodies_in_a_solid(shape: Any) -> None:
    body = vv.RigidBody(shape=shape, density=1000.0, position=(0, 0, -0.55))
    solid = block((2, 2, 1), (10, 10, 5), (-1, -1, -1))
    with pytest.raises(vv.InputError, match=r"'rigidbody-1' and Solid 'solid-1' overlap by .* at the start"):
        started(body, solid, second_faces="z1")


def test_press_fits_as_deep_as_the_reach_given_start() -> None:
    """Which the message says; beside it, what faces in contact do not lead out of is no matter of theirs."""
    upper, lower = (block((1, 1), (5, 5), (0, y)) for y in (0.95, 0.0))
    started(upper, lower, first_faces="y0", second_faces="y1", initial="press")
    with pytest.raises(vv.InputError, match=r"initial='press' and a reach above 0\.05"):
        started(
            *(block((1, 1), (5, 5), (0, y)) for y in (0.95, 0.0)),
            first_faces="y0",
            second_faces="y1",
            initial="press",
            reach=0.01,
        )
    pin, plate = block((0.2, 1), (2, 10), (0.4, -0.5)), block((1, 1), (5, 5), (0, 0))
    started(pin, plate, first_faces="x1", second_faces="x1")


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
def test_what_touches_starts(formulation: str) -> None:
    """By all faces: thin plates on each other, and a shell on them."""
    upper, lower = (block((1, 1, 0.02), (k, k, 1), (0, 0, z)) for k, z in ((3, 0.02), (5, 0.0)))
    started(upper, lower, formulation=formulation)
    flat = vv.RectangleMesh(size=(0.8, 0.8), counts=(3, 3), origin=(0.1, 0.1)).build()
    mesh = vv.Mesh(
        points=np.pad(flat.points, ((0, 0), (0, 1)), constant_values=0.025), cells=dict(flat.cells)
    )
    section = vv.HomogeneousSection(young=1e6, poisson=0.3, thickness=0.01, density=1000.0)
    shell, plate = vv.Shell(mesh=mesh, section=section), block((1, 1, 0.02), (5, 5, 1), (0, 0, 0))
    started(shell, plate, formulation=formulation)


@pytest.mark.parametrize("place", [(0.2, 0, 0.98), (0.2, 0, 0.9), (0.2, 0, 0.3), (0, 0, 0.9)])
@pytest.mark.parametrize(
    "given", [{}, {"enforcement": "penalty"}, {"enforcement": "penalty", "initial": "press"}]
)
def test_flush_boxes_in_each_other_are_refused(place: tuple[float, ...], given: dict[str, str]) -> None:
    """Vertices of one lie on the sides of the other, and none in it: no force acted between them."""
    boxes = [vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), mass=1.0, position=p) for p in ((0, 0, 0), place)]
    with pytest.raises(vv.InputError, match="overlap by"):
        started(*boxes, stiffness=1e5, **given)


@pytest.mark.parametrize("place", [(0, 0, 1), (0.2, 0, 1), (0.2, 0.3, 1), (1, 0, 0), (1, 0.4, 0.2)])
def test_boxes_that_touch_start(place: tuple[float, ...]) -> None:
    boxes = [vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), mass=1.0, position=p) for p in ((0, 0, 0), place)]
    started(*boxes, stiffness=1e5)


ACROSS = {
    "rod through plate": ((1, 1, 0.02), (0.05, 0.05, 1), (-0.2, 0.2, 0.3), 0.02),
    "bars": ((1, 0.1, 0.1), (0.1, 1, 0.1), (-0.2, 0.3, 0.04), 0.06),
    "plates": ((1, 1, 0.02), (1, 0.02, 1), (0.3, -0.2, 0.3), 0.02),
    "flush bars": ((1, 0.1, 0.1), (0.1, 1, 0.1), (0.2, 0.3, 0), 0.1),
    "flush plates": ((1, 1, 0.02), (1, 0.02, 1), (0, -0.2, 0.3), 0.02),
    "equal bars": ((1, 0.1, 0.1), (1, 0.1, 0.1), (0.3, 0, 0), 0.1),
}


@pytest.mark.parametrize("name", ACROSS)
@pytest.mark.parametrize(
    "given", [{}, {"enforcement": "penalty"}, {"initial": "press"}], ids=["multipliers", "penalty", "press"]
)
def test_boxes_through_each_other_are_refused(name: str, given: dict[str, str]) -> None:
    """No vertex of one is in the other, nor a middle of a facet: no force acted. The least width of what they have in
    common is known."""
    *sizes, place, depth = ACROSS[name]
    held, through = (
        vv.RigidBody(shape=vv.Box(size=size), density=1e3, position=p)
        for size, p in zip(sizes, ((0, 0, 0), place), strict=True)
    )
    with pytest.raises(vv.InputError, match=rf"overlap by {depth:.3g} near"):
        started(through, held, stiffness=1e6, **given)


SOFT_ACROSS = {
    "flush bars": ((1, 0.1, 0.1), (3, 1, 1), (0.1, 1, 0.1), (1, 3, 1), (0.2, 0.3, 0), 0.1),
    "rod through plate": ((0.05, 0.05, 1), (1, 1, 4), (1, 1, 0.02), (4, 4, 1), (0.03, 0.02, 0.1), 0.02),
    "plate about rod": ((1, 1, 0.02), (4, 4, 1), (0.05, 0.05, 1), (1, 1, 4), (0.03, 0.02, 0.1), 0.02),
    "plates": ((1, 1, 0.02), (4, 4, 1), (1, 0.02, 1), (4, 1, 4), (0.1, 0.03, 0.1), 0.02),
}


@pytest.mark.parametrize("name", SOFT_ACROSS)
@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
@pytest.mark.parametrize("given", [{}, {"enforcement": "penalty"}, {"initial": "press"}])
def test_solids_through_each_other_are_refused(name: str, formulation: str, given: dict[str, str]) -> None:
    """No node of one is in the other: no force acted. What they have in common has a known width."""
    size, counts, other, others, place, width = SOFT_ACROSS[name]
    centred = tuple(-np.array(size) / 2), tuple(np.array(place) - np.array(other) / 2)
    bodies = [block(size, counts, centred[0]), block(other, others, centred[1])]
    with pytest.raises(vv.InputError, match=r"overlap by .* where no gap sees it") as refused:
        started(*bodies, formulation=formulation, **given)
    told = float(str(refused.value).split("overlap by ")[1].split()[0])
    assert 0.8 * width < told <= width * (1 + 1e-9)


@pytest.mark.parametrize("turned", [False, True])
def test_boxes_that_touch_start_wherever_they_do(turned: bool) -> None:
    """Face to face along the whole, past corners, edge on edge and corner on corner, in any orientation."""
    random = np.random.default_rng(16)
    for _ in range(60):
        a, b = random.choice([0.1, 0.5, 1, 2], (2, 3))
        shares = random.choice([0.0, 1.0, -1.0, 0.3], 3)
        away = (a + b) / 2 * shares
        axis = random.integers(3)
        away[axis] = (a + b)[axis] / 2
        frame = np.linalg.qr(random.normal(size=(3, 3)))[0] if turned else np.eye(3)
        frame[:, 0] *= np.linalg.det(frame)
        bodies = [
            vv.RigidBody(shape=vv.Box(size=tuple(s)), density=1e3, position=x, rotation=frame)
            for s, x in ((a, np.zeros(3)), (b, frame @ away))
        ]
        contact = vv.Contact(first=bodies[0], second=bodies[1], stiffness=1e6)
        vv.System([*bodies, contact]).check()


@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-9])
def test_boxes_across_each_other_that_touch_start(off: float) -> None:
    """By faces that cross, with no vertex of one in the face of the other."""
    bars = [
        vv.RigidBody(shape=vv.Box(size=size), density=1e3, position=p)
        for size, p in (((1, 0.1, 0.1), (0, 0, 0)), ((0.1, 1, 0.1), (-0.2, 0.3, 0.1 + off)))
    ]
    started(*bars, stiffness=1e6)


@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize(
    ("sizes", "away"),
    [((0.3, 0.4), (-7.4, 0, -0.4 * np.sqrt(0.5))), ((0.7, 1), (2.6, 0, 0.175 - np.sqrt(0.5)))],
)
def test_boxes_far_apart_start(sizes: tuple[float, ...], away: tuple[float, ...], exchanged: bool) -> None:
    """One stands on its edge, level with where facets of the other one were looked from."""
    c, s = np.cos(np.pi / 4), np.sin(np.pi / 4)
    on_edge = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    bodies = [
        vv.RigidBody(shape=vv.Box(size=(size,) * 3), density=1.0, position=place, rotation=rotation)
        for size, place, rotation in zip(sizes, ((0, 0, 0), away), (np.eye(3), on_edge), strict=True)
    ]
    started(*(bodies[::-1] if exchanged else bodies), stiffness=1e3)
