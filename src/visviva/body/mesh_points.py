"""Quadrature points of meshes and their faces in the reference configuration, for loads and couplings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.element import depth
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.mesh.geometry import jacobians, measure
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import mass_rule

if TYPE_CHECKING:
    from visviva.body.mesh_body import MeshBody

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Points:
    """Quadrature points of cells or faces of one type.

    Attributes
    ----------
    nodes : array, (m, k)
        Nodes of m cells.
    N : array, (q, k)
        Shape functions at q points.
    X : array, (m, q, 3)
        Reference positions of the points.
    size : array, (m, q)
        Reference volume or area of each point; in the plane with the thickness or circumference.
    """

    nodes: Ints
    N: Array
    X: Array
    size: Array

    def unknowns(self, solid: MeshBody) -> NDArray[np.int32]:
        """First unknowns (m, v) of the vectors that places are made of."""
        return solid.node_unknowns(self.nodes)

    def of_vectors(self, shapes: Array) -> Array:
        """Shape functions or derivatives (q, k) as weights (m, q, v) of the vectors that places are made of."""
        return np.broadcast_to(shapes, (len(self.nodes), *shapes.shape))

    def forces(self, densities: Array) -> Array:
        """Forces (m, v, c) on these vectors by densities (m, q, c) per volume or area."""
        return np.asarray(np.einsum("mq,mqv,mqc->mvc", self.size, self.of_vectors(self.N), densities))

    def spread(self, densities: Array, n_nodes: int) -> Array:
        """Consistent nodal values (n_nodes, c) of densities (m, q, c) per volume or area."""
        total = np.zeros((n_nodes, densities.shape[2]))
        np.add.at(total, self.nodes, np.einsum("mq,qk,mqc->mkc", self.size, self.N, densities))
        return total


@dataclass(frozen=True, kw_only=True)
class FacePoints(Points):
    """Quadrature points of faces (edges if plane) of one type.

    Attributes
    ----------
    dN : array, (q, k, d - 1)
        Derivatives of the shape functions by the face's coordinates.
    weights : array, (q,)
    normal : array, (m, q, 3)
        Outward unit normals.
    heights : array, (m, k), optional
        Of the sides of shells, along directors: places are ``phi + h d`` at nodes.
    directors : callable, optional
        First unknowns (m, k) of these, once the shell is part of a system.
    """

    dN: Array
    weights: Array
    normal: Array
    heights: Array | None = None
    directors: Callable[[], NDArray[np.int32]] | None = None

    def unknowns(self, solid: MeshBody) -> NDArray[np.int32]:
        own = super().unknowns(solid)
        return own if self.directors is None else np.hstack([own, self.directors()])

    def of_vectors(self, shapes: Array) -> Array:
        every = super().of_vectors(shapes)
        if self.heights is None:
            return every
        return np.concatenate([every, self.heights[:, None] * shapes], axis=2)


def cell_points(grid: Mesh, *, thickness: float = 1.0, axisymmetric: bool = False) -> Iterator[Points]:
    """Quadrature points of cells for volume forces, type by type."""
    points = in_space(grid)
    for kind, nodes in grid.cells.items():
        xi, w = mass_rule(kind)
        N = CELLS[kind].N(xi)
        size = w * measure(jacobians(grid.points, nodes, CELLS[kind].dN(xi)))
        if grid.points.shape[1] == 2:
            size = size * depth(points, nodes, N, thickness, axisymmetric)
        yield Points(nodes=nodes, N=N, X=np.einsum("mkc,qk->mqc", points[nodes], N), size=size)


def face_points(
    grid: Mesh, faces: Faces, *, thickness: float = 1.0, axisymmetric: bool = False
) -> Iterator[FacePoints]:
    """Quadrature points of faces, type by type.

    Examples
    --------
    >>> import visviva as vv
    >>> block = vv.BoxMesh(size=(1, 2, 3), counts=(2, 2, 2)).build()
    >>> round(sum(float(p.size.sum()) for p in face_points(block, block.faces("x1"))), 12)
    6.0
    """
    points, plane = in_space(grid), grid.points.shape[1] == 2
    if not plane and any(CELLS[kind].dimension == 1 for kind in faces.cells):
        raise InputError(
            "edges of a surface in space are no faces: normals and areas are of faces of solids, or of edges in a plane"
        )
    for kind, nodes in faces.cells.items():
        xi, w = mass_rule(kind)
        N, dN = CELLS[kind].N(xi), CELLS[kind].dN(xi)
        tangents = np.einsum("mkc,qkt->mqtc", points[nodes], dN)
        across = np.array([0.0, 0.0, 1.0]) if plane else tangents[:, :, 1]
        outward = np.cross(tangents[:, :, 0], across)
        size = np.linalg.norm(outward, axis=2)
        area = w * size
        if plane:
            area = area * depth(points, nodes, N, thickness, axisymmetric)
        X = np.einsum("mkc,qk->mqc", points[nodes], N)
        normal = outward / size[:, :, None]
        yield FacePoints(nodes=nodes, N=N, X=X, size=area, dN=dN, weights=w, normal=normal)


def in_space(grid: Mesh) -> Array:
    """Positions (n, 3) of the nodes."""
    return np.pad(grid.points, ((0, 0), (0, 3 - grid.points.shape[1])))
