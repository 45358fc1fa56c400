"""What passes beside a surface that ends, as where faces of a body are named: free, but for what the face carries."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import visviva as vv

SOFT = vv.NeoHooke(young=1e7, poisson=0.3)


def plate(count: int) -> tuple[Any, list[Any]]:
    """One metre wide, rigid or with so many bricks along it, held below; its top is z = 0."""
    if count == 0:
        body, ground = (
            vv.RigidBody(shape=vv.Box(size=(1, 1, 0.1)), density=1e3, position=(0, 0, -0.05)),
            vv.Ground(),
        )
        return body, [ground, vv.Rigid(a=ground, b=body, at=(0, 0, 0))]
    mesh = vv.BoxMesh(size=(1, 1, 0.1), counts=(count, count, 1), origin=(-0.5, -0.5, -0.1))
    solid = vv.Solid(mesh=mesh, material=SOFT, density=1e3)
    return solid, [vv.Fixed(solid=solid, nodes="z0")]


def rotation(turn: float) -> Any:
    """About x = y, by this angle."""
    n, c, s = np.array([1, 1, 0]) / np.sqrt(2), np.cos(turn), np.sin(turn)
    across = np.array([[0, 0, n[1]], [0, 0, -n[0]], [-n[1], n[0], 0]])
    return c * np.eye(3) + s * across + (1 - c) * np.outer(n, n)


def thrown(solid: bool, turn: float, gap: float, velocity: tuple[float, ...]) -> tuple[Any, Any, Any]:
    """A cube that comes down by a gap beside the plate, and where its middle is."""
    turned = rotation(turn)
    half = 0.1 * np.abs(turned).sum(axis=1)
    middle = np.array([0.5 + half[0] + gap, 0.1, half[2] + 0.03])
    if not solid:
        box = vv.RigidBody(
            shape=vv.Box(size=(0.2, 0.2, 0.2)),
            density=1e3,
            position=middle,
            rotation=turned,
            velocity=velocity,
        )
        return box, box, middle
    mesh = vv.BoxMesh(size=(0.2, 0.2, 0.2), counts=(2, 2, 2), origin=(-0.1, -0.1, -0.1)).build()
    moved = replace(mesh, points=mesh.points @ turned.T + middle)
    cube = vv.Solid(mesh=moved, material=SOFT, density=1e3, velocity=velocity)
    return cube, cube.point(tuple(middle)), middle


def on_top(first: vv.Solid | vv.RigidBody, second: vv.Solid, enforcement: Any) -> vv.Contact:
    """Contact of a body with the upper face of another."""
    return vv.Contact(
        first=first,
        second=second,
        second_faces="z1",
        formulation="node-to-segment",
        enforcement=enforcement,
        stiffness=1e7,
    )


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize(("count", "solid"), [(0, False), (1, False), (3, False), (0, True), (3, True)])
@pytest.mark.parametrize(("turn", "gap"), [(0.0, 1e-3), (0.7, 0.1)])
def test_what_passes_beside_a_named_face_is_free(
    enforcement: Any, count: int, solid: bool, turn: float, gap: float
) -> None:
    """It was held by the rounding of the border, thrown up, and left at up to all of its speed aside."""
    body, held = plate(count)
    velocity = np.array([0.1, 0.0, -1.0])
    cube, of, middle = thrown(solid, turn, gap, tuple(velocity))
    contact = on_top(cube, body, enforcement)
    system = vv.System([body, cube, contact, *held])
    vv.simulate(system, until=0.3, step=3e-3)
    assert vv.Position(of=of)(system) == pytest.approx(middle + 0.3 * velocity, abs=1e-8)


@pytest.mark.parametrize("over", [0.1, 0.2])
def test_what_lies_over_the_border_is_carried(over: float) -> None:
    """A block of two bricks a side whose last nodes are beside the face that carries the others: it stays level."""
    body, held = plate(4)
    mesh = vv.BoxMesh(size=(0.2,) * 3, counts=(2, 2, 2), origin=(0.3 + 0.2 * over, -0.1, 0.002))
    block = vv.Solid(mesh=mesh, material=SOFT, density=1e3)
    contact = vv.Contact(first=block, second=body, second_faces="z1", formulation="node-to-segment")
    system = vv.System([body, block, contact, *held, vv.Gravity()])
    vv.simulate(system, until=0.2, step=2e-3)
    left, right = (
        vv.Position(of=block.point((0.3 + 0.2 * over + x, 0, 0.202)))(system)[2] for x in (0.0, 0.2)
    )
    assert [left, right] == pytest.approx([0.2, 0.2], abs=0.01)


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
def test_a_brick_that_falls_on_one_as_wide_is_carried(enforcement: Any) -> None:
    """All its vertices bulge over the border: it fell between both, and steps failed."""
    below = vv.BoxMesh(size=(0.2, 0.2, 0.1), counts=(1, 1, 1), origin=(-0.1, -0.1, -0.1))
    above = vv.BoxMesh(size=(0.2, 0.2, 0.1), counts=(1, 1, 1), origin=(-0.1, -0.1, 0.002))
    low, brick = (vv.Solid(mesh=mesh, material=SOFT, density=1e3) for mesh in (below, above))
    contact = on_top(brick, low, enforcement)
    system = vv.System([low, brick, contact, vv.Fixed(solid=low, nodes="z0"), vv.Gravity()])
    result = vv.simulate(system, until=0.15, step=2e-3)
    total = result.ledger["total"]
    assert brick.positions(system.x)[:4, 2] == pytest.approx([1e-3] * 4, abs=1.1e-3)
    if enforcement == "penalty":
        assert total == pytest.approx(total[0], abs=1e-9)


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("step", [3e-3, 6e-3])
def test_what_is_far_over_a_face_holds_nothing_beside_it(enforcement: Any, step: float) -> None:
    """A flat arm over the face, of a foot that falls beside that: the foot was held by the border's rounding when the
    arm was 0.1 m above, as far as the step searched."""
    body, held = plate(1)
    whole = vv.BoxMesh(size=(0.6, 0.1, 0.2), counts=(3, 1, 2), origin=(0.101, -0.05, 0.05)).build()
    hexahedra = whole.cells["hex8"]
    middles = whole.points[hexahedra].mean(axis=1)
    cells = {"hex8": hexahedra[(middles[:, 0] > 0.5) | (middles[:, 2] > 0.15)]}
    mesh = vv.Mesh(points=whole.points, cells=cells).without_orphans()
    arm = vv.Solid(mesh=mesh, material=SOFT, density=1e3, velocity=(0, 0, -1))
    contact = on_top(arm, body, enforcement)
    system = vv.System([body, arm, contact, *held])
    begin = arm.positions(system.x)
    vv.simulate(system, until=0.09, step=step)
    assert arm.positions(system.x) == pytest.approx(begin - [0, 0, 0.09], abs=1e-12)
