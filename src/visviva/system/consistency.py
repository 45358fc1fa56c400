"""Consistent states: positions and velocities on the constraints, accelerations and multipliers of a state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.system.actuated import Actuated, open_parts
from visviva.system.floating import displaced_mass, impulse_at_start
from visviva.system.instant import COMPLIANCE, Instant, instant
from visviva.system.memory import returning

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme, Table
    from visviva.system.system import System

Array = NDArray[np.float64]

NOTHING: NDArray[np.int32] = np.zeros(0, dtype=np.int32)
ROUND_OFF = 4e-15
"""Relative violation below which a constraint holds."""


@dataclass
class Correction:
    """Sizes of the motion by a projection.

    Attributes
    ----------
    before, after : float
        Largest relative violation of a constraint.
    moved : dict of str to float
        Largest change of an unknown (or rate), by component; in the units of the unknowns.
    """

    before: float
    after: float
    moved: dict[str, float]

    def __str__(self) -> str:
        if not self.moved:
            return f"consistent to {self.before:.1e}"
        largest = sorted(self.moved.items(), key=lambda item: -item[1])
        listed = ", ".join(f"{label} by {size:.3g}" for label, size in largest[:6])
        more = f" and {len(largest) - 6} more" if len(largest) > 6 else ""
        return f"violated by {self.before:.1e}, corrected to {self.after:.1e}: moved {listed}{more}"


def moved(system: System, change: Array) -> dict[str, float]:
    """Largest change of each component that changed by more than rounding."""
    sizes: dict[str, float] = {}
    noise = 1e-12 * float(np.abs(change).max(initial=0.0))
    for f in system.model.fields:
        if f.order > 0:
            size = float(np.abs(change[f.start : f.start + f.size]).max(initial=0.0))
            if size > noise:
                sizes[f.component.label] = max(size, sizes.get(f.component.label, 0.0))
    return sizes


def project_positions(system: System, at: Instant | None = None) -> Correction:
    """Move the configuration onto the constraints, as little as possible in the metric of mass.

    Gauss-Newton steps; where redundant constraints spoil them, damped ones.

    Returns
    -------
    Correction
        How far each component was moved; nothing is touched where the constraints hold to round-off.

    Raises
    ------
    InputError
        If no configuration satisfies the constraints; it names those that remain violated.
    """
    at = Instant(system) if at is None else at
    start = system.x.copy()
    first = worst(at)
    if first <= ROUND_OFF:
        return Correction(first, first, {})
    last = first
    for damped in (False, True):
        system.x[:] = start
        last = descend(system, damped)
        if last <= 1e-11:
            break
    else:
        message = contradiction(system)
        system.x[:] = start
        system.invalidate()
        raise InputError(message)
    system.invalidate()
    return Correction(first, last, moved(system, system.x - start))


def worst(at: Instant) -> float:
    """Largest relative violation."""
    size = float(np.abs(at.violation() / at.reach).max(initial=0.0))
    return size if np.isfinite(size) else np.inf


def descend(system: System, damped: bool) -> float:
    """Take Gauss-Newton steps until the violation no longer shrinks; returns what is left."""
    best, kept, stalled = np.inf, system.x.copy(), 0
    with returning(system):
        for _ in range(60 if damped else 25):
            at = Instant(system)
            size = worst(at)
            if size < 0.5 * best:
                stalled = 0
            elif stalled >= (12 if damped else 4) or best < 1e-13:
                break
            stalled += 1
            if size < best:
                best, kept = size, system.x.copy()
            if size <= ROUND_OFF / 4 or not np.isfinite(size):
                break
            at.factor(max(COMPLIANCE, 0.1 * size) if damped else COMPLIANCE)
            phi, zero = at.violation(), np.zeros(len(at.coordinates))
            step = at.soft(zero, -phi)[: len(zero)] if damped else at.solve(zero, -phi)[0]
            longest = float(np.abs(step / at.scale).max(initial=0.0))
            system.x[at.coordinates] += step * min(1.0, 0.5 / longest if longest > 0 else 1.0)
    system.x[:] = kept
    return best


def contradiction(system: System) -> str:
    """Names the constraints that remain violated at the present state."""
    at = Instant(system)
    relative = np.abs(at.violation() / at.reach)
    rigidity = {u for f in system.model.fields if f.multiplier and f.stage == 0 for u in f.unknowns}
    of_body = np.array([int(u) in rigidity for u in at.multipliers])
    if np.any(relative[~of_body] > 0.05 * relative.max()):
        relative[of_body] = 0.0  # bodies bend only because their joints pull
    named = []
    for k in np.argsort(-relative)[:4]:
        if relative[k] > 0.05 * relative.max():
            component, unknown = system.describe(int(at.multipliers[k]))
            named.append(f"{unknown} of {component} by {at.violation()[k]:.3g}")
    return (
        f"no configuration satisfies all constraints: violated remain {', '.join(named)} at the nearest "
        "configuration found. Correct the places, axes or lengths of these joints or of bodies they join, "
        "or start closer to a configuration that fits"
    )


def project_velocities(system: System, at: Instant | None = None) -> Correction:
    """Make the velocities satisfy the constraints' time derivatives, changed as little as possible in kinetic
    energy; `at` is factored.

    Raises
    ------
    InputError
        If no velocities do (a motion is prescribed that the joints do not allow); it names the constraints.
    """
    if at is None:
        at = Instant(system)
        at.factor()
    if len(at.multipliers) == 0:
        return Correction(0.0, 0.0, {})
    v = system.v[at.coordinates].copy()
    drift = at.drift()
    defect = at.G @ v + drift
    reach = rate_reach(system, at, drift)
    before = float(np.abs(defect / reach).max(initial=0.0))
    if before <= ROUND_OFF:
        return Correction(before, before, {})
    change, _ = at.solve(np.zeros(len(v)), -defect)
    system.v[at.coordinates] = v + change
    rest = at.G @ (v + change) + drift
    reach = np.maximum(reach, rate_reach(system, at, drift))  # things may start here, or stop
    relative = np.abs(rest) / reach
    after = float(relative.max(initial=0.0))
    if after > 1e-9:
        k = int(np.argmax(relative))
        component, unknown = system.describe(int(at.multipliers[k]))
        system.v[at.coordinates] = v
        raise InputError(
            f"no velocities satisfy all constraints in the initial state: {unknown} of {component} "
            f"stays violated at the rate {rest[k]:.3g}. Check prescribed motions against what joints allow"
        )
    system.invalidate()
    full = np.zeros(len(system.x))
    full[at.coordinates] = change
    return Correction(before, after, moved(system, full))


def rate_violation(system: System, at: Instant) -> float:
    """Largest relative violation of the constraints' rates."""
    v, drift = system.v[at.coordinates], at.drift()
    return float(np.abs((at.G @ v + drift) / rate_reach(system, at, drift)).max(initial=0.0))


