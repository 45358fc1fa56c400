"""The system: numbers the unknowns of its components, hands them to the core, takes steps."""

from __future__ import annotations

import bisect
import weakref
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import Named, finite, positive, refuse_other
from visviva.base.errors import InputError, RunError, VisvivaError
from visviva.component.component import Component, characteristic_length, name_components, refuse_loose
from visviva.component.point import Attachable
from visviva.linear.choice import Automatic, Direct, Problem
from visviva.model.field import Field
from visviva.model.form import Form, Strain, Vector
from visviva.model.model import Model
from visviva.scheme.clock import Clock
from visviva.scheme.schemes import EnergyMomentum, Scheme, load_step
from visviva.system.build import build_core
from visviva.system.memory import Trial, undisturbed
from visviva.system.newton import Newton, StepFailure
from visviva.system.problem import problem_of, rigid_modes, uses_null_space
from visviva.system.stability import Stability

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.check import CheckReport

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Attempt:
    """A step whose equations are solved, with the prescribed functions it saw and the core's report."""

    step: Any
    signals: Array
    report: Any


class System(metaclass=Named):
    """A set of components as one system of equations.

    Parameters
    ----------
    components : sequence of Component
        Bodies, joints, forces. Order does not matter for the physics.
    newton : Newton
        Options of the solver.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> system = vv.System([ground, ball, rod, vv.Gravity()])
    >>> system.n_coordinates, system.n_constraints
    (3, 1)
    """

    def __init__(self, components: Sequence[Component], newton: Newton | None = None) -> None:
        refuse_other("System", "components", components, Iterable, "a list of components")
        refuse_other("System", "newton", newton, Newton | None, "Newton(...)")
        self.components = list(components)
        self._newton = newton or Newton()
        self.clock = Clock()
        self.rejected = 0
        self._repeated: tuple[Scheme, float, Any] | None = None  # the last step; its tables are made once
        self._last: tuple[Any, Array] | None = None  # step and signals that led to the present state
        self.is_given = True  # whether the state was given, and is not that of a step
        self.is_undisturbed = False  # whether what is done now leaves no trace
        self.is_edited = False  # whether the state was touched since the last step, or the last check
        self.stability = Stability()  # of the equilibria that statics has found
        self.pace: dict[str, Array] = {}  # what chooses the steps carries on, for restarts
        self.has_acceleration = False
        self.report: CheckReport | None = None  # of the check before the first step
        self._pattern: tuple[int, tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]] | None = (
            None
        )
        name_components(self.components)
        refuse_loose(self.components)
        self.model = Model(self.components, length=characteristic_length(self.components))
        for c in self.components:
            owner = getattr(c, "_system", lambda: None)()
            if owner is not None and any(
                c is other for other in owner.components
            ):  # a copy keeps the reference
                raise InputError(
                    f"{c.label} belongs to another system; copy.deepcopy the components before reuse"
                )
            c._system = weakref.ref(self)  # type: ignore[attr-defined]
        for c in self.components:
            c.announce(self.model)
        for c in sorted(
            self.components, key=lambda c: not isinstance(c, Attachable)
        ):  # joints attach to bodies
            c.declare(self.model)
        for c in sorted(self.components, key=lambda c: c.contributes_last):
            c.contribute(self.model)
        if not self.model.fields:
            raise InputError("the system has no unknowns: add a body or another component that can move")
        fields = self.model.fields
        order = np.concatenate([np.full(f.size, f.order, dtype=np.int32) for f in fields])
        self.order = np.where(self.local < 0, order, 0)  # what elements have alone follows the coordinates
        self.core = build_core(self)
        self.choose_linear()
        self.core.x[:] = np.concatenate([f.values for f in fields])
        self.core.v[:] = np.concatenate([f.rates for f in fields])
        self._signals = np.zeros((4, max(len(self.model.signals), 1)))
        self._check_finite()

    # --- construction --------------------------------------------------------------------------------------
    @property
    def newton(self) -> Newton:
        """Options of the solver; new ones hold from the next step on.

        Raises
        ------
        InputError
            If they change the elimination of rigid bodies, which the equations are numbered for.
        """
        return self._newton

    @newton.setter
    def newton(self, newton: Newton) -> None:
        refuse_other("System", "newton", newton, Newton, "Newton(...)")
        if newton.null_space != self._newton.null_space:
            raise InputError(
                "Newton(null_space=...) is chosen when a system is made: System(components, newton=...)"
            )
        self._newton = newton
        self.choose_linear(inertia=self.has_inertia, discrete_gradient=self.has_discrete_gradient)

    @cached_property
    def local(self) -> NDArray[np.int32]:
        """Element (n,) that alone touches each unknown, numbered through all fields, or -1.

        Block elimination of rigid bodies, if it is forced, takes all blocks alike.
        """
        parts, first = [], 0
        for f in self.model.fields:
            parts.append(np.where(f.element >= 0, f.element + first, -1))
            first = max(first, int(parts[-1].max(initial=-1)) + 1)
        local: NDArray[np.int32] = np.concatenate(parts).astype(np.int32)
        return np.full_like(local, -1) if self.newton.null_space else local

    def choose_linear(self, *, inertia: bool = True, discrete_gradient: bool = True) -> None:
        """Hand the linear solvers to the core; rigid bodies by block elimination, small systems by sparse LU.

        Without masses block elimination has no pivots; then solvers are taken that pivot freely. Discrete gradients
        are not quite symmetric.
        """
        self.has_inertia, self.has_discrete_gradient = inertia, discrete_gradient
        core, options = self.core, self.newton.linear
        if options is not None and self.newton.null_space:
            raise InputError("Newton(linear=...) and null_space=True exclude each other: choose one")
        problem, by_blocks = problem_of(self), uses_null_space(self)
        if options is None and inertia and (by_blocks or problem.is_plain):
            core.use_solver(by_blocks, self.newton.regularization)
            self._project_in_core(by_blocks)
            self.linear_explanation = f"{core.n_equations} equations: {core.solver}"
            return
        core.set_modes(rigid_modes(self.model))
        choice = (options or Automatic()).choose(problem)
        core.use_linear(list(choice.in_order))
        self._project_in_core(False)
        self.linear_explanation = choice.explanation

    def _project_in_core(self, by_blocks: bool) -> None:
        """Let the core project the rates of motion, the equations of which are symmetric: mass and constraints."""
        if not self.has_lasting_constraints or np.any(self.order == 1):
            return
        if self.model.has_servo:
            return
        constraint = self.is_lasting_constraint.astype(np.int32)
        regularization = self.newton.regularization
        row, col, _ = self.core.csr
        rates = Problem(
            n=len(row) - 1,
            n_entries=len(col),
            symmetric=True,
            n_multipliers=int(constraint.sum()),
            regularization=regularization,
        )
        if by_blocks or rates.is_small:
            self.core.use_rate_solver(by_blocks, regularization, constraint)
        else:
            self.core.use_rate_linear(list(Direct().choose(rates).in_order), constraint)

    def _check_finite(self) -> None:
        if np.isfinite(self.x).all() and np.isfinite(self.v).all():
            return
        for f in self.model.fields:
            if not (np.isfinite(f.values).all() and np.isfinite(f.rates).all()):
                raise InputError(
                    f"{f.component.label}: its initial {f.name} is not finite: {f.values.tolist()}"
                )

    @property
    def time(self) -> float:
        """Present time; setting it begins a new count of steps."""
        return self.clock.time

    @time.setter
    def time(self, time: float) -> None:
        self.clock.restart(finite("System", "time", time))

    # --- what is in it -------------------------------------------------------------------------------------
    @property
    def n_coordinates(self) -> int:
        """Unknown coordinates n, augmented ones included, multipliers not."""
        return sum(int(np.sum(~f.fixed)) for f in self.model.fields if f.order > 0 and not f.is_local)

    @cached_property
    def is_lasting_constraint(self) -> NDArray[np.bool_]:
        """Unknowns (n,) that are multipliers of constraints which hold at every instant."""
        return np.concatenate([np.full(f.size, f.multiplier and f.instantaneous) for f in self.model.fields])

    @property
    def has_lasting_constraints(self) -> bool:
        """Whether there are some."""
        fixed = np.concatenate([f.fixed for f in self.model.fields])
        return bool((self.is_lasting_constraint & ~fixed).any())

    @cached_property
    def scale(self) -> Array:
        """Size (n,) by which a change of each unknown is judged; 0 where it is not."""
        return np.concatenate([f.scale for f in self.model.fields])

    @cached_property
    def inverse_scale(self) -> Array:
        """Its inverse; 0 where changes are not judged."""
        return np.where(self.scale > 0, 1 / np.where(self.scale > 0, self.scale, 1.0), 0.0)

    @property
    def n_constraints(self) -> int:
        """Constraints m."""
        return sum(f.size for f in self.model.fields if f.multiplier)

    @property
    def x(self) -> Array:
        """Present unknowns, a view; after changing it call `touch`."""
        return self.core.x

    @property
    def v(self) -> Array:
        """Present rates, a view; after changing it call `touch`."""
        return self.core.v

    def touch(self) -> None:
        """Tell the core that the state was changed from outside; if it was not, nothing happens."""
        if self.core.is_unchanged:
            return
        self._last = None
        self.is_edited = self.is_given = True
        self.has_acceleration = False
        self.core.invalidate()

    def describe(self, unknown: int) -> tuple[str, str]:
        """Component and unknown of a number, in words."""
        for f in self.model.fields:
            if unknown in f.unknowns:
                return f.component.label, f"{f.name}[{unknown - f.start}]"
        return "the system", "unknown"

    def field(self, component: Component, name: str) -> Field:
        """A field of a component by its name."""
        for f in self.model.fields:
            if f.component is component and f.name == name:
                return f
        refuse_other("System.field", "component", component, Component, "a component of the system")
        names = [f.name for f in self.model.fields if f.component is component]
        raise InputError(f"{component.label} has no field {name!r}; it has {names}")

    def value(self, what: Form | Vector | Strain) -> Any:
        """Present value of a form, vector or strain."""
        wanted = "a form, vector or strain such as body.point().position (call measures with the system)"
        refuse_other("System.value", "what", what, Form | Vector | Strain, wanted)
        return what.value(self.x)

    # --- stepping ------------------------------------------------------------------------------------------
    @cached_property
    def _kinks(self) -> list[float]:
        """All known kinks of prescribed functions, of loads too, in order."""
        return sorted({t for f in self.model.signals for t in f.kinks} | set(self.model.kinks))

    def next_kink(self, until: float) -> float:
        """The next time at which a prescribed function has a kink, `until` at most."""
        k = bisect.bisect_right(self._kinks, self.time + self.clock.rounding(self.time))
        return min(self._kinks[k], until) if k < len(self._kinks) else until

    def signals(self, step: Any) -> Array:
        """Prescribed functions of time at the step: rows for t0, te, t1 and the rate at t1."""
        s, length = self._signals, step.h if step.has_length else self.clock.step
        for k, f in enumerate(self.model.signals):
            rate = f.rate_after if f.kinks and not step.has_length else f.rate
            s[:, k] = f(step.t0), f(step.te), f(step.t1), rate(step.t1, length)
        if self.model.signals and not np.all(np.isfinite(s)):
            k = int(np.argmin(np.isfinite(s).all(axis=0)))
            raise RunError(f"a prescribed function of time gave {s[:, k].tolist()} near t = {step.t1:g}")
        return s

    def step(self, h: float, scheme: Scheme | None = None) -> Any:
        """Advance by one step of length `h`; if it does not converge, `StepFailure` and the state is kept."""
        scheme = EnergyMomentum() if scheme is None else scheme
        repeated = self._repeated
        if repeated is None or repeated[1] != h or (repeated[0] is not scheme and repeated[0] != scheme):
            h = positive("System.step", "h", h)
            refuse_other("System.step", "scheme", scheme, Scheme, "a scheme such as vv.EnergyMomentum()")
            repeated = self._repeated = scheme, h, scheme.step(self.time, h)
        step = repeated[2].moved_to(self.time)
        if self.projects(scheme):
            attempt = self.attempt(step)
            self.accept(attempt, scheme)
            return attempt.report
        signals = self.signals(step).copy() if self.model.signals else None
        report = self._solved(self.core.advance, step, signals)
        self._arrive(step, self._signals if signals is None else signals, scheme)
        return report

    def _arrive(self, step: Any, signals: Array, scheme: Scheme) -> None:
        self._last, self.is_edited, self.is_given = (step, signals), False, False
        self.clock.advance(step.h)
        self.has_acceleration = self.has_acceleration and scheme.needs_acceleration
        if self.model.kinks and scheme.keeps_swinging:
            near = self.clock.rounding(self.time)
            passed = [t for t in self.model.kinks if self.time - step.h + near < t <= self.time + near]
            if passed:
                self._follow_kinks(set().union(*(self.model.kinks[t] for t in passed)))

    def _follow_kinks(self, accounts: set[int]) -> None:
        """Give what is driven the rates behind a kink of its motion, by impulses whose work these accounts share."""
        from visviva.system.consistency import project_velocities

        last, before = self._last, self.core.energy.sum()
        self.follow_prescribed()
        if self.n_constraints:
            project_velocities(self)
        self._take_stock_again()
        self.core.work[list(accounts)] += (self.core.energy.sum() - before) / len(accounts)
        self._last, self.is_edited, self.is_given = last, False, False

    def prescribe(self, step: Any) -> None:
        """Put the increments of prescribed unknowns into the core's ``dx``, which keeps them while it solves."""
        for p in self.model.prescribed:
            values = p.values(step.t1)
            if not np.isfinite(values).all():
                raise RunError(f"{p.component.label}: its motion is not finite at t = {step.t1:g}")
            self.core.dx[p.unknowns] = values - self.x[p.unknowns]

    def attempt(self, step: Any) -> Attempt:
        """Solve a step's equations; its increment is then the core's ``dx``, to be accepted or discarded."""
        signals = self.signals(step).copy()
        return Attempt(step, signals, self._solved(self.core.solve, step, signals))

    def _solved(self, solve: Callable[..., Any], step: Any, signals: Array | None) -> Any:
        """Report of the core's function that solves a step; if it fails, the increment is discarded."""
        newton = self.newton
        with Trial(self):
            self.prescribe(step)
            options = newton.tolerance, newton.max_iterations, self._keep_factor, self._tangents
            report = solve(step, signals, *options)
            if not report.converged:
                raise StepFailure(self, self.time, step.h, report)
        return report

    def trouble(self) -> str:
        """What components find wrong with the trial state, in sentences; empty if nothing."""
        trial = self.x + self.core.dx
        if not np.isfinite(trial).all():
            return ""
        with suppress(VisvivaError), np.errstate(all="ignore"):  # of a user's function; states may be wild
            return "".join(f"{found}. " for c in self.components if (found := c.trouble(trial)))
        return ""

    def follow_prescribed(self) -> None:
        """Give prescribed unknowns the rates that they have from the present time on."""
        for p in self.model.prescribed:
            self.v[p.unknowns] = p.rates(self.time, self.clock.step)
        self.touch()

    @property
    def _tangents(self) -> int:
        """So many iterations of a step make tangents of their own; unless given what the components ask for."""
        given = self.newton.tangents
        return self._asked_tangents if given is None else given

    @cached_property
    def _asked_tangents(self) -> int:
        return max(c.least_tangents for c in self.components)

    @property
    def _keep_factor(self) -> float:
        """A kept tangent and redundant constraints do not go together: their multipliers wander off."""
        redundant = self.report is not None and self.report.redundant
        return 0.0 if redundant else self.newton.keep_factor

    def accept(self, attempt: Attempt, scheme: Scheme) -> None:
        """Make the increment of an attempt the new state."""
        project = self.projects(scheme)
        x0, dx = (self.x.copy(), self.core.dx.copy()) if project else (self.x, self.x)
        with Trial(self):
            self.core.accept(attempt.step, attempt.signals, True)
        self._arrive(attempt.step, attempt.signals, scheme)
        if project:
            self._project_step(scheme, x0, dx)

    def projects(self, scheme: Scheme) -> bool:
        """Whether rates are projected here, as the core does not."""
        if not scheme.projects_velocity or self.core.projects_rates:
            return False
        return self.constrains_motion if scheme.needs_acceleration else self.has_lasting_constraints

    @cached_property
    def constrains_motion(self) -> bool:
        """Whether constraints act on motion alone: flows and servos keep the rates that the scheme gives."""
        from visviva.system.instant import Instant

        if not self.n_constraints or self.model.has_servo:
            return False
        with undisturbed(self):
            at = Instant(self)
        touched = abs(at.G).sum(axis=0) > 0
        return bool(touched.any() and (self.order[at.coordinates[touched]] == 2).all())

    def _project_step(self, scheme: Scheme, x0: Array, dx: Array) -> None:
        """Project the rates of the accepted step and book it again with them."""
        from visviva.system.consistency import project_step

        assert self._last is not None
        step = self._last[0]
        work = project_step(self, step, scheme.motion(step.h), x0, x0 + dx)
        self._take_stock_again()
        for (_, account), part in zip(self.model.drives, work, strict=True):
            self.core.work[account] += part

    def _take_stock_again(self) -> None:
        """The sums of the state after its rates were changed, as the step leaves it; the works of the step stay."""
        self.core.mark_state()
        work = self.core.work.copy()
        self.take_stock()
        self.core.work[:] = work

    def take_stock(self) -> None:
        """Fill the core's sums with the present state."""
        step = load_step(self.time, 0.0)
        self.core.evaluate_ledger(step, self.signals(step), self.has_inertia)

    @property
    def pattern(self) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]:
        """Rows and columns of the tangent's compressed rows, and the unknown of every row.

        Contact brings new neighbours together, and then it changes.
        """
        if self._pattern is None or self._pattern[0] != self.core.revision:
            row, col, unknown = self.core.csr
            arrays = np.array(row, np.int64), np.array(col, np.int32), np.array(unknown, np.int64)
            self._pattern = self.core.revision, arrays
        return self._pattern[1]

    @property
    def free_equations(self) -> NDArray[np.int64]:
        """Equations of free unknowns; fixed components of mesh nodes have equations too."""
        fixed = np.concatenate([f.fixed for f in self.model.fields])
        return np.flatnonzero(~fixed[self.pattern[2]])

    @property
    def free_unknowns(self) -> NDArray[np.int64]:
        """The unknowns of the tangent's rows."""
        return self.pattern[2][self.free_equations]

    def residual(self, step: Any, signals: Array | None = None) -> Array:
        """Residual by unknown at the present trial state."""
        residual = np.zeros(len(self.x))
        self.core.find_neighbours()
        self.core.assemble(step, self.signals(step) if signals is None else signals, residual, None)
        return residual

    def holding_forces(self) -> Array:
        """Residual by unknown of the last step: at fixed unknowns, the forces that hold them.

        The midpoint schemes balance forces in the middle of the step. Without a step (at the start, or after
        the state was changed by hand) these are the forces of the present configuration, without inertia.
        """
        if self._last is None:
            return self.residual(load_step(self.time, 0.0))
        residual = np.zeros(len(self.x))
        self.core.forces(*self._last, residual)
        return residual

    def tangent(self, step: Any) -> tuple[Array, sp.csr_array]:
        """Residual by unknown and tangent over the free unknowns at the present trial state."""

        import scipy.sparse as sp

        self.core.find_neighbours()
        row, col, unknown = self.pattern
        values = np.zeros(len(col))
        residual = np.zeros(len(self.x))
        self.core.assemble(step, self.signals(step), residual, values)
        n = len(unknown)
        K = sp.csr_array((values, col, row), shape=(n, n))
        free = self.free_equations
        return residual, K if len(free) == n else K[free][:, free]

    @property
    def last_step(self) -> float:
        """Length of the step that led to the present state; 0 without one."""
        return 0.0 if self._last is None else float(self._last[0].h)

    def gauges(self) -> dict[str, float]:
        """Numbers of the components about the last step, such as a flow's CFL number; the largest of each name."""
        found: dict[str, float] = {}
        for c in self.components:
            for name, value in c.gauges(self).items():
                found[name] = max(value, found.get(name, value))
        return found

    def check(self, repair: bool = True) -> CheckReport:
        """Look the system over before its first step; see `visviva.system.check.check`.

        The state of a step is told about, not repaired: the run goes on to the bit as if nobody had looked.
        """
        from visviva.system.check import check

        if not self.is_given:
            with undisturbed(self):
                return check(self, repair=False)
        self.report = check(self, repair=repair)
        return self.report
