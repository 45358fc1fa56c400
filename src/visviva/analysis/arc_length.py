"""Equilibrium paths followed by their length, through limit points of load and of displacement."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.fork import NEAR, Fork, critical_mode
from visviva.analysis.load_steps import Equilibrium, LoadReport, NoEquilibrium, Static
from visviva.analysis.march import advance, begin, keep
from visviva.base.arguments import bounded, whole
from visviva.base.errors import InputError, NotFinite, RunError
from visviva.output.checkpoint import Record
from visviva.results.result import Result
from visviva.system.agreement import agreed
from visviva.system.memory import Trial
from visviva.system.system import System
from visviva.system.turn import by_one_thread

Array = NDArray[np.float64]

NAME, VERSION = "arc length", 2
"""Of the record of what the path has got to."""


@dataclass(frozen=True)
class ArcLength(Static):
    """Statics that follow an equilibrium path by its length through limit points (Riks 1979, Crisfield 1981).

    The first step goes along the path by the load `step`, and fixes the length of the arc. Time is the load parameter,
    which may fall; the path ends when it has passed the end time, or after `most` steps.

    Parameters
    ----------
    load_weight : float
        Weight of the load parameter, relative to the step, in the arc length; displacements count relative to the size
        of the model, as root mean square over the moving unknowns. 0 is the cylindrical method. What stands still until
        it buckles, such as a straight column that cannot stretch, has an arc by its load alone: take 0.01 there.
    iterations : int
        Wanted number of iterations; the arc grows or shrinks to meet it.
    longest : float
        Largest growth of the arc, relative to the first.
    most : int
        Largest number of steps.
    branch : float
        Leave the path at the first bifurcation along the mode in which the structure gives way there: by so much in
        the measure of arcs, in the sense of the sign, and follow the new path on. 0 stays on the path.
    """

    line_search: bool = False
    unstable: bool = True
    load_weight: float = 0.0
    iterations: int = 5
    longest: float = 8.0
    most: int = 1000
    branch: float = 0.0
    has_growing_time: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        bounded(
            self,
            load_weight=(0.0, 1e12),
            iterations=(1, 1e9),
            longest=(1.0, 1e12),
            most=(1, 1e9),
            branch=(-1.0, 1.0),
        )

    def march(self, system: System, *, until: float, step: float) -> Iterator[LoadReport]:
        return follow_path(system, self, until, step)

    def path(self, equations: Equilibrium, unit: float) -> Path:
        """By what steps along a path of equilibria are measured, with a first one of the load `unit`."""
        return Path(equations, unit, self.load_weight)


@by_one_thread
def arc_length(
    system: System,
    *,
    step: float,
    until: float = np.inf,
    steps: int = 200,
    scheme: ArcLength | None = None,
    stop: Callable[[System], bool] | None = None,
    project: bool = False,
) -> Result:
    """Follow an equilibrium path by its length, through limit points of load and of displacement.

    Parameters
    ----------
    system : System
        In equilibrium at its present load parameter (time).
    step : float
        Load parameter of the first step, which fixes the length of the arc.
    until : float
        Stop when the load parameter has passed this value.
    steps : int
        Largest number of steps.
    scheme : ArcLength
    stop : callable
        Called with the system after each step; the path ends when it returns True.
    project : bool
        Accept an initial state that is moved far to fit the constraints; see `simulate`.

    Returns
    -------
    Result
        The times are the load parameters of the kept states; they need not grow.
    """
    steps = whole("arc_length", "steps", steps)
    result, books = begin(system, scheme or ArcLength(), project=project)
    for _ in advance(result, books, until=until, step=step):
        keep(result)
        if result.statistics.steps >= steps or (stop is not None and _stops(system, stop)):
            break
    return result


def _stops(system: System, stop: Callable[[System], bool]) -> bool:
    """Whether the user's function ends the path, in all processes alike."""
    found = np.array(bool(stop(system)))
    return bool(agreed(f"its answer at {system.time:g}", ["arc_length: stop"], [found])[0])


