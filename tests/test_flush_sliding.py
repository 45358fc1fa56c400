"""Rigid boxes that slide flush on others without friction: nothing acts along their faces, also over edges.

Walls that end at the face still stop what is driven against them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.study.run import run

SIZE = (0.4, 0.4, 0.1)
SHAPES = ["box", "mesh", "finer"]
FEW = {"box": 24, "mesh": 24, "finer": 4}
"""Placements by chance; those of finer meshes are slow."""


def halved(points: list[Any], triangles: list[Any]) -> tuple[list[Any], list[Any]]:
    """Each triangle by the middles of its edges."""
    points, middles, finer = list(points), {}, []

    def middle(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in middles:
            middles[key] = len(points)
            points.append(0.5 * (np.array(points[a]) + points[b]))
        return middles[key]

    for a, b, c in triangles:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return points, finer


def shape_of(kind: str, size: tuple[float, float, float] = SIZE) -> Any:
    """An exact box, the same of 12 triangles, or of 48."""
    box = vv.Box(size=size)
    if kind == "box":
        return box
    points, triangles = box.surface()
    if kind == "finer":
        points, triangles = halved(list(points), list(triangles))
    return vv.SurfaceMesh(points=points, triangles=triangles)


def held(
    kind: str, places: list[float], size: tuple[float, float, float] = SIZE
) -> tuple[list[Any], list[Any]]:
    """Boxes beside each other, and all that holds them."""
    ground, shape = vv.Ground(), shape_of(kind, size)
    below = [vv.RigidBody(shape=shape, density=1e3, position=(x, 0, 0)) for x in places]
    return below, [ground, *below, *(vv.Rigid(a=ground, b=b, at=(0, 0, 0)) for b in below)]


def thrown(
    kind: str, place: Any, angle: float, velocity: Any, spin: float = 0.0, fall: float = 0.0
) -> vv.RigidBody:
    c, s = np.cos(angle), np.sin(angle)
    return vv.RigidBody(
        shape=shape_of(kind),
        density=1e3,
        position=place,
        rotation=[[c, -s, 0], [s, c, 0], [0, 0, 1]],
        velocity=(*velocity, -fall),
        angular_velocity=(0, 0, spin),
    )


def keeps_its_motion(
    kind: str,
    places: list[float],
    above: vv.RigidBody,
    loaded: bool,
    until: float,
    step: float,
    **options: Any,
) -> None:
    """Velocities along the faces, and that about their normal, stay; so does the height."""
    below, parts = held(kind, places, options.get("size", SIZE))
    pairs = [(b, above) if options.get("exchanged") else (above, b) for b in below]
    contacts = [vv.Contact(first=first, second=second, stiffness=1e7) for first, second in pairs]
    system = vv.System([*parts, above, *contacts, *([vv.Gravity()] if loaded else [])])
    before = vv.Velocity(of=above)(system), vv.AngularVelocity(of=above)(system)
    vv.simulate(system, until=until, step=step)
    assert vv.Velocity(of=above)(system) == pytest.approx(before[0], abs=1e-9)
    assert vv.AngularVelocity(of=above)(system) == pytest.approx(before[1], abs=1e-9)
    assert vv.Position(of=above)(system)[2] == pytest.approx(0.1, abs=1e-9)


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("exchanged", [False, True])
def test_boxes_slide_over_edges_of_equal_ones(kind: str, loaded: bool, exchanged: bool) -> None:
    """Corners that came back over an edge were thrown back by the wall that ends there.

    Loaded ones stay with their middles above the lower one, so that they do not tip over.
    """
    for seed in range(FEW[kind] // (2 if exchanged else 1)):
        random = np.random.default_rng(seed)
        angle, spin = random.uniform(0, np.pi), random.uniform(-0.6, 0.6)
        begin, end = random.uniform(-0.17, 0.17, (2, 2))
        velocity = (end - begin) * (1 if loaded else 2)
        above = thrown(kind, (*begin, 0.1), angle, velocity, spin)
        keeps_its_motion(kind, [0], above, loaded, 1.0, 0.04, exchanged=exchanged)


EDGE = 0.2 - 0.4 * np.sqrt(0.5)
"""Where a box turned by 45 degrees has a corner on the edge."""


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize(
    ("place", "angle", "velocity", "spin"),
    [
        ((0, 0), 0, (0.1, 0.2), 0),
        ((0, 0), 0, (0, 0), 0.5),
        ((0.1, 0.1), 0, (-0.3, -0.1), 0.3),
        ((EDGE, 0), np.pi / 4, (-0.2, 0.03), 0.2),
        ((0, 0), np.pi / 4, (0.1, 0.2), 0.3),
    ],
)
def test_boxes_slide_from_where_corners_are_on_edges(
    kind: str, loaded: bool, place: Any, angle: float, velocity: Any, spin: float
) -> None:
    keeps_its_motion(kind, [0], thrown(kind, (*place, 0.1), angle, velocity, spin), loaded, 0.3, 0.01)


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize(
    ("x", "angle", "velocity", "spin"),
    [
        (-0.2, 0, (0.3, 0), 0),
        (-0.2, 0, (0.3, 0.1), 0.2),
        (-0.2 + 1e-12, 0, (0.3, 0), 0),
        (-0.2 - 1e-9, 0, (0.3, 0), 0),
        (-0.25, 0, (1, 0), 0),
        (-0.31, 0.4, (0.5, 0.1), 0.5),
    ],
)
def test_boxes_slide_from_one_to_another_beside_it(
    kind: str, loaded: bool, x: float, angle: float, velocity: Any, spin: float
) -> None:
    """Over the seam, at which faces of both begin steps: the next one stopped it."""
    above = thrown(kind, (x, 0.1, 0.1), angle, velocity, spin)
    keeps_its_motion(kind, [-0.3, 0.3], above, loaded, 0.3, 0.01, size=(0.6, 1, 0.1))


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize(
    ("y", "angle", "width"),
    [(0, 0, 0.5), (0.05, 0, 0.5), (0.06, 0, 0.5), (0.2, 0, 0.5), (0, 0, 0.3), (0.1, 0.4, 0.5)],
)
def test_boxes_slide_over_seams_beside_which_they_stick_out(
    kind: str, loaded: bool, exchanged: bool, y: float, angle: float, width: float
) -> None:
    """Corners of the next one lay on the edge of the wall in front, and stopped it."""
    above = thrown(kind, (-0.3, y, 0.1), angle, (0.7, 0))
    options = {"size": (0.6, width, 0.1), "exchanged": exchanged}
    keeps_its_motion(kind, [-0.3, 0.3], above, loaded, 0.5, 0.5 / 60, **options)


def sunk_in(
    kind: str,
    y: float,
    angle: float,
    width: float,
    exchanged: bool,
    enforcements: Any = ("penalty", "penalty"),
    low: float = 0.0,
) -> tuple[list[Any], vv.RigidBody]:
    """A loaded box on its way over the seams of floors, the first of which carries it by a penalty."""
    places = [0.6 * i - 0.3 for i in range(len(enforcements))]
    ground, shape = vv.Ground(), shape_of(kind, (0.6, width, 0.1))
    heights = [0.0] + [-low] * (len(places) - 1)
    below = [
        vv.RigidBody(shape=shape, density=1e3, position=(x, 0, z))
        for x, z in zip(places, heights, strict=True)
    ]
    above = thrown(kind, (-0.3, y, 0.1), angle, (0.7, 0))
    pairs = [(b, above) if exchanged else (above, b) for b in below]
    contacts = [
        vv.Contact(first=a, second=b, enforcement=how, stiffness=1e7)
        for (a, b), how in zip(pairs, enforcements, strict=True)
    ]
    holds = [vv.Rigid(a=ground, b=b, at=(0, 0, 0)) for b in below]
    return [ground, *below, *holds, above, *contacts, vv.Gravity()], above


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize(
    ("y", "angle", "width"), [(0, 0, 1.0), (0.1, 0.4, 1.0), (0, 0, 0.5), (0.1, 0, 0.5), (0.1, 0.4, 0.3)]
)
def test_boxes_sunk_in_by_a_penalty_slide_over_seams(
    kind: str, exchanged: bool, y: float, angle: float, width: float
) -> None:
    """Corners lay below the top of the next floor by m g / 4 k, and its wall threw them back."""
    parts, above = sunk_in(kind, y, angle, width, exchanged)
    system = vv.System(parts)
    result = vv.simulate(system, until=0.5, step=0.5 / 60)
    assert vv.Velocity(of=above)(system)[:2] == pytest.approx((0.7, 0), abs=1e-3 * 0.7)
    assert vv.Position(of=above)(system)[2] == pytest.approx(0.1, abs=1e-4)
    result.assert_conserved("energy", tolerance=1e-9)


def slides_on(parts: list[Any], above: vv.RigidBody, until: float, step: float, deep: float = 1e-4) -> None:
    """No force along the floors: the velocity along them stays."""
    system = vv.System(parts)
    vv.simulate(system, until=until, step=step)
    assert vv.Velocity(of=above)(system)[:2] == pytest.approx((0.7, 0), abs=1e-3 * 0.7)
    assert vv.Position(of=above)(system)[2] == pytest.approx(0.1, abs=deep)


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("angle", [0, 0.1])
@pytest.mark.parametrize("each", [60, 240, 480, 1000])
def test_boxes_sunk_in_slide_over_seams_with_every_step(
    kind: str, exchanged: bool, angle: float, each: int
) -> None:
    """Corners of a second body fell in the step in which they left the first floor, and met the next one deep."""
    slides_on(*sunk_in(kind, 0, angle, 1.0, exchanged), 0.35, 1 / each)


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("low", [2e-6, 3e-6, 4e-6, 5e-6, 7e-6])
def test_boxes_sunk_in_slide_onto_floors_that_are_lower_by_less(kind: str, low: float) -> None:
    """By 2 to 8e-6: what was above the next one where the step began came down in it, by its wall."""
    slides_on(*sunk_in(kind, 0, 0, 1.0, False, low=low), 0.35, 1 / 240)


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("each", [60, 240])
@pytest.mark.parametrize("enforcements", ["pm", "mp", "pmm", "pmp"])
def test_boxes_sunk_in_slide_onto_floors_of_multipliers(
    kind: str, exchanged: bool, each: int, enforcements: str
) -> None:
    """What lies below these where it comes in stays as deep: the next one stopped it."""
    names = [{"p": "penalty", "m": "multipliers"}[letter] for letter in enforcements]
    until = 0.35 if len(names) == 2 else 1.2
    slides_on(*sunk_in(kind, 0, 0, 1.0, exchanged, names), until, 1 / each)


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("exchanged", [False, True])
def test_runs_over_seams_are_resumed_to_the_bit(kind: str, exchanged: bool, tmp_path: Path) -> None:
    """Cut where corners come to the seam, are at it, and beyond: how deep they lie is known there as before."""

    def study(end: int) -> vv.Study:
        return vv.Study(vv.System(sunk_in(kind, 0.1, 0.4, 1.0, exchanged)[0]), end / 120, 1 / 120)

    whole = run(study(60), tmp_path / "whole", pictures=False)
    for end in (9, 12, 18, 24, 31):
        run(study(end), tmp_path / f"{end}", pictures=False)
        parts = run(study(60), tmp_path / f"{end}", resume=True, pictures=False)
        for name in ("x", "v"):
            np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


@pytest.mark.parametrize("kind", SHAPES[:2])
@pytest.mark.parametrize("high", [1e-3, 0.02])
def test_steps_stop_what_slides_against_them_by_a_penalty(kind: str, high: float) -> None:
    """The same floors, of which the next one is higher, by more than the box has sunk in: 4e-6."""
    below, parts = held(kind, [-0.3], (0.6, 1, 0.1))
    step = vv.RigidBody(shape=shape_of(kind, (0.6, 1, 0.1)), density=1e3, position=(0.3, 0, high))
    above = thrown(kind, (-0.3, 0.05, 0.1), 0, (0.7, 0))
    contacts = [
        vv.Contact(first=above, second=b, enforcement="penalty", stiffness=1e7) for b in [*below, step]
    ]
    hold = vv.Rigid(a=parts[0], b=step, at=(0, 0, 0))
    system = vv.System([*parts, step, hold, above, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.16, step=1 / 400)
    assert vv.Velocity(of=above)(system)[0] < -0.3
    assert vv.Position(of=above)(system)[0] < -0.19


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("angle", [0, 0.3, np.pi / 4])
@pytest.mark.parametrize("low", [1e-6, 1e-3, 0.02, 0.1])
def test_walls_stop_what_is_driven_against_them(kind: str, angle: float, low: float) -> None:
    """A face or a corner in front, whose lower end is by `low` below the upper one of the wall, which is 0.1 high."""
    below, parts = held(kind, [0])
    first = -0.2 * (1 + abs(np.cos(angle)) + abs(np.sin(angle)))  # where it touches
    above = thrown(kind, (first - 0.0437, 0.013, 0.1 - low), angle, (1, 0))
    system = vv.System([*parts, above, vv.Contact(first=above, second=below[0], stiffness=1e7)])
    result = vv.simulate(system, until=0.1, step=0.01)
    assert vv.Velocity(of=above)(system)[0] < 0.5
    assert vv.Position(of=above)(system)[0] < first + 0.06
    energy = result.ledger["total"]
    assert np.diff(energy).max() < 1e-9 * energy[0]


@pytest.mark.parametrize("kind", ["box", "mesh"])
@pytest.mark.parametrize("beyond", [0.0, 1e-9, 1e-6, -1e-12])
def test_corners_at_a_seam_where_a_step_ends_pass_by_a_penalty(kind: str, beyond: float) -> None:
    """As far beyond the seam as it is below the floor or less: the wall there was nearer and threw the box back."""
    below, parts = held(kind, [-0.3, 0.3], (0.6, 1, 0.1))
    above = thrown(kind, (-0.3 + beyond, 0, 0.1), 0, (20, 0))
    contacts = [vv.Contact(first=above, second=b, enforcement="penalty", stiffness=1e7) for b in below]
    system = vv.System([*parts, above, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.01, step=1 / 2000)
    assert vv.Velocity(of=above)(system)[0] == pytest.approx(20, abs=1e-5)


@pytest.mark.parametrize("kind", ["box", "mesh"])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize(
    ("beyond", "each"), [(0.0, 2000), (1e-4, 500), (1e-4, 2000), (1.7e-3, 500), (1.7e-3, 2000)]
)
def test_boxes_that_land_where_they_pass_a_seam_go_on_by_a_penalty(
    kind: str, exchanged: bool, beyond: float, each: int
) -> None:
    """As over one floor: nothing lay in that yet where the step began, and the wall of the next threw them back."""
    below, parts = held(kind, [-0.3, 0.3], (0.6, 1, 0.1))
    above = thrown(kind, (-0.3 + beyond, 0, 0.1 + 1e-4), 0, (20, 0))
    pairs = [(b, above) if exchanged else (above, b) for b in below]
    contacts = [vv.Contact(first=a, second=b, enforcement="penalty", stiffness=1e7) for a, b in pairs]
    system = vv.System([*parts, above, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.01, step=1 / each)
    assert vv.Velocity(of=above)(system)[0] == pytest.approx(20, rel=1e-4)
    assert vv.Position(of=above)(system)[0] == pytest.approx(-0.1 + beyond, abs=1e-5)


@pytest.mark.parametrize("kind", ["box", "mesh"])
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("below_first", [False, True])
@pytest.mark.parametrize(
    ("x", "speed", "fall", "step"),
    [
        (-0.2983, 1.0, 0.0, 0.01),
        (-0.2983, 1.0, 0.0, 0.005),
        (-0.2983, 1.0, 1.0, 0.01),
        (-0.2986, 1.3856, 0.0, 0.01),
        (-0.20109, 1.1954, 0.0, 0.01),
        (-0.2307, 1.8915, 0.0, 0.005),
        (-0.2041, 0.52, 0.0, 0.002),
    ],
)
def test_boxes_that_bounce_over_a_seam_go_on_as_over_one_floor(
    kind: str, exchanged: bool, below_first: bool, x: float, speed: float, fall: float, step: float
) -> None:
    """What is covered by the floor before it was touched as a wall, or an edge: 1 m/s came to -0.25, 0.995, 0.9998."""
    below, parts = held(kind, [-0.3, 0.3], (0.6, 1, 0.1))
    above = thrown(kind, (x, 0, 0.1 + 1e-4), 0, (speed, 0), fall=fall)
    pairs = [(b, above) if exchanged else (above, b) for b in below]
    contacts = [vv.Contact(first=a, second=b, enforcement="penalty", stiffness=1e7) for a, b in pairs]
    bodies = [*parts, above] if below_first else [above, *parts]
    system = vv.System([*bodies, *contacts, vv.Gravity()])
    vv.simulate(system, until=step * np.ceil(0.3 / speed / step), step=step)
    assert vv.Velocity(of=above)(system)[:2] == pytest.approx((speed, 0), abs=1e-9)
    assert vv.Position(of=above)(system)[2] > 0.0995


@pytest.mark.parametrize("kind", ["box", "mesh"])
def test_boxes_by_multipliers_bounce_over_a_seam_as_over_one_floor(kind: str) -> None:
    """They came in between two steps, by the wall, and were thrown back at 4.3 of 4.7 m/s."""
    below, parts = held(kind, [-0.3, 0.3], (0.6, 1, 0.1))
    above = thrown(kind, (-0.21758, 0, 0.1 + 3.277e-5), 0, (4.74, 0))
    contacts = [vv.Contact(first=above, second=b, impact="conserving", stiffness=1e7) for b in below]
    system = vv.System([*parts, above, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.024, step=0.002)
    assert vv.Velocity(of=above)(system)[0] == pytest.approx(4.74, abs=1e-9)
