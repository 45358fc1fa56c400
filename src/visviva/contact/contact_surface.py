"""Surfaces that touch: vertices as linear forms of unknowns, and flat or bilinear facets between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.rigid import RigidBody
from visviva.body.touching import Skin
from visviva.component.component import Component
from visviva.component.point import Attachable
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.model.form import Vector

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SUBFACETS: dict[str, tuple[tuple[int, ...], ...]] = {
    "line2": ((0, 1),),
    "line3": ((0, 2), (2, 1)),
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad4": ((0, 1, 2, 3),),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (7, 6, 3), (4, 5, 6, 7)),
    "quad9": ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
"""Quadratic faces are cut into facets (Puso, Laursen & Solberg 2008)."""

BEYOND = {"line3": 1 / 6, "tri6": 1 / 6, "quad8": 0.3, "quad9": 1 / 6}
"""By so much of its edge's two corners the vertex in the middle of an edge lies beyond its node: see `lifted`."""


NO_FACETS = np.zeros((0, 4), dtype=np.int64)


class Faced(Protocol):
    """Component with a surface of faces of a mesh."""

    @property
    def dimension(self) -> int:
        """Of space: 2 or 3."""
        ...

    @property
    def axisymmetric(self) -> bool:
        """Whether a plane mesh stands for a revolution."""
        ...


@dataclass(frozen=True)
class Surface:
    """Vertices and facets of a surface.

    Attributes
    ----------
    forms : list of list of (int, float)
        For each vertex: first unknowns of vectors, and their weights.
    on_mesh : bool
        Whether each vertex is a node of a mesh.
    constant : array, (n, 3)
        What is added to the weighted vectors.
    facets : array of int, (m, 4)
        Vertices of the facets, anticlockwise as seen from outside, -1 where there are fewer than four; in the plane
        two, with the outside to the right.
    places : array, (n, 3)
        Positions of the vertices in the reference configuration.
    dimension : int
    axisymmetric : bool
        Edges stand for surfaces of revolution about the second axis.
    thick : array, (n,), optional
        Thickness of the body behind points without facets.
    source : array of int, (n,), optional
        Where several vertices stand for one place, at sharp edges and on the sides of shells: which.
    whole : Surface, optional
        What it is a part of, if that is known.
    extent : array, (n,), optional
        Areas that belong to the points of a round bar.
    across : float
        Its diameter.
    copies : int
        So many sets of the same points, one behind the other: see `repeated`.
    around : array of int, (k, 4), optional
        Facets of a rigid body that its points stand for.
    """

    forms: list[list[tuple[int, float]]]
    on_mesh: bool
    constant: Array
    facets: Ints
    places: Array
    dimension: int
    axisymmetric: bool = False
    thick: Array | None = None
    source: Ints | None = None
    whole: Surface | None = None
    extent: Array | None = None
    across: float = 0.0
    copies: int = 1
    around: Ints | None = None

    def gathered(self, values: Array, how: Any = np.sum) -> Any:
        """Of each point what `values` (copies n, ...) of its copies come to."""
        return how(values.reshape(self.copies, -1, *values.shape[1:]), axis=0) if self.copies > 1 else values

    @cached_property
    def sights(self) -> Array:
        """Thickness of the body behind each facet, and free way before it, (m, 2); inf where nothing is known."""
        if self.whole is not None:
            every = {where_of(corners): k for k, corners in enumerate(self.whole._corners())}
            return self.whole.sights[[every[where_of(corners)] for corners in self._corners()]]
        if self.extent is not None or (
            self.dimension == 3 and (self.facets[:, 2:] < 0).all()
        ):  # lines have no sides
            return np.full((len(self.facets), 2), np.inf)
        found = _core.sights(self.dimension, self.places.ravel(), self.facets.astype(np.int32).ravel())
        return np.asarray(found).reshape(-1, 2)

    @cached_property
    def behind(self) -> Array:
        """Thickness of the body behind each vertex (n,)."""
        behind = np.full(len(self.forms), np.inf) if self.thick is None else self.thick.copy()
        used = self.facets >= 0
        np.minimum.at(behind, self.facets[used], np.repeat(self.sights[:, 0], used.sum(axis=1)))
        return behind

    @cached_property
    def areas(self) -> Array:
        """Area (n,) that belongs to each vertex; length in the plane, 1 for points without facets."""
        if self.extent is not None:
            return self.extent
        if len(self.facets) == 0:
            return np.ones(len(self.places))
        there = self.facets >= 0
        share = np.where(there, (self._facet_areas() / there.sum(axis=1))[:, None], 0.0)
        if self.axisymmetric:  # of the edge to each end, with the mean circumference there
            r = self._corners()[:, :2, 0]
            share[:, :2] *= 2 * np.pi * (2 * r + r[:, ::-1]) / 3
        total = np.bincount(self.facets[there], share[there], minlength=len(self.places))
        return np.asarray(total, dtype=float)

    def _facet_areas(self) -> Array:
        return np.asarray(np.linalg.norm(self._area_vectors(), axis=1))

    @property
    def normals(self) -> Array:
        """Unit normals (m, 3) of the facets; zero of those without area."""
        vectors = self._area_vectors()
        sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
        return np.asarray(vectors / np.where(sizes > 0, sizes, 1.0))

    def _area_vectors(self) -> Array:
        corners = self._corners()
        if self.dimension == 2:
            return np.cross(corners[:, 1] - corners[:, 0], (0.0, 0.0, 1.0))
        # of a triangle, whose fourth corner is the first one, this is the product of two of its edges
        return 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])

    def _corners(self) -> Array:
        """Corners (m, 4, 3) of the facets; those that a facet lacks are its first one."""
        return self.places[np.where(self.facets >= 0, self.facets, self.facets[:, :1])]

    @cached_property
    def size(self) -> float:
        """Largest diameter of a facet, or of a round bar; 0 for points without facets."""
        if self.across > 0:
            return self.across
        corners = self._corners()
        spans = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=-1)
        return float(spans.max(initial=0.0))