def follow_path(system: System, scheme: ArcLength, until: float, step: float) -> Iterator[LoadReport]:
    """Steps along the path; ``system.stepper.pace`` carries arcs, the last increment and the number of steps."""
    if not until > system.time:
        raise InputError(f"until = {until} is not after the present load parameter {system.time:g}")
    way = Way(system, scheme, step)
    while system.time < until and way.done < scheme.most:
        try:
            with Trial(system):
                iterations = way.go()
        except (NoEquilibrium, NotFinite) as failure:
            system.stepper.rejected += 1
            way.shorten(failure)
        except Passed:
            way.halve()
        else:
            way.record(iterations)
            yield LoadReport(iterations, iterations)


class Passed(Exception):
    """A step went beyond a critical point that is to be located."""


@dataclass
class Way:
    """Progress along a path, and the start of its next step; arcs are 0 before the first one."""

    system: System
    scheme: ArcLength
    unit: float

    def __post_init__(self) -> None:
        pace = self.system.stepper.pace
        kept = pace[NAME].arrays if NAME in pace else {}
        arcs: list[float] = kept.get("arcs", np.array([0.0, 0, 0, 0, 1])).tolist()
        self.arc, self.shortest, self.longest, self.done, looks = arcs
        self.previous: Array | None = kept.get("increment")
        self.leap = self.scheme.branch
        self.fork = Fork(Equilibrium(self.system, self.scheme)) if self.leap and looks else None
        self.is_near = False

    def go(self) -> int:
        """One step along the path, or off it where that forks; returns the iterations it took."""
        equations = Equilibrium(self.system, self.scheme)
        path = self.scheme.path(equations, self.unit)
        mode = critical_mode(equations, path.slope()) if self.fork and self.is_near else None
        iterations = self._along(path) if mode is None else self._across(path, mode)
        if self.fork and mode is None:
            if not self.is_near and self.fork.is_passed(path.time):
                raise Passed
            self.fork.go_on(path.time)
        equations.accept(path.time)
        self.is_near = False
        if mode is not None:
            self.fork = None
        return iterations

    def _along(self, path: Path) -> int:
        self.arc = path.predict(self.arc, self.previous)
        if self.longest == 0.0:
            self._measure(self.arc)
        iterations = path.correct(self.arc)
        self.increment = path.increment
        if self.previous is not None and path.retraced(self.increment, self.previous):
            raise NoEquilibrium(f"the path turns back at the load parameter {path.time:.6g}")
        return iterations

    def _across(self, path: Path, mode: Array) -> int:
        """The first step along the branch, as long as `leap`."""
        mode = mode * self.leap / path.length(mode, 0.0)
        path.equations.dx[:] += mode
        self.arc = abs(self.leap)
        iterations = path.correct(self.arc)
        self.increment = path.increment
        if path.product(self.increment, np.append(mode, 0.0)) < 0.5 * self.leap**2:
            raise NoEquilibrium(f"no branch goes along the mode at the load parameter {path.time:.6g}")
        self._measure(self.arc)
        return iterations

    def _measure(self, arc: float) -> None:
        self.longest, self.shortest = self.scheme.longest * arc, arc / 2**self.scheme.halvings

    def halve(self) -> None:
        """Come closer to a critical point that a step has passed."""
        self.is_near = self.arc <= NEAR * self.longest / self.scheme.longest
        self.arc *= 1.0 if self.is_near else 0.5

    def shorten(self, failure: RunError) -> None:
        """Try again with half the step, unless that is too short."""
        scheme = self.scheme
        leaps = self.is_near and self.fork is not None
        self.leap, self.arc = (0.5 * self.leap, self.arc) if leaps else (self.leap, 0.5 * self.arc)
        short = (
            abs(self.leap) < abs(scheme.branch) / 2**scheme.halvings if leaps else self.arc < self.shortest
        )
        if short or self.longest == 0.0:
            raise NoEquilibrium(f"{failure}; the arc was cut {scheme.halvings} times") from failure

    def record(self, iterations: int) -> None:
        """Remember the step that was accepted, and find the length of the next one."""
        self.previous = self.increment
        wanted = self.arc * float(np.sqrt(self.scheme.iterations / iterations))
        self.arc = min(wanted, self.longest)
        self.done += 1
        arcs = np.array([self.arc, self.shortest, self.longest, self.done, self.fork is not None])
        self.system.stepper.pace[NAME] = Record(NAME, VERSION, {"arcs": arcs, "increment": self.increment})


