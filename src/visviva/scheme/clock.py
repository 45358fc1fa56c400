"""Time that is counted, not summed up: after k steps of length h it is t0 + k h."""

from __future__ import annotations

import math
from dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import rounding

SLIVER = 0.01
"""Part of a step that no step falls short of: velocities are increments by the length, and rounding of positions
would fill them."""
GRADED = 8
"""So many steps since the start there are at least before those with which a run begins lengthen."""


@dataclass
class Clock:
    """Counts steps of one length, or halves of them after failures.

    Sums of lengths drift, and leave slivers of steps at the end.

    Attributes
    ----------
    start : float
        Time from which steps are counted.
    step : float
        Length of a whole step.
    halvings : int
        How often it is halved at present.
    count : int
        Steps of the present length since the start.
    begins : bool
        Whether these are short steps with which a run begins, and which lengthen as time goes on.

    Examples
    --------
    >>> clock = Clock(step=0.1)
    >>> for _ in range(10):
    ...     clock.advance(0.1)
    >>> clock.time
    1.0
    """

    start: float = 0.0
    step: float = 0.0
    halvings: int = 0
    count: int = 0
    begins: bool = False

    @property
    def length(self) -> float:
        """Length of the present steps."""
        return math.ldexp(self.step, -self.halvings)

    @property
    def time(self) -> float:
        return self.start + self.count * self.length

    def restart(self, time: float) -> None:
        """Begin a new count of whole steps at a time."""
        self.start, self.halvings, self.count, self.begins = time, 0, 0, False

    def use(self, step: float) -> None:
        """Count whole steps of this length from now on, if it is another one."""
        if step != self.step:
            self.restart(self.time)
            self.step = step

    def advance(self, h: float) -> None:
        """A step of length `h` was taken; one of another length begins a new count."""
        if abs(h - self.length) <= self.rounding(self.time):
            self.count += 1
        else:
            self.restart(self.time + h)
            self.step = h

    def halve(self, failed: float) -> None:
        """Take steps of half the length that failed; where the end had shortened it, a new count of such begins."""
        if failed < self.length - self.rounding(self.time):
            self.restart(self.time)
            self.step = failed
        self.halvings, self.count = self.halvings + 1, 2 * self.count

    def begin_short(self, halvings: int) -> None:
        """Begin with steps that are halved so often, and are parts of the time since while they lengthen."""
        for _ in range(halvings):
            self.halve(self.length)
        self.begins |= halvings > 0  # a run that goes on may be among them

    def lengthen(self) -> None:
        """Twice the length again where a step of that length begins, so that the whole steps' times are met again."""
        if self.begins and self.count < GRADED:
            return
        if self.halvings and self.count % 2 == 0:
            self.halvings, self.count = self.halvings - 1, self.count // 2
        self.begins = self.begins and self.halvings > 0

    def next(self, until: float) -> float:
        """Length of the next step on the way to `until`: the last one is stretched if it left a sliver."""
        left, h = until - self.time, self.length
        whole = abs(left - h) <= self.rounding(until) or left > (1 + SLIVER) * h
        return h if whole else left

    def has_reached(self, until: float) -> bool:
        """True if the time is `until`, but for rounding."""
        return until - self.time <= self.rounding(until)

    def rounding(self, until: float) -> float:
        """By so much two times near `until` may differ and be the same."""
        return rounding(max(abs(until), abs(self.start)), self.step)

    def refuse_short(self, until: float, step: float, begins: bool) -> None:
        """Refuse an end that the first step of all would pass; later ones may be cut short, to no sliver."""
        left, least = until - self.time, ((1 - SLIVER) if begins else SLIVER) * step
        if left < least and not self.has_reached(until):
            raise InputError(
                f"step = {step:g} is longer than the way of {left:.6g} from the present time {self.time:g} to the end "
                f"time until = {until:g}: give a step of at most {left:.6g}, or a later end time"
            )
