"""Components whose equations do not hold in all states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component


class Limited(Component):
    """A component at whose limits steps fail: they may not end there."""

    def invalid(self, x: NDArray[np.float64]) -> str:
        """Why its equations mean nothing at the unknowns `x` of the system, in a sentence; empty if they hold."""
        return ""

    def trouble(self, x: NDArray[np.float64]) -> str:
        return self.invalid(x) or super().trouble(x)
