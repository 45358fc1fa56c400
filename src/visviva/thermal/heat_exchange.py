"""Heat that flows between two things, or from surroundings, by the difference of their temperatures."""

from __future__ import annotations

from dataclasses import dataclass as plain_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.base.timefunction import OfTime
from visviva.component.announcements import Conducting
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Nodes, Number, Vector3
from visviva.mesh.locate import locate
from visviva.mesh.periodic import refuse_periodic
from visviva.model.term import Stencils, Term
from visviva.thermal.carrier import HeatCarrier, HeatPort, absolute_zero
from visviva.thermal.celsius import looks_celsius, scales_differ, taken_for_kelvin
from visviva.thermal.lumps import Lump

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


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


@plain_dataclass(frozen=True, eq=False)
class End:
    """One side of an exchange: what has the heat, and where on it."""

    which: str
    of: Any
    nodes: Any
    at: Any
    faces: Any

    def refuse_misfits(self, label: str) -> None:
        """Refuse what holds no heat, and places on it that there are not.

        Raises
        ------
        InputError
        """
        given = [what for what in ("nodes", "at", "faces") if getattr(self, what) is not None]
        if not isinstance(self.of, HeatCarrier | Lump):
            raise InputError(
                f"{label}: {self.which} = {self.of!r} holds no heat; give a HeatStore, ThermalSpring or body"
            )
        if isinstance(self.of, Lump) and given:
            raise InputError(f"{label}: {given[0]}_{self.which} is for bodies with nodes")
        if isinstance(self.of, HeatCarrier) and len(given) != 1:
            one = " and ".join(f"{what}_{self.which}" for what in ("nodes", "at", "faces"))
            raise InputError(
                f"{label}: say where on {self.of.label} heat is exchanged, by one of {one.replace(' and ', ', ', 1)}"
            )
        try:
            self.port_nodes()
        except InputError as error:
            raise InputError(f"{label}: {error}") from None

    def port_nodes(self) -> tuple[Ints, Array, Array]:
        """Nodes and weights, which add up to one, of its temperature, and its modes; none where there are no nodes."""
        body = self.of
        if self.nodes is not None:
            nodes = body.nodes(self.nodes)
            return nodes, np.full(len(nodes), 1 / len(nodes)), np.ones(1)
        if self.at is not None:
            found, weights = locate(body.grid, self.at[: body.dimension], body.label)
            return np.asarray(found), np.asarray(weights), np.ones(1)
        if self.faces is None:
            return np.zeros(0, dtype=np.int64), np.zeros(0), np.ones(1)
        total = np.zeros(body.grid.n_nodes)
        faces = body.faces(self.faces)
        refuse_periodic("its faces", body, body.periodic, faces)
        for p in body.heated_points(faces):
            np.add.at(total, p.nodes, p.size @ p.N)
        nodes = np.flatnonzero(total)
        return nodes, total[nodes] / total.sum(), body.heat_modes(faces)

    def port(self) -> HeatPort:
        """Where its heat goes in and out."""
        return (
            self.of.heat_port(*self.port_nodes()) if isinstance(self.of, HeatCarrier) else self.of.heat_port()
        )


@dataclass(config=settings, eq=False, kw_only=True)
class HeatExchange(Component):
    """Heat that flows between two things by ``conductance (T_b - T_a)``, or between one and its surroundings.

    It is what a joint, a bolt or a coupling conducts, too: of a body it takes nodes, a place, or faces.

    Parameters
    ----------
    a, b : HeatStore, ThermalSpring, or a body that carries heat
        `b` may be left out for an `ambient` temperature.
    conductance : float
        Heat per time and difference of temperatures.
    nodes_a, nodes_b : str or int array, optional
        Of bodies: the nodes whose mean temperature counts, and among which the heat is spread evenly.
    at_a, at_b : (3,), optional
        Of bodies, in place of nodes: where it begins and ends, in the reference configuration.
    faces_a, faces_b : str or Faces, optional
        In place of either: faces whose mean temperature by area counts, over which the heat is spread; of a
        `ThermalShell` the sides 'upper' and 'lower' are as warm as these themselves, nodes and places as their mean
        through the thickness.
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

    A bolt between two bodies:

    >>> left = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), conductivity=1.0, temperature=10.0)
    >>> right = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(5, 0, 0)), conductivity=1.0)
    >>> bolt = vv.HeatExchange(a=left, at_a=(1, 0.5, 0.5), b=right, faces_b="x0", conductance=3.0)
    >>> system = vv.System([left, right, bolt])
    >>> result = vv.simulate(system, until=10.0, step=0.1)
    >>> right.temperatures(system.x).mean().round(3)
    np.float64(5.0)
    """

    outside_axes = NOWHERE

    a: Any
    b: Any = None
    conductance: Number
    nodes_a: Nodes | None = None
    nodes_b: Nodes | None = None
    at_a: Vector3 | None = None
    at_b: Vector3 | None = None
    faces_a: FaceSet | None = None
    faces_b: FaceSet | None = None
    ambient: OfTime | None = None

    def __post_init__(self) -> None:
        if not self.conductance >= 0:
            raise InputError(f"{self.label}: conductance = {self.conductance:g} is negative")
        if (self.b is None) == (self.ambient is None):
            raise InputError(f"{self.label}: give either b or the ambient temperature")
        if self.a is self.b:
            raise InputError(f"{self.label}: exchanges heat of {self.a.label} with itself")
        for end in self._ends():
            end.refuse_misfits(self.label)
        if self.ambient is not None:
            self._ambient(0.0, InputError)

    def remarks(self) -> list[str]:
        """On sides of which one counts from absolute zero and the other looks as if it were in degrees Celsius."""
        ends = self._ends()
        starts = [float(end.of.start_temperatures.mean()) for end in ends]
        if self.ambient is not None:
            around = np.array([self.ambient(0.0)])
            absolute = not ends[0].port().balances_heat and not looks_celsius(np.array(starts))
            return taken_for_kelvin(self.label, "the ambient one", around) if absolute else []
        apart = ends[0].port().balances_heat != ends[1].port().balances_heat
        if not (apart and scales_differ(min(starts), max(starts))):
            return []
        return [
            f"{self.label}: {ends[0].of.label} begins at {starts[0]:g} and {ends[1].of.label} at {starts[1]:g}; "
            "temperatures of one of them count from absolute zero: give both in kelvin"
        ]

    def _ends(self) -> list[End]:
        ends = [End("a", self.a, self.nodes_a, self.at_a, self.faces_a)]
        if self.b is not None:
            ends.append(End("b", self.b, self.nodes_b, self.at_b, self.faces_b))
        return ends

    def _ambient(self, time: float, kind: type[Exception] = RunError) -> float:
        """Temperature of the surroundings, which has to be above absolute zero where the heat brings entropy."""
        given: Any = self.ambient
        found = float(given(time))
        if not found > (0.0 if isinstance(self.a, Lump) else absolute_zero(self.a)):
            raise kind(
                f"{self.label}: its ambient temperature at t = {time:g} of {found:g} is not above absolute zero, as "
                f"{self.a.label} counts them; give kelvin"
            )
        return found

    def announce(self, model: Model) -> None:
        if isinstance(self.a, HeatCarrier) and isinstance(self.b, HeatCarrier):
            model.announce(self.a, Conducting((self.a, self.b)))

    def contribute(self, model: Model) -> None:
        for end in self._ends():
            model.index(end.of)
        a, b, *_ = [*(end.port() for end in self._ends()), None]
        model.term(self, Exchange(a, b, self.conductance, None if self.ambient is None else self._ambient))
