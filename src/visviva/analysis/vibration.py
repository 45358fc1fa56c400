"""Undamped modes of the linear equations of small motions: all of few coordinates, the lowest of many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.factors import factored
from visviva.analysis.linearized import Linearized, free_directions, massless, symmetric, without_forces
from visviva.analysis.multiples import completed
from visviva.base.errors import InputError, RunError
from visviva.system.instant import COMPLIANCE
from visviva.system.scaling import by_weight, equilibration, typical

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]

DENSE = 600
"""Up to this many coordinates all modes are computed at once."""
ROUNDED = 64 * float(np.finfo(float).eps)
"""Squares of frequencies are zero that are smaller than this part of the terms that they are the sums of."""
WEIGHTLESS = 1e-13
"""A direction weighs nothing with so little of what its coordinates weigh."""


def found_modes(linear: Linearized, n: int) -> tuple[Array, Array]:
    """The lowest modes; of few coordinates all at once, where the highest do not leave the lowest in round-off."""
    if len(linear.at.coordinates) > DENSE:
        return sparse_modes(linear, n)
    squared, z, is_clear = dense_modes(linear, n)
    if is_clear or n >= z.shape[0] // 2:
        return squared, z
    try:
        return sparse_modes(linear, n)
    except (InputError, RunError):  # free motions alone, or too few others
        return squared, z


def dense_modes(linear: Linearized, n: int) -> tuple[Array, Array, bool]:
    """All modes in a basis of what the constraints leave free, the lowest `n` returned."""

    import scipy.linalg as sla
    import scipy.sparse as sp

    at = linear.at
    q = len(at.coordinates)
    s = by_weight(at.M.diagonal(), at.scale)
    S = sp.diags_array(s)
    K, rows = without_forces(
        (S @ symmetric(linear.K) @ S).toarray(), (linear.B @ S).toarray(), linear.D.toarray()
    )
    free = free_directions(rows)
    Z = s[:, None] * free
    if Z.shape[1] == 0:
        return np.zeros(0), np.zeros((q, 0)), True
    M = Z.T @ (at.M @ Z)
    light, direction = np.linalg.eigh(M)
    if light[0] <= WEIGHTLESS:
        raise massless(at, int(np.argmax(np.abs(Z @ direction[:, 0]) / at.scale)))
    squared, y = sla.eigh(free.T @ K @ free, M)
    least = ROUNDED * max(float(np.abs(squared).max()), float(np.abs(K).sum(axis=1).max()))
    z = Z @ y
    own = rounding(K, free @ y)
    is_clear = not np.any((np.abs(squared[:n]) <= least) & (own[:n] < 1e-3 * least))
    squared[np.abs(squared) <= np.maximum(own, least)] = 0.0
    return squared[:n], z[:, :n], is_clear


def rounding(K: Any, z: Array) -> Array:
    """How far off round-off may be in the quadratic forms of a stiffness with vectors (n, k)."""
    sums: Array = (np.abs(z) * (abs(K) @ np.abs(z))).sum(axis=0)
    return ROUNDED * sums


def sparse_modes(linear: Linearized, n: int) -> tuple[Array, Array]:
    """Modes of squares nearest to zero, by inverse iteration with a small shift below zero."""

    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    at, K = linear.at, symmetric(linear.K)
    q, p = linear.B.shape[1], len(linear.unknowns)
    held = abs(linear.D).sum(axis=1) == 0
    light = (abs(at.M).sum(axis=1) == 0) & (abs(linear.B[held]).sum(axis=0) == 0)
    if light.any():
        raise massless(at, int(np.argmax(light)))
    n = max(min(n, q - int(held.sum()) - 1), 1)
    largest = typical(abs(K.diagonal()) * at.scale**2) / typical(at.M.diagonal() * at.scale**2)
    B = sp.block_diag([at.M, sp.csr_array((p, p))], format="csr")
    shift = -1e-6 * largest
    start = np.random.default_rng(0).standard_normal(q + p)
    A, inverse = shifted(linear, K, shift)
    for _ in range(4):  # close to the low modes of thin bodies, where few iterations do
        for _ in range(3):
            start = inverse @ (B @ start)
            start /= np.sqrt(start @ (B @ start))
        low = max(1e-2 * float(start[:q] @ (K @ start[:q])), 1e-10 * largest)
        if low > -0.1 * shift:
            break
        try:
            A, inverse = shifted(linear, K, -low)
        except InputError:  # so near to rigid motions that they are singular
            break
        shift = -low

    def nearest(inverse: Any, n: int = 1) -> tuple[Array, Array]:
        found: tuple[Array, Array] = spl.eigsh(A, k=n, M=B, sigma=shift, OPinv=inverse, v0=start, which="LM")
        return found

    try:
        squared, z = nearest(inverse, n)
        squared, z = completed(inverse, squared, z, B, lambda squared: squared - shift, nearest)
    except spl.ArpackError as error:
        raise RunError(
            f"modes: the lowest {n} were not found beside frequencies up to {np.sqrt(largest):.2g} rad per time; "
            "make what hardly gives way rigid, or ask for fewer"
        ) from error
    squared[np.abs(squared) <= np.maximum(rounding(K, z[:q]), -1e-9 * shift)] = 0.0
    order = np.argsort(squared)
    return squared[order], z[:q, order]


def shifted(linear: Linearized, K: sp.csr_array, shift: float) -> tuple[sp.csr_array, Any]:
    """The equations of vibration less a shift times the mass, and their inverse."""
    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    at, (p, q) = linear.at, linear.B.shape
    A = sp.block_array([[K - shift * at.M, linear.B.T], [linear.B, symmetric(linear.D)]], format="csr")
    s = equilibration(A, np.concatenate([at.scale, at.system.scale[linear.unknowns]]))
    S = sp.diags_array(s)
    soft = np.r_[np.zeros(q + p - linear.n_forces), np.full(linear.n_forces, COMPLIANCE)]
    unknowns = np.concatenate([at.coordinates, linear.unknowns])
    solve = factored(S @ A @ S - sp.diags_array(soft), linear.n_forces, at.system, unknowns)
    return A, spl.LinearOperator(A.shape, matvec=lambda r: s * solve(s * np.ravel(r)), dtype=float)
