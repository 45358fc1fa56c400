"""Pairs of bodies that touch, for the tests of contact."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]
Components = list[Component]

RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)


def bricks(cell: str = "hex8", scale: float = 4.0, gap: float = 0.0, **options: Any) -> Components:
    """A brick thrown onto a larger one with another mesh, both free; lengths are multiplied by `scale`."""
    one = vv.BoxMesh(size=(1, 1, 0.5), counts=(1, 1, 1), cell=cell).build()
    two = (
        vv.BoxMesh(size=(1.2, 1.1, 0.5), counts=(2, 2, 1), cell=cell).build().moved((-0.1, -0.07, -0.5 - gap))
    )
    return _thrown(one, two, ("z0", "z1"), scale, (0.3, 0.1, -2.0), **options)


def plates(cell: str = "quad4", gap: float = 0.0, scale: float = 4.0, **options: Any) -> Components:
    """The same in the plane."""
    one = vv.RectangleMesh(size=(1, 0.5), counts=(2, 1), cell=cell).build()
    two = vv.RectangleMesh(size=(1.3, 0.5), counts=(3, 1), cell=cell).build().moved((-0.13, -0.5 - gap))
    return _thrown(one, two, ("y0", "y1"), scale, (0.3, -2.0, 0.0), **options)


def overhanging(**options: Any) -> Components:
    """Two bricks of unlike meshes, one thrown onto the other, whose corners hang over each other's borders."""
    one = vv.BoxMesh(size=(1, 1, 0.5), counts=(2, 2, 1)).build().moved((0.38, 0.22, 0.0))
    two = vv.BoxMesh(size=(1, 1, 0.5), counts=(2, 1, 1)).build().moved((0, 0, -0.5))
    return _thrown(one, two, ("z0", "z1"), 4.0, (0.4, 0.3, -1.0), formulation="node-to-segment", **options)


def _thrown(
    one: vv.Mesh, two: vv.Mesh, faces: tuple[str, str], scale: float, velocity: Any, **options: Any
) -> Components:
    parts = [
        vv.Solid(
            mesh=scaled(mesh, scale), material=RUBBER, density=1.0 / scale**2, velocity=scale * np.array(v)
        )
        for mesh, v in ((one, velocity), (two, (0.0, 0.0, 0.0)))
    ]
    first, second = faces
    contact = vv.Contact(first=parts[0], second=parts[1], first_faces=first, second_faces=second, **options)
    return [*parts, contact]


def scaled(mesh: vv.Mesh, factor: float) -> vv.Mesh:
    """The mesh in another unit of length."""
    return vv.Mesh(factor * mesh.points, mesh.cells, face_sets=mesh.face_sets, node_sets=mesh.node_sets)


PYRAMID: dict[str, Any] = {
    "points": [(-0.5, -0.4, 0.0), (0.5, -0.4, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0), (0.05, 0.0, 0.7)],
    "triangles": [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
}


HALF_RIGHT = np.sqrt(0.5)
ABOUT_FIRST = [(1, 0, 0), (0, HALF_RIGHT, -HALF_RIGHT), (0, HALF_RIGHT, HALF_RIGHT)]
ABOUT_SECOND = [(HALF_RIGHT, 0, HALF_RIGHT), (0, 1, 0), (-HALF_RIGHT, 0, HALF_RIGHT)]
"""Turns by 45 degrees."""


def rigid_on_brick(shape: Any, height: float, **options: Any) -> Components:
    """A rigid body with a shape thrown onto a brick, both free."""
    mesh = vv.BoxMesh(size=(1.4, 1.3, 0.5), counts=(2, 2, 1)).build().moved((-0.7, -0.65, -0.5))
    brick = vv.Solid(mesh=mesh, material=RUBBER, density=1.0)
    body = vv.RigidBody(shape=shape, mass=0.5, position=(0.03, 0.02, height), velocity=(0.1, 0.2, -1.5))
    contact = vv.Contact(first=brick, second=body, first_faces="z1", **options)
    return [brick, body, contact]


def edge_on_edge(**options: Any) -> Components:
    """A cube thrown with an edge on that of another one, both free."""
    bodies = [
        vv.RigidBody(
            shape=vv.Box(size=(size,) * 3),
            mass=mass,
            position=(0.03 * up, 0.01, up * (size * np.sqrt(0.5) + 0.003)),
            rotation=np.array(R),
            velocity=(0.1 * up, 0.2, -0.5 * up),
            angular_velocity=(0.4, -0.3 * up, 0.5),
        )
        for size, mass, up, R in ((0.8, 1.0, 1, ABOUT_FIRST), (1.0, 2.0, -1, ABOUT_SECOND))
    ]
    return [*bodies, vv.Contact(first=bodies[0], second=bodies[1], stiffness=200.0, **options)]


def contact_of(components: Components) -> vv.Contact:
    """The contact among components."""
    (contact,) = (c for c in components if isinstance(c, vv.Contact))
    return contact


def stacked(
    dimension: int, cell: str, pressure: float = 10.0, **options: Any
) -> tuple[vv.Solid, vv.Solid, vv.Contact, Components]:
    """Two blocks of different meshes, the upper one held by nothing but the lower one along the last axis."""
    material = vv.LinearElastic(young=1e3, poisson=0.3)
    shape: Any = vv.BoxMesh if dimension == 3 else vv.RectangleMesh
    up = (0,) * (dimension - 1) + (1,)
    solids = []
    for n, level in ((3, 1), (2, 0)):
        mesh = shape(size=(1,) * dimension, counts=(n,) * (dimension - 1) + (1,), cell=cell).build()
        solids.append(vv.Solid(mesh=mesh.moved(level * np.array(up)), material=material))
    a, b = solids
    axis = "xyz"[dimension - 1]
    contact = vv.Contact(first=a, second=b, first_faces=f"{axis}0", second_faces=f"{axis}1", **options)
    normals = np.eye(3)[: dimension - 1]
    parts: Components = [*solids, contact]
    parts += [
        vv.SymmetryPlane(solid=s, nodes=f"{name}0", normal=n)
        for s in solids
        for name, n in zip("xy", normals, strict=False)
    ]
    parts.append(vv.SymmetryPlane(solid=b, nodes=f"{axis}0", normal=np.eye(3)[dimension - 1]))
    load = -pressure * np.eye(3)[dimension - 1]
    parts.append(vv.Traction(solid=a, faces=f"{axis}1", traction=load, times="t"))
    return a, b, contact, parts


def pushed(n: int, newton: vv.Newton | None = None, **options: Any) -> tuple[vv.System, vv.Solid]:
    """A block that is pushed onto a wider one and aside, by its top: statics until t = 1."""
    lower = vv.BoxMesh(size=(1.3, 1.3, 0.5), counts=(n + 1, n + 1, n), origin=(-0.16, -0.14, 0)).build()
    upper = vv.BoxMesh(size=(1, 1, 0.5), counts=(n, n, n)).build().moved((0, 0, 0.5))
    under, over = (vv.Solid(mesh=mesh, material=RUBBER) for mesh in (lower, upper))
    supports: Components = [
        vv.Fixed(solid=under, nodes="z0"),
        vv.Prescribed(solid=over, nodes="z1", motion=("0.03 * t", "0", "-0.05 * t")),
    ]
    contact = vv.Contact(first=over, first_faces="z0", second=under, second_faces="z1", **options)
    return vv.System([under, over, *supports, contact], newton), over
