"""Bodies that slide on a floor into a wall of the same body: an impact, however far the step goes beyond it."""

from __future__ import annotations

import pytest

import visviva as vv


def corner() -> vv.RigidBody:
    """A floor z = 0 that ends in a wall x = 0, of one closed surface."""
    profile = [(-2, -0.5), (0.5, -0.5), (0.5, 1), (0, 1), (0, 0), (-2, 0)]
    n = len(profile)
    points = [(x, y, z) for y in (-1, 1) for x, z in profile]
    front = [(0, 4, 5), (0, 1, 4), (1, 2, 4), (2, 3, 4)]
    sides = [f for i in range(n) for j in [(i + 1) % n] for f in ((i, n + i, j), (j, n + i, n + j))]
    triangles = [*front, *((n + a, n + c, n + b) for a, b, c in front), *sides]
    return vv.RigidBody(shape=vv.SurfaceMesh(points=points, triangles=triangles), density=1e3)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("start", [-0.5037, -0.506, -0.5])
@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_a_wall_throws_back_by_its_restitution(radius: float, start: float, restitution: float) -> None:
    """The share of the approach that came back depended on where in the step the wall is; points went through it."""
    place, moves = (start - radius, 0.01, radius), {"mass": 1.0, "velocity": (1.0, 0, 0)}
    slider: vv.PointMass | vv.RigidBody = vv.PointMass(position=place, **moves)
    if radius:
        slider = vv.RigidBody(shape=vv.Sphere(radius=radius), position=place, **moves)
    ground, body = vv.Ground(), corner()
    weld = vv.Rigid(a=ground, b=body, at=(0, 0, 0))
    contact = vv.Contact(first=slider, second=body, stiffness=1e4, restitution=restitution)
    system = vv.System([ground, body, weld, slider, contact, vv.Gravity()])
    result = vv.simulate(system, until=0.9, step=0.01)
    x = result.history(vv.Position(of=slider))[:, 0]
    assert (x[-1] - x[-11]) / 0.1 == pytest.approx(-restitution, abs=1e-6)
    assert x.max() + radius <= 1.5 * 0.01
    assert result.conservation()["energy"] < 1e-9
