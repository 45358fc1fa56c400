"""Statics of structures under loads that grow, by load steps with line search.

Time is the load parameter: whatever depends on it (loads, prescribed motion) is followed. Nothing has inertia here,
so what is not held by supports, springs or its own stiffness makes the tangent singular, and is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.march import advance, begin, checked_times, keep
from visviva.base.arguments import bounded, whole
from visviva.base.errors import InputError, NotFinite, RunError
from visviva.base.world import world
from visviva.model.field import Role
from visviva.results.result import Result
from visviva.scheme.schemes import NONE, Scheme, Table, load_step
from visviva.system.memory import Trial
from visviva.system.newton import trouble_of
from visviva.system.stability import falling_directions, instability
from visviva.system.steps import Attempt, invalid
from visviva.system.system import System
from visviva.system.turn import by_one_thread

Array = NDArray[np.float64]

TINY = 1e-7
"""Relative length of the differences that linearise prescribed motion and loads in time."""

ROUGH = 1e-3
"""Part of the residual that linear predictions may leave: they miss the curvature of the path."""

CONFIRMING = 0.05
"""Part of the residual that the last solution may leave, which is to be smaller than the tolerance."""

KNOWN = 1e-6
"""Part of a load step that increments which do not shrink may have, if the iteration is to have found it."""

EASY = 6
"""After no more iterations than this a halved load step lengthens again."""


class NoEquilibrium(RunError):
    """A load step whose iteration did not converge."""


class Unstable(RunError):
    """An equilibrium that a structure would leave at the slightest disturbance."""


@dataclass(frozen=True)
class Static(Scheme):
    """Static equilibrium at the end of every load step: no rates, no inertia; time is the load parameter.

    A load step that fails is halved; steps grow again, up to the given one, when they converge fast.

    The ledger has the work of loads and prescribed motion along each step by the trapezoidal rule: its balance closes
    where forces are linear in the displacements, else to second order in the step; see :doc:`/theory/structure`.

    Parameters
    ----------
    tolerance : float
        Largest increment of an accepted iterate, relative to the size of the model and of the load step.
    max_iterations : int
    halvings : int
        How often a load step that fails is tried again with half its length.
    line_search : bool
        Shorten increments that overshoot along their own direction.
    unstable : bool
        Go on along equilibria that are unstable, as a column that stays straight beyond its critical load. They are
        refused otherwise; the audit says so where this could not be checked.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, block = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1))
    >>> hold = vv.Bushing(a=ground, b=block, at=(0, 0, 0), stiffness=(10, 10, 10), rotational_stiffness=(1, 1, 1))
    >>> system = vv.System([ground, block, hold, vv.Force(on=block, force=(5, 0, 0), times="t")])
    >>> result = vv.simulate(system, until=1.0, step=0.5, scheme=Static())
    >>> [round(float(x[0]), 9) for x in result.states]
    [0.0, 0.25, 0.5]
    """

    tolerance: float = 1e-10
    max_iterations: int = 25
    halvings: int = 8
    line_search: bool = True
    unstable: bool = False
    order: ClassVar[int] = 0
    has_inertia: ClassVar[bool] = False

    def __post_init__(self) -> None:
        bounded(self, tolerance=(1e-300, 1.0), max_iterations=(1, 1e9), halvings=(0, 60))

    def march(self, system: System, *, until: float, step: float) -> Iterator[LoadReport]:
        return load_steps(system, self, until, step)

    def equations(self, system: System) -> Equilibrium:
        """Problem of a load step."""
        return Equilibrium(system, self)

    def motion(self, h: float) -> Table:
        return (NONE,) * 5

    transport = motion


@dataclass
class Bracket:
    """Parts of an increment between which the work of the residual vanishes; it is `work` at the lower one.

    Behind a kink, as where cracks close, the work may rise so steeply that secants fall short of it.
    """

    work: float
    low: float = 0.0
    high: float = 1.0
    is_passed: bool = False

    def next(self, s: float, g: float) -> float:
        """The part to try after `s`, where the work is `g`: a shorter one, unless a longer one was too long."""
        same = bool(np.isfinite(g)) and g * self.work > 0
        if same and self.is_passed:
            self.low, self.work = s, g
            return 0.5 * (s + self.high)
        self.high, self.is_passed = s, self.is_passed or (bool(np.isfinite(g)) and not same)
        known = np.isfinite(g) and g != self.work
        share = float(np.clip(self.work / (self.work - g), 0.1, 0.5)) if known else 0.25
        return self.low + share * (s - self.low)


@dataclass
class Equilibrium:
    """The equations of equilibrium of a system at load parameters from `start` on, at the trial state of its core."""

    system: System
    options: Static
    start: float = field(init=False)
    free: NDArray[np.bool_] = field(init=False)

    def __post_init__(self) -> None:
        fields = self.system.model.fields
        self.start = self.system.time
        self.free = ~np.concatenate([f.fixed for f in fields])

    @property
    def dx(self) -> Array:
        """Increment of the trial state."""
        return self.system.core.dx

    def at(self, time: float) -> Any:
        """The step that leads to the load parameter `time`; prescribed unknowns are moved to it."""
        step = load_step(self.system.time, time - self.system.time)
        self.system.prescribe(step)
        return step

    def residual(self, time: float) -> Array:
        """Residual at the trial state under the loads of `time`."""
        return self.system.residual(self.at(time))

    def linearise(self, time: float) -> Array:
        """Factorise the tangent at the trial state; returns the residual."""
        step = self.at(time)
        residual = np.zeros(len(self.dx))
        if not self.system.core.linearise(step, self.system.signals(step), residual):
            raise NoEquilibrium(
                f"the tangent stiffness is singular at the load parameter {time:.6g}: something is not held, or "
                "this is a limit point (follow it with vv.arc_length)"
            )
        return residual

    def solve(self, time: float, residual: Array, enough: float = 0.0) -> Array:
        """Increment that the factorised tangent gives for a residual; zero where prescribed.

        Iterative solvers may leave the part `enough` of the residual, if that is more than their tolerance.
        """
        d = np.zeros(len(residual))
        step = load_step(self.system.time, time - self.system.time)
        if not self.system.core.linear_solve(step, residual, d, enough):
            raise NoEquilibrium(f"at the load parameter {time:.6g}: {self.system.core.linear_message}")
        return np.where(self.free, d, 0.0)

    def refined(self, time: float, residual: Array, d: Array) -> Array:
        """The increment `d` for a residual with what the solver has left of that solved as well."""
        import scipy.sparse as sp

        step, core = self.at(time), self.system.core
        row, col, unknown = (np.asarray(part) for part in core.csr)
        values, change = np.zeros(len(col)), np.zeros(len(d))
        core.assemble(step, self.system.signals(step), np.zeros(len(d)), values)
        change[unknown] = sp.csr_array((values, col, row), shape=(len(unknown),) * 2) @ d[unknown]
        world().sum(change)  # each has the tangent of its elements
        return d + self.solve(time, residual + change)

    def size(self, d: Array) -> float:
        """Largest entry relative to the unknowns' scales."""
        return float(np.abs(d * self.system.inverse_scale).max(initial=0.0))

    def is_exact(self, residual: Array, size: float, last: float) -> bool:
        """True if the increments stopped shrinking because the `residual` they are solved for is rounding alone."""
        stagnates = size > 0.5 * last and size <= 1e-13
        if size >= last and size <= min(self.options.tolerance, KNOWN * self.size(self.dx)):
            return True  # no more digits of small load steps are known, as where thin shells hardly stretch
        return stagnates or bool(self.system.core.meets_rounding(residual, size, last))

    def slope(self, time: float, h: float) -> Array:
        """Derivative of the residual by the load parameter at the trial state."""
        kept, eps = self.dx.copy(), TINY * h
        r0 = self.residual(time)
        r1 = self.residual(time + eps)
        self.dx[:] = kept
        return (r1 - r0) / eps

    def predict(self, time: float) -> None:
        """First increment of a load step: linear, so that prescribed motion spreads through the body at once."""
        residual = self.linearise(self.system.time)
        h = time - self.system.time
        slope = self.slope(self.system.time, h)
        d = self.solve(self.system.time, residual + h * slope, ROUGH)
        self.at(time)
        self.dx[self.free] += d[self.free]

    def iterate(self, time: float) -> LoadReport:
        """Newton's iteration at the loads of `time` from the trial state; returns what it took."""
        o, last, n_tangents = self.options, np.inf, 1
        tolerance = o.tolerance * (min(1.0, self.size(self.dx)) or 1.0)
        r, kept = self.linearise(time), False
        for k in range(o.max_iterations):
            d = self.solve(time, r, CONFIRMING if kept else 0.0)
            size = self.size(d)
            if not np.isfinite(size) or size > 1e3:
                raise self.failure(time, "the iteration diverges")
            self.dx[:] += d
            settled = self.system.core.is_settled
            if settled and (size <= tolerance or self.is_exact(r, size, last)):
                self.residual(time)
                return LoadReport(k + 1, n_tangents)
            searches = o.line_search and size < last * 1e3
            there = self._search(time, d, float(d @ r)) if searches else None
            kept = k > 0 and settled and size * (size / last) ** 2 <= tolerance
            if kept:  # by quadratic convergence the next increment is the last: the tangent at hand serves
                r = there if there is not None else self.residual(time)
                kept = not self.system.core.is_outdated
            if not kept:
                r = self.linearise(time)
                n_tangents += 1
            last = size
        raise self.failure(
            time,
            f"no equilibrium in max_iterations = {o.max_iterations} (last relative increment {size:.1e})",
        )

    def _search(self, time: float, d: Array, g0: float) -> Array | None:
        """Shorten the increment `d` while the work of the residual along it has grown or hardly fallen.

        Returns the residual there, or nothing where the search ended without an answer. With contact, whose set of
        closed gaps changes along the way, and with friction and what is transported, which have no potential, the work
        then tells nothing, and the whole increment is taken where that is possible.
        """
        stores = any(f.role is Role.CONTENT for f in self.system.model.fields)
        tells_little, possible = stores or any(c.touches or c.rubs for c in self.system.components), False
        s, bracket = 1.0, Bracket(g0)
        for _ in range(5):
            r = self.residual(time)
            g = float(d @ r)
            possible = possible or (tells_little and s == 1.0 and np.isfinite(g) and not self._refused(time))
            if np.isfinite(g) and abs(g) <= 0.8 * abs(g0) and not self._refused(time):
                return r
            other = bracket.next(s, g)
            self.dx[:] += (other - s) * d
            s = other
        if possible:
            self.dx[:] += (1 - s) * d
        return None

    def _refused(self, time: float) -> str:
        step = load_step(self.system.time, time - self.system.time)
        return str(self.system.core.refuse(step, self.system.signals(step)))

    def failure(self, time: float, what: str) -> NoEquilibrium:
        """The error of an iteration that failed at a load parameter, with elements that it has turned inside out."""
        trouble = trouble_of(self.system).removesuffix(". ")
        at = f"{what} at the load parameter {time:.6g}"
        return NoEquilibrium(f"{at}: {trouble}; mesh the place finer, or load it less" if trouble else at)

    def accept(self, time: float) -> None:
        """Make the trial state the new state."""
        step = self.at(time)
        if reason := self._refused(time):
            raise NoEquilibrium(f"at the load parameter {time:.6g} {reason}")
        if reason := invalid(self.system):
            raise NoEquilibrium(f"at the load parameter {time:.6g} {reason}")
        falling = falling_directions(self.system, step)
        if falling and not self.options.unstable:
            found = instability(self.system, f"at the load parameter {time:.6g}", falling)
            raise Unstable(
                f"{found}, follow it with vv.arc_length, or say vv.Static(unstable=True) if it is meant"
            )
        self.system.stepper.stability.record(falling, time)
        self.system.accept(Attempt(step, self.system.signals(step).copy(), None), Static())


