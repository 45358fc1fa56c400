"""Equilibrium paths followed by their length, through limit points of load and of displacement."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.load_steps import Equilibrium, LoadReport, NoEquilibrium, Static
from visviva.analysis.march import advance, begin, keep
from visviva.base.arguments import bounded, whole
from visviva.base.errors import InputError
from visviva.results.result import Result
from visviva.system.memory import Trial
from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ArcLength(Static):
    """Statics that follow an equilibrium path by its length through limit points (Riks 1979, Crisfield 1981).

    The first step goes along the path by the load `step`, and fixes the length of the arc. Time is the load parameter,
    which may fall; the path ends when it has passed the end time, or after `most` steps.

    Parameters
    ----------
    load_weight : float
        Weight of the load parameter, relative to the step, in the arc length; displacements count relative to the size
        of the model, as root mean square over the moving unknowns. 0 is the cylindrical method.
    iterations : int
        Wanted number of iterations; the arc grows or shrinks to meet it.
    longest : float
        Largest growth of the arc, relative to the first.
    most : int
        Largest number of steps.
    """

    line_search: bool = False
    unstable: bool = True
    load_weight: float = 0.0
    iterations: int = 5
    longest: float = 8.0
    most: int = 1000
    has_growing_time: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        bounded(self, load_weight=(0.0, 1e12), iterations=(1, 1e9), longest=(1.0, 1e12), most=(1, 1e9))

    def march(self, system: System, *, until: float, step: float) -> Iterator[LoadReport]:
        return follow_path(system, self, until, step)


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
        if result.statistics.steps >= steps or (stop is not None and stop(system)):
            break
    return result


def follow_path(system: System, scheme: ArcLength, until: float, step: float) -> Iterator[LoadReport]:
    """Steps along the path; ``system.pace`` carries arcs, the last increment and the number of steps."""
    arc, shortest, longest, done = system.pace.get("arcs", np.zeros(4)).tolist()
    previous = system.pace.get("increment")
    while system.time < until and done < scheme.most:
        equations = Equilibrium(system, scheme)
        path = Path(equations, step, scheme.load_weight)
        try:
            with Trial(system):
                arc = path.predict(arc, previous)
                if longest == 0.0:
                    longest, shortest = scheme.longest * arc, arc / 2**scheme.halvings
                iterations = path.correct(arc)
                increment = np.append(equations.dx, path.time - system.time)
                if previous is not None and path.retraced(increment, previous):
                    raise NoEquilibrium(f"the path turns back at the load parameter {path.time:.6g}")
                equations.accept(path.time)
        except NoEquilibrium as failure:
            system.rejected += 1
            arc /= 2
            if arc < shortest or longest == 0.0:
                raise NoEquilibrium(f"{failure}; the arc was cut {scheme.halvings} times") from failure
            continue
        previous = increment
        arc = min(arc * float(np.sqrt(scheme.iterations / iterations)), longest)
        done += 1
        system.pace |= {"arcs": np.array([arc, shortest, longest, done]), "increment": increment}
        yield LoadReport(iterations, iterations)


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
        """Whether displacements and load parameter both turned: at limit points only one of them does."""
        return bool(self.metric @ (a[:-1] * b[:-1]) < 0 and a[-1] * b[-1] < 0)

    def predict(self, arc: float, previous: Array | None) -> float:
        """Go along the tangent; without a given arc by the load `unit`. Returns the arc."""
        e = self.equations
        e.linearise(self.time)
        d = e.solve(self.time, e.slope(self.time, self.unit))
        dt = self.unit
        if not self.length(d, 1.0):
            raise InputError(
                "vv.arc_length: nothing moves with the load parameter: let a load grow with time, times='t'"
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
            slope = e.slope(self.time, self.unit)
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
            if done or (size > 0.5 * last and size <= 1e-13):
                e.residual(self.time)
                return k + 1
            last = size
        raise e.failure(self.time, "no convergence of the arc-length iteration")
