"""Parts that touch at points: vertices against facets, exact shapes and themselves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import visviva as vv

RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)


def blocks(flat: bool = False, turn: Any = None, shift: Any = 0.0, **options: Any) -> list[Any]:
    """Two free blocks that collide askew and slide along each other over edges of facets, turned and shifted."""
    if flat:
        upper = vv.RectangleMesh(size=(1.0, 0.5), counts=(2, 1), origin=(0.07, 0.51)).build()
        lower = vv.RectangleMesh(size=(1.6, 0.5), counts=(3, 1)).build()
        velocity: Any = (0.8, -1.0, 0.0)
    else:
        upper = vv.BoxMesh(size=(0.8, 0.7, 0.5), counts=(1, 1, 1), origin=(0.11, 0.13, 0.51)).build()
        lower = vv.BoxMesh(size=(1.6, 1.1, 0.5), counts=(2, 2, 1)).build()
        velocity = (0.8, 0.4, -1.0)
    if turn is not None:
        upper, lower = (replace(m, points=m.points @ turn.T + shift) for m in (upper, lower))
        velocity = turn @ velocity
    one = vv.Solid(mesh=upper, material=RUBBER, density=1.0, velocity=velocity)
    two = vv.Solid(mesh=lower, material=RUBBER, density=1.0)
    more: Any = {"formulation": "node-to-segment", "impact": "conserving"} | options
    return [one, two, vv.Contact(first=one, second=two, **more)]


def wavy_track(enforcement: str, flat: bool, amplitude: float = 0.05) -> list[Any]:
    """A block under a dead load that slides along a track of convex and concave edges."""
    if flat:
        track = vv.RectangleMesh(size=(3.0, 0.4), counts=(10, 1)).build()
        slider = vv.RectangleMesh(size=(0.5, 0.3), counts=(2, 1), origin=(0.2, 0.4)).build()
        side, top, bottom, velocity = "y0", "y1", "y0", (1.0, 0.0, 0.0)
    else:
        track = vv.BoxMesh(size=(3.0, 0.8, 0.4), counts=(10, 2, 1)).build()
        slider = vv.BoxMesh(size=(0.5, 0.3, 0.3), counts=(2, 1, 1), origin=(0.2, 0.23, 0.4)).build()
        side, top, bottom, velocity = "z0", "z1", "z0", (1.0, 0.1, 0.0)
    X = track.points.copy()
    X[:, -1] += amplitude * (X[:, -1] > 0.3) * np.sin(2.2 * X[:, 0])
    by = np.zeros(slider.points.shape[1])
    by[-1] = amplitude * np.sin(2.2 * 0.7) + 0.01
    ground = vv.Solid(mesh=replace(track, points=X), material=RUBBER, density=1.0)
    above = vv.Solid(mesh=slider.moved(by), material=RUBBER, density=1.0, velocity=velocity)
    load = (0.0, -4.0, 0.0) if flat else (0.0, 0.0, -4.0)
    return [
        ground,
        above,
        vv.Fixed(solid=ground, nodes=side),
        vv.BodyForce(solid=above, force=load),
        vv.Contact(
            first=above,
            first_faces=bottom,
            second=ground,
            second_faces=top,
            formulation="node-to-segment",
            enforcement=enforcement,
            impact="conserving",
        ),
    ]


SHAPES: dict[str, tuple[Any, tuple[float, float, float]]] = {
    "plane": (None, (0.0, 0.1, 1.0)),
    "sphere": (vv.Sphere(radius=0.9), (0.0, 0.0, 1.0)),
    "cylinder": (vv.Cylinder(radius=0.9, length=3.0), (1.0, 0.2, 0.0)),
    "capsule": (vv.Capsule(radius=0.9, length=0.4), (1.0, 0.2, 0.1)),
    "box": (vv.Box(size=(2.0, 2.0, 1.8)), (0.0, 0.1, 1.0)),
}
"""Exact shapes, and the axes of their frames; of the plane its normal."""


def on_shape(name: str, turn: Any = None, **options: Any) -> list[Any]:
    """A brick thrown onto an exact shape that a free body carries, all turned."""
    R = np.eye(3) if turn is None else turn
    shape, axis = SHAPES[name]
    mesh = vv.BoxMesh(size=(0.5, 0.4, 0.3), counts=(1, 1, 1), origin=(-0.21, -0.17, 0.93)).build()
    brick = vv.Solid(
        mesh=replace(mesh, points=mesh.points @ R.T),
        material=RUBBER,
        density=1.0,
        velocity=R @ (0.1, 0.2, -2.0),
    )
    carrier = vv.RigidBody(
        mass=2.0,
        inertia=R @ np.diag((0.5, 0.6, 0.7)) @ R.T,
        position=R @ (0.1, -0.2, -0.1),
        angular_velocity=R @ (0.3, 0.2, -0.4),
    )
    if shape is None:
        obstacle: Any = vv.Plane(on=carrier, at=R @ (0, 0, 0.9), normal=R @ axis)
    else:
        first = R @ (0, 1, 0.1) if axis[0] else R @ (1, 0, 0)
        obstacle = vv.Obstacle(shape=shape, on=carrier, axis=R @ axis, first=first)
    return [brick, carrier, obstacle, vv.Contact(first=brick, second=obstacle, **options)]


def balls(shape: Any = None, away: float = 0.0, **options: Any) -> list[Any]:
    """Two spinning balls that hit each other off their centres and rub; the second, `away`, may have another shape."""
    one, two = (
        vv.RigidBody(shape=outside, density=1.0, position=place, velocity=v, angular_velocity=w)
        for outside, place, v, w in (
            (vv.Sphere(radius=0.5), (0.0, 0.0, 0.0), (0.3, 0.1, 0.0), (0.4, -0.2, 1.0)),
            (shape or vv.Sphere(radius=0.4), (0.8 + away, 0.3, 0.31), (-0.6, 0.0, 0.1), (0.0, 0.7, 0.5)),
        )
    )
    more: Any = {
        "enforcement": "penalty",
        "tangential": "penalty",
        "stiffness": 200.0,
        "friction": 0.3,
    } | options
    return [one, two, vv.Contact(first=one, second=two, formulation="node-to-segment", **more)]
