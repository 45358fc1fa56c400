"""Unknowns without rates that only grow, as damage does: their balance before the first step, and at ends of steps.

Either such an unknown rests or its equation holds. Schemes that ask for that in the middle of a step alone take what
begins out of balance twice as far, whatever the step's length: energy that is conserved leaves it nowhere else to go.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.system.algebraic import equations
from visviva.system.memory import Trial, undisturbed
from visviva.system.newton import GivenUp, StepFailure

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SHORT, BEYOND = 0.1, 0.15
"""Largest distances from balance at the end of a step, in sizes of the unknown. What stays short of it goes as far
beyond it in the next step, so that has to be allowed, with what that step adds."""
ROUNDING, ROUGH = 1e-13, 1e-4
"""Accuracy of balances that are taken, and of those that are looked at."""
MOVED = 1e-9
"""Part of its size from which on a move is told."""
MOST = 200
"""Choices of what rests; cracks that are given spread by a layer of nodes with each."""


def bring_into_balance(system: System) -> None:
    """Let grow what is out of balance with all other unknowns as they are; what moved stands in the report."""
    fields = _held(system)
    if not fields:
        return
    start = system.x.copy()
    r, K, at = equations(system, np.concatenate([f.unknowns for f in fields]))
    system.x[at] += change_to_balance(K, r, np.zeros(len(at)), ROUNDING)
    system.invalidate()
    change = np.abs(system.x - start) * system.inverse_scale
    told = [
        f"{f.name} of {f.component.label} by {change[f.unknowns].max():.3g}"
        for f in fields
        if change[f.unknowns].max() > MOVED
    ]
    if told:
        print(f"initial state brought into balance: {'; '.join(told)}", file=sys.stderr)
        if system.report is not None:
            system.report.moves.extend(told)


def watches(system: System, step: Any) -> bool:
    """Whether a step asks in its middle for the balance of what only grows."""
    return step.theta < 1 and system.has_inertia and bool(_held(system))


def refuse_imbalance(system: System, step: Any) -> None:
    """Fail a solved step at whose end something that grows is out of balance by more than errors of second order."""
    if not watches(system, step):
        return
    dx = system.core.dx.copy()
    with undisturbed(system):
        system.core.dx[:] = dx
        r, K, at = equations(system, np.concatenate([f.unknowns for f in _held(system)]), step.t1)
    change = change_to_balance(K, r, dx[at], ROUGH) * system.inverse_scale[at]
    beyond, short = int(np.argmin(change)), int(np.argmax(change))
    if -change[beyond] > BEYOND:
        _refuse(system, step, int(at[beyond]), dx, f"{-change[beyond]:.3g} beyond")
    if change[short] > SHORT:
        _refuse(system, step, int(at[short]), dx, f"{change[short]:.3g} short of")


def _refuse(system: System, step: Any, unknown: int, dx: Array, how: str) -> None:
    component, name = system.describe(unknown)
    reason = (
        f"{name} of {component} grows by {dx[unknown]:.3g} to {system.x[unknown] + dx[unknown]:.3g}, {how} its balance "
        "at the end of the step: forces balance in its middle. Where a load, a motion or a temperature jumps in time, "
        "that is so at any length of the step: let it rise over several steps, or take vv.BackwardEuler() or "
        "vv.GeneralizedAlpha(), which balance at the end and lose the energy that is then free"
    )
    with Trial(system):
        raise StepFailure(system, system.time, step.h, GivenUp(reason, unknown))


def _held(system: System) -> list[Field]:
    """Fields of which unknowns that would shrink rest."""
    return [growing.field for growing in system.model.growing if growing.held]


def change_to_balance(K: sp.csr_array, r: Array, room: Array, accuracy: float) -> Array:
    """The change z >= -room where ``z . r + z . K z / 2`` is least, by active sets (Hintermueller, Ito & Kunisch 2003).

    `K` (n, n) is symmetric and positive definite for what does not rest; `room` (n,) is by how much each may shrink.

    Examples
    --------
    >>> import scipy.sparse as sp
    >>> K = sp.csr_array([[2.0, -1.0], [-1.0, 2.0]])
    >>> change_to_balance(K, np.array([-1.0, 3.0]), np.full(2, 0.25), 1e-13).tolist()
    [0.375, -0.25]
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    rests = (room <= 0) & (r >= 0)
    z = np.zeros(len(r))
    for _ in range(MOST):
        z = np.where(rests, -room, z)
        moves = np.flatnonzero(~rests)
        if len(moves):
            A = K[moves][:, moves]
            right = -(r + K @ np.where(rests, z, 0.0))[moves]
            inverse = diags_array(1 / A.diagonal())
            z[moves] = cg(A, right, x0=z[moves], M=inverse, rtol=accuracy, maxiter=1000)[0]
        pressed = r + K @ z
        held = np.where(rests, pressed >= 0, z < -room)
        if np.array_equal(held, rests):
            break
        rests = held
    return np.maximum(z, -room)
