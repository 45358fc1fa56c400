"""Mechanics and heat in turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.arguments import bounded
from visviva.base.errors import InputError
from visviva.linear.choice import (
    BETWEEN,
    FEW,
    LOOSE,
    Automatic,
    Choice,
    Direct,
    Iterative,
    LinearOptions,
    Problem,
)


@dataclass(frozen=True)
class Halves:
    """Mechanics and heat of a problem, and by unknown which is which: int32 (n_unknowns,), 1 for heat."""

    mechanics: Problem
    heat: Problem
    is_heat: NDArray[np.int32]


@dataclass(frozen=True)
class Staggered(LinearOptions):
    """Solve mechanics and heat in turn: positions while entropies rest, then entropies and temperatures.

    Of solids and structures with temperatures. Each of Newton's iterations goes to and fro until what either leaves to
    the other is below the tolerance, so that steps get to the same solution as without, and the energy is kept as
    well. With entropies at rest the mechanics are those without exchange of heat, and symmetric: going to and fro
    contracts however strongly both are coupled (Armero & Simo 1992), by their coupling number.

    Parameters
    ----------
    tolerance : float
        Of what is left to the mechanics, relative to the largest residual that they had.
    mechanics, heat : LinearOptions
        How either is solved.

    Examples
    --------
    >>> import visviva as vv
    >>> block = vv.ThermoelasticSolid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
    ...     material=vv.NeoHooke(young=1e5, poisson=0.3),
    ...     density=1000.0,
    ...     heat=vv.Heat(conductivity=1.0, capacity=1e4, expansion=1e-4),
    ... )
    >>> system = vv.System([block], newton=vv.Newton(linear=vv.Staggered()))
    >>> "in turn" in system.linear_explanation
    True
    """

    tolerance: float = LOOSE
    mechanics: LinearOptions | None = None
    heat: LinearOptions | None = None

    def __post_init__(self) -> None:
        bounded(self, tolerance=BETWEEN)

    def choose(self, problem: Problem) -> Choice:
        """Refuses problems that have no halves."""
        raise InputError(
            "Staggered: nothing here both deforms and has temperatures, so there are no two parts to solve in turn; "
            "leave it out"
        )

    def choose_in_turn(self, problem: Problem, halves: Halves) -> Choice:
        """Solvers of both halves of a problem, and should turns not converge of all of it."""
        mechanics = (self.mechanics or Automatic()).choose(halves.mechanics)
        heat = self.heat.choose(halves.heat) if self.heat else self._heat(halves.heat)
        whole = Direct().choose(problem)
        c = _core.LinearChoice()
        c.backend, c.tolerance = _core.Backend.staggered, self.tolerance
        c.set_parts(list(mechanics.in_order), list(heat.in_order), halves.is_heat)
        last = whole.explanation.removeprefix(f"{problem}: ")
        return Choice(
            (c, *whole.in_order),
            f"{problem}: in turn mechanics, {mechanics.explanation}; and heat, {heat.explanation}; should turns not "
            f"converge, {last}",
        )

    def _heat(self, problem: Problem) -> Choice:
        """In time steps heat does not get far: a few iterations will do before factors."""
        last = Automatic().choose(problem)
        if not problem.has_inertia or problem.n_multipliers:
            return last
        first = Iterative(
            method="bicgstab", preconditioner="block", tolerance=LOOSE, max_iterations=FEW
        ).choose(problem)
        factors = last.explanation.removeprefix(f"{problem}: ")
        return Choice(
            (*first.in_order, *last.in_order), f"{first.explanation}; should it not converge, {factors}"
        )
