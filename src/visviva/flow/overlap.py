"""Refusal of bodies that lie within a fluid without taking part in it or cover its boundary, unless meant."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.rigid import RigidBody
from visviva.component.announcements import Wetting
from visviva.component.meshed import Meshed
from visviva.flow.location import Location, outside
from visviva.flow.marks import winding
from visviva.mesh.cells import CELLS
from visviva.model.field import Owner

if TYPE_CHECKING:
    from visviva.flow.fluid import Fluid
    from visviva.mesh.mesh import Mesh
    from visviva.model.model import Model

Array = NDArray[np.float64]

DEPTHS = 0.1, 0.5
"""Points below a rigid body's surface, in parts of its thickness there, are looked for in a fluid."""
TOUCHING = 1e-6
"""In extents of a body: what is no deeper within it touches it only."""
INTERIOR = 1e-4
"""A place lies within a cell, and not on its border, from so far inside in its reference coordinates."""


def places_within(body: Owner, dimension: int) -> Array:
    """Places (n, d) that lie inside of a body at the start, on the line or middle of a thin one; none of points."""
    if isinstance(body, MeshBody) and body.is_thin:
        grid = body.grid
        flat = dimension == 3 or (grid.dimension == 1 and not np.any(grid.points[:, 2:]))
        return np.vstack([grid.centres, grid.points])[:, :dimension] if flat else np.zeros((0, dimension))
    if isinstance(body, Meshed) and body.dimension == dimension == body.grid.dimension:
        return np.asarray(body.grid.centres)
    if isinstance(body, RigidBody) and body.shape is not None:
        X = below(*body.shape.surface())
        return np.asarray((body.position + X @ body.rotation.T)[:, :dimension])
    return np.zeros((0, dimension))


def below(points: Array, triangles: NDArray[np.int64]) -> Array:
    """Places (n, 3) within a closed surface, below each of its triangles; of a hollow body they are in its wall."""
    facets = np.pad(triangles, ((0, 0), (0, 1)), constant_values=-1).astype(np.int32)
    sights = np.asarray(_core.sights(3, np.ascontiguousarray(points).ravel(), facets.ravel()))
    corners, behind = points[triangles], sights.reshape(-1, 2)[:, :1]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    return np.vstack([corners.mean(axis=1) - part * behind * normals for part in DEPTHS])


def refuse_dry(fluid: Fluid, model: Model) -> None:
    """Refuse what lies within a fluid and feels nothing of it: bodies, thin ones too, and meshes that stand still.

    Raises
    ------
    InputError
        With the component, the place, and what to take instead.
    """
    for body in model.components:
        if body is fluid or model.announced(body, Wetting):
            continue
        places = places_within(body, fluid.dimension)
        if len(places):
            places = places[fluid.location.find(places)[0] >= 0]
        if isinstance(body, MeshBody) and body.is_thin and len(places):  # along a wall it is not within
            places = places[deep_in_fluid(fluid, places, TOUCHING * fluid.extent)]
        if len(places):
            raise InputError(
                f"{body.label} lies within {fluid.label}, at {places[0].round(6).tolist()} for instance, and neither "
                f"feels the other: {cure(body)}, move it, or allow it by Fluid(dry=True)"
            )


def cure(body: Owner) -> str:
    """What takes a component into account that lies within a fluid."""
    if isinstance(body, MeshBody):
        return "add vv.ImmersedThin(body=...)" if body.is_thin else "add vv.Immersed(solid=...)"
    if isinstance(body, RigidBody):
        return "add vv.ImmersedBody(body=...)"
    return "leave its place out of the mesh of the fluid"


def deep_in_fluid(fluid: Fluid, places: Array, reach: float) -> NDArray[np.bool_]:
    """Which places (n, d) are farther than that from the border of a fluid."""
    inside = np.ones(len(places), dtype=bool)
    for way in itertools.product((-reach, reach), repeat=fluid.dimension):
        inside[inside] = fluid.location.find(places[inside] + way)[0] >= 0
    return inside


def covered_by_mesh(fluid: Fluid, grid: Mesh) -> Array:
    """Places (n, d) of the fluid's boundary that lie inside of a mesh."""
    places = fluid.wall_places(grid.points.mean(axis=0))
    search = Location(grid)
    cells, xi = search.find(places)
    within = np.zeros(len(places), dtype=bool)
    for name, mine, _ in search.parts(cells):
        within[mine] = outside(CELLS[name], xi[mine]) < -INTERIOR
    return np.asarray(places[within])


def covered_by_body(fluid: Fluid, body: RigidBody, points: Array, triangles: NDArray[np.int64]) -> Array:
    """The same of a rigid body with a surface of triangles in its own coordinates; of prisms in a plane fluid too."""
    flat = fluid.dimension == 2
    places = fluid.wall_places(body.position[: fluid.dimension])
    X = (np.pad(places, ((0, 0), (0, 1))) - body.position * [1, 1, 0]) if flat else places - body.position
    X = X @ body.rotation
    if flat:
        X[:, 2] = points[:, 2].mean()
    near = np.flatnonzero(np.all((points.min(axis=0) < X) & (points.max(axis=0) > X), axis=1))
    return np.asarray(places[near[deep_within(points, triangles, X[near])]])


def deep_within(points: Array, triangles: NDArray[np.int64], places: Array) -> NDArray[np.bool_]:
    """Mask of places (n, 3) that lie within a closed surface, and not on it."""
    inside = np.ones(len(places), dtype=bool)
    reach = TOUCHING * float(np.ptp(points, axis=0).max())
    for way in itertools.product((-reach, reach), repeat=3):
        inside[inside] = winding(points[triangles], places[inside] + way) > 0.5
    return inside


def refuse_covering(label: str, body: Owner, fluid: Fluid, places: Array) -> None:
    """Refuse a body that covers a wall.

    Raises
    ------
    InputError
        With one of the places of the fluid's boundary that it covers.
    """
    if len(places):
        raise InputError(
            f"{label}: {body.label} covers the boundary of {fluid.label}, at {places[0].round(6).tolist()} for "
            "instance, where the fluid cannot move with it; move it into the fluid, or allow it by over_walls=True"
        )
