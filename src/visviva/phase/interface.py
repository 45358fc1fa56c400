"""Phases that a free energy separates into, and the flat interface between them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

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
WIDER = 60
"""Times that the part where phases are looked for is doubled, unless they lie inside."""
LEVEL = 1e-6
"""Differences of wells, over what is between them, that are none."""
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
    alone : bool
        Whether the energy has no other phases, and no other wells in between.
    tilt : float
        By how much the phase of high values has more energy than the other, over the height of what is between them.
    alike : bool
        Whether the gradient energy is the same in all directions of the mesh.
    """

    low: float
    high: float
    tension: float
    width: float
    alone: bool = True
    tilt: float = 0.0
    alike: bool = True


def interface(energy: FreeEnergy, gradient: float, start: Pair) -> Interface | None:
    """The interface of an energy with a gradient energy; None if nothing separates.

    Where phases are is told by the energy alone, if it is of logarithms, a double well, or another polynomial that is
    bounded below. For others they are looked for about `start`, the least and largest value at the start, and from 0 to
    1, farther away as long as the energy falls there. Of several pairs it is that which the start lies in most.

    Examples
    --------
    >>> found = interface(DoubleWell(barrier=1.0, low=-1.0), 2.0, (0.0, 0.0))
    >>> round(found.low, 3), round(found.high, 3), round(found.width, 3), round(found.tension, 3)
    (-1.0, 1.0, 2.0, 2.667)
    """
    pairs = phases(energy, start)
    if not pairs:
        return None
    pair = max(pairs, key=lambda each: shared(each, start))
    c = np.linspace(*pair, SAMPLES)
    f = energy.values(c)
    df = f - np.interp(c, pair, f[[0, -1]])
    tension = float(np.trapezoid(np.sqrt(2 * gradient * np.maximum(df, 0.0)), c))
    width = (pair[1] - pair[0]) * float(np.sqrt(gradient / (2 * df.max())))
    wells = np.sum((df[1:-1] < df[:-2]) & (df[1:-1] <= df[2:]) & (df[1:-1] > 1e-9 * df.max()))
    return Interface(*pair, tension, width, len(pairs) == 1 and not wells, float((f[-1] - f[0]) / df.max()))


def unclear(found: Interface, is_conserved: bool) -> str:
    """Why it is not known between which phases interfaces are; nothing where it is."""
    if not found.alone:
        return "has more wells than two"
    if not is_conserved and abs(found.tilt) > LEVEL:
        return "has wells of which one is deeper, and nothing that is conserved, so that one phase grows"
    return ""


def shared(pair: Pair, start: Pair) -> float:
    """Which part of the way between phases a start has; less than 0 for one that is beside them."""
    least, most = max(pair[0], start[0]), min(pair[1], start[1])
    return (most - least) / (pair[1] - pair[0])


def phases(energy: FreeEnergy, start: Pair) -> list[Pair]:
    """Pairs that an energy separates into."""
    if isinstance(energy, DoubleWell):
        return [(energy.low, energy.high)]
    if energy.has_domain:
        low, high = energy.domain
        return tangents(energy, low + EDGE, high - EDGE)
    if not isinstance(energy, UserFreeEnergy) and is_bounded(energy):
        concave = spinodals(energy)
        return searched(energy, *concave) if concave else []
    for low, high in windows(start):
        if found := searched(energy, low, high):
            return found
    return []


def windows(start: Pair) -> list[Pair]:
    """Where the phases of a function of the user may be, the likeliest first."""
    least, most = start
    size = max(abs(least), abs(most))
    ways = [max(0.1 * (most - least), 0.01 * size), 0.1 * size, size] if size else []
    sizes = [] if size else [10.0**k for k in (*range(-2, -22, -2), *range(2, 10, 2))]
    about = [(least - way, most + way) for way in ways]
    return [*about, (min(0.0, least), max(1.0, most)), *((-a, a) for a in sizes)]


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


