"""Statics of what cracks, to and fro between positions and damages."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.load_steps import Equilibrium, LoadReport, NoEquilibrium, Static
from visviva.base.arguments import bounded
from visviva.base.errors import InputError, NotFinite
from visviva.model.field import Role
from visviva.model.state import State
from visviva.system.system import System

Array = NDArray[np.float64]

ROUGHLY = 1e-4
"""Relative increments to which either part is solved on the way."""
ROUNDING = 1e-14
"""Of energies, by all that a component has."""


@dataclass(frozen=True)
class AlternateMinimization(Static):
    """Static load steps to and fro: positions in equilibrium at given damages, then the damages of least energy.

    The energy falls in every one of them, so that they get to an equilibrium where Newton's method for all unknowns at
    once does not: across the sudden growth of a crack (Bourdin, Francfort & Marigo 2000).

    Parameters
    ----------
    energy_tolerance : float
        Share of the energy stored in each component that cracks, weights left out, that the last change of damages may
        release; or take up, which history fields let it.
    rounds : int
        Largest number of goes to and fro; a load step that takes more is halved.
    newton : int
        Try Newton's method for all unknowns first, and again after every so many goes to and fro: where a crack has
        found its way it takes a few iterations, and one that does not get there or would shrink a crack is forgotten.
        0 never does.

    Examples
    --------
    >>> import visviva as vv
    >>> bar = vv.FracturingSolid(
    ...     mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
    ...     material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
    ...     toughness=1e-8,
    ...     length=1.0,
    ... )
    >>> held = vv.Fixed(solid=bar, nodes="x0")
    >>> pulled = vv.Prescribed(solid=bar, nodes="x1", motion=("1e-5 * t", None, None))
    >>> system = vv.System([bar, held, pulled])
    >>> _ = vv.quasi_static(system, until=1.0, step=0.5, scheme=AlternateMinimization())
    >>> round(float(bar.damages(system.x).max()), 3)  # e^2 / (G_c / l E + e^2)
    0.01
    """

    energy_tolerance: float = 1e-6
    rounds: int = 2000
    newton: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        bounded(self, energy_tolerance=(1e-300, 1.0), rounds=(1, 1e9), newton=(0, 1e9))

    def equations(self, system: System) -> Equilibrium:
        return Alternation(system, self)

    def refuse(self, state: State) -> None:
        super().refuse(state)
        if not state.model.growing:
            raise InputError(
                "vv.AlternateMinimization: nothing here has damage; take vv.Static() for a system without "
                "vv.FracturingSolid"
            )
        warm = {id(f.component) for f in state.model.fields if f.role is Role.TEMPERATURE}
        for growing in state.model.growing:
            if id(growing.field.component) in warm:
                raise InputError(
                    f"vv.AlternateMinimization: {growing.field.component.label} holds heat, beside which the energy of "
                    "its cracks tells nothing; take vv.Static() or vv.CrackControl(growth=...)"
                )


@dataclass
class Alternation(Equilibrium):
    """Equilibrium found to and fro between growing unknowns and all others."""

    options: AlternateMinimization
    damages: NDArray[np.int32] = field(init=False)
    accounts: list[tuple[NDArray[np.bool_], NDArray[np.bool_], bool]] = field(init=False)
    """Of every component that cracks: all of its energies, those that cracks release, without weights, and whether its
    energy falls in every round."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.damages = np.zeros(len(self.dx), dtype=np.int32)
        model = self.system.model
        stored = np.array([a.kind == "stored" for a in model.accounts])
        self.accounts = []
        for growing in model.growing:
            self.damages[growing.field.unknowns] = 1
            k = model.index(growing.field.component)
            self.accounts.append((np.array([a.component == k for a in model.accounts]), stored, growing.held))

    @contextmanager
    def _halted(self, unknowns: NDArray[np.int32]) -> Iterator[None]:
        self.system.core.halt(unknowns.tolist())
        try:
            yield
        finally:
            self.system.core.halt([])

    def predict(self, time: float) -> None:
        with self._halted(self.damages):
            super().predict(time)

    def energies(self, time: float) -> Array:
        """Stored at the trial state, by account."""
        step = self.at(time)
        return np.array(self.system.core.trial_energies(step, self.system.signals(step)))

    def iterate(self, time: float) -> LoadReport:
        o, taken, wait = self.options, LoadReport(0, 0), 0
        for k in range(o.rounds):
            if o.newton and k == wait:
                found = self._all_at_once(time)
                if found is not None:
                    return taken + found
                wait += max(o.newton, wait)  # tried ever more seldom, as it costs
            taken += self._part(time, self.damages, ROUGHLY)
            before = self.energies(time)
            taken += self._part(time, 1 - self.damages, ROUGHLY)
            after = self.energies(time)
            if self._has_settled(before, after):
                return taken + self._part(time, self.damages, o.tolerance)
        raise self.failure(
            time, f"no equilibrium in {o.rounds} goes to and fro between positions and damages"
        )

    def _has_settled(self, before: Array, after: Array) -> bool:
        """Whether a change of damages released next to nothing, in every component: none hides behind a larger one.

        Of history fields, which let energies rise, no energy may change: their sum passes zero on the way.
        """
        for own, stored, falls in self.accounts:
            allowed = self.options.energy_tolerance * after[own & stored].sum()
            allowed += ROUNDING * np.abs(after[own]).sum()
            change = (before - after)[own]
            if (abs(change.sum()) if falls else np.abs(change).sum()) > allowed:
                return False
        return True

    def _part(self, time: float, halted: NDArray[np.int32], tolerance: float) -> LoadReport:
        """Newton's method while some unknowns are halted."""
        kept, self.options = self.options, replace(self.options, tolerance=tolerance)
        try:
            with self._halted(halted):
                return super().iterate(time)
        finally:
            self.options = kept

    def _all_at_once(self, time: float) -> LoadReport | None:
        """Newton's method for all unknowns from here; where it fails they are as they were."""
        kept = self.dx.copy()
        try:
            report = super().iterate(time)
        except (NoEquilibrium, NotFinite):
            self.dx[:] = kept
            return None
        return report

    def accept(self, time: float) -> None:
        self.linearise(time)  # factors of all unknowns together, by which stability is judged
        super().accept(time)
