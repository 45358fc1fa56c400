"""What surfaces see of each other: never through their own bodies, and always what passes within a step."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from contact_parts import RUBBER, contact_of
from numpy.typing import NDArray

import visviva as vv
from visviva import _core
from visviva.base.errors import InputError
from visviva.component.component import Component
from visviva.contact.contact_surface import Surface, surface_of
from visviva.system.newton import StepFailure

Array = NDArray[np.float64]
STIFF = vv.NeoHooke(young=1e6, poisson=0.3)
FORMULATIONS = ("mortar", "node-to-segment")


def solid(mesh: Any, **options: Any) -> vv.Solid:
    return vv.Solid(mesh=mesh, **{"material": RUBBER, "density": 1.0, **options})


def box(size: Any, z: float, **options: Any) -> vv.RigidBody:
    return vv.RigidBody(shape=vv.Box(size=size), density=1.0, position=(0, 0, z), **options)


# --- far sides of thin bodies -------------------------------------------------------------------------------
def ball_and_table(**options: Any) -> list[Component]:
    ball = solid(
        vv.SphereMesh(radius=0.1, counts=(2, 2)).build().moved((0.013, 0.005, 0.31)), velocity=(0, 0, -3)
    )
    table = box((1, 1, 0.1), 0.0)
    return [ball, table, vv.Contact(first=ball, first_faces="outer", second=table, **options)]


def sheet_over_plate(**options: Any) -> list[Component]:
    above = vv.BoxMesh(size=(0.6, 0.5, 0.1), counts=(2, 2, 1), origin=(0.21, 0.23, 0.21))
    sheet = solid(above, velocity=(0, 0, -3))
    plate = solid(vv.BoxMesh(size=(1, 1, 0.05), counts=(4, 4, 1)))
    return [sheet, plate, vv.Contact(first=sheet, second=plate, **options)]


def two_boxes(**options: Any) -> list[Component]:
    above = box((1, 1, 0.1), 0.26, velocity=(0, 0, -3))
    below = box((1.2, 1.1, 0.1), 0.0)
    return [above, below, vv.Contact(first=above, second=below, stiffness=100.0, **options)]


def strips(**options: Any) -> list[Component]:
    above = vv.RectangleMesh(size=(1, 0.1), counts=(1, 1), origin=(0.1, 0.26))
    below = vv.RectangleMesh(size=(1.2, 0.1), counts=(1, 1))
    one, two = solid(above, velocity=(0, -3, 0)), solid(below)
    return [one, two, vv.Contact(first=one, second=two, **options)]


THIN: dict[str, Callable[..., list[Component]]] = {
    "ball and table": ball_and_table,
    "sheet over plate": sheet_over_plate,
    "rigid boxes": two_boxes,
    "strips in the plane": strips,
}


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", THIN)
def test_thin_bodies_fly_freely_until_they_meet(name: str, formulation: str) -> None:
    """They are 0.16 apart and meet after 0.16 / 3 = 0.0533: not a force before that, and one soon after."""
    parts = THIN[name](formulation=formulation, reach=1.5)
    contact, system = contact_of(parts), vv.System(parts)
    start = system.v.copy()
    vv.simulate(system, until=0.052, step=0.013)
    assert not contact.pressures.any()
    assert np.abs(system.v - start).max() < 1e-10
    pressed = []
    vv.simulate(system, until=0.056, step=0.002, observe=lambda _: pressed.append(contact.pressures.max()))
    assert max(pressed) > 0


@pytest.mark.parametrize("name", THIN)
def test_thin_bodies_start_near_each_other(name: str) -> None:
    """By default, 0.16 apart, where the largest facets are larger than that and both bodies together."""
    system = vv.System(THIN[name]())
    vv.simulate(system, until=0.01, step=0.01)


# --- small bodies beside thick ones -------------------------------------------------------------------------
def small_ball(at: Any, velocity: Any) -> vv.RigidBody:
    return vv.RigidBody(shape=vv.Sphere(radius=0.1), mass=1.0, position=at, velocity=velocity)


def past_box(**options: Any) -> list[Component]:
    """Along a face of a box, 0.25 clear of it; the box is 2 wide across."""
    ball, wall = small_ball((-0.6, -3, 0), (0, 3, 0)), box((0.5, 2, 1), 0.0)
    return [ball, wall, vv.Contact(first=ball, second=wall, stiffness=1e5, **options)]


def past_edge(**options: Any) -> list[Component]:
    ball, wall = small_ball((-0.7, -3, 0.45), (0, 3, 0)), box((1, 1, 1), 0.0)
    return [ball, wall, vv.Contact(first=ball, second=wall, stiffness=1e5, **options)]


def spinning_above(**options: Any) -> list[Component]:
    brick = box((0.3, 0.2, 0.1), 0.6, angular_velocity=(3, 5, 2))
    slab = box((4, 4, 0.2), 0.0)
    return [brick, slab, vv.Contact(first=brick, second=slab, stiffness=1e5, **options)]


def solid_past_solid(**options: Any) -> list[Component]:
    """A ball of several elements past a box of one."""
    sphere = vv.SphereMesh(radius=0.1, counts=(1, 2)).build().moved((-0.75, -1.5, 0.2))
    cube = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(-0.5, -0.5, -0.5))
    ball, wall = solid(sphere, velocity=(0, 3, 0)), solid(cube)
    return [ball, wall, vv.Contact(first=ball, first_faces="outer", second=wall, **options)]


BESIDE: dict[str, Callable[..., list[Component]]] = {
    "ball past a box": past_box,
    "ball past an edge": past_edge,
    "brick spinning above a slab": spinning_above,
    "solid ball past one element": solid_past_solid,
}


@pytest.mark.parametrize("options", [{}, {"enforcement": "penalty"}, {"impact": "conserving"}], ids=str)
@pytest.mark.parametrize("name", BESIDE)
def test_small_bodies_fly_freely_beside_thick_ones(name: str, options: Any) -> None:
    """Facets on their rear see as far as the body they belong to, and not into what lies beyond it."""
    parts = BESIDE[name](formulation="mortar", **options)
    contact, system = contact_of(parts), vv.System(parts)
    forces: list[float] = []
    result = vv.simulate(
        system, until=1.0, step=5e-3, observe=lambda _: forces.append(np.abs(contact.forces).max())
    )
    assert result.statistics.rejected == 0
    assert max(forces) == 0.0


def test_a_ball_meets_the_face_it_flies_at() -> None:
    """Not before it is there, after 1.15 at the speed 1; from a wall as heavy as this it flies back."""
    ball = small_ball((-1.5, 0.6, 0), (1, 0, 0))
    wall = vv.RigidBody(shape=vv.Box(size=(0.5, 2, 1)), mass=1e6)
    contact = vv.Contact(first=ball, second=wall, stiffness=1e5, formulation="mortar", impact="conserving")
    system = vv.System([ball, wall, contact])
    vv.simulate(system, until=1.14, step=1e-2)
    assert not contact.pressures.any()
    vv.simulate(system, until=1.3, step=1e-2)
    assert ball.point().position.rate(system.v)[0] < -0.9


def test_overlaps_are_told_where_they_are_in_space() -> None:
    """The message gave the vertex in the ball's own coordinates, near its middle."""
    for formulation in FORMULATIONS:
        ball, table = small_ball((2, 1, 0.58), (0, 0, 0)), box((6, 4, 1), 0.0)
        contact = vv.Contact(first=ball, second=table, stiffness=1e5, formulation=formulation)
        with pytest.raises(InputError, match=r"overlap by 0.0\d+ near \([12]\.?\d*, [01]\.?\d*, 0\.[45]"):
            vv.simulate(vv.System([ball, table, contact]), until=0.01, step=0.01)


