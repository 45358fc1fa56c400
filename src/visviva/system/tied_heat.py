"""Temperatures that are tied but jump at the start: heat passes across the tie at once, before the first step.

Whatever conducts, the flow into a jump of no width is infinite, so the temperatures there are the same after no time.
Steps that meet a jump make other things of it. Bonds between balances of entropy pass that, so that the jump evens out
as in an engine that works and ends too cold, and discrete gradients, that ask for one temperature of the step, leave a
jump which turns over in every step.

It is a step of no length: contents c, heat or entropy, change by the heat q of the ties alone, at the temperatures of
the step, the secants of the energy, and behind it temperatures are the same ::

    M (c1 - c0) + F^T (R^T q / D) = 0,      R F T1 = 0

with the values F T at the nodes of the ties, the weights R of these, and D = F theta where entropy is balanced, else 1.
The sum of the energies stays as it is to rounding.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.base.world import announce
from visviva.model.field import Role
from visviva.scheme.schemes import BackwardEuler, EnergyMomentum
from visviva.system.instant import instant
from visviva.system.memory import undisturbed
from visviva.system.newton import StepFailure
from visviva.thermal.carrier import EntropySupply
from visviva.thermal.exchange import HeatBond

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.field import Field
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
HALVINGS = 6
"""Steps, each a quarter of the one before, that are tried for mean rates."""
State = tuple[Array, Array, Array]
"""Unknowns (n,) of the system in the step and behind it, and heat (m,) of the ties."""

SHORT = 1e-30
"""Length of the step, in those of the run: nothing else changes a content in it, by more than rounding."""
ROUNDING = 1e-13
"""Relative change that is none."""
FITS, TOLD = 1e-9, 1e-6
"""Jumps up to this part of the temperatures are none, and changes up to this part are not told."""
MOST, SHORTEST = 100, 1e-3
"""Newton's iterations, and the least part of one."""


@dataclass(frozen=True, eq=False)
class Bonds:
    """The ties of a system.

    Attributes
    ----------
    weights : sparse array (m, k)
        R, of what is tied at the nodes of the ties.
    balances, warmth : sparse arrays (k, n)
        F, of all unknowns: of the balances there, and of the temperatures.
    is_entropy : bool array (k,)
    fields : list of Field
        Of the bodies that are tied.
    held : int array
        Contents of temperatures that are held.
    """

    weights: sp.csr_array
    balances: sp.csr_array
    warmth: sp.csr_array
    is_entropy: NDArray[np.bool_]
    fields: list[Field]
    held: Ints

    @classmethod
    def of(cls, system: System) -> Bonds | None:
        """None where nothing is tied."""
        import scipy.sparse as sp

        terms = [term for term, _ in system.model.terms]
        places = [p for term in terms if isinstance(term, HeatBond) for p in term.places(len(system.x))]
        if not places:
            return None
        weights, balances, warmth, is_entropy = zip(*places, strict=True)
        B, F = (sp.vstack(of, format="csr") for of in (balances, warmth))
        own = np.unique(np.concatenate([B.indices, F.indices]))
        owners = {f.component for f in system.model.fields if np.isin(own, f.unknowns).any()}
        fields = [f for f in system.model.fields if f.component in owners]
        held = [term.unknowns[:, 0] for term in terms if isinstance(term, EntropySupply)]
        rows = _side_by_side(weights)
        each = np.repeat(is_entropy, [w.shape[1] for w in weights])
        return cls(rows, B, F, each, fields, np.concatenate([np.zeros(0, dtype=int), *held]))

    def jump(self, T: Array) -> Array:
        """Integrals (m,) of the jumps of temperatures among unknowns (n,)."""
        return np.asarray(self.weights @ (self.warmth @ T))

    def fit(self, T: Array) -> bool:
        """Whether temperatures among unknowns (n,) have no jump."""
        largest = float(np.abs(self.warmth @ T).max(initial=0.0))
        reach = abs(self.weights) @ np.ones(self.weights.shape[1])
        return bool(np.all(np.abs(self.jump(T)) <= FITS * largest * reach))


def _side_by_side(weights: tuple[sp.csr_array, ...]) -> sp.csr_array:
    """Both sides of each tie beside each other, ties in blocks."""
    import scipy.sparse as sp

    pairs = [sp.hstack(weights[i : i + 2]) for i in range(0, len(weights), 2)]
    return sp.csr_array(sp.block_diag(pairs, format="csr"))


def even_out(system: System) -> bool:
    """Let heat pass across ties until temperatures fit; whether any did. What moved stands in the report."""
    bonds = Bonds.of(system)
    if bonds is None or bonds.fit(system.x):
        return False
    start = system.x.copy()
    with undisturbed(system):
        found = Passing(system, bonds).solve()
    if found is None and not bonds.is_entropy.any():
        return False  # steps pass heat as it is
    if found is None:
        raise InputError(
            f"the temperatures of {_named(bonds)} differ where they are tied, and cannot be evened out before the "
            "first step: give temperatures at the start that differ less there, or the vv.HeatTie a conductance"
        )
    system.x[:] = found
    system.invalidate()
    told = []
    for f in bonds.fields:
        change = np.abs(found - start)[f.unknowns].max(initial=0.0)
        if f.name == "temperature" and change > TOLD * np.abs(start[f.unknowns]).max():
            told.append(f"{f.name} of {f.component.label} by {change:.3g}")
    if told:
        announce(f"initial temperatures evened out across ties: {'; '.join(told)}")
    if system.report is not None:
        system.report.moves.extend(told)
    return True


