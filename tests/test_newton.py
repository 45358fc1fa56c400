"""How a step's iteration converges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import visviva as vv


def swing(keep_factor: float) -> tuple[list[list[float]], np.ndarray]:
    """Increments of the steps of a soft cantilever that falls, and where it ends."""
    mesh = vv.BoxMesh(size=(3, 1, 1), counts=(6, 2, 2)).build()
    beam = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0)
    system = vv.System([beam, vv.Fixed(solid=beam, nodes="x0"), vv.Gravity(acceleration=(0, 0, -1.0))])
    system.newton = vv.Newton(keep_factor=keep_factor, max_iterations=40)
    steps = vv.march(system, until=1.0, step=0.1, scheme=vv.EnergyMomentum())
    return [list(next(steps).increments) for _ in range(10)], system.x.copy()


def test_kept_tangents_that_contract_slowly_are_accelerated() -> None:
    """The tenth step begins with a contraction of 0.16, which plain iteration would keep to its end."""
    kept, reached = swing(0.9)
    ratios = [b / a for a, b in pairwise(kept[-1])]
    assert max(ratios[1:3]) > 0.15
    assert np.mean(np.log(ratios[3:])) < np.log(0.1)
    _, exact = swing(0.0)
    np.testing.assert_allclose(reached, exact, atol=1e-12)


def test_drives_are_iterated_until_their_work_is_known() -> None:
    """Of a wheel that a motor turns about a place beside its centre, coordinates are known long before its torque:
    with one iteration more than these need the energy was off by 6e-6."""
    ground, wheel = vv.Ground(), vv.RigidBody(shape=vv.Sphere(radius=0.2), mass=20.0)
    axis = vv.Revolute(a=ground, b=wheel, at=(0, 0, -0.05), axis=(0, 1, 0), angle=True)
    motor = vv.Motor(joint=axis, motion="sin(20*t)+0.5*sin(13*t)")
    result = vv.simulate(vv.System([ground, wheel, axis, motor, vv.Gravity()]), until=4.0, step=0.01)
    assert result.ledger.size("imbalance") < 2e-9
    assert result.statistics.iterations < 4.2 * result.statistics.steps