# --- how far facets see -------------------------------------------------------------------------------------
def seen(surface: Surface, facing: Array) -> Array:
    """Sights of the facets whose normals are near a direction."""
    corners = surface.places[surface.facets[:, :3]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return surface.sights[normals @ facing > 0.99]


def surface(component: Any, faces: str = "all") -> Surface:
    vv.System([component])
    return surface_of(component, faces, "here")


def test_thickness_and_view_of_a_channel() -> None:
    """A U of walls 0.5 and a floor of 0.25, 1 wide inside: from its walls one sees to the middle of the other wall."""
    mesh = vv.BoxMesh(size=(2, 1, 1), counts=(4, 1, 4)).build()
    centres = mesh.points[mesh.cells["hex8"]].mean(axis=1)
    walls = (np.abs(centres[:, 0] - 1) > 0.5) | (centres[:, 2] < 0.25)
    used, cells = np.unique(mesh.cells["hex8"][walls], return_inverse=True)
    u = surface(solid(vv.Mesh(mesh.points[used], {"hex8": cells.reshape(-1, 8)})))
    right = {tuple(row) for row in seen(u, np.array([1.0, 0, 0])).round(9).tolist()}
    assert right == {(0.5, 1.25), (0.5, np.inf), (2.0, np.inf)}  # inside, outside, and outside of the floor
    down = seen(u, np.array([0.0, 0, -1]))[:, 0].round(9)
    assert set(down.tolist()) == {0.25, 1.0}


def test_thickness_of_a_ball() -> None:
    """Rays along a facet's normal through the faceted ball of radius 1, never longer than its diameter."""
    behind = surface(solid(vv.SphereMesh(radius=1.0, counts=(4, 4))), "outer").sights[:, 0]
    assert behind.max() <= 2.0
    assert behind.min() > 1.5


@pytest.mark.parametrize("first", [1e-2, 1e-6])
def test_rays_of_facets_small_beside_their_body(first: float) -> None:
    """Facets graded to 1e-6 of a unit box see its thickness; rays went in pieces of their size."""
    a = np.concatenate([[0.0], np.geomspace(first, 1.0, 20)])
    n, (y, z) = len(a), np.meshgrid(a, a, indexing="ij")
    corner = (n * np.arange(n - 1)[:, None] + np.arange(n - 1)).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=1)
    places, facets = [], []
    for axis, side in itertools.product(range(3), (0.0, 1.0)):
        face = np.stack([np.full(n * n, side), y.ravel(), z.ravel()], axis=1)
        places.append(np.roll(face, axis, axis=1))
        facets.append(n * n * len(facets) + (quads if side else quads[:, ::-1]))
    begin = time.perf_counter()
    found = _core.sights(3, np.concatenate(places).ravel(), np.concatenate(facets).astype(np.int32).ravel())
    behind, ahead = np.asarray(found).reshape(-1, 2).T
    np.testing.assert_allclose(behind, 1.0, rtol=1e-12)
    assert np.isinf(ahead).all()
    assert time.perf_counter() - begin < 2.0


