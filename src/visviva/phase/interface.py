"""Phases that a free energy separates into, and the flat interface between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NotFinite, RunError
from visviva.phase.free_energy import DoubleWell, FreeEnergy, UserFreeEnergy

Array = NDArray[np.float64]
Pair = tuple[float, float]

SAMPLES = 4001
"""Compositions at which an energy is looked at."""
COARSE = 100
"""Of these between which an energy bends, so that rounding and corners of tables do not."""
SLIGHT = 0.01
"""Part of the largest bend that is none."""
FINE = 1000
"""Of these between the phases, at least."""
NEAR = 200
"""Of these to a bound: what ends so near to it may go on beyond, where values are rounded."""
WIDER = (1.0, 25), (0.1, 30)
"""By which part of itself that grows in which phases are looked for, and how often, unless they lie inside: by little
where energies fall beyond what they are meant for."""
AS_IT_IS = ((1.0, 1),)
"""Where one such part went on and on others do as well, unless phases lie inside."""
HALVED = 12
"""Times that what it grows by is halved, where an energy has no values."""
BESIDE = 10
"""Widths beside phases where others are looked for."""
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
        Whether the energy has no other phases, and none that may last in between.
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

    Of several pairs of phases it is that which the start lies in most. Energies of logarithms, double wells, and other
    polynomials that are bounded below tell all that they have; of others they are looked for about `start`, the least
    and largest value at the start, and from 0 to 1, then farther away, as far as they have values.

    Examples
    --------
    >>> found = interface(DoubleWell(barrier=1.0, low=-1.0), 2.0, (0.0, 0.0))
    >>> round(found.low, 3), round(found.high, 3), round(found.width, 3), round(found.tension, 3)
    (-1.0, 1.0, 2.0, 2.667)
    """
    found = phases(energy, start)
    if found is None:
        return None
    pair, alone = found
    c = np.linspace(*pair, SAMPLES)
    f = energy.values(c)
    df = above(c, f)
    tension = float(np.trapezoid(np.sqrt(2 * gradient * np.maximum(df, 0.0)), c))
    width = (pair[1] - pair[0]) * float(np.sqrt(gradient / (2 * df.max())))
    return Interface(*pair, tension, width, alone and not is_parted(df), float((f[-1] - f[0]) / df.max()))


