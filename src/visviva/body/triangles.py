"""Closed triangle surfaces: made by revolution, read from files, checked.

A surface is a pair of points (n, 3) and triangles (m, 3), rows of points, anticlockwise as seen from outside.
"""

import io
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.source_files import existing

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]
Surface = tuple[Array, Triangles]
KINDS = ("stl", "obj", "ply")


def halve(quads: Triangles) -> Triangles:
    """Two triangles (2m, 3) for each quadrilateral (m, 4)."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def arc(radius: float, start: float, end: float, n_segments: int) -> Array:
    """Profile (n, 2), distances from the axis and heights, along a circle about the origin; degrees."""
    angle = np.radians(np.linspace(start, end, n_segments + 1))
    profile = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    profile[np.abs(profile) < 1e-15 * radius] = 0.0
    return profile


def revolve(profile: Array, n_segments: int) -> Surface:
    """Surface of revolution about e3 of a profile (k, 2) from bottom to top, both its ends on the axis."""
    if n_segments < 3:
        raise InputError(f"resolution is {n_segments}: give at least 3 segments round the circle")
    n, n_rings = n_segments, len(profile) - 2
    angle = 2 * np.pi * np.arange(n) / n
    round_circle = np.stack([np.cos(angle), np.sin(angle), np.ones(n)], axis=1)
    rings = [round_circle * (radius, radius, height) for radius, height in profile[1:-1]]
    points = np.vstack([*rings, (0, 0, profile[0, 1]), (0, 0, profile[-1, 1])])

    here = np.arange(n_rings * n).reshape(n_rings, n)
    there = np.roll(here, -1, axis=1)
    bands = [np.column_stack([here[i], there[i], there[j], here[j]]) for i, j in pairwise(range(n_rings))]
    pole = np.full(n, n_rings * n)
    bottom = np.column_stack([pole, there[0], here[0]])
    top = np.column_stack([pole + 1, here[-1], there[-1]])
    return points, np.concatenate([bottom, *map(halve, bands), top])


def read(file: Path) -> Surface:
    """Triangles of an STL, OBJ or PLY file, equal points merged, triangles that collapse by it dropped."""
    existing(file)
    trimesh = load_trimesh()
    kind = file.suffix[1:].lower()
    if kind not in KINDS:
        raise InputError(f"{file} cannot be read as a mesh by its ending: give an STL, OBJ or PLY file")
    try:
        stream = io.BytesIO(file.read_bytes())  # without a path, materials it names are not looked for
        mesh = trimesh.load_mesh(stream, file_type=kind, process=False)
        corners = np.asarray(mesh.triangles, dtype=np.float64).reshape(-1, 3)
    except Exception as error:  # the readers of trimesh raise whatever the bytes lead them to
        raise InputError(
            f"{file} cannot be read as a mesh ({error}): give an STL, OBJ or PLY file"
        ) from error
    if not np.isfinite(corners).all():
        raise InputError(f"{file} holds points that are not finite: export it again")
    points, index = np.unique(corners + 0.0, axis=0, return_inverse=True)
    triangles = np.asarray(index, dtype=np.int64).reshape(-1, 3)
    a, b, c = triangles.T
    return points, triangles[(a != b) & (b != c) & (c != a)]


def check_closed(points: Array, triangles: Triangles) -> Surface:
    """Return the surface with outward normals, or refuse it where that leaves a doubt (see `SurfaceMesh`)."""
    if not len(triangles):
        raise InputError(
            "the mesh has no triangles: give a surface of triangles (is the file of the kind it says?)"
        )
    if triangles.max() >= len(points):
        raise InputError(f"a triangle names point {triangles.max()}, but there are only {len(points)} points")
    mesh = load_trimesh().Trimesh(points, triangles, process=False)
    if not mesh.is_watertight:
        raise InputError(_openness(triangles))
    turned = not mesh.is_winding_consistent
    if turned:
        triangles = _turn_alike(triangles)
    volume = float(np.linalg.det((points - points.mean(axis=0))[triangles]).sum()) / 6
    if abs(volume) <= 1e-14 * np.linalg.norm(np.ptp(points, axis=0)) ** 3:
        raise InputError("the mesh encloses no volume: give a body its thickness")
    if volume < 0.0 and not turned:
        raise InputError(
            f"the mesh is inside out, its volume is {volume:.6g}: reverse the order of points in each "
            "triangle (`triangles[:, ::-1]`, or 'flip normals' in the program that made the file)"
        )
    return points, triangles[:, ::-1] if volume < 0.0 else triangles


def load_trimesh() -> Any:
    """The optional package trimesh, imported where it is first needed."""
    try:
        import trimesh
    except ImportError as error:
        raise InputError('a surface mesh needs the package trimesh: pip install "visviva[mesh]"') from error
    return trimesh


def _edges(triangles: Triangles) -> Triangles:
    """Directed edges (3m, 2), those of one triangle after each other."""
    return triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def _openness(triangles: Triangles) -> str:
    edges, count = np.unique(np.sort(_edges(triangles), axis=1), axis=0, return_counts=True)
    bad = edges[count != 2]
    return (
        f"the mesh is not closed: {len(bad)} of {len(edges)} edges do not belong to exactly two triangles, "
        f"the first joins points {bad[0, 0]} and {bad[0, 1]}: fill the holes, let neighbours share "
        "their points, and split bodies that touch along an edge"
    )


def _turn_alike(triangles: Triangles) -> Triangles:
    """Turn the triangles of one connected closed surface so that neighbours agree, with either side outside.

    Every triangle enters a graph twice, as given (i) and reversed (i + m), linked where neighbours agree
    across their edge. A connected surface with two sides gives two connected components, one for each
    orientation.
    """
    from scipy.sparse import coo_array  # costs more time to import than all the rest, and is seldom needed
    from scipy.sparse.csgraph import connected_components

    m, edges = len(triangles), _edges(triangles)
    forward = edges[:, 0] < edges[:, 1]
    first, second = np.lexsort(np.sort(edges, axis=1).T).reshape(-1, 2).T
    agree = forward[first] != forward[second]
    i, j = first // 3, second // 3
    rows, columns = np.concatenate([i, i + m]), np.concatenate([j + m * ~agree, j + m * agree])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * m, 2 * m))
    n_components, component = connected_components(graph, directed=False)
    if n_components != 2:
        kind = "has one side only" if n_components == 1 else "consists of several surfaces"
        raise InputError(
            f"the triangles of the mesh contradict each other about which side is outside, and it {kind}: "
            "orient it anticlockwise as seen from outside, or give one mesh per body"
        )
    kept = component[:m] == component[0]
    return np.where(kept[:, None], triangles, triangles[:, ::-1])
