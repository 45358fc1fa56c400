"""Bodies that rub on each other, for the tests of friction."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]
Components = list[Component]

GRAVITY = 9.81


def _meshes(dimension: int, size: float, base: tuple[float, float]) -> tuple[list[vv.Mesh], tuple[str, str]]:
    """A brick, and below it a base of a length and a width, with other cells; the faces in contact."""
    length, width = size * base[0], size * base[1]
    if dimension == 3:
        one = vv.BoxMesh(size=(size, size, 0.5 * size), counts=(2, 2, 1)).build()
        two = vv.BoxMesh(size=(length, width, 0.5 * size), counts=(3, 1, 1)).build()
        return [one, two.moved((-0.13 * size, -0.07 * size, -0.5 * size))], ("z0", "z1")
    one = vv.RectangleMesh(size=(size, 0.5 * size), counts=(3, 1)).build()
    two = vv.RectangleMesh(size=(length, 0.5 * size), counts=(4, 1)).build()
    return [one, two.moved((-0.13 * size, -0.5 * size))], ("y0", "y1")


def thrown(dimension: int = 3, turn: Array | None = None, **options: Any) -> Components:
    """A soft brick thrown askew onto a larger one, both free."""
    meshes, faces = _meshes(dimension, 1.0, (1.3, 1.2))
    R = np.eye(3) if turn is None else turn
    velocity = (0.5, 0.3, -1.0) if dimension == 3 else (0.5, -1.0, 0.0)
    rubber = vv.NeoHooke(young=100.0, poisson=0.3)
    if turn is not None:
        meshes = [
            vv.Mesh(m.points @ R.T, m.cells, face_sets=m.face_sets, node_sets=m.node_sets) for m in meshes
        ]
    parts = [
        vv.Solid(mesh=m, material=rubber, density=1.0, velocity=R @ v)
        for m, v in zip(meshes, (velocity, (0.0, 0.0, 0.0)), strict=True)
    ]
    touch = {"first_faces": faces[0], "second_faces": faces[1]}
    return [*parts, vv.Contact(first=parts[0], second=parts[1], **touch, **{"friction": 0.3, **options})]


def slope(dimension: int = 3, size: float = 1.0, speed: float = 0.0, **options: Any) -> Components:
    """A stiff block on a slope of 30 degrees, in units of time in which gravity is the same for every size."""
    unit, angle = np.sqrt(size), np.radians(30)
    meshes, faces = _meshes(dimension, size, (6.0, 1.2))
    stiff = vv.NeoHooke(young=1e6 * size, poisson=0.3)
    block = vv.Solid(
        mesh=meshes[0],
        material=stiff,
        density=1.0,
        velocity=(speed * unit, 0, 0),
        stiffness_damping=0.003 * unit,
    )
    base = vv.Solid(mesh=meshes[1], material=stiff, density=1.0)
    contact = vv.Contact(first=block, second=base, first_faces=faces[0], second_faces=faces[1], **options)
    down = GRAVITY * (np.sin(angle) * np.eye(3)[0] - np.cos(angle) * np.eye(3)[dimension - 1])
    return [block, base, vv.Fixed(solid=base, nodes="all"), contact, vv.Gravity(acceleration=tuple(down))]


def contact_of(components: Components) -> vv.Contact:
    """The contact among components."""
    (contact,) = (c for c in components if isinstance(c, vv.Contact))
    return contact
