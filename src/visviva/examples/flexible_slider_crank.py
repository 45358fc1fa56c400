"""Slider-crank with a flexible connecting rod: a solid between rigid bodies, by the joints of rigid bodies.

The crank is a flywheel that runs free. The rod is a solid of 20-node bricks; rigid couplings on its end faces carry the
hinges. It swings and bends, and energy and constraints are kept to round-off.
"""

from __future__ import annotations

import numpy as np

import visviva as vv
from visviva.examples.four_bar import Z

X = (1.0, 0.0, 0.0)


def study(
    rate: float = 10.0,
    young: float = 2e7,
    crank: float = 0.3,
    rod_length: float = 1.0,
    until: float = 1.5,
    step: float = 0.0025,
) -> vv.Study:
    """Crank along +x at the start, turning with `rate`; the slider moves along x without friction."""
    A, B, width = np.array([crank, 0, 0]), np.array([crank + rod_length, 0, 0]), 0.06
    ground = vv.Ground()
    disc = vv.Cylinder(radius=1.2 * crank, length=0.05)
    wheel = vv.RigidBody(
        shape=disc, density=800.0, position=(0, 0, -0.08), angular_velocity=(0, 0, rate), name="crank"
    )
    mesh = vv.BoxMesh(
        size=(rod_length, width, width),
        counts=(10, 2, 1),
        cell="hex20",
        origin=(crank, -width / 2, -width / 2),
    )
    turning = -rate * crank / rod_length  # of the rod, whose end B starts at rest
    rod = vv.Solid(
        mesh=mesh,
        material=vv.NeoHooke(young=young, poisson=0.35),
        density=1000.0,
        velocity=lambda P: np.cross([0, 0, turning], P - B),
        name="rod",
    )
    big, small = (
        vv.RigidCoupling(solid=rod, faces=face, name=name)
        for face, name in (("x0", "big end"), ("x1", "small end"))
    )
    slider = vv.RigidBody(shape=vv.Box(size=(0.2, 0.15, 0.15)), mass=1.0, position=B, name="slider")
    shaft = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=Z, first=X, angle=True, name="shaft")
    pin = vv.Revolute(a=wheel, b=big, at=A, axis=Z, name="pin")
    wrist = vv.Revolute(a=small, b=slider, at=B, axis=Z, name="wrist")
    guide = vv.Prismatic(a=ground.frame_at((0, 0, 0), X), b=slider.frame_at(B, X), stroke=True, name="guide")
    system = vv.System([ground, wheel, rod, big, small, slider, shaft, pin, wrist, guide])
    middle = vv.Position(of=rod, at=(A + B) / 2)
    bending = vv.Formula(  # distance of the rod's middle from the line between its ends, in the plane
        formula="((b_x-a_x)*(m_y-a_y) - (b_y-a_y)*(m_x-a_x)) / sqrt((b_x-a_x)**2 + (b_y-a_y)**2)",
        of={"a": vv.Position(of=big), "m": middle, "b": vv.Position(of=small)},
    )
    probes = {
        "crank_angle": vv.JointCoordinate(joint=shaft),
        "slider": vv.JointCoordinate(joint=guide),
        "bending": bending,
        "middle": middle,
        "pin_force": vv.ReactionForce(joint=pin),
    }
    title = "Slider-crank with a flexible rod"
    return vv.Study(
        system, until, step, probes=probes, trails=("middle",), units="SI", title=title, notes=__doc__
    )


def check(result: vv.Result) -> None:
    """Energy, and the constraints of bodies, couplings and joints."""
    result.assert_conserved("energy", "constraints")
