"""The step in which a balance gains most while work is done: sums over steps do not resolve what jumps there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Leap:
    """Largest gain of a balance in one step in which works change.

    Attributes
    ----------
    values : array (3,)
        Imbalance and sum of works after the last step, and that gain.

    Examples
    --------
    >>> leap = Leap()
    >>> for imbalance, works in ((0.0, 0.0), (0.1, 0.5), (0.4, 0.5), (0.6, 0.9)):
    ...     leap.add(imbalance, works)
    >>> round(leap.gain, 9)
    0.2
    """

    def __init__(self) -> None:
        self.values = np.zeros(3)

    def add(self, imbalance: float, works: float) -> None:
        """Take in a step."""
        before, done, gain = self.values
        here = imbalance - before if works != done else 0.0
        self.values = np.array([imbalance, works, max(gain, here)])

    @property
    def gain(self) -> float:
        """So much was gained in that step."""
        return float(self.values[2])
