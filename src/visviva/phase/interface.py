"""Phases that a free energy separates into, and the flat interface between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from visviva.base.errors import NotFinite, RunError
from visviva.phase.free_energy import DoubleWell, FreeEnergy, UserFreeEnergy

Array = NDArray[np.float64]
Pair = tuple[float, float]

SAMPLES = 1001
"""Compositions at which an energy is looked at."""
STRIDE = 8
"""Of these between which it bends, so that rounding and corners of tables do not."""
FEW = 101
"""Compositions that tell whether it has values."""
FINE = 4001
"""Those between phases by which their tension is summed."""
NEAREST, FARTHEST = 1e-6, 1e20
"""Sizes of a start at which looking for the phases of a function begins and ends."""
EMPTY = 1e-30, 1e30
"""The same of a start of nothing: whatever unit there is."""
HALVED = 40
"""Times that a way is halved to where values end."""
RETREATS = 0.0, 1e-6, 1e-3
"""Parts of that way by which poles are kept away from, as little as will do."""
HUGE = 1e100
"""Values that count as none."""
SLIGHT = 0.01
"""Part of the largest bend that is none."""
SUDDEN = 10
"""Times that poles bend more than what is beside them, at least."""
DWARFED = 20
"""Times that phases are farther apart than ripples of tables, at least, and its square that they rise higher."""
BESIDE = 10, 100
"""Widths beside phases up to which others are looked for, at once."""
INSIDE = 20
"""Samples of a gap that tell how rough it is, at least."""
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
    polynomials that are bounded below tell all that they have; of others it is the nearest to `start`, the least and
    largest value at the start. What falls for ever beyond phases, as polynomials of odd degree do, does not count.

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
    c = np.linspace(*pair, FINE)
    f = energy.values(c)
    df = above(c, f)
    tension = float(np.trapezoid(np.sqrt(2 * gradient * np.maximum(df, 0.0)), c))
    width = (pair[1] - pair[0]) * float(np.sqrt(gradient / (2 * df.max())))
    return Interface(*pair, tension, width, alone and not is_parted(df), float((f[-1] - f[0]) / df.max()))


def is_parted(df: Array) -> bool:
    """Whether what is above a common tangent bends up between where it bends down, so that more phases may last."""
    bend = np.diff(df[:: FINE // FEW], 2)
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
    return round((most - least) / (pair[1] - pair[0]), 2)


def phases(energy: FreeEnergy, start: Pair) -> tuple[Pair, bool] | None:
    """The phases of an energy that a start lies in most, and whether it has no others."""
    if isinstance(energy, DoubleWell):
        return (energy.low, energy.high), True
    found = (separated(energy, look, start) for look in known(energy) or windows(energy, start))
    pair = next(filter(None, found), None)
    if pair and isinstance(energy, UserFreeEnergy):
        pair = without_ripples(energy, pair, start)
    return pair and (pair, is_alone(energy, pair))


def without_ripples(energy: FreeEnergy, pair: Pair, start: Pair) -> Pair:
    """The phases that a table means by values between which it has others."""
    for look in (look for k in (2, 3) for look in beside(energy, pair, DWARFED**k)):
        other = separated(energy, look, start)
        if other and other[1] - other[0] > DWARFED * (pair[1] - pair[0]):
            small, large = (above(c, energy.values(c)).max() for c in map(between, (pair, other)))
            if large > DWARFED**2 * small:
                return other
    return pair


@dataclass(frozen=True)
class Look:
    """Values of an energy at compositions, and whether it has none below the first and above the last."""

    c: Array
    f: Array
    closed: tuple[bool, bool]

    def part(self, first: int, last: int) -> Look:
        """From one sample to another."""
        closed = self.closed[0] and first == 0, self.closed[1] and last == len(self.c) - 1
        return Look(self.c[first : last + 1], self.f[first : last + 1], closed)

    def pair(self, gap: tuple[int, int]) -> Pair:
        """Compositions at both ends of a gap."""
        return float(self.c[gap[0]]), float(self.c[gap[1]])

    def is_inside(self, gap: tuple[int, int]) -> bool:
        """Whether a gap does not go on beyond."""
        return (gap[0] > 0 or self.closed[0]) and (gap[1] < len(self.c) - 1 or self.closed[1])


def known(energy: FreeEnergy) -> list[Look]:
    """All that an energy has; nothing where it does not tell."""
    looks = [look_at(energy, ends, (energy.has_domain,) * 2, FINE) for ends in bounds(energy)]
    return [look for look in looks if look is not None]


def tells_all(energy: FreeEnergy) -> bool:
    """Whether all phases of an energy are found, wherever a start is."""
    return isinstance(energy, DoubleWell) or bool(bounds(energy))


def bounds(energy: FreeEnergy) -> list[Pair]:
    """Between which compositions all phases are; nothing where an energy does not tell."""
    if energy.has_domain:
        low, high = energy.domain
        return [(low + EDGE, high - EDGE)]
    if isinstance(energy, UserFreeEnergy) or not is_bounded(energy):
        return []
    return [around(energy, *(spinodals(energy) or (-1.0, 1.0)))]


def around(energy: FreeEnergy, low: float, high: float) -> Pair:
    """What common tangents of a polynomial can touch, which bends up below and above two compositions.

    They are no steeper, and no less steep, than it is somewhere in between.
    """
    slope = energy.polynomial.deriv()
    first, last = low - energy.centre, high - energy.centre
    turns = [c for c in real_roots(slope.deriv()) if first < c < last]
    steep = slope(np.array([first, *turns, last]))
    least = real_roots(slope - steep.min()).min(initial=first) + energy.centre
    most = real_roots(slope - steep.max()).max(initial=last) + energy.centre
    return float(least + low - high), float(most + high - low)


def real_roots(polynomial: Polynomial) -> Array:
    """Those without an imaginary part but for rounding, in order."""
    roots = polynomial.roots()
    return np.sort(roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots).max(initial=0.0)])


def windows(energy: FreeEnergy, start: Pair) -> Iterator[Look]:
    """What a function of the user has about a start, each time twice as far away, up to where values end.

    Neither its unit is told nor up to where it is meant: the nearest is.
    """
    with np.errstate(all="ignore"):
        energy.values(between(start))  # which says where it has none
    (low, high), closed = start, (False, False)
    size = max(abs(low), abs(high))
    way, most = (max(0.1 * (high - low), NEAREST * size), FARTHEST * size) if size else EMPTY
    while way < most and not all(closed):
        aims = low if closed[0] else start[0] - way, high if closed[1] else start[1] + way
        if look := as_far(energy, start, aims, closed):
            (low, high), closed = look.pair((0, -1)), look.closed
            yield look
        way *= 2


def is_bounded(energy: FreeEnergy) -> bool:
    """Whether a polynomial has a least value."""
    coefficients = np.trim_zeros(energy.polynomial.coef, "b")
    return len(coefficients) % 2 == 1 and bool(coefficients[-1] > 0)


def spinodals(energy: FreeEnergy) -> Pair | None:
    """The outermost compositions that a polynomial is concave between; None if it is nowhere."""
    bend = energy.polynomial.deriv(2)
    found = real_roots(bend)
    if len(found) < 2 or not np.min(bend(0.5 * (found[1:] + found[:-1]))) < 0:
        return None
    return float(found[0] + energy.centre), float(found[-1] + energy.centre)


def between(pair: Pair) -> Array:
    """A few compositions from one to another."""
    return np.linspace(*pair, FEW)


def above(c: Array, f: Array) -> Array:
    """Energies at compositions above the line between the first and the last."""
    return np.asarray(f - np.interp(c, c[[0, -1]], f[[0, -1]]))


def look_at(energy: FreeEnergy, ends: Pair, closed: tuple[bool, bool], samples: int = SAMPLES) -> Look | None:
    """An energy between compositions, closer near these; None where it has no values, or a pole, in between."""
    low, high = ends
    c = low + (high - low) * np.sin(np.linspace(0, 0.5 * np.pi, samples)) ** 2
    c[-1] = high
    f = values(energy, c)
    return None if f is None or has_pole(energy, c, f) else Look(c, f, closed)


def values(energy: FreeEnergy, c: Array) -> Array | None:
    """Of an energy; None if it has none somewhere."""
    try:
        with np.errstate(all="ignore"):
            f = energy.values(c)
    except RunError:  # what the user's function is taken from ends in between
        return None
    return f if np.all(np.abs(f) < HUGE) else None


def has_pole(energy: FreeEnergy, c: Array, f: Array) -> bool:
    """Whether values grow beyond all bounds between the samples where they bend down most suddenly."""
    for _ in range(3):
        bend = np.pad(np.maximum(-np.diff(f, 2), 0.0), 3)
        sudden = bend[3:-3] * (bend[3:-3] > SUDDEN * np.maximum(bend[6:], bend[:-6]))
        if not sudden.any():
            return False
        at = int(np.argmax(sudden)) + 1
        around = float(np.ptp([*f[max(at - 3, 0) : max(at - 1, 0)], *f[at + 2 : at + 4]]))
        c = np.linspace(c[at - 1], c[at + 1], FEW)
        closer = values(energy, c)
        if closer is None:
            return True
        if not np.ptp(closer) > 2 * around:
            return False
        f = closer
    return True


def as_far(
    energy: FreeEnergy, inner: Pair, aims: Pair, closed: tuple[bool, bool] = (False, False)
) -> Look | None:
    """A look at an energy up to aims, or to where values end between these and what is inside of them."""
    if look := look_at(energy, aims, closed):
        return look
    low, high = farthest(energy, inner[0], aims[0]), farthest(energy, inner[1], aims[1])
    closed = closed[0] or low != aims[0], closed[1] or high != aims[1]
    for part in RETREATS:
        ends = low + part * closed[0] * (inner[0] - low), high + part * closed[1] * (inner[1] - high)
        if look := look_at(energy, ends, closed):
            return look
    return None


def farthest(energy: FreeEnergy, end: float, aim: float) -> float:
    """A composition as far from an end as an energy has values, up to some aim."""
    has, lacks, middle = end, aim, aim
    for _ in range(HALVED):
        if look_at(energy, (min(end, middle), max(end, middle)), (False, False), FEW) is None:
            lacks = middle
        else:
            has = middle
        if has == aim:
            break
        middle = 0.5 * (has + lacks)
    return has


def separated(energy: FreeEnergy, look: Look, start: Pair) -> Pair | None:
    """The phases that a start lies in most; None if there are none, or if these may go on beyond."""
    seen = without_falls(energy, look)
    if seen is None:
        return None
    found = [gap for gap in told(seen) if seen.is_inside(gap) or shared(seen.pair(gap), start) > 0]
    gap = max(found, key=lambda gap: shared(seen.pair(gap), start), default=(0, 0))
    return resolved(energy, seen, gap) if found and seen.is_inside(gap) else None


def without_falls(energy: FreeEnergy, look: Look) -> Look | None:
    """A closer look at what bends up, down, and up again; None if nothing does."""
    part = bent(look)
    closer = part and look_at(energy, part.pair((0, -1)), part.closed)
    return closer and bent(closer)


def bent(look: Look) -> Look | None:
    """What common tangents may touch, as far as an energy is not rough; None if nothing bends up, down, and up again.

    They touch nothing beyond ends that bend down, and nothing steeper or less steep than all that bends down between.
    """
    x, y = look.c[::STRIDE], look.f[::STRIDE]
    below = (y[:-2] * (x[2:] - x[1:-1]) + y[2:] * (x[1:-1] - x[:-2])) / (x[2:] - x[:-2]) - y[1:-1]
    rough = np.concatenate([[0.0], np.cumsum(np.pad(np.abs(np.diff(look.f, 5)), (2, 3)))])
    rough = (rough[2 * STRIDE :: STRIDE] - rough[: -2 * STRIDE : STRIDE]) / STRIDE
    clear = np.flatnonzero(np.abs(below) > rough)
    up = clear[below[clear] > 0]
    down = clear[(below[clear] < 0) & (clear > up.min(initial=len(x))) & (clear < up.max(initial=0))]
    if not len(down):
        return None
    slopes = np.diff(y) / np.diff(x)
    steep = slopes[np.concatenate([down, down + 1])]
    first = 0 if up[0] == clear[0] else up[0]
    last = len(slopes) if up[-1] == clear[-1] else up[-1] + 2
    first = max([first, *np.flatnonzero(slopes[: down[0]] < steep.min())[-1:]])
    last = min([last, *(down[-1] + 3 + np.flatnonzero(slopes[down[-1] + 2 :] > steep.max())[:1])])
    return look.part(int(first) * STRIDE, int(last) * STRIDE)


def told(look: Look) -> list[tuple[int, int]]:
    """Gaps of the hull over which an energy rises by more than it is rough."""
    rough = np.abs(np.diff(look.f, 5))  # of tables, or of noise, of which these differences are a multiple

    def is_clear(a: int, b: int) -> bool:
        inside = (
            slice(a, b - 4) if b - a >= INSIDE else slice(max(a - 5, 0), b + 1)
        )  # without steep walls beside
        return bool(above(look.c[a : b + 1], look.f[a : b + 1]).max() > rough[inside].max(initial=0.0))

    return [gap for gap in gaps(look.c, look.f) if is_clear(*gap)]


def is_alone(energy: FreeEnergy, pair: Pair) -> bool:
    """Whether an energy has no other phases, or a function of the user none about those found."""
    for look in known(energy) or (look for widths in BESIDE for look in beside(energy, pair, widths)):
        if (seen := without_falls(energy, look)) is not None:
            for gap in told(seen):
                low, high = seen.pair(gap)
                same = max(abs(low - pair[0]), abs(high - pair[1])) < SLIGHT * (seen.c[-1] - seen.c[0])
                if not same and (seen.is_inside(gap) or low < 0.5 * sum(pair) < high):
                    return False
    return True


def beside(energy: FreeEnergy, pair: Pair, widths: float) -> list[Look]:
    """What a function has about phases, up to so many times what is between them."""
    about = widths * (pair[1] - pair[0])
    look = as_far(energy, pair, (pair[0] - about, pair[1] + about))
    return [] if look is None else [look]


def resolved(energy: FreeEnergy, look: Look, gap: tuple[int, int]) -> Pair:
    """The ends of a tangent that is a gap between samples, by closer ones."""
    (first, second), (low, high) = look.pair(gap), look.pair((0, -1))
    apart = second - first
    closer = look_at(energy, (max(low, first - 0.5 * apart), min(high, second + 0.5 * apart)), look.closed)
    found = [] if closer is None else gaps(closer.c, closer.f)
    if closer is None or not found:
        return first, second
    ends = max((closer.pair(gap) for gap in found), key=lambda ends: shared(ends, (first, second)))
    return polished(energy, *ends, 4 * apart / SAMPLES)


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
            if max(abs(a - ends[0]), abs(b - ends[1])) <= EDGE * near:
                break
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
