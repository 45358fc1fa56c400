"""The ledger: where energy and momentum are, what work was done, and how well the balance closes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.base.html import sparkline, table
from visviva.model.field import Role
from visviva.output.labels import with_unit
from visviva.output.numbers_out import dataframe, write_table
from visviva.output.tables import Table
from visviva.results.entropy import EntropyBooks, EntropyColumns
from visviva.results.groups import Groups
from visviva.results.lags import Lag, lags_of
from visviva.results.missed import Missed
from visviva.results.spread import Spread, unbooked
from visviva.results.swings import Swings
from visviva.system.instant import Instant, instant
from visviva.system.memory import returning, undisturbed

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]

STILL = 1e-6
"""Part of its size below which the motion of a body counts as rest."""
QUIET = 1e-5
"""The same of energies that are sums over many points: a billionth of that is what rounding leaves in these."""

UNSEEN = 1e-10
"""Part of its size by which rounding may seem to move a body."""

FELT = 2e-7
"""Part of the impulse of forces inside that momenta are measured by: rounding of these is 1e-9 of it."""

RELEASE = "release"
"""Work in statics of what held a system that starts out of equilibrium: it lets go slowly in the first load step."""

MOMENTA = ("momentum_x", "momentum_y", "momentum_z", "angular_x", "angular_y", "angular_z")


@dataclass(frozen=True)
class Sizes:
    """Sizes that errors of a system are measured by.

    Attributes
    ----------
    mass, length : float
        Of the whole system: what momenta and rates are compared with.
    pull : float
        Work of the forces at the start if everything moved along by its own size.
    power : float
        Their power on what flows if it did so with the speed that is large in it.
    inner : tuple of str
        Kinds of potentials of components that move, of which forces come.
    spread, unbooked : Spread
        What components with contents, and those with `Unbooked` changes, stored and lost so far; nothing in a ledger
        that was read.
    missed : Missed, optional
        What sums over load steps missed so far.
    groups : Groups, optional
        What does not hang together gained, of runs in time.
    lags : tuple of Lag
        What fluid within rigid bodies lacks of their motion, of each.
    """

    mass: float = 0.0
    length: float = 1.0
    pull: float = 0.0
    power: float = 0.0
    inner: tuple[str, ...] = ()
    spread: Spread = field(default_factory=Spread.empty)
    unbooked: Spread = field(default_factory=Spread.empty)
    missed: Missed | None = None
    groups: Groups | None = None
    lags: tuple[Lag, ...] = ()


@dataclass(repr=False)
class Ledger:
    """Rows of books, one per accepted step, the first one the initial state.

    Attributes
    ----------
    names : list of str
        Columns: time, kinetic, potentials by kind, total, works and heats by kind (summed over time), imbalance of the
        balance ``total - total_0 - works - heats``, momenta, constraint defects of position and velocity (the largest
        violations relative to the constraints' gradients times the sizes of the unknowns, so that lengths,
        their squares and products of directors compare; that of rates is per unit of time). Where components announce
        entropy, it, what was produced and supplied of it by kind (summed over time), the imbalance of that balance,
        and how much of it was lost within the step.
    heats : list of str
        Kinds of heat that comes from outside.
    sizes : Sizes
        Of the system.
    entropy : EntropyColumns
    file : Table or None
        Holds the rows, maybe not of every step; without it they are kept in memory. Figures of the whole run need
        neither: they follow from the first and the last row and the least and greatest values of all.
    moves : list of str
        What was moved onto the constraints, or into balance (damage), before the first row.
    """

    potentials: list[str]
    works: list[str]
    heats: list[str] = field(default_factory=list)
    sizes: Sizes = field(default_factory=Sizes)
    entropy: EntropyColumns = field(default_factory=EntropyColumns)
    moves: list[str] = field(default_factory=list)
    rows: list[Array] = field(default_factory=list)
    file: Table | None = None
    span: Array = field(default_factory=lambda: np.empty((4, 0)))
    """First row, last row, least values, greatest values."""
    units: dict[str, str] = field(default_factory=dict)
    """Of the columns, as far as they are known; the first is named as in files."""

    def add(self, row: Array) -> None:
        """Take in the row of a step."""
        if not self.span.size:
            self.span = np.array([row] * 4)
        self.span[1] = row
        np.minimum(self.span[2], row, out=self.span[2])
        np.maximum(self.span[3], row, out=self.span[3])
        if self.file is None:
            self.rows.append(row)

    @cached_property
    def _column(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self.names)}

    def column(self, name: str) -> int:
        """Number of a column.

        Raises
        ------
        InputError
            With the nearest name, if there is none.
        """
        if name not in self._column:
            raise InputError(f"the ledger has no column {name!r}{nearest(str(name), self._column)}")
        return self._column[name]

    def first(self, name: str) -> float:
        """Value at the start."""
        return float(self.span[0, self.column(name)])

    def last(self, name: str) -> float:
        """Value of the last step."""
        return float(self.span[1, self.column(name)])

    def least(self, name: str) -> float:
        """Least value of all steps."""
        return float(self.span[2, self.column(name)])

    def greatest(self, name: str) -> float:
        """Greatest value of all steps."""
        return float(self.span[3, self.column(name)])

    def size(self, name: str) -> float:
        """Greatest absolute value of all steps."""
        return float(np.abs(self.span[2:, self.column(name)]).max())

    def swing(self, name: str) -> float:
        """Greatest value of all steps less the least one."""
        return self.greatest(name) - self.least(name)

    @property
    def names(self) -> list[str]:
        potentials = [f"potential_{k}" for k in self.potentials]
        defects = ["defect_position", "defect_velocity"]
        energies = [*potentials, "total", *self.brought, "imbalance"]
        return ["time", "kinetic", *energies, *MOMENTA, *defects, *self.entropy.names]

    @property
    def brought(self) -> list[str]:
        """Columns of works and heats, which change the total."""
        return [*(f"work_{k}" for k in self.works), *(f"heat_{k}" for k in self.heats)]

    @property
    def table(self) -> Array:
        """All rows (n, columns); of a run in a directory those in its table."""
        return np.array(self.rows) if self.file is None else self.file.read()

    def __getitem__(self, name: str) -> Array:
        return self.table[:, self.column(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._column

    def to_dataframe(self) -> Any:
        """Its rows as a table of pandas, with the times as index."""
        return dataframe(self._named())

    def to_csv(self, path: str | Path) -> Path:
        """Write its rows, with units where they are known."""
        named = {name: (values, self.units.get(name, "")) for name, values in self._named().items()}
        return write_table(path, named)

    def _named(self) -> dict[str, Array]:
        """Columns by their names in files."""
        return dict(zip([next(iter(self.units), "time"), *self.names[1:]], self.table.T, strict=True))

    def __repr__(self) -> str:
        if not self.span.size:
            return "Ledger(no rows)"
        return (
            f"Ledger(to time {self.last('time'):g}, total energy {self.first('total'):.6g} -> "
            f"{self.last('total'):.6g}, balance closes to {self.imbalance():.1e})"
        )

    def _repr_html_(self) -> str:
        if not self.span.size:
            return repr(self)
        rows = [
            (
                with_unit(n, self.units.get(n, "")),
                f"{self.first(n):.6g}",
                f"{self.last(n):.6g}",
                sparkline(values),
            )
            for n, values in zip(self.names[1:], self.table.T[1:], strict=True)
        ]
        return table(rows, ("", "first", "last", "over time"), "Ledger")

    @property
    def energy_scale(self) -> float:
        """Scale of energy errors: the largest of kinetic energy, swing of potentials, work, heat that moves inside.

        Where hardly anything moves a part of the potentials, or of what forces could do, which are exact to rounding
        only; where nothing does, what rounding of places makes.
        """
        jitter = UNSEEN * self.sizes.length / self.duration if self.duration > 0 else 0.0
        potentials = [f"potential_{k}" for k in self.potentials]
        swings = [max(self.swing(p), QUIET * self.size(p)) for p in potentials]
        works = [self.size(name) for name in self.brought]
        return float(
            max(
                [
                    self.greatest("kinetic"),
                    *swings,
                    *works,
                    self.heat_inside,
                    STILL * (self.sizes.pull + self.sizes.power * self.duration),
                    0.5 * self.sizes.mass * jitter**2,
                    np.finfo(float).tiny,
                ]
            )
        )

    @property
    def heat_inside(self) -> float:
        """Heat that passes from part to part: by which the entropy changes, at the temperature that it has."""
        if not self.entropy:
            return 0.0
        return self.entropy.temperature * max(self.swing("entropy"), STILL * self.entropy.size)

    @property
    def duration(self) -> float:
        """Time between the ends of the run."""
        return self.swing("time")

    @property
    def speed(self) -> float:
        """Greatest root mean square of the velocity of the mass; at least a millionth of the length per run."""
        rms = float(np.sqrt(2 * self.greatest("kinetic") / self.sizes.mass)) if self.sizes.mass > 0 else 0.0
        return max(rms, STILL * self.sizes.length / self.duration if self.duration > 0 else 0.0)

    def momentum_scale(self, kind: str) -> float:
        """Scale of changes of momentum ('momentum' or 'angular').

        The greatest momentum that the masses can have with the largest kinetic energy T of the run, ``sqrt(2 m
        T)``, times the length of the system for angular momentum; or the momentum they do have, if it is more. Where
        strong forces inside act for long on what hardly moves, a part of their impulse, which is exact to rounding.
        """
        arm = self.sizes.length if kind == "angular" else 1.0
        work = max((self.swing(f"potential_{k}") for k in self.sizes.inner), default=0.0)
        impulse = FELT * work / self.sizes.length * self.duration
        most = max(self.sizes.mass * self.speed, impulse) * arm
        parts = [self.size(f"{kind}_{c}") for c in "xyz"]
        return float(max(most, *parts, np.finfo(float).tiny))

    @property
    def rate_scale(self) -> float:
        """Rate at which the system moves by its length; once in the run at least."""
        return max(self.speed / self.sizes.length, 1 / self.duration if self.duration > 0 else 1.0)

    def imbalance(self) -> float:
        """Largest closing error of the energy balance relative to the energy scale."""
        return self.size("imbalance") / self.energy_scale

    def drift(self, name: str) -> float:
        """Largest change of a momentum column relative to the momentum scale."""
        first = self.first(name)
        change = max(self.greatest(name) - first, first - self.least(name))
        return change / self.momentum_scale(name.split("_")[0])


class Bookkeeper:
    """Turns the core's sums of each step into rows of a ledger.

    Attributes
    ----------
    ledger : Ledger
    done : array
        Work and heat so far by kind.
    entropy : EntropyBooks
    total0 : float or None
        Energy of the initial state, None before its row is booked.
    """

    def __init__(self, system: System) -> None:
        accounts = system.model.accounts

        def kinds(*categories: str) -> list[str]:
            return sorted({a.kind for a in accounts if a.category in categories})

        mass = sum(c.total_mass for c in system.components)
        self.entropy = EntropyBooks(system.model, system.scale)
        self._held = None if system.has_inertia else held(system)
        works = kinds("work", "dissipation") + ([] if self._held is None else [RELEASE])
        lacking = unbooked(system.components)
        with undisturbed(system):
            sizes = Sizes(
                mass,
                system.model.length,
                *force_scale(system),
                inner_potentials(system),
                Spread.of_contents(system.model),
                Spread.of(system.model, lacking),
                None if system.has_inertia else Missed(system),
                Groups(system.model, lacking) if system.has_inertia else None,
                lags_of(system),
            )
            columns = self.entropy.columns
            self.ledger = Ledger(kinds("potential"), works, kinds("heat"), sizes, columns)
            self._per_reach = 1 / reaches(system)[:, None]
        if system.report is not None:
            self.ledger.moves = system.report.moves
        ledger, n = self.ledger, len(accounts)
        self._kinetic = np.array([a.category == "kinetic" for a in accounts], dtype=float)
        self._potential = np.zeros((len(ledger.potentials), n))
        self._brought = np.zeros((len(ledger.brought), n))
        for k, a in enumerate(accounts):
            if a.category == "potential":
                self._potential[ledger.potentials.index(a.kind), k] = 1
            if a.category in ("work", "dissipation", "heat"):
                name = f"heat_{a.kind}" if a.category == "heat" else f"work_{a.kind}"
                self._brought[ledger.brought.index(name), k] = 1
        self.done = np.zeros(len(ledger.brought))
        self.swings = Swings()
        self.total0: float | None = None

    def book(self, time: float, core: Any) -> Array:
        """Add the row of the step that the core has just accepted (or of the initial state)."""
        for own in (self.ledger.sizes.spread, self.ledger.sizes.unbooked):
            own.add(core)
        energy = core.energy
        kinetic = self._kinetic @ energy
        potential = self._potential @ energy
        total = kinetic + potential.sum()
        self.done = self.done + self._brought @ core.work
        if self._held is not None:
            self.done[len(self.ledger.works) - 1] += core.release[self._held].sum()
        if self.total0 is None:
            self.total0 = total
        momentum = core.momentum.reshape(-1, 6).sum(axis=0)
        defect = (core.defect.reshape(-1, 2) * self._per_reach).max(axis=0)
        imbalance = total - self.total0 - self.done.sum()
        entropy = self.entropy.row(core, self.ledger)
        row = np.concatenate(
            [[time, kinetic], potential, [total], self.done, [imbalance], momentum, defect, entropy]
        )
        self.ledger.add(row)
        if (missed := self.ledger.sizes.missed) is not None:
            missed.add()
        if (groups := self.ledger.sizes.groups) is not None:
            groups.add(time, core)
        return row


def held(system: System) -> NDArray[np.bool_]:
    """Unknowns (n,) in which energies are least: those that stood out of equilibrium release some in statics."""
    fields = system.model.fields
    return np.concatenate([np.full(f.size, f.role.has_least_energy) for f in fields])


def reaches(system: System) -> Array:
    """By what the violations of each component's constraints are measured (n_components,); 1 without any."""
    reach = np.full(len(system.components), np.inf)
    if system.n_constraints:
        at, model = Instant(system), system.model
        owner = {u: model.index(f.component) for f in model.fields if f.multiplier for u in f.unknowns}
        np.minimum.at(reach, [owner[int(u)] for u in at.multipliers], at.reach)
    return np.where(np.isfinite(reach), reach, 1.0)


