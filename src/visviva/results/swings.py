"""Detect oscillations from step to step of heat, flow and concentrations: steps too long for a jump cause them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.system.freedom import massless

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]

BACK = 0.5
"""Part of a change by which the next one takes it back."""
FADED, NOISE = 1e-3, 1e-9
"""Parts of the field's largest change so far, and of its largest value, below which changes are not looked at."""
UNSOLVED = 1e-11
"""Part of what is a large change for a field, below which Newton's method and rounding leave changes."""
MANY = 6
"""Steps in a row that take back the one before them, by which a run is told to ring."""


class Swings:
    """Counts the steps in a row in which something of first order in time, or without mass, takes back its last change.

    Rules that ask for balance in the middle of a step (Crank & Nicolson), and `GeneralizedAlpha` with rho near 1, do so
    after a sudden change, for ``1 / k``-th of the steps if these are k times longer than the finest cell takes to
    follow. Changes are judged by those of their own field of one component: what happens elsewhere, in other units too,
    hides none.
    """

    def __init__(self) -> None:
        self._own: NDArray[np.int64] | None = None
        self._before: Array | None = None
        self._change: Array | None = None
        self._counts = np.zeros(0, dtype=np.int64)

    def look(self, system: System) -> int:
        """After a step: how many in a row took back the one before, of the unknown of which they are most."""
        if self._own is None:
            self._own = watched(system)
            self._scale = np.where(system.scale[self._own] > 0, system.scale[self._own], 1.0)
            field = np.searchsorted([f.start for f in system.model.fields], self._own, side="right")
            _, self._starts, self._sizes = np.unique(field, return_index=True, return_counts=True)
            self._largest = np.zeros(len(self._starts))
        if not len(self._own):
            return 0
        now, before, last = system.x[self._own] / self._scale, self._before, self._change
        self._before = now
        if before is None:
            self._counts = np.zeros(len(now), dtype=np.int64)
            return 0
        self._change = change = now - before
        size = np.abs(change)
        self._largest = np.maximum(self._largest, self._of_fields(size))
        if last is None:
            return 0
        least = np.maximum(FADED * self._largest, np.maximum(NOISE * self._of_fields(np.abs(now)), UNSOLVED))
        takes_back = (
            (size > np.repeat(least, self._sizes)) & (change * last < 0) & (size > BACK * np.abs(last))
        )
        self._counts = np.where(takes_back, self._counts + 1, 0)
        return int(self._counts.max())

    def _of_fields(self, values: Array) -> Array:
        """Largest value of each field that has any of the unknowns looked at."""
        return np.asarray(np.maximum.reduceat(values, self._starts))


def watched(system: System) -> NDArray[np.int64]:
    """Unknowns of first order in time, or without mass."""
    own = system.order == 1
    for _, unknowns in massless(system):
        own[unknowns] = True
    return np.flatnonzero(own)