def begin_with_mean_rates(system: System, h: float) -> None:
    """Give contents that are tied, in the histories of a scheme, the mean rates of a first step by backward Euler.

    Those of the moment know nothing of what passes the tie; and of temperatures that were evened out, steep from node
    to node, they are so large that longer steps would make heat of them. Means over a step differ by its length.
    """
    bonds = Bonds.of(system)
    if bonds is None:
        return
    with undisturbed(system):
        rates = _mean_rates(system, h)
    if rates is None:
        return
    own = np.concatenate([f.unknowns for f in bonds.fields if f.role is Role.CONTENT])
    for history in (system.core.a, system.core.w):
        history[own] = rates[own]


def _mean_rates(system: System, h: float) -> Array | None:
    """Of all unknowns (n,) over a step, a shorter one where that fails; None if all do."""
    for k in range(HALVINGS):
        part = h * 0.25**k
        with suppress(StepFailure):
            system.attempt(BackwardEuler().step(system.time, part))
            return np.asarray(system.core.dx / part)
    return None


def _named(bonds: Bonds) -> str:
    return " and ".join(dict.fromkeys(f.component.label for f in bonds.fields))


class Passing:
    """Newton's method for the heat that passes, with contents, temperatures of the step and those behind it."""

    def __init__(self, system: System, bonds: Bonds) -> None:
        self.system, self.bonds, self.start = system, bonds, system.x.copy()
        self.step = EnergyMomentum().step(system.time, SHORT * (system.clock.step or 1.0))
        self.contents = np.setdiff1d(self._free(Role.CONTENT), bonds.held)
        self.temperatures = self._free(Role.TEMPERATURE)
        self.relaxing = np.concatenate([self.contents, self._free(Role.STATE)])
        self._rows = [np.searchsorted(system.free_unknowns, of) for of in (self.relaxing, self.temperatures)]
        self.sizes = np.maximum(system.scale, np.abs(system.x))
        self.sizes[self.sizes == 0] = 1.0

    def _free(self, role: Role) -> Ints:
        of = [f.unknowns for f in self.bonds.fields if f.role is role]
        return np.intersect1d(np.concatenate([[], *of]).astype(int), self.system.free_unknowns)

    def solve(self) -> Array | None:
        """Unknowns (n,) of the system behind it; None if they are not found.

        Steps are shortened until what is left, by the same tangent, shortens as well: tables of capacity have humps.
        """
        from scipy.sparse.linalg import splu

        at = self.start.copy(), self.start.copy(), np.zeros(self.bonds.weights.shape[0])
        r, K = self._equations(*at)
        for _ in range(MOST):
            try:
                by = splu(K).solve
            except RuntimeError:  # singular
                return None
            way, share = -by(r), 1.0
            while True:
                trial = self._moved(at, share * way)
                r, K = self._equations(*trial)
                left = self._size(by(r))
                if left <= (1 - share / 2) * self._size(way) or self._size(way) <= ROUNDING:
                    break
                share /= 2
                if share < SHORTEST:
                    return None
            at = trial
            if self._size(way) <= ROUNDING:
                return at[1]
        return None

    def _moved(self, at: State, change: Array) -> State:
        """The trial state after a change of all unknowns."""
        during, behind, heat = (part.copy() for part in at)
        n, k = len(self.relaxing), len(self.temperatures)
        content, inner, outer, more = np.split(change, np.cumsum([n, k, k]))
        during[self.relaxing] += content
        behind[self.relaxing] += content
        during[self.temperatures] += inner
        behind[self.temperatures] += outer
        return during, behind, heat + more

    def _size(self, change: Array) -> float:
        """Of a change of contents and temperatures, relative."""
        n, k = len(self.relaxing), len(self.temperatures)
        parts = np.abs(np.concatenate([change[: len(self.contents)], change[n : n + 2 * k]]))
        parts /= self.sizes[np.concatenate([self.contents, self.temperatures, self.temperatures])]
        return float(parts.max(initial=0.0)) if np.isfinite(parts).all() else np.inf

    def _equations(self, during: Array, behind: Array, heat: Array) -> tuple[Array, Any]:
        """Of contents, of temperatures of the step and behind it, of jumps; and their derivatives."""
        import scipy.sparse as sp

        bonds, (c, t), n = self.bonds, self._rows, len(self.contents)
        r, K = self._at(self.step, during)
        r1, K1 = self._at(instant(self.system.time, theta=1.0), behind)
        D = np.where(bonds.is_entropy, bonds.warmth @ during, 1.0)
        passing = bonds.weights.T @ heat
        B, F = bonds.balances[:, self.relaxing], bonds.warmth[:, self.temperatures]
        own = bonds.warmth[:, self.relaxing]  # heat whose unknowns are temperatures
        residual = [
            self.step.h * r[self.contents] + (B.T @ (passing / D))[:n],
            r1[self.relaxing[n:]],
            r[self.temperatures],
            r1[self.temperatures],
            bonds.jump(behind),
        ]
        by_warmth = -B.T @ sp.diags_array(np.where(bonds.is_entropy, passing / D**2, 0.0)) @ F
        by_heat = B.T @ sp.diags_array(1 / D) @ bonds.weights.T
        inner = sp.vstack([self.step.h * K[c[:n]][:, c], K1[c[n:]][:, c]])
        none = sp.csr_array((n, len(t)))
        outer = sp.vstack([none, K1[c[n:]][:, t]])
        matrix = [
            [inner, by_warmth, outer, by_heat],
            [K[t][:, c], K[t][:, t], None, None],
            [K1[t][:, c], None, K1[t][:, t], None],
            [bonds.weights @ own, None, bonds.weights @ F, None],
        ]
        return np.concatenate(residual), sp.block_array(matrix, format="csc")

    def _at(self, step: Any, x: Array) -> tuple[Array, Any]:
        """Residual (n,) and tangent over the free unknowns of a trial state."""
        self.system.core.dx[:] = x - self.start
        return self.system.tangent(step)
