"""Temperatures that are held over steps, where the balance is one of entropy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from visviva.model.term import Stencils
from visviva.thermal.carrier import EntropySupply

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class HeldStep(EntropySupply):
    """Entropy that is supplied so that the temperature of the step is what it should be.

    Parameters
    ----------
    unknowns : int array (m, 3)
        Entropy, temperature and supply.
    values : callable
        Temperatures (m,) at a time.
    """

    def __init__(self, unknowns: NDArray[np.int32], values: Callable[[float], Array]) -> None:
        super().__init__(unknowns)
        self.values = values

    def residual(self, s: Stencils) -> Array:
        found = super().residual(s)
        found[:, 2] = s.x1[:, 1] - self.values(s.step.te)
        return found

    def tangent(self, s: Stencils) -> Array:
        K = np.array(super().tangent(s))
        K[:, 2, 1] = 1.0
        return K