def searched(energy: FreeEnergy, low: float, high: float) -> list[Pair]:
    """Phases between bounds, or farther away as long as the energy falls there; none if it does so on and on."""
    found, reach, ends = tangents(energy, low, high), high - low, False
    for _ in range(WIDER):
        below, above = undercuts(energy, found, low, high) if found else (False, False)
        if not (below or above):
            return found
        wider = low - below * reach, high + above * reach
        try:
            found = tangents(energy, *wider)
        except NotFinite:  # what it is taken from ends in between
            ends, reach = True, 0.5 * reach
            if reach < (high - low) / SAMPLES:
                return found
            continue
        low, high = wider
        reach = reach if ends else high - low
    return []


def undercuts(energy: FreeEnergy, found: list[Pair], low: float, high: float) -> tuple[bool, bool]:
    """Whether an energy is below its outermost common tangents beyond either bound, as far as it has values there."""
    away = (high - low) * np.array([1 / SAMPLES, 0.01, 0.1])
    return is_undercut(energy, found[0], low - away), is_undercut(energy, found[-1], high + away)


def is_undercut(energy: FreeEnergy, found: Pair, at: Array) -> bool:
    """Whether an energy is below a common tangent at one of some compositions."""
    f = energy.values(np.array(found))
    for c in at:
        try:
            beyond = float(energy.values(np.array([c]))[0])
        except NotFinite:
            return False
        line = f[0] + (f[1] - f[0]) * (c - found[0]) / (found[1] - found[0])
        if beyond < line - 1e-14 * np.abs(f).max():
            return True
    return False


def tangents(energy: FreeEnergy, low: float, high: float) -> list[Pair]:
    """Both ends of all common tangents from below, between bounds, in ascending order."""
    c = np.linspace(low, high, SAMPLES)
    return [resolved(energy, low, high, c, gap) for gap in gaps(c, energy.values(c))]


def resolved(energy: FreeEnergy, low: float, high: float, c: Array, gap: tuple[int, int]) -> Pair:
    """The ends of a tangent that is a gap between samples, by finer ones if it has few."""
    first, second = float(c[gap[0]]), float(c[gap[1]])
    if gap[1] - gap[0] >= FINE:
        return polished(energy, first, second, float(c[1] - c[0]))
    apart = second - first
    finer = np.linspace(max(low, first - 0.5 * apart), min(high, second + 0.5 * apart), SAMPLES)
    found = gaps(finer, energy.values(finer))
    if not found:
        return first, second
    most = max(found, key=lambda k: shared((float(finer[k[0]]), float(finer[k[1]])), (first, second)))
    return polished(energy, float(finer[most[0]]), float(finer[most[1]]), float(finer[1] - finer[0]))


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


def gaps(c: Array, f: Array) -> list[tuple[int, int]]:
    """Neighbours in the lower convex hull of samples that are farther apart than these are."""
    hull: list[int] = []
    for k in range(len(c)):
        while len(hull) > 1:
            a, b = hull[-2], hull[-1]
            rounding = 2e-15 * (abs(f[a]) + abs(f[b]) + abs(f[k])) * (c[k] - c[a])
            if (f[b] - f[a]) * (c[k] - c[a]) <= (f[k] - f[a]) * (c[b] - c[a]) + rounding:
                break
            hull.pop()
        hull.append(k)
    found = [(a, b) for a, b in pairwise(hull) if b - a > 1]
    return [part for gap in found for part in split(c, f, *gap)]


def split(c: Array, f: Array, first: int, second: int) -> list[tuple[int, int]]:
    """A common tangent between samples, at wells in between that touch it as far as samples tell."""
    above = f - f[first] - (f[second] - f[first]) * (c - c[first]) / (c[second] - c[first])
    bend = np.diff(f, 2)
    k = np.arange(first + 2, second - 1)
    touching = (above[k] <= np.minimum(above[k - 1], above[k + 1])) & (above[k] <= 0.25 * bend[k - 1])
    return list(pairwise([first, *map(int, k[touching]), second]))
