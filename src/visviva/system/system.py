"""The system: numbers the unknowns of its components, hands them to the core, takes steps."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from threading import RLock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import Named, finite, refuse_other
from visviva.base.errors import InputError, RunError, nearest
from visviva.base.html import table
from visviva.base.renamed import Renamed
from visviva.base.unit_labels import Units
from visviva.component.component import (
    Component,
    begin_anew,
    begin_if_set,
    characteristic_length,
    claimed,
    refuse_changed,
)
from visviva.component.connected import lengths_of_parts
from visviva.component.point import Attachable
from visviva.model.composition import Composition
from visviva.model.field import Field
from visviva.model.form import Form, Strain, Vector, refuse_foreign
from visviva.model.model import Model
from visviva.scheme.clock import Clock
from visviva.scheme.schemes import EnergyMomentum, Scheme, load_step
from visviva.system import agreement, averaged, steps
from visviva.system.build import build_core, check_finite
from visviva.system.memory import before_last_step, take_over, undisturbed
from visviva.system.newton import Newton
from visviva.system.problem import hand_solvers
from visviva.system.shared import square, whole_rows
from visviva.system.stepper import Stepper
from visviva.system.steps import Attempt
from visviva.system.tied_heat import even_out

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.check import CheckReport
    from visviva.system.present import Present

Array = NDArray[np.float64]

MOST_SHOWN = 30
"""Components that a notebook lists."""
Pattern = tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]


def refuse_no_system(whose: str, system: Any) -> None:
    """Refuse what is no system, as components alone are none."""
    if isinstance(system, Component) or (isinstance(system, list | tuple) and system):
        kind = type(system).__name__
        raise InputError(
            f"{whose}: system is a vv.System, not a {kind}; put the components into one: vv.System([...])"
        )
    refuse_other(whose, "system", system, System, "a vv.System")


class System(metaclass=Named):
    """A set of components as one system of equations.

    Parameters
    ----------
    components : sequence of Component
        Bodies, joints, forces. Order does not matter for the physics.
    newton : Newton
        Options of the solver.
    units : str or mapping, optional
        Names of the units in which the numbers of the model are meant: ``"SI"``, ``"N-mm-t"`` (force, length, mass; the
        time follows), or names by quantity, ``{"length": "mm", "force": "N", "stress": "MPa"}``. They are written into
        plots, pictures, tables and files, and multiply nothing.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    >>> rod = vv.Distance(a=ground.point(), b=ball.point())
    >>> system = vv.System([ground, ball, rod, vv.Gravity()])
    >>> system.n_coordinates, system.n_constraints
    (3, 1)
    """

    def __init__(
        self, components: Sequence[Component], newton: Newton | None = None, *, units: Any = None
    ) -> None:
        refuse_other("System", "components", components, Iterable, "a list of components")
        refuse_other("System", "newton", newton, Newton | None, "Newton(...)")
        self._components, self._newton = tuple(components), newton or Newton()
        self.units, self.turn = units, RLock()  # of the thread that works on it
        begin_if_set(self.components)
        self._compose()

    def _compose(self, before: Composition | None = None) -> None:
        """Number the unknowns of the components, and hand them to the core."""
        self.stepper, self.composition = Stepper(), Composition()  # by which others know whether it is theirs
        self.changed: dict[str, list[str]] = {}  # arguments of components that were set since
        self.is_undisturbed = False  # whether what is done now leaves no trace
        self._present: Present | None = None
        self.report: CheckReport | None = None  # of the check before the first step
        self._pattern: tuple[int, Pattern] | None = None
        with claimed(self, self.components):
            lengths = lengths_of_parts(self.components, length := characteristic_length(self.components))
            self.model = Model(self.components, length=length, lengths=lengths, _composition=self.composition)
            agreement.refuse_different(self.components, self.newton)
            for c in self.components:
                c.announce(self.model)
            rank = lambda c: (not isinstance(c, Attachable), c.contributes_last)  # noqa: E731
            for c in sorted(self.components, key=rank):  # joints attach to bodies
                c.declare(self.model)
            for c in sorted(self.components, key=lambda c: c.contributes_last):
                c.contribute(self.model)
        if not self.model.fields:
            raise InputError("the system has no unknowns: add a body or another component that can move")
        fields = self.model.fields
        self.composition.settle(fields, before)
        order = np.concatenate([np.full(f.size, f.order, dtype=np.int32) for f in fields])
        self.order = np.where(self.local < 0, order, 0)  # what elements have alone follows the coordinates
        self.core = build_core(self)
        self.choose_linear()
        self.core.x[:], self.core.v[:] = self.model.initial
        check_finite(self)
        even_out(self)

    def __getitem__(self, name: str) -> Any:
        """A component by its name.

        Raises
        ------
        InputError
            With the nearest name, if there is none.
        """
        found = {str(c.name): c for c in self.components}
        if name not in found:
            raise InputError(f"System: there is no component {name!r}{nearest(str(name), found)}")
        return found[name]

    def reset(self) -> None:
        """Compose the system anew from the same components: it is at time zero, as if it had never moved.

        Arguments of components that were changed since take effect.

        Examples
        --------
        >>> import visviva as vv
        >>> ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
        >>> system = vv.System([ball])
        >>> ends = []
        >>> for _ in range(2):
        ...     system.reset()
        ...     _ = vv.simulate(system, until=1.0, step=0.1)
        ...     ends.append(float(system.x[0]))
        >>> ends[0] == ends[1]
        True
        """
        before = self.composition
        kept = {name: vars(self)[name] for name in ("_components", "_newton", "_units", "turn")}
        vars(self).clear()
        vars(self).update(kept)
        begin_anew(self.components)
        self._compose(before)

    def copy(self) -> System:
        """A second system of the same components, also copies, in the same state; neither knows of the other.

        Its components are found by their names: ``system.copy()["ball"]``.

        Examples
        --------
        >>> import visviva as vv
        >>> system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")])
        >>> _ = vv.simulate(system, until=1.0, step=0.1)
        >>> twin = system.copy()
        >>> _ = vv.simulate(twin, until=2.0, step=0.1)
        >>> round(system.time), round(twin.time), round(float(twin.x[0]), 9)
        (1, 2, 2.0)
        """
        refuse_changed(self)
        parts = copy.deepcopy(self.components)
        twin = System(parts, self.newton, units=self.units)
        twin.choose_linear(inertia=self.has_inertia, discrete_gradient=self.has_discrete_gradient)
        take_over(twin, self)
        twin.report = self.report
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> System:
        return self.copy()

    def __repr__(self) -> str:
        return (
            f"System({len(self.components)} components, n = {self.n_coordinates}, m = {self.n_constraints}, "
            f"t = {self.time:g})"
        )

    def _repr_html_(self) -> str:
        rows = [
            (type(c).__name__, c.name, f"{c.total_mass:.6g}" if c.total_mass else "") for c in self.components
        ]
        more = [("", f"... {len(rows) - MOST_SHOWN} more", "")] if len(rows) > MOST_SHOWN else []
        return table([*rows[:MOST_SHOWN], *more], ("component", "name", "mass"), repr(self))

    @property
    def components(self) -> tuple[Component, ...]:
        """Its components, which are those it was made of."""
        return self._components

    @property
    def units(self) -> Units:
        """Names of the units of its numbers, labels alone."""
        return self._units

    @units.setter
    def units(self, units: Units | str | Mapping[str, str] | None) -> None:
        self._units = Units.of(units)

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
        agreement.refuse_different_newton(newton)
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
        self.linear_explanation = hand_solvers(self)

    @property
    def clock(self) -> Clock:
        """The clock that counts its steps."""
        return self.stepper.clock

    @property
    def is_given(self) -> bool:
        """Whether the state was given, and is not that of a step."""
        return self.stepper.is_given

    @property
    def solves_means(self) -> bool:
        """Whether multipliers are means over the last step, or not known yet."""
        return self.stepper.solves_means

    @property
    def time(self) -> float:
        """Present time; setting it begins a new count of steps."""
        return self.clock.time

    @time.setter
    def time(self, time: float) -> None:
        self.clock.restart(finite("System", "time", time))

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
        """True if some unknown that is not fixed is a multiplier of a constraint that holds at every instant."""
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
        return sum(int(np.sum(~f.fixed)) for f in self.model.fields if f.multiplier)

    @property
    def x(self) -> Array:
        """Present unknowns, a view; after changing it call `invalidate`."""
        return self.core.x

    @property
    def v(self) -> Array:
        """Present rates, a view; after changing it call `invalidate`."""
        return self.core.v

    touch, take_stock = Renamed("invalidate"), Renamed("evaluate_ledger")

    def invalidate(self) -> None:
        """Tell the core that the state was changed from outside; if it was not, nothing happens."""
        if self.core.is_unchanged:
            return
        self.stepper.edited()
        self.core.invalidate()

    def describe(self, unknown: int) -> tuple[str, str]:
        """Component and unknown of a number, in words."""
        return self.composition.describe(unknown)

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
        refuse_foreign("System.value", what, self.composition)
        return what.value(self.x)

    @cached_property
    def kinks(self) -> list[float]:
        """All known kinks of prescribed functions, of loads too, in order."""
        return self.model.driving.all_kinks()

    def signals(self, step: Any) -> Array:
        """Prescribed functions of time at the step: rows for t0, te, t1 and the rate at t1."""
        length = step.h if step.has_length else self.clock.step
        return agreement.agreed_signals(self.model.driving, step, length)

    def step(self, h: float, scheme: Scheme | None = None) -> Any:
        """Advance by one step of length `h`; if it does not converge, `StepFailure` and the state is kept."""
        refuse_changed(self)
        return steps.take(self, h, EnergyMomentum() if scheme is None else scheme)

    def attempt(self, step: Any) -> Attempt:
        """Solve a step's equations; its increment is then the core's ``dx``, to be accepted or discarded."""
        return steps.solved(self, step)

    def accept(self, attempt: Attempt, scheme: Scheme) -> None:
        """Make the increment of an attempt the new state."""
        steps.accept(self, attempt, scheme)

    @cached_property
    def asked_tangents(self) -> int:
        """Number of iterations of a step that make tangents of their own, as the components ask for."""
        return max(c.least_tangents for c in self.components)

    def prescribe(self, step: Any) -> None:
        """Put the increments of prescribed unknowns into the core's ``dx``, which keeps them while it solves."""
        moved = self.model.driving.prescribed
        for p, values in zip(moved, agreement.agreed_motions(self, step.t1), strict=True):
            if not np.isfinite(values).all():
                raise RunError(f"{p.component.label}: its motion is not finite at t = {step.t1:g}")
            self.core.dx[p.unknowns] = values - self.x[p.unknowns]

    def follow_prescribed(self) -> None:
        """Give prescribed unknowns the rates that they have from the present time on."""
        for p, rates in zip(self.model.driving.prescribed, agreement.agreed_rates(self), strict=True):
            self.v[p.unknowns] = rates
        self.invalidate()

    def projects(self, scheme: Scheme) -> bool:
        """Whether rates are projected here, as the core does not."""
        if not scheme.projects_velocity or self.core.projects_rates:
            return False
        return self.constrains_motion if scheme.needs_acceleration else self.has_lasting_constraints

    @cached_property
    def constrains_motion(self) -> bool:
        """Whether constraints act on motion alone: flows keep the rates that the scheme gives."""
        from visviva.system.instant import Instant

        if not self.n_constraints:
            return False
        with undisturbed(self):
            at = Instant(self)
        return bool(abs(at.G[at.of_motion]).sum() > 0)

    def evaluate_ledger(self) -> None:
        """Fill the core's sums with the present state."""
        step = load_step(self.time, 0.0)
        self.core.evaluate_ledger(step, self.signals(step), self.has_inertia)

    @property
    def pattern(self) -> Pattern:
        """Rows and columns of the tangent's compressed rows, and the unknown of every row.

        Contact brings new neighbours together, and then it changes. In one process columns are the core's own, which
        last until it does: copy what is kept longer.
        """
        if self._pattern is None or self._pattern[0] != self.core.revision:
            row, col, unknown = whole_rows(self.core)[0]
            arrays = np.array(row, np.int64), np.asarray(col, np.int32), np.array(unknown, np.int64)
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
        forces = self.forces_of_step()
        return averaged.forces_at_rest(self) if forces is None else forces

    def forces_of_step(self) -> Array | None:
        """The same of the last step alone, none without one; restarts keep them."""
        last, told = self.stepper.last, self.stepper.told_forces
        if last is None:
            return None if told is None else told.copy()
        residual = np.zeros(len(self.x))
        with before_last_step(self):
            self.core.forces(*last, residual)
        return residual

    @property
    def present(self) -> Present:
        """Forces of constraints at this instant."""
        from visviva.system.present import Present

        if self._present is None or not self._present.is_of(self):
            self._present = Present(self)
        return self._present

    @property
    def x_with_reactions(self) -> Array:
        """The unknowns (n,), with those multipliers of lasting constraints, and those pressures, of this instant.

        Statics and schemes that balance forces at the end of a step have them in their unknowns; others have means
        over the step there, as they have for pressures of mixed solids with heat.
        """
        in_unknowns = not self.solves_means or not self.has_inertia
        differs = self.has_lasting_constraints or averaged.has_averages(self)
        return self.x if in_unknowns or not differs else self.present.x

    def tangent(self, step: Any) -> tuple[Array, sp.csr_array]:
        """Residual by unknown and tangent over the free unknowns at the present trial state."""
        self.core.find_neighbours()
        row, col, _ = self.pattern
        residual, values = np.zeros(len(self.x)), np.zeros(len(self.core.csr[1]))
        self.core.assemble(step, self.signals(step), residual, values)
        _, whole = whole_rows(self.core, values)
        assert whole is not None  # as values are given
        K = square(whole, col.copy(), row)  # others may sort theirs
        free = self.free_equations
        return residual, K if len(free) == K.shape[0] else K[free][:, free]

    @property
    def last_step(self) -> float:
        """Length of the step that led to the present state; 0 without one."""
        last = self.stepper.last
        return 0.0 if last is None else float(last[0].h)

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

        refuse_changed(self)
        if not self.is_given:
            with undisturbed(self):
                return check(self, repair=False)
        self.report = check(self, repair=repair)
        return self.report
