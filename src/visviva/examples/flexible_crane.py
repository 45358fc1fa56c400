"""Rotary crane with a girder that bends: a beam on the slewing axis, a trolley held on it, a winch, a load on a rope.

The girder is a slender box of aluminium, which the trolley and the load bend by some 10 cm. It begins at rest, bent:
let go straight, its end would fall faster than the load, whose rope would be slack. A torque turns the crane up to
speed and the load swings. With `servo` the crane's angle and the height of the load follow functions of time instead,
and the torques of slewing drive and winch are the result, with the vibrations of the girder in them (servo
constraints of Betsch & Uhlar [7]).
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv
from visviva.examples.crane import ACROSS, X, Z
from visviva.examples.crane_servo import travel

BACK, FRONT = -2.0, 5.5
TURN, LIFT = np.pi / 2, 0.5


def study(
    count: int = 8,
    stroke: float = 5.0,
    length: float = 1.2,
    torque: float = 1000.0,
    servo: bool = False,
    until: float = 5.0,
    step: float = 0.01,
) -> vv.Study:
    """`count` elements in the girder and the trolley at `stroke` from the axis; the torque acts for two seconds."""
    bodies, joints = crane(count, stroke, length)
    slewing, _, axle, _ = joints
    girder, trolley, load = bodies["girder"], bodies["trolley"], bodies["load"]
    probes: dict[str, Any] = {
        "crane_angle": vv.JointCoordinate(joint=slewing),
        "trolley": vv.Position(of=trolley),
        "load": vv.Position(of=load),
        "bending": vv.Resultants(beam=girder, at=-BACK + 0.5),
    }
    scheme: vv.Scheme = vv.GeneralizedAlpha(rho=0.0) if servo else vv.EnergyMomentum()
    if servo:
        height = vv.Position(of=load, direction=Z)
        path = [lambda t: TURN * travel(t / until), lambda t: -length + LIFT * travel(t / until)]
        drive = vv.Servo(output=[slewing, height], follows=path, actuators=[slewing, axle], name="servo")
        drives: list[Any] = [drive]
        probes["inputs"] = vv.ServoInputs(servo=drive)
    else:
        times = f"{torque} * (smoothstep(4*t) - smoothstep(4*t - 7))"
        drives = [
            vv.Motor(joint=axle, motion=0.0, name="brake"),
            vv.JointForce(joint=slewing, force=times, name="drive"),
        ]
    system = vv.System([*bodies.values(), *joints, *drives, vv.Gravity()])
    if not servo:
        vv.equilibrium(system)
    return vv.Study(
        system,
        until,
        step,
        scheme,
        probes,
        trails=("load",),
        units="SI",
        title="Flexible crane",
        notes=__doc__,
    )


def crane(count: int, stroke: float, length: float) -> tuple[dict[str, Any], tuple[Any, ...]]:
    """Bodies by name, and what joins them: slewing axis, the trolley's seat, the winch's axle, the rope."""
    there = (stroke, 0.0, 0.0)
    box = vv.BoxSection(width=0.1, height=0.12, thickness=0.004, young=70e9, poisson=0.33, density=2700.0)
    line = vv.LineMesh(points=[(BACK, 0, 0), (FRONT, 0, 0)], count=count, cell="line3")
    cart, spool = vv.Box((0.5, 0.5, 0.3)), vv.Cylinder(0.18, 0.7)
    ground = vv.Ground()
    girder = vv.Beam(mesh=line, section=box, first=(0, 1, 0), name="girder")
    trolley = vv.RigidBody(mass=50, euler=(1.0417,) * 3, position=there, shape=cart, name="trolley")
    drum = vv.RigidBody(
        mass=3, euler=(0.01, 0.01, 0.25), rotation=ACROSS, position=there, shape=spool, name="winch"
    )
    load = vv.PointMass(mass=10, position=(stroke, 0.0, -length), name="load")
    slewing = vv.Revolute(a=ground, b=girder, at=(0, 0, 0), axis=Z, first=X, angle=True, name="slewing")
    seat = vv.Rigid(a=girder, b=trolley, at=there, name="seat")
    axle = vv.Revolute(a=trolley, b=drum, at=there, axis=(0, 1, 0), angle=True, name="axle")
    rope = vv.RopeOverWinch(
        a=drum.point(), b=load.point(), winch=axle, radius=0.1, length=length, name="rope"
    )
    bodies = {"ground": ground, "girder": girder, "trolley": trolley, "winch": drum, "load": load}
    return bodies, (slewing, seat, axle, rope)


def check(result: vv.Result) -> None:
    """Energy is what the torque has done, or all is on its path; the girder bends by less than half a metre."""
    system = result.system
    if any(isinstance(c, vv.Servo) for c in system.components):
        assert result.conservation()["constraints"] < 1e-8
    else:
        result.assert_conserved("energy")
    (trolley,) = (c for c in system.components if isinstance(c, vv.RigidBody) and c.name == "trolley")
    sag = np.abs(result.history(trolley.point().position)[:, 2]).max()
    assert 0.05 < sag < 0.5, f"the trolley goes down by {sag}"
