"""Cell types: reference geometry, shape functions and faces.

Nodes are ordered as in VTK, faces as Abaqus numbers them (S1, S2, ...). Lines, quadrilaterals and hexahedra
have the reference coordinates -1 to 1, triangles and tetrahedra the unit simplex, wedges a triangle
times -1 to 1. A type is corners, further nodes that lie in the middle of groups of corners, and the monomials
that span its shape functions: one line in `TYPES`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError, nearest

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Groups = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Family:
    """Corners of a reference shape (n, dim), and its edges and faces by corners, faces seen from outside."""

    corners: tuple[tuple[float, ...], ...]
    edges: Groups
    faces: Groups = ()


@dataclass(frozen=True)
class Face:
    """A face of a cell type: its own type and the local nodes (k,) of the cell, outward oriented."""

    type: str
    nodes: Ints


@dataclass(frozen=True, eq=False)
class Cell:
    """A cell type.

    Parameters
    ----------
    name : str
    family : Family
        Its corners, edges and faces.
    middles : tuple of corner groups
        Every node after the corners lies in the middle of such a group, where a corner may count more than once.
    powers : sequence of exponents, (n_nodes, dimension)
        Monomials that span the shape functions.
    vtk : int
        Cell type number of VTK.
    meshio : str
        Name in meshio.
    face_types : tuple of str
        Types of the faces; they are told apart by their number of corners.

    Examples
    --------
    >>> quad = CELLS["quad8"]
    >>> quad.n_nodes, quad.n_corners, quad.dimension, quad.faces[0].type, quad.faces[0].nodes.tolist()
    (8, 4, 2, 'line3', [0, 1, 4])
    >>> quad.N([[0.0, 0.0]]).tolist()
    [[-0.25, -0.25, -0.25, -0.25, 0.5, 0.5, 0.5, 0.5]]
    """

    name: str
    family: Family
    middles: Groups
    powers: Sequence[tuple[int, ...]]
    vtk: int
    meshio: str
    face_types: tuple[str, ...] = ()

    @property
    def dimension(self) -> int:
        """Of the reference shape: 1, 2 or 3."""
        return len(self.family.corners[0])

    @property
    def n_corners(self) -> int:
        """Number of corners; they are the first nodes."""
        return len(self.family.corners)

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return self.n_corners + len(self.middles)

    @cached_property
    def nodes(self) -> Array:
        """Reference coordinates of the nodes (n_nodes, dimension)."""
        corners = np.array(self.family.corners, dtype=float)
        return np.array([*corners, *(corners[list(group)].mean(axis=0) for group in self.middles)])

    @cached_property
    def centre(self) -> Array:
        """Reference coordinates of the centre (dimension,)."""
        return np.asarray(self.nodes[: self.n_corners].mean(axis=0))

    @cached_property
    def coefficients(self) -> Array:
        """Coefficients of the monomials (n_monomials, n_nodes) in the shape functions: multiples of 1/16."""
        values = np.prod(self.nodes[:, None, :] ** np.array(self.powers), axis=2)
        return np.asarray(np.round(16 * np.linalg.inv(values)) / 16)

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """Faces (edges of plane cells), outward oriented."""
        return tuple(self._face(corners) for corners in self.family.faces)

    def _face(self, corners: tuple[int, ...]) -> Face:
        (kind,) = (CELLS[name] for name in self.face_types if CELLS[name].n_corners == len(corners))
        groups = [frozenset(group) for group in self.middles]
        wanted = [frozenset(corners[k] for k in group) for group in kind.middles]
        nodes = [*corners, *(self.n_corners + groups.index(group) for group in wanted)]
        return Face(kind.name, np.array(nodes, dtype=np.int64))

    def N(self, xi: ArrayLike) -> Array:
        """Shape functions (q, n_nodes) at reference points `xi` (q, dimension)."""
        return np.asarray(self._products(xi, self._factors[0]) @ self.coefficients)

    def dN(self, xi: ArrayLike) -> Array:
        """Derivatives (q, n_nodes, dimension) of the shape functions at points `xi` (q, dimension)."""
        return self.N_dN(xi)[1]

    def N_dN(self, xi: ArrayLike) -> tuple[Array, Array]:
        """Shape functions and their derivatives at points, as `N` and `dN` give them."""
        values = self._products(xi, self._factors) @ self.coefficients
        return values[:, 0], values[:, 1:].transpose(0, 2, 1).copy()

    @cached_property
    def _n_powers(self) -> int:
        """Powers of a coordinate in the monomials, the zeroth included."""
        return 1 + max(map(max, self.powers))

    @cached_property
    def _factors(self) -> Ints:
        """Places (1 + dimension, n_monomials, dimension) of the factors of monomials and their derivatives.

        They are those in a row of the table that `_products` makes: for every coordinate its powers, then their
        derivatives.
        """
        powers, d, n = np.array(self.powers), self.dimension, self._n_powers
        derived = n * np.eye(d, dtype=np.int64)[:, None, :]
        return np.asarray(
            powers + 2 * n * np.arange(d) + np.concatenate([np.zeros((1, 1, d), np.int64), derived])
        )

    def _products(self, xi: ArrayLike, factors: Ints) -> Array:
        """Products (q, ...) of the factors (..., dimension) at points `xi` (q, dimension)."""
        x = np.asarray(xi, dtype=float)
        n = self._n_powers
        table = np.zeros((*x.shape, 2, n))
        table[:, :, 0, 0], table[:, :, 0, 1], table[:, :, 1, 1] = 1.0, x, 1.0
        for p in range(2, n):
            table[:, :, 0, p] = table[:, :, 0, p - 1] * x
            table[:, :, 1, p] = p * table[:, :, 0, p - 1]
        found = table.reshape(len(x), 2 * n * self.dimension)[:, factors]
        return np.asarray(reduce(np.multiply, (found[..., k] for k in range(self.dimension))))


LINE = Family(((-1,), (1,)), ((0, 1),))
TRIANGLE = Family(((0, 0), (1, 0), (0, 1)), ((0, 1), (1, 2), (2, 0)), ((0, 1), (1, 2), (2, 0)))
QUADRILATERAL = Family(
    ((-1, -1), (1, -1), (1, 1), (-1, 1)),
    ((0, 1), (1, 2), (2, 3), (3, 0)),
    ((0, 1), (1, 2), (2, 3), (3, 0)),
)
TETRAHEDRON = Family(
    ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
)
HEXAHEDRON = Family(
    ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)),
    ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
)
WEDGE = Family(
    ((0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)),
    ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
)

# The middles of faces and cell, in the order of VTK: -x, +x, -y, +y, -z, +z, inside.
INSIDE = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 1, 2, 3), (4, 5, 6, 7), tuple(range(8)))


def tensor(degree: int, dimension: int) -> list[tuple[int, ...]]:
    """Exponents of all monomials up to a degree in every coordinate."""
    return list(product(range(degree + 1), repeat=dimension))


def simplex(degree: int, dimension: int) -> list[tuple[int, ...]]:
    """Exponents of all monomials up to a total degree."""
    return [p for p in tensor(degree, dimension) if sum(p) <= degree]


def serendipity(dimension: int) -> list[tuple[int, ...]]:
    """Exponents of the quadratic serendipity elements: at most one coordinate squared."""
    return [p for p in tensor(2, dimension) if p.count(2) <= 1]


def prism(degree: int) -> list[tuple[int, ...]]:
    """Exponents of a triangle times a line."""
    return [(*p, k) for k in range(degree + 1) for p in simplex(degree, 2)]


TYPES = (
    Cell("line2", LINE, (), tensor(1, 1), 3, "line"),
    Cell("line3", LINE, LINE.edges, tensor(2, 1), 21, "line3"),
    Cell("line4", LINE, ((0, 0, 1), (0, 1, 1)), tensor(3, 1), 35, "line4"),
    Cell("tri3", TRIANGLE, (), simplex(1, 2), 5, "triangle", ("line2",)),
    Cell("tri6", TRIANGLE, TRIANGLE.edges, simplex(2, 2), 22, "triangle6", ("line3",)),
    Cell("quad4", QUADRILATERAL, (), tensor(1, 2), 9, "quad", ("line2",)),
    Cell("quad8", QUADRILATERAL, QUADRILATERAL.edges, serendipity(2), 23, "quad8", ("line3",)),
    Cell("quad9", QUADRILATERAL, (*QUADRILATERAL.edges, (0, 1, 2, 3)), tensor(2, 2), 28, "quad9", ("line3",)),
    Cell("tet4", TETRAHEDRON, (), simplex(1, 3), 10, "tetra", ("tri3",)),
    Cell("tet10", TETRAHEDRON, TETRAHEDRON.edges, simplex(2, 3), 24, "tetra10", ("tri6",)),
    Cell("hex8", HEXAHEDRON, (), tensor(1, 3), 12, "hexahedron", ("quad4",)),
    Cell("hex20", HEXAHEDRON, HEXAHEDRON.edges, serendipity(3), 25, "hexahedron20", ("quad8",)),
    Cell("hex27", HEXAHEDRON, HEXAHEDRON.edges + INSIDE, tensor(2, 3), 29, "hexahedron27", ("quad9",)),
    Cell("wedge6", WEDGE, (), prism(1), 13, "wedge", ("tri3", "quad4")),
)
CELLS = {cell.name: cell for cell in TYPES}
"""All cell types by name."""


def cell_type(name: str) -> Cell:
    """The cell type of a name.

    Raises
    ------
    InputError
        With the nearest valid name.

    Examples
    --------
    >>> cell_type("hex20").n_nodes
    20
    """
    if name not in CELLS:
        raise InputError(f"there is no cell type {name!r}{nearest(name, CELLS)}")
    return CELLS[name]
