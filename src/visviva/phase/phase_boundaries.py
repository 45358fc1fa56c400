"""Boundary conditions and sources of mixtures and order parameters: wetting, given values, reactions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.base.places import OfAll
from visviva.body.space import Table
from visviva.component.announcements import Given
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import FaceSet, Nodes, Number, OfTimeAndPlace
from visviva.mesh.faces import Faces
from visviva.mesh.periodic import numbering, refuse_apart, refuse_periodic
from visviva.model.field import Field
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.model.term import Stencils, Term
from visviva.phase.allen_cahn import AllenCahn
from visviva.phase.cahn_hilliard import CahnHilliard
from visviva.phase.exclusion import Exclusion
from visviva.phase.free_energy import FreeEnergy
from visviva.phase.interface import unclear
from visviva.phase.mixture_solid import MixtureSolid
from visviva.phase.wall_energy import CLOSE, WallEnergy, wall_at
from visviva.thermal.boundaries import Values

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def refuse_direct(label: str, body: CahnHilliard | MixtureSolid | AllenCahn) -> None:
    """Refuse a mixture without a potential, which conditions act by.

    Raises
    ------
    InputError
    """
    if isinstance(body, CahnHilliard) and body.form == "direct":
        raise InputError(
            f"{label}: {body.label} has form = 'direct', without a potential; take form = 'mixed'"
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Wetting(Component):
    """A wall with an energy per area of the concentration there, and so an angle at which interfaces meet it.

    Parameters
    ----------
    body : CahnHilliard, MixtureSolid or AllenCahn
    faces : str or Faces
    angle : float, optional
        In degrees, measured in the phase of the higher concentration (Young): below 90 it wets the wall.
    energy : FreeEnergy, optional
        Polynomial, per area; instead of an angle.

    Notes
    -----
    An angle gives an energy of the slope ``-cos(angle) sqrt(2 kappa df)`` between the phases, with the free energy df
    above them, and of none beyond: so the flat interface keeps its profile up to the wall. For a double well that is
    ``-tension cos(angle) (3 s^2 - 2 s^3)``, where s is 0 in the phase of low and 1 in that of high concentration; for
    others the square root is fitted. Where that makes another angle it is refused.

    Examples
    --------
    >>> import visviva as vv
    >>> drop = vv.CahnHilliard(
    ...     mesh=vv.RectangleMesh(size=(8, 8), counts=(16, 16)),
    ...     free_energy=vv.DoubleWell(barrier=1.0),
    ...     gradient_energy=1.0,
    ...     concentration=0.5,
    ... )
    >>> wall = vv.Wetting(body=drop, faces="y0", angle=60.0)
    >>> round(float(wall.wall_energy.values(0.0) - wall.wall_energy.values(1.0)) / drop.interface().tension, 3)
    0.5
    """

    outside_axes = NOWHERE

    body: CahnHilliard | MixtureSolid | AllenCahn
    faces: FaceSet
    angle: Number | None = None
    energy: FreeEnergy | None = None

    def __post_init__(self) -> None:
        refuse_direct(self.label, self.body)
        try:
            self._faces = self.body.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        refuse_periodic(self.label, self.body, self.body.periodic, self._faces)
        if (self.angle is None) == (self.energy is None):
            raise InputError(f"{self.label}: give either an angle or an energy")
        if self.angle is not None and not 0 <= self.angle <= 180:
            raise InputError(f"{self.label}: angle = {self.angle:g} is not between 0 and 180 degrees")
        if self.energy is not None and (any(self.energy.logs) or not self.energy.polynomial.coef.any()):
            raise InputError(
                f"{self.label}: the energy of a wall is a polynomial of the core; take vv.PolynomialEnergy"
            )
        self.wall_energy = (
            self._by_angle(self.angle)
            if self.energy is None
            else WallEnergy(self.energy.polynomial, self.energy.centre)
        )

    def _by_angle(self, angle: Any) -> WallEnergy:
        if self.body.free_energy.changes:
            raise InputError(
                f"{self.label}: the free energy of {self.body.label} changes in time, and with it what an angle stands "
                "for; give an energy"
            )
        found = self.body.interface()
        if found is None:
            raise InputError(
                f"{self.label}: the free energy of {self.body.label} has no two phases, and so no angle"
            )
        if not found.alike:
            raise InputError(
                f"{self.label}: the gradient energy of {self.body.label} is not the same in all directions, so that "
                "what an angle stands for is another one for every direction of the wall; give an energy"
            )
        if why := unclear(found, not isinstance(self.body, AllenCahn) or self.body.conserved):
            raise InputError(
                f"{self.label}: the free energy of {self.body.label} {why}; what an angle stands for it does not tell: "
                "give an energy"
            )
        made, becomes = wall_at(angle, self.body.free_energy, found)
        if abs(np.cos(np.radians(becomes)) - np.cos(np.radians(angle))) > CLOSE:
            raise InputError(
                f"{self.label}: with angle = {angle:g} interfaces would meet the wall at {becomes:.3g} degrees, as no "
                f"polynomial comes near enough to the free energy of {self.body.label}; take an angle nearer to 90, or "
                "give an energy"
            )
        return made

    def announce(self, model: Model) -> None:
        model.announce(self.body, self)

    def declare(self, model: Model) -> None:
        for other in model.announced(self.body, Wetting):
            if other is not self and self.angle is not None and shares(self._faces, other._faces):
                raise InputError(
                    f"{self.label}: {other.label} has some of its faces, and the energies of both add up: angle = "
                    f"{self.angle:g} is none that interfaces would have there; give each face one angle, or energies"
                )
        if self.angle is not None and (others := model.announced(self.body, Exclusion)):
            raise InputError(
                f"{self.label}: {self.body.label} is one of several order parameters of {others[0].label}, and its "
                "free energy alone does not tell what an angle stands for; give an energy"
            )

    def contribute(self, model: Model) -> None:
        model.index(self.body)
        kind = PhysicsKind.ORDER_WALL if self.body.potential is None else PhysicsKind.MIXTURE_WALL
        fields = [f for f in (self.body.phase, self.body.potential) if f is not None]
        for table in self.body.space.walls(self._faces):
            groups = [Group(f.start + table.numbers, table.columns(gradients=False)) for f in fields]
            add_points(model, self, kind, groups, table.size, self.wall_energy.constants())


def shares(one: Faces, other: Faces) -> bool:
    """Whether some faces are in both."""
    sets = (
        {tuple(sorted(nodes)) for rows in faces.cells.values() for nodes in np.asarray(rows).tolist()}
        for faces in (one, other)
    )
    return not set.isdisjoint(*sets)


@dataclass(config=settings, eq=False, kw_only=True)
class PrescribedConcentration(Component):
    """Places whose concentration is given: what flows in or out there is a result.

    Parameters
    ----------
    body : CahnHilliard or MixtureSolid
    nodes : str or int array
        Name of a set of nodes or faces, 'all', or numbers.
    value : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)

    Notes
    -----
    The ledger books what the inflow brings, its potential times its amount, as "supply". Nodes may be held by several,
    such as those of edges, if all give them the same value.
    """

    outside_axes = NOWHERE

    body: CahnHilliard | MixtureSolid
    nodes: Nodes
    value: OfTimeAndPlace

    def __post_init__(self) -> None:
        refuse_direct(self.label, self.body)
        try:
            self._chosen = self.body.nodes(self.nodes)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        self._number = numbering(self.body.grid, self.body.periodic, self.label)[0][self._chosen]
        self._values = Values(self.label, "value", self.value, OfAll)
        self._values.checked(self.body.points[self._chosen])
        try:
            self._held = self.body.space.held(self._chosen)
        except InputError as error:
            raise InputError(f"{self.label}: {self.body.label} stands on splines: {error}") from None
        try:
            self._given(0.0)
        except RunError as error:
            raise InputError(str(error)) from error

    def announce(self, model: Model) -> None:
        model.announce(self.body, self)
        model.announce(self.body, Given(self._given(0.0)))

    def declare(self, model: Model) -> None:
        model.index(self.body)
        every = model.announced(self.body, PrescribedConcentration)
        others = [c for c in every if c is not self]
        both = [(c, *np.intersect1d(self._number, c._number, return_indices=True)[1:]) for c in others]
        self._beside = [(other, mine, theirs) for other, mine, theirs in both if len(mine)]
        before = [c._held for c in every[: every.index(self)]]
        self._own = ~np.isin(self._held, np.concatenate([np.zeros(0, dtype=int), *before]))
        try:
            self.wanted(0.0)
        except RunError as error:
            raise InputError(str(error)) from error
        self.inflow = model.multipliers(self, "inflow", int(self._own.sum()), instantaneous=False)

    def wanted(self, time: float) -> Array:
        """Coefficients (k,) of what is held, but for what others before hold already.

        Sides of splines that meet fit the same values each by itself, which gives another one where they meet.

        Raises
        ------
        RunError
            If others give the same places other concentrations.
        """
        own = self._given(time)
        for other, mine, theirs in self._beside:
            given = other._given(time)
            apart = np.abs(own[mine] - given[theirs])
            worst = int(np.argmax(apart))
            if apart[worst] > 1e-9 * max(np.abs(own).max(), np.abs(given).max()):
                raise RunError(
                    f"{self.label} and {other.label} hold the same place of {self.body.label}, at concentrations of "
                    f"{own[mine][worst]:g} and {given[theirs][worst]:g} at t = {time:g}: give both the same, or take "
                    "its nodes out of one of them"
                )
        return self.body.space.fitted_on(self._chosen, own)[self._own]

    def _given(self, time: float) -> Array:
        """At its nodes."""
        values = self._values.at(time, self.body.points[self._chosen])
        refuse_apart(self.label, "concentration", self._number, values, time)
        return values

    def contribute(self, model: Model) -> None:
        assert self.body.potential is not None
        if not np.any(self._own):
            return
        unknowns = [f.start + self._held[self._own] for f in (self.body.phase, self.body.potential)]
        unknowns.append(self.inflow.start + np.arange(self.inflow.size))
        model.term(self, Inflow(np.stack(unknowns, axis=1).astype(np.int32), self.wanted))


class Inflow(Term):
    """Multipliers that hold concentrations: unknowns are the concentration, the potential and the inflow."""

    kind = "supply"

    def __init__(self, unknowns: NDArray[np.int32], wanted: Callable[[float], Array]) -> None:
        super().__init__()
        self.unknowns, self.order, self._wanted = unknowns, np.array([1, 0, 0], dtype=np.int32), wanted

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        found[:, 0], found[:, 2] = -s.x1[:, 2], self._wanted(s.step.t1) - s.x1[:, 0]
        return found

    def tangent(self, s: Stencils) -> Array:
        K = np.zeros((3, 3))
        K[0, 2] = K[2, 0] = -1.0
        return np.broadcast_to(K, (len(s.x1), 3, 3))

    def work(self, s: Stencils) -> Array:
        return np.asarray(s.step.h * s.x1[:, 1] * s.x1[:, 2])


@dataclass(config=settings, eq=False, kw_only=True)
class ConcentrationSource(Component):
    """Source of a mixture by reactions or radiation, per volume and time.

    Parameters
    ----------
    body : CahnHilliard, MixtureSolid or AllenCahn
    rate : number, expression or table of time, or ``f(t, X)`` of time and positions (n, 3) with values (n,)
        Of an order parameter: a force, which adds to ``-(f' - div(K grad c))``.
    """

    outside_axes = NOWHERE

    body: CahnHilliard | MixtureSolid | AllenCahn
    rate: OfTimeAndPlace

    def __post_init__(self) -> None:
        self._values = Values(self.label, "rate", self.rate)
        self._values.checked(self.body.points)

    def contribute(self, model: Model) -> None:
        model.index(self.body)
        for table in self.body.space.cells():
            model.term(self, self._source(table))

    def _source(self, table: Table) -> Source:
        if isinstance(self.body, CahnHilliard) and self.body.form == "direct":
            return DirectSource(self.body, table, self._values)
        return Source(self.body.phase, self.body.potential, table, self._values)


class Source(Term):
    """Adds to the balance of a concentration, whose potential may follow among the unknowns."""

    kind = "source"

    def __init__(self, field: Field, potential: Field | None, table: Table, values: Values) -> None:
        super().__init__()
        k, parts = table.numbers.shape[1], [field.start + table.numbers]
        if potential is not None:
            parts.append(potential.start + table.numbers)
        self.unknowns = np.hstack(parts).astype(np.int32)
        self.order = np.array([1] * k + [0] * (self.unknowns.shape[1] - k), dtype=np.int32)
        self.k, self.has_potential, self.table, self.values = k, potential is not None, table, values

    def loads(self, s: Stencils) -> Array:
        """Rates of supply (m, k), by coefficients."""
        t = self.table
        return np.asarray(np.einsum("mq,mq,mqk->mk", t.size, self.values.at(s.step.te, t.X), t.N))

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        found[:, : self.k] = -self.loads(s)
        return found

    def tangent(self, s: Stencils) -> Array:
        n = s.x1.shape[1]
        return np.zeros((len(s.x1), n, n))

    def work(self, s: Stencils) -> Array:
        by = s.step.h * s.x1[:, self.k :] if self.has_potential else s.x1 - s.x0
        return np.asarray((self.loads(s) * by).sum(axis=1))


class DirectSource(Source):
    """Of a mixture without a potential, which is that of the concentrations: ``f' - kappa laplace c``."""

    def __init__(self, body: CahnHilliard, table: Table, values: Values) -> None:
        super().__init__(body.phase, None, table, values)
        self.potential = body.potential_at

    def work(self, s: Stencils) -> Array:
        t = self.table
        mu = self.potential(t, s.x, s.step.te)
        return np.asarray(s.step.h * np.einsum("mq,mq,mq->m", t.size, self.values.at(s.step.te, t.X), mu))
