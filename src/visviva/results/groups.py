"""Balances of energy of what hangs together, each for itself: what is done to others excuses no gain there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.results.outside import groups, untold
from visviva.results.spread import BROUGHT, Spread

Array = NDArray[np.float64]


class Groups:
    """What components gain and lose beside what is brought to them, by those that hang together, if not all do.

    Left out are those with contents, of which energies turn into each other without an account of that, and those that
    do not book all; and all, where something that acts does not tell on whom.

    Parameters
    ----------
    model : Model
    lacking : iterable of Component
        Those that do not book all.

    Attributes
    ----------
    span : array (3, n)
        What each group stored at the start, and the least and the greatest that it gained so far; empty where that is
        not known.
    brought : Spread
        What was done to them.
    """

    def __init__(self, model: Model, lacking: Iterable[Component] = ()) -> None:
        self._model, self._of = model, groups(model)
        owners = np.array([a.component for a in model.accounts], dtype=int)
        contents = [f.component for f in model.fields if f.role is Role.CONTENT]
        out = [self._of[model.index(c)] for c in (*contents, *lacking)]
        of = self._of[owners]
        apart = len(set(of)) > 1 and not untold(model).intersection(owners)
        judged = apart & ~np.isin(of, out)
        stores = np.array([a.category in ("kinetic", "potential") for a in model.accounts], dtype=bool)
        does = np.array([a.category in BROUGHT for a in model.accounts], dtype=bool)
        self._stored, self._done = np.flatnonzero(judged & stores), np.flatnonzero(judged & does)
        self._storing, self._doing = of[self._stored], of[self._done]
        self.brought = Spread(model, set(owners[self._done]), ())
        self.span = np.empty((0, len(self._of)))

    def add(self, core: Any) -> None:
        """Take in the core's sums of a step, or of the initial state."""
        if not len(self._stored):
            return
        self.brought.add(core)
        stored = self._by_group(self._storing, core.energy[self._stored])
        start, least, greatest = self.span if len(self.span) else (stored, np.inf, -np.inf)
        gained = stored - start - self._by_group(self._doing, self.brought.span[0])
        self.span = np.array([start, np.minimum(gained, least), np.maximum(gained, greatest)])

    def resume(self, span: Array | None, brought: Array | None) -> None:
        """Go on with the sums of a run that was saved, if it had them."""
        known = span is not None and brought is not None and np.shape(span)[1:] == self.span.shape[1:]
        self.span = np.array(span) if known else np.full((3, len(self._of)), np.nan)
        self.brought.span = np.array(brought) if known else self.brought.span

    def balances(self) -> Iterator[tuple[list[Any], float, float, float]]:
        """Of each group its components, the most that it gained and lost, and how far what was brought to it swung."""
        if not len(self.span):
            return
        swings = self._by_group(self._doing, self.brought.swings)
        for k in np.unique(self._storing):
            members = [c for c, group in zip(self._model.components, self._of, strict=True) if group == k]
            yield members, float(self.span[2, k]), -float(self.span[1, k]), float(swings[k])

    def _by_group(self, of: NDArray[np.int64], values: Array) -> Array:
        """Sums over the accounts of each."""
        return np.asarray(np.bincount(of, values, len(self._of)), dtype=float)
