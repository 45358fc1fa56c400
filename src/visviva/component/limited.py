"""Components whose equations do not hold in all states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class Limited:
    """A component at whose limits steps fail: they may not end there."""

    def invalid(self, x: NDArray[np.float64]) -> str:
        """Why its equations mean nothing at the unknowns `x` of the system, in a sentence; empty if they hold.

        Its `trouble` says it as well.
        """
        return ""
