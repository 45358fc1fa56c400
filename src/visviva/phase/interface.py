"""Phases that a free energy separates into, and the flat interface between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NotFinite
from visviva.phase.free_energy import DoubleWell, FreeEnergy, UserFreeEnergy

Array = NDArray[np.float64]
Pair = tuple[float, float]

SAMPLES = 4001
"""Compositions at which an energy is looked at."""
FINE = 1000
"""Of these between the phases, at least."""
WIDER = 30
"""Times that the part where phases are looked for is doubled, unless they lie inside."""
EDGE = 1e-9
"""Of logarithms that is left out."""


@dataclass(frozen=True)
class Interface:
    """Flat interface between the phases of a free energy with a gradient energy.

    Attributes
    ----------
    low, high : float
        Compositions of the phases, by the common tangent.
    tension : float
        Energy per area, ``integral of sqrt(2 kappa df) dc``.
    width : float
        ``(high - low) sqrt(kappa / (2 max df))``: of ``tanh(2 x / width)``.
    """

    low: float
    high: float
    tension: float
    width: float


def interface(energy: FreeEnergy, gradient: float, start: Pair) -> Interface | None:
    """The interface of an energy with a gradient energy; None if nothing separates.

    Where phases are is told by the energy alone, if it is of logarithms, a double well, or another polynomial that is
    bounded below. For others they are looked for about `start`, the least and largest value at the start, and from 0 to
    1, farther away as long as the energy falls there.

    Examples
    --------
    >>> found = interface(DoubleWell(barrier=1.0, low=-1.0), 2.0, (0.0, 0.0))
    >>> round(found.low, 3), round(found.high, 3), round(found.width, 3), round(found.tension, 3)
    (-1.0, 1.0, 2.0, 2.667)
    """
    pair = phases(energy, start)
    if pair is None:
        return None
    c = np.linspace(*pair, SAMPLES)
    f = energy.values(c)
    df = f - np.interp(c, pair, f[[0, -1]])
    tension = float(np.trapezoid(np.sqrt(2 * gradient * np.maximum(df, 0.0)), c))
    return Interface(*pair, tension, (pair[1] - pair[0]) * float(np.sqrt(gradient / (2 * df.max()))))


def phases(energy: FreeEnergy, start: Pair) -> Pair | None:
    """What an energy separates into."""
    if isinstance(energy, DoubleWell):
        return energy.low, energy.high
    if energy.has_domain:
        low, high = energy.domain
        return tangent(energy, low + EDGE, high - EDGE)
    if not isinstance(energy, UserFreeEnergy) and is_bounded(energy):
        concave = spinodals(energy)
        return concave and searched(energy, *concave)
    size = 10 * float(np.abs(start).max())
    return searched(energy, min(0.0, *start), max(1.0, *start)) or (
        searched(energy, -size, size) if size else None
    )


def is_bounded(energy: FreeEnergy) -> bool:
    """Whether a polynomial has a least value."""
    coefficients = np.trim_zeros(energy.polynomial.coef, "b")
    return len(coefficients) % 2 == 1 and bool(coefficients[-1] > 0)


def spinodals(energy: FreeEnergy) -> Pair | None:
    """The outermost compositions that a polynomial is concave between; None if it is nowhere."""
    bend = energy.polynomial.deriv(2)
    roots = bend.roots()
    found = np.sort(roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots).max(initial=0.0)])
    if len(found) < 2 or not np.min(bend(0.5 * (found[1:] + found[:-1]))) < 0:
        return None
    return float(found[0] + energy.centre), float(found[-1] + energy.centre)


def searched(energy: FreeEnergy, low: float, high: float) -> Pair | None:
    """Phases between bounds, or farther away as long as the energy falls there; None if it does so on and on."""
    found: Pair | None = None
    for _ in range(WIDER):
        try:
            wider = tangent(energy, low, high)
        except NotFinite:
            if found is None:
                raise
            return found  # what it is taken from ends here
        if wider is None:
            return None
        found, apart = wider, high - low
        beyond = low - apart / SAMPLES, high + apart / SAMPLES
        below, above = (is_undercut(energy, found, end) for end in beyond)
        if not (below or above):
            return found
        low, high = low - below * apart, high + above * apart
    return None


def is_undercut(energy: FreeEnergy, found: Pair, at: float) -> bool:
    """Whether an energy is below a common tangent at a composition, as far as it has values there."""
    try:
        f = energy.values(np.array([*found, at]))
    except NotFinite:
        return False
    line = f[0] + (f[1] - f[0]) * (at - found[0]) / (found[1] - found[0])
    return bool(f[2] < line - 1e-12 * np.abs(f).max())


def tangent(energy: FreeEnergy, low: float, high: float) -> Pair | None:
    """Both ends of the longest common tangent from below, between bounds."""
    c = np.linspace(low, high, SAMPLES)
    f = energy.values(c)
    first, second = beside_each_other(c, f, *widest_gap(c, f))
    if second - first < 2:
        return None
    if second - first >= FINE:
        return polished(energy, c[first], c[second], c[1] - c[0])
    apart = c[second] - c[first]
    return tangent(energy, max(low, c[first] - apart), min(high, c[second] + apart))


def beside_each_other(c: Array, f: Array, first: int, second: int) -> tuple[int, int]:
    """The longest part of a common tangent between samples, if wells in between touch it, as far as samples tell."""
    above = f - f[first] - (f[second] - f[first]) * (c - c[first]) / (c[second] - c[first])
    bend = np.diff(f, 2)
    k = np.arange(first + 2, second - 1)
    touching = (above[k] <= np.minimum(above[k - 1], above[k + 1])) & (above[k] <= 0.25 * bend[k - 1])
    ends = np.array([first, *k[touching], second])
    longest = int(np.argmax(np.diff(ends)))
    return int(ends[longest]), int(ends[longest + 1])


def polished(energy: FreeEnergy, low: float, high: float, near: float) -> Pair:
    """The same by Newton's method, from samples that are as near as that; these if it leads elsewhere."""
    a, b = low, high
    for _ in range(20):
        ends = np.array([a, b])
        try:
            with np.errstate(all="ignore"):
                f, slope, bend = energy.values(ends), energy.slopes(ends), energy.curvatures(ends)
                steeper, above = slope[0] - slope[1], f[1] - f[0] - slope[0] * (b - a)
                divisor = -bend[0] * (steeper + bend[1] * (b - a))
                a += (steeper**2 - bend[1] * above) / divisor
                b -= bend[0] * (above + steeper * (ends[1] - ends[0])) / divisor
        except NotFinite:
            return low, high
        if not max(abs(a - low), abs(b - high)) <= 2 * near:
            return low, high
    return float(a), float(b)


def widest_gap(c: Array, f: Array) -> tuple[int, int]:
    """Neighbours in the lower convex hull of points that are farthest apart; what is straight has no gaps."""
    hull: list[int] = []
    rounding = 1e-13 * float(np.ptp(f)) * float(np.ptp(c))
    for k in range(len(c)):
        while len(hull) > 1:
            a, b = hull[-2], hull[-1]
            if (f[b] - f[a]) * (c[k] - c[a]) <= (f[k] - f[a]) * (c[b] - c[a]) + rounding:
                break
            hull.pop()
        hull.append(k)
    k = int(np.argmax(np.diff(hull)))
    return hull[k], hull[k + 1]