def test_a_face_alone_does_not_know_its_body() -> None:
    block = solid(vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)))
    assert np.isinf(surface(block, "z1").sights).all()
    assert surface(block).behind == pytest.approx(1.0)


# --- faces of rigid shapes ----------------------------------------------------------------------------------
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("end", [0, 1])
def test_faces_of_a_box_lie_where_their_names_say(axis: int, end: int) -> None:
    body = box((1, 2, 3), 0.0)
    face = surface(body, "xyz"[axis] + str(end))
    assert face.places[:, axis] == pytest.approx((end - 0.5) * (1, 2, 3)[axis])
    assert face.areas.sum() == pytest.approx(6 / (1, 2, 3)[axis])


@pytest.mark.parametrize("shape", [vv.Cylinder(radius=1, length=2), vv.Cone(radius=1, height=2)], ids=str)
def test_faces_of_round_shapes_make_up_their_surface(shape: Any) -> None:
    _, facets = shape.facets()
    named = np.sort(np.concatenate(list(shape.faces.values())))
    assert named.tolist() == list(range(len(facets)))
    body = vv.RigidBody(shape=shape, density=1.0)
    assert np.ptp(surface(body, "z1").places[:, 2]) == pytest.approx(0.0)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_contact_by_faces_of_a_box(formulation: str) -> None:
    """A brick that falls onto a box's named top moves there as it does on the whole box."""
    ends = []
    for faces in ("z1", "all"):
        brick = solid(vv.BoxMesh(size=(0.5, 0.4, 0.3), counts=(2, 2, 1), origin=(-0.2, -0.2, 0.06)))
        table = box((1, 1, 0.1), 0.0)
        contact = vv.Contact(
            first=brick, first_faces="z0", second=table, second_faces=faces, formulation=formulation
        )
        parts = [brick, table, contact, vv.BodyForce(solid=brick, force=(0, 0, -10))]
        system = vv.System(parts)
        vv.simulate(system, until=0.1, step=0.01)
        ends.append(brick.positions(system.x))
        assert brick.velocities(system.x, system.v)[:, 2].mean() > -0.99  # which the force alone gives
    assert np.abs(ends[0] - ends[1]).max() < 1e-7


def test_unknown_faces_of_a_shape_are_refused_with_those_it_has() -> None:
    a, b = box((1, 1, 1), 2.0), box((1, 1, 1), 0.0)
    with pytest.raises(InputError, match=r"no face 'top', but 'z0', 'z1', 'y0'"):
        vv.System([a, b, vv.Contact(first=a, second=b, second_faces="top", stiffness=1.0)])


@pytest.mark.parametrize("impact", ["conserving", "dissipative"])
def test_a_ball_lands_in_the_middle_of_a_box(impact: str) -> None:
    """Its mesh is symmetric about the middle and the diagonals of the box, whose faces are whole facets."""
    mesh = vv.SphereMesh(radius=0.1, counts=(1, 2)).build().moved((0, 0, 0.16))
    ball = solid(mesh, velocity=(0, 0, -3))
    table = box((1, 1, 0.1), 0.0)
    contact = vv.Contact(first=ball, first_faces="outer", second=table, impact=impact)
    pressed = []
    result = vv.simulate(
        vv.System([ball, table, contact]),
        until=0.02,
        step=0.005,
        observe=lambda _: pressed.append(contact.pressures.max()),
    )
    assert max(pressed) > 0
    result.assert_conserved("momentum_z", tolerance=1e-10)
    assert np.diff(result.ledger["total"]).max() < 1e-10


