"""Springs and dampers with a temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.component.values import Function, Number, Vector3
from visviva.component.where import point_of
from visviva.model.callback import Function as Derivatives
from visviva.model.entropies import PRODUCED
from visviva.model.form import Vector
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.legendre import Internal
from visviva.thermal.lumps import Lump

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalSpring(Lump):
    """A spring and damper between two points that stores heat.

    Its free energy is ``W (1 + moduli_slope (T - T0)) - stiffness expansion (T - T0) g + c (T - T0 - T ln(T / T0))``
    with ``W = stiffness g^2 / 2``, where ``g = ln(l / free_length)`` of a logarithmic spring (Romero 2009), whose
    stiffness is a force times a length, else ``g = l - free_length`` with ``expansion`` times `free_length` in place
    of `expansion`.

    Parameters
    ----------
    a, b : component or Point
        What it connects; `at_a`, `at_b` say where on a component, its own origin if not given.
    capacity : float
        Heat per temperature, c.
    stiffness, damping : float
        What the damper, with a tension ``damping dl/dt``, dissipates is heat of the spring. Not negative.
    law : {'linear', 'logarithmic'}
    free_length : float
        Length without force at the reference temperature; the initial length if not given.
    expansion : float
        Relative change of length per temperature that heat alone would leave.
    moduli_slope : float
        Change of the stiffness per temperature, as a share.
    energy : callable
        Instead of stiffness, expansion and capacity, the free energy ``psi(l, T)`` elementwise on arrays, written
        with numpy functions that take complex numbers.
    temperature : float, optional
        Absolute, at the start; by default the `reference`.
    reference : float
        T0, absolute: there its entropy vanishes and it has the `stiffness` and the `free_length`.
    at_a, at_b : array (3,), optional
        Places at the start (length) on components `a` and `b`.

    Notes
    -----
    Strain is the squared length: momentum and angular momentum are conserved exactly, and with the energy-momentum
    scheme so is the energy, whatever flows between springs; entropy grows by what flows and by what the damper
    dissipates alone.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.1, 0, 0))
    >>> spring = vv.ThermalSpring(a=ground, b=ball, stiffness=1e3, capacity=3.0, free_length=1.0, expansion=1e-3)
    >>> system = vv.System([ground, ball, spring])
    >>> result = vv.simulate(system, until=1.0, step=0.01)
    >>> result.assert_conserved("energy", tolerance=1e-9)
    """

    a: Any
    b: Any
    capacity: Number = 0.0
    stiffness: Number = 0.0
    damping: Number = 0.0
    law: Literal["linear", "logarithmic"] = "linear"
    free_length: Number | None = None
    expansion: Number = 0.0
    moduli_slope: Number = 0.0
    energy: Function | None = None
    temperature: Number | None = None
    reference: Number = 293.15
    at_a: Vector3 | None = None
    at_b: Vector3 | None = None

    def __post_init__(self) -> None:
        A, B = self.points()
        if A is B:
            raise InputError(f"{self.label} connects a point of {A.component.label} with itself")
        for what in ("stiffness", "damping"):
            if getattr(self, what) < 0:
                raise InputError(f"{self.label}: {what} = {getattr(self, what):g} is negative")
        if self.energy is None:
            self.refuse_heat()
        elif self.stiffness or self.expansion or self.moduli_slope or self.capacity:
            raise InputError(
                f"{self.label}: energy stands for stiffness, expansion, moduli_slope and capacity; give one or the "
                "others"
            )
        if self.free_length is not None and not self.free_length > 0:
            raise InputError(f"{self.label}: free_length = {self.free_length:g} is not positive")
        if beyond := self._beyond_slope(self.start_temperature):
            raise InputError(beyond)

    def _beyond_slope(self, T: float) -> str:
        if 1 + self.moduli_slope * (T - self.reference) > 0:
            return ""
        return f"{self.label}: moduli_slope = {self.moduli_slope:g} leaves no stiffness at {T:g}"

    def invalid(self, x: Array) -> str:
        """A temperature of the step below absolute zero, or at which no stiffness is left."""
        return super().invalid(x) or self._beyond_slope(float(x[self.algorithmic.start]))

    def points(self) -> tuple[Any, Any]:
        """The two points it connects."""
        return point_of(self.label, self.a, self.at_a), point_of(self.label, self.b, self.at_b)

    def lines(self) -> list[tuple[Vector, Vector]]:
        A, B = self.points()
        return [(A.position, B.position)]

    def _between(self) -> Vector:
        A, B = self.points()
        between: Vector = B.position - A.position
        return between

    def length(self, x: Array) -> float:
        """Its length at the unknowns `x` of the system."""
        return float(np.linalg.norm([form.value(x) for form in self._between()]))

    def declare(self, model: Model) -> None:
        if self.energy is None:
            super().declare(model)
            return
        psi = self.energy
        self.internal = Internal(
            lambda z, T: psi(np.sqrt(z[0]), T), 1, self.reference, f"{self.label}, its energy"
        )
        rest = np.array([[self.free_length or 1.0]]) ** 2
        self.capacity = float(self.internal.capacity(rest, np.array([self.start_temperature]))[0])
        self.refuse_heat()
        super().declare(model)

    def contribute(self, model: Model) -> None:
        length = self.length(model.initial[0])
        if length == 0:
            raise InputError(
                f"{self.label}: its two points coincide initially, so it has no direction; move them apart"
            )
        self.free = length if self.free_length is None else float(self.free_length)
        self.entropy.values[0] = self._start_entropy(length)
        model.refresh(self.entropy)
        groups = [*self._between_groups(model), *self.groups()]
        kind, energy = PhysicsKind.HEATED_SPRING, self._own_energy()
        term = add_points(model, self, kind, groups, np.ones((1, 1)), self._parameters(), energy=energy)
        damped = self.damping > 0
        account = model.account(self, "viscosity", PRODUCED) if damped else -1
        self.store_entropy(model, account, [term])

    def _start_entropy(self, length: float) -> float:
        T = self.start_temperature
        if self.energy is not None:
            return float(self.internal.entropy(np.array([[length**2]]), np.array([T]))[0])
        return float(self.capacity * np.log(T / self.reference) + self._strain_entropy(length))

    def _own_energy(self) -> Derivatives | None:
        return None if self.energy is None else self.internal.energy(np.array([[self.free**2]]))

    @property
    def _coupling(self) -> float:
        along = self.free if self.law == "linear" else 1.0
        return self.stiffness * self.expansion * along

    def _parameters(self) -> list[float]:
        """See ``visviva/point/heat_stores.hpp``."""
        mine = [
            float(self.law == "logarithmic"),
            self.stiffness,
            self.free,
            self._coupling,
            self.moduli_slope,
        ]
        return [*mine, self.capacity, self.reference, self.damping]

    def _strain_entropy(self, length: float) -> float:
        """Part of the entropy that depends on its length, at one temperature."""
        g = length - self.free if self.law == "linear" else np.log(length / self.free)
        return float(self._coupling * g - self.moduli_slope * 0.5 * self.stiffness * g**2)

    def _between_groups(self, model: Model) -> list[Group]:
        """Components of what lies between its points as weighted sums; what is fixed is an unknown that is held."""
        forms = list(self._between())
        if not any(form.weights for form in forms):
            raise InputError(f"{self.label}: neither of its points can move")
        fixed = [form.constant for form in forms]
        anchor = model.field(self, "anchor", fixed, scale=model.length_of(self), fixed=True)
        groups = []
        for k, form in enumerate(forms):
            weights = [*form.weights, (anchor.start + k, 1.0)]
            unknowns, shares = zip(*weights, strict=True)
            groups.append(Group(np.array([unknowns]), np.array(shares)[None, None, :, None], None, True))
        return groups

    def temperature_at(self, x: Array) -> float:
        length, s = self.length(x), float(x[self.entropy.start])
        if self.energy is not None:
            return float(self.internal.temperature(np.array([[length**2]]), np.array([s]))[0])
        return float(self.reference * np.exp((s - self._strain_entropy(length)) / self.capacity))
