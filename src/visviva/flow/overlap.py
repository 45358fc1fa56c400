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
from visviva.mesh.cells import CELLS, TETRAHEDRON, TRIANGLE, WEDGE, Cell
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

SEARCHED = 20_000
"""So many places of a mesh are looked for in a fluid, if its cells are fewer."""
SOME = 500
"""So many cells of a fluid are looked for in a body."""


def places_within(body: Owner, dimension: int, size: float, box: Array) -> Array:
    """Places (n, d) that lie inside of a body at the start, on the line or middle of a thin one; none of points.

    Those in cells of a mesh are no farther from each other than `size`, or as many as are searched fast; of cells
    outside of the `box` (2, d) there are none.
    """
    if isinstance(body, Meshed) and is_sheet(body, dimension):
        grid = body.grid
        flat = dimension == 3 or (grid.dimension == 1 and not np.any(grid.points[:, 2:]))
        if not flat:
            return np.zeros((0, dimension))
        return np.vstack([spread(grid, size, box), grid.points])[:, :dimension]
    if isinstance(body, Meshed) and body.dimension == dimension == body.grid.dimension:
        return spread(body.grid, size, box)
    if isinstance(body, RigidBody) and body.shape is not None:
        X = below(*body.shape.surface())
        return np.asarray((body.position + X @ body.rotation.T)[:, :dimension])
    return np.zeros((0, dimension))


def is_sheet(body: Meshed, dimension: int) -> bool:
    """Whether a body is a line or a surface in a fluid of a dimension, thin or without thickness."""
    return (isinstance(body, MeshBody) and body.is_thin) or body.grid.dimension < body.dimension == dimension


def spread(grid: Mesh, size: float, box: Array) -> Array:
    """Places (n, d) within the cells of a mesh that meet a box (2, k), no farther from each other than a size."""
    found, k = [np.zeros((0, grid.points.shape[1]))], box.shape[1]
    for name, nodes in grid.cells.items():
        X, kind = grid.points[nodes], CELLS[name]
        low, high = X.min(axis=1), X.max(axis=1)
        meets = np.all((high[:, :k] >= box[0]) & (low[:, :k] <= box[1]), axis=1)
        counts = np.maximum(np.ceil((high - low)[meets].max(axis=1) / size), 1.0)
        while counts.max(initial=1) > 1 and np.sum(counts**kind.dimension) > SEARCHED:
            counts = np.ceil(counts / 2)
        for n in np.unique(counts):
            N = kind.N(lattice(kind, int(n)))
            found.append(np.einsum("qk,mkd->mqd", N, X[meets][counts == n]).reshape(-1, X.shape[2]))
    return np.concatenate(found)


def lattice(kind: Cell, n: int) -> Array:
    """Centres (q, d) of the parts of a reference cell that is cut into `n` along edges; of simplices the upright."""
    d, simplex = kind.dimension, {TRIANGLE: 2, WEDGE: 2, TETRAHEDRON: 3}.get(kind.family, 0)
    steps = np.stack(np.meshgrid(*[np.arange(n)] * d, indexing="ij"), axis=-1).reshape(-1, d)
    steps = steps[steps[:, :simplex].sum(axis=1) < n] if simplex else steps
    upright, straight = steps[:, :simplex], steps[:, simplex:]
    return np.hstack([(upright + 1 / (simplex + 1)) / n, (2 * straight + 1) / n - 1])


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
    size = float(np.median(fluid.grid.volumes) ** (1 / fluid.dimension))
    for body in model.components:
        if body is fluid or any(wet.fluid is fluid for wet in model.announced(body, Wetting)):
            continue
        places = places_within(body, fluid.dimension, size, fluid.grid.bounding_box)
        if len(places):
            places = places[fluid.location.find(places)[0] >= 0]
        if isinstance(body, Meshed) and is_sheet(body, fluid.dimension) and len(places):
            # along a wall it is not within
            places = places[deep_in_mesh(fluid.location, places, TOUCHING * fluid.extent)]
        places = places if len(places) else swallowed(fluid.grid, body)
        if len(places):
            raise InputError(
                f"{body.label} lies within {fluid.label}, at {places[0].round(6).tolist()} for instance, and neither "
                f"feels the other: {cure(body)}, move it, or allow it by Fluid(dry=True)"
            )


def swallowed(grid: Mesh, body: Owner) -> Array:
    """Centres (n, d) of some cells all over a mesh that lie inside of a body: all may lie in one of its cells."""
    centres: Array = grid.centres
    some: Array = centres[np.unique(np.linspace(0, len(centres) - 1, SOME).astype(int))]
    if isinstance(body, Meshed) and body.dimension == grid.dimension == body.grid.dimension:
        low, high = body.grid.bounding_box
        return inside_mesh(body.grid, some[np.all((low < some) & (some < high), axis=1)])
    if isinstance(body, RigidBody) and body.shape is not None:
        return inside_body(body, *body.shape.surface(), some)
    return np.zeros((0, grid.dimension))


def cure(body: Owner) -> str:
    """Advice in errors: the component that couples a body to the fluid in which it lies."""
    if isinstance(body, MeshBody):
        return "add vv.ImmersedThin(body=...)" if body.is_thin else "add vv.Immersed(solid=...)"
    if isinstance(body, RigidBody):
        return "add vv.ImmersedBody(body=...)"
    return "leave its place out of the mesh of the fluid"


def deep_in_mesh(location: Location, places: Array, reach: float) -> NDArray[np.bool_]:
    """Which places (n, d) are farther than that from the border of a mesh."""
    inside = np.ones(len(places), dtype=bool)
    for way in itertools.product((-reach, reach), repeat=places.shape[1]):
        inside[inside] = location.find(places[inside] + way)[0] >= 0
    return inside


def inside_mesh(grid: Mesh, places: Array) -> Array:
    """Those of places (n, d) that lie within cells of a mesh, and not on their borders."""
    search = Location(grid)
    cells, xi = search.find(places)
    within = np.zeros(len(places), dtype=bool)
    for name, mine, _ in search.parts(cells):
        within[mine] = outside(CELLS[name], xi[mine]) < -INTERIOR
    return np.asarray(places[within])


def inside_body(body: RigidBody, points: Array, triangles: NDArray[np.int64], places: Array) -> Array:
    """Those of places (n, d) that lie within a rigid body, and not on its surface; in a plane within the prism.

    The surface has triangles between points (k, 3) in the body's own coordinates.
    """
    flat = places.shape[1] == 2
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
