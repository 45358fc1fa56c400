"""The equations of motion of an instant: inputs of servos push along their actuators, not along their outputs.

Whatever moves masses goes by these, forces as well as impulses. The least change of a state, as of one that does not
fit its constraints, goes by those of `Instant`.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.system.instant import COMPLIANCE, Instant
from visviva.system.memory import undisturbed
from visviva.system.scaling import equilibration

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]

RANK = 1e-10
"""Relative size of singular values that count as zero."""
UNBALANCED = 1e-6
"""Part of forces on masses that nothing balances, beyond which the equations leave something open."""
UNDETERMINED = 1e-6
"""Part of the largest multiplier from where on it is taken for open: only the compliance of constraints bounds it."""
WEAK = 30.0
"""Change of rates by impulses of inputs, as a multiple of the least that changes outputs alike, beyond which rates are
not projected so: they would answer to errors of a step by as much more."""
OPEN = 1e6
"""The same from where on inputs do not accelerate their outputs at all."""


class Actuated(Instant):
    """``M a + C mu = f``, ``G a = g`` with the gradients `C` (n, m) of actuators among those of constraints.

    Inputs that do not accelerate the outputs (index five) are left open by them: then the least serve.
    """

    is_open = False
    left: NDArray[np.int32] = np.zeros(0, dtype=np.int32)
    """Unknowns of the parts that `keep_reached` has left out."""

    def _columns_in(self, A: sp.csr_array) -> sp.csc_array:
        if not self.system.model.driving.has_servo:
            return super()._columns_in(A)
        columns: sp.csc_array = A[:, self._m][self._q].tocsc()
        return columns

    def _sizes(self, K: sp.csr_array) -> sp.csr_array:
        sizes = abs(K)
        return sizes.maximum(sizes.T) if self.system.model.driving.has_servo else super()._sizes(K)

    def factor(self, compliance: float = COMPLIANCE) -> None:
        super().factor(compliance)
        self.is_open = self.system.model.driving.has_servo and self._leaves_open()

    def _pushes(self) -> Array:
        """Some forces (n,) on all masses."""
        n = len(self.coordinates)
        pushes: Array = self.metric @ (self._s[:n] * np.random.default_rng(0).standard_normal(n))
        return pushes

    def _leaves_open(self) -> bool:
        """Whether there are forces of masses that no accelerations and multipliers balance."""
        n, f = len(self.coordinates), self._pushes()
        a, mu = super().solve(f, np.zeros(len(self.multipliers)))
        rest = np.concatenate([f - self.metric @ a - self.columns @ mu, self.G @ a])
        largest = float(np.abs(self._s[:n] * f).max(initial=0.0))
        return bool(np.abs(self._s * rest).max(initial=0.0) > UNBALANCED * largest)

    def open_multipliers(self) -> NDArray[np.bool_]:
        """Which multipliers (m,) the factored equations leave open: without its compliance they would be infinite."""
        n, m = len(self.coordinates), len(self.multipliers)
        answers = np.abs(self.soft(self._pushes(), np.zeros(m)) / self._s)[n:]
        return np.asarray(self.is_open & (answers > UNDETERMINED * answers.max(initial=0.0)))

    def keep_reached(self, most: float = WEAK) -> None:
        """Factor the equations without constraints of parts in which inputs hardly accelerate their outputs."""
        self.factor()
        inputs = np.isin(self.multipliers, [u for u, _ in self.system.model.driving.inputs])
        if not inputs.any():
            return
        n, part, least = len(self.coordinates), self.parts(), self._least()
        own = {p: np.flatnonzero(inputs & (part[n:] == p)) for p in np.unique(part[n:][inputs])}
        weak = [p for p, rows in own.items() if self._detour(least, rows) > most]
        if weak:
            self.left = np.concatenate([self.coordinates, self.multipliers])[np.isin(part, weak)]
            self.keep(~np.isin(part[n:], weak))
            self.factor()

    def _least(self) -> Instant:
        """The least changes of rates, by the scales of unknowns."""
        import scipy.sparse as sp

        least = copy(self)
        least.columns, least.metric = self.G.T.tocsc(), sp.diags_array(1 / self.scale**2).tocsr()
        Instant.factor(least)
        return least

    def _detour(self, least: Instant, rows: NDArray[np.int64]) -> float:
        """Change of rates by inputs as a multiple of the least, for those rates of their outputs for which it is most.

        It has no unit, nor do those of outputs and actuators matter.
        """
        rates, still = np.zeros((len(self.multipliers), len(rows))), np.zeros(len(self.coordinates))
        rates[rows, np.arange(len(rows))] = 1.0
        own, other = (
            np.column_stack([at.soft(still, g)[: len(still)] / self.scale for g in rates.T])
            for at in (self, least)
        )
        size = np.linalg.norm(other, axis=0)
        return float(np.linalg.norm(own / size @ np.linalg.pinv(np.linalg.qr(other / size)[1]), 2))

    def parts(self) -> NDArray[np.int32]:
        """Numbers (n + m,) of the parts that hang together, by masses, constraints or actuators."""
        import scipy.sparse as sp
        from scipy.sparse.csgraph import connected_components

        coupled = sp.block_array([[self.M, self.columns], [self.G, None]], format="csr")
        part: NDArray[np.int32] = connected_components(abs(coupled), directed=False)[1]
        return part

    def solve(self, f: Array, g: Array) -> tuple[Array, Array]:
        return self.least(f, g) if self.is_open else super().solve(f, g)

    def solve_consistent(self, f: Array, g: Array) -> tuple[Array, Array]:
        return self.least(f, g) if self.is_open else super().solve_consistent(f, g)

    def least(self, f: Array, g: Array) -> tuple[Array, Array]:
        """Smallest accelerations and multipliers that fit, both scaled; exact for a start from rest."""
        import scipy.sparse as sp

        K = sp.block_array([[self.M, self.columns], [self.G, None]], format="csr")
        unit = np.concatenate([self.scale, np.zeros(len(self.multipliers))])
        scale = equilibration(sp.csr_array(abs(K) + abs(K.T)), unit)
        scaled = scale[:, None] * K.toarray() * scale
        z = scale * np.linalg.lstsq(scaled, scale * np.concatenate([f, g]), rcond=RANK)[0]
        return z[: len(f)], z[len(f) :]


def open_parts(system: System) -> NDArray[np.int32]:
    """Unknowns of the parts in which inputs of servos do not accelerate their outputs now."""
    at = Actuated(system)
    at.keep_reached(OPEN)
    return at.left


def leaves_rates(system: System) -> bool:
    """Whether some inputs of servos hardly accelerate their outputs now, so that rates are not projected there."""
    with undisturbed(system):
        at, reached = Actuated(system), Actuated(system)
        reached.keep_reached()
    return len(reached.multipliers) < len(at.multipliers)