def rate_reach(system: System, at: Instant, drift: Array) -> Array:
    """Scale of the rates (m,) of constraints: their gradients times the speeds of the fastest unknowns.

    Unknowns of one role compare by their scales; so no unit of time counts, and what rests beside what moves may have
    the round-off of that. Where nothing moves, rates are measured by those that round-off of positions makes in a step.
    """
    relative, fastest = np.abs(system.v) * system.inverse_scale, np.zeros(len(system.x))
    fields = [f for f in system.model.fields if f.order > 0]
    for role in {f.role for f in fields}:
        unknowns = np.concatenate([f.unknowns for f in fields if f.role is role])
        fastest[unknowns] = relative[unknowns].max(initial=0.0)
    speed = (fastest * system.scale)[at.coordinates]
    least = ROUND_OFF * at.reach / at.moment
    reach: Array = np.maximum(abs(at.G) @ speed + np.abs(drift), least)
    return reach


def follow_branch(system: System, at: Instant, null: Array) -> dict[str, float]:
    """In a singular position, turn velocities that lead nowhere into those of a motion close by.

    Where constraints are redundant for an instant only (bars in one line), more velocities satisfy their rates
    than motions have: accelerations exist only if ``null^T (G' v) v`` vanishes for the combinations `null`
    (m, r) of constraints without effect. Newton steps keep ``G v`` and are least in kinetic energy. Where they
    find nothing (the mechanism is locked, or an impact is due) the velocities stay as they are.

    Returns
    -------
    dict of str to float
        Largest change of a rate by component.
    """
    coordinates, start = at.coordinates, system.v.copy()
    bound = rate_violation(system, at) + 1e-9
    for _ in range(20):
        c = at.convection()
        rest = null.T @ c
        if np.all(np.abs(rest) <= 1e-7 * (np.abs(null).T @ np.abs(c))):
            break
        J = 2 * at.bend(null)
        still = np.zeros(len(at.multipliers))
        ways = np.column_stack([at.solve(column, still)[0] for column in J.T])
        system.v[coordinates] -= ways @ np.linalg.lstsq(J.T @ ways, rest, rcond=1e-9)[0]
        if rate_violation(system, at) > bound:
            system.v[:] = start
            break
    else:
        system.v[:] = start
    system.invalidate()
    return moved(system, system.v - start)