@cache
def lifted(kind: str) -> Array:
    """Weights (k, k) of a face's nodes in the vertices of its facets.

    On straight edges vertices are where the nodes are; on curved ones those in the middle lie beyond them. A pressure
    that is constant over the facets then acts on the nodes as it does on the face with its quadratic functions.
    """
    face = CELLS[kind]
    T = np.eye(face.n_nodes)
    for middle, corners in enumerate(face.middles, start=face.n_corners):
        beyond = BEYOND[kind]
        if len(corners) == 2:
            T[middle, middle] += 2 * beyond
            T[middle, list(corners)] = -beyond
        else:  # along both directions of quad9
            ends = slice(0, face.n_corners), slice(face.n_corners, middle)
            T[middle, ends[0]], T[middle, ends[1]] = beyond**2, -beyond * (1 + 2 * beyond)
            T[middle, middle] = (1 + 2 * beyond) ** 2
    return T


def vertices_of(faces: Faces) -> sp.csr_array:
    """Weights (n, n) of the nodes of faces in the vertices of their facets."""
    import scipy.sparse as sp

    n = len(faces.nodes)
    weights = sp.lil_array((n, n))
    weights.setdiag(1.0)
    for kind, cells in faces.cells.items():
        T, number = lifted(kind), np.searchsorted(faces.nodes, cells)
        for middle in range(CELLS[kind].n_corners, T.shape[0]):
            for node in range(T.shape[0]):
                if T[middle, node]:
                    weights[number[:, middle], number[:, node]] = T[middle, node]
    return weights.tocsr()


def surface_of(component: Attachable, faces: str | Faces, label: str) -> Surface:
    """The surface of a mesh given by faces, or the whole one of a rigid body or the ground."""
    if isinstance(component, MeshBody):
        return of_skin(component, component.skin(faces))
    return _of_shape(component, faces, label)


