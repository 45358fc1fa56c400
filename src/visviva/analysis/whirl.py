"""Modes that turn or grow: of gyroscopic forces, and of forces without potential."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.analysis.linearized import STIFF, Linearized, free_directions, symmetric
from visviva.analysis.resolution import noise, refuse_lost
from visviva.base.errors import InputError, RunError
from visviva.system.instant import COMPLIANCE, Instant
from visviva.system.scaling import equilibration, typical

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SMALL = 200
"""Up to this many coordinates all modes are computed at once."""
NEUTRAL = 1e-6
"""Growth or frequency smaller than this part of a root is rounding: double roots lose half of the digits."""
LOOSE = 1e-14
"""A stiffness whose least value is smaller than this, relative to the largest, leaves something loose."""
TURNING = 1e-12
"""Gyroscopic terms smaller than this, relative to the largest of damping, are none."""

WIDE, RESTARTS = 80, 300
"""Vectors of the Krylov space of few modes, and how often it may be begun anew."""


def gyroscopic(at: Instant) -> sp.csr_array | None:
    """The skew part (n, n) of the forces by velocities; None where there is none."""
    system = at.system
    motion, rest = np.zeros((5, 4)), np.zeros((5, 4))
    without = _core.Step(system.time, 0.0, system.time, 1.0, 1.0, False, motion, rest)
    motion[0, 0] = 1.0
    moving = _core.Step(system.time, 0.0, system.time, 1.0, 1.0, False, motion, rest)
    C = (system.tangent(moving)[1] - system.tangent(without)[1])[at._q][:, at._q]
    skew = 0.5 * (C - C.T)
    if not C.nnz or abs(skew).max() <= TURNING * abs(C).max():
        return None
    return skew.tocsr()


def complex_modes(linear: Linearized, C: sp.csr_array, n: int) -> tuple[Complex, Complex]:
    """Roots (k,) of ``(r^2 M + r C + K) z = 0`` nearest to zero, one of each pair, and vectors (., k)."""
    import scipy.sparse.linalg as spl

    q = len(linear.at.coordinates)
    if q <= SMALL or 2 * n + 4 >= 2 * q - 2:
        roots, z = all_roots(linear, C)
    else:
        shift = lowest(linear, C)
        operator = Inverse(linear, C, shift)
        start = np.random.default_rng(0).standard_normal(2 * q)
        linear_operator = spl.LinearOperator((2 * q, 2 * q), matvec=operator.__matmul__, dtype=float)
        try:
            k, ncv = 2 * n + 4, min(2 * q - 1, max(WIDE, 4 * n))
            theta, z = spl.eigs(linear_operator, k=k, which="LM", v0=start, ncv=ncv, maxiter=RESTARTS)
        except spl.ArpackError as error:
            raise RunError(f"modes: the lowest {n} were not found; ask for fewer, or for more") from error
        finite = np.abs(theta) > 1e-9 * np.abs(theta).max(initial=0.0)
        roots, z = shift + 1 / theta[finite], linear.at.scale[:, None] * z[:q, finite]
    roots = cleaned(roots)
    one = (roots.imag > 0) | ((roots.imag == 0) & (roots.real >= 0))
    roots, z = roots[one], z[:, one]
    order = np.lexsort((-roots.real, np.round(np.abs(roots), 12)))[:n]
    z = z[:, order].astype(np.complex128)
    weight: Array = np.sqrt(np.abs((z.conj() * (linear.at.M @ z)).sum(axis=0)))
    roots, z = roots[order], np.asarray(z / np.where(weight > 0, weight, 1.0), dtype=np.complex128)
    doubt = noise(symmetric(linear.K), np.abs(z))  # of their squares
    for part in (z.real, z.imag):
        refuse_lost(linear, np.abs(roots) ** 2, part, doubt)
    return cleaned(roots, doubt / np.where(roots == 0, 1.0, np.abs(roots))), z


def all_roots(linear: Linearized, C: sp.csr_array) -> tuple[Complex, Complex]:
    """All finite roots (k,) with vectors (., k), on the directions that constraints leave.

    On all coordinates those of constraints have roots at infinity, double ones that rounding brings near. Where
    nothing is loose the inverses of the roots are computed, so that rounding leaves the lowest ones alone.
    """
    import scipy.linalg as sla

    K, rows, columns = held_and_soft(linear)
    s, rate = linear.at.scale, fastest(linear)
    N, left = free_directions(rows * s), free_directions(columns.T * s)
    M, K, C_N = (left.T @ (s[:, None] * (A @ (s[:, None] * N))) for A in (linear.at.M, K, C))
    n, zero, one = len(M), np.zeros_like(M), np.eye(len(M))
    if n and np.linalg.cond(K) * LOOSE < 1:
        both = sla.block_diag(N, N)
        inverse, z = np.linalg.eig(both.T @ (Inverse(linear, C, 0.0) @ both))
        finite = inverse != 0
        roots = 1 / np.where(finite, inverse, 1.0)
    else:
        ahead, behind = (
            np.block([[zero, one], [-K, -rate * C_N]]),
            np.block([[one, zero], [zero, rate**2 * M]]),
        )
        roots, z = sla.eig(ahead, behind)
        finite = np.isfinite(roots)
        roots = rate * np.where(finite, roots, 0.0)
    return roots[finite], s[:, None] * (N @ z[:n, finite])


def fastest(linear: Linearized) -> float:
    """Scale of the rates of coordinates: about the highest frequency."""
    at = linear.at
    stiff = typical(abs(linear.K.diagonal()) * at.scale**2)
    return float(np.sqrt(stiff / typical(at.M.diagonal() * at.scale**2)))


def held_and_soft(linear: Linearized) -> tuple[Array, Array, Array]:
    """Stiffness (n, n) with what forces of compliance add, rows (r, n) of constraints, and how those act (n, r)."""
    K, B, D, column = (A.toarray() for A in (linear.K, linear.B, linear.D, linear.column))
    if len(B) == 0:
        return K, B, column
    size = np.abs(B).max(axis=1)
    r = 1 / np.where(size > 0, size, np.sqrt(np.abs(D.diagonal())) + (size == 0))
    B, column = r[:, None] * B, column * r
    U, compliance, Vt = np.linalg.svd(r[:, None] * D * r)
    largest = compliance.max()
    held = compliance * max(np.abs(K).max(), 1 / largest if largest > 0 else 0.0) <= STIFF
    rows, columns = U.T @ B, column @ Vt.T
    soft = columns[:, ~held] @ (rows[~held] / compliance[~held, None])
    return K - soft, rows[held], columns[:, held]


def cleaned(roots: Complex, doubt: Array | float = 0.0) -> Complex:
    """Roots whose growth or frequency is rounding, or in doubt, have none."""
    least = np.maximum(NEUTRAL * np.abs(roots), doubt)
    real = np.where(np.abs(roots.real) > least, roots.real, 0.0)
    imag = np.where(np.abs(roots.imag) > least, roots.imag, 0.0)
    return np.asarray(real + 1j * imag)


def lowest(linear: Linearized, C: sp.csr_array) -> float:
    """A real number somewhat below the size of the lowest roots, which is none of them."""
    high, q = fastest(linear), len(linear.at.coordinates)
    for shift in high * 10.0 ** -np.arange(3, 7):
        inverse, grown = Inverse(linear, C, float(shift)), 1.0
        z = np.random.default_rng(0).standard_normal(2 * q)
        for k in range(8):
            z = inverse @ (z / np.linalg.norm(z))
            grown *= float(np.linalg.norm(z)) if k > 3 else 1.0
        if grown**-0.25 > 2 * shift:  # distance of the nearest root: mostly its own size
            break
    return float(shift)


class Inverse:
    """Of the first-order equations in (z, r z) less a shift; its eigenvalues are 1 / (r - shift).

    Coordinates are measured by their scales, and their rates by those and a frequency, so that units do not count.
    """

    def __init__(self, linear: Linearized, C: sp.csr_array, shift: float) -> None:
        import scipy.sparse as sp
        import scipy.sparse.linalg as spl

        at, m = linear.at, len(linear.unknowns)
        rate = shift or fastest(linear)
        self._d = np.concatenate([at.scale, rate * at.scale])
        self._q, self._M, self._C = len(at.coordinates), at.M, C + 2 * shift * at.M
        self._shift = shift
        K = linear.K + shift * C + shift**2 * at.M
        A = sp.block_array([[K, linear.column], [linear.B, linear.D]], format="csr")
        scale = np.concatenate([at.scale, at.system.scale[linear.unknowns]])
        self._s = equilibration((0.5 * (A + A.T)).tocsr(), scale)
        S, free = sp.diags_array(self._s), self._q + m - linear.n_forces
        soft = sp.diags_array(np.r_[np.zeros(free), np.full(linear.n_forces, COMPLIANCE)])
        try:
            self._A = (S @ A @ S).tocsr()
            self._lu = spl.splu((self._A - soft).tocsc())
        except RuntimeError as error:
            raise InputError(
                "modes: the equations are singular: something moves that neither mass nor stiffness determines; hold it"
            ) from error

    def __matmul__(self, x: Any) -> Any:
        d = self._d.reshape(-1, *[1] * (np.ndim(x) - 1))
        x = d * np.asarray(x)
        z, v = x[: self._q], x[self._q :]  # v = (r - shift) z
        r = np.zeros((len(self._s), *x.shape[1:]))
        r[: self._q] = -(self._C @ z + self._M @ v)
        s = self._s.reshape(-1, *[1] * (x.ndim - 1))
        r, y = s * r, np.zeros_like(r)
        for _ in range(3):  # takes off the compliance of constraints, whose roots would be finite
            y += self._lu.solve(r - self._A @ y)
        return np.concatenate([(s * y)[: self._q], z]) / d