def bearing(system: System) -> NDArray[np.bool_]:
    """Unknowns (n,) that stand for forces, or have the least energy in the state of the others."""
    fields = system.model.fields
    return np.concatenate([np.full(f.size, f.order == 0 and f.role is not Role.TEMPERATURE) for f in fields])


def inner_potentials(system: System) -> tuple[str, ...]:
    """Kinds of potentials that components have which move."""
    model = system.model
    moving = {model.index(f.component) for f in model.fields if f.role is Role.MOTION}
    kinds = {a.kind for a in model.accounts if a.category == "potential" and a.component in moving}
    return tuple(sorted(kinds))


def force_scale(system: System) -> tuple[float, float]:
    """Floors of relative errors of energies: the sum of |force| times the scale of each unknown of motion, constraints
    left out, and the sum of |force| times the scale of speed over unknowns of flows."""
    with returning(system):
        system.x[bearing(system)] = 0.0
        force = np.abs(system.residual(instant(system.time, theta=1.0)))
    fields, effect = system.model.fields, force * system.scale
    moves = np.concatenate([(f.role is Role.MOTION) & ~f.fixed for f in fields])
    flows = np.concatenate([(f.role is Role.VELOCITY) & ~f.fixed for f in fields])
    return float(effect[moves].sum()), float(effect[flows].sum())
