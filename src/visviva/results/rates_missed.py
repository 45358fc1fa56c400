"""What rates over several steps miss of contents: these change by what the scheme does not ask a balance for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.model.field import Role
from visviva.model.model import Model

Array = NDArray[np.float64]


class RatesMissed:
    """By groups of components, the energy that contents change by beyond what their rates say.

    Rates such as ``(3 dx - dx_last) / 2h`` are balanced by what flows, times the step, while dx is stored: of entropy
    the difference is known, at the temperatures of the step, and sums over steps miss no more than what entropies and
    temperatures change by in one, times each other. Of what stores heat without any, or matter, it is at most
    what changes of steps differ by from each other.

    Parameters
    ----------
    model : Model
    of : array of int (n,)
        Groups of the components.

    Attributes
    ----------
    span : array (7, n)
        Of each group what its contents without entropy store, the least and the greatest change of that in a step,
        what its entropy missed so far, the least and the greatest of that, and the sum of changes of entropies times
        those of temperatures, without their signs.
    last : array
        Time, and entropies and their temperatures at the end of the last step.
    """

    def __init__(self, model: Model, of: NDArray[np.int64]) -> None:
        contents = [f for f in model.fields if f.role is Role.CONTENT]
        warm = {f.component: f for f in model.fields if f.role is Role.TEMPERATURE}
        entropic = [f for f in contents if model.entropies.touches(np.asarray(f.unknowns))]
        others = {model.index(f.component) for f in contents if f not in entropic}
        self._n = len(of)
        stores = [a.component in others and a.category == "potential" for a in model.accounts]
        self.accounts = np.flatnonzero(stores)
        self._storing = of[[model.accounts[k].component for k in self.accounts]].astype(int)
        weights = dict[int, float]()
        for unknowns, own in zip(model.entropies.unknowns, model.entropies.weights, strict=True):
            weights.update(zip(map(int, unknowns), map(float, own), strict=True))
        none = [np.zeros(0, dtype=int)]
        self._unknowns = np.concatenate([*none, *(np.asarray(f.unknowns) for f in entropic)])
        self._kelvin = np.concatenate([*none, *(np.asarray(warm[f.component].unknowns) for f in entropic)])
        self._weights = np.array([weights.get(int(u), 0.0) for u in self._unknowns])
        self._having = np.concatenate(
            [*none, *(np.full(f.size, of[model.index(f.component)]) for f in entropic)]
        )
        self.span = np.empty((0, self._n))
        self.last = np.empty(0)

    def add(self, time: float, core: Any) -> None:
        """Take in the core's state after a step, or the initial one."""
        stored = np.bincount(self._storing, core.energy[self.accounts], self._n)
        x, k = np.array(core.x), len(self._unknowns)
        entropy, kelvin = x[self._unknowns], x[self._kelvin]
        if not len(self.span):
            never = np.full(self._n, np.inf)
            self.span = np.array([stored, never, -never, *np.zeros((4, self._n))])
        else:
            before, least, greatest, missed, lowest, highest, mixed = self.span
            change, differs = stored - before, entropy - self.last[1 : k + 1]
            beyond = (time - self.last[0]) * np.array(core.v)[self._unknowns] - differs
            missed = missed + self._by_group(kelvin * self._weights * beyond)
            both = np.abs(self._weights * differs * (kelvin - self.last[k + 1 :]))
            self.span = np.array(
                [
                    stored,
                    np.minimum(change, least),
                    np.maximum(change, greatest),
                    missed,
                    np.minimum(missed, lowest),
                    np.maximum(missed, highest),
                    mixed + self._by_group(both),
                ]
            )
        self.last = np.concatenate([[time], entropy, kelvin])

    @property
    def most(self) -> Array:
        """The most that may have been missed, of each group."""
        if not len(self.span):
            return np.zeros(self._n)
        _, least, greatest, _, lowest, highest, mixed = self.span
        return np.asarray(np.maximum(greatest - least, 0.0) + highest - lowest + mixed)

    def _by_group(self, values: Array) -> Array:
        """Sums over what has entropy."""
        return np.asarray(np.bincount(self._having, values, self._n), dtype=float)