# --- accelerations ------------------------------------------------------------------------------------------


def accelerations(system: System, at: Instant, still: bool = False) -> tuple[Array, Array]:
    """Accelerations (n,) and multipliers (m,) of the present state; `still` leaves the velocities out."""
    return at.solve_consistent(*unbalanced(system, at, still))


def unbalanced(system: System, at: Instant, still: bool = False) -> tuple[Array, Array]:
    """What accelerations and multipliers have to balance: forces (n,), and second rates (m,) of constraints."""
    with returning(system):
        system.x[at.multipliers] = 0.0
        force = system.residual(instant(system.time, theta=1.0, rates=not still))[at.coordinates]
        if system.model.driving.prescribed and not still:
            force = force + at.prescribed_inertia()
    right = np.zeros(len(at.multipliers)) if still else np.concatenate([-at.convection(), at.added])
    return -force, right


def initial_acceleration(system: System, scheme: Scheme, h: float, at: Actuated | None = None) -> None:
    """Fill the history of schemes that start from accelerations, and the multipliers, consistently.

    Solves ``M a + f(q, v) + G^T lambda = 0`` with ``G a = -(G' v) v - ...``, parts prescribed in time
    included. Acceleration-like variables stand for another moment than their step's end, see `Scheme.history_at`.
    """
    if at is None:
        at = Actuated(system)
        at.add_rate_constraints()
        at.factor()
    a, multipliers = accelerations(system, at)
    histories = (system.core.a, system.core.w)
    for history in histories:
        history[:] = at.prescribed_acceleration()
        history[at.coordinates] = a
    system.x[at.multipliers] = multipliers
    left = open_parts(system) if at.is_open else NOTHING
    for history, offset in zip(histories, scheme.history_at, strict=True):
        if offset and len(at.multipliers):
            history[:] = accelerations_later(system, history, offset * h, left)
    system.invalidate()
    system.stepper.has_acceleration = True


def restart_motion(system: System, scheme: Scheme, h: float, left: NDArray[np.int32]) -> None:
    """A new history of motion by the accelerations of this instant; what is of first order goes on with its own, and so
    do these unknowns, which are `left` to the scheme."""
    histories, others = (system.core.a, system.core.w), system.order != 2
    others[left] = True
    kept, x = [history[others] for history in histories], system.x[left]
    initial_acceleration(system, scheme, h)
    system.x[left] = x
    for history, values in zip(histories, kept, strict=True):
        history[others] = values


