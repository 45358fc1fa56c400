"""Parts of a model that nothing connects are measured each by its own length where they are worlds apart."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from visviva.component.connected import connected, lengths_of_parts

BEAM = 4.0


def beam(thickness: float = 0.1) -> list[vv.Component]:
    """A cantilever of metres, pulled aside by a rigid end."""
    mesh = vv.BoxMesh(size=(BEAM, thickness, thickness), counts=(8, 1, 1), cell="hex20")
    steel = vv.SaintVenantKirchhoff(young=1e9, poisson=0.3)
    solid = vv.Solid(mesh=mesh, material=steel, density=1.0, name="beam")
    end = vv.RigidCoupling(solid=solid, faces="x1", name="end")
    pull = vv.Force(on=end.point(), force=(0, 0, -1e7 * thickness**4), times="t")
    return [solid, vv.Fixed(solid=solid, nodes="x0"), end, pull]


def rock(size: float) -> list[vv.Component]:
    """A mountain."""
    mesh = vv.BoxMesh(size=(size, size, size), counts=(2, 2, 2), origin=(10, 10, 10))
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=1e9, poisson=0.2), density=2e3, name="rock")
    snow = vv.Traction(solid=solid, faces="z1", traction=(0, 0, -1e3), times="t")
    return [solid, vv.Fixed(solid=solid, nodes="z0"), snow]


@pytest.mark.parametrize("size", [4e2, 4e3, 4e4])
def test_a_beam_beside_a_mountain(size: float) -> None:
    """Nothing connects them: each moves as it does alone."""
    ends = []
    for parts in (beam(), beam() + rock(size)):
        system = vv.System(parts)
        vv.quasi_static(system, until=1.0, step=0.25)
        end = parts[2]
        assert isinstance(end, vv.RigidCoupling)
        ends.append(system.value(end.point().position))
    assert ends[0][2] < -1.8
    assert np.abs(ends[0] - ends[1]).max() < 1e-9 * BEAM


def test_what_names_each_other_is_one_part() -> None:
    ground = vv.Ground()
    a, b, c = (vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (0.0, 1.0, 5000.0))
    spring = vv.Spring(a=a.point(), b=b.point(), stiffness=1.0)
    held = [vv.Distance(a=ground.point((x, 1, 0)), b=p.point()) for x, p in ((0, a), (5000, c))]
    components = [ground, a, b, c, spring, *held, vv.Gravity()]
    groups = {frozenset(id(k) for k in part) for part in connected(components)}
    assert {id(k) for k in (a, b, spring, held[0])} in groups
    assert {id(k) for k in (c, held[1])} in groups
    lengths = lengths_of_parts(components, 5000.0)
    assert lengths[id(a)] == lengths[id(spring)] == pytest.approx(1.0)
    assert id(c) not in lengths  # so far from the origin its positions are no better known than that


def test_parts_of_like_size_share_one_length() -> None:
    near = [vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (0.0, 30.0)]
    assert lengths_of_parts(near, 30.0) == {}
