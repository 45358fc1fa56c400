"""Three rods on ball joints, 30 degrees below the horizontal, spinning about their axes (25.74 J in all)."""

from __future__ import annotations

import numpy as np

import visviva as vv

TILT = np.pi / 6
FRAME = np.array(
    [[np.cos(TILT), 0, np.sin(TILT)], [0, 1, 0], [-np.sin(TILT), 0, np.cos(TILT)]]
)  # directors as columns


def study(
    rods: int = 3,
    spin: float = 30.0,
    radius: float = 0.05,
    gravity: float = 9.81,
    until: float = 20.0,
    step: float = 0.01,
) -> vv.Study:
    """`rods` unit rods in line, all with the angular velocity (`spin`, 2, 2.5) along their directors."""
    rate = FRAME @ (spin, 2.0, 2.5)
    along = FRAME[:, 0]
    ground = vv.Ground()
    bodies: list[vv.RigidBody] = []
    joints: list[vv.Spherical] = []
    for k in range(rods):
        centre = (k + 0.5) * along
        rod = vv.RigidBody(
            mass=1.0,
            inertia=(0.5 * radius**2, 1 / 12, 1 / 12),
            shape=vv.Box(size=(1, 2 * radius, 2 * radius)),
            position=centre,
            rotation=FRAME,
            velocity=np.cross(rate, centre),
            angular_velocity=rate,
            name=f"rod {k + 1}",
        )
        joints.append(
            vv.Spherical(a=bodies[-1] if bodies else ground, b=rod, at=k * along, name=f"ball {k + 1}")
        )
        bodies.append(rod)
    system = vv.System([ground, *bodies, *joints, vv.Gravity(acceleration=(0, 0, -gravity))])
    probes = {f"end{k + 1}": vv.Position(of=rod.point((0.5, 0, 0))) for k, rod in enumerate(bodies)}
    trails = (f"end{rods}",)
    return vv.Study(
        system, until, step, probes=probes, trails=trails, units="SI", title="Pendulum of rods on ball joints"
    )


def check(result: vv.Result) -> None:
    """Energy and the momentum about the vertical."""
    result.assert_conserved("energy", "angular_z", "constraints")
