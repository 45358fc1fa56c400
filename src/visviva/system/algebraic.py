"""Unknowns without rates at the start, which follow from the others: rates of contents follow from them in turn.

With pressures or potentials that are not those of the state given, forces and energies at the start would be wrong, and
schemes that start from rates would start from wrong ones, and be of first order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import RunError
from visviva.base.world import announce
from visviva.model.field import Role
from visviva.system.instant import instant

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING, ROUGH = 1e-13, 1e-9
"""Relative change that is none, and one that is none where it does not get smaller: stiff volumes round more."""
MOST_LINEAR = 1000
"""Iterations for what is linear."""
MOST = 25
"""Iterations after which positions without mass stay as they are given."""


def settle(system: System) -> None:
    """Give what has no rates the values of this instant: what elements add to strains, pressures, potentials.

    Before potentials positions without mass of what has potentials: they are in balance with the contents at every
    moment, so at the start, too. Where no balance is found they stay as given, and the first step looks for one.
    """
    grown = [growing.field for growing in system.model.growing]
    fields = [f for f in system.model.fields if f not in grown]
    of = {role: [f for f in fields if f.role is role] for role in Role}
    _bring_into_balance(system, [f for f in fields if _balances(f)])
    for role in (Role.SOLID_PRESSURE, Role.TEMPERATURE):
        if of[role]:
            find_linear(system, of[role])
    if of[Role.POTENTIAL]:
        owners = {id(f.component) for f in of[Role.POTENTIAL]}
        if of_motion := [f for f in of[Role.MOTION] if id(f.component) in owners]:
            balance(system, _unknowns(of_motion))
        find_linear(system, of[Role.POTENTIAL])
    system.invalidate()


def _balances(f: Field) -> bool:
    """Whether forces balance in it at every moment, so at the start, too: it has no inertia, and no neighbours."""
    return f.role is Role.STATE or (f.role is Role.MOTION and f.stage > 0 and f.is_local)


def _bring_into_balance(system: System, fields: list[Field]) -> None:
    """Balance what each component has of these by itself: where one is not found, that of others is."""
    of: dict[str, list[Field]] = {}
    for f in fields:
        of.setdefault(f.component.label, []).append(f)
    lost = solve_groups(system, [_unknowns(own) for own in of.values()])
    for name, own in (list(of.items())[k] for k in lost):
        told = f"no balance is found of {' and '.join(f.name for f in own)} of {name}, which start as given"
        if system.report is None or told not in system.report.moves:
            announce(f"initial state: {told}")
        if system.report is not None:
            system.report.moves.append(told)


def _unknowns(fields: list[Field]) -> Ints:
    return np.concatenate([f.unknowns for f in fields])


def find_linear(system: System, fields: list[Field]) -> None:
    """What equations are linear in that have a mass matrix for them: projections on the mesh of what others make.

    Raises
    ------
    RunError
        If neither conjugate gradients nor factors find it.
    """
    import scipy.sparse as sp
    from scipy.sparse.linalg import cg

    r, K, at = equations(system, _unknowns(fields))
    if not len(at):
        return
    b, inverse = _tested(K, r), sp.diags_array(1 / K.diagonal())
    change = cg(K, b, M=inverse, rtol=ROUNDING, maxiter=MOST_LINEAR)[0]
    left = _left(K, b, change)
    if not left <= ROUGH:  # stabilised pressures of what is nearly incompressible
        change = _factored(K, b)
        left = _left(K, b, change)
    if not left <= ROUGH:
        names = ", ".join(dict.fromkeys(f"{f.name} of {f.component.label}" for f in fields))
        raise RunError(
            f"initial state: {MOST_LINEAR} iterations and factors do not find {names}, and leave {left:.1e} of the "
            "residual: sizes of its cells, or constants of its material, are out of proportion"
        )
    system.x[at] -= change


def _left(K: sp.csr_array, b: Array, change: Array) -> float:
    """Part of a residual that a solution leaves."""
    return float(np.linalg.norm(b - K @ change) / max(np.linalg.norm(b), np.finfo(float).tiny))


def _factored(K: sp.csr_array, b: Array) -> Array:
    """A solution by factors, improved once; not a number where there are none."""
    from scipy.sparse.linalg import splu

    try:
        factors = splu(K.tocsc())
    except RuntimeError:  # singular
        return np.full(len(b), np.nan)
    found = factors.solve(b)
    return np.asarray(found + factors.solve(b - K @ found))


def _tested(K: sp.csr_array, r: Array) -> Array:
    """Residuals without their means where equations tell differences alone, as of what is incompressible."""
    from scipy.sparse.csgraph import connected_components

    part = connected_components(K, directed=False)[1]
    size = np.bincount(part, abs(K).sum(axis=1))
    means = np.bincount(part, r) / np.bincount(part)
    means[np.abs(np.bincount(part, K.sum(axis=1))) > ROUNDING * size] = 0.0
    return np.asarray(r - means[part])


def balance(system: System, unknowns: Ints) -> None:
    """Of these positions move those without mass to where forces are in balance, with what holds them."""
    free = system.free_unknowns
    A = system.tangent(instant(system.time, leading=1.0))[1]
    own = np.isin(free, unknowns) & (A.diagonal() == 0)
    if not own.any():
        return
    held = system.is_lasting_constraint[free] & (abs(A) @ own.astype(float) > 0)
    solve_groups(system, [free[own | held]])


def solve_groups(system: System, groups: list[Ints], step: Any = None) -> list[int]:
    """Solve the equations of groups of unknowns, which do not see each other, for them by Newton's method.

    They are those of this instant, or of a step, in which all else rests; then the core's ``dx`` is what changes. What
    is not found stays as it is: the numbers of those groups.
    """
    values = system.x if step is None else system.core.dx
    start, left, last = values.copy(), list(range(len(groups))), [np.inf] * len(groups)
    lost: list[int] = []
    for _ in range(MOST):
        if not left:
            break
        r, K, at = equations(system, np.concatenate([groups[k] for k in left]), step)
        for k in list(left):
            own = np.flatnonzero(np.isin(at, groups[k]))
            size = _improve(system, values, K[own][:, own], r[own], at[own])
            if not np.isfinite(size):
                lost.append(k)
            if not np.isfinite(size) or size <= ROUNDING or 0.5 * last[k] <= size <= ROUGH:
                left.remove(k)
            last[k] = size
    lost += left
    for k in lost:
        values[groups[k]] = start[groups[k]]
    return lost


def _improve(system: System, values: Array, K: sp.csr_array, r: Array, at: Ints) -> float:
    """Take an iteration of Newton's method; its largest relative change of what has a scale, or of all if none has."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    if not len(at):  # all are given, as free strains are
        return 0.0
    rows = _sizes(abs(K).max(axis=1))
    K = sp.diags_array(1 / rows) @ K
    columns = _sizes(abs(K).max(axis=0))
    try:
        change = splu((K @ sp.diags_array(1 / columns)).tocsc()).solve(r / rows) / columns
    except RuntimeError:  # singular
        return np.inf
    if not np.isfinite(change).all():
        return np.inf
    scale = system.scale[at]
    seen = scale > 0 if scale.any() else np.ones(len(at), dtype=bool)
    sizes = np.maximum(np.where(seen & (scale > 0), scale, 1.0), np.abs(system.x[at] - change)[seen].max())
    size = float((np.abs(change) / sizes)[seen].max())
    if size > 0.01 * ROUNDING:  # what is in balance stays to the bit
        values[at] -= change
    return size


def _sizes(largest: Any) -> Array:
    """Largest entries (n,) of rows or columns, 1 where there are none."""
    found = np.asarray(largest.toarray()).ravel()
    return np.where(found > 0, found, 1.0)


def equations(system: System, unknowns: Ints, step: Any = None) -> tuple[Array, sp.csr_array, Ints]:
    """Residual and tangent of these unknowns alone in a step, by default now, without rates, and the free ones."""
    r, K = system.tangent(instant(system.time, theta=1.0) if step is None else step)
    own = np.isin(system.free_unknowns, unknowns)
    at = system.free_unknowns[own]
    return r[at], K[own][:, own], at