def mesh_bodies(*bodies: Component | None) -> list[MeshBody]:
    """Deformable bodies; contact knows others by their shape."""
    return [body for body in bodies if isinstance(body, MeshBody)]


def of_skin(body: MeshBody, own: Skin) -> Surface:
    """The surface of a body that is part of a system."""
    used = own.used
    shaped = own.weights[used] if own.round else vertices_of(own.faces) @ own.weights[used]
    surface = of_points(body, own, forms_of(shaped, own.vectors()))
    nodes, source = np.unique(own.nodes[used], return_inverse=True)
    return replace(
        surface,
        places=surface.places if own.round else np.asarray(vertices_of(own.faces) @ own.points[used]),
        source=None if len(nodes) == len(used) else source,
        whole=None if own.whole is own.faces or own.round else _whole(body, own),
    )


def layer_mass(body: MeshBody, size: float) -> float:
    """Mass by area of a layer of this thickness, or of the whole of what is thinner; by length of plane bodies."""
    own = body.skin("all").mass
    return body.density * size * body.thickness if own is None else own


def _whole(body: MeshBody, own: Skin) -> Surface:
    every = replace(own, faces=own.whole)
    return replace(
        of_points(body, every, []), places=np.asarray(vertices_of(own.whole) @ own.points[every.used])
    )


def forms_of(weights: sp.csr_array, unknowns: NDArray[np.int32]) -> list[list[tuple[int, float]]]:
    """Rows of weights of vectors that start at these unknowns."""
    weights = weights.tocsr()
    weights.sort_indices()
    starts, where, values = weights.indptr.tolist(), unknowns[weights.indices].tolist(), weights.data.tolist()
    return [list(zip(where[a:b], values[a:b], strict=True)) for a, b in pairwise(starts)]


def where_of(corners: Array) -> tuple[tuple[float, ...], ...]:
    """Key of a facet: the places of its corners, whichever comes first."""
    return tuple(sorted(map(tuple, corners.tolist())))


def of_points(body: Faced, own: Skin, forms: list[list[tuple[int, float]]]) -> Surface:
    """The surface of a body whose points of the skin, as far as it has faces there, are these forms."""
    points = own.used
    number = np.full(len(own.points), -1)
    number[points] = np.arange(len(points))
    rows = [NO_FACETS]
    for kind, cells in own.faces.cells.items():
        for part in SUBFACETS[kind]:
            facets = np.full((len(cells), 4), -1)
            facets[:, : len(part)] = number[cells[:, list(part)]]
            rows.append(facets)
    places = own.points[points]
    surface = Surface(
        forms, True, np.zeros_like(places), np.concatenate(rows), places, body.dimension, body.axisymmetric
    )
    bar = own.round
    return replace(surface, extent=bar.areas, across=2 * bar.radius) if bar else surface


def joined(*parts: Surface) -> Surface:
    """Vertices without facets, one surface after the other."""
    return Surface(
        [form for part in parts for form in part.forms],
        False,
        np.concatenate([part.constant for part in parts]),
        NO_FACETS,
        np.concatenate([part.places for part in parts]),
        3,
    )


def repeated(points: Surface, times: int) -> Surface:
    """Points without facets, one set of them behind the other."""
    if times == 1:
        return points
    return replace(
        points,
        forms=points.forms * times,
        constant=np.tile(points.constant, (times, 1)),
        places=np.tile(points.places, (times, 1)),
        thick=None if points.thick is None else np.tile(points.thick, times),
        copies=times,
    )


def _of_shape(component: Attachable, faces: str | Faces, label: str) -> Surface:
    shape = component.shape if isinstance(component, RigidBody) else None
    surface = component.surface()
    if surface is None:
        raise InputError(f"{label}: {component.label} has no surface; give it a shape, or take a solid")
    if shape is not None:
        points, facets = shape.facets()
    else:
        points, facets = surface[0], np.pad(surface[1], ((0, 0), (0, 1)), constant_values=-1)
    if faces != "all":
        facets = facets[_named(component, faces, label)]
        used = np.unique(facets[facets >= 0])
        number = np.append(np.cumsum(np.isin(np.arange(len(points)), used)) - 1, -1)
        points, facets = points[used], number[facets]
    return of_vectors([component.place(X) for X in points], facets, points)


