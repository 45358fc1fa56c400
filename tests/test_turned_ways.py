"""Bodies that turn by much within a step meet what is on their arcs, and nothing that is on the chords of these."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest

import visviva as vv

SPIN = 20.0


def block(kind: str, size: Any, middle: Any) -> list[Any]:
    """A box that is held in its place: one brick, or rigid."""
    if kind == "rigid":
        body = vv.RigidBody(shape=vv.Box(size=size), density=1e3, position=middle, name="post")
        ground = vv.Ground(name="bed")
        return [body, ground, vv.Rigid(a=ground, b=body, at=middle)]
    mesh = vv.BoxMesh(size=size, counts=(1, 1, 1), origin=tuple(np.array(middle) - np.array(size) / 2))
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e9, poisson=0.3), density=1e3, name="post")
    return [solid, vv.Fixed(solid=solid, nodes="z0")]


def swing(
    turn: float, width: float, post: list[Any], is_first: bool, start: float = 0.0, **options: Any
) -> int:
    """Steps that an arm takes which turns about an end, from `start` off that to one metre further, for 2.6 rad."""
    middle = start + 0.5
    arm = vv.RigidBody(
        shape=vv.Box(size=(1, width, width)),
        density=1e3,
        position=(middle, 0, 0),
        angular_velocity=(0, 0, SPIN),
        velocity=(0, SPIN * middle, 0),
    )
    ground = vv.Ground()
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    first, second = (post[0], arm) if is_first else (arm, post[0])
    options = {"formulation": "node-to-segment", **options}
    contact = vv.Contact(first=first, second=second, stiffness=1e6, **options)
    times: list[float] = []
    system = vv.System([ground, arm, hinge, *post, contact])
    n = int(np.ceil(2.6 / turn))
    vv.simulate(system, until=n * turn / SPIN, step=turn / SPIN, observe=lambda s: times.append(s.time))
    spin = float(vv.AngularVelocity(of=arm)(system)[2])
    assert spin < 0 or spin == pytest.approx(SPIN, rel=1e-9)
    return len(times) if spin > 0 else -1


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("faces", ["all", "x1"])
@pytest.mark.parametrize("formulation", ["node-to-segment", "mortar"])
@pytest.mark.parametrize(
    ("width", "turn"), [(0.04, 0.06), (0.04, 0.24), (0.02, 0.18), (0.01, 0.09), (0.01, 0.3), (0.005, 1.0)]
)
def test_an_arm_that_swings_into_a_post_does_not_pass_it(
    width: float, turn: float, formulation: str, faces: str, is_first: bool
) -> None:
    """From the square root of 1.6 widths by lengths on it passed in a step, with a clean audit."""
    post = block("solid", (width, 0.2, 1.0), (0, 0.85, 0))
    named = {"first_faces" if is_first else "second_faces": faces}
    with suppress(vv.StepFailure):
        assert swing(turn, width, post, is_first, formulation=formulation, **named) == -1


@pytest.mark.parametrize("kind", ["rigid", "solid"])
@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("width", [0.01, 0.05])
@pytest.mark.parametrize("turn", [0.1, 0.3, 0.6])
def test_an_arm_that_clears_what_it_swings_by_takes_all_steps(
    turn: float, width: float, is_first: bool, kind: str
) -> None:
    """By a twentieth of its width at its tip and at its side, also where it meets the chord of its arc."""
    tip = np.hypot(1, 0.5 * width)
    for size, middle in (
        ((0.1, 0.1, 1.0), (0, tip + 0.05 + 0.05 * width, 0)),
        ((3.0, 3.0, 0.1), (0, 0, -0.5 * width - 0.05 - 0.05 * width)),
    ):
        assert swing(turn, width, block(kind, size, middle), is_first) == int(np.ceil(2.6 / turn))


@pytest.mark.parametrize("turn", [0.1, 0.3, 0.6])
def test_an_arm_that_goes_round_a_hub_takes_all_steps(turn: float) -> None:
    """The corners of which, 71 mm off the axis, its inner end clears by 29: chords of its arcs lead nearer."""
    hub = block("rigid", (0.1, 0.1, 0.5), (0, 0, 0))
    assert swing(turn, 0.05, hub, False, start=0.1) == int(np.ceil(2.6 / turn))


@pytest.mark.parametrize("turn", [0.1, 0.5])
def test_a_bar_that_flies_turning_over_a_slab_takes_all_steps(turn: float) -> None:
    """Straight in its middle: on an arc it would go in."""
    bar = vv.RigidBody(
        shape=vv.Box(size=(0.5, 0.02, 0.02)),
        density=1e3,
        position=(0, 0, 0.2525),
        velocity=(10.0, 0, 0),
        angular_velocity=(0, SPIN, 0),
    )
    post = block("rigid", (6.0, 1.0, 0.1), (2.0, 0, -0.05))
    times: list[float] = []
    system = vv.System([bar, *post, vv.Contact(first=bar, second=post[0], stiffness=1e6)])
    vv.simulate(system, until=20 * turn / SPIN, step=turn / SPIN, observe=lambda s: times.append(s.time))
    assert len(times) == 20
    assert vv.Velocity(of=bar)(system)[2] == pytest.approx(0, abs=1e-9)
