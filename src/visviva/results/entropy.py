"""The second law in the ledger: what entropy there is, what of it arose, and what came from outside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.model.entropies import PRODUCED, SUPPLIED
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.results.ledger import Ledger

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EntropyColumns:
    """Columns of a ledger about entropy; none where no component announces any.

    Attributes
    ----------
    produced, supplied : tuple of str
        Kinds of what arises in the system and of what comes from outside.
    size : float
        Large changes of the entropy, that of all unknowns together; 0 where there is none.
    temperature : float
        At which it is at the start, in the mean of those that have any.
    """

    produced: tuple[str, ...] = ()
    supplied: tuple[str, ...] = ()
    size: float = 0.0
    temperature: float = 0.0

    @classmethod
    def of(cls, model: Model, scale: Array) -> EntropyColumns:
        """Those of a model, given large changes (n,) of its unknowns."""
        produced, supplied = (
            tuple(sorted({a.kind for a in model.accounts if a.category == category}))
            for category in (PRODUCED, SUPPLIED)
        )
        having: dict[Any, None] = dict.fromkeys(
            f.component
            for f in model.fields
            if f.role is Role.CONTENT and model.entropies.touches(np.asarray(f.unknowns))
        )
        mean = float(np.mean([c.start_temperatures.mean() for c in having])) if having else 0.0
        return cls(produced, supplied, model.entropies.of(scale), mean)

    def __bool__(self) -> bool:
        return self.size > 0

    @property
    def sums(self) -> list[str]:
        """Columns that add up over the steps."""
        return [
            *(f"entropy_produced_{k}" for k in self.produced),
            *(f"entropy_supplied_{k}" for k in self.supplied),
        ]

    @property
    def names(self) -> list[str]:
        """All of them: the entropy, those sums, its change beside them, and what was lost within the step."""
        return ["entropy", *self.sums, "entropy_imbalance", "defect_entropy"] if self else []


class EntropyBooks:
    """Turns the core's sums of each step into these columns.

    Attributes
    ----------
    done : array
        What was produced and supplied so far, by the columns' sums.
    """

    def __init__(self, model: Model, scale: Array) -> None:
        self.columns, self._model = EntropyColumns.of(model, scale), model
        names = {PRODUCED: "entropy_produced_", SUPPLIED: "entropy_supplied_"}
        self._where = np.zeros((len(self.columns.sums), len(model.accounts)))
        for k, a in enumerate(model.accounts):
            if a.category in names:
                self._where[self.columns.sums.index(names[a.category] + a.kind), k] = 1
        self._produces = np.array([a.category == PRODUCED for a in model.accounts], dtype=bool)
        self.done = np.zeros(len(self.columns.sums))

    def row(self, core: Any, ledger: Ledger) -> Array:
        """Values of the columns after a step, or at the start of a run, where the ledger has no rows."""
        if not self.columns:
            return np.zeros(0)
        entropy = self._model.entropies.of(core.x)
        self.done = self.done + self._where @ core.entropy
        change = entropy - ledger.first("entropy") if ledger.span.size else 0.0
        lost = np.maximum(-core.entropy[self._produces], 0.0).sum()
        return np.array([entropy, *self.done, change - self.done.sum(), lost])
