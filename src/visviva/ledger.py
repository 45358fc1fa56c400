"""The ledger: where energy and momentum are, what work was done, and how well the balance closes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOMENTA = ("momentum_x", "momentum_y", "momentum_z", "angular_x", "angular_y", "angular_z")


@dataclass
class Ledger:
    """Rows of books, one per accepted step, the first one the initial state.

    Attributes
    ----------
    names : list of str
        Columns: time, kinetic, potentials by kind, total, works by kind (summed over time), imbalance of the
        balance ``total - total_0 - works``, momenta, constraint defects of position and velocity.
    """

    potentials: list[str]
    works: list[str]
    rows: list[Array] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        works = [f"work_{k}" for k in self.works]
        potentials = [f"potential_{k}" for k in self.potentials]
        defects = ["defect_position", "defect_velocity"]
        return ["time", "kinetic", *potentials, "total", *works, "imbalance", *MOMENTA, *defects]

    @property
    def table(self) -> Array:
        """All rows (n, columns)."""
        return np.array(self.rows)

    def __getitem__(self, name: str) -> Array:
        return self.table[:, self.names.index(name)]

    @property
    def energy_scale(self) -> float:
        """What energy errors are relative to: the largest of kinetic energy, swing of potentials, work."""
        t = self.table
        swings = [np.ptp(self[f"potential_{k}"]) for k in self.potentials]
        works = [np.abs(self[f"work_{k}"]).max() for k in self.works]
        return float(max([t[:, 1].max(), *swings, *works, np.finfo(float).tiny]))

    def momentum_scale(self, kind: str) -> float:
        """Largest momentum ('momentum' or 'angular') of the run."""
        parts = np.array([self[f"{kind}_{c}"] for c in "xyz"])
        return float(max(np.abs(parts).max(), np.finfo(float).tiny))

    def imbalance(self) -> float:
        """Largest closing error of the energy balance relative to the energy scale."""
        return float(np.abs(self["imbalance"]).max() / self.energy_scale)

    def drift(self, name: str) -> float:
        """Largest change of a momentum column relative to the momentum scale."""
        column = self[name]
        return float(np.abs(column - column[0]).max() / self.momentum_scale(name.split("_")[0]))


class Bookkeeper:
    """Turns the core's sums of each step into rows of a ledger.

    Attributes
    ----------
    ledger : Ledger
    done : array
        Work done so far by kind.
    total0 : float or None
        Energy of the initial state, None before its row is booked.
    """

    def __init__(self, accounts: list[Any]) -> None:
        def kinds(*categories: str) -> list[str]:
            return sorted({a.kind for a in accounts if a.category in categories})

        self.ledger = Ledger(kinds("potential"), kinds("work", "dissipation"))
        ledger, n = self.ledger, len(accounts)
        self._kinetic = np.array([a.category == "kinetic" for a in accounts], dtype=float)
        self._potential = np.zeros((len(ledger.potentials), n))
        self._work = np.zeros((len(ledger.works), n))
        for k, a in enumerate(accounts):
            if a.category == "potential":
                self._potential[ledger.potentials.index(a.kind), k] = 1
            if a.category in ("work", "dissipation"):
                self._work[ledger.works.index(a.kind), k] = 1
        self.done = np.zeros(len(ledger.works))
        self.total0: float | None = None

    def book(self, time: float, core: Any) -> Array:
        """Add the row of the step that the core has just accepted (or of the initial state)."""
        energy = core.energy
        kinetic = self._kinetic @ energy
        potential = self._potential @ energy
        total = kinetic + potential.sum()
        self.done = self.done + self._work @ core.work
        if self.total0 is None:
            self.total0 = total
        momentum = core.momentum.reshape(-1, 6).sum(axis=0)
        defect = core.defect.reshape(-1, 2).max(axis=0)
        imbalance = total - self.total0 - self.done.sum()
        row = np.concatenate([[time, kinetic], potential, [total], self.done, [imbalance], momentum, defect])
        self.ledger.rows.append(row)
        return row
