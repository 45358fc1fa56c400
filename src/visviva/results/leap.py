"""The step in which a balance gains most as what cracks stores it: sums over steps do not resolve what jumps there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visviva.model.model import Model

Array = NDArray[np.float64]


class Leap:
    """Largest gain of a balance in one step in which what grows in one direction stores as much, as by a jump.

    Attributes
    ----------
    values : array (3,)
        Imbalance and what that stores after the last step, and this gain.
    """

    def __init__(self, model: Model) -> None:
        of = {model.index(growing.field.component) for growing in model.growing}
        accounts = enumerate(model.accounts)
        self._stored = [k for k, a in accounts if a.component in of and a.category == "potential"]
        self.values = np.zeros(3)

    def add(self, imbalance: float, energy: Array) -> None:
        """Take in a step, or the initial state, with the energies (n,) of all accounts."""
        before, held, gain = self.values
        stored = energy[self._stored].sum()
        self.values = np.array([imbalance, stored, max(gain, min(imbalance - before, stored - held))])

    @property
    def gain(self) -> float:
        """So much was gained in that step."""
        return float(self.values[2])
