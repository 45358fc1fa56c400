"""Functions of time that a long step would not see, such as pulses between its ends."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.timefunction import TimeFunction
from visviva.base.world import world
from visviva.component.component import Component
from visviva.component.within import within

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]

MISSED = 0.1
"""Part of a function's range in a step by which it may be off the parabola of its start, middle and end."""
ROUNDING = 1e-12
"""Part of its values by which a function is off for that."""
SLIGHT = 0.01
"""Part of its range up to now that is not worth shorter steps."""
MOST = 200
"""Looks into one step; its ends and middle tell the rest of what is short."""


class FunctionsInSteps:
    """Looks at the functions of time that components were given, within steps longer than a given one.

    Tables are left out: steps end at their points.

    Attributes
    ----------
    seen : array (2, n)
        The least and greatest value of each function up to now.
    """

    def __init__(self, system: System, seen: Array | None) -> None:
        found = {
            id(f): f
            for c in system.components
            for field in fields(c)
            for f in within(getattr(c, field.name), TimeFunction, (Component,))
        }
        self._functions = [f for f in found.values() if callable(f.source) or isinstance(f.source, str)]
        nothing = np.full((2, len(self._functions)), [[np.inf], [-np.inf]])
        self.seen = nothing if seen is None or seen.shape != nothing.shape else seen
        self._within = self.seen

    def are_missed(self, time: float, taken: float, step: float) -> bool:
        """Whether a step `taken` from a time, longer than a given one, passes over what some function does."""
        if not self._functions:
            return False
        n = 2 * min(math.ceil(taken / step), MOST // 2)
        s = np.linspace(0.0, 1.0, n + 1)
        values = np.array([[f(time + taken * float(part)) for part in s] for f in self._functions])
        least, greatest = values.min(axis=1), values.max(axis=1)
        self._within = np.array([np.minimum(self.seen[0], least), np.maximum(self.seen[1], greatest)])
        first, middle, last = (values[:, k, None] for k in (0, n // 2, n))
        parabola = first * (1 - s) * (1 - 2 * s) + 4 * middle * s * (1 - s) + last * s * (2 * s - 1)
        off = np.abs(values - parabola).max(axis=1)
        missed = off > np.maximum(MISSED * (greatest - least), SLIGHT * (self._within[1] - self._within[0]))
        missed &= off > ROUNDING * np.abs(values).max(axis=1)
        return taken > step * (1 + 1e-9) and bool(world().first(bool(missed.any())))

    def accept(self) -> None:
        """The step that was looked at last is taken."""
        self.seen = self._within