ROUNDING = 1e-12
"""Displacements in the measure of arcs that are rounding."""


@dataclass
class Path:
    """The extended system of an arc-length step: equilibrium and a sphere around the last one."""

    equations: Equilibrium
    unit: float
    load_weight: float
    time: float = field(init=False)

    def __post_init__(self) -> None:
        e = self.equations
        self.time = e.system.time
        moving = e.free & (e.system.order > 0)
        self.metric = np.where(moving, e.system.inverse_scale**2, 0.0) / max(int(moving.sum()), 1)

    def length(self, dx: Array, dt: float) -> float:
        """Length of an increment."""
        return float(np.sqrt(self.metric @ dx**2 + (self.load_weight * dt / self.unit) ** 2))

    def product(self, a: Array, b: Array) -> float:
        """Scalar product of two increments of unknowns and, as their last entries, the load parameter."""
        return float(self.metric @ (a[:-1] * b[:-1])) + (self.load_weight / self.unit) ** 2 * float(
            a[-1] * b[-1]
        )

    def retraced(self, a: Array, b: Array) -> bool:
        """True if both the displacements and the load parameter reversed: at a limit point only the load does."""
        return bool(self.metric @ (a[:-1] * b[:-1]) < 0 and a[-1] * b[-1] < 0)

    @property
    def increment(self) -> Array:
        """Of the unknowns and, last, of the load parameter."""
        return np.append(self.equations.dx, self.time - self.equations.system.time)

    def slope(self) -> Array:
        """Derivative of the residual by the load parameter at the present state."""
        return self.equations.slope(self.time, self.unit)

    def predict(self, arc: float, previous: Array | None) -> float:
        """Go along the tangent; without a given arc by the load `unit`. Returns the arc."""
        e = self.equations
        e.linearise(self.time)
        slope = self.slope()
        d = e.solve(self.time, slope)
        if previous is None:
            d = e.refined(self.time, slope, d)  # all arcs are measured by it
        dt = self.unit
        if previous is None and not self.length(d * self.unit, self.unit) > ROUNDING:
            raise InputError(
                "vv.arc_length: nothing moves with the load parameter: let a load grow with time, times='t', or take a "
                f"longer step (that of {self.unit:g} moves all by less than 1e-12 of the model's size), or count the "
                "load in the arc, vv.ArcLength(load_weight=0.01), where what cannot stretch stands until it buckles"
            )
        if previous is not None:
            dt = float(np.sign(self.product(np.append(d, 1.0), previous))) * arc / self.length(d, 1.0)
        else:
            arc = arc or self.length(d * dt, dt)
            dt = arc / self.length(d, 1.0)
        self.time = e.system.time + dt
        e.at(self.time)
        e.dx[e.free] += (dt * d)[e.free]
        return arc

    def correct(self, arc: float) -> int:
        """Newton's iteration of the extended system."""
        e, o, last = self.equations, self.equations.options, np.inf
        for k in range(o.max_iterations):
            r = e.linearise(self.time)
            slope = self.slope()
            d1, d2 = e.solve(self.time, r), e.solve(self.time, slope)
            dt = self.time - e.system.time
            w = (self.load_weight / self.unit) ** 2
            gap = float(self.metric @ e.dx**2) + w * dt**2 - arc**2
            denominator = 2 * (self.metric @ (e.dx * d2) + w * dt)
            change = -(gap + 2 * self.metric @ (e.dx * d1)) / denominator if denominator else np.inf
            if not np.isfinite(change):
                raise NoEquilibrium(
                    f"the arc-length iteration breaks down at the load parameter {self.time:.6g}"
                )
            d = d1 + change * d2
            size = e.size(d)
            if not np.isfinite(size) or size > 1e3:
                raise e.failure(self.time, "the arc-length iteration diverges")
            self.time += float(change)
            e.at(self.time)
            e.dx[e.free] += d[e.free]
            done = size <= o.tolerance * max(min(1.0, e.size(e.dx)), 1e-12)
            if done or e.is_exact(r, size, last):
                e.residual(self.time)
                return k + 1
            last = size
        raise e.failure(self.time, "no convergence of the arc-length iteration")
