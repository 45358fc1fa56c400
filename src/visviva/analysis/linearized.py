"""The linear equations of small motions about a state: stiffness, mass, and the rows of what has no mass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.system.growing import growing_unknowns, resting_unknowns
from visviva.system.instant import REDUNDANT, Instant, instant
from visviva.system.local import condensed
from visviva.system.scaling import asymmetry
from visviva.system.stability import BY_DIFFERENCES, bears, lack_of_rounding

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]

STIFF = 1e-12
"""Compliances smaller than this, beside that of all else, are those of constraints."""


@dataclass
class Linearized:
    """The equations ``K u + B^T p = omega^2 M u``, ``B u + D p = 0`` of coordinates u and forces p.

    Damages and what else never shrinks are constant, see `growing_unknowns`.

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


def linearized(at: Instant, step: Any = None) -> Linearized:
    """The equations about the state of an instant, or about the trial state of a load step from there."""
    system, q = at.system, at._q
    A = system.tangent(instant(system.time, theta=1.0) if step is None else step)[1]
    element, forces = system.local[system.free_unknowns], bears(system)[system.free_unknowns]
    rest = np.setdiff1d(np.flatnonzero(~growing_unknowns(system)[system.free_unknowns]), q)
    p = rest[element[rest] < 0]
    p = p[np.argsort(forces[p], kind="stable")]
    A = condensed(A, element)
    K = A[q][:, q]
    B, D, column = A[p][:, q].tocsr(), A[p][:, p].tocsr(), A[q][:, p].tocsr()
    return Linearized(at, K.tocsr(), B, D, column, system.free_unknowns[p], int(forces[p].sum()))


def symmetric(A: sp.csr_array) -> sp.csr_array:
    """Symmetric part of a matrix that is unsymmetric by rounding alone."""
    return (0.5 * (A + A.T)).tocsr()


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


def refuse_first_order(whose: str, system: System) -> None:
    """Refuse what flows or conducts: fields of first order in time decay, they do not vibrate."""
    for f in system.model.fields:
        if f.order == 1 and not np.all(f.fixed):
            raise InputError(
                f"{whose}: {f.name} of {f.component.label} is of first order in time: it decays or is carried along, "
                "and does not vibrate; leave it out, or simulate the system"
            )


def refuse_unfit(whose: str, system: System) -> None:
    """Refuse what does not vibrate linearly about the present state."""
    for component in system.components:
        if reason := component.unfit_for_modes():
            raise InputError(f"{whose}: {component.label}: {reason}")


def refuse_softening(whose: str, system: System) -> None:
    """Refuse damages that grow with the loads, as stiffness then falls, or that follow a history field."""
    rests = resting_unknowns(system)
    for growing in system.model.growing:
        f = growing.field
        if not growing.held:
            raise InputError(
                f"{whose}: {f.name} of {f.component.label} follows a history field, whose forces have no potential; "
                "take irreversibility='active set'"
            )
        if moves := int(np.sum(~rests[f.unknowns] & ~f.fixed)):
            raise InputError(
                f"{whose}: {f.name} of {f.component.label} grows with the loads, at {moves} nodes, and softens it: "
                f"call {whose} before it does, or follow the loads by vv.quasi_static, which tells where the structure "
                "becomes unstable"
            )


def refuse_lossy(whose: str, linear: Linearized) -> None:
    """Refuse forces without potential, named by what they act on."""
    A, unknowns = whole(linear)
    refuse_unsymmetric(whose, linear.at.system, A, unknowns, asymmetry(A))  # friction that sticks is within


def whole(linear: Linearized) -> tuple[sp.csr_array, NDArray[np.int64]]:
    """The matrix of coordinates and forces, and whose their rows are."""
    import scipy.sparse as sp

    A = sp.block_array([[linear.K, linear.column], [linear.B, linear.D]], format="csr")
    return A, np.concatenate([linear.at.coordinates, linear.unknowns])


def is_symmetric(linear: Linearized) -> bool:
    """True if the tangent is symmetric: the forces then have a potential."""
    size, _ = asymmetry(whole(linear)[0])
    return size <= lack_of_rounding(linear.at.system)


def refuse_unsymmetric(
    whose: str,
    system: System,
    A: sp.csr_array,
    unknowns: NDArray[np.int64],
    found: tuple[float, int] | None = None,
) -> None:
    """Refuse a matrix (n, n) of forces without potential; `unknowns` (n,) tell whose they are.

    `found` is the most by which entries differ across the diagonal and the row of one, where not `asymmetry` tells.
    """
    limit = lack_of_rounding(system) if found is None else BY_DIFFERENCES
    size, row = asymmetry(A) if found is None else found
    if size > limit:
        owner, unknown = system.describe(int(unknowns[row]))
        raise InputError(
            f"{whose}: the stiffness of {unknown} of {owner} is not symmetric (by {size:.1g} of it): "
            "follower loads, servos, friction that sticks under load (tie the surfaces instead) or other forces "
            f"without potential act; {whose} asks for conservative systems"
        )
