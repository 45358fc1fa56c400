"""Unknowns without rates at the start, which follow from the others: rates of contents follow from them in turn.

With pressures or potentials that are not those of the state given, forces and energies at the start would be wrong, and
schemes that start from rates would start from wrong ones, and be of first order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.model.field import Role
from visviva.system.instant import instant

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 1e-13
"""Relative change that is none."""
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
    if of[Role.STATE]:
        _solve(system, _unknowns(of[Role.STATE]))
    for role in (Role.SOLID_PRESSURE, Role.TEMPERATURE):
        if of[role]:
            find_linear(system, _unknowns(of[role]))
    if of[Role.POTENTIAL]:
        owners = {id(f.component) for f in of[Role.POTENTIAL]}
        if of_motion := [f for f in of[Role.MOTION] if id(f.component) in owners]:
            balance(system, _unknowns(of_motion))
        find_linear(system, _unknowns(of[Role.POTENTIAL]))
    system.invalidate()


def _unknowns(fields: list[Field]) -> Ints:
    return np.concatenate([f.unknowns for f in fields])


def find_linear(system: System, unknowns: Ints) -> None:
    """What equations are linear in that have a mass matrix for them: projections on the mesh of what others make."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import cg

    r, K, at = equations(system, unknowns)
    if not len(at):
        return
    inverse = sp.diags_array(1 / K.diagonal())
    system.x[at] -= cg(K, _tested(K, r), M=inverse, rtol=ROUNDING, maxiter=1000)[0]


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
    _solve(system, free[own | held])


def _solve(system: System, unknowns: Ints) -> None:
    """Solve the equations of these unknowns for them by Newton's method; what is not found stays as it is."""
    from scipy.sparse.linalg import splu

    start = system.x.copy()
    for _ in range(MOST):
        r, K, at = equations(system, unknowns)
        if not len(at):  # all are given, as free strains are
            return
        try:
            change = splu(K.tocsc()).solve(r)
        except RuntimeError:  # singular
            break
        if not np.isfinite(change).all():
            break
        system.x[at] -= change
        if np.all(np.abs(change) <= ROUNDING * np.maximum(system.scale[at], np.abs(system.x[at]).max())):
            return
    system.x[:] = start


def equations(system: System, unknowns: Ints, time: float | None = None) -> tuple[Array, sp.csr_array, Ints]:
    """Residual and tangent of these unknowns alone at an instant, by default now, without rates, and the free ones."""
    r, K = system.tangent(instant(system.time if time is None else time, theta=1.0))
    own = np.isin(system.free_unknowns, unknowns)
    at = system.free_unknowns[own]
    return r[at], K[own][:, own], at
