"""The conditions at the boundary of a fluid together: who holds which nodes, and whether what flows in flows out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, RunError
from visviva.component.component import Component
from visviva.flow.boundary_faces import flux_weights
from visviva.mesh.faces import Faces, corner_rows
from visviva.mesh.periodic import refuse_periodic

if TYPE_CHECKING:
    from visviva.flow.fluid import Fluid
    from visviva.model.model import Model

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BALANCED = 1e-3
"""Prescribed flow out of a closed fluid that misses the flow in by less than this part of it is scaled to meet it:
what interpolation leaves of profiles that balance."""


class Condition(Component):
    """Common part of the conditions on faces of a fluid.

    Attributes
    ----------
    fluid : Fluid
    chosen : Faces
    """

    fluid: Any  # its class stands above
    chosen: Faces

    rank: ClassVar[int] = 0
    """Who has the nodes that several conditions share: the lowest."""
    prescribes: ClassVar[bool] = False
    """Whether it says at which velocity fluid passes."""

    @property
    def is_open(self) -> bool:
        """Whether fluid may pass at a velocity that the flow finds."""
        return False

    def announce(self, model: Model) -> None:
        model.announce(self.fluid, self)

    def wanted(self) -> Mask:
        """Components (n_nodes, d) of the velocity that it holds, if nobody of lower rank does."""
        return np.zeros(self.fluid.grid.points.shape, dtype=bool)

    def velocities_at(self, time: float) -> Array:
        """Velocities (n_nodes, d) that it prescribes; zero elsewhere."""
        return np.zeros(self.fluid.grid.points.shape)


class Conditions:
    """Conditions of one fluid, gathered over its boundary.

    Nodes that several conditions share belong to walls first, then to prescribed velocities, then to slip.

    Attributes
    ----------
    listed : list of Condition
        In this order.
    closed : bool
        Whether nothing but prescribed velocities lets fluid through, so that the level of the pressure is free.
    """

    def __init__(self, fluid: Fluid, model: Model) -> None:
        self.fluid, self.listed = fluid, sorted(model.announced(fluid, Condition), key=lambda c: c.rank)
        self._refuse_overlap()
        self._refuse_uncovered()
        self.closed = not any(c.is_open for c in self.listed)
        self._shares = self._shared()
        self._weights = flux_weights(fluid.grid, fluid.grid.boundary()) if self.closed else np.zeros((0, 0))
        self._factor: tuple[float, float] | None = None

    @property
    def speed(self) -> float:
        """Largest prescribed velocity at the start."""
        return max((float(np.abs(c.velocities_at(0.0)).max(initial=0.0)) for c in self.listed), default=0.0)

    @property
    def walls(self) -> list[Faces]:
        """Where the fluid sticks."""
        return [c.chosen for c in self.listed if c.rank == 0]

    def share(self, condition: Condition) -> NDArray[np.int64]:
        """Numbers in the fluid's field of the components that a condition holds."""
        return np.flatnonzero(self._shares[id(condition)])

    # --- who holds what ------------------------------------------------------------------------------------
    def _shared(self) -> dict[int, Mask]:
        fluid, d = self.fluid, self.fluid.dimension
        taken, shares = np.zeros((fluid.n_numbers, d), dtype=bool), {}
        prescribed = np.full(taken.shape, np.nan)
        for c in self.listed:
            wanted = np.zeros_like(taken)
            np.logical_or.at(wanted, fluid.number, c.wanted())
            self._refuse_conflict(c, wanted, prescribed)
            shares[id(c)] = wanted & ~taken
            taken |= wanted
        return shares

    def _refuse_conflict(self, c: Condition, wanted: Mask, prescribed: Array) -> None:
        """Two prescribed velocities that disagree in a node; `prescribed` gathers those met so far."""
        if not c.prescribes:
            return
        here = np.zeros_like(prescribed)
        here[self.fluid.number] = c.velocities_at(0.0)
        size = float(np.abs(here).max(initial=0.0))
        differ = wanted & (np.abs(here - prescribed) > 1e-9 * size)
        if differ.any():
            number = int(np.argmax(differ.any(axis=1)))
            place = self.fluid.grid.points[np.argmax(self.fluid.number == number)]
            raise InputError(
                f"{c.label}: at {place.tolist()} it prescribes the velocity {here[number].tolist()}, and another "
                f"condition {prescribed[number].tolist()}; let the profiles meet, or take faces from one of them"
            )
        prescribed[wanted] = here[wanted]

    def _refuse_overlap(self) -> None:
        owner: dict[tuple[int, ...], Condition] = {}
        for c in self.listed:
            refuse_periodic(c.label, self.fluid, self.fluid.periodic, c.chosen)
            for row in corner_rows(c.chosen):
                other = owner.setdefault(row, c)
                if other is not c:
                    place = self.fluid.grid.points[list(row)].mean(axis=0).round(9).tolist()
                    raise InputError(
                        f"{c.label} and {other.label} both have the face at {place}; leave it to one of them"
                    )

    def _refuse_uncovered(self) -> None:
        fluid = self.fluid
        named = [c.chosen for c in self.listed] + [fluid.faces(n) for pair in fluid.periodic for n in pair]
        covered = {row for faces in named for row in corner_rows(faces)}
        bare = [row for row in corner_rows(fluid.grid.boundary()) if row not in covered]
        if bare:
            place = fluid.grid.points[list(bare[0])].mean(axis=0).round(9).tolist()
            raise InputError(
                f"{fluid.label}: {len(bare)} faces of its boundary have no condition, one of them at {place}; give "
                "them vv.NoSlip, vv.VelocityBoundary, vv.FreeSlip, vv.Outlet or vv.FluidTraction"
            )

    # --- balance -------------------------------------------------------------------------------------------
    def outflow_factor(self, time: float) -> float:
        """By what prescribed outflow is scaled so that it balances the inflow; 1 where an outlet does that.

        Raises
        ------
        RunError
            If they miss each other by more than interpolation explains.
        """
        if not self.closed:
            return 1.0
        if self._factor is None or self._factor[0] != time:
            self._factor = time, self._balanced(time)
        return self._factor[1]

    def _balanced(self, time: float) -> float:
        through, size = np.zeros(self.fluid.grid.n_nodes), 0.0
        for c in self.listed:
            held = self._shares[id(c)][self.fluid.number]
            parts = np.where(held, self._weights * c.velocities_at(time), 0.0)
            speed = np.linalg.norm(c.velocities_at(time), axis=1)
            size += float(np.linalg.norm(self._weights, axis=1) @ speed)
            through += parts.sum(axis=1)
        self._leaving = through > 0
        out, into = float(through[through > 0].sum()), -float(through[through < 0].sum())
        if abs(out - into) <= 1e-14 * size:
            return 1.0
        if abs(out - into) > BALANCED * max(out, into):
            raise RunError(
                f"{self.fluid.label}: at t = {time:g} {into:.6g} flows in and {out:.6g} out by its prescribed "
                f"velocities, a difference of {into - out:.6g} per time that an incompressible fluid cannot take; make "
                "one of the boundaries a vv.Outlet, or let the velocities balance"
            )
        return into / out

    def scaled(self, time: float, v: Array) -> Array:
        """Velocities (n_nodes, d) with what leaves scaled to balance what enters."""
        factor = self.outflow_factor(time)
        if factor == 1.0:
            return v
        return np.where(self._leaving[:, None], factor * v, v)
