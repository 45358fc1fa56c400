"""Entropy in the books: which unknowns are one, and which terms bring it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva import _core

Array = NDArray[np.float64]
Ints = NDArray[np.integer]

PRODUCED, SUPPLIED = "entropy produced", "entropy supplied"
"""Categories of accounts: what arises and is never lost, and what comes from outside or goes there."""

LIGHT = 0.1
"""Part of the size of a shape function up to which its integral is next to nothing."""


@dataclass(eq=False)
class Entropies:
    """Unknowns whose equations, added up, are the balance of entropy.

    Attributes
    ----------
    unknowns : list of int arrays
    weights : list of arrays
        The entropy is the sum of the unknowns times these.
    tested : list of int arrays
        Unknowns whose equations add up to its balance.
    light : list of bool arrays
        Of the unknowns, those whose weights are next to nothing of what their shape functions are in size.
    accounts : list of int
        Where what the unknowns of an entry store in a step is booked with what its terms let go; -1: nowhere.
    """

    unknowns: list[Ints] = field(default_factory=list)
    weights: list[Array] = field(default_factory=list)
    tested: list[Ints] = field(default_factory=list)
    light: list[NDArray[np.bool_]] = field(default_factory=list)
    accounts: list[int] = field(default_factory=list)

    def store(
        self,
        unknowns: Ints,
        weights: Array,
        tested: Ints,
        account: int = -1,
        terms: Sequence[_core.Term] = (),
        sizes: Array | None = None,
    ) -> None:
        """Note unknowns (n,) whose sum with weights (n,) is an entropy, and the equations that balance it.

        What `terms`, those of the body itself, give these beyond what is stored is booked on an account of entropy
        that is produced; without one the body produces none. The `sizes` (n,) are integrals of shape functions without
        their signs, where these are not those of the weights.
        """
        self.unknowns.append(unknowns)
        self.weights.append(weights)
        self.light.append(np.abs(weights) < LIGHT * (np.abs(weights) if sizes is None else sizes))
        self.tested.append(tested)
        self.accounts.append(account)
        for term in terms:
            term.entropy_account = account

    def touches(self, unknowns: Ints) -> bool:
        """Whether equations of some of these unknowns balance entropy."""
        return any(np.isin(unknowns, rows).any() for rows in self.tested)

    def __bool__(self) -> bool:
        return bool(self.unknowns)

    def of(self, x: Array) -> float:
        """All entropy at the unknowns `x` of the system."""
        return float(sum(w @ x[u] for u, w in zip(self.unknowns, self.weights, strict=True)))

    def hand_over(self, core: _core.System) -> None:
        """Let the core add up what terms bring."""
        if not self:
            return
        counts = [len(u) for u in self.unknowns]
        core.set_entropy(
            np.concatenate(self.tested).astype(np.int32),
            np.concatenate(self.unknowns).astype(np.int32),
            np.concatenate(self.weights).astype(float),
            np.repeat(self.accounts, counts).astype(np.int32),
            np.concatenate(self.light).astype(np.int32),
        )
