"""Solids for the catalogue: bricks and plates in flight, loaded, supported, and joined to others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]
Components = list[Component]

ORIGIN = (0.0, 0.0, 0.0)
REST: dict[str, Any] = {"velocity": ORIGIN, "angular_velocity": ORIGIN}


def block(cell: str = "hex8", counts: Sequence[int] = (1, 1, 1), at: float = 0.0, **options: Any) -> vv.Solid:
    """A soft brick in flight, or a plate if the cells are plane, that begins at x = `at`."""
    plane = cell.startswith(("tri", "quad"))
    size = (1.0, 0.7, 0.5)[: 2 if plane else 3]
    mesh = (vv.RectangleMesh if plane else vv.BoxMesh)(
        size=size, counts=tuple(counts[: len(size)]), cell=cell, origin=(at, 0.0, 0.0)[: len(size)]
    )
    motion: dict[str, Any] = {
        "velocity": (0.3, -0.2, 0.0 if plane else 0.4),
        "angular_velocity": (0.0, 0.0, 0.8) if plane else (0.5, -0.6, 0.8),
    }
    return vv.Solid(
        mesh=mesh,
        material=vv.NeoHooke(young=60.0, poisson=0.3),
        density=1.3,
        **(motion | options),
    )


def rigid() -> vv.RigidBody:
    """A body beside the brick."""
    return vv.RigidBody(
        mass=0.8,
        inertia=(0.2, 0.3, 0.25),
        position=(1.6, 0.2, 0.1),
        velocity=(-0.2, 0.1, 0.3),
        angular_velocity=(0.4, 0.9, -0.5),
    )


def loaded(*more: Callable[[vv.Solid], Component], **options: Any) -> Components:
    """A solid and what acts on it."""
    b = block(**options)
    return [b, *(make(b) for make in more)]


def coupled(
    joint: Callable[..., Component], other: str = "body", cell: str = "hex8", **more: Any
) -> Components:
    """A solid with a frame on its face, joined to a body or to a frame on another solid."""
    a, plane = block(cell), cell != "hex8"
    on_a = vv.RigidCoupling(solid=a, faces="x1")
    at, axis = ((1.2, 0.3, 0.0), (0, 0, 1.0)) if plane else ((1.2, 0.3, 0.2), (0.3, -0.5, 0.8))
    options = {"at": at, "axis": axis} | more
    if other == "body":
        b = rigid()
        return [a, on_a, b, joint(a=on_a, b=b, **options)]
    c = block(cell, at=1.4)
    on_c = vv.DistributedCoupling(solid=c, faces="x0")
    return [a, on_a, c, on_c, joint(a=on_a, b=on_c, **options)]


def pinned(joint: Callable[..., Component]) -> Components:
    """A body joined to a point inside an element of a solid, with a spring to one of its nodes."""
    a, b = block(), rigid()
    inside, node = a.point((0.6, 0.3, 0.2)), a.point((1.0, 0.7, 0.5))
    return [
        a,
        b,
        joint(a=b.point((-0.5, 0.2, 0.0)), b=inside),
        vv.Spring(a=b.point((0.1, 0, 0)), b=node, stiffness=20.0),
    ]


def rod(a: Any, b: Any, **_: Any) -> vv.Distance:
    """A rod between the origins of two components."""
    return vv.Distance(a=a.point(), b=b.point())


FRAMED: dict[str, Callable[..., Component]] = {
    "spherical": vv.Spherical,
    "revolute": vv.Revolute,
    "revolute, angle": partial(vv.Revolute, angle=True),
    "prismatic": vv.Prismatic,
    "prismatic, stroke": partial(vv.Prismatic, stroke=True),
    "cylindrical": vv.Cylindrical,
    "planar": vv.Planar,
    "screw": partial(vv.Screw, pitch=0.7),
    "universal": vv.Universal,
    "rigid": vv.Rigid,
    "point on line": vv.PointOnLine,
    "point on plane": vv.PointOnPlane,
    "distance": rod,
}
"""Joints between frames."""


def wavy(t: float, X: Array) -> Array:
    """A load or motion of time and place."""
    return 0.1 * np.sin(3 * t) * np.column_stack([X[:, 1], X[:, 0] ** 2, 0 * X[:, 0]])


TIED = (("hex8", "dual"), ("tet4", "standard"), ("quad8", "dual"), ("tri3", "standard"))


def tied(cell: str, multipliers: Any) -> Components:
    """Two bricks or plates in flight whose meshes do not match, tied along curved surfaces."""
    first, second = block(cell, (1, 3, 1)), block(cell, (1, 2, 1), at=1.0)
    for solid in (first, second):
        points = solid.grid.points.copy()
        points[:, 0] += 0.06 * np.sin(4.0 * points[:, 1]) * (1.0 - np.abs(points[:, 0] - 1.0))
        solid.mesh = solid.grid = replace(solid.grid, points=4.0 * points)
    return [
        first,
        second,
        vv.Tie(first=first, first_faces="x1", second=second, second_faces="x0", multipliers=multipliers),
    ]
