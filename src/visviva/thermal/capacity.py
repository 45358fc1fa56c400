"""Heat capacities that may depend on the temperature: numbers, with a slope, or tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError

Array = NDArray[np.float64]
MOST_BENDS = 6
"""Of a table, see ``visviva/point/capacity.hpp``."""


STEEP = 20.0
"""Tables whose values differ by more have humps over which Newton's method may fail."""


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
        rest, last = MOST_BENDS - len(self.bends), self.bends[-1, 0] if len(self.bends) else 1.0
        return [self.slope, *self.bends.ravel(), *[last, 0.0] * rest]

    def times(self, factor: float) -> Capacity:
        """Capacity multiplied by `factor`."""
        return Capacity(factor * self.c, self.zero, self.slope, self.bends * (1.0, factor))

    @property
    def is_constant(self) -> bool:
        return not self.slope and not np.any(self.bends[:, 1:])

    @property
    def steepness(self) -> str:
        """What helps steps over its hump, as of latent heat, in words behind "the capacity"; empty if there is none."""
        if not len(self.bends):
            return ""
        c = self.at(self.bends[:, 0])
        if c.max() < STEEP * c.min():
            return ""
        return (
            f"is {c.max() / c.min():.3g} times as much about {self.bends[np.argmax(c), 0]:g}: for steps over "
            "such a hump give simulate adaptive=vv.Adaptive(tolerance=1e-3) and scheme=vv.BDF2(), or the "
            "table the same heat over more kelvin"
        )

    def _pieces(self, T: Array) -> Iterator[tuple[Any, float, Any, Array]]:
        """Pieces ``v + m (T - a)`` between bends that temperatures (n,) are away from `zero`: v, m, a, and how far.

        Sums over bends lose, far above a narrow hump, the digits of what these have in common.
        """
        ends, m, v = [*self.bends[1:, 0], np.inf][: len(self.bends)], 0.0, 0.0
        for (t, b), end in zip(self.bends, ends, strict=True):
            m = m + b if np.isfinite(end) else 0.0  # constant behind the last bend, not but for rounding
            a = min(max(self.zero, t), end)
            yield v + m * (a - t), m, a, np.clip(T, t, end) - a
            v += m * (end - t) if np.isfinite(end) else 0.0

    def at(self, T: Array) -> Array:
        """Capacity (n,) at temperatures (n,)."""
        total = self.c * (1 + self.slope * (T - self.zero))
        if len(self.bends):
            t, b = self.bends.T
            values = np.concatenate([[0.0], np.cumsum(np.cumsum(b)[:-1] * np.diff(t))])
            total = total + np.interp(T, t, values)
        return np.asarray(total)

    def content(self, T: Array) -> Array:
        """Heat (n,) that it takes from `zero` to temperatures (n,)."""
        rise = T - self.zero
        total = self.c * rise * (1 + 0.5 * self.slope * rise)
        for v, m, _, d in self._pieces(T):
            total = total + d * (v + 0.5 * m * d)
        return np.asarray(total)

    def entropy(self, T: Array) -> Array:
        """Entropy (n,) that it takes."""
        ratio = T / self.zero
        total = self.c * ((1 - self.slope * self.zero) * np.log(ratio) + self.slope * self.zero * (ratio - 1))
        for v, m, a, d in self._pieces(T):
            if a > 0:
                total = total + (v - m * a) * np.log1p(d / a) + m * d
        return np.asarray(total)

    def temperature(self, H: Array) -> Array:
        """Temperatures (n,) at entropies (n,), by Newton's method within what is known to hold them."""
        y = np.clip(H / self.c, -1, 1) if not self.is_constant else H / self.c
        low, high = np.full_like(y, -700.0), np.full_like(y, 700.0)
        moving = np.full(y.shape, not self.is_constant)
        for k in range(200):
            if not moving.any():
                break
            # across a narrow hump Newton's steps may go to and fro: from the tenth on every second halves
            held = (low > -700) & (high < 700) if k > 8 and k % 2 else (y <= low) | (y >= high)
            y = np.where(moving & held, 0.5 * (low + high), y)
            T = self.zero * np.exp(y)
            off, c = self.entropy(T) - H, self.at(T)
            low, high = np.where(off < 0, y, low), np.where(off > 0, y, high)
            step, tiny = off / c, 1e-15 * (np.abs(y) + np.abs(H) / c)
            y = y - np.where(moving, np.clip(step, -1, 1), 0.0)
            moving = moving & (np.abs(step) > tiny) & (high - low > tiny)
        return np.asarray(self.zero * np.exp(y))


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
