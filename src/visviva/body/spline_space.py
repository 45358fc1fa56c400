"""Spaces of splines for scalar fields, as tables of shape functions element by element."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.space import Table
from visviva.body.spline_quadrature import gauss_points, points_needed
from visviva.mesh import convert
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces, corner_rows
from visviva.mesh.geometry import determinant
from visviva.mesh.grid import SIDES
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import Rule, gauss
from visviva.mesh.spline import SplinePatch, SplineSource
from visviva.mesh.spline_joined import CLOSE, joined

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Sides:
    """Quadrature points of faces on the sides of patches.

    Attributes
    ----------
    numbers : array of int (m, k)
        Coefficients of the functions at each of m faces.
    N : array (m, q, k)
    slopes : array (m, q, k, d - 1)
        Derivatives of the functions by the coordinates of the face.
    X, normal : array (m, q, 3)
        Places, and outward unit normals.
    size : array (m, q)
        Area; in the plane with the thickness.
    weights : array (q,)
        Of the quadrature.
    drawn : array of int (m, a)
        Nodes of the faces in the mesh that is drawn.
    shapes : array (q, a)
        Shape functions there.
    """

    numbers: Ints
    N: Array
    slopes: Array
    X: Array
    normal: Array
    size: Array
    weights: Array
    drawn: Ints
    shapes: Array


class SplineSpace:
    """Splines on one patch or several; what is drawn is a fine mesh of plain cells.

    Parameters
    ----------
    source : SplineSource
    periodic : sequence of (str, str)
        Opposite sides that are taken for the same, smoothly.
    thickness : float
        Of a plane patch.
    level_at_sides : bool
        Whether the fields have no slope across sides of a `SplineBox` that are not periodic.
    are_one : bool
        Whether periodic sides share coefficients; else those that reach across a side stand on both, to be joined.

    Examples
    --------
    >>> from visviva.mesh.spline import SplineBox
    >>> space = SplineSpace(SplineBox(size=(1, 1), counts=(8, 8), degree=2), [("x0", "x1"), ("y0", "y1")])
    >>> space.size, len(space.cells()[0].numbers)
    (64, 64)
    """

    def __init__(
        self,
        source: SplineSource,
        periodic: Sequence[tuple[str, str]] = (),
        thickness: float = 1.0,
        level_at_sides: bool = False,
        are_one: bool = True,
    ) -> None:
        directions = [direction_of(pair) for pair in periodic]
        self.patches, self.thickness = source.parts(directions), thickness
        if source.numbers is None:
            alone = [numbering(self.patches[0], directions if are_one else (), level_at_sides)]
            self.numbers = joined(self.patches, alone)
            self.is_welded = int(self.numbers[0].max()) < int(alone[0].max())
        else:
            self.numbers = source.numbers
            self.is_welded = True
        self.size = 1 + max(int(number.max()) for number in self.numbers)
        self._samples_of_span = max(2, *(max(p.degrees) for p in self.patches))
        self.grid, self._xi, self._nodes = sampled(self.patches, self._samples_of_span, self.is_welded)
        if self.is_welded:
            self._refuse_touching()

    def _refuse_touching(self) -> None:
        """Refuse nodes in one place that move apart."""
        rows, nodes = self._rows, np.concatenate(self._nodes)
        apart = abs(rows - self.samples[nodes]).max(axis=1).toarray().ravel()
        if apart.max() > 1e-9:
            place = self.grid.points[nodes[int(np.argmax(apart))]].round(6).tolist()
            raise InputError(
                f"patches of splines touch at {place} and are not joined there; cut patches where corners of others lie"
            )

    @property
    def smoothness(self) -> int:
        """So many derivatives are continuous."""
        return 0 if self.is_welded else self.patches[0].smoothness

    @property
    def spacing(self) -> float:
        """Longest knot span."""
        return float(self.spacings.max())

    @property
    def spacings(self) -> Array:
        cells = next(iter(self.grid.cells.values()))
        return np.asarray(self._samples_of_span * np.ptp(self.grid.points[cells], axis=1).max(axis=0))

    def cells(self) -> Sequence[Table]:
        return self._cells

    @cached_property
    def _cells(self) -> list[Table]:
        return [self._table(*each) for each in zip(self.patches, self.numbers, self._points, strict=True)]

    @cached_property
    def _points(self) -> list[list[int]]:
        """Points of quadrature by direction in each knot span, patch by patch."""
        return [points_needed(patch) for patch in self.patches]

    def _table(self, patch: SplinePatch, number: Ints, counts: Sequence[int]) -> Table:
        xi, w = gauss_points(patch, counts)
        q = w.shape[1]
        numbers, N, dN, H = patch.functions(xi)
        P = patch.control.reshape(-1, patch.dimension)[numbers]
        X = np.einsum("nk,nkc->nc", N, P)
        J = np.einsum("nka,nkc->nca", dN, P)
        if not determinant(J).min() > 0:
            worst = X[int(np.argmin(determinant(J)))]
            raise InputError(
                f"a patch of splines is folded at {worst.round(4).tolist()}: its Jacobian is not positive"
            )
        inverse = np.linalg.inv(J)
        gradients = dN @ inverse
        bend = H - np.einsum("nkc,ncab->nkab", gradients, np.einsum("nkab,nkc->ncab", H, P))
        laplacians = np.einsum("nac,nkab,nbc->nk", inverse, bend, inverse)
        d = patch.dimension

        def by_cell(a: Array) -> Array:
            return np.ascontiguousarray(a.reshape(-1, q, *a.shape[1:]))

        return Table(
            numbers=number[numbers.reshape(-1, q, numbers.shape[1])[:, 0]],
            N=by_cell(N),
            gradients=by_cell(np.pad(gradients, ((0, 0), (0, 0), (0, 3 - d)))),
            size=by_cell(determinant(J)) * w * (self.thickness if d == 2 else 1.0),
            X=by_cell(np.pad(X, ((0, 0), (0, 3 - d)))),
            laplacians=by_cell(laplacians),
        )

    def walls(self, faces: Faces) -> Iterator[Table]:
        """Tables of faces of the mesh that is drawn, on the sides of the patches."""
        for side in self.sides(faces):
            flat = np.zeros((*side.N.shape, 3))
            yield Table(numbers=side.numbers, N=side.N, gradients=flat, size=side.size, X=side.X)

    def sides(self, faces: Faces) -> Iterator[Sides]:
        """Quadrature points of faces of the mesh that is drawn, on the sides of the patches, patch by patch."""
        ends = np.cumsum([0, *(self._samples_of_span**p.dimension * np.prod(p.counts) for p in self.patches)])
        for k, patch in enumerate(self.patches):
            local = np.zeros(self.grid.n_nodes, dtype=np.int64)
            local[self._nodes[k]] = np.arange(len(self._nodes[k]))
            for kind, nodes in faces.cells.items():
                own = nodes[(faces.owners[kind] >= ends[k]) & (faces.owners[kind] < ends[k + 1])]
                if len(own):
                    rule = gauss(max(self._points[k]), patch.dimension - 1)
                    yield self._sides(patch, self.numbers[k], kind, self._xi[k][local[own]], rule, own)

    def _sides(
        self, patch: SplinePatch, number: Ints, kind: str, corners: Array, rule: Rule, drawn: Ints
    ) -> Sides:
        """Points of faces with the parameters (m, a, d) of their nodes."""
        d, (eta, w) = patch.dimension, rule
        shapes = CELLS[kind].N(eta)
        xi = np.einsum("mac,qa->mqc", corners, shapes)
        along = np.einsum("mac,qat->mqct", corners, CELLS[kind].dN(eta))
        # all points of a face see the functions of its first point, whose span is that of the face's middle
        numbers, N, dN, _ = patch.functions(xi.reshape(-1, d))
        shape = (*xi.shape[:2], N.shape[1])
        slopes = np.einsum("mqkc,mqct->mqkt", dN.reshape(*shape, d), along)
        P = patch.control.reshape(-1, d)[numbers].reshape(*shape, d)
        X = in_three(np.einsum("mqk,mqkc->mqc", N.reshape(shape), P))
        tangents = in_three(np.einsum("mqkt,mqkc->mqtc", slopes, P))
        across = np.array([0.0, 0.0, 1.0]) if d == 2 else tangents[:, :, 1]
        outward = np.cross(tangents[:, :, 0], across)
        size = np.linalg.norm(outward, axis=2)
        return Sides(
            numbers=number[numbers.reshape(shape)[:, 0]],
            N=N.reshape(shape),
            slopes=slopes,
            X=X,
            size=size * w * (self.thickness if d == 2 else 1.0),
            normal=outward / size[..., None],
            weights=w,
            drawn=drawn,
            shapes=shapes,
        )

    @cached_property
    def control(self) -> Array:
        """Control points (size, d)."""
        found = np.empty((self.size, self.patches[0].dimension))
        for patch, number in zip(self.patches, self.numbers, strict=True):
            found[number] = patch.control.reshape(-1, patch.dimension)
        return found

    @cached_property
    def anchors(self) -> Ints:
        """Node (size,) of the grid where each function is largest: of those of a side, one of the side."""
        return np.asarray(self.samples.tocsc().argmax(axis=0)).ravel()

    @cached_property
    def samples(self) -> Any:
        """From coefficients to the nodes of the grid, as a sparse matrix."""
        _, first = np.unique(np.concatenate(self._nodes), return_index=True)
        return self._rows[first]

    @cached_property
    def _rows(self) -> Any:
        """From coefficients to the nodes of all patches, one after another."""
        import scipy.sparse as sp

        parts = []
        for patch, number, xi in zip(self.patches, self.numbers, self._xi, strict=True):
            numbers, N, _, _ = patch.functions(xi)
            rows = np.repeat(np.arange(len(xi)), N.shape[1])
            part = sp.coo_array((N.ravel(), (rows, number[numbers].ravel())), shape=(len(xi), self.size))
            parts.append(part)
        return sp.csr_array(sp.vstack(parts))

    def at_nodes(self, coefficients: Array) -> Array:
        return np.asarray(self.samples @ coefficients)

    def torn(self, what: str, values: Array) -> list[str]:
        return []  # what they are fitted to is seen by both of their sides

    def fitted(self, values: Array, leaders: Ints | None = None) -> Array:
        """By least squares; coefficients (size,) with the same leader are the same."""
        import scipy.sparse as sp
        from scipy.sparse.linalg import spsolve

        number = np.unique(np.arange(self.size) if leaders is None else leaders, return_inverse=True)[1]
        joined = sp.csr_array((np.ones(self.size), number, np.arange(self.size + 1)))
        S = self.samples @ joined
        return np.asarray(joined @ spsolve((S.T @ S).tocsc(), S.T @ values))

    def held(self, nodes: Ints) -> Ints:
        """Coefficients that nodes depend on.

        Raises
        ------
        InputError
            If some of these belong to nodes beside them.
        """
        part = self.samples[nodes].tocoo()
        held = np.unique(part.col[np.abs(part.data) > 1e-12])
        if not np.all(np.isin(self.anchors[held], nodes)):
            raise InputError(
                f"to hold {len(nodes)} of its nodes would hold others beside them; hold whole sides of its patches"
            )
        return held

    def fitted_on(self, nodes: Ints, values: Array) -> Array:
        held = self.held(nodes)
        S = self.samples[nodes][:, held].toarray()
        return np.asarray(np.linalg.lstsq(S, values, rcond=None)[0])


def in_three(vectors: Array) -> Array:
    """Vectors (..., 3) of some (..., d)."""
    return np.pad(vectors, [(0, 0)] * (vectors.ndim - 1) + [(0, 3 - vectors.shape[-1])])


def numbering(patch: SplinePatch, periodic: Sequence[int], level: bool) -> Ints:
    """Coefficient (n_control,) of every control point of a patch that stands alone."""
    shape, along = patch.control.shape[:-1], []
    for k, n in enumerate(shape):
        here = np.arange(n)
        if k in periodic:
            here %= n - patch.degrees[k]
        elif level:
            here[0], here[-1] = 1, n - 2
        along.append(np.unique(here, return_inverse=True)[1])
    number = np.zeros(1, dtype=np.int64)
    for a in along:
        number = (number[:, None] * (int(a.max()) + 1) + a[None]).ravel()
    return number


def sampled(
    patches: Sequence[SplinePatch], samples: int, is_welded: bool
) -> tuple[Mesh, list[Array], list[Ints]]:
    """A mesh of plain cells of all patches, and the parameters (n, d) and numbers (n,) of the nodes of each."""
    made = [patch.sampled(samples) for patch in patches]
    if not is_welded:
        return made[0][0], [made[0][1]], [np.arange(made[0][0].n_nodes)]
    named = [mesh for mesh, _ in made]
    if len(made) > 1:
        named = [
            replace(mesh, face_sets={f"{k}.{name}": faces for name, faces in mesh.face_sets.items()})
            for k, mesh in enumerate(named)
        ]
    apart = convert.joined(named)
    close = CLOSE * float(np.ptp(apart.points, axis=0).max())
    grid = convert.welded(apart, 10 * close)
    rows = [np.concatenate([c.ravel() for c in mesh.cells.values()]) for mesh in (apart, grid)]
    number = np.empty(apart.n_nodes, dtype=np.int64)
    number[rows[0]] = rows[1]
    outer = grid.boundary()
    kept = {name: faces for name, faces in grid.face_sets.items() if is_part(faces, outer)}
    nodes = np.split(number, np.cumsum([mesh.n_nodes for mesh, _ in made])[:-1])
    return replace(grid, face_sets=kept), [xi for _, xi in made], nodes


def is_part(faces: Faces, of: Faces) -> bool:
    """Whether faces are all among others."""
    return set(corner_rows(faces)) <= set(corner_rows(of))


def direction_of(pair: tuple[str, str]) -> int:
    """The direction whose opposite sides a pair names.

    Raises
    ------
    InputError
        If it names others.
    """
    for k, sides in enumerate(SIDES):
        if set(pair) == set(sides):
            return k
    raise InputError(
        f"periodic sides of splines are opposite ones, ('x0', 'x1'), ('y0', 'y1') or ('z0', 'z1'), not {tuple(pair)}"
    )
