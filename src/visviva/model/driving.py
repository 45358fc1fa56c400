"""Functions of time as drivers: loads and constraints by signals, unknowns by prescribed motion."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import RunError
from visviva.base.timefunction import TimeFunction
from visviva.model.field import Prescription

Array = NDArray[np.float64]


@dataclass(eq=False)
class Driving:
    """Functions of time of a model.

    Attributes
    ----------
    signals : list of TimeFunction
        Those that elements refer to by number.
    owners : list of str
        Whose these are.
    rated : set of int
        Signals whose rates are needed.
    prescribed : list of Prescription
        Unknowns that move as functions of time.
    kinks : dict of float to set of int
        Times at which what is driven gets another rate at once, and the accounts that this concerns.
    given : set of float
        Times at which some function of time that a component was given has a kink, whatever it is for.
    drives : list of tuple of int
        Multipliers of driven constraints, and their accounts.
    inputs : list of tuple of int
        Inputs of servos, and their accounts.
    is_driven : bool
        Whether constraints are functions of time.
    """

    signals: list[TimeFunction] = field(default_factory=list)
    owners: list[str] = field(default_factory=list)
    rated: set[int] = field(default_factory=set)
    prescribed: list[Prescription] = field(default_factory=list)
    kinks: dict[float, set[int]] = field(default_factory=dict)
    given: set[float] = field(default_factory=set)
    drives: list[tuple[int, int]] = field(default_factory=list)
    inputs: list[tuple[int, int]] = field(default_factory=list)
    is_driven: bool = False

    @property
    def has_servo(self) -> bool:
        """Whether servo constraints are among them."""
        return bool(self.inputs)

    @property
    def working(self) -> list[tuple[int, int]]:
        """All multipliers that do work, and their accounts."""
        return self.drives + self.inputs

    def signal(self, owner: str, function: Any, has_rate: bool = False) -> int:
        """Number of a prescribed function of time, see `Model.signal`."""
        if function is None:
            return -1
        if has_rate:
            self.rated.add(len(self.signals))
        self.signals.append(TimeFunction(function))
        self.owners.append(owner)
        return len(self.signals) - 1

    def bend(self, times: Iterable[float], account: int) -> None:
        """Note at which times what is driven gets another rate at once, by the work of an account."""
        for t in times:
            self.kinks.setdefault(t, set()).add(account)

    def drive(self, multipliers: list[int], signals: list[int], account: int, servo: bool) -> None:
        """Note constraints that some of these signals (-1 for none) drive."""
        if servo:
            self.inputs += [(u, account) for u in multipliers]
        else:
            self.drives += [(u, account) for u, s in zip(multipliers, signals, strict=True) if s >= 0]
        self.is_driven |= servo or any(s >= 0 for s in signals)
        self.bend((t for s in signals if s >= 0 for t in self.signals[s].kinks), account)

    def values(self, step: Any, length: float) -> Array:
        """Of all signals at a step: rows (4, n) for t0, te, t1 and the rate at t1, by steps of some length."""
        rows = np.zeros((4, max(len(self.signals), 1)))
        for k, f in enumerate(self.signals):
            rows[:, k] = f(step.t0), f(step.te), f(step.t1), 0.0
            if k in self.rated:
                rows[3, k] = (f.rate_after if f.kinks and not step.has_length else f.rate)(step.t1, length)
        if self.signals and not np.all(np.isfinite(rows)):
            k = int(np.argmin(np.isfinite(rows).all(axis=0)))
            raise RunError(
                f"{self.owners[k]}: its function of time gave {rows[:, k].tolist()} near t = {step.t1:g}"
            )
        return rows

    def curvatures(self, time: float, length: float) -> Array:
        """Second derivatives of all signals, 0 where rates are not needed."""
        return np.array(
            [f.curvature(time, length) if k in self.rated else 0.0 for k, f in enumerate(self.signals)]
        )

    def bent(self, start: float, end: float) -> set[int]:
        """Accounts of what gets another rate at once after `start` and not after `end`."""
        return {account for t, accounts in self.kinks.items() if start < t <= end for account in accounts}

    def of_bent(self, start: float, end: float, of: Callable[[TimeFunction], float]) -> Array:
        """What `of` tells of signals with kinks from `start` to `end`; nothing of all others: they are smooth."""
        return np.array(
            [
                of(f) if k in self.rated and any(start < t <= end for t in f.kinks) else 0.0
                for k, f in enumerate(self.signals)
            ]
        )

    def all_kinks(self) -> list[float]:
        """Of all that depends on time, in order."""
        return sorted({t for f in self.signals for t in f.kinks} | set(self.kinks) | self.given)
