"""Behind kinks of what functions of time drive: rates that turn at once, the work of that, new histories of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.system.instant import inertia, instant
from visviva.system.memory import returning

if TYPE_CHECKING:
    from visviva.base.timefunction import TimeFunction
    from visviva.model.field import Prescription
    from visviva.scheme.schemes import Scheme
    from visviva.system.actuated import Actuated
    from visviva.system.system import System

Array = NDArray[np.float64]

FOLLOWS = 1e-9
"""Part of the rates of what is driven that may be left where nothing follows it."""


@dataclass(frozen=True)
class Before:
    """What is known before a step.

    Attributes
    ----------
    places : array
        Positions of what is moved by means.
    passed : float
        Up to when kinks are passed.
    """

    places: Array
    passed: float

    @staticmethod
    def of(system: System) -> Before:
        return Before(system.x[system.stepper.means], passed(system))


def passed(system: System) -> float:
    """The time up to which kinks are behind the present state, or at it but for rounding."""
    return system.time + system.clock.rounding(system.time)


@dataclass(frozen=True)
class Turn:
    """A change of rates at once.

    Attributes
    ----------
    change : array (n,)
        Of the rates of all unknowns.
    impulses : array (m,)
        Multipliers of the constraints of that moment, by which it comes.
    reached : array of bool (n,)
        Unknowns of the parts that it may turn, by masses, constraints and actuators.
    """

    change: Array
    impulses: Array
    reached: NDArray[np.bool_]

    def __add__(self, other: Turn) -> Turn:
        reached = self.reached | other.reached
        return Turn(self.change + other.change, self.impulses + other.impulses, reached)

    def __rmul__(self, part: float) -> Turn:
        return Turn(part * self.change, part * self.impulses, self.reached)


def follow_kinks(system: System, step: Any, scheme: Scheme, before: Before, bent: set[int]) -> bool:
    """Give what is driven the rates behind a kink of its motion, by impulses whose work is booked.

    Schemes with a history begin a new one there: theirs is that of another motion. Parts in which inputs do not
    accelerate their outputs are left to the scheme. Whether all this could be done.

    Parameters
    ----------
    bent : set of int
        Accounts of what has the kink.
    """
    from visviva.system.actuated import OPEN, Actuated
    from visviva.system.consistency import restart_motion

    stepper, energy, rates = system.stepper, float(system.core.energy.sum()), system.v.copy()
    last, has_rates = stepper.last, stepper.has_rates
    at = Actuated(system)
    at.keep_reached(OPEN)
    if at.is_open or not bent & _reached(at):
        return False
    system.follow_prescribed()
    within = None if scheme.solves_means else astray(at, step, before)
    turned = turn(at, bent, system.v - rates, scheme)
    system.v[at.coordinates] += turned.change[at.coordinates]
    system.invalidate()
    own = works(at, turned, system.v - 0.5 * turned.change)
    work, twice = (own, 0.0 * own) if within is None else works_within(at, turned, within, scheme, step.h)
    if scheme.needs_acceleration:
        reached = turned.reached if within is None else turned.reached | within.mean.reached
        left = np.union1d(at.left, np.flatnonzero(~reached))
        restart_motion(system, scheme, step.h, left.astype(np.int32))
    evaluate_ledger_again(system)
    lacking = float(system.core.energy.sum()) - energy - float(own.sum())
    shares = np.abs(own) if own.any() else np.isin(np.arange(len(own)), list(bent)).astype(float)
    system.core.work[:] += work - twice + lacking * shares / shares.sum()
    stepper.led_by(last)
    stepper.has_rates = has_rates
    return True


def _reached(at: Actuated) -> set[int]:
    """Accounts of what is driven by impulses."""
    driving, multipliers = at.system.model.driving, set(at.multipliers.tolist())
    return {a for u, a in driving.working if u in multipliers} | {p.account for p in driving.prescribed}


def turn(at: Actuated, bent: set[int], change: Array, scheme: Scheme) -> Turn:
    """What turns at once where rates (n,) of prescribed unknowns do, and those of drives that have a kink.

    Others keep what the rates of their constraints are off by, as a step leaves them: that of rotors is no work of a
    drive.
    """
    change = np.where(at.system.order == 2, change, 0.0)
    drift = at.drift(np.zeros(len(at.system.model.driving.signals)), change)
    off = at.G @ at.system.v[at.coordinates] + at.drift()
    own = np.isin(at.multipliers, [u for u, a in at.system.model.driving.working if a in bent])
    if scheme.needs_acceleration and at.system.projects(scheme):  # here, in the place of that of every step
        own[:] = True
    drift[own] = off[own]
    return followed(at, change, drift)


def followed(at: Actuated, change: Array, drift: Array) -> Turn:
    """The impulses by which all else follows a change (n,) of prescribed rates, and the rates (m,) of constraints.

    Raises
    ------
    InputError
        If nothing can follow; it names what is left.
    """
    system = at.system
    pushed = -inertia(system, change)[at.coordinates] if change.any() else np.zeros(len(at.coordinates))
    own, impulses = at.solve_consistent(pushed, -drift)
    left = np.abs(at.G @ own + drift)
    if len(left) and left.max() > FOLLOWS * np.max(abs(at.G) @ np.abs(own) + np.abs(drift)):
        component, unknown = system.describe(int(at.multipliers[np.argmax(left)]))
        raise InputError(
            f"{component}: at the kink of what is driven at the time {system.time:.6g} no velocities satisfy all "
            f"constraints; {unknown} stays violated at the rate {left.max():.3g}. Check prescribed motions against "
            "what joints allow"
        )
    change = change.copy()
    change[at.coordinates] = own
    part = at.parts()
    reached = change != 0
    reached[np.concatenate([at.coordinates, at.multipliers])] = np.isin(
        part, part[np.flatnonzero(np.concatenate([pushed, drift]))]
    )
    return Turn(change, impulses, reached)


@dataclass(frozen=True)
class Within:
    """What kinks within a step have turned.

    Attributes
    ----------
    mean, driven : Turn
        Its mean rates, from those at its start, all of it and by drives alone.
    last : Turn
        The rates at its end, from those at its start, by drives alone.
    """

    mean: Turn
    driven: Turn
    last: Turn


def astray(at: Actuated, step: Any, before: Before) -> Within | None:
    """What kinks within a step have turned; None if there are no kinks but at its end."""
    system, driving = at.system, at.system.model.driving
    begun, end, t0, t1, h = before.passed, step.t1 - system.clock.rounding(step.t1), step.t0, step.t1, step.h
    bent = driving.bent(begun, end)
    if not bent:
        return None

    def led(of: Callable[[TimeFunction], float]) -> Turn:
        still = np.zeros(len(system.x))
        return followed(at, still, at.drift(driving.of_bent(begun, end, of), still))

    def off(p: Prescription) -> Array:
        if p.account not in bent:
            return np.zeros(len(p.unknowns))
        return np.asarray((p.values(t1) - p.values(t0)) / h - p.rates(t0, h))

    driven = led(lambda f: (f(t1) - f(t0)) / h - f.rate_after(t0, h))
    change = np.where(system.order == 2, at.prescribed(off), 0.0)
    moved = followed(at, change, at.drift(np.zeros(len(driving.signals)), change))
    return Within(driven + moved, driven, led(lambda f: f.rate_after(t1, h) - f.rate_after(t0, h)))


def works_within(at: Actuated, turned: Turn, within: Within, scheme: Scheme, h: float) -> tuple[Array, Array]:
    """Work of the impulses at kinks within a step, and of them what multipliers have done in it already; by account.

    The rates with which a step across a kink ends have turned by a part of what the scheme makes of its mean rates, and
    its forces are those of that. Where the core projects them, by drives they have turned whole, and by forces of that.
    """
    system, table = at.system, scheme.motion(h)
    after = system.v
    part, force = h * table[2][0], h * table[1][0]
    whole, done = turned + part * within.mean, force * within.mean
    if scheme.needs_acceleration and scheme.projects_velocity and system.core.projects_rates:
        rest = within.last + -part * within.driven
        whole, done = whole + rest, done + force / part * rest
    # of schemes with accelerations forces at the end of a step are half of those along it
    done = (0.5 if scheme.needs_acceleration else 1.0) * h * done
    mean = after - whole.change + within.mean.change
    return works(at, whole, after - 0.5 * whole.change), works(at, done, mean)


def works(at: Actuated, turned: Turn, rates: Array) -> Array:
    """Work of what is driven, by account, as its impulses act along these rates (n,)."""
    driving, core = at.system.model.driving, at.system.core
    work, of = np.zeros(len(core.work)), {int(u): k for k, u in enumerate(at.multipliers)}
    along = at.columns.T @ rates[at.coordinates]
    for u, account in driving.working:
        if (k := of.get(u)) is not None:
            work[account] -= turned.impulses[k] * along[k]
    if driving.prescribed:
        borne = _borne(at, turned)
        for p in driving.prescribed:
            work[p.account] += borne[p.unknowns] @ rates[p.unknowns]
    return work


def _borne(at: Actuated, turned: Turn) -> Array:
    """Impulses (n,) by which all that is held takes part."""
    system, step = at.system, instant(at.system.time)
    with returning(system):
        system.x[at.multipliers] = 0.0
        rest = system.residual(step).copy()
        system.x[at.multipliers] = turned.impulses
        forces = system.residual(step) - rest
    return np.where(system.order == 2, forces + inertia(system, turned.change), 0.0)


def evaluate_ledger_again(system: System) -> None:
    """The sums of the state after its rates were changed, as the step leaves it; what the step has brought stays."""
    core = system.core
    core.mark_state()
    brought = [(of_step, of_step.copy()) for of_step in (core.work, core.entropy, core.release)]
    system.evaluate_ledger()
    for of_step, before in brought:
        of_step[:] = before
