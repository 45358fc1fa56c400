"""What the check says of contacts that cannot be exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv


def remarks(shape: Any, **options: Any) -> str:
    body, plane = vv.RigidBody(shape=shape, density=1e3, position=(0, 0, 1)), vv.Plane()
    contact = vv.Contact(first=body, second=plane, stiffness=1e4, **options)
    return str(vv.System([body, plane, contact, vv.Gravity()]).check())


OVERLAPS = "an impact leaves RigidBody 'rigidbody-1' overlapping by up to one and a half of the way of a step"
BOX, BALL = vv.Box(size=(0.2, 0.3, 0.1)), vv.Sphere(radius=0.1)


@pytest.mark.parametrize(
    ("shape", "options", "said"),
    [
        (BOX, {}, ["single ones are not determined", OVERLAPS]),
        (BALL, {"restitution": 0.5}, []),
        (BALL, {"impact": "conserving"}, []),
        (BOX, {"enforcement": "penalty", "friction": 0.3}, []),
        (BALL, {"friction": 0.3}, [OVERLAPS]),
        (BALL, {"friction": 0.3, "tangential": "penalty"}, ["elastic slip has no time to rub", OVERLAPS]),
        (BALL, {"friction": 0.3, "tangential": "penalty", "enforcement": "penalty"}, []),
    ],
)
def test_what_the_check_says_of_rigid_contacts(shape: Any, options: dict[str, Any], said: list[str]) -> None:
    found = remarks(shape, **options)
    assert found.count("Contact 'contact-1':") == len(said)
    assert all(words in found for words in said)


@pytest.mark.parametrize(("sides", "friction", "says"), [(12, 0.3, True), (90, 0.3, False), (12, 0.0, False)])
def test_blunt_edges_that_rub_are_named(sides: int, friction: float, says: bool) -> None:
    """A disc of triangles about its middle, whose boundary turns by 30 or by 4 degrees at each node."""
    rubber, turns = vv.NeoHooke(young=1e5, poisson=0.3), np.linspace(0, 2 * np.pi, sides, endpoint=False)
    rim = 0.1 * np.column_stack([np.cos(turns), np.sin(turns)]) + (0, 0.2)
    cells = np.array([(0, 1 + k, 1 + (k + 1) % sides) for k in range(sides)])
    disc = vv.Solid(
        mesh=vv.Mesh(points=np.vstack([[0, 0.2], rim]), cells={"tri3": cells}), material=rubber, density=1e3
    )
    slab = vv.Solid(mesh=vv.RectangleMesh(size=(1, 0.1), counts=(4, 1)), material=rubber, density=1e3)
    contact = vv.Contact(first=disc, second=slab, second_faces="y1", friction=friction, initial="press")
    found = str(vv.System([disc, slab, vv.Fixed(solid=slab, nodes="all"), contact]).check())
    assert ("edges of Solid 'solid-1' of up to 30 degrees count as round" in found) == says


def test_an_impact_without_restitution_leaves_what_the_check_says() -> None:
    """With no weight nothing presses afterwards; the overlap is a part of a step's way, and shrinks with the step."""
    for step in (0.01, 0.001):
        ball = vv.RigidBody(shape=BALL, density=1e3, position=(0, 0, 0.2034), velocity=(0, 0, -1))
        floor = vv.Plane()
        contact = vv.Contact(first=ball, second=floor, stiffness=1e4)
        system = vv.System([ball, floor, contact])
        vv.simulate(system, until=0.2, step=step)
        assert 0 < -contact.gaps[0] <= 1.5 * step
        assert contact.pressures[0] == pytest.approx(0, abs=1e-6)
