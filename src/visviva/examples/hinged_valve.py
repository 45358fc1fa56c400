"""Two rigid leaflets hinged to the walls of a channel: a heart valve in pulsating flow.

The channel, the fluid and the inflow of the paper's valve (`valve`), with rigid leaflets as long as its flaps in
place of these. They turn about hinges at the walls, against springs that pull them back across the channel, and follow
the fluid by marks along their middle (paper (31) to (44), with bodies in directors). The flow starts from rest.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

import visviva as vv
from visviva.examples.valve import FLAP, HEIGHT, RIGHT, channel, check_carried

THICKNESS, CLEARANCE = 0.05, 0.03  # of the leaflets' feet above the walls
GALLERY = {"mesh": "coarse", "until": 0.4}


def study(
    mesh: Literal["full", "coarse"] = "coarse",
    density: float = 10.0,
    stiffness: float = 30.0,
    until: float = 2.1,
    step: float = 0.01,
    damping: float = 0.05,
) -> vv.Study:
    """Springs of a `stiffness` (torque per radian) close the leaflets, whose density is that of the fluid."""
    blood, openings_and_walls = channel(mesh, density)
    ground = vv.Ground()
    parts: list[Any] = [blood, ground, *openings_and_walls]
    probes: dict[str, Any] = {}
    for side, wall, way in (("lower", 0.0, 1.0), ("upper", HEIGHT, -1.0)):
        foot = np.array([RIGHT, wall, 0.0])
        leaflet = vv.RigidBody(
            shape=vv.Box(size=(THICKNESS, FLAP - CLEARANCE, 1.0)),
            density=density,
            position=foot + np.array([0.0, way * (FLAP + CLEARANCE) / 2, 0.0]),
            name=f"{side} leaflet",
        )
        hinge = vv.Revolute(a=ground, b=leaflet, at=foot, name=f"{side} hinge")
        parts += [
            leaflet,
            hinge,
            vv.JointSpring(joint=hinge, stiffness=stiffness, name=f"{side} spring"),
            vv.ImmersedBody(body=leaflet, fluid=blood, damping=damping, name=f"{side} leaflet in blood"),
        ]
        probes[f"{side}_angle"] = lambda s, h=hinge: h.coordinate("angle").value(s.x)
    return vv.Study(
        vv.System(parts, vv.Newton(tolerance=1e-9)),
        until,
        step,
        probes=probes,
        fields=("velocity", "pressure"),
        moments=(0.3, 0.8),
        movie=True,
        title="Two hinged leaflets in a channel",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy balance closes; the leaflets follow the fluid and stay at their hinges."""
    check_carried(result, "leaflets")
