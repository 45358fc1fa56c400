"""What sums of work over load steps miss: trapezoids of forces that bend along the way, as their energies tell."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NO_VALUE, VisvivaError
from visviva.model.field import Role
from visviva.results.outside import hanging_together, untold
from visviva.results.spread import BROUGHT, Spread
from visviva.scheme.schemes import load_step
from visviva.system.memory import undisturbed
from visviva.user.servo import Servo

if TYPE_CHECKING:
    from visviva.model.model import Account
    from visviva.system.system import System

Array = NDArray[np.float64]

NEAR, NEARER = 2.0**-13, 2.0**-20
"""Parts of a load step over which differences of energies are taken for forces, and those of energies of contact, which
may rise in the last moment."""
CLOSE = 0.01
"""Part of what was missed by which that may be off: differences tell it to a thousandth."""
PART = 0.5
"""The same of what steps dissipated more, or less, than the last."""
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
    booked. Contents, heat among them, come and go in a load step that takes no time, unbooked: works on what has them
    may go with them, and all else is judged for itself as well. Of flows powers are in balance, and no energies, and
    multipliers of servos do not act on what these follow: they are left out, with all that they hang together with.

    Attributes
    ----------
    shares : list of Share
        What is judged: all but what is left out, and that without contents and what hangs together with them.
    brought : Spread
        What was done to what has contents and to what hangs together with that.
    apart : list of str
        Why energies of contents and flows, if there are any, are not in balance.
    serves : bool
        Whether servos are left out.
    """

    def __init__(self, system: System) -> None:
        model = system.model
        contents, flows = (
            [f.component for f in model.fields if f.role is role] for role in (Role.CONTENT, Role.VELOCITY)
        )
        servos = [c for c in system.components if isinstance(c, Servo)]
        self.apart = [why for some, why in ((contents, FILLED), (flows, FLOWS)) if some]
        self.serves = bool(servos)
        out = hanging_together(model, [*flows, *servos])
        judged, filled = set(range(len(model.components))) - out, hanging_together(model, contents)
        self.brought = Spread(model, filled - out, ())
        holds = [np.full(f.size, f.role in HOLDING) for f in model.fields]
        self._holds = np.concatenate([np.zeros(0, dtype=bool), *holds])
        owners = np.repeat([model.index(f.component) for f in model.fields], [f.size for f in model.fields])
        leads = np.repeat([f.role in LED for f in model.fields], [f.size for f in model.fields]).astype(bool)
        self._moves = leads & np.isin(owners, list(judged))
        loose = bool(untold(model).intersection(a.component for a in model.accounts))
        parts = [judged] + [judged - filled] * bool(contents and not loose)
        self.shares = [
            Share(
                model.accounts, part, set(map(model.index, contents)), leads & np.isin(owners, list(part)),
                owners[self._holds],
            )
            for part in parts
        ]  # fmt: skip
        sharp = np.array([a.kind == "contact" for a in model.accounts] + [False] * int(self._holds.sum()))
        self._steps = [(NEAR, ~sharp)] + [(NEARER, sharp)] * bool(sharp.any())
        self.system = system
        self._start: tuple[float, Array] | None = None
        if out and loose:  # works on what is left out may be among the others
            self.shares[0].span[:] = np.nan

    @property
    def span(self) -> Array:
        """Sums of the shares, by which a run goes on."""
        return np.array([share.span for share in self.shares])

    @property
    def most(self) -> float:
        """The most that the rule may have missed."""
        return float(self.shares[0].span[MOST])

    @property
    def lacking(self) -> float:
        """The most that the balance lacked beside all that it may."""
        return float(np.max(self.span[:, LACKING]))

    def resume(self, span: Array | None) -> None:
        """Go on at the present state with the sums of a run that was saved, if it had them."""
        known = span is not None and np.shape(span) == self.span.shape
        for k, share in enumerate(self.shares):
            share.span = np.array(span[k]) if span is not None and known else np.full(len(share.span), np.nan)
        self._start = self.system.time, self.system.x.copy()

    def add(self) -> None:
        """Take in the initial state, or the step that led to the present one."""
        core = self.system.core
        self.brought.add(core)
        now = self.system.time, self.system.x.copy()
        missed = None if self._start is None else self._of_step(*self._start, *now)
        for share, excused in zip(self.shares, (self.brought.done, 0.0), strict=False):
            share.add(core, missed, excused)
        self._start = now

    def _of_step(self, time0: float, x0: Array, time1: float, x1: Array) -> Array:
        """What the rule misses in the step to the present state, by accounts and what holds."""
        system = self.system
        n = len(system.model.accounts)
        if not self._moves.any():
            return np.zeros(n + int(self._holds.sum()))
        way = x1 - x0
        way[~self._moves] = 0.0
        try:
            with undisturbed(system):
                there, here = self._energies(time0, x0), self._energies(time1, x1)
                missed = here - there
                for near, of in self._steps:
                    after = self._energies(time0, x0 + near * way)
                    before = self._energies(time1, x1 - near * way)
                    missed[of] -= (0.5 / near * (after - there + here - before))[of]
                if system.model.driving.drives:
                    missed[n:] += self._drives(time0, x0, time1, x1)
                return missed
        except (VisvivaError, *NO_VALUE):  # functions of the user may fail where nothing was computed yet
            return np.full(n + int(self._holds.sum()), np.nan)

    def _energies(self, time: float, x: Array) -> Array:
        """Energies of a state by account, and multipliers times violations."""
        core, step = self.system.core, load_step(time, 0.0)
        np.subtract(x, core.x, out=core.dx)
        energies = core.trial_energies(step, self.system.signals(step))
        return np.append(energies, x[self._holds] * self._violations(time, x))

    def _drives(self, time0: float, x0: Array, time1: float, x1: Array) -> Array:
        """Half of what multipliers give that drive: violations at each end by what moves until the other end."""
        there, here = x0[self._holds], x1[self._holds]
        return np.asarray(0.5 * (there * self._violations(time0, x1) - here * self._violations(time1, x0)))

    def _violations(self, time: float, x: Array) -> Array:
        """Of the equations of what holds."""
        if not self._holds.any():
            return np.zeros(0)
        self.system.core.dx[:] = x - self.system.core.x
        residual = self.system.residual(load_step(time, 0.0))
        return np.asarray(residual[self._holds])


