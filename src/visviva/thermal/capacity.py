"""Heat capacities that may depend on the temperature: numbers, with a slope, or tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError

Array = NDArray[np.float64]
MOST_BENDS = 6
"""Of a table, see ``visviva/point/capacity.hpp``."""


@dataclass(frozen=True, eq=False)
class Capacity:
    """``c (1 + slope (T - zero)) + sum b max(0, T - t)``, with entropy and heat content that vanish at `zero`.

    Attributes
    ----------
    bends : array (k, 2)
        Temperatures t at which the slope changes, and by what b.
    """

    c: float
    zero: float
    slope: float
    bends: Array

    def parameters(self) -> list[float]:
        """Beside `c` and `zero`, of the core."""
        rest = MOST_BENDS - len(self.bends)
        return [self.slope, *self.bends.ravel(), *[1.0, 0.0] * rest]

    def times(self, factor: float) -> Capacity:
        """Capacity multiplied by `factor`."""
        return Capacity(factor * self.c, self.zero, self.slope, self.bends * (1.0, factor))

    @property
    def is_constant(self) -> bool:
        return not self.slope and not np.any(self.bends[:, 1:])

    def at(self, T: Array) -> Array:
        """Capacity (n,) at temperatures (n,)."""
        total = self.c * (1 + self.slope * (T - self.zero))
        for t, b in self.bends:
            total = total + b * np.maximum(T - t, 0)
        return np.asarray(total)

    def content(self, T: Array) -> Array:
        """Heat (n,) that it takes from `zero` to temperatures (n,)."""
        rise = T - self.zero
        total = self.c * rise * (1 + 0.5 * self.slope * rise)
        for t, b in self.bends:
            total = total + 0.5 * b * (np.maximum(T - t, 0) ** 2 - max(self.zero - t, 0) ** 2)
        return np.asarray(total)

    def entropy(self, T: Array) -> Array:
        """Entropy (n,) that it takes."""
        ratio = T / self.zero
        total = self.c * ((1 - self.slope * self.zero) * np.log(ratio) + self.slope * self.zero * (ratio - 1))
        for t, b in self.bends:
            total = total + b * (bent(t, T) - bent(t, np.asarray(self.zero)))
        return np.asarray(total)

    def temperature(self, H: Array) -> Array:
        """Temperatures (n,) at entropies (n,)."""
        y = H / self.c
        for _ in range(0 if self.is_constant else 60):
            T = self.zero * np.exp(y)
            step = np.clip((self.entropy(T) - H) / self.at(T), -1, 1)
            y = y - step
            if not np.any(np.abs(step) > 1e-15):
                break
        return np.asarray(self.zero * np.exp(y))


def bent(t: float, T: Array) -> Array:
    """Gain of entropy above a bend."""
    rise = np.maximum(T - t, 0)
    return np.asarray(rise - t * np.log1p(rise / t) if t > 0 else rise)


def capacity_of(label: str, given: Any, slope: float, zero: float) -> Capacity:
    """A capacity as users give it: a number with a slope, or rows of temperature and capacity.

    Beyond the ends of a table its last values hold.

    Raises
    ------
    InputError

    Examples
    --------
    >>> table = capacity_of("", [(300.0, 2.0), (400.0, 4.0)], 0.0, 350.0)
    >>> table.at(np.array([200.0, 350.0, 500.0])).tolist()
    [2.0, 3.0, 4.0]
    """
    values = np.asarray(given, dtype=float)
    if values.ndim == 0:
        if not values > 0:
            raise InputError(f"{label}: capacity = {float(values):g} is not positive")
        return Capacity(float(values), zero, slope, np.zeros((0, 2)))
    return _of_table(label, values, slope, zero)


def _of_table(label: str, rows: Array, slope: float, zero: float) -> Capacity:
    if rows.ndim != 2 or rows.shape[1] != 2 or len(rows) < 2:
        raise InputError(
            f"{label}: capacity has shape {rows.shape}; give a number, or rows of temperature and capacity"
        )
    if slope:
        raise InputError(f"{label}: a table of capacity takes no capacity_slope; put it into the table")
    T, c = rows.T
    if not np.all(np.diff(T) > 0):
        raise InputError(f"{label}: the temperatures {T.tolist()} of its table of capacity do not increase")
    if not np.all(c > 0):
        raise InputError(f"{label}: its table of capacity has {c.min():g}, which is not positive")
    if len(T) > MOST_BENDS:
        raise InputError(f"{label}: its table of capacity has {len(T)} rows; {MOST_BENDS} are the most")
    slopes = np.concatenate([[0.0], np.diff(c) / np.diff(T), [0.0]])
    return Capacity(float(c[0]), zero, 0.0, np.column_stack([T, np.diff(slopes)]))
