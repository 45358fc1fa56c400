"""The equations of motion of an instant: inputs of servos push along their actuators, not along their outputs.

Whatever moves masses goes by these, forces as well as impulses. The least change of a state, as of one that does not
fit its constraints, goes by those of `Instant`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.system.instant import COMPLIANCE, Instant
from visviva.system.scaling import equilibration

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]

RANK = 1e-10
"""Relative size of singular values that count as zero."""
UNBALANCED = 1e-6
"""Part of forces on masses that nothing balances, beyond which the equations leave something open."""


class Actuated(Instant):
    """``M a + C mu = f``, ``G a = g`` with the gradients `C` (n, m) of actuators among those of constraints.

    Inputs that do not accelerate the outputs (index five) are left open by them: then the least serve.
    """

    _is_open = False

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
        self._is_open = self.system.model.driving.has_servo and self._leaves_open()

    def _leaves_open(self) -> bool:
        """Whether there are forces of masses that no accelerations and multipliers balance."""
        n = len(self.coordinates)
        f = self.metric @ (self._s[:n] * np.random.default_rng(0).standard_normal(n))
        a, mu = super().solve(f, np.zeros(len(self.multipliers)))
        rest = np.concatenate([f - self.metric @ a - self.columns @ mu, self.G @ a])
        largest = float(np.abs(self._s[:n] * f).max(initial=0.0))
        return bool(np.abs(self._s * rest).max(initial=0.0) > UNBALANCED * largest)

    def solve(self, f: Array, g: Array) -> tuple[Array, Array]:
        return self.least(f, g) if self._is_open else super().solve(f, g)

    def solve_consistent(self, f: Array, g: Array) -> tuple[Array, Array]:
        return self.least(f, g) if self._is_open else super().solve_consistent(f, g)

    def dense(self) -> tuple[Array, Array]:
        """The matrix (n + m, n + m), scaled on both sides by the last array."""
        import scipy.sparse as sp

        K = sp.block_array([[self.M, self.columns], [self.G, None]], format="csr")
        unit = np.concatenate([self.scale, np.zeros(len(self.multipliers))])
        scale = equilibration(sp.csr_array(abs(K) + abs(K.T)), unit)
        return scale[:, None] * K.toarray() * scale, scale

    def least(self, f: Array, g: Array) -> tuple[Array, Array]:
        """Smallest accelerations and multipliers that fit, both scaled; exact for a start from rest."""
        K, scale = self.dense()
        z = scale * np.linalg.lstsq(K, scale * np.concatenate([f, g]), rcond=RANK)[0]
        return z[: len(f)], z[len(f) :]
