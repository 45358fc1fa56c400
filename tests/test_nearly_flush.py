"""Rigid bodies whose faces lie on each other nearly flush rest at their height under their weight, at every turn."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

G = 9.81
BOX = (0.3, 0.3, 0.1)


def lying(
    upper: vv.Box, lower: vv.Box, turn: float, drop: float, speed: float, scale: float = 1, **options: Any
) -> tuple[vv.System, vv.RigidBody, vv.Contact]:
    """One on another that is held, both 0.1 high, turned about the vertical and so high above it.

    A scale is that of lengths, and of times by its root: falls look the same.
    """
    c, s, ground = np.cos(turn), np.sin(turn), vv.Ground()
    below = vv.RigidBody(shape=lower, density=1e3)
    above = vv.RigidBody(
        shape=upper,
        density=1e3,
        position=(0, 0, (0.1 + drop) * scale),
        rotation=[[c, -s, 0], [s, c, 0], [0, 0, 1]],
        velocity=(0, 0, -speed * np.sqrt(scale)),
    )
    contact = vv.Contact(first=above, second=below, stiffness=1e7 * scale**2, **options)
    held = vv.Rigid(a=ground, b=below, at=(0, 0, 0))
    return vv.System([ground, below, above, held, contact, vv.Gravity()]), above, contact


def rests(
    upper: tuple[float, ...],
    lower: tuple[float, ...],
    turn: float,
    drop: float,
    speed: float,
    step: float,
    scale: float = 1,
) -> None:
    """It lies as deep as the impact's step came, and the force is its weight."""
    boxes = [vv.Box(size=tuple(scale * a for a in size)) for size in (upper, lower)]
    system, above, contact = lying(boxes[0], boxes[1], turn, drop, speed, scale)
    h = step * np.sqrt(scale)
    result = vv.simulate(system, until=0.2 * np.sqrt(scale), step=h)
    near = (np.sqrt(speed**2 + 2 * G * drop) + G * step) * step * scale
    assert vv.Position(of=above)(system)[2] == pytest.approx(0.1 * scale, abs=1.5 * near)
    weight = G * 1e3 * np.prod(upper) * scale**3
    assert vv.ContactForce(contact=contact)(system)[2] == pytest.approx(weight, rel=1e-6)
    energy = result.ledger["total"]
    assert np.diff(energy).max() < 1e-9 * weight * 0.1 * scale


TURNS = [0, 1e-8, 1e-7, 1e-6, 2e-6, 1e-5, 1e-4, 1e-3, 9e-3, 1e-2, 1.1e-2, 3e-2]


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize(
    ("drop", "speed", "step"), [(0, 0, 2e-3), (0.02, 0, 2e-3), (0.0005, 2, 2e-3), (0.002, 0, 5e-4)]
)
def test_a_box_that_falls_nearly_flush_on_an_equal_one_rests(
    turn: float, drop: float, speed: float, step: float
) -> None:
    """It fell through where its corners were beside the other face, and its edges next to ends of others."""
    rests(BOX, BOX, turn, drop, speed, step)


@pytest.mark.parametrize("turn", [1e-7, 1e-4, 9e-3])
@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_small_and_large_boxes_rest_nearly_flush(turn: float, scale: float) -> None:
    rests(BOX, BOX, turn, 0.02, 0, 2e-3, scale)


@pytest.mark.parametrize("by", [1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("speed", [0, 2])
@pytest.mark.parametrize("ways", [(1, -1), (1, 0), (-1, 0), (1, 1), (-1, -1), (-0.1, 1)])
def test_a_box_nearly_as_large_rests(by: float, speed: float, ways: tuple[float, float]) -> None:
    """Longer and narrower, or shorter and wider."""
    size = (0.3 + by * ways[0], 0.3 + by * ways[1], 0.1)
    rests(size, BOX, 0.0, 0.0005, speed, 2e-3)


@pytest.mark.parametrize("turn", [1e-8, 1e-7, 1e-6, 1e-5, 1e-3, 9e-3])
@pytest.mark.parametrize("width", [0.05, 0.2])
@pytest.mark.parametrize("exchanged", [False, True])
def test_bars_that_lie_nearly_along_each_other_rest(turn: float, width: float, exchanged: bool) -> None:
    bars = [(1.0, 0.05, 0.1), (1.0 - 1e-8, width, 0.1)]
    rests(*(bars[::-1] if exchanged else bars), turn, 0.002, 0, 2e-3)


@pytest.mark.parametrize("order", [1, -1])
def test_a_cube_rests_on_a_plate_in_both_orders(order: int) -> None:
    """Corners of the cube are in a face of the plate whose vertices are far away: that was refused."""
    plate = vv.RigidBody(shape=vv.Box(size=(2, 2, 0.05)), density=1e3, position=(0, 0, -0.025))
    cube = vv.RigidBody(shape=vv.Box(size=(0.1,) * 3), density=1e3, position=(0.3, 0.2, 0.052))
    ground, (first, second) = vv.Ground(), (plate, cube)[::order]
    contact = vv.Contact(first=first, second=second, stiffness=1e7)
    system = vv.System(
        [ground, plate, cube, contact, vv.Rigid(a=ground, b=plate, at=(0, 0, 0)), vv.Gravity()]
    )
    vv.simulate(system, until=0.2, step=1e-3)
    assert vv.Position(of=cube)(system) == pytest.approx([0.3, 0.2, 0.05], abs=3e-4)
    assert abs(vv.ContactForce(contact=contact)(system)[2]) == pytest.approx(G, rel=1e-6)


def on_solid(size: float, **options: Any) -> vv.System:
    """A rigid plate that falls on a solid, by vertices of the plate."""
    block = vv.Solid(
        mesh=vv.BoxMesh(size=BOX, counts=(3, 3, 1), origin=(-0.15, -0.15, 0)),
        material=vv.NeoHooke(young=1e7, poisson=0.3),
        density=1e3,
    )
    plate = vv.RigidBody(shape=vv.Box(size=(size, size, 0.1)), density=1e3, position=(0, 0, 0.17))
    contact = vv.Contact(first=plate, second=block, formulation="node-to-segment", **options)
    return vv.System([block, plate, contact, vv.Fixed(solid=block, nodes="z0"), vv.Gravity()])


@pytest.mark.parametrize("options", [{}, {"enforcement": "penalty"}])
def test_a_plate_does_not_fall_through_a_solid_by_its_vertices(options: Any) -> None:
    """All of the solid is between these: refused where the whole plate is larger, and else where it sinks."""
    with pytest.raises(vv.InputError, match="larger than all of Solid 'solid-1', which falls between"):
        on_solid(1.0, **options)
    with pytest.raises(vv.StepFailure, match=r"sink into each other .* exchange first and second"):
        vv.simulate(on_solid(0.302, **options), until=0.3, step=2e-3)
