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
"""Cosine between the changes in two steps from whose negative on the second takes the first back."""
FADED, NOISE = 1e-3, 1e-9
"""Parts of the largest change so far, and of what there is, below which changes are not looked at."""
MIDDLE = 0.5
"""Where schemes evaluate that ring: in the middle of steps."""
MANY = 4
"""Steps in a row that take back the one before them, by which a run is told to ring."""


class Swings:
    """Counts the steps in a row in which what is of first order in time, or has no mass, takes back its last change.

    Rules that ask for balance in the middle of a step (Crank & Nicolson) do so after a sudden change, for
    ``1 / k``-th of the steps if these are k times longer than the finest cell takes to follow.
    """

    def __init__(self) -> None:
        self._own: NDArray[np.bool_] | None = None
        self._before: Array | None = None
        self._change: Array | None = None
        self._largest = 0.0
        self._count = 0

    def look(self, system: System) -> int:
        """After a step: how many in a row took back the one before."""
        if self._own is None:
            self._own = system.order == 1
            for _, unknowns in massless(system):
                self._own[unknowns] = True
        own = self._own
        if not own.any():
            return 0
        now, before, last = system.x[own], self._before, self._change
        self._before = now
        if before is None:
            return 0
        scale = np.where(system.scale[own] > 0, system.scale[own], 1.0)
        self._change = change = (now - before) / scale
        size = float(np.linalg.norm(change))
        self._largest = max(self._largest, size)
        if last is None or size <= max(FADED * self._largest, NOISE * float(np.linalg.norm(now / scale))):
            self._count = 0
            return 0
        takes_back = float(change @ last) < -BACK * size * float(np.linalg.norm(last))
        self._count = self._count + 1 if takes_back else 0
        return self._count
