"""Mortar integrals between two surfaces of solids in the reference configuration, for tying."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.body.touching import Skin
from visviva.contact.contact_surface import SUBFACETS, Faced, of_points, skin
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

CHUNK = 400
"""So many pairs of facets are integrated at once."""

TO_CORNERS = 0.2
"""Share of the functions in the middles of edges that corners take over, where these have none otherwise."""


@cache
def triangle_rule(n: int = 5) -> Array:
    """Gauss points on the unit triangle by collapsing a square: coordinates, and weights that add up to one."""
    x, w = np.polynomial.legendre.leggauss(n)
    s, w = 0.5 * (1 + x), 0.5 * w
    a, b = s[:, None], s[None, :] * (1 - s[:, None])
    weight = 2 * w[:, None] * w[None, :] * (1 - a)
    return np.column_stack([(a + 0 * b).ravel(), b.ravel(), weight.ravel()])


@cache
def exchange(kind: str) -> Array:
    """Functions (k, k) of shape functions of a face whose integrals are positive, which dual ones need.

    Those of the corners of tri6 and quad8 integrate to zero or less; they get a share of the functions beside
    them (Popp, Wohlmuth, Gee & Wall 2012).
    """
    face = CELLS[kind]
    T = np.eye(face.n_nodes)
    if kind in ("tri6", "quad8"):
        for k, corners in enumerate(face.middles):
            middle = face.n_corners + k
            T[list(corners), middle] += TO_CORNERS
            T[middle, middle] -= TO_CORNERS * len(corners)
    return T


def numbered(faces: Faces) -> list[list[tuple[int, float]]]:
    """Vertices as forms of themselves: systems number their unknowns later."""
    return [[(k, 1.0)] for k in range(len(faces.nodes))]


@dataclass(frozen=True)
class Parents:
    """The faces that the facets of a surface are parts of.

    Attributes
    ----------
    face : array of int, (n_facets,)
        Number of the face.
    nodes : array of int, (n_faces, 9)
        Its vertices, -1 behind the last.
    corners : array, (n_facets, 4, 2)
        Coordinates in the face of the corners of the facets.
    kinds : list of str
        Types of the faces, and in `kind` (n_facets,) which of them.
    """

    face: Ints
    nodes: Ints
    corners: Array
    kinds: list[str]
    kind: Ints

    @classmethod
    def of(cls, faces: Faces) -> Parents:
        """In the order in which `of_points` cuts faces into facets."""
        number, first = faces.nodes, 0
        face, nodes, corners, kind = [], [], [], []
        for which, (name, cells) in enumerate(faces.cells.items()):
            padded = np.full((len(cells), 9), -1)
            padded[:, : cells.shape[1]] = np.searchsorted(number, cells)
            nodes.append(padded)
            for part in SUBFACETS[name]:
                xi = np.zeros((4, 2))
                xi[: len(part), : CELLS[name].dimension] = CELLS[name].nodes[list(part)]
                face.append(first + np.arange(len(cells)))
                corners.append(np.tile(xi, (len(cells), 1, 1)))
                kind.append(np.full(len(cells), which))
            first += len(cells)
        return cls(
            np.concatenate(face),
            np.concatenate(nodes),
            np.concatenate(corners),
            list(faces.cells),
            np.concatenate(kind),
        )

    def shapes(self, facet: Ints, N: Array) -> Array:
        """Shape functions (q, 9) of the faces at points given by those of the facets (q, 4)."""
        values = np.zeros((len(facet), 9))
        xi = np.einsum("qa,qad->qd", N, self.corners[facet])
        for k, name in enumerate(self.kinds):
            at = np.flatnonzero(self.kind[facet] == k)
            cell = CELLS[name]
            values[at, : cell.n_nodes] = cell.N(xi[at, : cell.dimension])
        return values


@dataclass(frozen=True)
class Integrals:
    """Integrals over the segments of pairs of facets, added up for pairs of faces.

    Attributes
    ----------
    faces : array of int, (n, 2)
    own, other : array, (n, 9, 9)
        Of products of the first face's functions with each other and with the second's.
    covered : array, (n_vertices,)
        Area at each vertex of the first surface that faces the second.
    """

    faces: Ints
    own: Array
    other: Array
    covered: Array


class MortarSurfaces:
    """Two surfaces and what is integrated over both; facets farther apart than `reach` do not see each other."""

    def __init__(
        self, first: tuple[Faced, Skin], second: tuple[Faced, Skin], reach: float | None = None
    ) -> None:
        self.first, self.second = (of_points(*side, numbered(side[1].faces)) for side in (first, second))
        self.parents = Parents.of(first[1].faces), Parents.of(second[1].faces)
        self.reach = reach or 0.1 * max(self.first.size, self.second.size)
        self._axisymmetric = first[0].axisymmetric
        self._skin = skin(self.first, self.second, sees=False)
        self._places = np.vstack([self.first.places, self.second.places])

    @cached_property
    def integrals(self) -> Integrals:
        """All there are."""
        faces, own, other = [], [], []
        covered = np.zeros(len(self.first.forms))
        for pairs, pair, weight, N1, N2 in self._points(self._near(2 * self.reach)):
            first, second = pairs[pair, 0], pairs[pair, 1] - len(self.first.facets)
            shapes = self.parents[0].shapes(first, N1), self.parents[1].shapes(second, N2)
            start = np.flatnonzero(np.diff(pair, prepend=-1))
            weighted = weight[:, None] * shapes[0]
            own.append(np.add.reduceat(weighted[:, :, None] * shapes[0][:, None, :], start))
            other.append(np.add.reduceat(weighted[:, :, None] * shapes[1][:, None, :], start))
            seen = self.parents[0].face[first[start]], self.parents[1].face[second[start]]
            faces.append(np.column_stack(seen))
            corner = self.first.facets[first]
            np.add.at(covered, corner[corner >= 0], (weight[:, None] * N1)[corner >= 0])
        if not faces:
            return Integrals(np.zeros((0, 2), int), np.zeros((0, 9, 9)), np.zeros((0, 9, 9)), covered)
        return Integrals(np.concatenate(faces), np.concatenate(own), np.concatenate(other), covered)

    @property
    def share(self) -> Array:
        """Part (n_vertices,) of the area of each vertex of the first surface that faces the second; of edges of shells,
        which have no area, 1 or 0.
        """
        found, areas = self.integrals.covered, np.asarray(self.first.areas)
        return np.asarray(np.divide(found, areas, out=np.asarray(found > 0, dtype=float), where=areas > 0))

    def shared_points(self) -> Iterator[tuple[tuple[Ints, Ints], tuple[Array, Array], Array]]:
        """Points that both surfaces share, by pairs of faces of each pair of types.

        Vertices (m, k1) and (m, k2) of the faces, shape functions (m, q, k1) and (m, q, k2) there, and areas (m, q).
        Pairs with fewer points have their first one again, with no area: laws that divide by a temperature find one.
        """
        faces, size, first, second = self._by_point()
        pairs, number = np.unique(faces, axis=0, return_inverse=True)
        order = np.argsort(number, kind="stable")
        number = number[order]
        place = np.arange(len(number)) - np.searchsorted(number, number)
        kinds = [np.zeros(len(p.nodes), dtype=int) for p in self.parents]
        for kind, parent in zip(kinds, self.parents, strict=True):
            kind[parent.face] = parent.kind
        types = np.stack([kind[pairs[:, s]] for s, kind in enumerate(kinds)], axis=1)
        for a, b in np.unique(types, axis=0):
            mine = np.flatnonzero((types == (a, b)).all(axis=1))
            row = np.full(len(pairs), -1)
            row[mine] = np.arange(len(mine))
            here = row[number] >= 0
            at, q = row[number[here]], place[here]
            k = [CELLS[p.kinds[t]].n_nodes for p, t in zip(self.parents, (a, b), strict=True)]
            area = np.zeros((len(mine), int(q.max()) + 1))
            begin = order[np.searchsorted(number, mine)]
            N = [
                np.repeat(of[begin][:, None, :n], area.shape[1], axis=1)
                for of, n in zip((first, second), k, strict=True)
            ]
            area[at, q] = size[order][here]
            for shape, values, n in zip(N, (first, second), k, strict=True):
                shape[at, q] = values[order][here][:, :n]
            nodes = [
                p.nodes[pairs[mine, s]][:, :n] for s, (p, n) in enumerate(zip(self.parents, k, strict=True))
            ]
            yield (nodes[0], nodes[1]), (N[0], N[1]), area

    def _by_point(self) -> tuple[Ints, Array, Array, Array]:
        """Faces (n, 2) of all points, their areas, and the shape functions (n, 9) of both faces."""
        faces, size, shapes = [np.zeros((0, 2), int)], [np.zeros(0)], [np.zeros((2, 0, 9))]
        for pairs, pair, weight, N1, N2 in self._points(self._near(2 * self.reach)):
            first, second = pairs[pair, 0], pairs[pair, 1] - len(self.first.facets)
            shapes.append(np.stack([self.parents[0].shapes(first, N1), self.parents[1].shapes(second, N2)]))
            faces.append(np.column_stack([self.parents[0].face[first], self.parents[1].face[second]]))
            size.append(weight)
        both = np.concatenate(shapes, axis=1)
        return np.concatenate(faces), np.concatenate(size), both[0], both[1]

    def distance(self) -> float:
        """Smallest distance between vertices of the surfaces."""
        from scipy.spatial import KDTree

        return float(KDTree(self.second.places).query(self.first.places)[0].min())

    def _near(self, margin: float) -> NDArray[np.int32]:
        found = _core.near_facets(self._skin, self._places.ravel(), margin)
        return np.ascontiguousarray(found.reshape(-1, 2), dtype=np.int32)

    def _points(self, pairs: NDArray[np.int32]) -> Iterator[tuple[Ints, Ints, Array, Array, Array]]:
        """Pairs, and per quadrature point the number of its pair, the weight, both facets' shape functions."""
        for begin in range(0, len(pairs), CHUNK):
            some = np.ascontiguousarray(pairs[begin : begin + CHUNK])
            pair, values = _core.segment_points(self._skin, self._places.ravel(), some, triangle_rule())
            pair, values = pair.astype(np.int64), values.reshape(-1, 9)
            N1, N2 = values[:, 1:5], values[:, 5:]
            corners = np.vstack([self.first.facets, self._second_facets])[some[pair]]
            x = self._places[np.where(corners >= 0, corners, 0)]
            x1, x2 = np.einsum("qa,qai->qi", N1, x[:, 0]), np.einsum("qa,qai->qi", N2, x[:, 1])
            apart = np.full(len(some), np.inf)
            np.minimum.at(apart, pair, np.linalg.norm(x2 - x1, axis=1))
            near = apart[pair] <= self.reach
            weight = values[:, 0] * (2 * np.pi * x1[:, 0] if self._axisymmetric else 1.0)
            if near.any():
                yield some.astype(np.int64), pair[near], weight[near], N1[near], N2[near]

    @cached_property
    def _second_facets(self) -> Ints:
        facets = self.second.facets
        return np.where(facets >= 0, facets + len(self.first.forms), -1)

    # --- rows of constraints --------------------------------------------------------------------------------
    def standard(self) -> sp.csr_array:
        """Rows (n1, n1 + n2) of ``sum n_AB x_B - sum n_AC x_C`` with the shape functions as multipliers."""
        i = self.integrals
        eye = np.broadcast_to(np.eye(9), i.own.shape)
        return self._assembled(eye, i.own, i.other)

    def dual(self) -> sp.csr_array:
        """The same with dual multipliers: diagonal in the first surface, except at middles beside corners."""
        i = self.integrals
        total = np.zeros((len(self.parents[0].nodes), 9, 9))
        np.add.at(total, i.faces[:, 0], i.own)
        A, own = np.zeros_like(total), np.zeros_like(total)
        kind = np.zeros(len(total), dtype=int)
        kind[self.parents[0].face] = self.parents[0].kind
        seen = np.flatnonzero(total.any(axis=(1, 2)))
        for which, name in enumerate(self.parents[0].kinds):
            at, T = seen[kind[seen] == which], exchange(name)
            k = np.arange(len(T))
            mass = T @ total[np.ix_(at, k, k)] @ T.T
            D = mass.sum(axis=2)[:, :, None]
            A[np.ix_(at, k, k)] = D * np.linalg.inv(mass) @ T
            own[np.ix_(at, k, k)] = D * np.linalg.inv(T).T
        pair_own = np.zeros_like(i.own)
        _, once = np.unique(i.faces[:, 0], return_index=True)
        pair_own[once] = own[i.faces[once, 0]]
        return self._assembled(A[i.faces[:, 0]], pair_own, i.other, own_is_done=True)

    def _assembled(self, A: Array, own: Array, other: Array, own_is_done: bool = False) -> sp.csr_array:
        import scipy.sparse as sp

        i, (first, second) = self.integrals, self.parents
        a, b = first.nodes[i.faces[:, 0]], second.nodes[i.faces[:, 1]]
        n1, n2 = len(self.first.forms), len(self.second.forms)
        blocks = []
        for values, columns, shift in ((own if own_is_done else A @ own, a, 0), (-(A @ other), b, n1)):
            kept = (a[:, :, None] >= 0) & (columns[:, None, :] >= 0) & (values != 0.0)
            row = np.broadcast_to(a[:, :, None], kept.shape)[kept]
            column = np.broadcast_to(columns[:, None, :], kept.shape)[kept] + shift
            blocks.append(sp.coo_array((values[kept], (row, column)), shape=(n1, n1 + n2)))
        return (blocks[0] + blocks[1]).tocsr()
