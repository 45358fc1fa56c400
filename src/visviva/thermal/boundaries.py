"""Boundary conditions and sources of heat: given temperatures, fluxes, convection, radiation, sources in the volume."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.differences import forward_rate
from visviva.base.errors import InputError, RunError
from visviva.base.places import OfAll, OfPart
from visviva.base.timefunction import TimeFunction
from visviva.body.mesh_points import Points
from visviva.component.announcements import Facing
from visviva.component.component import Component, settings
from visviva.component.limited import Limited
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Nodes, Number, OfTimeAndPlace
from visviva.mesh.periodic import refuse_periodic
from visviva.thermal.carrier import GivenTemperatures, HeatCarrier, absolute_zero
from visviva.thermal.celsius import looks_celsius, taken_for_kelvin

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
STEFAN_BOLTZMANN = 5.670374419e-8
"""W / (m^2 K^4), CODATA 2018."""


def refuse_below_zero(
    whose: str, temperatures: Array, zero: float = 0.0, kind: type[Exception] = RunError
) -> None:
    """Refuse temperatures that are not above absolute zero, which is `zero` on their scale."""
    least = float(temperatures.min())
    if not least > zero:
        raise kind(
            f"{whose} of {least:g} is not above absolute zero, which is {zero:g} here; give kelvin (a Radiation takes "
            "zero = -273.15 for degrees Celsius)"
        )


class Values:
    """A number that may depend on time, or on time and place, as the user gave it.

    Functions of places are asked of a part of them at once, unless `kind` says otherwise.
    """

    def __init__(self, label: str, what: str, given: Any, kind: type[OfAll] = OfPart) -> None:
        self.label, self.what = label, what
        self.by_place = not isinstance(given, TimeFunction)
        self.given = given
        self._function = kind(label, what, given)

    def at(self, time: float, X: Array) -> Array:
        """Values (...) at a time and places (..., 3).

        Raises
        ------
        RunError
            If the user's function gives something else.
        """
        if not self.by_place:
            return np.full(X.shape[:-1], self.given(time))
        places = X.reshape(-1, 3)
        found = self._function(time, places)
        if found.shape not in ((), (len(places),)) or not np.all(np.isfinite(found)):
            raise RunError(
                f"{self.label}: its {self.what} has shape {found.shape}, or is not finite, at t = {time:g} for "
                f"{len(places)} places (n, 3); it must give n finite numbers"
            )
        return np.asarray(np.broadcast_to(found, (len(places),)).reshape(X.shape[:-1]))

    def above_zero(self, time: float, X: Array, zero: float) -> Array:
        """The same of temperatures above absolute zero, which is `zero` on their scale.

        Raises
        ------
        RunError
            If one is not above it.
        """
        found = self.at(time, X)
        refuse_below_zero(f"{self.label}: its {self.what} at t = {time:g}", found, zero)
        return found

    def remarks(self, body: HeatCarrier, X: Array) -> list[str]:
        """On temperatures given to a body that looks as if it were in kelvin, and they in degrees Celsius."""
        absolute = body.balances_entropy and not looks_celsius(body.start_temperatures)
        return taken_for_kelvin(self.label, f"the lowest {self.what}", self.checked(X)) if absolute else []

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times at which its rate may jump."""
        return () if self.by_place else self.given.kinks

    def checked(self, X: Array, zero: float | None = None) -> Array:
        """Values (n,) at the beginning, at places (n, 3); above absolute zero, if that is given.

        Raises
        ------
        InputError
        """
        try:
            return self.at(0.0, X) if zero is None else self.above_zero(0.0, X, zero)
        except RunError as error:
            raise InputError(str(error)) from error


