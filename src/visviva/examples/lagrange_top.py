"""Lagrange's top: a cone on its tip, spinning so that it precesses steadily, or started without precession.

Steady precession with 10 rad/s at 60 degrees needs the spin 135.6 rad/s; without initial precession the same
top falls and rises periodically, with cusps in the path of its axis.
"""

from __future__ import annotations

import numpy as np

import visviva as vv


def study(
    nutation: float = 60.0,
    precession: float = 10.0,
    spin: float = 135.6,
    gravity: float = 9.81,
    until: float = 1.2,
    step: float = 0.001,
) -> vv.Study:
    """Cone (radius 0.05, height 0.1, density 2700) tilted by `nutation` degrees; precession 0: cusps."""
    c, s = np.cos(np.radians(nutation)), np.sin(np.radians(nutation))
    tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    ground = vv.Ground()
    cone = vv.RigidBody(
        shape=vv.Cone(radius=0.05, height=0.1),
        density=2700.0,
        rotation=tilt,
        angular_velocity=np.array([0, 0, precession]) + spin * tilt[:, 2],
        name="cone",
    )
    tip = vv.Spherical(a=ground, b=cone, at=(0, 0, 0), name="tip")
    system = vv.System([ground, cone, tip, vv.Gravity(acceleration=(0, 0, -gravity))])
    centre = vv.Position(of=cone.point((0, 0, 0.075)))
    probes = {"centre": centre, "tip_force": vv.ReactionForce(joint=tip)}
    return vv.Study(
        system, until, step, probes=probes, trails=("centre",), units="SI", title="Lagrange's top"
    )


def check(result: vv.Result) -> None:
    """Energy and the momentum about the vertical."""
    result.assert_conserved("energy", "angular_z", "constraints")
