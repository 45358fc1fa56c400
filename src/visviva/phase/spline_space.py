"""Spaces of splines for scalar fields, as tables of shape functions element by element."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.mesh_points import face_points
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.mesh.geometry import determinant
from visviva.mesh.grid import SIDES
from visviva.mesh.quadrature import mass_rule
from visviva.mesh.spline import SplineSource
from visviva.phase.space import Table

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class SplineSpace:
    """Splines on one patch; what is drawn is a fine mesh of plain cells.

    Parameters
    ----------
    source : SplineSource
    periodic : sequence of (str, str)
        Opposite sides that are taken for the same, smoothly.
    thickness : float
        Of a plane patch.
    level_at_sides : bool
        Whether the fields have no slope across sides of a `SplineBox` that are not periodic.

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
    ) -> None:
        directions = [direction_of(pair) for pair in periodic]
        self.patch, self.thickness = source.patch(directions), thickness
        self.number, self.size = self._numbering(directions, level_at_sides)
        self.grid, self._xi = self.patch.sampled(max(2, max(self.patch.degrees)))

    def _numbering(self, periodic: Sequence[int], level: bool) -> tuple[Ints, int]:
        """Coefficient (n_control,) of every control point, and how many there are."""
        shape, along = self.patch.control.shape[:-1], []
        for k, n in enumerate(shape):
            here = np.arange(n)
            if k in periodic:
                here %= n - self.patch.degrees[k]
            elif level:
                here[0], here[-1] = 1, n - 2
            along.append(np.unique(here, return_inverse=True)[1])
        counts = [int(a.max()) + 1 for a in along]
        number = np.zeros(1, dtype=np.int64)
        for a, n in zip(along, counts, strict=True):
            number = (number[:, None] * n + a[None]).ravel()
        return number, int(np.prod(counts))

    @property
    def spacing(self) -> float:
        """Longest knot span."""
        points = self.grid.points
        step = max(2, max(self.patch.degrees))
        cells = next(iter(self.grid.cells.values()))
        return float(step * np.ptp(points[cells], axis=1).max())

    def cells(self) -> Sequence[Table]:
        return [self._cells]

    @cached_property
    def _cells(self) -> Table:
        xi, w = self._points()
        q = w.shape[1]
        numbers, N, dN, H = self.patch.functions(xi)
        P = self.patch.control.reshape(-1, self.patch.dimension)[numbers]
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
        d = self.patch.dimension

        def by_cell(a: Array) -> Array:
            return np.ascontiguousarray(a.reshape(-1, q, *a.shape[1:]))

        return Table(
            numbers=self.number[numbers.reshape(-1, q, numbers.shape[1])[:, 0]],
            N=by_cell(N),
            gradients=by_cell(np.pad(gradients, ((0, 0), (0, 0), (0, 3 - d)))),
            size=by_cell(determinant(J)) * w * (self.thickness if d == 2 else 1.0),
            X=by_cell(np.pad(X, ((0, 0), (0, 3 - d)))),
            laplacians=by_cell(laplacians),
        )

    def _points(self) -> tuple[Array, Array]:
        """Parameters (m q, d) of Gauss points, degree and one in each direction, and weights (m, q)."""
        places, weights = [], []
        for k, p in enumerate(self.patch.degrees):
            x, w = np.polynomial.legendre.leggauss(p + 1)
            b = self.patch.breaks(k)
            half = 0.5 * np.diff(b)
            places.append(b[:-1, None] + half[:, None] * (1 + x))
            weights.append(half[:, None] * w)
        d = self.patch.dimension

        def spread(parts: Sequence[Array], k: int) -> Array:
            """Of direction k on all spans, then all points."""
            spans, n = self.patch.counts, [len(a[0]) for a in parts]
            shape = [1] * (2 * d)
            shape[k], shape[d + k] = spans[k], n[k]
            return np.broadcast_to(parts[k].reshape(shape), (*spans, *n)).reshape(int(np.prod(spans)), -1)

        xi = np.stack([spread(places, k) for k in range(d)], axis=-1)
        w = np.prod([spread(weights, k) for k in range(d)], axis=0)
        return xi.reshape(-1, d), np.asarray(w)

    def walls(self, faces: Faces) -> Iterator[Table]:
        """Tables of faces of the mesh that is drawn, whose plain shape their size is taken from."""
        for p in face_points(self.grid, faces, thickness=self.thickness):
            kind = next(name for name, nodes in faces.cells.items() if nodes is p.nodes)
            xi = np.einsum("mkc,qk->mqc", self._xi[p.nodes], CELLS[kind].N(mass_rule(kind).points))
            q = xi.shape[1]
            # all points of a face see the functions of its first point, whose span is that of the face's middle
            numbers, N, _, _ = self.patch.functions(xi.reshape(-1, self.patch.dimension))
            values = N.reshape(-1, q, N.shape[1])
            yield Table(
                numbers=self.number[numbers.reshape(-1, q, numbers.shape[1])[:, 0]],
                N=values,
                gradients=np.zeros((*values.shape, 3)),
                size=p.size,
                X=p.X,
            )

    @cached_property
    def _samples(self) -> Any:
        """From coefficients to the nodes of the grid, as a sparse matrix."""
        import scipy.sparse as sp

        numbers, N, _, _ = self.patch.functions(self._xi)
        rows = np.repeat(np.arange(len(N)), N.shape[1])
        shape = (len(N), self.size)
        return sp.csr_array(sp.coo_array((N.ravel(), (rows, self.number[numbers].ravel())), shape=shape))

    def at_nodes(self, coefficients: Array) -> Array:
        return np.asarray(self._samples @ coefficients)

    def fitted(self, values: Array) -> Array:
        """By least squares."""
        from scipy.sparse.linalg import spsolve

        S = self._samples
        return np.asarray(spsolve((S.T @ S).tocsc(), S.T @ values))

    def held(self, nodes: Ints) -> Ints:
        part = self._samples[nodes].tocoo()
        return np.unique(part.col[np.abs(part.data) > 1e-12])

    def fitted_on(self, nodes: Ints, values: Array) -> Array:
        held = self.held(nodes)
        S = self._samples[nodes][:, held].toarray()
        return np.asarray(np.linalg.lstsq(S, values, rcond=None)[0])


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
