"""Simple pendulum of the IFToMM benchmark library (A01): a point mass on a massless bar, starting at rest.

The exact motion is an elliptic function: the period from `angle` 90 degrees is 2.36784194757623745 s.
"""

from __future__ import annotations

import numpy as np

import visviva as vv


def study(
    mass: float = 1.0,
    length: float = 1.0,
    gravity: float = 9.81,
    angle: float = 90.0,
    until: float = 10.0,
    step: float = 0.01,
) -> vv.Study:
    """Released from rest at `angle` degrees from the downward vertical, towards -x; gravity along -y."""
    phi = np.radians(angle)
    ground = vv.Ground()
    bob = vv.PointMass(mass=mass, position=(-length * np.sin(phi), -length * np.cos(phi), 0), name="bob")
    bar = vv.Distance(a=ground.point(), b=bob.point(), length=length, name="bar")
    system = vv.System([ground, bob, bar, vv.Gravity(acceleration=(0, -gravity, 0))])
    force = vv.ReactionForce(joint=bar)
    probes = {
        "bob": vv.Position(of=bob),
        "bar_force": force,
        "tension": vv.Formula(formula="sqrt(f_x**2 + f_y**2 + f_z**2)", of={"f": force}),
    }
    title = "Simple pendulum (IFToMM A01)"
    return vv.Study(system, until, step, probes=probes, trails=("bob",), units="SI", title=title)


def check(result: vv.Result) -> None:
    """Energy, and the angular momentum that vanishes in the plane of motion."""
    result.assert_conserved("energy", "constraints")
    assert abs(result.states[-1][2]) < 1e-12