@dataclass(config=settings, eq=False, kw_only=True)
class PrescribedTemperature(Component):
    """Nodes whose temperature is given.

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    nodes : str or int array
        Name of a set of nodes or faces, 'all', or numbers. Nodes of a periodic fluid are their images, too.
    value : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)

    Notes
    -----
    The ledger books the heat that flows in there as "supply".

    At the edges of clamped faces of a thermoelastic body the temperature that conducts differs from the one that is
    held and shown: by 2 percent of a rise where alpha^2 E T / c is 0.02 or less, as of metals and rubber, by a fifth
    where it is 1, whatever the mesh (theory of heat).
    """

    outside_axes = NOWHERE

    body: HeatCarrier
    nodes: Nodes
    value: OfTimeAndPlace

    def __post_init__(self) -> None:
        try:
            self.chosen = self.body.nodes(self.nodes)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self._values = Values(self.label, "value", self.value, OfAll)
        self._values.checked(self._places, absolute_zero(self.body))

    def remarks(self) -> list[str]:
        return self._values.remarks(self.body, self._places)

    @property
    def _places(self) -> Array:
        return self.body.points[self.chosen]

    def _temperatures(self, time: float) -> Array:
        return self._values.above_zero(time, self._places, absolute_zero(self.body))

    def _rates(self, time: float, step: float) -> Array:
        if self._values.by_place:
            rates: Array = forward_rate(self._temperatures, time, step)
            return rates
        return np.full(len(self.chosen), self._values.given.rate_after(time, step))

    def announce(self, model: Model) -> None:
        model.announce(self.body, self)

    def _refuse_contradictions(self, other: PrescribedTemperature, time: float) -> None:
        shared, own, its = np.intersect1d(self.chosen, other.chosen, return_indices=True)
        values = self._temperatures(time)[own], other._temperatures(time)[its]
        apart = np.flatnonzero(np.abs(values[0] - values[1]) > 1e-9 * np.abs(values[0]))
        if len(apart):
            k = apart[0]
            raise RunError(
                f"{self.label} and {other.label} hold node {shared[k]} of {self.body.label} at {values[0][k]:g} and at "
                f"{values[1][k]:g} at t = {time:g}; leave it out of one of them"
            )

    def contribute(self, model: Model) -> None:
        model.index(self.body)
        others = [p for p in model.announced(self.body, PrescribedTemperature) if p is not self]

        def values(time: float) -> Array:
            for other in others:
                self._refuse_contradictions(other, time)
            return self._temperatures(time)

        if others and self.body.balances_entropy:  # heat has one holder of an unknown anyway
            try:
                values(0.0)
            except RunError as error:
                raise InputError(str(error)) from None
        else:
            values = self._temperatures
        self.body.hold_temperatures(
            model, self, GivenTemperatures(self.chosen, values, self._rates, self._values.kinks)
        )


class ThroughPoints(Component):
    """Base of heat that comes in by a law at quadrature points."""

    outside_axes = NOWHERE

    body: HeatCarrier
    kind = "heat"

    def points(self) -> Sequence[Points]:
        """Points at which it comes in."""
        raise NotImplementedError

    def law(self, time: float, X: Array, T: Array) -> tuple[Array, Array]:
        """Heat (m, q) per time and area or volume, and its derivative by the temperature (m, q)."""
        raise NotImplementedError

    def contribute(self, model: Model) -> None:
        model.index(self.body)
        for p in self.points():
            self.body.take_heat(model, self, self.kind, p, self.law)


@dataclass(config=settings, eq=False, kw_only=True)
class HeatSource(ThroughPoints):
    """Heat that arises in the volume of a body.

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    power : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)
        Per volume; of a `ThermalBeam` per length.
    """

    body: HeatCarrier
    power: OfTimeAndPlace
    kind = "source"

    def __post_init__(self) -> None:
        self._values = Values(self.label, "power", self.power)
        self._values.checked(self.body.points)

    def points(self) -> Sequence[Points]:
        return list(self.body.source_points())

    def law(self, time: float, X: Array, T: Array) -> tuple[Array, Array]:
        return self._values.at(time, X), np.zeros_like(T)


@dataclass(config=settings, eq=False, kw_only=True)
class ThroughFaces(ThroughPoints):
    """Base of heat that comes in through `faces` of a `body`."""

    body: HeatCarrier
    faces: FaceSet

    def __post_init__(self) -> None:
        try:
            self._faces = self.body.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

        refuse_periodic(self.label, self.body, self.body.periodic, self._faces)

    def announce(self, model: Model) -> None:
        model.announce(self.body, Facing(self, self._faces))

    def points(self) -> Sequence[Points]:
        return list(self.body.heated_points(self._faces))