@dataclass(frozen=True)
class LoadReport:
    """Cost of a load step."""

    iterations: int
    factorizations: int

    def __add__(self, other: LoadReport) -> LoadReport:
        return LoadReport(self.iterations + other.iterations, self.factorizations + other.factorizations)


@by_one_thread
def quasi_static(
    system: System,
    *,
    until: float,
    step: float,
    scheme: Static | None = None,
    every: int = 1,
    project: bool = False,
) -> Result:
    """Follow the equilibrium of a structure while its loads grow in time.

    The same as `simulate` with the scheme `Static`. All kept states and the ledger stay in memory: where they are
    many and large keep fewer, with `every`, or let `visviva.study.run.run` write them into a directory.

    Parameters
    ----------
    system : System
        At rest in equilibrium at its present time, or close to it.
    until, step : float
        Last load parameter, and length of the first load step.
    scheme : Static
        Tolerances of the iteration.
    every : int
        Keep the state of every n-th load step, and the last one.
    project : bool
        Accept an initial state that is moved far to fit the constraints; see `simulate`.

    Returns
    -------
    Result
        States and ledger by load step; times are load parameters.

    Raises
    ------
    InputError
        If a body can move rigidly without resistance.
    NoEquilibrium
        If the smallest load step fails; the system keeps the last equilibrium.
    Unstable
        If an equilibrium is unstable and the scheme does not say that this is meant; the system keeps the last one.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=2.0, position=(0, 0, -1))
    >>> spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0)
    >>> guide = vv.PointOnLine(a=ground.frame(axes=((1, 0, 0), (0, 1, 0), (0, 0, 1))), b=ball.point())
    >>> pull = vv.Force(on=ball.point(), force=(0, 0, -20), times=lambda t: t)
    >>> result = vv.quasi_static(vv.System([ground, ball, spring, guide, pull]), until=1.0, step=0.5)
    >>> round(float(result.states[-1][2]), 9)
    -1.2
    """
    every, (until, step) = whole("quasi_static", "every", every), checked_times(until, step)
    result, books = begin(system, scheme or Static(), project=project)
    for _ in advance(result, books, until=until, step=step):
        if result.statistics.steps % every == 0:
            keep(result)
    if result.statistics.steps % every:
        keep(result)
    return result


def load_steps(system: System, scheme: Static, until: float, step: float) -> Iterator[LoadReport]:
    """Load steps to the end, halved where they fail; they lengthen again where they converge fast."""
    if not until > system.time:
        raise InputError(f"until = {until} is not after the present time {system.time:g}")
    clock = system.clock
    clock.use(step)
    clock.refuse_short(until, step, system.stepper.is_given)
    while not clock.has_reached(until):
        equations = scheme.equations(system)
        h = clock.next(until)
        target = system.time + h
        try:
            with Trial(system):
                equations.predict(target)
                report = equations.iterate(target)
                equations.accept(target)
        except (NoEquilibrium, NotFinite) as failure:
            system.stepper.rejected += 1
            if clock.halvings >= scheme.halvings:
                clock.restart(clock.time)
                raise NoEquilibrium(
                    f"{failure}; the last equilibrium is that of {system.time:.6g}, steps were cut {scheme.halvings} "
                    "times. If it snaps here, to an equilibrium far away, follow the path with vv.arc_length, or "
                    "take the snap in steps of dynamics with vv.simulate"
                ) from failure
            clock.halve(h)
            continue
        if report.iterations <= EASY:
            clock.lengthen()
        yield report
