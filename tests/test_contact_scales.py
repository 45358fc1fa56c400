"""Contact of small, far, thin and fine things: nothing is judged by what has nothing to do with it."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

import visviva as vv

RUBBER = vv.NeoHooke(young=1e6, poisson=0.3)


@pytest.mark.parametrize("micrometre", [1.0, 1e6])
@pytest.mark.parametrize("stiffness", [1e-3, 1e3, 1e5])
def test_small_balls_leave_with_their_restitution_and_are_not_held(
    micrometre: float, stiffness: float
) -> None:
    """Of a silicon ball of 10 micrometres half the velocity is left, and no pressure pulls."""
    um = micrometre
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=1e-5 * um),
        density=2330.0 / um**3,
        position=(0, 0, 3e-5 * um),
        velocity=(0, 0, -1e-3 * um),
    )
    floor = vv.Plane()
    contact = vv.Contact(first=ball, second=floor, stiffness=stiffness, restitution=0.5)
    system = vv.System([ball, floor, contact])
    pressures: list[float] = []
    vv.simulate(
        system, until=0.03, step=1e-4, observe=lambda s: pressures.append(float(contact.pressures[0]))
    )
    assert system.v[2] == pytest.approx(0.5e-3 * um, rel=1e-9)
    assert min(pressures) >= 0


def test_a_ball_bounces_off_rubber_alike_in_metres_and_micrometres() -> None:
    """The little give that the tangent has is of the mass of a facet's layer: with that by area Newton crept."""
    ends, iterations = [], []
    for um in (1.0, 1e6):
        mesh = vv.BoxMesh(size=(0.4 * um, 0.4 * um, 0.2 * um), counts=(2, 2, 1))
        rubber = vv.NeoHooke(young=1e5 / um, poisson=0.3)
        block = vv.Solid(mesh=mesh, material=rubber, density=1000 / um**3)
        place, velocity = (0.17 * um, 0.13 * um, 0.26 * um), (0.3 * um, 0, -um)
        shape = vv.Sphere(radius=0.05 * um)
        ball = vv.RigidBody(shape=shape, density=1000 / um**3, position=place, velocity=velocity)
        contact = vv.Contact(first=ball, second=block, second_faces="z1", restitution=0.5)
        system = vv.System([block, ball, vv.Fixed(solid=block, nodes="z0"), contact])
        statistics = vv.simulate(system, until=0.06, step=0.004).statistics
        ends.append(ball.point().position.value(system.x) / um)
        iterations.append(statistics.iterations)
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)
    assert iterations[1] <= 1.1 * iterations[0]  # what is left is rounding


@pytest.mark.parametrize(("unit", "away"), [(3.0, 0), (10.0, 0), (1e3, 0), (1.0, 1e3)])
def test_gaps_that_close_at_the_end_of_a_step_are_closed_in_all_units(unit: float, away: float) -> None:
    """Rounding left some of them open, whose nodes then felt the impact a step later than others."""
    assert landing(unit, away) == pytest.approx(landing(1.0, 0), abs=1e-10)


def landing(unit: float, away: float) -> float:
    """Way of a block that falls onto another with a velocity that closes its gap in two steps, in units of length."""
    rubber = vv.NeoHooke(young=1e5 / unit, poisson=0.3)
    lower = vv.BoxMesh(size=(unit, unit, 0.3 * unit), counts=(2, 2, 1)).build()
    upper = vv.BoxMesh(size=(0.6 * unit, 0.6 * unit, 0.3 * unit), counts=(2, 2, 1)).build()
    place = unit * np.array([away, away, away])
    base = vv.Solid(mesh=lower.moved(place), material=rubber, density=1e3 / unit**3)
    block = vv.Solid(
        mesh=upper.moved(place + unit * np.array([0.2, 0.2, 0.31])),
        material=rubber,
        density=1e3 / unit**3,
        velocity=(0, 0, -unit),
    )
    contact = vv.Contact(first=base, first_faces="z1", second=block, second_faces="z0", impact="conserving")
    system = vv.System([base, block, vv.Fixed(solid=base, nodes="z0"), contact])
    height = vv.simulate(system, until=0.1, step=0.005).history(vv.CentreOfMass(of=block))[:, 2]
    return float(height[-1] - height[0]) / unit


@pytest.mark.parametrize("start", [0.0, 1.0])
def test_overlap_at_the_start_is_refused_whatever_the_time(start: float) -> None:
    lower = vv.Solid(mesh=vv.BoxMesh(size=(2, 2, 1), counts=(2, 2, 1)), material=RUBBER, density=1.0)
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1)).build().moved((0.5, 0.5, 0.8))
    upper = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    contact = vv.Contact(first=upper, first_faces="z0", second=lower, second_faces="z1")
    system = vv.System([lower, upper, contact])
    system.time = start
    with pytest.raises(vv.InputError, match=r"overlap by 0\.2"):
        vv.simulate(system, until=start + 0.1, step=0.01)


def steps_of(parts: list[Any], until: float, step: float) -> tuple[int, int]:
    statistics = vv.simulate(vv.System(parts), until=until, step=step).statistics
    return statistics.steps, statistics.rejected


