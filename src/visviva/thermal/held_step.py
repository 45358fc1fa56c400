"""Temperatures that are held over steps, where the balance is one of entropy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from visviva.model.term import Stencils
from visviva.thermal.carrier import EntropySupply

Array = NDArray[np.float64]


class HeldStep(EntropySupply):
    """Entropy that is supplied so that the temperature of the step is what it should be.

    That is the one that conducts. At the end of a step it should be the given one; within, on the way there from what
    it is where the step begins. The given one itself, held within, would leave what is off at the start of a step as
    much off to the other side at its end.

    Parameters
    ----------
    unknowns : int array (m, 3)
        Entropy, temperature and supply.
    values : callable
        Temperatures (m,) at a time.
    found : callable
        Temperatures (m,) of the state at all unknowns of the system, in the functions of the temperature.
    """

    def __init__(
        self,
        unknowns: NDArray[np.int32],
        values: Callable[[float], Array],
        found: Callable[[Array], Array],
    ) -> None:
        super().__init__(unknowns)
        self.values, self.found = values, found
        self._seen, self._start = np.zeros(0), np.zeros(0)

    def look(self, x: Array) -> None:
        self._seen, self._start = np.array(x), np.zeros(0)

    def _before(self) -> Array:
        """Temperatures (m,) where the step begins."""
        if not len(self._start):
            self._start = self.found(self._seen)
        return self._start

    def residual(self, s: Stencils) -> Array:
        found, held = super().residual(s), self.values(s.step.t1)
        if s.step.theta < 1:
            before = self._before()
            held = before + s.step.theta * (held - before)
        found[:, 2] = s.x1[:, 1] - held
        return found

    def tangent(self, s: Stencils) -> Array:
        K = np.array(super().tangent(s))
        K[:, 2, 1] = 1.0
        return K
