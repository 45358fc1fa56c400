"""Rigid boxes by penalties on one floor, against each other and against walls flush with it, and under a lid.

Bodies lie in what carries them by what they sag, lower ends of walls too: these are no seams, all of them push.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

FLOOR = ((3, 1, 0.1), (0, 0, -0.05))
PENALTY = {"enforcement": "penalty"}
CONSERVING = {"impact": "conserving"}


def box(kind: str, size: Any, place: Any, velocity: Any = (0, 0, 0)) -> vv.RigidBody:
    shape: Any = vv.Box(size=size)
    if kind == "mesh":
        points, triangles = shape.surface()
        shape = vv.SurfaceMesh(points=points, triangles=triangles)
    return vv.RigidBody(shape=shape, density=1e3, position=place, velocity=velocity)


def velocities(
    kind: str, fixed: Any, moving: Any, until: float, step: float, exchanged: bool = False, **how: Any
) -> tuple[list[Any], Any]:
    """Of what moves, all of which touches all, and the total energy."""
    ground = vv.Ground()
    floors, boxes = [box(kind, *one) for one in fixed], [box(kind, *one) for one in moving]
    pairs = [(a, b) for a in boxes for b in floors]
    pairs += [(a, b) for i, a in enumerate(boxes) for b in boxes[i + 1 :]]
    contacts = [
        vv.Contact(first=b if exchanged else a, second=a if exchanged else b, stiffness=1e7, **how)
        for a, b in pairs
    ]
    holds = [vv.Rigid(a=ground, b=floor, at=(0, 0, 0)) for floor in floors]
    system = vv.System([ground, *floors, *boxes, *holds, *contacts, vv.Gravity()])
    result = vv.simulate(system, until=until, step=step)
    return [vv.Velocity(of=one)(system) for one in boxes], np.array(result.ledger["total"])


@pytest.mark.parametrize("kind", ["box", "mesh"])
@pytest.mark.parametrize("step", [0.005, 0.002])
def test_boxes_that_collide_on_one_floor_exchange_their_velocities(kind: str, step: float) -> None:
    """Their lower ends lie in the floor, which covers none of them: 0.03 m/s was left, and a sixteenth of it lost."""
    size = (0.4, 0.4, 0.1)
    moving = [(size, (-0.44, 0, 0.05), (1, 0, 0)), (size, (0, 0, 0.05))]
    (one, two), energy = velocities(kind, [FLOOR], moving, 0.1, step, **PENALTY)
    assert one[:2] == pytest.approx((0, 0), abs=1e-4)
    assert two[:2] == pytest.approx((1, 0), abs=1e-4)
    assert energy[-1] == pytest.approx(energy[0], abs=1e-3)


def test_boxes_that_collide_under_a_flush_lid_exchange_their_velocities() -> None:
    size = (0.4, 0.4, 0.1)
    moving = [(size, (-0.23, 0, 0.05), (1, 0, 0)), (size, (0.2, 0, 0.05))]
    lid = ((3, 2, 0.2), (0, 0, 0.2))
    (one, two), _ = velocities("mesh", [FLOOR, lid], moving, 0.1, 0.002, **PENALTY)
    assert one[0] == pytest.approx(0, abs=1e-3)
    assert two[0] == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("kind", ["box", "mesh"])
@pytest.mark.parametrize(
    ("how", "left", "exchanged"),
    [(PENALTY, 1, False), (PENALTY, 1, True), (CONSERVING, 1, False), ({"restitution": 0.5}, 0.5, False)],
)
def test_boxes_bounce_off_a_wall_flush_beside_their_floor(
    kind: str, how: Any, left: float, exchanged: bool
) -> None:
    """The wall goes down as far as the floor, and ends where that does: only there it is covered."""
    fixed = [((2, 1, 0.1), (0, 0, -0.05)), ((2, 0.1, 0.4), (0, 0.55, 0.1))]
    moving = [((0.4, 0.4, 0.1), (-0.3, 0.2877, 0.05), (1, 0.4, 0))]
    (v,), energy = velocities(kind, fixed, moving, 0.1, 0.002, exchanged, **how)
    assert v[:2] == pytest.approx((1, -0.4 * left), abs=1e-4)
    if left == 1:
        assert energy[-1] == pytest.approx(energy[0], abs=1e-3)


@pytest.mark.parametrize("width", [0.8, 1, 3])
def test_boxes_bounce_off_a_wall_at_the_end_of_their_floor(width: float) -> None:
    fixed = [((2, 1, 0.1), (0, 0, -0.05)), ((0.1, width, 0.4), (1.05, 0, 0.1))]
    moving = [((0.4, 0.4, 0.1), (0.76, 0.03, 0.05), (1, 0, 0))]
    (v,), _ = velocities("mesh", fixed, moving, 0.1, 0.002, **PENALTY)
    assert v[:2] == pytest.approx((-1, 0), abs=1e-3)


@pytest.mark.parametrize("kind", ["box", "mesh"])
def test_energy_is_kept_in_the_corner_of_a_room(kind: str) -> None:
    """It rose by a fifth of what moved where walls counted as covered by the floor."""
    fixed = [
        ((2, 2, 0.1), (0, 0, -0.05)),
        ((0.1, 2, 0.5), (1.05, 0, 0.15)),
        ((2.2, 0.1, 0.5), (0.1, 1.05, 0.15)),
    ]
    moving = [((0.4, 0.4, 0.2), (0.79, 0.795, 0.1), (1, 0.7, 0))]
    (v,), energy = velocities(kind, fixed, moving, 0.05, 0.001, **PENALTY)
    assert v[:2] == pytest.approx((-1, -0.7), abs=0.05)
    assert energy.max() < energy[0] + 1e-6 * abs(energy[0])


def test_steps_in_a_floor_are_no_seams() -> None:
    """A thousandth, of floors a hundred times as thick: what runs into it makes no energy, or is refused."""
    fixed = [((0.6, 1, 0.1), (-0.3, 0, 0)), ((0.6, 1, 0.1), (0.3, 0, 1e-3))]
    moving = [((0.4, 0.4, 0.1), (-0.3, 0, 0.1), (1.5, 0, 0))]
    _, energy = velocities("mesh", fixed, moving, 0.2, 0.002, **PENALTY)
    assert energy[-1] < energy[0] + 1e-6


@pytest.mark.parametrize("kind", ["box", "mesh"])
def test_boxes_collide_over_a_seam_as_on_one_floor(kind: str) -> None:
    """Boxes that touch each other cover nothing of each other: one kept .208 of 1 m/s in place of .085."""
    size = (0.4, 0.4, 0.1)
    moving = [(size, (-0.44, 0.1, 0.05), (1, 0, 0)), (size, (0, 0, 0.05))]
    halves = [((1.5, 1, 0.1), (x, 0, -0.05)) for x in (-0.75, 0.75)]
    found = [
        velocities(kind, floors, moving, 0.1, 0.002, exchanged=True, **PENALTY)
        for floors in ([FLOOR], halves)
    ]
    (alone, energy), (over_seam, over) = found
    np.testing.assert_allclose(over_seam, alone, atol=1e-3)
    assert over[-1] == pytest.approx(energy[-1], abs=1e-3)
    assert energy[-1] == pytest.approx(energy[0], abs=1e-3)
