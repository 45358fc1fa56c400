"""What mixtures and heated bodies store and lose: what schemes miss of sums over steps is theirs alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.model.field import Role
from visviva.model.model import Model

Array = NDArray[np.float64]


class Spread:
    """Accounts of the components with contents, where columns of a ledger are sums over all that store and lose alike.

    Attributes
    ----------
    span : array (3, n)
        Of each account what is stored, or was lost so far: now, least and greatest.
    """

    def __init__(self, model: Model) -> None:
        of = {model.index(f.component) for f in model.fields if f.role is Role.CONTENT}
        own = [(k, a.category) for k, a in enumerate(model.accounts) if a.component in of]
        self._stored = [k for k, category in own if category == "potential"]
        self._done = [k for k, category in own if category in ("work", "dissipation", "heat")]
        self.span = np.empty((0, len(self._stored) + len(self._done)))

    def add(self, core: Any) -> None:
        """Take in the core's sums of a step, or of the initial state."""
        so_far = self.span[0, len(self._stored) :] if len(self.span) else 0.0
        now = np.concatenate([core.energy[self._stored], so_far + core.work[self._done]])
        least, greatest = self.span[1:] if len(self.span) else (now, now)
        self.span = np.array([now, np.minimum(now, least), np.maximum(now, greatest)])

    @property
    def swing(self) -> float:
        """Greatest value of all steps less the least one, of all accounts together."""
        return float(np.sum(self.span[2] - self.span[1])) if len(self.span) else 0.0
