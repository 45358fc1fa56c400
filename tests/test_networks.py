"""Networks of beams: pieces that meet at kinks and branches, joined rigidly, by hinges or elastically."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

C = np.array([200.0, 180, 300, 5, 4, 3])
SOFT = vv.GivenSection(stiffness=C, mass=1.0, moments=(0.03, 0.02, 0.0))
ROOF = vv.Mesh(
    [(-1, 0, 0), (0, 0.75, 0), (1, 0, 0)], {"line2": [(0, 1), (1, 2)]}, node_sets={"walls": np.array([0, 2])}
)


def roof(kinks: Any) -> tuple[vv.Beam, vv.System]:
    """Two bars between walls under a force at the ridge."""
    beam = vv.Beam(mesh=ROOF, section=SOFT, kinks=kinks, first=(0, 0, 1))
    walls = vv.Fixed(solid=beam, nodes="walls")
    flat = vv.SymmetryPlane(solid=beam, nodes="all", normal=(0, 0, 1))
    push = vv.Force(on=beam.point((0, 0.75, 0)), force=(0, -1e-6, 0))
    system = vv.System([beam, walls, flat, push])
    vv.quasi_static(system, until=1.0, step=1.0)
    return beam, system


def test_hinged_bars_are_a_truss() -> None:
    """N = P / (2 sin a) in each bar, and nothing else; the ridge is two nodes at one place."""
    beam, system = roof("hinged")
    assert beam.grid.n_nodes == 4
    found = beam.resultants(system.x)[:, 0]
    np.testing.assert_allclose(found[:, 2], -1e-6 / 1.2, rtol=1e-5)
    assert abs(found[:, [0, 1, 3, 4, 5]]).max() < 1e-11
    np.testing.assert_allclose(beam.positions(system.x)[1], beam.positions(system.x)[3], atol=1e-15)


def test_a_rigid_ridge_carries_a_moment() -> None:
    beam, system = roof("rigid")
    assert abs(beam.resultants(system.x)[:, 0, 3:5]).max() > 1e-8


def test_a_hinged_branch_is_three_beams_with_ball_joints() -> None:
    """Freely flying: the same motion, and energy and momenta stay."""
    points = np.array([(0, 0, 0), (1, 0, 0), (2, 0.8, 0), (1.5, -1, 0.5)], dtype=float)
    pairs = [(0, 1), (1, 2), (1, 3)]

    def swaying(X: Any) -> Any:
        return 0.4 * np.sin(2.0 * X[:, ::-1] + 1.0)

    whole = vv.Beam(mesh=vv.Mesh(points, {"line2": pairs}), section=SOFT, kinks="hinged", velocity=swaying)
    parts = [
        vv.Beam(mesh=vv.LineMesh(points=points[list(pair)]), section=SOFT, velocity=swaying) for pair in pairs
    ]
    balls = [vv.Spherical(a=parts[0], b=other, at=points[1]) for other in parts[1:]]
    one, many = vv.System([whole]), vv.System([*parts, *balls])
    result = vv.simulate(one, until=1.0, step=0.02)
    vv.simulate(many, until=1.0, step=0.02)
    result.assert_conserved("energy", "momentum_x", "angular_z", tolerance=1e-10)
    for k, part in enumerate(parts):
        found = whole.positions(one.x)[whole.line.cells[k]]
        np.testing.assert_allclose(found, part.positions(many.x), atol=1e-9)


def test_an_elastic_connection_turns_by_the_moment_over_its_stiffness() -> None:
    """A cantilever of two beams with a bushing between: the tip goes down by P a^2 / k more than that of one."""
    halves = [vv.LineMesh(points=[(x, 0, 0), (x + 1, 0, 0)], count=4, cell="line3") for x in (0, 1)]
    load, k = 1e-6, 0.5
    one = vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (2, 0, 0)], count=8, cell="line3"), section=SOFT)
    a, b = (vv.Beam(mesh=half, section=SOFT) for half in halves)
    stiff = 1e7
    spring = vv.Bushing(
        a=a, b=b, at=(1, 0, 0), stiffness=(stiff,) * 3, rotational_stiffness=(stiff, k, stiff)
    )
    tips = []
    for beams, others in (([one], []), ([a, b], [spring])):
        push = vv.Force(on=beams[-1].point((2, 0, 0)), force=(0, 0, -load))
        system = vv.System([*beams, *others, vv.Clamped(solid=beams[0], nodes="start"), push])
        vv.quasi_static(system, until=1.0, step=1.0)
        tips.append(float(beams[-1].displacements(system.x)[-1, 2]))
    assert tips[1] - tips[0] == pytest.approx(-load / k, rel=1e-4)