MISSED, MOST, LOSING, WAVERED, LOST, BALANCE, LACKING = range(7)
"""Sums of a share: see `Share`."""


class Share:
    """Components whose energies are in balance for themselves.

    What materials that remember dissipate in a step is a sum of its own, which misses what the loss wavers by from step
    to step. Their energies relax along the way, too: what trapezoids miss of them is known in size alone.

    Parameters
    ----------
    accounts : list of Account
    own, filled : set of int
        The components, and those with contents, whose potentials do not count.
    moves : bool array (n,)
        Unknowns of theirs that move.
    holders : int array (m,)
        Whose the unknowns are that hold.

    Attributes
    ----------
    span : array (7,)
        Sum of what was missed, the same of absolute values, and of those of what loses, how much the losses of steps
        wavered, the loss of the last step, what is to be stored, and the most that the balance lacked beside all that.
        Not a number where it is not known.
    """

    def __init__(
        self,
        accounts: Sequence[Account],
        own: set[int],
        filled: set[int],
        moves: NDArray[np.bool_],
        holders: Array,
    ) -> None:
        def of(categories: Collection[str], those: set[int]) -> list[int]:
            return [k for k, a in enumerate(accounts) if a.category in categories and a.component in those]

        self._moves, potentials = moves, of(("potential",), own - filled)
        self._stored, self._done = of(("kinetic",), own) + potentials, of(BROUGHT, own)
        self._lossy = [k for k in of(("dissipation",), own) if accounts[k].kind != "contact"]
        self._loses = of(("potential",), {accounts[k].component for k in self._lossy} - filled)
        held = len(accounts) + np.flatnonzero(np.isin(holders, list(own)))
        self._missing = np.array([*potentials, *held], dtype=int)
        self.span = np.zeros(7)

    def add(self, core: Any, missed: Array | None, excused: float) -> None:
        """Take in what was missed in a step, or the initial state, where nothing was."""
        self.span[BALANCE] += core.work[self._done].sum() + core.release[self._moves].sum()
        stored = float(core.energy[self._stored].sum())
        if missed is None:
            self.span[BALANCE] += stored
            return
        lost, of_step = core.work[self._lossy].sum(), missed[self._missing].sum()
        self.span[:LOST] += of_step, abs(of_step), abs(missed[self._loses].sum()), abs(lost - self.span[LOST])
        self.span[LOST] = lost
        off = CLOSE * self.span[MOST] + self.span[LOSING] + PART * self.span[WAVERED]
        lacks = stored - self.span[BALANCE]
        lacking = np.minimum(abs(lacks), abs(lacks - self.span[MISSED])) - off - excused
        self.span[LACKING] = np.maximum(self.span[LACKING], lacking)
