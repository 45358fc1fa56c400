"""Balances of energy of what hangs together, each for itself: what is done to others excuses no gain there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component
from visviva.model.entropies import PRODUCED
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.results.outside import groups, untold
from visviva.results.rates_missed import RatesMissed
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


@dataclass(frozen=True)
class Balance:
    """What happened to the energy of a group.

    Attributes
    ----------
    members : list of Component
    gained, lost : float
        The most that there was more, and less, than was there at the start and brought since.
    worked : float
        How far works and losses swung.
    size : float
        Of its energies of motion and strain.
    in_all : float
        Of all energies and all that was brought.
    contents : float
        What sums over steps may miss of heat and matter.
    """

    members: list[Any]
    gained: float
    lost: float
    worked: float
    size: float
    in_all: float
    contents: float


class Groups:
    """What components gain and lose beside what is brought to them, by those that hang together.

    Left out are those that do not book all; and all, where something that acts does not tell on whom, or where all
    hangs together and nothing has contents, which is judged as a whole.

    Parameters
    ----------
    model : Model
    lacking : iterable of Component
        Those that do not book all.

    Attributes
    ----------
    span : array (6, n)
        What each group stored at the start, the least and the greatest that it gained so far, the largest sum of its
        energies without their signs, the same of those of motion and strain alone, and the heat that entropy which
        arose stands for at the temperatures of the start; empty where that is not known.
    brought : Spread
        What was done to them.
    missed : RatesMissed
        What rates miss of their contents.
    """

    def __init__(self, model: Model, lacking: Iterable[Component] = ()) -> None:
        self._model, self._of = model, groups(model)
        accounts, components = model.accounts, model.components
        owners = np.array([a.component for a in accounts], dtype=int)
        contents = {model.index(f.component) for f in model.fields if f.role is Role.CONTENT}
        entropic = temperatures(model, np.arange(len(components))) > 0
        warm = {k for k in contents if components[k].carries_heat or entropic[k]}
        of = self._of[owners]
        apart = (len(set(of)) > 1 or bool(contents)) and not untold(model).intersection(owners)
        judged = apart & ~np.isin(of, [self._of[model.index(c)] for c in lacking])
        kinds = np.array([a.category for a in accounts], dtype=object)
        self._stored = np.flatnonzero(judged & np.isin(kinds, ("kinetic", "potential")))
        self.brought = Spread(model, set(owners[judged & np.isin(kinds, BROUGHT)]), ())
        self._done = self.brought.accounts
        self._storing, self._doing = of[self._stored], of[self._done]
        self._moves = (kinds[self._stored] == "kinetic") | ~np.isin(owners[self._stored], list(warm))
        self._works = kinds[self._done] != "heat"
        self._mixes = np.isin(owners[self._done], list(contents - warm))
        self._produced = np.flatnonzero(judged & (kinds == PRODUCED))
        self._producing = of[self._produced]
        self._kelvin = temperatures(model, self._of)
        self.missed = RatesMissed(model, self._of)
        self.span = np.empty((6, 0))

    def add(self, time: float, core: Any) -> None:
        """Take in the core's sums of a step, or of the initial state."""
        if not len(self._stored):
            return
        begins = not self.span.size
        self.brought.add(core)
        self.missed.add(time, core)
        energies = core.energy[self._stored]
        sizes = np.abs(energies)
        stored, size, moving = (
            self._by_group(self._storing, some) for some in (energies, sizes, sizes * self._moves)
        )
        arose = self._kelvin * self._by_group(self._producing, core.entropy[self._produced])
        start, least, greatest, most, most_moving, inside = (
            (stored, np.inf, -np.inf, 0.0, 0.0, 0.0 * arose) if begins else self.span
        )
        gained = stored - start - self._by_group(self._doing, self.brought.span[0])
        self.span = np.array(
            [
                start,
                np.minimum(gained, least),
                np.maximum(gained, greatest),
                np.maximum(size, most),
                np.maximum(moving, most_moving),
                inside + (0.0 if begins else arose),
            ]
        )

    def memory(self) -> dict[str, Array]:
        """All sums, to go on with."""
        return {
            "groups": self.span,
            "groups_brought": self.brought.span,
            "groups_missed": self.missed.span,
            "groups_last": self.missed.last,
        }

    def resume(self, saved: Mapping[str, Array]) -> None:
        """Go on with the sums of a run that was saved, if it had them."""
        fresh = self.memory()
        if fresh.keys() <= saved.keys() and np.shape(saved["groups"]) in ((6, 0), (6, len(self._of))):
            self.span, self.brought.span, self.missed.span, self.missed.last = (
                np.array(saved[name]) for name in fresh
            )
        else:
            self.span = np.full((6, len(self._of)), np.nan)

    def balances(self) -> Iterator[Balance]:
        """Of each group what happened to its energy."""
        if not self.span.size:
            return
        swings = self.brought.swings
        done, worked, mixed = (
            self._by_group(self._doing, swings * some) for some in (1.0, self._works, self._mixes)
        )
        missed = self.missed.most
        for k in np.unique(self._storing):
            members = [c for c, group in zip(self._model.components, self._of, strict=True) if group == k]
            _, least, greatest, size, moving, inside = self.span[:, k]
            contents = mixed[k] + missed[k] + SUMMED * inside
            yield Balance(
                members,
                float(greatest),
                -float(least),
                float(worked[k]),
                float(moving),
                float(size + done[k] + inside),
                float(contents),
            )

    def _by_group(self, of: NDArray[np.int64], values: Array) -> Array:
        """Sums over the accounts of each."""
        return np.asarray(np.bincount(of, values, len(self._of)), dtype=float)


