"""Eigenmodes of small vibrations about an equilibrium."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.arguments import positive, refuse_other, whole
from visviva.base.errors import InputError
from visviva.linear.choice import Direct, Problem
from visviva.system.consistency import accelerations
from visviva.system.instant import COMPLIANCE, REDUNDANT, Instant, instant
from visviva.system.scaling import by_weight, equilibration, typical
from visviva.system.stability import bears

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.component.component import Component
    from visviva.system.system import System

Array = NDArray[np.float64]

DENSE = 600
"""Up to this many coordinates all modes are computed at once."""
ZERO = 1e-11
"""Squares of frequencies smaller than this part of the largest are round-off."""
WEIGHTLESS = 1e-13
"""A direction weighs nothing with so little of what its coordinates weigh."""
UNSYMMETRIC = 1e-7
"""Difference of the stiffness from its transpose, relative to its rows, from which on forces have no potential."""
STIFF = 1e-12
"""Compliances smaller than this, beside that of all else, are those of constraints."""


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

    ``K z = omega^2 M z`` with ``G z = 0``; `K` contains the geometric stiffness of the reactions, of prestress and of
    dead loads.

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
        If the configuration is no equilibrium, or something in it has no undamped modes; the message names it.

    Notes
    -----
    Supported are bodies, joints, springs, solids of every formulation, incompressible ones among them, ties and dead
    loads. Dampers are left out, velocities are taken as zero, prescribed motions and loads keep their present values.

    Contact counts as it is: gaps closed by multipliers are constraints, those of a penalty springs, open ones nothing.
    Friction that sticks holds along the surface, by constraints or by its tangential stiffness. Fibres that only pull
    have the stiffness of one side where they are just slack.

    Refused, by name, are fluids, heat and what else is of first order in time, with all that is immersed; forces
    without potential (follower loads, torques about fixed axes on bodies free to turn, servos, friction that slips or
    whose sticking tractions make the stiffness unsymmetric); surfaces that touch without pressure; motion without
    mass.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> system = vv.System([ground, ball, rod, vv.Gravity(acceleration=(0, 0, -4))])
    >>> vv.modes(system).angular.round(9).tolist()
    [2.0, 2.0]
    """
    from visviva.system.system import System

    refuse_other("modes", "system", system, System, "a vv.System")
    whole("modes", "n", n)
    positive("modes", "tolerance", tolerance)
    if not len(system.free_unknowns):
        raise InputError(
            "all that moves is held or prescribed: there are no modes; leave something free to move"
        )
    refuse_first_order(system)
    at = Instant(system)
    at.factor()
    balance(system, at, tolerance)
    linear = linearized(at)
    refuse_lossy(linear)
    solve = dense_modes if len(at.coordinates) <= DENSE else sparse_modes
    squared, z = solve(linear, n)
    shapes = np.zeros((len(squared), len(system.x)))
    shapes[:, at.coordinates] = z.T
    return Modes(system, squared, shapes)


@dataclass
class Linearized:
    """The equations ``K u + B^T p = omega^2 M u``, ``B u + D p = 0`` of coordinates u and forces p.

    Attributes
    ----------
    K : sparse array (n, n)
        Stiffness of the coordinates, what elements have alone (enhanced strains, pressures) being in equilibrium.
    B, D : sparse arrays (p, n), (p, p)
        Of what has no mass: multipliers of constraints and of contact, pressures, tractions. The rows of D vanish for
        constraints, among them closed contacts, and not for pressures of what is compressible or stabilised.
    column : sparse array (n, p)
        How p acts upon u; the transpose of B where forces have a potential.
    unknowns : array of int (p,)
        Of the system; those that stand for forces come last.
    n_forces : int
        How many do.
    """

    at: Instant
    K: sp.csr_array
    B: sp.csr_array
    D: sp.csr_array
    column: sp.csr_array
    unknowns: NDArray[np.int64]
    n_forces: int


def linearized(at: Instant) -> Linearized:
    """The equations about the state of an instant."""
    system, q = at.system, at._q
    A = system.tangent(instant(system.time, theta=1.0))[1]
    element, forces = (of[system.free_unknowns] for of in (system.local, bears(system)))
    rest = np.setdiff1d(np.arange(A.shape[0]), q)
    own = rest[element[rest] >= 0]
    p = rest[element[rest] < 0]
    p = p[np.argsort(forces[p], kind="stable")]
    K = A[q][:, q]
    if len(own):
        K = K - A[q][:, own] @ (inverse_by_element(A[own][:, own], element[own]) @ A[own][:, q])
    B, D, column = A[p][:, q].tocsr(), A[p][:, p].tocsr(), A[q][:, p].tocsr()
    return Linearized(at, K.tocsr(), B, D, column, system.free_unknowns[p], int(forces[p].sum()))


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


def symmetric(A: sp.csr_array) -> sp.csr_array:
    """What of a matrix rounding has not made unsymmetric."""
    return (0.5 * (A + A.T)).tocsr()


def refuse_first_order(system: System) -> None:
    """Refuse what flows or conducts: fields of first order in time decay, they do not vibrate."""
    for f in system.model.fields:
        if f.order == 1 and not np.all(f.fixed):
            raise InputError(
                f"modes: {f.name} of {f.component.label} is of first order in time: it decays or is carried along, and "
                "does not vibrate; leave it out, or simulate the system"
            )


