"""Rotary crane whose load follows a path: slewing torque, trolley force and winch torque are the result.

Servo constraints of Betsch & Uhlar [7]: the three positions of the load are prescribed, the drives of the
crane are unknown. The load goes straight from START to TARGET, at rest at both ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import visviva as vv
from visviva.examples.crane import ACROSS, ALONG, X, Z

START, TARGET = (1.5, 0.0, -1.2), (0.5, 1.5, -0.8)


def travel(s: float) -> float:
    """From 0 to 1 with four derivatives zero at both ends."""
    s = min(max(s, 0.0), 1.0)
    return s**5 * (126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4)


def study(gravity: float = 9.81, duration: float = 5.0, step: float = 0.02) -> vv.Study:
    """The driven crane over `duration`, by generalised-alpha with all damping at infinity."""
    there, length = (START[0], 0.0, 0.0), -START[2]
    ground = vv.Ground()
    girder = vv.RigidBody(
        mass=100, euler=(8.3, 208.3, 8.3), rotation=ALONG, shape=vv.Box((0.3, 5.0, 0.12)), name="girder"
    )
    trolley = vv.RigidBody(
        mass=50, euler=(1.0417,) * 3, position=there, shape=vv.Box((0.5, 0.5, 0.3)), name="trolley"
    )
    drum = vv.RigidBody(mass=3, euler=(0.01, 0.01, 0.25), rotation=ACROSS, position=there, name="winch")
    load = vv.PointMass(mass=10, position=START, name="load")
    slewing = vv.Revolute(a=ground, b=girder, at=(0, 0, 0), axis=Z, first=X, name="slewing")
    rail = vv.Prismatic(a=girder.frame_at((0, 0, 0), X), b=trolley.frame_at(there, X), name="rail")
    axle = vv.Revolute(a=trolley, b=drum, at=there, axis=(0, 1, 0), name="axle")
    rope = vv.RopeOverWinch(
        a=drum.point(), b=load.point(), winch=axle, radius=0.1, length=length, name="rope"
    )

    def path(k: int) -> Callable[[float], float]:
        return lambda t: START[k] + (TARGET[k] - START[k]) * travel(t / duration)

    drives: list[Any] = [slewing, rail, axle]
    servo = vv.Servo(output=[load], follows=[path(k) for k in range(3)], actuators=drives, name="servo")
    parts = [ground, girder, trolley, drum, load, *drives, rope, servo]
    system = vv.System([*parts, vv.Gravity(acceleration=(0, 0, -gravity))])
    names = {"crane_angle": slewing, "trolley_position": rail, "winch_angle": axle}
    probes: dict[str, Any] = {name: vv.JointCoordinate(joint=joint) for name, joint in names.items()}
    probes |= {"load": vv.Position(of=load), "inputs": vv.ServoInputs(servo=servo)}
    scheme = vv.GeneralizedAlpha(rho=0.0)
    title = "Servo-controlled crane"
    return vv.Study(system, duration, step, scheme, probes, trails=("load",), units="SI", title=title)


def check(result: vv.Result) -> None:
    """The load has arrived, and was on its path all the time."""
    assert result.conservation()["constraints"] < 1e-10
