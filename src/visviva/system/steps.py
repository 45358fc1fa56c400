"""Steps of a system: solved, accepted, their rates projected, and what follows kinks of prescribed motion."""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, NotFinite
from visviva.component.limited import Limited
from visviva.system.agreement import stepping
from visviva.system.growing import refuse_imbalance, watches
from visviva.system.kinks import Before, evaluate_ledger_again, follow_kinks, passed
from visviva.system.memory import Trial
from visviva.system.newton import GivenUp, StepFailure
from visviva.system.steep_heat import begin_even
from visviva.system.turn import alone

if TYPE_CHECKING:
    from visviva.scheme.schemes import Scheme
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Attempt:
    """A step whose equations are solved, with the prescribed functions it saw and the core's report."""

    step: Any
    signals: Array
    report: Any


def next_kink(system: System, until: float) -> float:
    """The next time at which a prescribed function has a kink, `until` at most."""
    k = bisect.bisect_right(system.kinks, passed(system))
    return min(system.kinks[k], until) if k < len(system.kinks) else until


def take(system: System, h: float, scheme: Scheme) -> Any:
    """Advance by one step of length `h`; returns the core's report."""
    with alone(system), stepping(system, h, scheme):
        return _taken(system, h, scheme)


def _taken(system: System, h: float, scheme: Scheme) -> Any:
    step = system.stepper.step_of(scheme, h)
    limited = any(isinstance(c, Limited) for c in system.components)
    if limited or system.projects(scheme) or watches(system, step):
        attempt = solved(system, step)
        accept(system, attempt, scheme)
        return attempt.report
    signals = system.signals(step).copy() if system.model.driving.signals else None
    before = Before.of(system)
    report = _solve(system, system.core.advance, step, signals)
    _arrive(system, step, system.signals(step) if signals is None else signals, scheme, before)
    return report


def solved(system: System, step: Any) -> Attempt:
    """Solve a step's equations; its increment is then the core's ``dx``, to be accepted or discarded."""
    signals = system.signals(step).copy()
    attempt = Attempt(step, signals, _solve(system, system.core.solve, step, signals))
    refuse_imbalance(system, step)
    return attempt


def accept(system: System, attempt: Attempt, scheme: Scheme) -> None:
    """Make the increment of an attempt the new state; a step to where energies or rates have no value has failed."""
    project = system.projects(scheme)
    x0, dx = (system.x.copy(), system.core.dx.copy()) if project else (system.x, system.x)
    before = Before.of(system)
    with Trial(system), _failing(system, attempt.step):
        refuse_invalid(system, attempt.step)
        _refuse_failed(system, attempt.step, system.core.accept(attempt.step, attempt.signals, True))
    jumped = _arrive(system, attempt.step, attempt.signals, scheme, before)
    if project and not (jumped and scheme.needs_acceleration):  # whose rates satisfy the constraints already
        _project(system, attempt.step, scheme, x0, dx)


def invalid(system: System) -> str:
    """Reason why the equations of some component are meaningless at the trial state; empty if there is none."""
    limited = [c for c in system.components if isinstance(c, Limited)]
    if not limited:
        return ""
    trial = system.x + system.core.dx
    return "; ".join(found for c in limited if (found := c.invalid(trial)))


def refuse_invalid(system: System, step: Any) -> None:
    """Fail a step whose equations are solved by a state at which they mean nothing.

    Raises
    ------
    InputError
        If no shorter step would do: what some component refuses there.
    """
    try:
        found = invalid(system)
    except InputError as error:
        raise InputError(
            f"{error}; come to in the step from t = {system.time:.6g} to {step.t1:.6g}"
        ) from error
    if found:
        raise StepFailure(system, system.time, step.h, GivenUp("it ends where equations mean nothing"))


def _solve(system: System, solve: Callable[..., Any], step: Any, signals: Array | None) -> Any:
    """Report of the core's function that solves a step; if it fails, the increment is discarded."""
    newton = system.newton
    tangents = system.asked_tangents if newton.tangents is None else newton.tangents
    begin_even(system, step)
    with Trial(system):
        system.prescribe(step)
        with _failing(system, step):
            report = solve(
                step, signals, newton.tolerance, newton.max_iterations, _keep_factor(system), tangents
            )
        _refuse_failed(system, step, report)
    return report


def _refuse_failed(system: System, step: Any, report: Any) -> None:
    """Fail a step of which the core reports that it has failed."""
    if not report.converged:
        raise StepFailure(system, system.time, step.h, report)


@contextmanager
def _failing(system: System, step: Any) -> Iterator[None]:
    """Inside, what has no finite value is a failure of the step."""
    try:
        yield
    except NotFinite as error:
        raise StepFailure(system, system.time, step.h, GivenUp(str(error))) from error


def _keep_factor(system: System) -> float:
    """A kept tangent and redundant constraints do not go together: their multipliers wander off."""
    redundant = system.report is not None and system.report.redundant
    return 0.0 if redundant else system.newton.keep_factor


def _arrive(system: System, step: Any, signals: Array, scheme: Scheme, before: Before) -> bool:
    """Take the state for that of a step from what was `before`.

    Returns
    -------
    bool
        Whether rates have changed at once there, as those of what is driven do behind a kink.
    """
    system.stepper.arrive(step, signals, scheme)
    means = system.stepper.means
    if len(means):
        system.v[means] = (system.x[means] - before.places) / step.h
        system.core.mark_state()
    bent = system.model.driving.bent(before.passed, passed(system))
    follows = bool(bent) and scheme.has_inertia and bool(np.any(system.order == 2))
    return follows and follow_kinks(system, step, scheme, before, bent)


def _project(system: System, step: Any, scheme: Scheme, x0: Array, dx: Array) -> None:
    """Project the rates of the accepted step and book it again with them."""
    from visviva.system.consistency import project_step

    work = project_step(system, step, scheme.motion(step.h), x0, x0 + dx)
    evaluate_ledger_again(system)
    for (_, account), part in zip(system.model.driving.working, work, strict=True):
        system.core.work[account] += part