@dataclass(config=settings, eq=False, kw_only=True)
class HeatFlux(ThroughFaces):
    """Heat that flows in through faces, whatever their temperature.

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    faces : str or Faces
        Faces without any condition let no heat through.
    flux : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)
        Per area, positive into the body.
    """

    flux: OfTimeAndPlace
    kind = "flux"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._values = Values(self.label, "flux", self.flux)
        self._values.checked(self.body.points)

    def law(self, time: float, X: Array, T: Array) -> tuple[Array, Array]:
        return self._values.at(time, X), np.zeros_like(T)


@dataclass(config=settings, eq=False, kw_only=True)
class Convection(ThroughFaces):
    """Heat exchange with a surrounding fluid: ``coefficient (ambient - T)`` per area flows in.

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    faces : str or Faces
    coefficient : float
        Heat per time, area and difference of temperatures.
    ambient : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)
        Temperature of the fluid.
    """

    coefficient: Number
    ambient: OfTimeAndPlace
    kind = "convection"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.coefficient >= 0:
            raise InputError(f"{self.label}: coefficient = {self.coefficient:g} is negative")
        self._values = Values(self.label, "ambient", self.ambient)
        self._values.checked(self.body.points, absolute_zero(self.body))

    def remarks(self) -> list[str]:
        return self._values.remarks(self.body, self.body.points)

    def law(self, time: float, X: Array, T: Array) -> tuple[Array, Array]:
        ambient = self._values.above_zero(time, X, absolute_zero(self.body))
        return self.coefficient * (ambient - T), np.full_like(T, -self.coefficient)


@dataclass(config=settings, eq=False, kw_only=True)
class Radiation(ThroughFaces, Limited):
    """Heat radiation of faces that see surroundings of one temperature (Stefan-Boltzmann).

    Parameters
    ----------
    body : ThermalBody or ThermoelasticSolid
    faces : str or Faces
    emissivity : float
        From 0 to 1.
    ambient : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)
    zero : float
        Absolute zero on the scale of all temperatures: 0 for kelvin, -273.15 for degrees Celsius.
    constant : float
        Of Stefan and Boltzmann, in the units of the model.
    """

    emissivity: Number
    ambient: OfTimeAndPlace
    zero: Number = 0.0
    constant: Number = STEFAN_BOLTZMANN
    kind = "radiation"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.emissivity <= 1:
            raise InputError(f"{self.label}: emissivity = {self.emissivity:g} is not between 0 and 1")
        if not self.constant > 0:
            raise InputError(f"{self.label}: constant = {self.constant:g} is not positive")
        self._values = Values(self.label, "ambient", self.ambient)
        self._values.checked(self.body.points, self.zero)
        start = f"{self.label}: a temperature of {self.body.label}"
        refuse_below_zero(start, self.body.start_temperatures, self.zero, InputError)

    def remarks(self) -> list[str]:
        found = np.append(self._values.checked(self.body.points), self.body.start_temperatures)
        if self.zero != 0.0 or self.constant != STEFAN_BOLTZMANN or not looks_celsius(found):
            return []
        return [
            f"{self.label}: temperatures from {found.min():g} on radiate as kelvin, as zero = 0; if they are degrees "
            "Celsius, give zero = -273.15"
        ]

    def contribute(self, model: Model) -> None:
        super().contribute(model)
        nodes = np.unique(np.concatenate([p.nodes.ravel() for p in self.points()]))
        self._seen = self.body.temperature_unknowns(nodes)

    def invalid(self, x: Array) -> str:
        """Temperatures at or below absolute zero at the end of a step: they would radiate as those above it."""
        T = float(x[self._seen].min(initial=np.inf))
        if self.zero < T:
            return ""
        return f"{self.label} of {self.body.label} at {T:.4g}, where absolute zero is {self.zero:g}; take smaller steps"

    def law(self, time: float, X: Array, T: Array) -> tuple[Array, Array]:
        ambient = self._values.above_zero(time, X, self.zero)
        factor, T = self.emissivity * self.constant, T - self.zero
        return factor * ((ambient - self.zero) ** 4 - T**4), -4 * factor * T**3
