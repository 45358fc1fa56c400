"""Heavy symmetric top of Geradin & Cardona: mass 15, centre of mass at distance 1 from the fixed point."""

from __future__ import annotations

import numpy as np

import visviva as vv


def study(
    spin: float = 150.0,
    precession: float = -4.61538,
    gravity: float = 9.81,
    until: float = 2.0,
    step: float = 0.002,
) -> vv.Study:
    """Spinning about its second axis with `spin`, and about the third with `precession`; gravity along -z."""
    ground = vv.Ground()
    rate = np.array([0.0, spin, precession])
    arm = np.array([0.0, 1.0, 0.0])
    disc = vv.RigidBody(
        mass=15.0,
        inertia=(0.234375, 0.46875, 0.234375),
        shape=vv.Box(size=(0.5, 2.0, 0.5)),
        position=arm,
        velocity=np.cross(rate, arm),
        angular_velocity=rate,
        name="top",
    )
    tip = vv.Spherical(a=ground, b=disc, at=(0, 0, 0), name="tip")
    system = vv.System([ground, disc, tip, vv.Gravity(acceleration=(0, 0, -gravity))])
    probes = {"centre": vv.Position(of=disc), "tip_force": vv.ReactionForce(joint=tip)}
    title = "Heavy top (Geradin & Cardona)"
    return vv.Study(system, until, step, probes=probes, trails=("centre",), units="SI", title=title)


def check(result: vv.Result) -> None:
    """Energy and the momentum about the vertical."""
    result.assert_conserved("energy", "angular_z", "constraints")