def temperatures(model: Model, of: NDArray[np.int64]) -> Array:
    """Means of each group (n,) at the start, of what balances entropy; 0 where nothing does."""
    having: dict[Any, None] = dict.fromkeys(
        f.component
        for f in model.fields
        if f.role is Role.CONTENT and model.entropies.touches(np.asarray(f.unknowns))
    )
    found, count = np.zeros(len(of)), np.zeros(len(of))
    for c in having:
        k = of[model.index(c)]
        found[k] += c.start_temperatures.mean()
        count[k] += 1
    return np.asarray(found / np.maximum(count, 1))


def alone(ledger: Ledger, scheme: Scheme) -> Iterator[str]:
    """What gained energy though nothing was done to it that brings that about, whatever was done elsewhere.

    By schemes that do not dissipate none is lost, either; those that do, in second order, give some of it back.
    """
    groups, all_of_it = ledger.sizes.groups, ledger.energy_scale
    for b in [] if groups is None else groups.balances():
        either, own = max(b.gained, b.lost), b.size + b.worked + b.contents
        if scheme.conserves_energy:
            astray, may = either, LOOSE * b.in_all
            meant, cure = (
                "conserve energy, and it did not balance",
                "or its stress is no discrete gradient of its energy",
            )
        elif not scheme.dissipates:
            astray, may = either, SWAYING * own + b.contents
            meant, cure = "keep energies nearly, and they went far astray", "or take shorter steps"
        else:
            sways = SWAYING * b.size if scheme.order > 1 else 0.0
            may = max(SUMMED * b.worked, OVERSHOOT * b.lost, sways) + b.contents + CONSERVED * b.in_all
            astray = b.gained
            meant, cure = "dissipate energy, and there was more than before", "or take shorter steps"
        may += ROUNDING * all_of_it
        if astray > may:
            named = ", ".join(c.label for c in b.members[:NAMED]) + (
                ", ..." if len(b.members) > NAMED else ""
            )
            yield (
                f"WRONG, as this scheme is to {meant}, by {astray / all_of_it:.1e}, of what hangs together with "
                f"nothing else ({named}): the work of some force is not booked, {cure}"
            )