def refuse_lossy(linear: Linearized) -> None:
    """Refuse forces without potential, named by whose they are or by what they act on."""
    system, coordinates = linear.at.system, linear.at.coordinates
    for component in system.components:
        if reason := component.unfit_for_modes():
            raise InputError(f"modes: {component.label}: {reason}")
    pairs = (
        (linear.K, linear.K.T, coordinates),
        (linear.column, linear.B.T, coordinates),
        (linear.D, linear.D.T, linear.unknowns),
    )
    for A, B, unknowns in pairs:
        if not A.nnz + B.nnz:
            continue
        size = abs(A).max(axis=1).toarray().ravel(), abs(B).max(axis=0).toarray().ravel()
        lack = abs(A - B).tocoo()
        lack.data /= np.maximum(size[0][lack.row], size[1][lack.col]) + 1e-300
        if lack.data.max(initial=0.0) > UNSYMMETRIC:
            k = int(np.argmax(lack.data))
            owner, unknown = system.describe(int(unknowns[lack.row[k]]))
            raise InputError(
                f"modes: the stiffness of {unknown} of {owner} is not symmetric (by {lack.data[k]:.1g} of it): "
                "follower loads, servos, friction that sticks under load (tie the surfaces instead) or other forces "
                "without potential act; modes are defined for conservative systems"
            )


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


def dense_modes(linear: Linearized, n: int) -> tuple[Array, Array]:
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
        return np.zeros(0), np.zeros((q, 0))
    M = Z.T @ (at.M @ Z)
    light, direction = np.linalg.eigh(M)
    if light[0] <= WEIGHTLESS:
        raise massless(at, int(np.argmax(np.abs(Z @ direction[:, 0]) / at.scale)))
    squared, y = sla.eigh(free.T @ K @ free, M)
    rounding = 4 * np.finfo(float).eps * np.abs(K).sum(axis=1).max()
    squared[np.abs(squared) < max(ZERO * np.abs(squared).max(), rounding)] = 0.0
    return squared[:n], Z @ y[:, :n]


def massless(at: Instant, k: int) -> InputError:
    """The refusal of a coordinate that moves without mass."""
    component, unknown = at.system.describe(int(at.coordinates[k]))
    return InputError(f"{unknown} of {component} moves without mass, its frequency is infinite; give it mass")


def without_forces(K: Array, B: Array, D: Array) -> tuple[Array, Array]:
    """Stiffness (n, n) with the forces ``p = -D^-1 B u`` in it, and the rows (r, n) that vanish instead.

    Combinations of forces that D gives no compliance, beside that of K, are those of constraints.
    """
    if len(B) == 0:
        return K, B
    size = np.abs(B).max(axis=1)
    r = 1 / np.where(size > 0, size, np.sqrt(np.abs(D.diagonal())) + (size == 0))
    compliance, V = np.linalg.eigh(0.5 * r[:, None] * (D + D.T) * r)
    B = V.T @ (r[:, None] * B)
    largest = np.abs(compliance).max()
    held = np.abs(compliance) * max(np.abs(K).max(), 1 / largest if largest > 0 else 0.0) <= STIFF
    soft = B[~held]
    return K - soft.T @ (soft / compliance[~held, None]), B[held]


def free_directions(rows: Array) -> Array:
    """Orthonormal directions (n, freedoms) that rows of constraints allow."""
    if len(rows) == 0:
        return np.eye(rows.shape[1])
    _, length, V = np.linalg.svd(rows)
    return V[int(np.sum(length > REDUNDANT)) :].T.copy()


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
    shift = -1e-6 * largest  # close to the low modes of thin bodies: few iterations
    A = sp.block_array([[K - shift * at.M, linear.B.T], [linear.B, symmetric(linear.D)]], format="csr")
    s = equilibration(A, np.concatenate([at.scale, at.system.scale[linear.unknowns]]))
    S = sp.diags_array(s)
    soft = np.r_[np.zeros(q + p - linear.n_forces), np.full(linear.n_forces, COMPLIANCE)]
    unknowns = np.concatenate([at.coordinates, linear.unknowns])
    solve = factored(S @ A @ S - sp.diags_array(soft), linear.n_forces, at.system, unknowns)
    B = sp.block_diag([at.M, sp.csr_array((p, p))], format="csr")
    inverse = spl.LinearOperator(A.shape, matvec=lambda r: s * solve(s * np.ravel(r)), dtype=float)
    start = inverse @ (B @ np.random.default_rng(0).standard_normal(q + p))
    squared, z = spl.eigsh(A, k=n, M=B, sigma=shift, OPinv=inverse, v0=start, which="LM")
    squared[np.abs(squared) < ZERO * largest] = 0.0
    order = np.argsort(squared)
    return squared[order], z[:q, order]


def loosest(A: sp.csr_array) -> int:
    """The row that moves most in what a singular symmetric matrix leaves free."""
    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    lu = spl.splu((A + 1e-10 * sp.eye_array(A.shape[0])).tocsc())
    z = np.random.default_rng(0).standard_normal(A.shape[0])
    for _ in range(3):
        z = lu.solve(z / np.linalg.norm(z))
    return int(np.argmax(np.abs(z)))


def factored(
    A: sp.csr_array, n_constraints: int, system: System, unknowns: NDArray[np.int64]
) -> Callable[[Array], Array]:
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
        component, unknown = system.describe(int(unknowns[loosest(A)]))
        raise InputError(
            f"modes: the equations are singular: nothing determines {unknown} of {component}; hold it, or give it mass"
        )

    def solve(r: Array) -> Array:
        x = np.zeros(n)
        linear.solve(np.ascontiguousarray(r), x)
        return x

    return solve
