"""Assumed natural strains of shells: where those of a cell type are sampled, and what is made of them at its points.

In-plane strains (membrane and curvature) and shear strains are sampled along directions in the cell's own coordinates:
MITC4 (Dvorkin & Bathe 1984), MITC9 (Bucalem & Bathe 1993), MITC3 and the shear of MITC6 (Lee & Bathe 2004), whose
in-plane strains are those of Regge's elements (Neunteufel & Schoeberl 2021); three-node triangles have less shear
stiffness where they are larger than thick, or they would lock (Lyly, Stenberg & Vihinen 1993).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import Rule, gauss, rule

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Functions = Callable[[float, float], Array]
R, S, ALONG = (1.0, 0.0), (0.0, 1.0), (-1.0, 1.0)
"""Directions: along the two coordinates, and along the third side of a triangle."""


@dataclass(frozen=True)
class Sample:
    """The strain of two directions at a point (2,); of one direction alone, the shear strain along it."""

    at: tuple[float, float]
    directions: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class Tying:
    """Samples, and shares (q, components, samples) of each in the strains at points (q, 2)."""

    samples: Sequence[Sample]
    shares: Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class AssumedStrains:
    """Strains of a cell type: first those of the membrane, then curvatures, sampled alike, then shear.

    Attributes
    ----------
    cell : str
    points : Rule
        Where strains are integrated.
    plane, shear : Tying
        Components 11, 22, 2 x 12 and 1, 2 along the cell's coordinates.
    relief : float
        The shear stiffness is taken times ``t^2 / (t^2 + relief h^2)`` of the thickness t and the longest side h.
    """

    cell: str
    points: Rule
    plane: Tying
    shear: Tying
    relief: float = 0.0

    @cached_property
    def n(self) -> int:
        """Number of samples."""
        return 2 * len(self.plane.samples) + len(self.shear.samples)

    @cached_property
    def shares(self) -> Array:
        """Of the samples in the eight natural strains at the points (q, 8, n)."""
        xi, k = self.points.points, len(self.plane.samples)
        found = np.zeros((len(xi), 8, self.n))
        found[:, :3, :k] = found[:, 3:6, k : 2 * k] = self.plane.shares(xi)
        found[:, 6:, 2 * k :] = self.shear.shares(xi)
        return found

    @cached_property
    def _made(self) -> tuple[Array, Ints, Array]:
        vectors: dict[tuple[object, ...], int] = {}
        products: list[tuple[int, int, int]] = []
        factors: list[float] = []

        def vector(*key: object) -> int:
            return vectors.setdefault(key, len(vectors))

        k = len(self.plane.samples)
        for i, sample in enumerate(self.plane.samples):
            u, v = sample.directions
            pairs = [(u, v)] if u == v else [(u, v), (v, u)]
            products.append((i, vector("phi", sample.at, u), vector("phi", sample.at, v)))
            factors.append(0.5 if u == v else 1.0)
            for a, b in pairs:
                products.append((k + i, vector("phi", sample.at, a), vector("d", sample.at, b)))
                factors.append(1.0)
        for i, sample in enumerate(self.shear.samples):
            products.append(
                (2 * k + i, vector("phi", sample.at, sample.directions[0]), vector("d", sample.at))
            )
            factors.append(1.0)
        return self._weights(list(vectors)), np.array(products), np.array(factors)

    def _weights(self, vectors: list[tuple[object, ...]]) -> Array:
        cell = CELLS[self.cell]
        weights = np.zeros((len(vectors), 2, cell.n_nodes))
        for row, (what, at, *along) in zip(weights, vectors, strict=True):
            N, dN = cell.N_dN(np.array([at]))
            row[0 if what == "phi" else 1] = dN[0] @ np.array(along[0]) if along else N[0]
        return weights.reshape(len(vectors), -1)

    @property
    def weights(self) -> Array:
        """Of nodal positions, then directors, in the sampled vectors (v, 2 k)."""
        return self._made[0]

    @property
    def products(self) -> Ints:
        """Sample, and the two vectors whose product adds to it (p, 3)."""
        return self._made[1]

    @property
    def factors(self) -> Array:
        """Of the products (p,)."""
        return self._made[2]

    def sampled(self, phi: Array, d: Array) -> Array:
        """Strains (m, n) of positions and directors (m, k, 3) of the nodes of cells."""
        z = np.einsum("vk,mkc->mvc", self.weights, np.concatenate([phi, d], axis=1), optimize=True)
        sample, left, right = self.products.T
        found = np.zeros((self.n, len(z)))
        np.add.at(found, sample, (self.factors * (z[:, left] * z[:, right]).sum(axis=2)).T)
        return found.T


def fitted(samples: Sequence[Sample], functions: Functions) -> Tying:
    """Shear strains of a space of functions (components, n) that agree with all samples."""

    def values(at: Array) -> Array:
        return np.stack([functions(r, s) for r, s in at])

    found = values(np.array([s.at for s in samples]))
    inverse = np.linalg.inv(
        np.stack([np.array(s.directions[0]) @ v for s, v in zip(samples, found, strict=True)])
    )
    return Tying(samples, lambda xi: values(xi) @ inverse)


def lagrange(nodes: Array, x: Array) -> Array:
    """Polynomials (q, n) that are one at one of the nodes (n,) and zero at the others."""
    one = np.ones_like(x)
    return np.stack(
        [np.prod([one, *((x - b) / (a - b) for b in nodes if b != a)], axis=0) for a in nodes], axis=1
    )


# --- quadrilaterals -----------------------------------------------------------------------------------------
def grids(blocks: Sequence[tuple[int, tuple[tuple[float, float], ...], Array, Array]], n: int) -> Tying:
    """Components (one of n) with the directions that they are sampled along, each on a grid of its own."""
    samples = [Sample((float(a), float(b)), along) for _, along, r, s in blocks for b in s for a in r]

    def shares(xi: Array) -> Array:
        found, start = np.zeros((len(xi), n, len(samples))), 0
        for component, _, r, s in blocks:
            part = np.einsum("qb,qa->qba", lagrange(s, xi[:, 1]), lagrange(r, xi[:, 0]))
            size = len(r) * len(s)
            found[:, component, start : start + size] = part.reshape(len(xi), -1)
            start += size
        return found

    return Tying(samples, shares)


G2, G3, ENDS = (
    np.array([-1.0, 1.0]) / np.sqrt(3),
    np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6),
    np.array([-1.0, 1.0]),
)
MIDDLE = np.array([0.0])
QUAD4 = AssumedStrains(
    "quad4",
    gauss(2, 2),
    grids([(0, (R, R), G2, G2), (1, (S, S), G2, G2), (2, (R, S), G2, G2)], 3),
    grids([(0, (R,), MIDDLE, ENDS), (1, (S,), ENDS, MIDDLE)], 2),
)
QUAD9 = AssumedStrains(
    "quad9",
    gauss(3, 2),
    grids([(0, (R, R), G2, G3), (1, (S, S), G3, G2), (2, (R, S), G2, G2)], 3),
    grids([(0, (R,), G2, G3), (1, (S,), G3, G2)], 2),
)


# --- triangles ----------------------------------------------------------------------------------------------
def mitc3(r: float, s: float) -> Array:
    """Shear strains (2, 3): constant along every side."""
    return np.array([(1.0, 0, s), (0, 1, -r)])


def mitc6(r: float, s: float) -> Array:
    """Shear strains (2, 8): linear along every side (MITC6-a)."""
    return np.array(
        [(1, r, s, 0, 0, 0, r * s, s * s), (0, 0, 0, 1, r, s, -r * r, -r * s)],
        dtype=float,
    )


def regge(sides: Sequence[Sample], inside: Rule) -> Tying:
    """Linear in-plane strains that agree with samples along the sides, and in their means over points inside.

    Strains along a side are those of its nodes alone, so that cells on both sides of it have the same ones.
    """
    weights = inside.weights / inside.weights.sum()
    along = [sample.directions[0] for sample in sides]
    pairs = ((R, R), (S, S), (R, S))
    within = [Sample((float(a), float(b)), pair) for pair in pairs for a, b in inside.points]
    fields = np.zeros((9, 9))  # what is fitted of 1, r, s in the components 11, 22, 2 x 12
    for row, ((a, b), sample) in zip(fields, zip(along, sides, strict=True), strict=False):
        row[:] = np.kron((a * a, b * b, a * b), (1.0, *sample.at))
    centre = weights @ np.column_stack([np.ones(len(weights)), inside.points])
    fields[6:] = np.kron(np.eye(3), centre)
    means = np.zeros((9, len(sides) + len(within)))
    means[:6, :6], means[6:, 6:] = np.eye(6), np.kron(np.eye(3), weights)
    shares_of = (np.linalg.inv(fields) @ means).reshape(3, 3, -1)

    def shares(xi: Array) -> Array:
        return np.asarray(np.einsum("qp,cpn->qcn", np.column_stack([np.ones(len(xi)), xi]), shares_of))

    return Tying([*(Sample(s.at, (u, u)) for s, u in zip(sides, along, strict=True)), *within], shares)


LOW, HIGH = 0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3)
EDGES = (
    *(Sample((a, 0.0), (R,)) for a in (LOW, HIGH)),
    *(Sample((0.0, a), (S,)) for a in (LOW, HIGH)),
    *(Sample((1 - a, a), (ALONG,)) for a in (LOW, HIGH)),
)
CENTRE = (1 / 3, 1 / 3)
TRI3 = AssumedStrains(
    "tri3",
    rule("tri3", 2),
    Tying(
        [Sample(CENTRE, (R, R)), Sample(CENTRE, (S, S)), Sample(CENTRE, (R, S))],
        lambda xi: np.broadcast_to(np.eye(3), (len(xi), 3, 3)),
    ),
    fitted([Sample((0.5, 0.0), (R,)), Sample((0.0, 0.5), (S,)), Sample((0.5, 0.5), (ALONG,))], mitc3),
    relief=0.1,
)
TRI6 = AssumedStrains(
    "tri6",
    rule("tri6", 5),
    regge(EDGES, rule("tri3", 2)),
    fitted([*EDGES, Sample(CENTRE, (R,)), Sample(CENTRE, (S,))], mitc6),
)
ASSUMED = {strains.cell: strains for strains in (TRI3, TRI6, QUAD4, QUAD9)}
"""By the cell types that shells are made of."""
