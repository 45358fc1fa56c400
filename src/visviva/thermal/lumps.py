"""Things that store heat in one temperature: masses, and springs between points of anything."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.limited import Limited
from visviva.component.momentum import NOWHERE
from visviva.component.values import Number
from visviva.model.field import FAINT, Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.carrier import CURE, HeatPort
from visviva.thermal.celsius import refuse_below_zero, taken_for_kelvin

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


class Lump(Limited):
    """Base of what has one entropy and one temperature.

    Attributes
    ----------
    reference : float
        Absolute temperature at which its entropy vanishes.
    temperature : float, optional
        At the start; by default the reference.
    """

    outside_axes = NOWHERE

    capacity: Number
    reference: Number
    temperature: Number | None

    def refuse_heat(self) -> None:
        """Refuse capacities and temperatures that are not positive.

        Raises
        ------
        InputError
        """
        for name in ("capacity", "reference"):
            if not getattr(self, name) > 0:
                raise InputError(f"{self.label}: {name} = {getattr(self, name):g} is not positive")
        refuse_below_zero(self.label, self.start_temperature)

    @property
    def start_temperature(self) -> float:
        return float(self.reference if self.temperature is None else self.temperature)

    @property
    def start_temperatures(self) -> NDArray[np.float64]:
        """The same, as bodies on meshes have it."""
        return np.array([self.start_temperature])

    def remarks(self) -> list[str]:
        return taken_for_kelvin(self.label, "that at the start", self.start_temperatures)

    def declare(self, model: Model) -> None:
        T = self.start_temperature
        s = self.capacity * np.log(T / self.reference)
        self.entropy = model.field(self, "entropy", [s], role=Role.CONTENT, scale=self.capacity, least=FAINT)
        self.algorithmic = model.field(self, "temperature", [T], role=Role.TEMPERATURE, scale=self.reference)

    def store_entropy(self, model: Model, account: int = -1, terms: Sequence[Any] = ()) -> None:
        """Note its entropy, and where what its terms produce is booked, see `Entropies.store`."""
        own = np.array([self.entropy.start])
        model.entropies.store(own, np.ones(1), own, account, terms)

    def heat_port(self) -> HeatPort:
        """Port through which its heat goes in and out."""
        one = np.ones(1)
        return HeatPort(np.array([self.entropy.start]), np.array([self.algorithmic.start]), one)

    def groups(self) -> list[Group]:
        """Its entropy and its temperature."""
        one = np.ones((1, 1, 1, 1))
        return [
            Group(np.array([[self.entropy.start]]), one),
            Group(np.array([[self.algorithmic.start]]), one),
        ]

    @abstractmethod
    def temperature_at(self, x: Array) -> float:
        """Its temperature at the unknowns `x` of the system."""

    def entropy_at(self, x: Array) -> float:
        """Its entropy at the unknowns `x` of the system."""
        return float(x[self.entropy.start])

    def total_entropy(self, x: Array) -> float:
        """The same: of the whole at the unknowns `x` of the system."""
        return self.entropy_at(x)

    def invalid(self, x: Array) -> str:
        T = float(x[self.algorithmic.start])
        return "" if T > 0 else f"{self.label} has a temperature of {T:.4g} K in the step, {CURE}"


@dataclass(config=settings, eq=False, kw_only=True)
class HeatStore(Lump):
    """A heat capacity of one temperature: of a rigid body, a heat bath, a motor.

    Parameters
    ----------
    capacity : float
        Heat per temperature.
    temperature : float, optional
        Absolute, at the start; by default `reference`.
    reference : float
        Absolute temperature at which energy and entropy count from zero.
    body : component, optional
        Whose heat it is, for pictures and messages.

    Notes
    -----
    The temperature of a step is the discrete gradient of the energy by the entropy, so that what flows in by a
    `HeatExchange` changes its energy by exactly that heat.

    Examples
    --------
    >>> import visviva as vv
    >>> hot = vv.HeatStore(capacity=10.0, temperature=400.0)
    >>> cold = vv.HeatStore(capacity=10.0, temperature=300.0)
    >>> link = vv.HeatExchange(a=hot, b=cold, conductance=5.0)
    >>> system = vv.System([hot, cold, link])
    >>> _ = vv.simulate(system, until=20.0, step=0.5)
    >>> round(hot.temperature_at(system.x), 6)
    350.0
    """

    capacity: Number
    temperature: Number | None = None
    reference: Number = 293.15
    body: Any = None

    def __post_init__(self) -> None:
        self.refuse_heat()
        if self.body is not None and not isinstance(self.body, Component):
            raise InputError(f"{self.label}: body = {self.body!r} is no component")

    def contribute(self, model: Model) -> None:
        parameters = [self.capacity, self.reference]
        add_points(model, self, PhysicsKind.HEAT_STORE, self.groups(), np.ones((1, 1)), parameters)
        self.store_entropy(model)

    def temperature_at(self, x: Array) -> float:
        return float(self.reference * np.exp(x[self.entropy.start] / self.capacity))