def _named(component: Attachable, faces: str | Faces, label: str) -> Ints:
    """Facets of a face of a rigid body's shape."""
    shape = component.shape if isinstance(component, RigidBody) else None
    named = {} if shape is None else shape.faces
    if not isinstance(faces, str) or faces not in named:
        names = ", ".join(map(repr, named)) or "none"
        raise InputError(
            f"{label}: the shape of {component.label} has no face {faces!r}, but {names}; 'all' is its whole surface"
        )
    return named[faces]


def of_vectors(vectors: list[Vector], facets: Ints, places: Array) -> Surface:
    """A surface whose vertices are vector forms."""
    forms = [list(v[0].weights) for v in vectors]
    constant = np.array([[c.constant for c in v] for v in vectors])
    return Surface(forms, False, constant, facets, places, 3)


def positions(surface: Surface, x: Array) -> Array:
    """Positions (n, 3) of the vertices at the unknowns `x`."""
    places = surface.constant.copy()
    for place, form in zip(places, surface.forms, strict=True):
        for unknown, weight in form:
            place[: surface.dimension] += weight * x[unknown : unknown + surface.dimension]
    return places


def points_of(
    component: Attachable, faces: str | Faces, label: str, fine: bool = False
) -> tuple[Surface, float]:
    """Points at which a component touches exact shapes and facets, and the radius of balls about them."""
    if isinstance(component, MeshBody):
        own = component.skin(faces, fine)
        return of_skin(component, own), own.round.radius if own.round else 0.0
    feelers = component.feelers()
    if feelers is None:
        raise InputError(f"{label}: nothing says where {component.label} touches; give it a shape")
    points, radius = feelers
    if radius == 0 and isinstance(component, RigidBody):  # vertices of its shape
        shape = _of_shape(component, faces, label)
        return replace(shape, facets=NO_FACETS, thick=shape.behind, around=shape.facets), radius
    if faces != "all":
        _named(component, faces, label)  # round shapes have no faces, points neither
    thick = np.full(len(points), 2 * radius if radius > 0 else np.inf)
    return replace(of_vectors([component.place(X) for X in points], NO_FACETS, points), thick=thick), radius


def skin(first: Surface, second: Surface | None, *frames: Surface, sees: bool = True) -> Any:
    """The core's description of two surfaces, or of one that may touch itself, and of frames.

    Where it `sees`, facets know their own bodies, which are in the way of what is behind them.
    """
    parts = [first] if second is None else [first, second, *frames]
    forms = [form for part in parts for form in part.forms]
    starts = np.concatenate([[0], np.cumsum([len(form) for form in forms])])
    shifts = np.cumsum([0, *(len(part.forms) for part in parts)])
    facets = [np.where(p.facets >= 0, p.facets + s, -1) for p, s in zip(parts, shifts, strict=False)]
    none = np.full((sum(len(p.facets) for p in parts), 2), np.inf)
    sights = np.concatenate([p.sights for p in parts]) if sees else none
    on_mesh = [np.full(sum(len(f) for f in p.forms), p.on_mesh) for p in parts]
    return _core.Skin(
        first.dimension,
        starts.astype(np.int32),
        np.array([u for form in forms for u, _ in form], dtype=np.int32),
        np.array([w for form in forms for _, w in form], dtype=float),
        np.concatenate(on_mesh).astype(np.int32),
        np.concatenate([p.constant for p in parts]).ravel(),
        np.concatenate(facets).astype(np.int32).ravel(),
        np.ascontiguousarray(sights[:, 0]),
        np.ascontiguousarray(sights[:, 1]),
        len(first.facets),
        0 if second is None else len(first.facets),
    )
