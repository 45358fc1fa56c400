"""Free energies of mixtures: of a concentration, per volume."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED, Unchanging
from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime, TimeFunction
from visviva.component.component import settings
from visviva.component.values import Function, Number, NumberOrFunction
from visviva.model.callback import Function as Derivatives

Array = NDArray[np.float64]

COEFFICIENTS = 8
"""Of the polynomials that the core knows."""
GAS_CONSTANT = 8.31446261815324
"""J / (mol K), CODATA 2018."""


class FreeEnergy(Unchanging):
    """Base of free energies ``f(c)`` per volume of a concentration or an order parameter.

    Those of the core are ``a c ln c + b (1 - c) ln(1 - c) + p(c - centre)`` with a polynomial p of degree 7 at most.
    """

    logs: tuple[float, float] = (0.0, 0.0)
    centre: float = 0.0
    polynomial: Polynomial
    temperature: Any = 0.0

    @property
    def changes(self) -> bool:
        """Whether its temperature is a function of time; what it knows is then that at the start."""
        return not is_constant(self.temperature)

    @property
    def turns(self) -> list[float]:
        """Times from the start on at which its temperature turns, as far as they are known: those of a table."""
        source = self.temperature.source if self.changes else ()
        return [t for t, _ in source if t > 0] if isinstance(source, tuple) else []

    def at(self, time: float) -> FreeEnergy:
        """The energy at a time."""
        return self.heated(temperature_at(self, time)) if self.changes else self

    def heated(self, temperature: float) -> FreeEnergy:
        """The energy at a temperature that stays."""
        return self

    def positive(self, *names: str) -> None:
        """Refuse arguments that are not positive."""
        for name in names:
            if not getattr(self, name) > 0:
                raise InputError(f"{type(self).__name__}: {name} = {getattr(self, name):g} is not positive")

    @property
    def domain(self) -> tuple[float, float]:
        """Between which compositions it is defined, by its logarithms."""
        low, high = (0.0 if a else bound for a, bound in zip(self.logs, (-np.inf, np.inf), strict=True))
        return low, 1.0 if self.logs[1] else high

    @property
    def has_domain(self) -> bool:
        """Whether it has logarithms, so that only compositions between 0 and 1 are allowed."""
        return any(self.logs)

    def constants(self) -> list[float]:
        """Of the core, see ``visviva/point/mixture.hpp``."""
        p = self.polynomial.coef
        return [*self.logs, self.centre, *p, *[0.0] * (COEFFICIENTS - len(p))]

    def values(self, c: Array) -> Array:
        """Energies (...) at compositions (...)."""
        from scipy.special import xlogy

        value = self.polynomial(c - self.centre)
        for a, x in ((self.logs[0], c), (self.logs[1], 1 - c)):
            if a:
                value = value + a * xlogy(x, x)
        return np.asarray(value, dtype=float)

    def slopes(self, c: Array) -> Array:
        """Their first derivatives, the chemical potentials without gradients."""
        slope = self.polynomial.deriv()(c - self.centre)
        for a, x, sign in ((self.logs[0], c, 1.0), (self.logs[1], 1 - c, -1.0)):
            if a:
                slope = slope + sign * a * (np.log(x) + 1)
        return np.asarray(slope, dtype=float)

    def curvatures(self, c: Array) -> Array:
        """Their second derivatives, negative where a mixture separates by itself."""
        bend = self.polynomial.deriv(2)(c - self.centre)
        for a, x in ((self.logs[0], c), (self.logs[1], 1 - c)):
            if a:
                bend = bend + a / x
        return np.asarray(bend, dtype=float)


def is_constant(temperature: Any) -> bool:
    """Whether a temperature does not change in time."""
    return not isinstance(temperature, TimeFunction) or isinstance(temperature.source, float)


def temperature_at(of: Any, time: float) -> float:
    """The temperature of an energy or a mobility at a time.

    Raises
    ------
    InputError
        If it is not positive.
    """
    found = float(of.temperature(time))
    if not (found > 0 and np.isfinite(found)):
        when = "" if is_constant(of.temperature) else f" at t = {time:g}"
        raise InputError(f"{type(of).__name__}: temperature = {found:g}{when} is not positive")
    return found


@dataclass(config=settings, kw_only=True)
class DoubleWell(FreeEnergy):
    """A polynomial with two wells: ``barrier (c - low)^2 (high - c)^2``.

    Parameters
    ----------
    barrier : float
    low, high : float
        Where the wells are.

    Examples
    --------
    >>> import visviva as vv
    >>> f = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)
    >>> float(f.values(0.5).round(12)), float(f.curvatures(0.5).round(12))
    (0.008, -0.8)
    """

    barrier: Number
    low: Number = 0.0
    high: Number = 1.0

    def __post_init__(self) -> None:
        self.positive("barrier")
        if not self.high > self.low:
            raise InputError(f"DoubleWell: high = {self.high:g} is not above low = {self.low:g}")
        self.centre, half = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        self.polynomial = self.barrier * Polynomial([half**2, 0.0, -1.0]) ** 2


@dataclass(config=settings, kw_only=True)
class FloryHuggins(FreeEnergy):
    """Flory & Huggins: ``scale (c ln c / n1 + (1 - c) ln(1 - c) / n2 + chi c (1 - c))``.

    Parameters
    ----------
    chi : float
        Interaction; chains of one length n separate above ``2 / n``.
    lengths : (float, float)
        Of the chains n1, n2, in segments; 1 for what is no polymer.
    scale : float
        Thermal energy per volume of a segment.

    Examples
    --------
    >>> import visviva as vv
    >>> float(vv.FloryHuggins(chi=3.0).curvatures(0.5))
    -2.0
    """

    chi: Number
    lengths: tuple[Number, Number] = (1.0, 1.0)
    scale: Number = 1.0

    def __post_init__(self) -> None:
        self.positive("scale")
        if not min(self.lengths) > 0:
            raise InputError(f"FloryHuggins: lengths = {self.lengths} are not both positive")
        self.logs = self.scale / self.lengths[0], self.scale / self.lengths[1]
        self.centre = 0.5
        self.polynomial = self.scale * self.chi * Polynomial([0.25, 0.0, -1.0])


@dataclass(config=settings, kw_only=True)
class RegularSolution(FreeEnergy):
    """A substitutional solution with the excess energy of Redlich & Kister, as in CALPHAD, per volume.

    ``((1 - c) G_A + c G_B + R T (c ln c + (1 - c) ln(1 - c)) + c (1 - c) sum_k L_k (1 - 2 c)^k) / volume``, where c is
    the share of B.

    Parameters
    ----------
    temperature : float, or a function of time
        Absolute.
    excess : sequence of float, or functions of the temperature
        L_0, L_1, ..., six at most; per mole.
    standard : (float, float)
        G_A and G_B, per mole.
    volume : float
        Molar.
    gas_constant : float

    Examples
    --------
    A regular solution separates below ``L_0 / 2 R``:

    >>> import visviva as vv
    >>> f = vv.RegularSolution(temperature=1000.0, excess=[2 * 8.31446261815324 * 1000.0])
    >>> abs(float(f.curvatures(0.5))) < 1e-9
    True

    A temperature that changes in time, with an excess energy that follows it:

    >>> heated = vv.RegularSolution(temperature="900 + 5*t", excess=[lambda T: 20e3 - 4 * T])
    >>> bool(heated.at(60.0).curvatures(0.5) > heated.curvatures(0.5))
    True
    """

    temperature: OfTime
    excess: Annotated[tuple[NumberOrFunction, ...], LISTED] = ()
    standard: tuple[Number, Number] = (0.0, 0.0)
    volume: Number = 1.0
    gas_constant: Number = GAS_CONSTANT

    def __post_init__(self) -> None:
        self.positive("volume", "gas_constant")
        now = temperature_at(self, 0.0)
        if len(self.excess) > COEFFICIENTS - 2:
            raise InputError(
                f"RegularSolution: excess has {len(self.excess)} coefficients, {COEFFICIENTS - 2} are known"
            )
        thermal = self.gas_constant * now / self.volume
        self.logs, self.centre = (thermal, thermal), 0.5
        first, second = self.standard
        series = Polynomial([0.0])
        for k, L in enumerate(self.excess):
            series = series + (L(now) if callable(L) else L) * Polynomial([0.0, -2.0]) ** k
        mixed = Polynomial([0.25, 0.0, -1.0]) * series
        self.polynomial = (mixed + Polynomial([0.5 * (first + second), second - first])) / self.volume

    def heated(self, temperature: float) -> FreeEnergy:
        return replace(self, temperature=temperature)


@dataclass(config=settings, kw_only=True)
class PolynomialEnergy(FreeEnergy):
    """A polynomial ``sum_k a_k (c - centre)^k`` of degree 7 at most.

    Parameters
    ----------
    coefficients : sequence of float
        a_0, a_1, ...
    centre : float

    Examples
    --------
    >>> import visviva as vv
    >>> float(vv.PolynomialEnergy(coefficients=(0.25, 0.0, -0.5, 0.0, 0.25)).values(1.0))
    0.0
    """

    coefficients: Annotated[tuple[Number, ...], LISTED]
    centre: Number = 0.0

    def __post_init__(self) -> None:
        if not 1 <= len(self.coefficients) <= COEFFICIENTS:
            raise InputError(
                f"PolynomialEnergy: it needs 1 to {COEFFICIENTS} coefficients, got {len(self.coefficients)}"
            )
        self.polynomial = Polynomial(self.coefficients)


@dataclass(config=settings, kw_only=True)
class UserFreeEnergy(FreeEnergy):
    """The user's own: any function of compositions (n,) with values (n,).

    Parameters
    ----------
    function : callable
        Its derivatives come from the complex step, or from differences where it takes no complex numbers.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> f = vv.UserFreeEnergy(function=lambda c: np.cos(2 * np.pi * c))
    >>> float(f.slopes(np.array([0.25])).item().__round__(9))
    -6.283185307
    """

    function: Function

    def __post_init__(self) -> None:
        self.polynomial = Polynomial([0.0])

    def _derivatives(self, c: Array) -> Derivatives:
        """Of the function, about compositions of the size of these, in whichever unit they are."""
        size = float(np.abs(c).max(initial=0.0)) or 1.0
        return Derivatives(lambda e: self.function(e[0]), 1, 1, "UserFreeEnergy", np.array([size]))

    def values(self, c: Array) -> Array:
        return self._derivatives(c).value(np.reshape(c, (1, -1))).reshape(np.shape(c))

    def slopes(self, c: Array) -> Array:
        return self._derivatives(c).gradient(np.reshape(c, (1, -1))).reshape(np.shape(c))

    def curvatures(self, c: Array) -> Array:
        return self._derivatives(c).hessian(np.reshape(c, (1, -1))).reshape(np.shape(c))