def accelerations_later(system: System, now: Array, time: float, left: NDArray[np.int32] = NOTHING) -> Array:
    """Accelerations (n,) of the motion a `time` from now; those of now where they change too much for that.

    Where they do (stiff solids in long steps) they are not resolved by the steps anyway. Unknowns that are `left` keep
    those of now.
    """
    later, moves, flows = now.copy(), system.order == 2, system.order == 1
    known = moves.copy()
    known[left] = False
    with returning(system):
        system.x[flows] += time * now[flows]
        system.x[moves] += time * system.v[moves] + 0.5 * time**2 * now[moves]
        system.v[moves] += time * now[moves]
        system.time += time
        for p in system.model.driving.prescribed:
            system.x[p.unknowns], system.v[p.unknowns] = (
                p.values(system.time),
                p.rates(system.time, system.clock.step),
            )
        at = Actuated(system)
        at.add_rate_constraints()
        at.factor()
        of_motion = known[at.coordinates]
        later[at.coordinates[of_motion]] = accelerations(system, at)[0][of_motion]
    change, size = (float(np.linalg.norm(u * system.inverse_scale)) for u in (later - now, now))
    return later if change < 0.5 * size else now


def project_step(system: System, step: Any, table: Table, x0: Array, trial: Array) -> Array:
    """Rates at the end of a step on the constraints; what `cpp/visviva/system/rates.cpp` does, for systems of any kind.

    Parameters
    ----------
    step : Step
        The step; its solution was `trial`.
    table : table
        The scheme's table of motion.
    x0, trial : array (n,)
        Unknowns at its start and as solved.

    Returns
    -------
    array
        Work of what is driven by functions of time as the rates change, of each of ``system.model.driving.working``.
    """
    at, rates_alone = Actuated(system), not np.any(table[3])
    if not rates_alone:  # flows keep what the scheme remembers of them
        at.keep(at.of_motion)
    impulse = np.zeros(len(at.coordinates))
    if step.theta_g == 0.0:
        impulse = impulse_at_start(system, at, step, table, x0, trial)
    at.M = at.M + displaced_mass(system)[at.coordinates][:, at.coordinates]
    if rates_alone:
        at.factor()
    else:
        at.keep_reached()
    before = system.v[at.coordinates].copy()
    # the change alone: rates that have no mass stay as they are
    change, mu = at.solve_consistent(impulse, -at.drift() - at.G @ before)
    after = before + change
    if rates_alone:
        system.v[at.coordinates] = after
        return drive_works(system, at, step, x0, trial, mu, 0.5 * (before + after))
    moves = system.order[at.coordinates] == 2
    change, coordinates = (after - before)[moves], at.coordinates[moves]
    for history, row in ((system.v, 2), (system.core.a, 3), (system.core.w, 4)):
        history[coordinates] += table[row][0] / table[2][0] * change
    change_of_multipliers = table[1][0] / table[2][0] * mu
    system.x[at.multipliers] += change_of_multipliers
    # work is booked with the mean of the forces at both ends of the step
    work = -0.5 * change_of_multipliers * (at.columns.T @ (trial - x0)[at.coordinates])
    of = {int(u): float(w) for u, w in zip(at.multipliers, work, strict=True)}
    return np.array([of.get(u, 0.0) for u, _ in system.model.driving.working])


def driven_rows(system: System, at: Instant) -> NDArray[np.int64]:
    """Among the multipliers, those of what functions of time drive."""
    drives = [u for u, _ in system.model.driving.working]
    return np.array([int(np.flatnonzero(at.multipliers == u)[0]) for u in drives], dtype=np.int64)


def drive_works(
    system: System, at: Instant, step: Any, x0: Array, trial: Array, mu: Array, mean: Array
) -> Array:
    """Work of each drive by its share of the impulses of a projection, along the `mean` of the rates."""
    rows = driven_rows(system, at)
    if not len(rows):
        return np.zeros(0)
    work: Array = -mu[rows] * (at.columns.T @ mean)[rows]
    if step.theta_g == 0.0:
        with returning(system):
            system.x[:] = x0
            start = Actuated(system)
        work += 0.5 * step.h * trial[at.multipliers[rows]] * (start.columns.T @ mean)[rows]
    return work
