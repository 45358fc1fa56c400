"""Rotary crane of Hesch & Betsch (2012), section 4.1: girder, trolley, winch and a load on a rope.

What the paper's text leaves open is chosen as follows. The girder turns about e3 through its centre of mass
and is long along its own second director, where Table 1 has the large Euler value; crane angle zero is along
e1. The winch sits in the trolley's centre, its axis is horizontal across the girder and is its third
principal axis (J = 0.02). The rope leaves at the winch's centre and is vertical at the start.
"""

from __future__ import annotations

from typing import Any

import visviva as vv

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
ALONG = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))  # directors as columns: the second along e1
ACROSS = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))  # the third along e2


def study(
    omega: float = 1.32,
    stroke: float = 1.5,
    gravity: float = 9.81,
    length: float = 1.2,
    radius: float = 0.1,
    winch: str = "free",
    until: float = 2.0,
    step: float = 0.01,
) -> vv.Study:
    """The crane slewing at `omega` with its trolley at `stroke`; the winch is 'free' or 'locked'."""
    if winch not in ("free", "locked"):
        raise vv.InputError(f"winch = {winch!r}: choose 'free' or 'locked'")
    there, sideways, spin = (stroke, 0.0, 0.0), (0.0, omega * stroke, 0.0), (0.0, 0.0, omega)
    ground = vv.Ground()
    beam, cart, spool = (
        vv.Box((0.3, 12.0, 0.12)),
        vv.Box((0.5, 0.5, 0.3)),
        vv.Cylinder(0.18, 0.7),
    )  # to look at
    girder = vv.RigidBody(
        mass=100, euler=(8.3, 208.3, 8.3), rotation=ALONG, angular_velocity=spin, shape=beam, name="girder"
    )
    moving: dict[str, Any] = {"position": there, "velocity": sideways, "angular_velocity": spin}
    trolley = vv.RigidBody(mass=50, euler=(1.0417,) * 3, shape=cart, name="trolley", **moving)
    drum = vv.RigidBody(
        mass=3, euler=(0.01, 0.01, 0.25), rotation=ACROSS, shape=spool, name="winch", **moving
    )
    load = vv.PointMass(mass=10, position=(stroke, 0.0, -length), velocity=sideways, name="load")
    slewing = vv.Revolute(a=ground, b=girder, at=(0, 0, 0), axis=Z, first=X, angle=True, name="slewing")
    rail = vv.Prismatic(
        a=girder.frame_at((0, 0, 0), X), b=trolley.frame_at(there, X), stroke=True, name="rail"
    )
    axle = vv.Revolute(a=trolley, b=drum, at=there, axis=(0, 1, 0), angle=True, name="axle")
    rope = vv.RopeOverWinch(
        a=drum.point(), b=load.point(), winch=axle, radius=radius, length=length, name="rope"
    )
    parts = [ground, girder, trolley, drum, load, slewing, rail, axle, rope]
    if winch == "locked":
        parts.append(vv.Motor(joint=axle, motion=0.0, name="brake"))
    system = vv.System([*parts, vv.Gravity(acceleration=(0, 0, -gravity))])
    probes = {
        "crane_angle": vv.JointCoordinate(joint=slewing),
        "trolley_position": vv.JointCoordinate(joint=rail),
        "winch_angle": vv.JointCoordinate(joint=axle),
        "rope_length": vv.Separation(a=drum, b=load),
        "load": vv.Position(of=load),
        "slewing_force": vv.ReactionForce(joint=slewing),
        "rope_force": vv.ReactionForce(joint=rope),
    }
    return vv.Study(
        system,
        until,
        step,
        probes=probes,
        trails=("load",),
        units="SI",
        title="Rotary crane",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Laws that hold for all parameters: energy, and momentum about the slewing axis."""
    assert (result.system.n_coordinates, result.system.n_constraints) in ((42, 37), (42, 38))
    result.assert_conserved("energy", "angular_z", "constraints")
