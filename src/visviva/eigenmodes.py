"""Eigenmodes of small vibrations about an equilibrium."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.arguments import positive, refuse_other, whole
from visviva.consistency import accelerations
from visviva.errors import InputError
from visviva.instant import COMPLIANCE, REDUNDANT, Instant, equilibration, instant, typical
from visviva.linear import Direct, Problem

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.component import Component
    from visviva.system import System

Array = NDArray[np.float64]

DENSE = 600
"""Up to this many coordinates all modes are computed at once."""
ZERO = 1e-11
"""Squares of frequencies smaller than this part of the largest are round-off."""


@dataclass
class Modes:
    """Modes in order of their squared frequencies; print it for a table.

    Attributes
    ----------
    squared : array (k,)
        Squares of the angular frequencies; negative where the equilibrium is unstable, zero for free motion.
    shapes : array (k, unknowns)
        Directions in the unknowns of the system, of unit modal mass.
    """

    system: System
    squared: Array
    shapes: Array

    @property
    def angular(self) -> NDArray[Any]:
        """Angular frequencies (k,) in rad per time; complex if any is imaginary (unstable)."""
        return np.emath.sqrt(self.squared)

    @property
    def frequencies(self) -> NDArray[Any]:
        """Frequencies (k,) in cycles per time; complex if any is imaginary (unstable)."""
        cycles: NDArray[Any] = self.angular / (2 * np.pi)
        return cycles

    @property
    def stable(self) -> bool:
        """Whether no mode grows."""
        return bool(np.all(self.squared >= 0))

    def shape(self, component: Component, name: str) -> Array:
        """Shapes (k, size) in one field of a component."""
        f = self.system.field(component, name)
        part: Array = self.shapes[:, f.start : f.start + f.size]
        return part

    def leader(self, k: int) -> str:
        """The component that moves most in mode `k`, relative to the scales of its unknowns."""
        scale = self.system.scale
        moves = np.abs(self.shapes[k]) / np.where(scale > 0, scale, np.inf)
        return self.system.describe(int(np.argmax(moves)))[0]

    def __str__(self) -> str:
        lines = [" mode   frequency [1/T]   angular [rad/T]   moves most"]
        for k, squared in enumerate(self.squared):
            w = float(np.sqrt(abs(squared)))
            stable = f"{w / (2 * np.pi):18.9g}{w:18.9g}"
            text = stable if squared >= 0 else f"      unstable, grows like exp({w:.6g} t)"
            lines.append(f"{k + 1:5d}{text}   {self.leader(k)}")
        return "\n".join(lines)


def modes(system: System, n: int = 10, *, tolerance: float = 1e-6) -> Modes:
    """Undamped eigenmodes of small vibrations about the present configuration, which must be an equilibrium.

    ``K z = omega^2 M z`` with ``G z = 0``; `K` contains the geometric stiffness of the reactions. Dampers are
    left out, velocities are taken as zero.

    Parameters
    ----------
    n : int
        How many: those of lowest square (in large systems: of squares nearest to zero).
    tolerance : float
        Largest unbalanced force, relative to the largest force.

    Returns
    -------
    Modes
        Squares of the frequencies (negative: unstable) and shapes.

    Raises
    ------
    InputError
        If the configuration is no equilibrium, forces have no potential, or something moves without mass.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> system = vv.System([ground, ball, rod, vv.Gravity(acceleration=(0, 0, -4))])
    >>> vv.modes(system).angular.round(9).tolist()
    [2.0, 2.0]
    """
    from visviva.system import System

    refuse_other("modes", "system", system, System, "a vv.System")
    whole("modes", "n", n)
    positive("modes", "tolerance", tolerance)
    if not len(system.free_unknowns):
        raise InputError(
            "all that moves is held or prescribed: there are no modes; leave something free to move"
        )
    at = Instant(system)
    at.factor()
    balance(system, at, tolerance)
    K = condensed(system.tangent(instant(system.time, theta=1.0))[1], at)
    lack = abs(K - K.T).max() if K.nnz else 0.0
    if lack > 1e-7 * abs(K).max():
        raise InputError(
            f"the stiffness is not symmetric (by {lack:.2g}): follower or other loads without potential "
            "act; modes are defined for conservative systems"
        )
    K = 0.5 * (K + K.T)
    solve = dense_modes if len(at.coordinates) <= DENSE else sparse_modes
    squared, z = solve(at, K, n)
    shapes = np.zeros((len(squared), len(system.x)))
    shapes[:, at.coordinates] = z.T
    return Modes(system, squared, shapes)


def condensed(A: sp.csr_array, at: Instant) -> sp.csr_array:
    """Stiffness of the coordinates, with unknowns of no motion (pressures, enhanced strains) in their equilibrium."""
    import scipy.sparse.linalg as spl

    q, rest = at._q, np.setdiff1d(np.arange(A.shape[0]), np.concatenate([at._q, at._m]))
    element = at.system.local[at.system.free_unknowns[rest]]
    own, rest = rest[element >= 0], rest[element < 0]
    K = A[q][:, q].tocsr()
    if len(own):
        K = K - A[q][:, own] @ (inverse_by_element(A[own][:, own], element[element >= 0]) @ A[own][:, q])
    if len(rest):
        K = K - A[q][:, rest] @ spl.spsolve(A[rest][:, rest].tocsc(), A[rest][:, q].tocsc())
    return K.tocsr()


def inverse_by_element(A: sp.csr_array, element: NDArray[np.int32]) -> sp.csr_array:
    """Inverse of a matrix that couples the unknowns of each element with each other only."""
    import scipy.sparse as sp

    _, first, number, count = np.unique(element, return_index=True, return_inverse=True, return_counts=True)
    place, k = np.arange(len(element)) - first[number], np.arange(count.max())
    blocks = np.tile(np.eye(len(k)), (len(count), 1, 1))  # fillers of smaller ones are identities
    entry = A.tocoo()
    blocks[number, place, place] = 0.0
    blocks[number[entry.row], place[entry.row], place[entry.col]] = entry.data
    row, column = np.broadcast_arrays(first[:, None, None] + k[:, None], first[:, None, None] + k)
    used = np.maximum(k[:, None], k) < count[:, None, None]
    return sp.csr_array((np.linalg.inv(blocks)[used], (row[used], column[used])), shape=A.shape)


def balance(system: System, at: Instant, tolerance: float) -> None:
    """Give the multipliers their static values, or refuse a configuration that is no equilibrium."""
    a, multipliers = accelerations(system, at, still=True)
    pull, carried = at.M @ a, at.G.T @ multipliers
    largest = float(np.abs(carried).max(initial=0.0) + np.abs(pull).max(initial=0.0))
    K = system.tangent(instant(system.time, theta=1.0))[1]
    stiff = (
        float(abs(K).max() * at.scale.max(initial=0.0)) if K.nnz else 0.0
    )  # a mesh at rest has forces of round-off
    noise = 1e-12 * max(typical(at.M.diagonal()), stiff)
    if len(pull) and np.abs(pull).max() > tolerance * largest and largest > noise:
        k = int(np.argmax(np.abs(pull)))
        component, unknown = system.describe(int(at.coordinates[k]))
        raise InputError(
            f"the present configuration is no equilibrium: a force of {pull[k]:.3g} acts on {unknown} of "
            f"{component}; call equilibrium(system) first"
        )
    system.x[at.multipliers] = multipliers
    system.touch()


def dense_modes(at: Instant, K: sp.csr_array, n: int) -> tuple[Array, Array]:
    """All modes in a basis of the constraints' null space, the lowest `n` returned."""

    import scipy.linalg as sla

    q = len(at.coordinates)
    Z = at._s[:q, None] * free_directions(at)
    M, stiffness = Z.T @ (at.M @ Z), Z.T @ (K @ Z)
    if Z.shape[1] == 0:
        return np.zeros(0), np.zeros((q, 0))
    light, direction = np.linalg.eigh(M)
    if light[0] <= 1e-13 * light[-1]:
        system = at.system
        k = int(np.argmax(np.abs(Z @ direction[:, 0]) / at.scale))
        component, unknown = system.describe(int(at.coordinates[k]))
        raise InputError(
            f"{unknown} of {component} moves without mass, its frequency is infinite; give it mass"
        )
    squared, y = sla.eigh(stiffness, M)
    squared[np.abs(squared) < ZERO * np.abs(squared).max()] = 0.0
    return squared[:n], Z @ y[:, :n]


