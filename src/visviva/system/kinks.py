"""Behind kinks of what functions of time drive: rates that turn at once, the work of that, new histories of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.system.instant import inertia, instant
from visviva.system.memory import returning

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.actuated import Actuated
    from visviva.system.system import System

Array = NDArray[np.float64]

BROUGHT = ("work", "dissipation", "heat")
"""Categories of accounts of what changes energies."""


@dataclass(frozen=True)
class Before:
    """What is known before a step.

    Attributes
    ----------
    places : array
        Positions of what is moved by means.
    passed : float
        Up to when kinks are passed.
    energy : float or None
        Of the system, unless nobody has summed it up or asks for it.
    """

    places: Array
    passed: float
    energy: float | None

    @staticmethod
    def of(system: System) -> Before:
        known = system.model.driving.kinks and not system.is_given
        energy = float(system.core.energy.sum()) if known else None
        return Before(system.x[system.stepper.means], passed(system), energy)


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
    """

    change: Array
    impulses: Array

    def __add__(self, other: Turn) -> Turn:
        return Turn(self.change + other.change, self.impulses + other.impulses)

    def __rmul__(self, part: float) -> Turn:
        return Turn(part * self.change, part * self.impulses)


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
    from visviva.system.consistency import project_velocities, restart_motion

    stepper, energy, rates = system.stepper, float(system.core.energy.sum()), system.v.copy()
    last, has_rates = stepper.last, stepper.has_rates
    at = Actuated(system)
    at.keep_reached(OPEN)
    if at.is_open or not bent & _reached(at):
        return False
    system.follow_prescribed()
    project_velocities(system, at)
    turned, strayed = turn(at, system.v - rates), None if scheme.solves_means else astray(at, step, before)
    work, twice = works_at_kinks(at, turned, strayed, scheme, step.h)
    if scheme.needs_acceleration:
        restart_motion(system, scheme, step.h, at.left)
    evaluate_ledger_again(system)
    system.core.work[:] += work - twice
    if strayed is None:
        lacking = float(system.core.energy.sum()) - energy - float(work.sum())
    else:
        lacking = _lacking(system, before) if not len(at.left) else 0.0
    shares = np.abs(work) if work.any() else np.isin(np.arange(len(work)), list(bent)).astype(float)
    system.core.work[:] += lacking * shares / shares.sum()
    stepper.led_by(last)
    stepper.has_rates = has_rates
    return True


def _reached(at: Actuated) -> set[int]:
    """Accounts of what is driven by impulses."""
    driving, multipliers = at.system.model.driving, set(at.multipliers.tolist())
    return {a for u, a in driving.working if u in multipliers} | {p.account for p in driving.prescribed}


def turn(at: Actuated, change: Array) -> Turn:
    """The change of the rates (n,) of motion with its impulses."""
    change = np.where(at.system.order == 2, change, 0.0)
    free = change[at.coordinates]
    return Turn(change, at.solve(np.zeros(len(free)), at.G @ free)[1])


def astray(at: Actuated, step: Any, before: Before) -> Turn | None:
    """What kinks within a step have turned its mean rates by; None if there are no kinks but at its end."""
    system, driving = at.system, at.system.model.driving
    begun, end = before.passed, step.t1 - system.clock.rounding(step.t1)
    bent = driving.bent(begun, end)
    if not bent:
        return None
    signals = driving.strayed(step.t0, step.t1, begun, end)
    change = at.prescribed(
        lambda p: (
            (p.values(step.t1) - p.values(step.t0)) / step.h - p.rates(step.t0, step.h)
            if p.account in bent
            else np.zeros(len(p.unknowns))
        )
    )
    change[system.order != 2] = 0.0
    drift = at.drift(signals, change)
    change[at.coordinates], impulses = at.solve(np.zeros(len(at.coordinates)), -drift)
    return Turn(change, impulses)


def works_at_kinks(
    at: Actuated, turned: Turn, strayed: Turn | None, scheme: Scheme, h: float
) -> tuple[Array, Array]:
    """Work of the impulses at kinks, and of them what multipliers have done within the step already; by account.

    The rates with which a step across a kink ends have turned by a part of what the scheme makes of its mean rates, and
    its forces are those of that.
    """
    after = at.system.v
    if strayed is None:
        return works(at, turned, after - 0.5 * turned.change), np.zeros(len(at.system.core.work))
    table = scheme.motion(h)
    whole = turned + h * table[2][0] * strayed
    at_ends = (
        0.5 if scheme.needs_acceleration else 1.0
    )  # forces at the end of a step are half of those along it
    mean = after - whole.change + strayed.change
    work = works(at, whole, after - 0.5 * whole.change)
    return work, at_ends * h * h * table[1][0] * works(at, strayed, mean)


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


def _lacking(system: System, before: Before) -> float:
    """What the books of a step across a kink lack, as forces jump within it; nothing where flows have their own."""
    if before.energy is None or np.any(system.order == 1):
        return 0.0
    brought = np.array([a.category in BROUGHT for a in system.model.accounts])
    return float(system.core.energy.sum()) - before.energy - float(system.core.work[brought].sum())


def evaluate_ledger_again(system: System) -> None:
    """The sums of the state after its rates were changed, as the step leaves it; what the step has brought stays."""
    core = system.core
    core.mark_state()
    brought = [(of_step, of_step.copy()) for of_step in (core.work, core.entropy, core.release)]
    system.evaluate_ledger()
    for of_step, before in brought:
        of_step[:] = before
