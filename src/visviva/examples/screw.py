"""A body on a vertical screw without friction falls and turns.

The angular acceleration is -m g h / (J + m h^2) with h = pitch / 2 pi.
"""

from __future__ import annotations

import numpy as np

import visviva as vv


def study(
    mass: float = 2.0,
    inertia: float = 0.05,
    pitch: float = 0.3,
    rate: float = 0.0,
    gravity: float = 9.81,
    until: float = 1.0,
    step: float = 0.01,
) -> vv.Study:
    """Nut of `mass` and axial `inertia`, turning with `rate` at the start; gravity along -z."""
    ground = vv.Ground()
    nut = vv.RigidBody(
        mass=mass,
        inertia=(inertia, inertia, inertia),
        shape=vv.Box(size=(0.5, 0.2, 0.1)),
        velocity=(0, 0, pitch / (2 * np.pi) * rate),
        angular_velocity=(0, 0, rate),
        name="nut",
    )
    thread = vv.Screw(a=ground, b=nut, at=(0, 0, 0), axis=(0, 0, 1), pitch=pitch, name="thread")
    system = vv.System([ground, nut, thread, vv.Gravity(acceleration=(0, 0, -gravity))])
    probes = {
        "angle": vv.JointCoordinate(joint=thread),
        "nut": vv.Position(of=nut),
        "tip": vv.Position(of=nut.point((0.25, 0, 0))),
        "force": vv.ReactionForce(joint=thread),
        "torque": vv.ReactionTorque(joint=thread),
    }
    return vv.Study(system, until, step, probes=probes, trails=("tip",), units="SI", title="Screw")


def check(result: vv.Result) -> None:
    """Energy and the thread."""
    result.assert_conserved("energy", "constraints")
