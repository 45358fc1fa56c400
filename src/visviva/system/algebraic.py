"""Unknowns without rates at the start, which follow from the others: rates of contents follow from them in turn.

With potentials that are not those of the contents given, schemes that start from rates would start from wrong ones,
and be of first order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.model.field import Role
from visviva.system.instant import instant

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 1e-13
"""Relative change that is none."""
MOST = 25
"""Iterations after which positions without mass stay as they are given."""


def settle(system: System) -> None:
    """Give potentials, and before them positions without mass of what has potentials, the values of this instant.

    Positions without mass are in balance with the contents at every moment, so at the start, too. Where no balance is
    found they stay as given, and the first step looks for one.
    """
    potentials = [f for f in system.model.fields if f.role is Role.POTENTIAL]
    if not potentials:
        return
    owners = {id(f.component) for f in potentials}
    of_motion = [f for f in system.model.fields if f.role is Role.MOTION and id(f.component) in owners]
    if of_motion:
        balance(system, np.concatenate([f.unknowns for f in of_motion]))
    find_potentials(system, np.concatenate([f.unknowns for f in potentials]))
    system.invalidate()


def find_potentials(system: System, unknowns: Ints) -> None:
    """Potentials by their equations, which are linear in them: each that of the contents, projected on the mesh."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import cg

    r, K, at = equations(system, unknowns)
    inverse = sp.diags_array(1 / K.diagonal())
    system.x[at] -= cg(K, r, M=inverse, rtol=ROUNDING, maxiter=1000)[0]


def balance(system: System, unknowns: Ints) -> None:
    """Of these positions move those without mass to where forces are in balance, with what holds them."""
    from scipy.sparse.linalg import splu

    free = system.free_unknowns
    A = system.tangent(instant(system.time, leading=1.0))[1]
    own = np.isin(free, unknowns) & (A.diagonal() == 0)
    if not own.any():
        return
    held = system.is_lasting_constraint[free] & (abs(A) @ own.astype(float) > 0)
    chosen, start = free[own | held], system.x.copy()
    for _ in range(MOST):
        r, K, at = equations(system, chosen)
        try:
            change = splu(K.tocsc()).solve(r)
        except RuntimeError:  # singular
            break
        system.x[at] -= change
        moved = np.abs(change * system.inverse_scale[at]).max()
        if not np.isfinite(moved):
            break
        if moved <= ROUNDING:
            return
    system.x[:] = start


def equations(system: System, unknowns: Ints, time: float | None = None) -> tuple[Array, sp.csr_array, Ints]:
    """Residual and tangent of these unknowns alone at an instant, by default now, without rates, and the free ones."""
    r, K = system.tangent(instant(system.time if time is None else time, theta=1.0))
    own = np.isin(system.free_unknowns, unknowns)
    at = system.free_unknowns[own]
    return r[at], K[own][:, own], at
