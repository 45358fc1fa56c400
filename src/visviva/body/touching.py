"""Surfaces of mesh bodies for contact and tying: points linear in the unknowns, and faces between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.faces import Faces
from visviva.model.form import Form, Vector

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
NO_FACES = Faces({}, {})


@dataclass(frozen=True, eq=False)
class Skin:
    """The surface of a body: solids are touched at the nodes of their faces, shells at both of their sides.

    Attributes
    ----------
    vectors : callable
        First unknowns (v,) of the vectors that the points are made of, once the body is part of a system.
    weights : sparse array, (p, v)
        Of the vectors in the points.
    points : array, (p, 3)
        In the reference configuration.
    nodes : array of int, (p,)
        The node of the mesh that a point belongs to.
    faces : Faces
        What is touched, between the points and looking outwards; none where the points themselves are.
    whole : Faces
        The whole surface that they are part of, by which bodies know how thick they are.
    dimension : int
    directors : array, (n, 3), optional
        Reference of vectors of constant length at the nodes, which stand behind those of the n positions.
    drawn : array of int, (k,), optional
        Nodes that the points belong to which are drawn, if these are not the nodes.
    mass : float, optional
        Mass by area of what is thinner than a layer of elements.
    round : Round, optional
        Where the points are the middle of a round bar.
    folds : array of int
        Nodes (k,) of the mesh at which smooth parts meet, each with sides of its own.
    """

    vectors: Callable[[], NDArray[np.int32]]
    weights: sp.csr_array
    points: Array
    nodes: Ints
    faces: Faces
    whole: Faces
    dimension: int = 3
    directors: Array | None = None
    drawn: Ints | None = None
    mass: float | None = None
    round: Round | None = None
    folds: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def used(self) -> Ints:
        """Points (k,) of the faces in ascending order; all where there are none."""
        return np.arange(len(self.points)) if self.round else self.faces.nodes

    @property
    def touched(self) -> Ints:
        """Nodes (k,) of the mesh that these points belong to, in ascending order."""
        return np.unique(self.nodes[self.used])

    def combination(self, weights: Array) -> Vector:
        """A sum of the used points (k,) by weights as a vector form."""
        of_vectors = weights @ self.weights[self.used]
        kept = np.flatnonzero(of_vectors)
        starts, values = self.vectors()[kept].tolist(), of_vectors[kept].tolist()
        x, y, z = (
            Form(tuple((u + c, w) for u, w in zip(starts, values, strict=True)) if c < self.dimension else ())
            for c in range(3)
        )
        return Vector((x, y, z))

    def director(self, node: int) -> list[tuple[Vector, Array]]:
        """The vector of constant length at a node, if there is one, and its reference (3,)."""
        if self.directors is None:
            return []
        return [(Vector.of(int(self.vectors()[len(self.directors) + node])), self.directors[node])]

    @property
    def keys(self) -> set[tuple[int, ...]]:
        """Key that tells parts of one body apart: the points of every face in ascending order."""
        if self.round:
            return {(int(node),) for node in self.touched}
        return {tuple(row) for rows in self.faces.cells.values() for row in np.sort(rows, axis=1).tolist()}


@dataclass(frozen=True, eq=False)
class Round:
    """Points along the middle of a round bar.

    Attributes
    ----------
    radius : float
    places : array, (p, 3)
        In the reference configuration.
    areas : array, (p,)
        Length times diameter that belongs to each point.
    axes : sparse array, (3 p, v)
        Weights of the vectors in the directors there, those of a point after each other.
    segments : array of int, (s, 2)
        Neighbours along the bar.
    """

    radius: float
    places: Array
    areas: Array
    axes: sp.csr_array
    segments: Ints


def both_sides(cells: Mapping[str, Ints], edges: Mapping[str, Ints], n: int) -> tuple[Faces, Faces, Faces]:
    """The upper side, the lower side and the rim of cells of a surface.

    Point i of the lower side is node i, of the upper one i + n. Edges run as the cells do.
    """
    upper = {kind: nodes + n for kind, nodes in cells.items()}
    lower = {kind: nodes[:, reversed_order(kind)] for kind, nodes in cells.items()}
    ends = [e[:, [i, j]] for e in edges.values() for i, j in ([(0, 1)], [(0, 2), (2, 1)])[e.shape[1] - 2]]
    rim = {"quad4": np.concatenate([np.column_stack([e, e[:, ::-1] + n]) for e in ends])} if ends else {}
    return as_faces(upper), as_faces(lower), as_faces(rim)


def reversed_order(kind: str) -> list[int]:
    """Nodes of a face in an order by which it looks to the other side."""
    corners = 3 if kind.startswith("tri") else 4
    turned = [0, *range(corners - 1, 0, -1)]
    middles = [corners + i for i in range(corners - 1, -1, -1)]
    return {3: turned, 6: turned + middles, 4: turned, 8: turned + middles, 9: [*turned, *middles, 8]}[
        int(kind.lstrip("triquad"))
    ]


def as_faces(cells: Mapping[str, Any]) -> Faces:
    """Faces whose owners are numbered as they come."""
    return Faces(cells, {kind: np.arange(len(nodes)) for kind, nodes in cells.items()})


def looks_up(rows: Ints, cells: Ints) -> NDArray[np.bool_]:
    """True (m,) where a face lists its nodes in the same sense of rotation as the cell that it is."""
    n = 3 if cells.shape[1] in (3, 6) else 4
    first = np.argmax(cells[:, :n] == rows[:, :1], axis=1)
    return np.asarray(cells[np.arange(len(cells)), (first + 1) % n] == rows[:, 1])
