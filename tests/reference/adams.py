"""Joint series against ADAMS (unit tests of Project Chrono, BSD-3): exact definition of every case, selected
results.

One body and the ground; gravity 9.80665 along -z; start at rest; 5 s. The tables tests/data/adams_NAME.csv
hold, every 0.25 s and with ADAMS' six or seven digits, of the body
    x y z, vx vy vz     centre of mass, global axes
    e0 e1 e2 e3         quaternion of the body axes (scalar first; body to global)
    wx wy wz            angular velocity, global axes
    fx fy fz            reaction force ON THE GROUND, global axes
    tx ty tz            reaction torque ON THE GROUND about the joint's ground point, global axes
so the action on the body is the opposite. Springs count with their joint: f and t are all that acts on the
ground. The model files name other values for two cases than the results were made with: RotSpring_Case01 k =
200, c = 10 (file: 57.3, 2.86), TranSpring_Case02 c = 5 (file: 1); the values here are those of the results.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .integrate import Array, axis_rotation, read_table

GRAVITY = 9.80665
COLUMNS = [
    "t",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "e0",
    "e1",
    "e2",
    "e3",
    "wx",
    "wy",
    "wz",
    "fx",
    "fy",
    "fz",
    "tx",
    "ty",
    "tz",
]
ORIGIN, CORNER = (0.0, 0.0, 0.0), (1.0, 2.0, 3.0)
BAR_X, BAR_Z = (0.04, 0.1, 0.1), (0.1, 0.1, 0.04)


def about(axis: int, angle: float) -> Array:
    """Rotation matrix about a coordinate axis."""
    return axis_rotation(np.eye(3)[axis], angle)


@dataclass(frozen=True, eq=False)
class Case:
    """One body held by one joint to the ground.

    The joint's frame (columns: its axes x, y, z, global) is the same on ground and body at t = 0; z is the
    axis of a revolute, cylindrical and prismatic joint. Universal: the ground's x axis stays perpendicular to
    the body's y axis. `body_point` is the joint's point on the body in global coordinates at t = 0.
    """

    name: str
    joint: str
    inertia: tuple[float, float, float]  # principal moments about the centre, in the body axes
    centre: tuple[float, float, float]
    attitude: Array  # body to global at t = 0
    ground_point: tuple[float, float, float] = ORIGIN
    body_point: tuple[float, float, float] = ORIGIN
    frame: Array = field(default_factory=lambda: np.eye(3))
    mass: float = 1.0
    stiffness: float = 0.0
    damping: float = 0.0
    length: float = 0.0  # of the distance joint, or the free length of the spring


def _on_joint(
    name: str, joint: str, rotation: Array, point: tuple[float, float, float] = ORIGIN, **more: float
) -> Case:
    """Bar along x of the joint's frame, centre at distance 2 from the joint."""
    x, y, z = (float(c) for c in np.asarray(point) + 2.0 * rotation[:, 0])
    return Case(name, joint, BAR_X, (x, y, z), rotation, point, point, rotation, **more)


def _universal(name: str, rotation: Array) -> Case:
    """Bar along z of the joint's frame, centre at z = -2 of that frame."""
    x, y, z = (float(c) for c in -2.0 * rotation[:, 2])
    return Case(name, "universal", BAR_Z, (x, y, z), rotation, frame=rotation)


_QUARTER, _EIGHTH = np.pi / 2, np.pi / 4
_EYE = np.eye(3)
_ALL = [
    _on_joint("Revolute_Case01", "revolute", about(0, -_QUARTER)),
    _on_joint("Revolute_Case02", "revolute", about(0, -_EIGHTH), CORNER),
    _on_joint("Spherical_Case01", "spherical", _EYE),
    _on_joint("Spherical_Case02", "spherical", about(0, -_EIGHTH), CORNER),
    _on_joint("Prismatic_Case01", "prismatic", _EYE),
    _on_joint("Prismatic_Case02", "prismatic", about(0, -_EIGHTH), CORNER),
    _on_joint("Prismatic_Case03", "prismatic", about(0, -_QUARTER), CORNER),
    _on_joint("Cylindrical_Case01", "cylindrical", _EYE),
    _on_joint("Cylindrical_Case02", "cylindrical", about(0, -_QUARTER)),
    _on_joint("Cylindrical_Case03", "cylindrical", about(0, -_EIGHTH), CORNER),
    _universal("Universal_Case01", about(0, _QUARTER)),
    _universal("Universal_Case02", about(1, _QUARTER)),
    _universal("Universal_Case03", about(2, -_EIGHTH) @ about(0, _QUARTER) @ about(2, _EIGHTH)),
    Case("Distance_Case01", "distance", BAR_X, (0, 2, 0), _EYE, ORIGIN, (0, 2, 0), length=2.0),
    Case("Distance_Case02", "distance", BAR_X, (-1, 4, 3), _EYE, CORNER, (1, 4, 3), length=2.0),
    Case("Distance_Case03", "distance", BAR_X, (0, 4, 0), about(2, -_QUARTER), ORIGIN, (0, 2, 0), length=2.0),
    _on_joint("RotSpring_Case01", "torsion spring", about(0, -_QUARTER), stiffness=200.0, damping=10.0),
    Case(
        "TranSpring_Case02",
        "spring",
        BAR_X,
        (0, 2, 0),
        _EYE,
        ORIGIN,
        (0, 2, 0),
        stiffness=100.0,
        damping=5.0,
        length=2.0,
    ),
]
CASES: dict[str, Case] = {case.name: case for case in _ALL}


def table(name: str) -> dict[str, Array]:
    """Columns `COLUMNS` of one case at t = 0, 0.25 ... 5."""
    return read_table(f"adams_{name}.csv")


def rack_and_pinion(
    time: float, mass: float = 1.0, inertia: float = 0.04, radius: float = 0.1, gravity: float = GRAVITY
) -> dict[str, float]:
    """Rack falling along -z, geared to a pinion on a fixed horizontal axis (case RackPinion_Case01, closed
    form).

    z'' = -m g / (m + J / r^2); pinion angle |z| / r; tooth force J |z''| / r^2 upwards on the rack. No ADAMS
    results exist, and the ADAMS model (PD = 0.1, axial inertia 0.1) disagrees with the unit test (radius 0.1,
    axial inertia 0.04) which is the default here.
    """
    second = -mass * gravity / (mass + inertia / radius**2)
    return {
        **{"z": 0.5 * second * time**2, "vz": second * time, "angle": 0.5 * abs(second) * time**2 / radius},
        **{"tooth_force": inertia * abs(second) / radius**2},
    }
