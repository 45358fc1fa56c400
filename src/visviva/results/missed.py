"""What sums of work over load steps miss: trapezoids of forces that bend along the way, as their energies tell."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.model.field import Role
from visviva.results.outside import hanging_together
from visviva.results.spread import BROUGHT, Spread
from visviva.scheme.schemes import load_step
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    from visviva.model.model import Account
    from visviva.system.system import System

Array = NDArray[np.float64]

NEAR, NEARER = 2.0**-13, 2.0**-20
"""Parts of a load step over which differences of energies are taken for forces, and those of energies of contact, which
may rise in the last moment."""
PART = 0.5
"""Part of what was missed, or dissipated, by which that may be off."""
FILLED = "heat that bodies give away in them is not booked, nor are other contents"
FLOWS = "of steady flows it is powers that balance"
"""What load steps, which take no time, leave open."""
LED = tuple(role for role in Role if role.has_least_energy)
"""What moves along the way."""
HOLDING = (Role.MULTIPLIER, Role.SOLID_PRESSURE)
"""What stands for forces that only hold: times what violates its equation it belongs to the energy of the others."""


class Missed:
    """What the trapezoidal rule misses of works along load steps, and what the balance of energy lacks beside that.

    Forces in equilibrium follow from energies E: along the straight way d of a load step these rise by ``E1 - E0``, of
    which the rule takes ``(E0' + E1') d / 2``, that of constraints included. The difference is of third order in d, is
    all that is let go in a jump to an equilibrium far away, and has nothing of forces without energy whose work is not
    booked. What materials that remember dissipate in a step is a sum of its own, of which half may be missed. Contents,
    heat among them, come and go in a load step that takes no time, unbooked: works on what has them may go with them.
    Of flows powers are in balance, and no energies: they are left out, with all that they hang together with.

    Attributes
    ----------
    span : array (5,)
        Sum of what was missed, the same of absolute values, what is stored with contents and flows at the start with
        what was done to flows so far, the most that the balance lacked beside all that, and what was dissipated. Not a
        number where it is not known.
    brought : Spread
        What was done to what has contents and to what hangs together with that.
    apart : list of str
        Why energies of contents and flows, if there are any, are not in balance.
    """

    def __init__(self, system: System) -> None:
        model = system.model
        contents, flows = (
            [f.component for f in model.fields if f.role is role] for role in (Role.CONTENT, Role.VELOCITY)
        )
        self.apart = [why for some, why in ((contents, FILLED), (flows, FLOWS)) if some]
        flowing = hanging_together(model, flows)
        self.brought = Spread(model, hanging_together(model, contents) - flowing, ())
        self._sort(model.accounts, flowing, set(map(model.index, contents)) - flowing)
        fields = [(f, model.index(f.component) in flowing) for f in model.fields]
        self._moves, self._released, self._holds = (
            np.concatenate([np.full(f.size, of is of_flow and f.role in roles) for f, of in fields])
            for of_flow, roles in ((False, LED), (True, LED), (False, HOLDING))
        )
        self.system, self.span = system, np.zeros(5)
        self._start: tuple[float, Array] | None = None

    def _sort(self, accounts: Sequence[Account], flowing: set[int], filled: set[int]) -> None:
        """Which accounts are those of contents and flows, given the components of these, and which of the others."""

        def of(categories: Collection[str], flows: bool = False, fills: bool = False) -> list[int]:
            return [
                k
                for k, a in enumerate(accounts)
                if a.category in categories
                and (a.component in flowing, a.component in filled) == (flows, fills)
            ]

        self._done = of(BROUGHT, flows=True)
        self._apart = of(("kinetic", "potential"), flows=True) + of(("potential",), fills=True)
        stored, sharp = of(("potential",)), {k for k, a in enumerate(accounts) if a.kind == "contact"}
        self._parts = [(NEAR, [*(k for k in stored if k not in sharp), -1])]  # -1: with what holds
        self._parts += [(NEARER, sorted(sharp.intersection(stored)))] * bool(sharp.intersection(stored))
        lossy = of(("dissipation",)) + of(("dissipation",), fills=True)
        self._lossy = [k for k in lossy if k not in sharp]

    @property
    def most(self) -> float:
        """The most that the rule may have missed."""
        return float(self.span[1])

    @property
    def lacking(self) -> float:
        """The most that the balance lacked beside all that it may."""
        return float(self.span[3])

    def resume(self, span: Array | None) -> None:
        """Go on at the present state with the sums of a run that was saved, if it had them."""
        self.span = np.full(5, np.nan) if span is None else np.array(span)
        self._start = self.system.time, self.system.x.copy()

    def add(self, imbalance: float) -> None:
        """Take in the initial state, or the step that led to the present one."""
        core = self.system.core
        self.brought.add(core)
        apart = float(core.energy[self._apart].sum())
        self.span[2] += core.work[self._done].sum() + core.release[self._released].sum()
        if self._start is None:
            self.span[2] += apart
        else:
            missed = self._of_step(*self._start)
            lost = core.work[self._lossy]
            self.span[:2] += missed, abs(missed)
            self.span[4] += abs(lost).sum()
            lacking = imbalance - (apart - self.span[2])
            lacking = min(abs(lacking), abs(lacking - self.span[0])) - PART * (self.most + self.span[4])
            self.span[3] = np.maximum(self.span[3], lacking - self.brought.done)
        self._start = self.system.time, self.system.x.copy()

    def _of_step(self, time0: float, x0: Array) -> float:
        """What the rule misses in the step to the present state."""
        system, time1, x1 = self.system, self.system.time, self.system.x.copy()
        if system.model.driving.has_servo:  # its multipliers do not act on what it follows
            return np.nan
        if not self._moves.any():
            return 0.0
        way, missed = np.where(self._moves, x1 - x0, 0.0), 0.0
        try:
            with undisturbed(system):
                there, here = self._energies(time0, x0), self._energies(time1, x1)
                for near, of in self._parts:
                    after = self._energies(time0, x0 + near * way)
                    before = self._energies(time1, x1 - near * way)
                    missed += (here - there - 0.5 / near * (after - there + here - before))[of].sum()
                return missed + (self._drives(time0, x0, time1, x1) if system.model.driving.drives else 0.0)
        except Exception:  # functions of the user may raise where nothing was computed yet
            return np.nan

    def _energies(self, time: float, x: Array) -> Array:
        """Energies of a state by account, and last multipliers times violations."""
        core, step = self.system.core, load_step(time, 0.0)
        core.dx[:] = x - core.x
        energies = core.trial_energies(step, self.system.signals(step))
        return np.append(energies, x[self._holds] @ self._violations(time, x))

    def _drives(self, time0: float, x0: Array, time1: float, x1: Array) -> float:
        """Half of what multipliers give that drive: violations at each end by what moves until the other end."""
        there, here = x0[self._holds], x1[self._holds]
        return 0.5 * float(there @ self._violations(time0, x1) - here @ self._violations(time1, x0))

    def _violations(self, time: float, x: Array) -> Array:
        """Of the equations of what holds."""
        if not self._holds.any():
            return np.zeros(0)
        self.system.core.dx[:] = x - self.system.core.x
        residual = self.system.residual(load_step(time, 0.0))
        return np.asarray(residual[self._holds])
