"""Contact of balls and points as it is by default: by their middle, not by facets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

RADII = (0.1, 0.15)


def ball(radius: float, **options: Any) -> vv.RigidBody:
    return vv.RigidBody(shape=vv.Sphere(radius=radius), mass=1.0, **options)


@pytest.mark.parametrize("options", [{}, {"enforcement": "penalty"}], ids=str)
@pytest.mark.parametrize("offset", [0.05, 0.12, 0.2])
def test_an_oblique_impact_of_balls(offset: float, options: Any) -> None:
    """Equal smooth elastic balls exchange their velocities along the line of centres n when they touch."""
    one = ball(RADII[0], position=(-0.5, offset, 0.01), velocity=(1, 0, 0))
    two = ball(RADII[1])
    impact = {} if options else {"impact": "conserving"}
    stiff = 1e7 if options else 1e5
    contact = vv.Contact(first=one, second=two, stiffness=stiff, **impact, **options)
    system = vv.System([one, two, contact])
    vv.simulate(system, until=0.7, step=5e-5 if options else 2e-4)
    across = np.array([0, offset, 0.01])
    n = (across - [np.sqrt(sum(RADII) ** 2 - across @ across), 0, 0]) / sum(RADII)
    v = np.array([1.0, 0, 0])
    assert two.point().position.rate(system.v) == pytest.approx((v @ n) * n, abs=4e-3)
    assert one.point().position.rate(system.v) == pytest.approx(v - (v @ n) * n, abs=4e-3)


def test_what_formulation_is_taken_by_default() -> None:
    """Balls and points have one place where they touch; means over facets of rigid bodies let corners sink."""
    cube = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), mass=1.0)
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1.0, poisson=0)
    )
    rod = vv.RigidBody(shape=vv.Capsule(radius=0.1, length=1), mass=1.0)
    for first in (ball(0.1), vv.PointMass(mass=1.0)):
        for second in (cube, solid, ball(0.2)):
            assert not vv.Contact(first=first, second=second).is_mortar
    for other in (cube, rod):
        assert not vv.Contact(first=other, second=ball(0.2)).is_mortar
        assert vv.Contact(first=other, second=solid).is_mortar
    assert vv.Contact(first=solid, second=ball(0.2)).is_mortar
    assert vv.Contact(first=ball(0.1), second=solid, multipliers="dual").is_mortar


@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_the_penalty_of_a_ball_on_a_solid_goes_with_units(unit: float) -> None:
    """A ball at rest sinks by the same part of its radius in metres and millimetres: stiffness is force by length."""
    mesh = vv.BoxMesh(size=(unit, unit, unit), counts=(2, 2, 2), origin=(-0.45 * unit, -0.4 * unit, -unit))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3))
    sphere = ball(0.1 * unit, position=(0, 0, 0.1 * unit))
    push = vv.Force(on=sphere, force=(0, 0, -100 * unit**2))
    contact = vv.Contact(first=sphere, second=block, enforcement="penalty")
    side = vv.Fixed(solid=block, nodes="all")
    ground = vv.Ground()
    guide = vv.Prismatic(a=ground, b=sphere, at=(0, 0, 0), axis=(0, 0, 1))
    system = vv.System([block, sphere, push, contact, side, ground, guide])
    vv.quasi_static(system, until=1.0, step=1.0)
    size = np.sqrt(0.5) * unit  # the diagonal of a face of the cells
    depth = 100 * unit**2 / (10 * 1e6 * size)
    assert contact.gaps == pytest.approx(-depth, rel=1e-6)
