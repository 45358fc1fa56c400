"""Mobilities: how fast a mixture follows its potential, by composition."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import Unchanging
from visviva.base.errors import InputError, RunError, named
from visviva.base.timefunction import OfTime
from visviva.component.component import settings
from visviva.component.values import Function, Number
from visviva.phase.free_energy import (
    COEFFICIENTS,
    GAS_CONSTANT,
    is_constant,
    temperature_at,
)

Array = NDArray[np.float64]
LOCALLY = 10.0
"""Times as much may a polynomial be off a function of what this is at a place, as of its largest value."""
FAINT = 3e-3
"""Below this part of the largest, values count as this."""


class Mobility(Unchanging):
    """Base of mobilities ``M(c)``: polynomials of degree 7 at most, cut at zero."""

    centre: float = 0.0
    polynomial: Polynomial
    temperature: Any = 0.0

    @property
    def changes(self) -> bool:
        """Whether its temperature is a function of time; what it knows is then that at the start."""
        return not is_constant(self.temperature)

    def at(self, time: float) -> Mobility:
        """The mobility at a time."""
        return self

    def constants(self) -> list[float]:
        """Of the core, see ``visviva/point/mixture.hpp``."""
        p = self.polynomial.coef
        return [self.centre, *p, *[0.0] * (COEFFICIENTS - len(p))]

    def values(self, c: Array) -> Array:
        """Mobilities (...) at compositions (...)."""
        return np.asarray(np.maximum(self.polynomial(c - self.centre), 0.0))

    def missed(self, c: Array) -> NDArray[np.bool_]:
        """At which compositions (...) its polynomial is not what it stands for."""
        return np.zeros(np.shape(c), dtype=bool)

    def missing(self, c: float) -> str:
        """Say why it is not at a composition where it is `missed`."""
        return ""


@dataclass(config=settings, kw_only=True)
class DegenerateMobility(Mobility):
    """A mobility that vanishes in pure phases: ``4 scale (c - low) (high - c) / (high - low)^2``.

    Parameters
    ----------
    scale : float
        In the middle, where it is largest.
    low, high : float
        The pure phases.

    Examples
    --------
    >>> import visviva as vv
    >>> float(vv.DegenerateMobility(scale=2.0).values(0.5)), float(vv.DegenerateMobility(scale=2.0).values(1.1))
    (2.0, 0.0)
    """

    scale: Number
    low: Number = 0.0
    high: Number = 1.0

    def __post_init__(self) -> None:
        if not (self.scale > 0 and self.high > self.low):
            raise InputError(
                f"DegenerateMobility: scale = {self.scale:g} is not positive, or high = {self.high:g} not above low = "
                f"{self.low:g}"
            )
        self.centre = 0.5 * (self.low + self.high)
        self.polynomial = self.scale * Polynomial([1.0, 0.0, -4 / (self.high - self.low) ** 2])


@dataclass(config=settings, kw_only=True)
class UserMobility(Mobility):
    """The user's own mobility: a function of compositions (n,), taken as a polynomial of degree 7 that fits.

    Beyond low and high, where it is fitted, the function is asked at the end of every step, less than zero being taken
    for none: a step may end where the polynomial is off by the tolerance at most, and is refused elsewhere.

    Parameters
    ----------
    function : callable
        Positive or zero from low to high.
    low, high : float
        The compositions that occur.
    tolerance : float
        By how much of its largest value from low to high the polynomial may be off, and by ten times as much of what
        it is at a composition, or of three thousandths of the largest where it is less.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> M = vv.UserMobility(function=lambda c: np.exp(-c))
    >>> bool(abs(M.values(0.3) - np.exp(-0.3)) < 1e-9)
    True
    """

    function: Function
    low: Number = 0.0
    high: Number = 1.0
    tolerance: Number = 1e-3

    def __post_init__(self) -> None:
        if not self.high > self.low:
            raise InputError(f"UserMobility: high = {self.high:g} is not above low = {self.low:g}")
        nearer_ends = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 201))
        c = self.low + (self.high - self.low) * nearer_ends
        given = np.asarray(self.function(c), dtype=float)
        if given.shape != c.shape or not np.all(np.isfinite(given)):
            raise InputError(
                f"UserMobility: the function gives shape {given.shape}, or what is not finite, for compositions "
                f"{c.shape}"
            )
        if given.min() < 0:
            raise InputError(
                f"UserMobility: it is {given.min():g} at c = {c[given.argmin()]:g}; it must not be negative"
            )
        self._largest = float(given.max())
        if not self._largest > 0:
            raise InputError(
                f"UserMobility: it is 0 from low = {self.low:g} to high = {self.high:g}; nothing would move"
            )
        weights, ends = 1 / np.maximum(given, FAINT * self._largest), [self.low, self.high]
        # What moves slowly sets the pace.
        series = Chebyshev.fit(c, given, COEFFICIENTS - 1, domain=ends, w=weights)
        self.centre = 0.5 * (self.low + self.high)
        half = 0.5 * (self.high - self.low)
        plain: Array = np.asarray(Chebyshev(series.coef).convert(kind=Polynomial).coef, dtype=float)
        self.polynomial = Polynomial(plain / half ** np.arange(len(plain)))
        off = np.abs(self.values(c) - given)
        if np.any(off > self._allowed(given)):
            at = int((off - self._allowed(given)).argmax())
            raise InputError(
                f"UserMobility: at c = {c[at]:.4g} it is {given[at]:.4g}, and a polynomial of degree "
                f"{COEFFICIENTS - 1} off by {off[at]:.2g}, more than {self.tolerance:g} of its largest value, or "
                f"{LOCALLY * self.tolerance:g} of that; give the compositions that occur, or a smoother function"
            )

    def _allowed(self, given: Array) -> Array:
        """By how much the polynomial may be off the function (n,)."""
        least = np.maximum(given, FAINT * self._largest)
        return np.asarray(self.tolerance * np.minimum(self._largest, LOCALLY * least))

    def missed(self, c: Array) -> NDArray[np.bool_]:
        found = np.asarray((c < self.low) | (c > self.high))
        if np.any(found):
            beyond = np.asarray(c)[found]
            given = self._given(beyond)
            found[found] = ~(np.abs(self.values(beyond) - given) <= self._allowed(given))
        return found

    def missing(self, c: float) -> str:
        end = f"below low = {self.low:g}" if c < self.low else f"above high = {self.high:g}"
        given, taken = self._given(np.array([c]))[0], self.values(np.array(c))
        return (
            f"{c:.6g} is {end} of its UserMobility, whose polynomial gives {taken:.4g} there, and whose function "
            f"{given:.4g}: give low and high of all compositions that occur"
        )

    def _given(self, c: Array) -> Array:
        """What the function gives (n,), not negative; nan where it has no values."""
        try:
            with named("UserMobility: its function"), np.errstate(all="ignore"):
                given = np.asarray(self.function(c), dtype=float)
        except RunError:
            return np.full(c.shape, np.nan)
        return np.asarray(np.maximum(given, 0.0))


@dataclass(config=settings, kw_only=True)
class ConstantMobility(Mobility):
    """The same at all compositions."""

    scale: Number

    def __post_init__(self) -> None:
        if not self.scale > 0:
            raise InputError(f"mobility = {self.scale:g} is not positive")
        self.polynomial = Polynomial([self.scale])


@dataclass(config=settings, kw_only=True)
class ArrheniusMobility(Mobility):
    """A mobility that diffusion needs activation for: ``base exp(-activation / (gas_constant temperature))``.

    Parameters
    ----------
    base : float or Mobility
        At infinite temperature.
    activation : float
        Energy per mole.
    temperature : float, or a function of time
        Absolute; the same everywhere.
    gas_constant : float

    Examples
    --------
    >>> import visviva as vv
    >>> cold, warm = (vv.ArrheniusMobility(base=1e-3, activation=50e3, temperature=T) for T in (300.0, 400.0))
    >>> round(float(warm.values(0.5) / cold.values(0.5)))
    150
    """

    base: Number | Mobility
    activation: Number
    temperature: OfTime
    gas_constant: Number = GAS_CONSTANT

    def __post_init__(self) -> None:
        base = mobility_of("ArrheniusMobility", self.base)
        if not self.gas_constant > 0:
            raise InputError(f"ArrheniusMobility: gas_constant = {self.gas_constant:g} is not positive")
        now = temperature_at(self, 0.0)
        if not self.activation >= 0:
            raise InputError(f"ArrheniusMobility: activation = {self.activation:g} is negative")
        share = float(np.exp(-self.activation / (self.gas_constant * now)))
        if not share > 0:
            raise InputError(
                f"ArrheniusMobility: nothing moves at temperature = {now:g} with activation = "
                f"{self.activation:g}; check their units"
            )
        self.centre, self.polynomial, self._base = base.centre, share * base.polynomial, base

    @property
    def changes(self) -> bool:
        return super().changes or self._base.changes

    def missed(self, c: Array) -> NDArray[np.bool_]:
        return self._base.missed(c)

    def missing(self, c: float) -> str:
        return self._base.missing(c)

    def at(self, time: float) -> Mobility:
        if not self.changes:
            return self
        return replace(self, base=self._base.at(time), temperature=temperature_at(self, time))


def mobility_of(label: str, given: Any) -> Mobility:
    """A number as a constant mobility, or the mobility that is given.

    Raises
    ------
    InputError
        If it is not positive.
    """
    if isinstance(given, Mobility):
        return given
    try:
        return ConstantMobility(scale=given)
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
