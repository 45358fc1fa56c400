"""Undamped modes of the linear equations of small motions: all of few coordinates, the lowest of many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.factors import factored
from visviva.analysis.linearized import Linearized, free_directions, massless, symmetric, without_forces
from visviva.analysis.multiples import completed
from visviva.analysis.resolution import LOST, Lost, noise, refuse_lost
from visviva.base.errors import InputError, RunError
from visviva.system.instant import COMPLIANCE
from visviva.system.scaling import by_weight, equilibration, typical

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]

MOST = 1000
"""Restarts after which nothing more is to be hoped for."""
DENSE = 600
"""Up to this many coordinates all modes are computed at once."""
ROUNDED = 64 * float(np.finfo(float).eps)
"""Squares of frequencies are zero that are smaller than this part of the terms that they are the sums of."""
COUPLED = 1e6
"""Condition of a stiffness of unit diagonal, beyond which its inverse is no better than itself."""
OWN = 4 * float(np.finfo(float).eps)
"""Part of the stiffness of a component that rounding may leave where it has none."""
WEIGHTLESS = 1e-13
"""A direction weighs nothing with so little of what its coordinates weigh."""


def found_modes(linear: Linearized, n: int) -> tuple[Array, Array]:
    """The lowest modes; of few coordinates all at once, where the highest do not leave the lowest in round-off."""
    find = few_modes if len(linear.at.coordinates) <= DENSE else sparse_modes
    squared, z, doubt = find(linear, n)
    refuse_lost(linear, squared, z, doubt)
    return squared, z


def few_modes(linear: Linearized, n: int) -> tuple[Array, Array, Array]:
    """The lowest modes of all, of which inverse iteration finds those where they are in round-off."""
    squared, z, doubt = dense_modes(linear, n)
    lowest = min(n, z.shape[0] // 2 - 1)
    if lowest < 1 or not np.any(LOST * np.abs(squared[:lowest]) <= doubt[:lowest]):
        return squared, z, doubt
    unsure = float(doubt.max()) / LOST
    try:
        low, y, doubts = within(linear, lowest, unsure)
    except Lost:
        raise
    except (InputError, RunError):  # free motions alone, or too few others
        return squared, z, doubt
    m, near = int(np.sum(squared < -unsure)), low >= -unsure
    k = min(m + int(np.sum(near)), len(squared))
    low, y, doubts = low[near][: k - m], y[:, near][:, : k - m], doubts[near][: k - m]
    return (
        np.r_[squared[:m], low, squared[k:]],
        np.c_[z[:, :m], y, z[:, k:]],
        np.r_[doubt[:m], doubts, doubt[k:]],
    )


def within(linear: Linearized, n: int, radius: float) -> tuple[Array, Array, Array]:
    """Modes by inverse iteration, `n` and all of squares up to a radius: those below zero may be far from it."""
    found, most = sparse_modes(linear, n), len(linear.at.coordinates) // 2 - 1
    while len(found[0]) == n < most and np.abs(found[0]).max() <= radius:
        n = min(2 * n, most)
        try:
            found = sparse_modes(linear, n)
        except (InputError, RunError):
            break
    return found


def dense_modes(linear: Linearized, n: int) -> tuple[Array, Array, Array]:
    """All modes in a basis of what the constraints leave free, the lowest `n` returned, and rounding of squares."""

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
        return np.zeros(0), np.zeros((q, 0)), np.zeros(0)
    M = Z.T @ (at.M @ Z)
    light, direction = np.linalg.eigh(M)
    if light[0] <= WEIGHTLESS:
        raise massless(at, int(np.argmax(np.abs(Z @ direction[:, 0]) / at.scale)))
    squared, y = sla.eigh(free.T @ K @ free, M)
    least = np.full(len(M), ROUNDED * max(float(np.abs(squared).max()), float(np.abs(K).sum(axis=1).max())))
    if n > q // 2 - 1:  # more than inverse iteration finds
        squared, y, low = by_inverse(free.T @ K @ free, M, squared, y)
        least[low] = of_own(linear, Z @ y[:, low])
    z = Z @ y
    squared[np.abs(squared) <= np.maximum(rounding(K, free @ y), least)] = 0.0
    doubt = np.maximum(noise(symmetric(linear.K), z), least / 32)
    return squared[:n], z[:, :n], doubt[:n]


def by_inverse(K: Array, M: Array, squared: Array, y: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Modes whose lower ones, which are marked, are those of the inverse, where scaling leaves K far from singular."""
    import scipy.linalg as sla

    low = np.zeros(len(M), dtype=bool)
    if not np.all(K.diagonal()):
        return squared, y, low
    r = 1 / np.sqrt(np.abs(K.diagonal()))
    scaled = r[:, None] * K * r
    if np.linalg.cond(scaled) > COUPLED:
        return squared, y, low
    flexibility = r[:, None] * np.linalg.inv(scaled) * r
    theta, x = sla.eigh(M @ flexibility @ M, M)
    size = np.sort(np.abs(theta))
    high = np.argsort(-np.abs(squared))[: int(np.sum(size**2 < size[0] * size[-1]))]
    lower = np.argsort(-np.abs(theta))[: len(M) - len(high)]
    low = np.arange(len(M)) >= len(high)
    squared, y = np.r_[squared[high], 1 / theta[lower]], np.c_[y[:, high], x[:, lower]]
    order = np.argsort(squared, kind="stable")
    return squared[order], y[:, order], low[order]


