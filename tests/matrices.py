"""Matrices to solve: linear elasticity on blocks of trilinear hexahedra, with what makes them harder."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Elasticity:
    """A stiffness matrix, with the nodes of its equations."""

    matrix: sp.csr_array
    node: NDArray[np.int32]
    """First equation of every node, and the number of equations."""
    modes: Array
    """Rigid-body motions by equation."""


def hexahedron(size: Array, young: float = 1.0, poisson: float = 0.3) -> Array:
    """Stiffness (24 x 24) of a hexahedron with edges along the axes, 2 x 2 x 2 points."""
    mu, lam = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
    C = np.zeros((6, 6))
    C[:3, :3] = lam
    C[np.diag_indices(6)] += [2 * mu] * 3 + [mu] * 3
    corner = np.array(list(product((-1, 1), repeat=3)), dtype=float)
    K = np.zeros((24, 24))
    for at in corner / np.sqrt(3):
        factor = 1 + corner * at
        B = np.zeros((6, 24))
        for i in range(8):
            x, y, z = (corner[i] / 4 / size) * [
                factor[i, [1, 2]].prod(),
                factor[i, [0, 2]].prod(),
                factor[i, [0, 1]].prod(),
            ]
            B[:, 3 * i : 3 * i + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
        K += B.T @ C @ B * size.prod() / 8
    return K


def rigid_motions(X: Array) -> Array:
    """Six rigid motions of points (n, 3), as (3 n, 6)."""
    B = np.zeros((len(X), 3, 6))
    B[:, range(3), range(3)] = 1
    for k in range(3):
        B[:, :, 3 + k] = np.cross(np.eye(3)[k], X - X.mean(axis=0))
    return B.reshape(-1, 6)


def block(n: int, *, length: tuple[float, float, float] = (1, 1, 1), fixed: str = "clamped") -> Elasticity:
    """A block of n^3 hexahedra: "clamped" at x = 0, held by "symmetry" planes, or "free"."""
    grid = np.array(list(product(range(n + 1), repeat=3)))
    size = np.array(length) / n
    corner = np.array(list(product((0, 1), repeat=3)))
    first = np.array(list(product(range(n), repeat=3)))
    cells = ((first[:, None] + corner) @ [(n + 1) ** 2, n + 1, 1]).astype(int)
    dof = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 24)
    values = np.tile(hexahedron(size).ravel(), len(cells))
    rows, cols = np.repeat(dof, 24, axis=1).ravel(), np.tile(dof, 24).ravel()
    K = sp.coo_array((values, (rows, cols))).tocsr()
    held = {"clamped": np.repeat(grid[:, :1] == 0, 3, axis=1), "symmetry": grid == 0, "free": grid < 0}[fixed]
    free = np.flatnonzero(~held.ravel())
    per_node = (~held).sum(axis=1)
    node = np.concatenate([[0], np.cumsum(per_node[per_node > 0])]).astype(np.int32)
    return Elasticity(matrix_of(K[free][:, free]), node, rigid_motions(grid * size)[free])


def torus(around: int, across: int, layers: int, h: float, density: float = 1.0) -> Elasticity:
    """A thin hollow ring of hexahedra, periodic in two directions, with the inertia of a step of length h.

    The cells are the flat ones of a block: only the connections are those of a torus.
    """
    counts = np.array([around, across, layers + 1])
    size = np.array([40 / around, 8 / across, 0.5 / layers])
    first = np.array(list(product(range(around), range(across), range(layers))))
    at = (first[:, None] + np.array(list(product((0, 1), repeat=3)))) % [around, across, layers + 2]
    cells = (at @ [counts[1] * counts[2], counts[2], 1]).astype(int)
    dof = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 24)
    values = np.tile(hexahedron(size).ravel(), len(cells))
    rows, cols = np.repeat(dof, 24, axis=1).ravel(), np.tile(dof, 24).ravel()
    K = sp.coo_array((values, (rows, cols))).tocsr()
    mass = density * size.prod() * np.bincount(dof.ravel()) / 8
    n = K.shape[0]
    modes = np.tile(np.eye(3), (n // 3, 1))
    return Elasticity(
        matrix_of(K + sp.diags_array(4 / h**2 * mass)), np.arange(0, n + 1, 3, dtype=np.int32), modes
    )


def with_constraints(e: Elasticity, n: int, seed: int = 0) -> sp.csr_array:
    """The saddle point of n constraints between neighbouring equations, zero diagonals not stored."""
    random = np.random.default_rng(seed)
    size = e.matrix.shape[0]
    at = random.choice(size - 18, n, replace=False)
    cols = (at[:, None] + random.permuted(np.tile(np.arange(18), (n, 1)), axis=1)[:, :8]).ravel()
    G = sp.csr_array((random.standard_normal(8 * n), (np.repeat(np.arange(n), 8), cols)), shape=(n, size))
    return matrix_of(sp.block_array([[e.matrix, G.T], [G, None]], format="csr"))


def scaled(A: sp.csr_array, d: Array) -> sp.csr_array:
    """D A D on the pattern of A."""
    A = A.copy()
    A.data = A.data * np.repeat(d, np.diff(A.indptr)) * d[A.indices]
    return A


def shifted(A: sp.csr_array, s: float) -> sp.csr_array:
    """A + s I on the pattern of A."""
    A = A.copy()
    A.data = A.data + s * (np.repeat(np.arange(A.shape[0]), np.diff(A.indptr)) == A.indices)
    return A


def unsymmetric(e: Elasticity, amount: float = 0.3, seed: int = 0) -> sp.csr_array:
    """The matrix with its entries changed at random."""
    random = np.random.default_rng(seed)
    A = e.matrix.copy()
    A.data = A.data * (1 + amount * random.uniform(-1, 1, A.nnz))
    return A


def matrix_of(A: sp.csr_array) -> sp.csr_array:
    """With ascending columns and no doubles, as the core keeps them."""
    A = sp.csr_array(A)
    A.sum_duplicates()
    A.sort_indices()
    return A
