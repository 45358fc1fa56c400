"""Marching a system through time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

from visviva.errors import InputError
from visviva.ledger import Bookkeeper
from visviva.result import Result
from visviva.scheme import EnergyMomentum, Scheme
from visviva.system import StepFailure, System

HALVINGS = 6
"""A step that fails is tried again with half its length this many times before the run gives up."""


def march(system: System, *, until: float, step: float, scheme: Scheme | None = None) -> Iterator[Any]:
    """Take steps of length `step` up to time `until`, yielding the core's report after each accepted one.

    A step that does not converge is halved up to six times; then `StepFailure` is raised and the system keeps
    the last accepted state.

    Examples
    --------
    >>> import visviva as vv
    >>> system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    >>> for report in vv.march(system, until=1.0, step=0.1):
    ...     pass
    >>> round(float(system.x[0]), 12)
    1.0
    """
    if not step > 0:
        raise InputError(f"step = {step} is not positive")
    if not until > system.time:
        raise InputError(f"end time until = {until} is not after the present time {system.time:g}")
    scheme = EnergyMomentum() if scheme is None else scheme
    prepare(system, scheme)
    halvings = 0
    while until - system.time > 1e-9 * step:
        h = min(step / 2**halvings, until - system.time)
        if abs(until - system.time - h) < 1e-9 * step:
            h = until - system.time if halvings or abs(h - step) > 1e-9 * step else step
        try:
            report = system.step(h, scheme)
        except StepFailure:
            halvings += 1
            system.rejected += 1
            if halvings > HALVINGS:
                raise
            continue
        halvings = max(halvings - 1, 0)
        yield report


def prepare(system: System, scheme: Scheme) -> None:
    """Before the first step of a scheme: consistent accelerations where its history starts from them."""
    if scheme.needs_acceleration and not system.has_acceleration:
        from visviva.consistency import initial_acceleration

        initial_acceleration(system)


def simulate(
    system: System,
    *,
    until: float,
    step: float,
    scheme: Scheme | None = None,
    every: int = 1,
    observe: Callable[[System], None] | None = None,
) -> Result:
    """Run a system to time `until` and return states, ledger and statistics.

    Parameters
    ----------
    system : System
        What moves; continues from its present state.
    until, step : float
        End time and step length.
    scheme : Scheme
        Time integration, `EnergyMomentum` if not given.
    every : int
        Keep the states of every so many steps.
    observe : callable
        Called with the system after each accepted step.
    """
    scheme = EnergyMomentum() if scheme is None else scheme
    books = Bookkeeper(system.model.accounts)
    result = Result(system, scheme, books.ledger)
    system.take_stock()
    books.book(system.time, system.core)
    keep(result)
    start, rejected = time.perf_counter(), system.rejected
    for report in march(system, until=until, step=step, scheme=scheme):
        s = result.statistics
        s.steps += 1
        s.iterations += report.iterations
        s.factorizations += report.factorizations
        books.book(system.time, system.core)
        if s.steps % every == 0:
            keep(result)
        if observe is not None:
            observe(system)
    result.statistics.seconds = time.perf_counter() - start
    result.statistics.rejected = system.rejected - rejected
    return result


def keep(result: Result) -> None:
    """Keep the present state."""
    result.times.append(result.system.time)
    result.states.append(result.system.x.copy())
    result.rates.append(result.system.v.copy())