# --- what passes within a step ------------------------------------------------------------------------------
def bullet(**options: Any) -> list[Component]:
    """A block 0.6 high that covers its own height in a step of 0.01, 0.01 before another one."""
    upper = vv.BoxMesh(size=(1, 1, 0.6), counts=(1, 1, 1), origin=(0, 0, 0.61))
    lower = vv.BoxMesh(size=(1.2, 1.1, 0.6), counts=(1, 1, 1), origin=(-0.1, -0.05, 0))
    one, two = solid(upper, velocity=(0, 0, -60), material=STIFF), solid(lower, material=STIFF)
    return [one, two, vv.Contact(first=one, second=two, impact="conserving", **options)]


def through_plate(**options: Any) -> list[Component]:
    """A ball that would be on the other side of an exact plate after a step."""
    mesh = vv.BoxMesh(size=(0.2, 0.2, 0.2), counts=(1, 1, 1), origin=(0, 0, 0.11))
    brick = solid(mesh, velocity=(0, 0, -60), material=STIFF)
    plate = vv.Obstacle(shape=vv.Box(size=(3, 3, 0.1)))
    return [brick, plate, vv.Contact(first=brick, second=plate, impact="conserving", **options)]


FAST: dict[str, Callable[..., list[Component]]] = {
    "mortar": bullet,
    "faces alone": lambda: bullet(first_faces="z0", second_faces="z1", reach=0.3),
    "vertices": lambda: bullet(formulation="node-to-segment"),
    "exact plate": through_plate,
}


@pytest.mark.parametrize("name", FAST)
def test_a_step_in_which_bodies_would_pass_each_other_is_halved(name: str) -> None:
    parts = FAST[name]()
    body = parts[0]
    assert isinstance(body, vv.Solid)
    system = vv.System(parts)
    forces = []
    result = vv.simulate(
        system, until=0.01, step=0.01, observe=lambda _: forces.append(contact_of(parts).pressures.max())
    )
    assert result.statistics.rejected > 0
    assert max(forces) > 0
    result.assert_conserved("energy", tolerance=1e-9)
    assert body.nodal_mass @ body.velocities(system.x, system.v)[:, 2] > -60 * body.mass


@pytest.mark.parametrize(("enforcement", "speed"), [("multipliers", 9.5), ("penalty", 10.0)])
def test_a_block_does_not_jump_over_a_plate_thinner_than_its_vertices_see(
    enforcement: Any, speed: float
) -> None:
    """Fifteen times the plate's thickness in the first step: it would be below as a whole, and untouched.

    By multipliers steps fail by name at 10, whose iterations go to and fro between sets of closed gaps.
    """
    material = vv.NeoHooke(young=1e5, poisson=0.3)
    plate = solid(vv.BoxMesh(size=(1, 1, 0.05), counts=(6, 6, 1)), material=material)
    above = vv.BoxMesh(size=(0.2, 0.2, 0.2), counts=(2, 2, 2), origin=(0.42, 0.42, 0.36))
    block = solid(above, material=material, velocity=(0, 0, -speed))
    contact = vv.Contact(first=block, second=plate, formulation="node-to-segment", enforcement=enforcement)
    system = vv.System([plate, block, contact])
    result = vv.simulate(system, until=0.08, step=0.08)
    assert result.statistics.rejected > 0
    heights = [body.positions(system.x)[:, 2].mean() for body in (plate, block)]
    assert heights[0] < 0.0 < 0.1 < heights[1] - heights[0]
    result.assert_conserved("momentum_z", tolerance=1e-10)


def test_the_message_says_where_they_pass() -> None:
    with pytest.raises(
        StepFailure, match=r"Contact '.*': the surfaces pass through each other within the step, near \("
    ):
        vv.System(bullet()).step(0.01, vv.EnergyMomentum())


def test_a_step_that_goes_too_far_to_be_followed_is_refused() -> None:
    """Its way is 300 times the reach: gaps were evaluated at 600 places along it."""
    parts = bullet(reach=0.02)
    parts[0].velocity = np.array([0.0, 0.0, -600.0])
    with pytest.raises(StepFailure, match="come nearer by more than can be followed in a step, near"):
        vv.System(parts).step(0.01, vv.EnergyMomentum())
