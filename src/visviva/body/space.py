"""Spaces of scalar fields: shape functions of finite elements, as tables at quadrature points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.element import depth
from visviva.body.mesh_points import face_points, in_space
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.mesh.geometry import jacobians, measure
from visviva.mesh.mesh import Mesh
from visviva.mesh.periodic import numbering
from visviva.mesh.quadrature import corner_rule, mass_rule

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FLAT = 0.02
"""Part of a cell's mean size that it has at least at a corner for quadrature."""


@dataclass(frozen=True, kw_only=True)
class Table:
    """Shape functions of elements of one kind at their quadrature points.

    Attributes
    ----------
    numbers : array of int (m, k)
        Coefficients of each of m elements.
    N : array (m, q, k)
    gradients : array (m, q, k, 3)
        Zero at the points of faces.
    size : array (m, q)
        Volume or area of each point.
    X : array (m, q, 3)
        Where the points are.
    laplacians : array (m, q, k) or None
        Of spaces whose functions have two derivatives.
    """

    numbers: Ints
    N: Array
    gradients: Array
    size: Array
    X: Array
    laplacians: Array | None = None

    def at(self, coefficients: Array) -> Array:
        """Values (m, q) of a field."""
        return np.asarray(np.einsum("mqk,mk->mq", self.N, coefficients[self.numbers]))

    def slopes(self, coefficients: Array) -> Array:
        """Gradients (m, q, 3) of a field."""
        return np.asarray(np.einsum("mqkd,mk->mqd", self.gradients, coefficients[self.numbers]))

    def columns(self, gradients: bool = True) -> Array:
        """Weights (m, q, k, 4) of the value and the gradient, or (m, q, k, 1) of the value, for the core."""
        value = self.N[..., None]
        return np.concatenate([value, self.gradients], axis=3) if gradients else value

    def smooth_columns(self) -> Array:
        """Weights (m, q, k, 5) of the value, the gradient and the Laplacian."""
        assert self.laplacians is not None
        return np.concatenate([self.N[..., None], self.gradients, self.laplacians[..., None]], axis=3)


class ScalarSpace(Protocol):
    """Interface of the space of scalar fields.

    Attributes
    ----------
    grid : Mesh
        Of what is drawn, and whose sets name faces and nodes.
    size : int
        Number of coefficients.
    spacing : float
        Largest distance of neighbouring coefficients.
    spacings : array
        The same along each axis.
    """

    grid: Mesh
    size: int

    @property
    def spacing(self) -> float: ...

    @property
    def spacings(self) -> Array: ...

    def cells(self) -> Sequence[Table]:
        """Tables of the elements, kind by kind."""
        ...

    def walls(self, faces: Faces) -> Iterator[Table]:
        """Tables of faces, kind by kind."""
        ...

    def at_nodes(self, coefficients: Array) -> Array:
        """Values (n_nodes,) of a field at the nodes of the grid."""
        ...

    def torn(self, what: str, values: Array) -> list[str]:
        """Remark on values (n_nodes,) that differ between nodes which are one."""
        ...

    def fitted(self, values: Array) -> Array:
        """Coefficients (size,) of a field that is given at the nodes of the grid."""
        ...

    def held(self, nodes: Ints) -> Ints:
        """Coefficients (k,) that values at nodes of the grid, such as those of a face, are given by."""
        ...

    def fitted_on(self, nodes: Ints, values: Array) -> Array:
        """Coefficients (k,) from values at these nodes."""
        ...


