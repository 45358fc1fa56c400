"""What is swept along a round surface of facets stays on it, as far round as it goes."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv


def ring(n: int) -> vv.Mesh:
    """A ring about y, of radii 1 and 1.2, by n bricks."""
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    points = np.array(
        [(r * np.sin(a), y, r * np.cos(a)) for y in (-0.2, 0.2) for r in (1, 1.2) for a in angle]
    )
    cells = [
        [(2 * j + k) * n + i % n for j in (1, 0) for k, i in ((0, c), (0, c + 1), (1, c + 1), (1, c))]
        for c in range(n)
    ]
    return vv.Mesh(points, {"hex8": np.array(cells)})


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
@pytest.mark.parametrize("n", [32, 64])
def test_particle_swept_round_in_a_drum_stays_inside(n: int, step: float) -> None:
    """Five turns by an arm along which it is free. Overlap of impacts at the edges was by the side where the particle
    had come in, which ended 60 degrees on: there it left through the wall. Now it is less than a step's way."""
    omega = 5.0
    drum = vv.Solid(mesh=ring(n), material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3)
    ground, arm = vv.Ground(), vv.RigidBody(shape=vv.Sphere(radius=0.1), mass=1.0)
    axis = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 1, 0), angle=True)
    particle = vv.PointMass(mass=1.0, position=(0, 0, 0.99))
    groove = vv.PointOnLine(a=arm, b=particle, at=(0, 0, 0.5), axis=(0, 0, 1))
    contact = vv.Contact(first=particle, second=drum, stiffness=1e4, formulation="node-to-segment")
    motor = vv.Motor(joint=axis, motion=f"{omega}*t")
    held = vv.Fixed(solid=drum, nodes="all")
    system = vv.System([ground, arm, axis, particle, groove, drum, held, contact, motor])
    result = vv.simulate(system, until=6.0, step=step)
    radius = np.linalg.norm(result.history(vv.Position(of=particle)), axis=1)
    assert radius.max() < 1 + omega * step
    assert radius[len(radius) // 2 :].min() > 0.95
