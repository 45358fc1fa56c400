"""Slider-crank: a motor turns the crank uniformly; the torque of the motor is a result."""

from __future__ import annotations

import numpy as np

import visviva as vv
from visviva.examples.four_bar import Z, rod

X = (1.0, 0.0, 0.0)


def study(
    rate: float = 4.0,
    crank: float = 0.3,
    rod_length: float = 1.0,
    piston_mass: float = 2.0,
    until: float = 3.0,
    step: float = 0.005,
) -> vv.Study:
    """Crank along +x at the start, turning with `rate`; the piston slides along x without friction."""
    A, B = np.array([crank, 0, 0]), np.array([crank + rod_length, 0, 0])
    speed = np.array([0.0, rate * crank, 0.0])
    ground = vv.Ground()
    wheel = rod(np.zeros(3), A, rate, speed / 2, "crank")
    connecting = rod(A, B, -rate * crank / rod_length, speed / 2, "connecting rod")
    piston = vv.RigidBody(shape=vv.Box(size=(0.2, 0.15, 0.15)), mass=piston_mass, position=B, name="piston")
    shaft = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=Z, first=X, angle=True, name="shaft")
    pin = vv.Revolute(a=wheel, b=connecting, at=A, axis=Z, name="pin")
    wrist = vv.Revolute(a=connecting, b=piston, at=B, axis=Z, name="wrist")
    slide = vv.Prismatic(a=ground.frame_at((0, 0, 0), X), b=piston.frame_at(B, X), stroke=True, name="slide")
    motor = vv.Motor(joint=shaft, motion=lambda t: rate * t, name="motor")
    system = vv.System([ground, wheel, connecting, piston, shaft, pin, wrist, slide, motor])
    probes = {
        "crank_angle": vv.JointCoordinate(joint=shaft),
        "piston": vv.JointCoordinate(joint=slide),
        "A": vv.Position(of=wheel, at=A),
    }
    return vv.Study(system, until, step, probes=probes, trails=("A",), units="SI", title="Slider-crank")


def check(result: vv.Result) -> None:
    """The balance of energy with the work of the motor, and the loop."""
    result.assert_conserved("energy", "constraints")