def is_parted(df: Array) -> bool:
    """Whether what is above a common tangent bends up between where it bends down, so that more phases may last."""
    bend = np.diff(df[:: SAMPLES // COARSE], 2)
    least = SLIGHT * -float(bend.min())
    down = np.flatnonzero(bend < -least)
    return bool(np.any(bend[down[0] : down[-1]] > least))


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


def phases(energy: FreeEnergy, start: Pair) -> tuple[Pair, bool] | None:
    """The phases of an energy that a start lies in most, and whether it has no others."""
    if isinstance(energy, DoubleWell):
        return (energy.low, energy.high), True
    ways: tuple[tuple[float, int], ...] = WIDER
    for low, high in bounds(energy) or windows(energy, start):
        if told(energy, low, high)[1]:
            found = (widened(energy, low, high, start, part, most) for part, most in ways)
            if pair := next(filter(None, found), None):
                return pair, is_alone(energy, pair, low, high)
            ways = AS_IT_IS
    return None


def bounds(energy: FreeEnergy) -> list[Pair]:
    """Between which compositions all phases are; nothing where an energy does not tell."""
    if energy.has_domain:
        low, high = energy.domain
        return [(low + EDGE, high - EDGE)]
    if isinstance(energy, UserFreeEnergy) or not is_bounded(energy):
        return []
    low, high = spinodals(energy) or (-1.0, 1.0)
    return [(2 * low - high, 2 * high - low)]


def windows(energy: FreeEnergy, start: Pair) -> Iterator[Pair]:
    """Where the phases of a function of the user may be, as far as it has values: the likeliest first."""
    least, most = start
    size = max(abs(least), abs(most))
    near = [0.1 * (most - least), *(size * 10.0**k for k in (-4, -2, 0))] if size else [1e-2]
    far = (
        (size * 10.0**k for k in (2, 4))
        if size
        else (10.0**k for k in (*range(-4, -22, -2), *range(2, 10, 2)))
    )
    about = [(least - way, most + way) for way in near]
    for low, high in (*about, (min(0.0, least), max(1.0, most)), *((least - way, most + way) for way in far)):
        yield farther(energy, least, low - least), farther(energy, most, high - most)


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


def widened(energy: FreeEnergy, low: float, high: float, start: Pair, part: float, most: int) -> Pair | None:
    """The phases that a start lies in most, between bounds that grow where these go on beyond.

    They grow by that part of what is between them, so often at most. None if there are no phases, or if they go on.
    """
    for _ in range(most):
        c, found = told(energy, low, high)
        if not found:
            return None
        gap = max(found, key=lambda ends: shared((c[ends[0]], c[ends[1]]), start))
        reach, before = part * (high - low), (low, high)
        if gap[0] < NEAR:
            low = farther(energy, low, -reach)
        if gap[1] >= len(c) - NEAR:
            high = farther(energy, high, reach)
        if (low, high) == before:
            return resolved(energy, low, high, c, gap)
    return None


def told(energy: FreeEnergy, low: float, high: float) -> tuple[Array, list[tuple[int, int]]]:
    """Samples between bounds, and the gaps of their hull over which an energy rises by more than it is rough."""
    c = np.linspace(low, high, SAMPLES)
    f, rough = energy.values(c), 0.0
    if isinstance(energy, UserFreeEnergy):
        # of tables, or of noise, of which these differences are a multiple
        rough = float(np.quantile(np.abs(np.diff(f, 5)), 0.99))
    return c, [(a, b) for a, b in gaps(c, f) if above(c[a : b + 1], f[a : b + 1]).max() > rough]


def above(c: Array, f: Array) -> Array:
    """Energies at compositions above the line between the first and the last."""
    return np.asarray(f - np.interp(c, c[[0, -1]], f[[0, -1]]))


def farther(energy: FreeEnergy, end: float, reach: float) -> float:
    """A composition as far beyond an end as an energy has values, up to some reach; not close to where these end."""
    parts = 0.5 ** np.arange(HALVED)
    return float(
        end + next((part for part in parts if has_values(energy, end, end + part * reach)), 0.0) * reach
    )


def farthest(energy: FreeEnergy, end: float, reach: float) -> float:
    """The same, as close to where values end as makes no difference."""
    has, lacks = 0.0, 1.0
    if has_values(energy, end, end + reach):
        return end + reach
    for _ in range(HALVED):
        part = 0.5 * (has + lacks)
        has, lacks = (part, lacks) if has_values(energy, end, end + part * reach) else (has, part)
    return end + has * reach


def has_values(energy: FreeEnergy, first: float, second: float) -> bool:
    """Whether an energy has values from one composition to another."""
    try:
        with np.errstate(all="ignore"):
            return bool(np.all(np.isfinite(energy.values(np.linspace(first, second, SAMPLES // 10)))))
    except RunError:  # what the user's function is taken from ends in between
        return False


def is_alone(energy: FreeEnergy, pair: Pair, low: float, high: float) -> bool:
    """Whether there are no other phases between bounds, or about those found.

    What goes on beyond is not counted, but where values end nothing does.
    """
    about, middle = BESIDE * (pair[1] - pair[0]), 0.5 * (pair[0] + pair[1])
    low, high = min(low, farthest(energy, pair[0], -about)), max(high, farthest(energy, pair[1], about))
    c, found = told(energy, low, high)
    goes_down, goes_up = (
        has_values(energy, end, end + way) for end, way in ((low, -SLIGHT * about), (high, SLIGHT * about))
    )
    return all(
        (a < NEAR and goes_down) or (b >= len(c) - NEAR and goes_up) or c[a] < middle < c[b] for a, b in found
    )


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
    x, y = c.tolist(), f.tolist()  # floats of Python, as it is one after the other
    for k in range(len(x)):
        while len(hull) > 1:
            a, b = hull[-2], hull[-1]
            rounding = 2e-15 * (abs(y[a]) + abs(y[b]) + abs(y[k])) * (x[k] - x[a])
            if (y[b] - y[a]) * (x[k] - x[a]) <= (y[k] - y[a]) * (x[b] - x[a]) + rounding:
                break
            hull.pop()
        hull.append(k)
    found = [(a, b) for a, b in pairwise(hull) if b - a > 1]
    return [part for gap in found for part in split(c, f, *gap)]


def split(c: Array, f: Array, first: int, second: int) -> list[tuple[int, int]]:
    """A common tangent between samples, at wells in between that touch it as far as samples tell."""
    between = slice(first, second + 1)
    df, bend = above(c[between], f[between]), np.diff(f[between], 2)
    k = np.arange(2, second - first - 1)
    touching = (df[k] <= np.minimum(df[k - 1], df[k + 1])) & (df[k] <= 0.25 * bend[k - 1])
    return list(pairwise([first, *(first + k[touching]).tolist(), second]))
