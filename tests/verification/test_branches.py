"""Branches that arc length takes at bifurcations: an elastica, and a truss of two springs in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import visviva as vv


@pytest.mark.parametrize(
    ("branch", "rigid", "weight"),
    [(0.02, (), 0.0), (-0.02, (), 0.0), (0.02, ("stretch",), 0.01), (-0.02, ("stretch", "shear"), 0.01)],
)
def test_column_buckles_into_the_elastica(branch: float, rigid: Any, weight: float) -> None:
    """P = (2 K / pi)^2 P_cr, top at (2 k / K, 2 E / K - 1) with k = sin(a / 2) of the slope a at the free end."""
    stiff = 1e5
    section = vv.GivenSection(stiffness=(stiff, stiff, stiff, 1.0, 10.0, 10.0))
    mesh = vv.LineMesh(points=[(0, 0, 0), (0, 0, 1)], count=12, cell="line3")
    column = vv.Beam(mesh=mesh, section=section, first=(1, 0, 0), rigid=rigid)
    press = vv.Force(on=column.point((0, 0, 1)), force=(0, 0, -1), times="t")
    system = vv.System([column, vv.Clamped(solid=column, nodes="start"), press])
    scheme = vv.ArcLength(branch=branch, longest=8.0, load_weight=weight)
    if rigid:
        with pytest.raises(vv.InputError, match="count the load in the arc"):
            vv.arc_length(system, step=0.7, until=4.0)
    result = vv.arc_length(system, step=0.7, until=4.0, scheme=scheme, steps=120)
    top = result.history(column.point_at((0, 0, 1)).position)
    bent = np.abs(top[:, 1]) > 0.05
    assert np.all(np.sign(top[bent, 1]) == np.sign(top[bent, 1][0]))
    assert bent.sum() > 5
    assert np.abs(top[bent, 1]).max() > 0.6
    for load, (_, y, z) in zip(np.array(result.times)[bent], top[bent], strict=True):
        m = brentq(lambda m, p=load: (2 * ellipk(m) / np.pi) ** 2 * np.pi**2 / 4 - p, 1e-9, 0.99)
        K = ellipk(m)
        assert abs(y) == pytest.approx(2 * np.sqrt(m) / K, abs=4e-3)
        assert z == pytest.approx(2 * ellipe(m) / K - 1, abs=4e-3)


def truss(rise: float) -> tuple[vv.System, vv.PointMass, float]:
    ground, tip = vv.Ground(), vv.PointMass(mass=1.0, position=(0, rise, 0))
    length = float(np.hypot(1, rise))
    springs = [
        vv.Spring(a=ground.point((x, 0, 0)), b=tip.point(), stiffness=100.0, free_length=length)
        for x in (-1, 1)
    ]
    plane = vv.PointOnPlane(a=ground.frame(), b=tip.point())
    pull = vv.Force(on=tip.point(), force=(0, -1, 0), times="t")
    return vv.System([ground, tip, *springs, plane, pull]), tip, length


def test_steep_truss_gives_way_sideways() -> None:
    """It bifurcates where l^3 = l0 y^2; beside, forces across vanish: (1 - l0/l1) (1 + x) = (1 - l0/l2) (1 - x)."""
    system, tip, length = truss(3.0)
    result = vv.arc_length(
        system,
        step=5.0,
        steps=80,
        scheme=vv.ArcLength(branch=0.05, longest=2.0),
        stop=lambda s: s.value(tip.point().position)[1] < 0.5,
    )
    x, y = result.history(tip.point().position)[:, :2].T
    height = brentq(lambda h: np.hypot(1, h) ** 3 - length * h**2, 2.0, 3.0)
    beside = np.abs(x) > 1e-3
    assert beside.sum() > 5
    assert y[~beside].min() == pytest.approx(height, abs=0.02)
    ends = np.hypot(1 + x, y)[beside], np.hypot(1 - x, y)[beside]
    across = (1 - length / ends[0]) * (1 + x[beside]) - (1 - length / ends[1]) * (1 - x[beside])
    np.testing.assert_allclose(across, 0.0, atol=1e-8)
    down = 100.0 * sum((length / end - 1) * y[beside] for end in ends)
    np.testing.assert_allclose(np.array(result.times)[beside], down, atol=1e-6)


def test_limit_points_are_no_forks() -> None:
    """A shallow truss snaps through upright, though it is asked for branches."""
    shallow, tip, length = truss(0.4)
    result = vv.arc_length(
        shallow,
        step=0.2,
        steps=300,
        scheme=vv.ArcLength(branch=0.05, longest=2.0),
        stop=lambda s: s.value(tip.point().position)[1] < -0.45,
    )
    x, y = result.history(tip.point().position)[:, :2].T
    np.testing.assert_allclose(x, 0.0, atol=1e-9)
    assert y[-1] < -0.45
    np.testing.assert_allclose(result.times, 200 * (length / np.hypot(1, y) - 1) * y, atol=1e-6)