class MeshSpace:
    """Continuous finite elements on any mesh: in space, in a plane, or on a surface or line in space.

    Parameters
    ----------
    grid : Mesh
    periodic : sequence of (str, str)
        Sets of faces that are taken for the same.
    thickness, axisymmetric
        Of a plane mesh.
    label : str
        Whose space it is, for messages.
    at_corners : bool
        Whether cells without other nodes have their corners for quadrature points.

    Examples
    --------
    >>> from visviva import RectangleMesh
    >>> mesh = RectangleMesh(size=(1, 1), counts=(4, 4)).build()
    >>> MeshSpace(mesh, [("x0", "x1"), ("y0", "y1")]).size
    16
    """

    def __init__(
        self,
        grid: Mesh,
        periodic: Sequence[tuple[str, str]] = (),
        thickness: float = 1.0,
        axisymmetric: bool = False,
        label: str = "space",
        at_corners: bool = False,
    ) -> None:
        self.grid, self.thickness, self.axisymmetric = grid, thickness, axisymmetric
        self.at_corners = at_corners
        self.is_lumped = at_corners and not any(CELLS[cell].middles for cell in grid.cells)
        self._refuse_flat()
        self.number, self.size = numbering(grid, periodic, label)
        self._first = np.unique(self.number, return_index=True)[1]

    def _refuse_flat(self) -> None:
        """Refuse corners that are points of quadrature and nearly straight: gradients there are without bound."""
        for cell, nodes in self.grid.cells.items() if self.at_corners else ():
            kind = CELLS[cell]
            if not kind.middles and len(nodes):
                size = measure(jacobians(self.grid.points, nodes, kind.dN(corner_rule(cell).points)))
                worst, corner = np.unravel_index(np.argmin(size / size.mean(axis=1)[:, None]), size.shape)
                if size[worst, corner] < FLAT * size[worst].mean():
                    raise InputError(
                        f"the mesh has a {cell} whose corner at "
                        f"{self.grid.points[nodes[worst, corner]].round(6).tolist()} is nearly straight, and energies "
                        "with logarithms are summed at corners; move its nodes, or cut it into triangles or tetrahedra"
                    )

    @property
    def spacing(self) -> float:
        """Largest distance of neighbouring nodes: edges of cells by their order.

        Of triangles the longest edge is left out and of tetrahedra the two longest, which are diagonals of grids that
        are cut into such cells: a front across a diagonal meets nodes that are nearer, not farther apart.
        """
        longest = 0.0
        for cell, nodes in self.grid.cells.items():
            kind = CELLS[cell]
            X = self.grid.points[nodes[:, : kind.n_corners]]
            edges = [np.linalg.norm(X[:, a] - X[:, b], axis=1) for a, b in kind.family.edges]
            diagonals = kind.dimension - 1 if kind.n_corners == kind.dimension + 1 else 0
            counted = np.sort(edges, axis=0)[-1 - diagonals]
            longest = max(longest, float(counted.max()) / (1 if kind.n_nodes == kind.n_corners else 2))
        return longest

    @property
    def spacings(self) -> Array:
        found = np.zeros(self.grid.points.shape[1])
        for cell, nodes in self.grid.cells.items():
            kind = CELLS[cell]
            wide = np.ptp(self.grid.points[nodes[:, : kind.n_corners]], axis=1).max(axis=0)
            found = np.maximum(found, wide / (1 if kind.n_nodes == kind.n_corners else 2))
        return found

    def cells(self) -> Sequence[Table]:
        return self._cells

    @cached_property
    def _cells(self) -> list[Table]:
        return [self._table(cell, nodes) for cell, nodes in self.grid.cells.items()]

    def _table(self, cell: str, nodes: Ints) -> Table:
        points, kind = self.grid.points, CELLS[cell]
        xi, w = corner_rule(cell) if self.at_corners and not kind.middles else mass_rule(cell)
        N, dN = kind.N(xi), kind.dN(xi)
        J = jacobians(points, nodes, dN)
        inverse = np.linalg.inv(J) if J.shape[2] == J.shape[3] else np.linalg.pinv(J)
        gradients = np.zeros((*J.shape[:2], kind.n_nodes, 3))
        gradients[..., : J.shape[2]] = dN @ inverse
        size = w * measure(J)
        if points.shape[1] == 2:
            size = size * depth(points, nodes, N, self.thickness, self.axisymmetric)
        X = np.einsum("mkc,qk->mqc", in_space(self.grid)[nodes], N)
        return Table(
            numbers=self.number[nodes],
            N=np.broadcast_to(N, (len(nodes), *N.shape)),
            gradients=gradients,
            size=size,
            X=X,
        )

    def walls(self, faces: Faces) -> Iterator[Table]:
        for p in face_points(self.grid, faces, thickness=self.thickness, axisymmetric=self.axisymmetric):
            N = np.broadcast_to(p.N, (len(p.nodes), *p.N.shape))
            yield Table(
                numbers=self.number[p.nodes], N=N, gradients=np.zeros((*N.shape, 3)), size=p.size, X=p.X
            )

    def at_nodes(self, coefficients: Array) -> Array:
        return np.asarray(coefficients[self.number])

    def fitted(self, values: Array) -> Array:
        return np.asarray(values[self._first])

    def torn(self, what: str, values: Array) -> list[str]:
        apart = float(np.abs(values - self.at_nodes(self.fitted(values))).max())
        if apart <= 1e-9 * np.abs(values).max():
            return []
        return [
            f"{what} differs by up to {apart:.3g} between nodes of periodic faces that are one, which have that of the "
            "first of them: give both the same"
        ]

    def held(self, nodes: Ints) -> Ints:
        return np.unique(self.number[nodes])

    def fitted_on(self, nodes: Ints, values: Array) -> Array:
        return np.asarray(values[np.unique(self.number[nodes], return_index=True)[1]])
