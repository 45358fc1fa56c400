"""Marching a system through time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.adaptive import Adaptive, adaptive_steps
from visviva.base.arguments import number, positive, refuse_other, whole
from visviva.base.errors import InputError
from visviva.base.world import announce
from visviva.component.component import refuse_changed
from visviva.results.ledger import Bookkeeper
from visviva.results.naming import ledger_units
from visviva.results.recorded import Record, Recorded
from visviva.results.result import Kept, Result, spilled
from visviva.scheme.schemes import EnergyMomentum, Scheme, refuse_extreme
from visviva.system import agreement
from visviva.system.freedom import refuse_free, refuse_massless, refuse_swinging
from visviva.system.growing import bring_into_balance
from visviva.system.mean_rates import moved_by_means
from visviva.system.memory import undisturbed
from visviva.system.newton import StepFailure
from visviva.system.steep_heat import first_halvings
from visviva.system.system import System, refuse_no_system
from visviva.system.tied_heat import begin_consistently
from visviva.system.turn import by_one_thread

Array = NDArray[np.float64]

MEMORY = 1e9
"""Bytes of states that `simulate` keeps in memory."""
MOST = 1e10
"""Steps that nobody waits for."""
HALVINGS = 6
"""A step that fails is tried again with half its length this many times before the run gives up."""
FITS, DRIFTS = 1e-8, 0.05
"""Relative violations of constraints up to which an edited state fits, and of their rates, which some schemes leave."""
LAST_RESORT = 3
"""After this many halvings solvers are tried that cost more than half a step does."""


@runtime_checkable
class Marching(Protocol):
    """A scheme that chooses its steps itself, as those of statics do."""

    def march(self, system: System, *, until: float, step: float) -> Iterator[Any]:
        """Steps to `until`, yielding a report of each."""
        ...


def march(
    system: System,
    *,
    until: float,
    step: float,
    scheme: Scheme | None = None,
    adaptive: Adaptive | None = None,
    project: bool = False,
) -> Iterator[Any]:
    """Take steps of length `step` up to time `until`, yielding the core's report after each accepted one.

    A step that does not converge is halved up to six times, and the halves lengthen again on the grid of the
    steps; if the shortest fails too `StepFailure` is raised and the system keeps the last accepted state. With
    `adaptive` the steps follow the motion, `step` is the first; a second march goes on with the length, and what is
    known of the error, where the last one ended, unless ``system.stepper.pace`` is cleared. An initial state that does
    not fit the constraints is moved onto them; more than a thousandth of the system's size only with `project`.

    Examples
    --------
    >>> import visviva as vv
    >>> system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    >>> for report in vv.march(system, until=1.0, step=0.1):
    ...     pass
    >>> round(float(system.x[0]), 12)
    1.0
    """
    refuse_no_system("march", system)
    until, step = checked_times(until, step, system.time)
    refuse_other("march", "adaptive", adaptive, Adaptive | None, "vv.Adaptive(...)")
    scheme = EnergyMomentum() if scheme is None else scheme
    own = scheme.march(system, until=until, step=step) if isinstance(scheme, Marching) else None
    if own is None and not (until > system.time and math.isfinite(until)):
        cure = "; start='beginning' runs it anew" if until > 0 else ""
        raise InputError(f"end time until = {until} is not after the present time {system.time:g}{cure}")
    agreement.refuse_different_arguments("march", until=until, step=step, scheme=scheme, adaptive=adaptive)
    know(system, step)
    prepare(system, scheme, project=project)
    if scheme.needs_acceleration and not system.stepper.has_acceleration:
        from visviva.system.consistency import initial_acceleration

        initial_acceleration(system, scheme, step)
    if own is not None:
        yield from agreement.in_step(system, own)
        return
    n = first_halvings(system, scheme, step) if system.is_given else 0
    if adaptive is not None:
        steps = adaptive_steps(system, until=until, step=step, scheme=scheme, rule=adaptive, halved=n)
    else:
        steps = counted_steps(system, until=until, step=step, scheme=scheme, halved=n)
    yield from agreement.in_step(system, steps)


def know(system: System, step: float) -> None:
    """Tell a clock that has not run yet the length of the first step, as a measure of time for looks before it."""
    refuse_no_system("march", system)
    refuse_extreme(step)
    if system.clock.step == 0.0:
        system.clock.use(step)


def checked_times(until: Any, step: Any, now: float = 0.0) -> tuple[float, float]:
    """End time and length of steps as numbers that fit a run; those of numpy may have few digits to count with."""
    step, until = positive("march", "step", step), number("march", "until", until)
    if MOST * step < abs(until - now) < math.inf:
        raise InputError(
            f"step = {step:g} is too small: {abs(until - now) / step:.0e} steps are no run; the most is {MOST:g}"
        )
    refuse_extreme(step)
    return until, step


def counted_steps(
    system: System, *, until: float, step: float, scheme: Scheme, halved: int = 0
) -> Iterator[Any]:
    """Steps of equal length, the first of them `halved` so often, and after failures; yields reports."""
    clock = system.clock
    clock.use(step)
    clock.refuse_short(until, step, system.stepper.is_given)
    clock.begin_short(halved)
    halved = clock.halvings if clock.begins else 0
    while not clock.has_reached(until):
        halved = min(halved, clock.halvings)
        system.core.allow_last_resort(clock.halvings >= halved + LAST_RESORT)
        h = clock.next(until)
        try:
            report = system.step(h, scheme)
        except StepFailure:
            system.stepper.rejected += 1
            if clock.halvings >= halved + HALVINGS:
                clock.restart(clock.time)
                raise
            clock.halve(h)
            continue
        finally:
            system.core.allow_last_resort(True)
        clock.lengthen()
        yield report


def prepare(system: System, scheme: Scheme, *, project: bool = False) -> None:
    """Before the first step: a consistent state, if need be moved onto the constraints, far only with `project`.

    The check is made once in a system's life, and again of states that were edited until they no longer fit; what it
    found stays in ``system.report``. Without inertia bodies must be held and are at rest, and other linear solvers are
    due; so they are with tangents that are symmetric or not.
    """
    refuse_no_system("march", system)
    refuse_other("march", "scheme", scheme, Scheme, "a scheme such as vv.EnergyMomentum()")
    refuse_changed(system)
    agreement.agree_on_edits(system)
    due = {"inertia": scheme.has_inertia, "discrete_gradient": scheme.discrete_gradient}
    changes = due != {"inertia": system.has_inertia, "discrete_gradient": system.has_discrete_gradient}
    scheme.refuse(system)
    is_new = changes or system.report is None or system.is_given  # `System.check` tells, and refuses nothing
    if is_new:
        (refuse_massless if scheme.has_inertia else refuse_free)(system)
    if changes:
        system.choose_linear(**due)
    if not scheme.has_inertia:
        for history in (system.v, system.core.a, system.core.w):
            history[:] = 0.0
        system.stepper.has_acceleration = False
    elif changes and system.report is not None:  # from statics to dynamics
        system.follow_prescribed()
    if system.report is None or (system.stepper.is_edited and not still_fits(system)):
        from visviva.system.check import fit

        system.report = fit(system, project=project, moving=scheme.has_inertia)
    is_new_to_scheme = system.stepper.settled != scheme
    begins = system.is_given and is_new_to_scheme
    if begins and scheme.has_inertia:
        begin_consistently(system)
        bring_into_balance(system)
    if is_new:
        refuse_swinging(system, scheme)
    system.stepper.means = moved_by_means(system, scheme)
    system.projects(scheme)  # a look at the equations, which is due before the first increment
    for component in system.components if is_new_to_scheme else ():
        component.start(system, scheme)
    if begins and not scheme.has_inertia:  # begins elsewhere where components say so
        begin_consistently(system)
    _tell_moves(system)
    system.stepper.is_edited, system.stepper.settled = False, scheme


def _tell_moves(system: System) -> None:
    """Tell once what was moved to begin consistently."""
    moves, system.stepper.moves = system.stepper.moves, []
    if moves:
        announce(f"initial state made consistent: {'; '.join(moves)}")
    if system.report is not None:
        system.report.moves.extend(moves)


def still_fits(system: System) -> bool:
    """Whether a state that was edited after the first check satisfies the constraints, and roughly their rates."""
    from visviva.system.consistency import rate_violation, worst
    from visviva.system.instant import Instant

    with undisturbed(system):
        at = Instant(system)
        return not len(at.multipliers) or (worst(at) <= FITS and rate_violation(system, at) <= DRIFTS)


@by_one_thread
def simulate(
    system: System,
    *,
    until: float,
    step: float,
    scheme: Scheme | None = None,
    every: int = 1,
    observe: Callable[[System], None] | None = None,
    adaptive: Adaptive | None = None,
    project: bool = False,
    start: Literal["now", "beginning"] = "now",
    record: Record = (),
    memory: float = MEMORY,
) -> Result:
    """Run a system to time `until` and return states, ledger and statistics.

    States are kept in memory up to a budget and in a temporary file beyond it. `vv.run` writes a run into a directory.

    Parameters
    ----------
    system : System
        What moves; continues from its present state.
    until, step : float
        End time and step length.
    scheme : Scheme
        Time integration, `EnergyMomentum` if not given.
    every : int
        Keep the state of every n-th step, and the last one.
    observe : callable
        Called with the system after each accepted step.
    adaptive : Adaptive
        Choose step sizes by the error; `step` is the first.
    project : bool
        Accept an initial state that is moved by more than a thousandth of the system's size, or loses speeds, to fit
        the constraints.
    start : {'now', 'beginning'}
        Go on from the present state, or compose the system anew first; see `System.reset`.
    record : list of probes, or mapping from names to probes
        Histories to keep exactly, at every step, reactions and multipliers included: `Result.history` gives them back.
        Others are made of the kept states later, as far as those tell them.
    memory : float
        Bytes of states that are kept in memory.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, bob = vv.Ground(), vv.PointMass(mass=2.0, position=(1, 0, 0))
    >>> rod = vv.Spherical(a=ground, b=vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0)), at=(0, 0, 0))
    >>> system = vv.System([ground, rod.b, rod, vv.Gravity()])
    >>> force = vv.ReactionForce(joint=rod)
    >>> result = vv.simulate(system, until=0.1, step=0.01, record={"force": force})
    >>> result.history("force").shape
    (11, 3)
    """
    refuse_no_system("simulate", system)
    if start not in ("now", "beginning"):
        raise InputError(f"simulate: start is 'now' or 'beginning', not {start!r}")
    if start == "beginning":
        system.reset()
    recorded = Recorded.of("simulate", record)
    memory = positive("simulate", "memory", memory)
    every = whole("simulate", "every", every)
    until, step = checked_times(until, step, system.time)
    refuse_other("simulate", "observe", observe, Callable | None, "a function of the system")
    result, books = begin(system, scheme, project=project, step=step)
    agreement.refuse_different_arguments("simulate", every=every)
    result.recorded = recorded
    recorded.take(system)
    for _ in advance(result, books, until=until, step=step, adaptive=adaptive):
        recorded.take(system)
        if result.statistics.steps % every == 0:
            keep(result, memory)
        if observe is not None:
            observe(system)
    if result.statistics.steps % every:
        keep(result, memory)
    return result


def begin(
    system: System, scheme: Scheme | None = None, *, project: bool = False, step: float = 0.0
) -> tuple[Result, Bookkeeper]:
    """A result that holds the present state, and the books opened with it; `step` as far as it is known."""
    know(system, step)
    scheme = EnergyMomentum() if scheme is None else scheme
    prepare(system, scheme, project=project)
    system.stepper.begin_run()
    books = Bookkeeper(system)
    books.ledger.units = ledger_units(books.ledger.names, system.units, scheme)
    result = Result(system, scheme, books.ledger)
    with undisturbed(system):
        system.evaluate_ledger()
    books.book(system.time, system.core)
    if scheme.rings:
        books.swings.look(system)
    keep(result)
    return result, books


def advance(
    result: Result, books: Bookkeeper, *, until: float, step: float, adaptive: Adaptive | None = None
) -> Iterator[Array]:
    """March on with the books kept; yields the ledger's row after each accepted step."""
    system, s = result.system, result.statistics
    start, rejected = time.perf_counter(), system.stepper.rejected - s.rejected
    for report in march(system, until=until, step=step, scheme=result.scheme, adaptive=adaptive):
        row = record(result, books, report.iterations, report.factorizations)
        s.rejected = system.stepper.rejected - rejected
        s.seconds += time.perf_counter() - start
        yield row
        start = time.perf_counter()  # what the caller does with the step is not the step's time


def record(result: Result, books: Bookkeeper, iterations: int, factorizations: int) -> Array:
    """Enter a step into statistics and ledger; returns the ledger's row."""
    s = result.statistics
    s.steps += 1
    s.iterations += iterations
    s.factorizations += factorizations
    if result.scheme.rings:
        s.swings = max(s.swings, books.swings.look(result.system))
    for lag in books.ledger.sizes.lags:
        lag.add(result.system)
    return books.book(result.system.time, result.system.core)


def present(system: System) -> tuple[float, Array, Array, list[Array]]:
    """The record of the present state: time, unknowns, rates and the results of contacts."""
    records = [component.record(system.x) for component in system.components]
    return system.time, system.x, system.v, [r for r in records if r is not None]


def keep(result: Result, memory: float = np.inf) -> None:
    """Keep the present state; beyond a limit of memory all kept states go into a temporary file."""
    result.kept.append(*present(result.system))
    if isinstance(result.kept, Kept) and result.kept.n_bytes > memory:
        result.kept = spilled(result.kept)
