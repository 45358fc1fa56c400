"""Towers of rigid boxes that are knocked over: what slides off edges and comes back over them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

SIZE = 0.2


def box(facets: bool) -> Any:
    shape = vv.Box(size=(SIZE,) * 3)
    if not facets:
        return shape
    points, corners = shape.facets()
    halves = [[int(c[i]) for i in half] for c in corners for half in ((0, 1, 2), (0, 2, 3))]
    return vv.SurfaceMesh(points=[tuple(float(x) for x in p) for p in points], triangles=halves)


def pushed(n: int, friction: float, facets: bool) -> tuple[vv.System, list[Any]]:
    """Boxes of 8 kg on each other and on a plane, beside each other by chance; the highest is thrown aside."""
    floor, shape, shifts = vv.Plane(), box(facets), 0.01 * np.random.default_rng(1).uniform(-1, 1, (n, 2))
    boxes = [
        vv.RigidBody(
            shape=shape,
            density=1e3,
            position=(*shifts[k], SIZE * (k + 0.5) + 1e-5 * (k + 1)),
            velocity=(1.5, 0.2, 0) if k == n - 1 else (0, 0, 0),
        )
        for k in range(n)
    ]
    pairs = [(b, other) for k, b in enumerate(boxes) for other in (floor, *boxes[:k])]
    contacts = [vv.Contact(first=a, second=b, stiffness=1e6, friction=friction) for a, b in pairs]
    return vv.System([floor, *boxes, *contacts, vv.Gravity()]), boxes


@pytest.mark.parametrize(
    ("n", "step", "friction", "facets"),
    [
        (3, 0.002, 0.0, False),
        (3, 0.005, 0.0, False),
        (3, 0.005, 0.0, True),
        (3, 0.005, 0.3, False),
        (4, 0.005, 0.0, False),
    ],
)
def test_towers_knocked_over_never_gain_energy(n: int, step: float, friction: float, facets: bool) -> None:
    """Without friction the plane leaves momenta along it alone, 12 and 1.6 kg m/s."""
    system, boxes = pushed(n, friction, facets)
    result = vv.simulate(system, until=1.0, step=step)
    energy = result.ledger["total"]
    assert np.diff(energy).max() < 1e-12 * energy[0]
    places = [vv.Position(of=b)(system)[2] for b in boxes]
    assert places[-1] < 0.6 * SIZE
    assert min(places) > 0.5 * SIZE - 3 * step  # by what comes down in a step
    if friction == 0:
        result.assert_conserved("momentum_x", "momentum_y", "angular_z", tolerance=1e-10)
