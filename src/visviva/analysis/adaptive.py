"""Step sizes that follow the motion: small where it bends, large where it does not."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.functions_in_steps import FunctionsInSteps
from visviva.base.arguments import Validated
from visviva.base.errors import InputError
from visviva.model.field import Role
from visviva.output.checkpoint import Record
from visviva.system.newton import StepFailure
from visviva.system.steps import next_kink

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

Array = NDArray[np.float64]

NAME, VERSION = "adaptive steps", 4
"""Of the record of what the choice of steps carries on."""
ROUNDING = 1e-13
"""Errors below this part of a scale are taken for rounding."""


@dataclass(frozen=True)
class Adaptive(metaclass=Validated):
    """Chooses step sizes by the estimated error of each step.

    The increment of a step is compared with the explicit two-step formula of second order, which differs from
    the scheme's own error by a known factor (Milne's device); a PI controller chooses the next step. Velocities of
    fluids and of what has no mass, of which the midpoint rule and backward Euler know the mean rates of steps, are
    compared over two steps at a time, in which what swings from step to step cancels: no step is short enough to
    resolve that. A step that had to be shortened, since its error was too large or it did not converge, is followed by
    none that is longer.

    Impacts of rigid bodies by multipliers leave no trace in the increment: there twice what the bodies came deeper into
    each other in the step is its error, as the next step may take them as deep again before they turn.

    Steps end at the points of tables. Longer ones than the given step are taken only where expressions and functions of
    time alone are near parabolas: what they do within one would be passed over. Shorter pulses than that, and those of
    functions of time and place, can lie between the ends of two steps; `max_step` should be shorter than them.

    Parameters
    ----------
    tolerance : float
        Error allowed in one step, relative to the scale of each unknown: the length of the model, 1 for directors; of
        what is transported, such as heat or concentrations, the largest change up to now, at least the differences that
        it starts with, what it is given at the start, the distance of phases, or a hundredth of what is uniform.
    min_step, max_step : float
        Bounds; without them 1e-6 and 100 times the given step.
    """

    tolerance: float = 1e-5
    min_step: float | None = None
    max_step: float | None = None

    def __post_init__(self) -> None:
        for what in ("tolerance", "min_step", "max_step"):
            value = getattr(self, what)
            if value is not None and not (value > 0 and np.isfinite(value)):
                raise InputError(f"Adaptive: {what} = {value} is not a positive number")
        if None not in (self.min_step, self.max_step):
            self.bounds(1.0)

    def bounds(self, step: float) -> tuple[float, float]:
        """Shortest and longest step."""
        low = 1e-6 * step if self.min_step is None else self.min_step
        high = 100 * step if self.max_step is None else self.max_step
        if low > high:
            raise InputError(f"Adaptive: min_step = {low} is longer than max_step = {high}")
        return low, high


class _Sizes:
    """By what errors are measured: scales, or of what is transported its largest change from the start up to now.

    Attributes
    ----------
    reached : array (fields,)
        That change of each field that is transported, over its scale.
    """

    def __init__(self, system: System, reached: Array | None) -> None:
        self._fields = [f for f in system.model.fields if f.order == 1]
        self._system, self._fixed = system, np.where(system.order > 0, system.inverse_scale, 0.0)
        self.reached = np.zeros(len(self._fields)) if reached is None else reached

    def after_step(self) -> Array:
        """The changes reached at the end of the step solved last."""
        x, inverse = self._system.x + self._system.core.dx, self._system.inverse_scale
        changes = [np.abs(x[f.unknowns] - f.values) * inverse[f.unknowns] for f in self._fields]
        return np.maximum(self.reached, [float(change.max(initial=0.0)) for change in changes])

    def inverse(self, reached: Array, tolerance: float) -> Array:
        """Inverse of the size (n,) of each unknown; 0 where changes are not judged."""
        found = self._fixed.copy()
        for f, change in zip(self._fields, reached, strict=True):
            found[f.unknowns] /= max(f.least, float(change), ROUNDING / tolerance)
        return found


@dataclass
class _Estimate:
    """The velocities before the last step, that step's length and the length of the one before.

    `means` are the unknowns whose rates are means over the last step, `late` those of them without a rate at the start;
    `first` are the rates at the start of contents that take a first step, in which theirs are means as well.
    """

    means: NDArray[np.bool_]
    late: NDArray[np.int64]
    first: tuple[NDArray[np.bool_], Array] | None = None
    rates: Array | None = None
    length: float = 0.0
    before: float = 0.0

    def error(self, increment: Array, rates: Array, h: float, inverse: Array, tolerance: float) -> float:
        """Estimated error of a step as a multiple of `tolerance`, where unknowns have sizes of this inverse."""
        bend = (increment / h - rates) * inverse  # half of the change of velocity, without history
        if self.rates is None:  # the change of velocity alone, raised to the order of the estimate
            bend[self.late] = 0.0
            if self.first is not None:
                of, start = self.first
                bend[of] = 0.5 * ((start - rates) * inverse)[of]
            return float((np.abs(h * bend).max() / tolerance ** (2 / 3)) ** 1.5)
        L = self.length
        before = 0.5 * h / L * (rates - self.rates) * inverse
        off = h * (bend - before) / (3 * (1 + L / h))
        earlier = (L * rates + self.before * self.rates) / (L + self.before)
        smooth = ((increment + L * rates) / (h + L) - earlier) * inverse
        off[self.means] = h * smooth[self.means] / 12
        return float(np.abs(off).max() / tolerance)


def _estimate(system: System, scheme: Scheme) -> _Estimate:
    """What is known before the first step."""
    has_means, late = np.count_nonzero(scheme.transport(1.0)[2]) == 1, system.stepper.means
    means = has_means & (system.order == 1)
    means[late] = True
    estimate = _Estimate(means, late)
    if scheme.needs_acceleration and not system.stepper.has_rates:
        contents = [np.full(f.size, f.role is Role.CONTENT) for f in system.model.fields]
        estimate.first = (system.order == 1) & np.concatenate(contents), system.core.a.copy()
    return estimate


def adaptive_steps(
    system: System, *, until: float, step: float, scheme: Scheme, rule: Adaptive, halved: int = 0
) -> Iterator[Any]:
    """March to `until` with steps that `rule` chooses, the first `step` `halved` so often; yields reports.

    Shorter than the rule's shortest one are those with which the run so begins, until they have grown.

    ``system.stepper.pace`` carries the next length, the last error, and what the estimate remembers.
    """
    low, high = rule.bounds(step)
    estimate = _estimate(system, scheme)
    h, last, pace = math.ldexp(float(np.clip(step, low, high)), -halved), 1.0, system.stepper.pace
    if NAME in pace:
        h, last, estimate.length, estimate.before = pace[NAME].arrays["steps"].tolist()
        estimate.rates = pace[NAME].arrays["rates"]
    depths = pace[NAME].arrays["depths"] if NAME in pace else overlaps(system)
    sizes = _Sizes(system, pace[NAME].arrays["reached"] if NAME in pace else None)
    least = max(step, low)
    functions = FunctionsInSteps(system, pace[NAME].arrays["functions"] if NAME in pace else None)
    system.clock.refuse_short(until, step, begins=system.stepper.is_given)
    shortened = False
    while not system.clock.has_reached(until):
        left = next_kink(system, until) - system.time
        taken = left if left <= h * (1 + 1e-9) else min(h, 0.5 * left) if left < 2 * h else h
        if functions.are_missed(system.time, taken, least):
            h, shortened = max(0.5 * taken, least), True
            continue
        try:
            attempt = system.attempt(system.stepper.step_of(scheme, taken))
            rates = system.v.copy()
            there = overlaps(system)
            deeper = 2 * float((there - depths).max(initial=0.0)) / (rule.tolerance * system.model.length)
            reached = sizes.after_step()
            inverse = sizes.inverse(reached, rule.tolerance)
            error = max(estimate.error(system.core.dx, rates, taken, inverse, rule.tolerance), deeper, 1e-6)
            if error > 1 and taken > low * (1 + 1e-6):  # what is left at the end may be longer by rounding
                system.core.discard()
                system.stepper.rejected += 1
                h, shortened = max(taken * max(0.9 * error ** (-1 / 3), 0.2), low), True
                continue
            system.accept(attempt, scheme)
        except StepFailure:
            system.stepper.rejected += 1
            if taken <= low:
                raise
            h, shortened = max(0.5 * taken, low), True
            continue
        estimate.rates, estimate.length, estimate.before = rates, taken, estimate.length
        depths, sizes.reached = there, reached
        functions.accept()
        proposed = next_step(taken, h, error, last, 1.0 if shortened else 2.0)
        h, last, shortened = float(np.clip(proposed, min(low, h), high)), error, False
        steps = np.array([h, last, taken, estimate.before])
        carried = {
            "steps": steps,
            "rates": rates,
            "depths": depths,
            "reached": reached,
            "functions": functions.seen,
        }
        pace[NAME] = Record(NAME, VERSION, carried)
        yield attempt.report


def overlaps(system: System) -> Array:
    """Depth of overlaps of rigid bodies at the state evaluated last."""
    return np.concatenate([np.zeros(0), *(c.overlaps for c in system.components)])


def next_step(taken: float, planned: float, error: float, last: float, most: float) -> float:
    """PI control for an error of third order, up to the factor `most`; small changes are not worth factorising anew."""
    factor = 0.9 * error ** (-0.7 / 3) * last ** (0.4 / 3)
    factor = min(max(factor, 0.3), most)
    if 0.9 <= factor <= 1.2:
        factor = 1.0
    proposed: float = taken * factor
    return max(proposed, planned) if taken < planned and factor >= 1.0 else proposed