def free_directions(at: Instant) -> Array:
    """Orthonormal directions (n, freedoms) that the scaled constraints allow."""

    import scipy.sparse as sp

    q = len(at.coordinates)
    G = (sp.diags_array(at._s[q:]) @ at.G @ sp.diags_array(at._s[:q])).toarray()
    if len(G) == 0:
        return np.eye(q)
    _, length, V = np.linalg.svd(G)
    return V[int(np.sum(length > REDUNDANT)) :].T.copy()


def sparse_modes(at: Instant, K: sp.csr_array, n: int) -> tuple[Array, Array]:
    """Modes of squares nearest to zero, by inverse iteration with a small shift below zero."""

    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    q, m = len(at.coordinates), len(at.multipliers)
    n = min(n, q - m - 1) if q - m > 1 else 1
    largest = typical(abs(K.diagonal())) / typical(at.M.diagonal())
    shift = -1e-6 * largest  # close to the low modes of thin bodies: few iterations
    A = sp.block_array([[K - shift * at.M, at.G.T], [at.G, sp.csr_array((m, m))]], format="csr")
    s = equilibration(A)
    S = sp.diags_array(s)
    solve = factored(S @ A @ S - sp.diags_array(np.r_[np.zeros(q), np.full(m, COMPLIANCE)]), m, at.system)
    B = sp.block_diag([at.M, sp.csr_array((m, m))], format="csr")
    inverse = spl.LinearOperator(A.shape, matvec=lambda r: s * solve(s * np.ravel(r)), dtype=float)
    start = inverse @ (B @ np.random.default_rng(0).standard_normal(q + m))
    squared, z = spl.eigsh(A, k=n, M=B, sigma=shift, OPinv=inverse, v0=start, which="LM")
    squared[np.abs(squared) < ZERO * largest] = 0.0
    order = np.argsort(squared)
    return squared[order], z[:q, order]


def factored(A: sp.csr_array, n_constraints: int, system: System) -> Callable[[Array], Array]:
    """The inverse of a symmetric matrix, by the factors that the system's options name; constraints come last.

    Raises
    ------
    InputError
        If the factors are estimated to need more memory than there is, or the matrix is singular.
    """
    A = A.tocsr()
    A.sort_indices()
    n = A.shape[0]
    constraint = np.r_[np.zeros(n - n_constraints, np.int32), np.ones(n_constraints, np.int32)]
    options = system.newton.linear if isinstance(system.newton.linear, Direct) else Direct()
    problem = Problem(n, A.nnz, symmetric=True, definite=True, n_multipliers=n_constraints)
    choices, none = list(options.choose(problem).in_order), np.zeros(0)
    row, col = A.indptr.astype(np.int64), A.indices.astype(np.int32)
    try:
        linear = _core.Linear(choices, row, col, none.astype(np.int32), none, constraint)
        done = linear.factor(A.data)
    except MemoryError as error:
        raise InputError(f"modes: {error}") from error
    if not done:
        raise InputError(f"modes: {linear.message}")

    def solve(r: Array) -> Array:
        x = np.zeros(n)
        linear.solve(np.ascontiguousarray(r), x)
        return x

    return solve
