"""What some components store and lose: sums over steps and accounts that are lacking miss no more than that."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.announcements import Unbooked
from visviva.component.component import Component
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.results.outside import hanging_together

Array = NDArray[np.float64]

BROUGHT = ("work", "dissipation", "heat")
"""Categories of accounts of what comes and goes."""


class Spread:
    """Accounts of some components alone, where columns of a ledger are sums over all that store and lose alike.

    Parameters
    ----------
    model : Model
    losing, storing : collection of int
        Components whose works, dissipation and heat count, and those whose potentials do.

    Attributes
    ----------
    span : array (3, n)
        Of each account what is stored, or was lost so far: now, least and greatest.
    """

    def __init__(self, model: Model, losing: Collection[int], storing: Collection[int]) -> None:
        def own(components: Collection[int], *categories: str) -> list[int]:
            return [
                k
                for k, a in enumerate(model.accounts)
                if a.component in components and a.category in categories
            ]

        self._stored = own(storing, "potential")
        self._done = own(losing, *BROUGHT)
        self.span = np.empty((0, len(self._stored) + len(self._done)))

    @property
    def accounts(self) -> NDArray[np.int64]:
        """All that it looks at, what is stored before what is done."""
        return np.array([*self._stored, *self._done], dtype=int)

    @classmethod
    def empty(cls) -> Spread:
        """Nothing, as of a ledger that was read."""
        return cls(Model(), (), ())

    @classmethod
    def of(cls, model: Model, components: Iterable[Component]) -> Spread:
        """What these components store, and what is done to them and whatever they hang together with."""
        own = list(components)
        return cls(model, hanging_together(model, own), {model.index(c) for c in own})

    @classmethod
    def of_contents(cls, model: Model) -> Spread:
        """What mixtures lose and heated bodies exchange.

        Those that balance entropy turn one energy of theirs into another without an account of that.
        """
        contents = [f for f in model.fields if f.role is Role.CONTENT]
        entropic = [f for f in contents if model.entropies.touches(np.asarray(f.unknowns))]
        return cls(model, *({model.index(f.component) for f in some} for some in (contents, entropic)))

    def add(self, core: Any) -> None:
        """Take in the core's sums of a step, or of the initial state."""
        so_far = self.span[0, len(self._stored) :] if len(self.span) else 0.0
        now = np.concatenate([core.energy[self._stored], so_far + core.work[self._done]])
        least, greatest = self.span[1:] if len(self.span) else (now, now)
        self.span = np.array([now, np.minimum(now, least), np.maximum(now, greatest)])

    @property
    def stored(self) -> float:
        """Greatest value of all steps less the least one, of all that is stored."""
        return float(self.swings[: len(self._stored)].sum())

    @property
    def done(self) -> float:
        """The same of all that was lost or brought."""
        return float(self.swings[len(self._stored) :].sum())

    @property
    def swings(self) -> Array:
        """Greatest values of all steps less the least ones, by account."""
        least, greatest = self.span[1:] if len(self.span) else np.zeros((2, len(self._stored)))
        return np.asarray(greatest - least)


def unbooked(components: Iterable[Component]) -> dict[Component, str]:
    """Those that change energies by what is in no account, and why."""
    return {c: c.unbooked for c in components if isinstance(c, Unbooked) and c.unbooked}