def of_own(linear: Linearized, z: Array) -> Array:
    """Rounding (k,) of squares of motions (n, k) where components know nothing of each other's stiffness.

    That of a spring across its length is a difference of numbers as large as that along it.
    """
    at, rows = linear.at, np.ravel(abs(symmetric(linear.K)).sum(axis=1))
    found = np.zeros(z.shape[1])
    for f in at.system.model.fields:
        own = (at.coordinates >= f.start) & (at.coordinates < f.start + f.size)
        found += OWN * rows[own].max(initial=0.0) * (z[own] ** 2).sum(axis=0)
    return found


def rounding(K: Any, z: Array) -> Array:
    """Bound of round-off in the quadratic forms of a stiffness with vectors (n, k)."""
    sums: Array = (np.abs(z) * (abs(K) @ np.abs(z))).sum(axis=0)
    return ROUNDED * sums


def sparse_modes(linear: Linearized, n: int) -> tuple[Array, Array, Array]:
    """Modes of squares nearest to zero, by inverse iteration near to it, and what rounding makes of the squares."""

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
    A, inverse, shift = near(linear, K, B, largest)
    random = np.random.default_rng(0)

    def nearest(inverse: Any, n: int = 1) -> tuple[Array, Array]:
        """Of an inverse, from another start each time: the same one has no part in what the first left out."""
        start = random.standard_normal(q + p)
        found: tuple[Array, Array] = spl.eigsh(
            A, k=n, M=B, sigma=shift, OPinv=inverse, v0=start, which="LM", maxiter=MOST
        )
        return found

    try:
        squared, z = nearest(inverse, n)
        squared, z = completed(inverse, squared, z, B, lambda squared: np.abs(squared - shift), nearest)
    except spl.ArpackError as error:
        raise RunError(
            f"modes: the lowest {n} were not found beside frequencies up to {np.sqrt(largest):.2g} rad per time; "
            "make what hardly gives way rigid, what is slender or thin thicker or its cells longer, or ask for fewer"
        ) from error
    doubt = np.maximum(noise(K, z[:q]), misfit(A, inverse, B, squared - shift, z))
    doubt = np.maximum(doubt, -1e-12 * shift)
    squared[
        (np.abs(squared) <= np.maximum(rounding(K, z[:q]), doubt)) & (LOST * np.abs(squared) <= doubt)
    ] = 0.0
    order = np.argsort(squared)
    return squared[order], z[:q, order], doubt[order]


def misfit(A: sp.csr_array, inverse: Any, B: sp.csr_array, distance: Array, z: Array) -> Array:
    """Bound of the error of distances (k,) of modes (n, k) from the shift, by the residue of the inverse.

    What modes have of each other does not count: a little of free motions, which are far nearer, looks large.
    """
    weighted, found = B @ z, []
    gram = z.T @ weighted
    for away, mode, load in zip(distance, z.T, weighted.T, strict=True):
        y = away * (inverse @ load)
        lacks = np.stack([y - mode, inverse @ (away * load - A @ y)], axis=1)
        lacks = lacks - z @ np.linalg.solve(gram, weighted.T @ lacks)
        found.append(abs(away) * np.sqrt(np.abs((lacks * (B @ lacks)).sum(axis=0))).sum())
    return np.array(found)


def near(
    linear: Linearized, K: sp.csr_array, B: sp.csr_array, largest: float
) -> tuple[sp.csr_array, Any, float]:
    """Equations close to the low modes, where few iterations do, their inverse and the shift.

    That of no shift is the most exact, as in statics; where something is free to move, a small one below zero is taken.
    """
    q = len(linear.at.coordinates)
    start = np.random.default_rng(0).standard_normal(B.shape[0])
    try:
        A, inverse = shifted(linear, K, 0.0)
        z, squared = iterated(inverse, B, start)
        if LOST * squared > noise(K, z[:q, None])[0]:
            return A, inverse, 0.0
    except InputError:  # something is free to move
        pass
    shift = -1e-6 * largest
    A, inverse = shifted(linear, K, shift)
    for _ in range(4):
        start, _ = iterated(inverse, B, start)
        low = max(1e-2 * float(start[:q] @ (K @ start[:q])), 1e-10 * largest)
        if low > -0.1 * shift:
            break
        try:
            A, inverse = shifted(linear, K, -low)
        except InputError:  # so near to rigid motions that they are singular
            break
        shift = -low
    least = np.array([start[:q] @ (K @ start[:q])])
    refuse_lost(linear, least, start[:q, None], noise(K, start[:q, None]))
    return A, inverse, shift


def iterated(inverse: Any, B: sp.csr_array, z: Array) -> tuple[Array, float]:
    """A vector that inverse iteration has led to the nearest mode, and the distance of that from the shift."""
    weight = 1.0
    for _ in range(3):
        y = inverse @ (B @ z)
        weight = float(np.sqrt(y @ (B @ y)))
        z = y / weight
    return z, 1 / weight


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
