"""Reactions of statically determinate structures in closed form.

A body held to the ground by one joint is at rest when its load does no work in the joint's free motions; then
the joint passes the whole load on. Load and reaction are wrenches (force, torque about the joint's point) in
the joint's axes x, y, z (z = axis of revolute, cylindrical, prismatic, screw; normal of plane; direction of
line; x and y = the cross of the universal joint; distance and rope along x). The ground feels exactly the
load, the body the opposite.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .integrate import Array

PITCH_RADIUS = 0.3 / (2.0 * np.pi)  # advance per radian of the screw with pitch 0.3


@dataclass(frozen=True)
class Held:
    """A joint, a load that it can carry alone, and its free motions (velocity, angular velocity) in joint
    axes."""

    joint: str
    force: tuple[float, float, float]
    torque: tuple[float, float, float]
    free: tuple[tuple[float, ...], ...]

    def load_at(self, frame: ArrayLike, lever: ArrayLike) -> tuple[Array, Array]:
        """Global force and torque that make this load when applied at joint point + `lever`; `frame` = joint
        axes."""
        axes = np.asarray(frame, dtype=float)
        force, torque = axes @ np.array(self.force), axes @ np.array(self.torque)
        return force, torque - np.cross(np.asarray(lever, dtype=float), force)

    def reaction(self, frame: ArrayLike) -> tuple[Array, Array]:
        """Global force and torque (about the joint's point) on the ground; the opposite acts on the body."""
        return self.load_at(frame, np.zeros(3))


_VX, _VY, _VZ, _WX, _WY, _WZ = (tuple(map(float, row)) for row in np.eye(6))
HELD = (
    Held("rigid", (3.0, -4.0, 5.0), (0.7, -1.1, 1.3), ()),
    Held("revolute", (3.0, -4.0, 5.0), (0.7, -1.1, 0.0), (_WZ,)),
    Held("prismatic", (3.0, -4.0, 0.0), (0.7, -1.1, 1.3), (_VZ,)),
    Held("cylindrical", (3.0, -4.0, 0.0), (0.7, -1.1, 0.0), (_VZ, _WZ)),
    Held(
        "screw",
        (3.0, -4.0, 5.0),
        (0.7, -1.1, -5.0 * PITCH_RADIUS),
        ((0.0, 0.0, PITCH_RADIUS, 0.0, 0.0, 1.0),),
    ),
    Held("spherical", (3.0, -4.0, 5.0), (0.0, 0.0, 0.0), (_WX, _WY, _WZ)),
    Held("universal", (3.0, -4.0, 5.0), (0.0, 0.0, 1.3), (_WX, _WY)),
    Held("planar", (0.0, 0.0, 5.0), (0.7, -1.1, 0.0), (_VX, _VY, _WZ)),
    Held("point on line", (3.0, -4.0, 0.0), (0.0, 0.0, 0.0), (_VZ, _WX, _WY, _WZ)),
    Held("point on plane", (0.0, 0.0, 5.0), (0.0, 0.0, 0.0), (_VX, _VY, _WX, _WY, _WZ)),
    Held("distance", (3.0, 0.0, 0.0), (0.0, 0.0, 0.0), (_VY, _VZ, _WX, _WY, _WZ)),
)


def virtual_power(case: Held) -> float:
    """Largest power of the load in a free motion: zero, or the case is wrong."""
    wrench = np.array([*case.force, *case.torque])
    return float(max((abs(wrench @ np.array(motion)) for motion in case.free), default=0.0))


def cantilever(mass: float, length: float, load: ArrayLike, gravity: float = 9.81) -> tuple[Array, Array]:
    """Uniform bar clamped at the origin along +x, gravity along -z, dead force `load` at the tip: force,
    torque on ground."""
    f, weight = np.asarray(load, dtype=float), np.array([0.0, 0.0, -mass * gravity])
    arm = np.array([length, 0.0, 0.0])
    return f + weight, np.cross(arm, f) + np.cross(0.5 * arm, weight)


def two_bar_truss(load: ArrayLike, span: float, height: float) -> tuple[Array, Array]:
    """Massless bars from (0, 0) and (span, 0) to (span/2, height), ball joints, planar force `load` at the
    top.

    Forces on the ground at the left and right support: bar forces S1, S2 along the bars balance the load.
    """
    directions = np.array([[0.5 * span, height], [-0.5 * span, height]]).T
    amounts = np.linalg.solve(directions, np.asarray(load, dtype=float))
    return amounts[0] * directions[:, 0], amounts[1] * directions[:, 1]


def three_hinged_arch(mass: float, length: float, angle: float, gravity: float = 9.81) -> dict[str, Array]:
    """Two equal uniform bars leaning on each other, hinged at the ground and at the top, gravity along -y.

    Bars rise at `angle` from the horizontal. Each support carries m g; moments of one bar about its foot give
    the thrust H = m g / (2 tan angle). Keys left, right: force on the ground; top: force of the left bar on
    the right bar.
    """
    thrust, weight = mass * gravity / (2.0 * np.tan(angle)), mass * gravity
    return {
        "left": np.array([-thrust, -weight]),
        "right": np.array([thrust, -weight]),
        "top": np.array([thrust, 0.0]),
    }


def winch_torque(load: float, radius: float, gravity: float = 9.81) -> float:
    """Torque on the winch (sense that unwinds positive) that holds a hanging load: -m g r."""
    return -load * gravity * radius


def gear_torques(first: float, radius1: float, radius2: float) -> tuple[float, float]:
    """Torque on the second wheel that balances `first`, for r1 a1 + r2 a2 = 0 (outer gearing), and the tooth
    force."""
    return first * radius2 / radius1, first / radius1


def rack_torque(force: float, radius: float) -> float:
    """Torque on the pinion that balances a force on the rack when s = r a: M = -F r."""
    return -force * radius
