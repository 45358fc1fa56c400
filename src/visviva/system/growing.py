"""Unknowns without rates that only grow, as damage does: their balance before the first step, and at ends of steps.

Either such an unknown rests or its equation holds. Schemes that ask for that in the middle of a step alone take what
begins out of balance twice as far, whatever the step's length: energy that is conserved leaves it nowhere else to go.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, RunError
from visviva.base.world import announce
from visviva.system.algebraic import equations
from visviva.system.instant import instant
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
CLEAR = 0.5
"""Part of the first within which residuals alone tell of balance: terms like masses, of the wrong sign between
neighbours, let some be farther from it."""
ROUNDING, ROUGH = 1e-13, 1e-4
"""Accuracy of balances that are taken, and of those that are looked at."""
MOVED = 1e-9
"""Part of its size from which on a move is told."""
LITTLE = 1e-12
"""Part of the largest forces that presses nothing: signs of rounding would let it move and rest by turns."""
BALANCED = 1e-2
"""Growth, in sizes of the unknown, up to which damages are in balance: what goes to and fro finds them no better."""
NEAR, LEAST, HALVES = 1e-6, 1e-4, 40
"""What is so near to its limit, and pressed to it, goes there; energy falls by this part at least of what its slope
says, or steps are halved, so often."""
MOST, WAITS = 1000, 4
"""Choices of what rests; so many spread by a layer of nodes each, then by twice as many layers each time."""


def bring_into_balance(system: System) -> None:
    """Let grow what is out of balance with all other unknowns as they are; what moved stands in the report."""
    fields = _held(system)
    if not fields:
        return
    start = system.x.copy()
    r, K, at = equations(system, np.concatenate([f.unknowns for f in fields]))
    try:
        system.x[at] += change_to_balance(K, r, np.zeros(len(at)), ROUNDING)
    except Lost as reason:
        refused = f"{_named(fields)}: {reason}; give a start nearer to it by damage=, or larger cells"
        raise RunError(refused) from None
    system.invalidate()
    change = np.abs(system.x - start) * system.inverse_scale
    told = [
        f"{f.name} of {f.component.label} by {change[f.unknowns].max():.3g}"
        for f in fields
        if change[f.unknowns].max() > MOVED
    ]
    if told:
        announce(f"initial state brought into balance: {'; '.join(told)}")
        if system.report is not None:
            system.report.moves.extend(told)


def watches(system: System, step: Any) -> bool:
    """Whether a step asks in its middle for the balance of what only grows."""
    return step.theta < 1 and system.has_inertia and bool(_held(system))


def refuse_imbalance(system: System, step: Any) -> None:
    """Fail a solved step at whose end something that grows is out of balance by more than errors of second order."""
    if not watches(system, step):
        return
    fields = _held(system)
    unknowns, dx = np.concatenate([f.unknowns for f in fields]), system.core.dx.copy()
    with undisturbed(system):
        system.core.dx[:] = dx
        if _is_near_balance(system, step, unknowns):
            return
        system.core.dx[:] = dx
        r, K, at = equations(system, unknowns, instant(step.t1, theta=1.0))
    try:
        change = change_to_balance(K, r, dx[at], ROUGH) * system.inverse_scale[at]
    except Lost as reason:
        told = f"{_named(fields)}: {reason} at the end of the step"
        _fail(system, step, told, int(at[np.argmin(r)]))
    beyond, short = int(np.argmin(change)), int(np.argmax(change))
    if -change[beyond] > BEYOND:
        _refuse(system, step, int(at[beyond]), dx, f"{-change[beyond]:.3g} beyond")
    if change[short] > SHORT:
        _refuse(system, step, int(at[short]), dx, f"{change[short]:.3g} short of")


def _is_near_balance(system: System, step: Any, unknowns: Ints) -> bool:
    """Whether residuals alone tell that no limit can be passed; the trial state is another one afterwards.

    Nothing has gone further beyond its balance than it grew in the step. And where all of it would shrink if it were
    larger by the same part of its size, none is short of balance by more.
    """
    at = np.intersect1d(unknowns, system.free_unknowns)
    dx, size = system.core.dx, system.scale[at]
    if (dx[at] > BEYOND * size).any():
        return False
    dx[at] += CLEAR * SHORT * size
    return bool((system.residual(instant(step.t1, theta=1.0))[at] >= 0).all())


def _refuse(system: System, step: Any, unknown: int, dx: Array, how: str) -> None:
    component, name = system.describe(unknown)
    reason = (
        f"{name} of {component} grows by {dx[unknown]:.3g} to {system.x[unknown] + dx[unknown]:.3g}, {how} its balance "
        "at the end of the step: forces balance in its middle. Where a load, a motion or a temperature jumps in time, "
        "that is so at any length of the step: let it rise over several steps, or take vv.BackwardEuler() or "
        "vv.GeneralizedAlpha(), which balance at the end and lose the energy that is then free"
    )
    _fail(system, step, reason, unknown)


def _fail(system: System, step: Any, reason: str, unknown: int) -> NoReturn:
    with Trial(system):
        raise StepFailure(system, system.time, step.h, GivenUp(reason, unknown))


def growing_unknowns(system: System) -> NDArray[np.bool_]:
    """Unknowns (n,) that never shrink: in small vibrations about an equilibrium they are constant.

    What is below its limit rests. What is at it grows in the first swing alone, to where no later one gets.
    """
    return _among(system, [u for growing in system.model.growing for u in growing.field.unknowns])


def resting_unknowns(system: System) -> NDArray[np.bool_]:
    """Unknowns (n,) that rest at the trial state, as they would shrink or are below their limit."""
    return _among(system, system.core.resting)


def _among(system: System, unknowns: list[int]) -> NDArray[np.bool_]:
    found = np.zeros(len(system.x), dtype=bool)
    found[np.array(unknowns, dtype=np.int64)] = True
    return found


def refuse_growth(whose: str, system: System, tolerance: float) -> None:
    """Refuse a state in which something would grow at once, by more than a tolerance: it is no equilibrium."""
    for growing in system.model.growing:
        f = growing.field
        r, K, at = equations(system, np.asarray(f.unknowns))
        try:
            most = float(change_to_balance(K, r, np.zeros(len(at)), ROUGH).max(initial=0.0))
        except Lost as reason:
            raise InputError(f"{whose}: {f.name} of {f.component.label}: {reason}") from None
        if most > max(BALANCED, tolerance):
            raise InputError(
                f"{whose}: the present configuration is no equilibrium: {f.name} of {f.component.label} would grow by "
                f"{most:.3g}; call vv.quasi_static or vv.equilibrium first"
            )


def _held(system: System) -> list[Field]:
    """Fields of which unknowns that would shrink rest."""
    return [growing.field for growing in system.model.growing if growing.held]


def _named(fields: list[Field]) -> str:
    return " and ".join(f"{f.name} of {f.component.label}" for f in fields)


class Lost(Exception):
    """Why a balance is not found."""


def change_to_balance(K: sp.csr_array, r: Array, room: Array, accuracy: float) -> Array:
    """The change z >= -room where ``z . r + z . K z / 2`` is least, by active sets (Hintermueller, Ito & Kunisch 2003).

    `K` (n, n) is symmetric and positive definite for what does not rest; `room` (n,) is by how much each may shrink.
    Choices of what rests that come back, as they may where terms like masses are large, are left for `_descend`.

    Raises
    ------
    Lost
        If it is not found.

    Examples
    --------
    >>> import scipy.sparse as sp
    >>> K = sp.csr_array([[2.0, -1.0], [-1.0, 2.0]])
    >>> change_to_balance(K, np.array([-1.0, 3.0]), np.full(2, 0.25), 1e-13).tolist()
    [0.375, -0.25]
    """
    rests, little = (room <= 0) & (r >= 0), LITTLE * np.abs(r).max(initial=0.0)
    z, advances, seen = np.zeros(len(r)), 0, set[bytes]()
    for _ in range(MOST):
        if rests.tobytes() in seen:
            return _descend(K, r, room, z)
        seen.add(rests.tobytes())
        z = np.where(rests, -room, z)
        _move(K, r, z, ~rests, accuracy)
        held = np.where(rests, r + K @ z >= -little, z < -room)
        if np.array_equal(held, rests):
            return np.maximum(z, -room)
        advances = 0 if (held & ~rests).any() else advances + 1
        rests = _spread(K, held, rests & ~held, advances)
    raise Lost(f"no balance is found in {MOST} choices of what rests")


def _descend(K: sp.csr_array, r: Array, room: Array, z: Array) -> Array:
    """The same by projected Newton steps that each lower the energy (Bertsekas 1982), so that none comes back."""
    z, diagonal = np.maximum(z, -room), K.diagonal()
    for _ in range(MOST):
        pressed = r + K @ z
        off = np.abs(np.maximum(z - pressed / diagonal, -room) - z)
        size = np.abs(r) + abs(K) @ np.abs(z)
        if (diagonal * off <= LITTLE * size.max(initial=0.0)).all():
            return z
        rests = (z <= -room + min(NEAR, off.max())) & (pressed > 0)
        target = z.copy()
        _move(K, r, target, ~rests, ROUNDING)
        way = np.where(rests, -pressed / diagonal, target - z)
        for part in 0.5 ** np.arange(HALVES):
            change = np.maximum(z + part * way, -room) - z
            if change @ pressed + 0.5 * change @ (K @ change) < LEAST * (change @ pressed):
                break
        else:
            break
        z = z + change
    raise Lost(f"no balance is found in {MOST} choices of what rests")


def _move(K: sp.csr_array, r: Array, z: Array, moves: NDArray[np.bool_], accuracy: float) -> None:
    """Bring those that move into balance beside all others, in place."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    own = np.flatnonzero(moves)
    if not len(own):
        return
    A = K[own][:, own]
    inverse = diags_array(1 / A.diagonal())
    right = -(r + K @ np.where(moves, 0.0, z))[own]
    most = max(1000, 10 * len(own))
    z[own], failed = cg(A, right, x0=z[own], M=inverse, rtol=accuracy, maxiter=most)
    if failed:
        raise Lost(f"its {len(own)} equations are not solved by conjugate gradients in {most} iterations")


def _spread(
    K: sp.csr_array, rests: NDArray[np.bool_], front: NDArray[np.bool_], advances: int
) -> NDArray[np.bool_]:
    """What rests, less layers of neighbours of a front that has advanced so often; what went too far comes back."""
    rests, near = rests.copy(), abs(K)
    for _ in range(0 if advances < WAITS else 2 ** (advances - WAITS)):
        front = rests & (near @ front.astype(float) > 0)
        if not front.any():
            break
        rests &= ~front
    return rests
