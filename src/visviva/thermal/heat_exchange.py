"""Heat that flows between two things, or from surroundings, by the difference of their temperatures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Nodes, Number
from visviva.model.term import Stencils, Term
from visviva.thermal.carrier import HeatCarrier, HeatPort
from visviva.thermal.lumps import Lump

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


class Side:
    """Columns of a port among the unknowns of an exchange."""

    def __init__(self, port: HeatPort, first: int) -> None:
        self.port, k = port, len(port.contents)
        self.balances_heat = port.balances_heat
        self.unknowns = (
            port.contents if self.balances_heat else np.concatenate([port.contents, port.temperatures])
        )
        self.contents = np.arange(first, first + k)
        self.temperatures = self.contents if self.balances_heat else self.contents + k
        self.order = [1] * k if self.balances_heat else [1] * k + [0] * k

    def temperature(self, s: Stencils) -> Array:
        """Of the step (m,)."""
        values = s.x if self.balances_heat else s.x1
        return np.asarray(values[:, self.temperatures] @ self.port.weights)

    def take(self, found: Array, heat: Array, T: Array) -> None:
        """Book heat (m,) per time that comes in at the temperature T (m,)."""
        share = heat if self.balances_heat else heat / T
        found[:, self.contents] -= share[:, None] * self.port.weights

    def slope(self, theta: float) -> Array:
        """Of its temperature by its columns of temperatures (k,)."""
        return self.port.weights * (theta if self.balances_heat else 1.0)

    def take_slopes(self, K: Array, by: Array, heat: Array, T: Array, theta: float) -> None:
        """Add to the tangent (m, n, n) by the derivatives `by` (m, n) of the heat."""
        share = by if self.balances_heat else by / T[:, None]
        own = np.zeros_like(by)
        if not self.balances_heat:
            own[:, self.temperatures] = -(heat / T**2)[:, None] * self.slope(theta)
        K[:, self.contents] -= self.port.weights[:, None] * (share + own)[:, None, :]


class Exchange(Term):
    """``conductance (T_b - T_a)`` that flows into a, out of b or of surroundings of a given temperature."""

    kind = "exchange"
    brings = "heat"

    def __init__(self, a: HeatPort, b: HeatPort | None, conductance: float, ambient: Any) -> None:
        super().__init__()
        first = Side(a, 0)
        self.sides = [first] if b is None else [first, Side(b, len(first.unknowns))]
        self.conductance, self.ambient = conductance, ambient
        self.produces = ambient is None and not any(side.balances_heat for side in self.sides)
        self.unknowns = np.concatenate([side.unknowns for side in self.sides])[None].astype(np.int32)
        self.order = np.array([o for side in self.sides for o in side.order], dtype=np.int32)

    def _flow(self, s: Stencils) -> tuple[Array, list[Array]]:
        """Heat (m,) per time into a, and the temperatures (m,) of all sides."""
        T = [side.temperature(s) for side in self.sides]
        other = np.full_like(T[0], self.ambient(s.step.te)) if self.ambient is not None else T[1]
        return self.conductance * (other - T[0]), T

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        heat, T = self._flow(s)
        for side, sign, at in zip(self.sides, (1.0, -1.0), T, strict=False):
            side.take(found, sign * heat, at)
        return found

    def tangent(self, s: Stencils) -> Array:
        m, n = s.x1.shape
        K, by = np.zeros((m, n, n)), np.zeros((m, n))
        heat, T = self._flow(s)
        for side, sign in zip(self.sides, (-1.0, 1.0), strict=False):
            by[:, side.temperatures] += sign * self.conductance * side.slope(s.step.theta)
        for side, sign, at in zip(self.sides, (1.0, -1.0), T, strict=False):
            side.take_slopes(K, sign * by, sign * heat, at, s.step.theta)
        return K

    def work(self, s: Stencils) -> Array:
        """Heat (m,) from the surroundings over the step."""
        return s.step.h * self._flow(s)[0] if self.ambient is not None else np.zeros(len(s.x1))


@dataclass(config=settings, eq=False, kw_only=True)
class HeatExchange(Component):
    """Heat that flows between two things by ``conductance (T_b - T_a)``, or between one and its surroundings.

    Parameters
    ----------
    a, b : HeatStore, ThermalSpring, or a body that carries heat
        `b` may be left out for an `ambient` temperature.
    conductance : float
        Heat per time and difference of temperatures.
    nodes_a, nodes_b : str or int array, optional
        Of bodies: the nodes whose mean temperature counts, and among which the heat is spread evenly.
    ambient : number, expression or table of time, optional
        Absolute temperature of the surroundings.

    Notes
    -----
    Heat leaves one side as it enters the other, at the temperatures of the step: energy is kept to round-off, and
    entropy grows by ``conductance (T_b - T_a)^2 / (T_a T_b)`` per time.

    Examples
    --------
    >>> import visviva as vv
    >>> cup = vv.HeatStore(capacity=800.0, temperature=360.0)
    >>> room = vv.HeatExchange(a=cup, conductance=1.0, ambient=293.0)
    >>> system = vv.System([cup, room])
    >>> _ = vv.simulate(system, until=800.0, step=10.0)
    >>> round(cup.temperature_at(system.x), 1)
    317.6
    """

    outside_axes = NOWHERE

    a: Any
    b: Any = None
    conductance: Number
    nodes_a: Nodes | None = None
    nodes_b: Nodes | None = None
    ambient: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.conductance >= 0:
            raise InputError(f"{self.label}: conductance = {self.conductance:g} is negative")
        if (self.b is None) == (self.ambient is None):
            raise InputError(f"{self.label}: give either b or the ambient temperature")
        if self.a is self.b:
            raise InputError(f"{self.label}: exchanges heat of {self.a.label} with itself")
        for what in ("a", "b"):
            self._refuse(what, getattr(self, what), getattr(self, f"nodes_{what}"))

    def _refuse(self, what: str, given: Any, nodes: Any) -> None:
        if isinstance(given, HeatCarrier):
            if nodes is None:
                raise InputError(
                    f"{self.label}: say at which nodes_{what} of {given.label} heat is exchanged"
                )
            given.nodes(nodes)
        elif not isinstance(given, Lump) and not (what == "b" and given is None):
            raise InputError(
                f"{self.label}: {what} = {given!r} holds no heat; give a HeatStore, ThermalSpring or body"
            )
        elif nodes is not None:
            raise InputError(f"{self.label}: nodes_{what} is for bodies with nodes")

    def contribute(self, model: Model) -> None:
        ports = []
        for given, nodes in ((self.a, self.nodes_a), (self.b, self.nodes_b)):
            if given is not None:
                model.index(given)
                carrier = isinstance(given, HeatCarrier)
                ports.append(given.heat_port(given.nodes(nodes)) if carrier else given.heat_port())
        a, b = ports if len(ports) == 2 else (ports[0], None)
        model.term(self, Exchange(a, b, self.conductance, self.ambient))
