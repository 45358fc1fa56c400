"""Balances of energy of what hangs together, each for itself: what is done to others excuses no gain there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.results.outside import groups, untold
from visviva.results.spread import BROUGHT, Spread

if TYPE_CHECKING:
    from visviva.results.ledger import Ledger
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]

CONSERVED = 1e-9
"""Relative errors up to this are those of rounding and of Newton's method."""
LOOSE = 1e-6
"""Errors of schemes that conserve energy up to this may be those of loose tolerances, in many steps."""
SUMMED = 0.1
"""Part of all work done by which its sums over steps may miss it: more is not resolved by the steps."""
OVERSHOOT = 0.1
"""Part of the energy lost so far that schemes may give back which dissipate over many steps, but not in each."""
SWAYING = 0.1
"""Part of the energies by which a balance may sway with schemes that neither conserve nor damp, or that damp in second
order and give some of it back: more is astray."""
ROUNDING = 1e-12
"""Energies below this part of those in play are written as none."""
NAMED = 3
"""So many of what acts from outside are named."""


class Groups:
    """What components gain and lose beside what is brought to them, by those that hang together, if not all do.

    Left out are those with contents, of which energies turn into each other without an account of that, and those that
    do not book all; and all, where something that acts does not tell on whom.

    Parameters
    ----------
    model : Model
    lacking : iterable of Component
        Those that do not book all.

    Attributes
    ----------
    span : array (4, n)
        What each group stored at the start, the least and the greatest that it gained so far, and the largest sum of
        its energies without their signs; empty where that is not known.
    brought : Spread
        What was done to them.
    """

    def __init__(self, model: Model, lacking: Iterable[Component] = ()) -> None:
        self._model, self._of = model, groups(model)
        owners = np.array([a.component for a in model.accounts], dtype=int)
        contents = [f.component for f in model.fields if f.role is Role.CONTENT]
        out = [self._of[model.index(c)] for c in (*contents, *lacking)]
        of = self._of[owners]
        apart = len(set(of)) > 1 and not untold(model).intersection(owners)
        judged = apart & ~np.isin(of, out)
        stores = np.array([a.category in ("kinetic", "potential") for a in model.accounts], dtype=bool)
        does = np.array([a.category in BROUGHT for a in model.accounts], dtype=bool)
        self._stored, self._done = np.flatnonzero(judged & stores), np.flatnonzero(judged & does)
        self._storing, self._doing = of[self._stored], of[self._done]
        self.brought = Spread(model, set(owners[self._done]), ())
        self.span = np.empty((4, 0))

    def add(self, core: Any) -> None:
        """Take in the core's sums of a step, or of the initial state."""
        if not len(self._stored):
            return
        self.brought.add(core)
        energies = core.energy[self._stored]
        stored, size = (self._by_group(self._storing, some) for some in (energies, np.abs(energies)))
        start, least, greatest, sizes = self.span if self.span.size else (stored, np.inf, -np.inf, 0.0)
        gained = stored - start - self._by_group(self._doing, self.brought.span[0])
        self.span = np.array(
            [start, np.minimum(gained, least), np.maximum(gained, greatest), np.maximum(size, sizes)]
        )

    def resume(self, span: Array | None, brought: Array | None) -> None:
        """Go on with the sums of a run that was saved, if it had them."""
        known = span is not None and brought is not None and np.shape(span) in ((4, 0), (4, len(self._of)))
        self.span = np.array(span) if known else np.full((4, len(self._of)), np.nan)
        self.brought.span = np.array(brought) if known else self.brought.span

    def balances(self) -> Iterator[tuple[list[Any], float, float, float, float]]:
        """Of each group its components, the most that it gained and lost, how far what was brought to it swung, and the
        size of its energies.
        """
        if not self.span.size:
            return
        swings = self._by_group(self._doing, self.brought.swings)
        for k in np.unique(self._storing):
            members = [c for c, group in zip(self._model.components, self._of, strict=True) if group == k]
            _, least, greatest, size = self.span[:, k]
            yield members, float(greatest), -float(least), float(swings[k]), float(size)

    def _by_group(self, of: NDArray[np.int64], values: Array) -> Array:
        """Sums over the accounts of each."""
        return np.asarray(np.bincount(of, values, len(self._of)), dtype=float)


def alone(ledger: Ledger, scheme: Scheme) -> Iterator[str]:
    """What gained energy though nothing was done to it that brings that about, whatever was done elsewhere.

    By schemes that do not dissipate none is lost, either; those that do, in second order, give some of it back.
    """
    groups, all_of_it = ledger.sizes.groups, ledger.energy_scale
    for members, gained, lost, brought, size in [] if groups is None else groups.balances():
        either, own = max(gained, lost), size + brought
        if scheme.conserves_energy:
            astray, may = either, LOOSE * own
            meant, cure = (
                "conserve energy, and it did not balance",
                "or its stress is no discrete gradient of its energy",
            )
        elif not scheme.dissipates:
            astray, may = either, SWAYING * own
            meant, cure = "keep energies nearly, and they went far astray", "or take shorter steps"
        else:
            sways = SWAYING * size if scheme.order > 1 else 0.0
            astray, may = gained, max(SUMMED * brought, OVERSHOOT * lost, sways) + CONSERVED * own
            meant, cure = "dissipate energy, and there was more than before", "or take shorter steps"
        may += ROUNDING * all_of_it
        if astray > may:
            named = ", ".join(c.label for c in members[:NAMED]) + (", ..." if len(members) > NAMED else "")
            yield (
                f"WRONG, as this scheme is to {meant}, by {astray / all_of_it:.1e}, of what hangs together with "
                f"nothing else ({named}): the work of some force is not booked, {cure}"
            )
