"""Quadrature points of a fluid's faces, with the cells behind them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.flow.elements import flow_face_rule
from visviva.mesh.cells import CELLS
from visviva.mesh.convert import cell_numbers
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class FlowFaces:
    """Faces of one type of cells of one type.

    Attributes
    ----------
    nodes : int array (m, k)
        Of the cells behind the faces.
    N, gradients : arrays (m, q, k), (m, q, k, d)
        Shape functions of these and their gradients at the faces' points.
    normal : array (m, q, d)
        Outward, times the area of the point.
    X : array (m, q, 3)
        The points.
    rows : int array (m,)
        Which of all faces they are, through all types.
    """

    nodes: Ints
    N: Array
    gradients: Array
    normal: Array
    X: Array
    rows: Ints

    @property
    def on_face(self) -> NDArray[np.bool_]:
        """Mask of the nodes (m, k) that lie on the face."""
        found: NDArray[np.bool_] = np.abs(self.N).max(axis=1) > 1e-12
        return found

    def spread(self, values: Array, n_nodes: int) -> Array:
        """Sums ``sum N values`` (n_nodes, c) of values (m, q, c)."""
        total = np.zeros((n_nodes, values.shape[2]))
        np.add.at(total, self.nodes, np.einsum("mqk,mqc->mkc", self.N, values))
        return total


def flow_faces(grid: Mesh, faces: Faces) -> Iterator[FlowFaces]:
    """The points of faces, by types of faces and cells."""
    numbers, first = cell_numbers(grid.cells), 0
    for kind, rows in faces.cells.items():
        for name, cells in numbers.items():
            mine = np.flatnonzero((faces.owners[kind] >= cells[0]) & (faces.owners[kind] <= cells[-1]))
            if len(mine):
                behind = grid.cells[name][faces.owners[kind][mine] - cells[0]]
                yield _points(grid.points, kind, rows[mine], name, behind, first + mine)
        first += len(rows)


def _points(points: Array, kind: str, rows: Ints, name: str, behind: Ints, numbers: Ints) -> FlowFaces:
    face, cell = CELLS[kind], CELLS[name]
    rule = flow_face_rule(name, kind)
    N, dN = face.N(rule.points), face.dN(rule.points)
    local = np.argmax(behind[:, :, None] == rows[:, None, :], axis=1)
    xi = np.einsum("qk,mkd->mqd", N, cell.nodes[local])
    m, q, d = xi.shape
    N_cell = cell.N(xi.reshape(-1, d)).reshape(m, q, -1)
    dN_cell = cell.dN(xi.reshape(-1, d)).reshape(m, q, -1, d)
    J = np.einsum("mkx,mqkj->mqxj", points[behind], dN_cell)
    tangents = np.einsum("mkc,qkt->mqtc", points[rows], dN)
    if d == 2:
        outward = np.stack([tangents[:, :, 0, 1], -tangents[:, :, 0, 0]], axis=2)
    else:
        outward = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    X = np.einsum("mkc,qk->mqc", points[rows], N)
    return FlowFaces(
        behind,
        np.ascontiguousarray(N_cell),
        np.ascontiguousarray(dN_cell @ np.linalg.inv(J)),
        np.ascontiguousarray(rule.weights[:, None] * outward),
        np.pad(X, ((0, 0), (0, 0), (0, 3 - d))),
        numbers,
    )


def flux_weights(grid: Mesh, faces: Faces) -> Array:
    """Weights (n_nodes, d) of the nodal velocities in what flows out through faces."""
    parts = [p.spread(p.normal, grid.n_nodes) for p in flow_faces(grid, faces)]
    return np.asarray(sum(parts, np.zeros(grid.points.shape)))