@pytest.mark.parametrize("thickness", [0.1, 1e-3, 1e-6])
def test_thin_sheets_do_not_slow_what_flies_away(thickness: float) -> None:
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().moved((0, 0, 5))
    block = vv.Solid(mesh=mesh, material=RUBBER, density=1e3, velocity=(0, 0, 20.0))
    sheet = vv.Obstacle(shape=vv.Box(size=(1, 1, thickness)))
    assert steps_of([block, sheet, vv.Contact(first=block, second=sheet)], 0.2, 0.01) == (20, 0)


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("shape", [vv.Sphere(radius=1e-4), vv.Cylinder(radius=1e-4, length=1e-4)])
def test_small_shapes_do_not_slow_what_passes_far_away(shape: Any, enforcement: Any) -> None:
    ball = vv.PointMass(mass=1.0, position=(100, 0, 0), velocity=(0, 50, 0))
    stone = vv.Obstacle(shape=shape)
    contact = vv.Contact(first=ball, second=stone, stiffness=1e5, enforcement=enforcement)
    assert steps_of([ball, stone, contact], 1.0, 0.1) == (10, 0)


def test_what_would_pass_through_a_sheet_is_still_stopped() -> None:
    ball = vv.PointMass(mass=1.0, position=(0.013, 0.02, 0.21), velocity=(0, 0, -1.0))
    sheet = vv.Obstacle(shape=vv.Box(size=(1, 1, 0.01)))
    contact = vv.Contact(first=ball, second=sheet, stiffness=1e3, restitution=1.0)
    system = vv.System([ball, sheet, contact])
    result = vv.simulate(system, until=0.5, step=0.05)
    assert result.statistics.rejected > 0
    assert system.v[2] == pytest.approx(1.0)


def plate(n: int) -> vv.SurfaceMesh:
    """A plate of 2 (n + 1)^2 vertices."""
    shape = vv.BoxMesh(size=(2, 2, 0.1), counts=(n, n, 1), origin=(-1, -1, -0.05)).build()
    quads = np.concatenate(list(shape.boundary().cells.values()))
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return vv.SurfaceMesh(points=shape.points, triangles=triangles)


def test_fine_surfaces_cost_in_proportion_to_their_vertices() -> None:
    """Sixteen times the vertices take less than a hundred times as long, not 256 times."""
    spent = []
    for n in (10, 43):
        slab = vv.RigidBody(shape=plate(n), density=1.0, position=(0, 0, 0.0501))
        table = vv.Obstacle(shape=vv.Box(size=(4, 4, 1)), at=(0, 0, -0.5))
        contact = vv.Contact(first=slab, second=table, enforcement="penalty", stiffness=1.0)
        system = vv.System([slab, table, contact, vv.Gravity()])
        vv.simulate(system, until=0.05, step=0.005)
        begin = time.process_time()
        vv.simulate(system, until=0.1, step=0.005)
        spent.append(time.process_time() - begin)
    assert spent[1] < 100 * spent[0]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("enforcement", ["penalty", "multipliers"])
def test_plane_solids_touch_alike_whatever_their_thickness(enforcement: str, friction: float) -> None:
    """Loads, masses and stiffnesses are in proportion to it; so are the default penalty and augmentation."""
    ends = []
    for thickness in (1e-3, 1.0, 1e3):
        made: dict[str, Any] = {
            "material": RUBBER,
            "density": 1000.0,
            "plane": "stress",
            "thickness": thickness,
        }
        block = vv.Solid(mesh=vv.RectangleMesh(size=(1, 1), counts=(3, 3)), **made)
        floor = vv.Solid(mesh=vv.RectangleMesh(size=(2, 1), counts=(2, 1), origin=(-0.5, -1.001)), **made)
        chosen: dict[str, Any] = {"enforcement": enforcement, "friction": friction}
        contact = vv.Contact(first=block, first_faces="y0", second=floor, second_faces="y1", **chosen)
        push = vv.BodyForce(solid=block, force=(2e4 * (friction > 0), -5e4, 0))
        system = vv.System([block, floor, contact, vv.Fixed(solid=floor, nodes="y0"), push])
        vv.simulate(system, until=0.1, step=0.01)
        ends.append(block.displacements(system.x))
        assert np.abs(ends[-1][:, 1]).max() > 0.03
    assert np.allclose(ends[0], ends[1], rtol=0, atol=1e-8)
    assert np.allclose(ends[2], ends[1], rtol=0, atol=1e-8)


@pytest.mark.parametrize("formulation", ["mortar", "node-to-segment"])
def test_default_penalties_do_not_know_how_wide_a_rigid_floor_is(formulation: Any) -> None:
    """The layer that gives them is one of the block, not of facets of what is rigid."""
    found = []
    for wide in (1.0, 10.0, 100.0):
        floor = vv.RigidBody(shape=vv.Box(size=(wide, wide, 0.3)), density=30.0, position=(0.5, 0.45, -0.15))
        mesh = vv.BoxMesh(size=(0.4, 0.3, 0.2), counts=(4, 3, 2), origin=(0.3, 0.31, 0.0))
        block = vv.Solid(mesh=mesh, material=RUBBER, density=1000.0)
        chosen: dict[str, Any] = {"enforcement": "penalty", "formulation": formulation}
        touch = vv.Contact(first=block, first_faces="z0", second=floor, **chosen)
        hold = vv.Rigid(a=vv.Ground(), b=floor, at=(0, 0, -0.3))
        guides = [
            vv.SymmetryPlane(solid=block, nodes=side, normal=n)
            for side, n in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)))
        ]
        system = vv.System([block, floor, touch, hold, *guides, vv.Gravity()])
        vv.quasi_static(system, until=1.0, step=1.0)
        found.append(float(block.displacements(system.x)[:, 2].min()))
    assert found == pytest.approx([found[0]] * 3, rel=1e-6)
    assert -5e-4 < found[0] < 0
