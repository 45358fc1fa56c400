"""What friction brings to rest stays at rest, with the force that equilibrium asks for."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv


def block(
    velocity: tuple[float, float, float], gravity: tuple[float, float, float], friction: float
) -> vv.System:
    box = vv.RigidBody(
        shape=vv.Box(size=(0.4, 0.2, 0.1)), density=100.0, position=(0, 0, 0.05), velocity=velocity
    )
    floor = vv.Plane()
    rub = vv.Contact(first=box, second=floor, friction=friction, stiffness=1e4)
    return vv.System([box, floor, rub, vv.Gravity(acceleration=gravity)])


@pytest.mark.parametrize("step", [0.0082, 0.0066])
def test_a_box_that_slid_to_rest_feels_no_friction(step: float) -> None:
    """It alternated from step to step by up to the limit, which no shorter step cured."""
    system = block((1, 0, 0), (0, 0, -9.81), 0.3)
    (rub,) = (c for c in system.components if isinstance(c, vv.Contact))
    result = vv.simulate(system, until=200 * step, step=step, record={"force": vv.ContactForce(contact=rub)})
    assert system.x[0] == pytest.approx(1 / (2 * 0.3 * 9.81), rel=2e-3)
    limit = 0.3 * 0.8 * 9.81
    assert np.abs(result.history("force")[-10:, 0]).max() < 1e-3 * limit
    assert np.abs(system.v[:3]).max() < 1e-3 * 0.3 * 9.81 * step


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_box_that_came_to_rest_on_a_slope_is_held(way: float) -> None:
    """Downhill and uphill: friction is m g sin a, and has never given energy."""
    a = 0.5
    system = block((way, 0.3, 0), (9.81 * np.sin(a), 0, -9.81 * np.cos(a)), 0.7)
    (rub,) = (c for c in system.components if isinstance(c, vv.Contact))
    result = vv.simulate(system, until=2.0, step=0.0082, record={"force": vv.ContactForce(contact=rub)})
    held = 0.8 * 9.81 * np.sin(a)
    np.testing.assert_allclose(result.history("force")[-10:, 0], -held, rtol=1e-2)
    result.assert_conserved("energy", tolerance=1e-10)


def test_a_ball_that_slid_rolls() -> None:
    """v = 5 / 7 v0 + 2 / 7 w0 r, and both v and w are steady."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.05),
        density=1000.0,
        position=(0, 0, 0.05),
        velocity=(1, 0, 0),
        angular_velocity=(3, -10, 5),
    )
    floor = vv.Plane()
    rub = vv.Contact(first=ball, second=floor, friction=0.2, stiffness=1e4)
    system = vv.System([ball, floor, rub, vv.Gravity()])
    spins = []
    vv.simulate(system, until=0.3, step=0.001, observe=lambda s: spins.append(vv.AngularVelocity(of=ball)(s)))
    np.testing.assert_allclose(spins[-4:], [(6 / 7, 80 / 7, 5.0)] * 4, rtol=1e-3)
