"""Static equilibrium: where a system comes to rest under its loads, with the reactions there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.load_steps import Unstable
from visviva.analysis.march import begin, keep, prepare, record
from visviva.base.arguments import number, whole
from visviva.base.errors import InputError, RunError
from visviva.results.ledger import Bookkeeper
from visviva.results.result import Result
from visviva.scheme.schemes import NONE, Scheme, Table, load_step
from visviva.system.agreement import refuse_different_arguments
from visviva.system.freedom import refuse_free, refuse_insulated
from visviva.system.instant import Instant, instant
from visviva.system.memory import returning
from visviva.system.newton import StepFailure
from visviva.system.stability import count_falling, instability
from visviva.system.system import System, refuse_no_system
from visviva.system.turn import by_one_thread

Array = NDArray[np.float64]

AT_REST = 1e-13
"""A system whose largest move, relative to its size, is smaller than this is at rest."""
LONGEST = 1e5
"""Ratio of the last to the first duration of the relaxation."""


@dataclass(frozen=True)
class Relaxation(Scheme):
    """One step downhill: ``M (x1 - x0) / duration^2 + f(x1) + G^T lambda = 0``, statics as `duration` grows.

    Mass keeps every step well posed, also where nothing else holds a body, and leads to stable equilibria.
    """

    duration: float = 1.0

    @property
    def dissipates(self) -> bool:
        return True

    def motion(self, h: float) -> Table:
        """Table of a field of order 2."""
        return (NONE, (1 / self.duration**2, 0.0, 0.0, 0.0), NONE, NONE, NONE)

    def transport(self, h: float) -> Table:
        return (NONE,) * 5


@by_one_thread
def equilibrium(
    system: System,
    *,
    until: float | None = None,
    steps: int = 1,
    most: int = 400,
    unstable: bool = False,
    project: bool = False,
) -> Result:
    """Bring a system to rest under its loads.

    Velocities are set to zero. Starting from its present configuration the system goes downhill in energy
    until it rests; a system that starts in an unstable equilibrium stays there, which is refused unless it is meant.

    No time passes while it goes downhill, so that what creeps or relaxes, such as the branches of a
    `ViscoelasticSolid`, answers as it does at once: that is the rest just after loading and not that of long times,
    which a run in time or `quasi_static` over many relaxation times gives, and so does a `Solid` without branches.

    Parameters
    ----------
    system : System
        Is in equilibrium afterwards, its multipliers are the static ones.
    until, steps : float, int
        Loads and prescribed motions that depend on time are followed to this time in so many steps; without
        `until` they keep their present values.
    most : int
        Give up after this many steps downhill under one load.
    unstable : bool
        Accept an equilibrium that is unstable.
    project : bool
        Accept an initial state that is moved far to fit the constraints; see `simulate`.

    Returns
    -------
    Result
        Configuration of each load step, and the ledger of all steps downhill.

    Raises
    ------
    RunError
        If the system does not come to rest: something is free to move under its loads.
    Unstable
        If it rests where the slightest disturbance would make it leave.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=2.0, position=(0, 0, -1))
    >>> spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0)
    >>> system = vv.System([ground, ball, spring, vv.Gravity(acceleration=(0, 0, -10))])
    >>> result = vv.equilibrium(system)
    >>> round(float(system.x[2]), 12)
    -1.2
    """
    refuse_no_system("equilibrium", system)
    until = None if until is None else number("equilibrium", "until", until)
    steps, most = whole("equilibrium", "steps", steps), whole("equilibrium", "most", most)
    if until is not None and not until > system.time:
        raise InputError(f"end time until = {until} is not after the present time {system.time:g}")
    refuse_different_arguments("equilibrium", until=until, steps=steps)
    for history in (system.v, system.core.a, system.core.w):
        history[:] = 0.0
    system.invalidate()
    refuse_insulated(system)
    prepare(system, Relaxation(), project=project)  # which gives prescribed motion its rates
    system.v[:] = 0.0
    result, books = begin(system, Relaxation())
    try:
        follow(system, result, books, until, steps, most, unstable)
    except Unstable:
        raise
    except RunError as error:
        raise RunError(f"{error}{free_motions(system)}") from error
    system.follow_prescribed()
    system.invalidate()
    system.stepper.has_acceleration = False
    return result


def free_motions(system: System) -> str:
    """Sentence on what nothing holds, for an error."""
    try:
        refuse_free(system)
    except InputError as error:
        return f". Note that {error}"
    return ""


def follow(
    system: System,
    result: Result,
    books: Bookkeeper,
    until: float | None,
    steps: int,
    most: int,
    unstable: bool,
) -> None:
    """Relax under the present loads, or under those of every load step to `until`."""
    start = system.time
    for k in range(steps):
        if until is not None:
            system.time = start + k * (until - start) / steps
        h = 0.0 if until is None else start + (k + 1) * (until - start) / steps - system.time
        relax(system, result, books, h, most)
        confirm(system, unstable)
        keep(result)


def confirm(system: System, unstable: bool) -> None:
    """Refuse an unstable equilibrium unless it is meant."""
    falling = count_falling(system, load_step(system.time, 0.0))
    if falling and not unstable:
        raise Unstable(
            f"{instability(system, 'found', falling)}, or say vv.equilibrium(..., unstable=True) if it is meant"
        )
    system.stepper.stability.record(falling, system.time)


def relax(system: System, result: Result, books: Bookkeeper, h: float, most: int) -> None:
    """Go downhill under the loads of time ``system.time + h`` until nothing moves."""
    inverse = np.where(system.order > 0, system.inverse_scale, 0.0)
    first = duration = natural_time(system, inverse)
    failures = 0  # in a row
    for _ in range(most):
        scheme = Relaxation(duration=duration)
        try:
            attempt = system.attempt(scheme.step(system.time, h))
            moves = np.abs(system.core.dx) * inverse
            system.accept(attempt, scheme)
        except StepFailure:
            failures += 1
            system.stepper.rejected += 1
            if failures > 20:
                raise
            duration /= 4
            continue
        size, mover = float(moves.max()), int(np.argmax(moves))
        h, shortened, failures = 0.0, failures > 0, 0
        record(result, books, attempt.report.iterations, attempt.report.factorizations)
        if size <= AT_REST and duration >= min(first * 30, LONGEST * first):
            return
        if not shortened:
            duration = min(2 * duration, LONGEST * first)
    component, unknown = system.describe(mover)
    raise RunError(
        f"no equilibrium found: {unknown} of {component} still moves by {size:.1e} of its scale. Something "
        "may be free to move under the loads; hold it, or raise `most`"
    )


def natural_time(system: System, inverse: Array) -> float:
    """In which forces, without constraints, would move their masses by a tenth of the system's size."""
    at = Instant(system)
    with returning(system):
        system.x[at.multipliers] = 0.0
        force = np.abs(system.residual(instant(system.time, theta=1.0))[at.coordinates])
    mass = at.M.diagonal()
    pull = np.where(mass > 0, force / np.where(mass > 0, mass, 1.0), 0.0) * inverse[at.coordinates]
    strongest = float(pull.max(initial=0.0))
    return float(np.sqrt(0.1 / strongest)) if strongest > 0 else 1.0
