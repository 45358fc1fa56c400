"""What fits between vertices or nodes that alone touch is refused where it starts."""

from __future__ import annotations

from typing import Any

import pytest
from coarse import bar, coarse_plate, start

import visviva as vv


@pytest.mark.parametrize("kind", [vv.Solid, vv.Shell, vv.Obstacle])
@pytest.mark.parametrize(
    ("shape", "position", "fits"),
    [
        (vv.Box(size=(0.3, 2, 0.3)), (0.25, 0.5, 0.21), True),
        (vv.Box(size=(0.3, 2, 2)), (0.25, 0.5, 1.06), True),
        (vv.Box(size=(0.4, 0.4, 0.4)), (0.25, 0.25, 0.26), True),
        (vv.Box(size=(0.4, 0.4, 0.4)), (0.5, 0.5, 0.26), False),
        (vv.Sphere(radius=0.33), (0.25, 0.25, 0.41), True),
        (vv.Sphere(radius=0.37), (0.25, 0.25, 0.45), False),
        (vv.Box(size=(0.4, 0.4, 0.4)), (2.25, 0.25, 0.26), False),
    ],
)
def test_what_fits_between_vertices_is_refused(kind: Any, shape: Any, position: Any, fits: bool) -> None:
    """Where no step is watched: it fell through, without a word. Over a vertex, and beside it all, it does not."""
    plate = coarse_plate(kind is vv.Shell)
    named: dict[str, Any] = {"first_faces": "upper" if kind is vv.Shell else "z1"}
    other: Any = vv.RigidBody(shape=shape, density=500.0, position=position)
    if kind is vv.Obstacle:
        other = vv.Obstacle(shape=shape, at=position)
    contact = vv.Contact(first=plate, second=other, formulation="node-to-segment", **named)
    parts = [plate, other, vv.Fixed(solid=plate, nodes="all" if kind is vv.Shell else "z0"), contact]
    start(parts, "finer cells" if fits else None)


@pytest.mark.parametrize("faces", ["all", "y1"])
@pytest.mark.parametrize(
    ("width", "place", "fits"), [(0.4, 0.25, True), (0.6, 0.25, False), (0.2, 0.5, False)]
)
def test_what_fits_between_vertices_in_the_plane_is_refused(
    width: float, place: float, fits: bool, faces: str
) -> None:
    lower = vv.RectangleMesh(size=(1, 0.2), counts=(2, 1))
    upper = vv.RectangleMesh(size=(width, 0.6), counts=(4, 2), origin=(place - width / 2, 0.21))
    rubber = vv.NeoHooke(young=1e6, poisson=0.3)
    plate, block = (vv.Solid(mesh=mesh, material=rubber, density=1e3) for mesh in (lower, upper))
    contact = vv.Contact(first=plate, first_faces=faces, second=block, formulation="node-to-segment")
    parts = [plate, block, vv.Fixed(solid=plate, nodes="y0"), contact]
    start(parts, "exchange first and second" if fits else None)


@pytest.mark.parametrize("kind", [vv.Obstacle, vv.RigidBody])
@pytest.mark.parametrize(
    ("shape", "place", "count", "fits"),
    [
        (vv.Box(size=(0.1, 1, 0.1)), (0.1, 0, -0.1), 4, True),
        (vv.Box(size=(0.1, 20, 0.1)), (0.1, 5, -0.1), 4, True),
        (vv.Box(size=(0.1, 1, 0.1)), (0.1, 0, -0.1), 5, False),
        (vv.Box(size=(0.19, 1, 0.1)), (0.125, 0, -0.1), 4, True),
        (vv.Box(size=(0.22, 1, 0.1)), (0.125, 0, -0.1), 4, False),
        (vv.Sphere(radius=0.05), (0.1, 0, 0.1), 4, True),
        (vv.Sphere(radius=0.05), (0.52, 0, -0.1), 4, False),
    ],
)
def test_what_fits_between_nodes_of_a_bar_is_refused(
    kind: Any, shape: Any, place: Any, count: int, fits: bool
) -> None:
    """These are balls a quarter or a fifth of a length apart: the bar fell through what is between them."""
    line, options = bar(count), {"density": 500.0} if kind is vv.RigidBody else {}
    other = kind(shape=shape, **{"position" if options else "at": place}, **options)
    start([line, other, vv.Contact(first=line, second=other)], "give .* more cells" if fits else None)


def test_bars_by_a_penalty_touch_between_their_nodes() -> None:
    """As the refusal says: the stretch over a bar stays above it, less what the penalty gives way."""
    line, peg = bar(4, velocity=(0, 0, -1)), vv.Obstacle(shape=vv.Box(size=(0.1, 1, 0.1)), at=(0.1, 0, -0.1))
    system = vv.System([line, peg, vv.Contact(first=line, second=peg, enforcement="penalty")])
    vv.simulate(system, until=0.15, step=1e-3)
    over = [vv.Position(of=line.point((X, 0, 0)))(system)[2] for X in (0.06, 0.1, 0.14)]
    assert min(over) > -0.05 + 0.9 * 0.02
