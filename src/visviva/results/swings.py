"""Detect oscillations from step to step of heat, flow and concentrations: steps too long for a jump cause them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.system.freedom import massless

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]

BACK = 0.15
"""Part of a change by which the next one takes it back."""
NOISE = 1e-9
"""Part of the field's largest value below which changes are not looked at."""
UNSOLVED = 1e-11
"""Part of what is a large change for a field, below which Newton's method and rounding leave changes."""
RINGING = ((2, 0.55, 0.25), (3, 0.1, 0.02), (6, 0.01, 0.002))
"""Steps in a row that take back the one before them, by which a run is told to ring, if the least of the last three of
them is more than these parts of the field's largest change in a step, and of its largest change since the start.

What the steps resolve changes its direction once in several of them. After a change that came over ten steps, values
ring by less than that."""


class Swings:
    """Counts the steps in a row in which something of first order in time, or without mass, takes back its last change.

    Rules that ask for balance in the middle of a step (Crank & Nicolson), and `GeneralizedAlpha` with rho near 1, do so
    after a sudden change, for ``1 / k``-th of the steps if these are k times longer than the finest cell takes to
    follow. Changes are judged by those of their own field of one component: what happens elsewhere, in other units too,
    hides none.

    Attributes
    ----------
    largest : array (2, n)
        Of each field what is looked at, the largest change so far in a step, and since the start.
    """

    def __init__(self) -> None:
        self._own: NDArray[np.int64] | None = None
        self._states: list[Array] = []
        self._counts = np.zeros(0, dtype=np.int64)
        self.largest = np.empty((2, 0))

    def look(self, system: System) -> int:
        """At the start and after each step: how many in a row ring, of the unknown of which they are most."""
        if self._own is None:
            self._own = self._begin(system)
        if not len(self._own):
            return 0
        now = system.x[self._own] / self._scale
        if not self._states:
            self._start = now
        self._states = [*self._states[-3:], now]
        changes = np.diff(self._states, axis=0)
        if not len(changes):
            return 0
        sizes = np.abs(changes)
        so_far = np.array([self._of_fields(sizes[-1]), self._of_fields(np.abs(now - self._start))])
        self.largest = np.maximum(self.largest, so_far)
        if len(changes) < 2:
            return 0
        least = np.repeat(np.maximum(NOISE * self._of_fields(np.abs(now)), UNSOLVED), self._sizes)
        takes_back = (
            self._free
            & (sizes[-1] > least)
            & (changes[-1] * changes[-2] < 0)
            & (sizes[-1] > BACK * sizes[-2])
        )
        self._counts = np.where(takes_back, self._counts + 1, 0)
        return int(self._counts.max(where=self._ringing(sizes.min(axis=0)), initial=0))

    def resume(self, largest: Array | None, system: System) -> None:
        """Go on from here with the largest changes of a run that was saved, if it had them."""
        if self._own is None:  # under rules that do not ring nothing is looked at
            return
        self._states = []
        self.look(system)
        if largest is not None and np.shape(largest) == self.largest.shape:
            self.largest = np.array(largest)

    def _begin(self, system: System) -> NDArray[np.int64]:
        """Unknowns to look at."""
        own = watched(system)
        self._free = ~np.concatenate([f.fixed for f in system.model.fields])[own]
        self._scale = np.where(system.scale[own] > 0, system.scale[own], 1.0)
        field = np.searchsorted([f.start for f in system.model.fields], own, side="right")
        _, self._starts, self._sizes = np.unique(field, return_index=True, return_counts=True)
        self._counts = np.zeros(len(own), dtype=np.int64)
        self.largest = np.zeros((2, len(self._starts)))
        return own

    def _ringing(self, sizes: Array) -> NDArray[np.bool_]:
        """Which have taken back enough of what changed before, often enough."""
        found = np.zeros(len(sizes), dtype=bool)
        for count, *parts in RINGING:
            enough = np.max(np.array(parts)[:, None] * self.largest, axis=0)
            found |= (self._counts >= count) & (sizes > np.repeat(enough, self._sizes))
        return found

    def _of_fields(self, values: Array) -> Array:
        """Largest value of each field that has any of the unknowns looked at."""
        return np.asarray(np.maximum.reduceat(values, self._starts))


def watched(system: System) -> NDArray[np.int64]:
    """Unknowns of first order in time, or without mass."""
    own = system.order == 1
    for _, unknowns in massless(system):
        own[unknowns] = True
    return np.flatnonzero(own)
