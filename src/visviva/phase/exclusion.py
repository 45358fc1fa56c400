"""Order parameters that exclude each other: grains, variants, several phases."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.space import Table
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.model.term import Stencils, Term
from visviva.phase.allen_cahn import AllenCahn, held_back
from visviva.phase.interface import LEVEL
from visviva.phase.phase_body import warmth
from visviva.phase.shared_boundary import Side, widths

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]

ROUGHLY = 0.01
"""To which widths of boundaries are known."""
ABSENT = 0.1
"""Of the values of an order parameter, up to which it counts as 0."""


@dataclass(config=settings, eq=False, kw_only=True)
class Exclusion(Component):
    """Several order parameters of which one alone is to be anywhere: energy ``strength sum_(i < j) a_i^2 a_j^2``.

    Each is an `AllenCahn` body of its own on the same mesh. With free energies ``m (a^4 / 4 - a^2 / 2)`` and the
    strength ``3 m / 2`` they are grains, between which ``a_i + a_j = 1`` (Chen & Yang 1994; Moelans et al. 2008).

    Parameters
    ----------
    bodies : list of AllenCahn
        Two at least.
    strength : float
        Per volume. The larger it is, the thinner are boundaries; those that less than two cells resolve are refused.

    Notes
    -----
    The discrete gradient of every product is ``(a_i0 + a_i1) (a_j0^2 + a_j1^2) / 2``: with the energy-momentum scheme
    the sum of all energies falls in every step by exactly what relaxation dissipates.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> def grain(sign):
    ...     return vv.AllenCahn(
    ...         mesh=vv.RectangleMesh(size=(8, 1), counts=(32, 4), origin=(-4, 0)),
    ...         free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25)),
    ...         gradient_energy=0.5,
    ...         order=lambda X: 0.5 + 0.5 * sign * np.tanh(X[:, 0]),
    ...     )
    >>> left, right = grain(-1), grain(1)
    >>> system = vv.System([left, right, vv.Exclusion(bodies=[left, right], strength=1.5)])
    >>> result = vv.simulate(system, until=5.0, step=0.5)
    >>> bool(np.abs(left.values(system.x) + right.values(system.x) - 1).max() < 0.01)
    True
    """

    bodies: list[AllenCahn]
    strength: Number

    def __post_init__(self) -> None:
        if not self.strength > 0:
            raise InputError(f"{self.label}: strength = {self.strength:g} is not positive")
        if len({id(b) for b in self.bodies}) != len(self.bodies) or len(self.bodies) < 2:
            raise InputError(f"{self.label}: bodies needs two different order parameters at least")
        first = self.bodies[0]
        for other in self.bodies[1:]:
            pairs = zip(first.space.cells(), other.space.cells(), strict=False)
            same = first.space.size == other.space.size and len(first.space.cells()) == len(
                other.space.cells()
            )
            if not same or not all(
                np.array_equal(a.X, b.X) and np.array_equal(a.numbers, b.numbers) for a, b in pairs
            ):
                raise InputError(
                    f"{self.label}: {first.label} and {other.label} are not on the same mesh, with the same periodic "
                    "sides"
                )
            if first.thickness != other.thickness:
                raise InputError(
                    f"{self.label}: {first.label} has thickness = {first.thickness:g}, {other.label} "
                    f"{other.thickness:g}: what excludes each other fills the same volume; give both the same"
                )
        for time in sorted({0.0, *(t for body in self.bodies for t in body.free_energy.turns)}):
            self._refuse_thin(time)
        self._resolved: frozenset[tuple[int, ...]] = frozenset({()})

    def _boundaries(self, time: float) -> Iterator[tuple[AllenCahn, AllenCahn, float]]:
        """Order parameters, and how wide the boundary of both is; of pairs that are alike one is looked at."""
        seen: list[tuple[Side, Side]] = []
        for one, other in combinations(self.bodies, 2):
            for sides in across(one, other, time):
                if sides not in seen:
                    seen.append(sides)
                    yield one, other, float(widths(sides, self.strength).min())

    def _refuse_thin(self, time: float) -> None:
        """Refuse boundaries that less than two cells resolve."""
        spacing, when = self.bodies[0].space.spacing, f" at t = {time:g}" if time else ""
        for one, other, width in self._boundaries(time):
            wider = 2 * spacing / width
            if wider > 1 + ROUGHLY:
                raise InputError(
                    f"{self.label}: with strength = {self.strength:g} the boundary of {one.label} and "
                    f"{other.label} is {width:.3g} wide{when}, the distance of their nodes {spacing:.3g}: less "
                    f"than two cells resolve it; take cells of {width / 4:.2g}, a smaller strength, or gradient "
                    f"energies {wider * wider:.3g} times as large"
                )

    def remarks(self) -> list[str]:
        first, least = self.bodies[0], min(width for _, _, width in self._boundaries(0.0))
        return held_back(f"{self.label}: boundaries", first, least, first.space.spacing)

    def announce(self, model: Model) -> None:
        for body in self.bodies:
            model.announce(body, self)

    def contribute(self, model: Model) -> None:
        for body in self.bodies:
            model.index(body)
        for table in self.bodies[0].space.cells():
            starts = [body.phase.start for body in self.bodies]
            model.term(self, Products(table, starts, self.strength, self._watch))

    def _watch(self, time: float) -> None:
        """Refuse boundaries that are too thin at a time: they are looked at once for all temperatures nearby."""
        heated = [body.free_energy for body in self.bodies if body.free_energy.changes]
        now = tuple(warmth(energy, time) for energy in heated)
        if now not in self._resolved:
            self._refuse_thin(time)
            self._resolved |= {now}


def across(one: AllenCahn, other: AllenCahn, time: float) -> Iterator[tuple[Side, Side]]:
    """Both sides of the boundary of two order parameters, in principal directions of their gradient energies."""
    for direction in np.hstack([np.linalg.eigh(body._stiffness)[1] for body in (one, other)]).T:
        yield side(one, direction, time), side(other, direction, time)


def side(body: AllenCahn, direction: Array, time: float) -> Side:
    """An order parameter on its side of a boundary across a direction at a time."""
    values: tuple[float, ...] = (float(body.start_values.min()), float(body.start_values.max()))
    if (found := body.interface(time)) is not None:
        values = found.low, found.high
        if max(abs(found.low + found.high) / (found.high - found.low), abs(found.tilt)) < LEVEL:
            values = values[1:]  # the other is its mirror image
    most = max(abs(c) for c in values)
    present = tuple(c for c in values if abs(c) > ABSENT * most)
    return Side(body.free_energy.at(time), float(direction @ body._stiffness @ direction), present)


class Products(Term):
    """``strength a_i^2 a_j^2`` of all pairs at the points of elements; unknowns are grouped by order parameter."""

    kind = "exclusion"

    def __init__(
        self, table: Table, starts: Sequence[int], strength: float, watch: Callable[[float], None]
    ) -> None:
        super().__init__()
        self.table, self.n, self.strength, self.watch = table, len(starts), strength, watch
        self.unknowns = np.hstack([start + table.numbers for start in starts]).astype(np.int32)
        self.order = np.ones(self.unknowns.shape[1], dtype=np.int32)

    def at_points(self, x: Array) -> Array:
        """Order parameters (m, n, q) at points."""
        return np.asarray(np.einsum("mqk,mnk->mnq", self.table.N, x.reshape(len(x), self.n, -1)))

    def energy(self, s: Stencils) -> Array:
        a = self.at_points(s.x1) ** 2
        pairs = 0.5 * (a.sum(axis=1) ** 2 - (a**2).sum(axis=1))
        return np.asarray(self.strength * np.einsum("mq,mq->m", self.table.size, pairs))

    def residual(self, s: Stencils) -> Array:
        self.watch(s.step.te)
        double, others, _, _ = self.parts(s)
        forces = self.strength * self.table.size[:, None] * double * others
        return np.asarray(np.einsum("mnq,mqk->mnk", forces, self.table.N)).reshape(s.x1.shape)

    def tangent(self, s: Stencils) -> Array:
        double, others, by_own, by_others = self.parts(s)
        D = double[:, :, None] * by_others[:, None]  # (m, i, j, q)
        own = np.arange(self.n)
        D[:, own, own] = by_own * others
        D *= self.strength * self.table.size[:, None, None]
        K = np.asarray(np.einsum("mijq,mqk,mql->mikjl", D, self.table.N, self.table.N, optimize=True))
        return K.reshape(len(D), self.unknowns.shape[1], -1)

    def parts(self, s: Stencils) -> tuple[Array, Array, float, Array]:
        """Of the force ``double_i others_i`` (m, n, q): both factors, and what they change by with the end's values."""
        if s.step.discrete_gradient:
            a0, a1 = self.at_points(s.x0), self.at_points(s.x1)
            squares, double, by_own, by_others = 0.5 * (a0**2 + a1**2), a0 + a1, 1.0, a1
        else:
            a, theta = self.at_points(s.x), s.step.theta
            squares, double, by_own, by_others = a**2, 2 * a, 2 * theta, 2 * theta * a
        return double, squares.sum(axis=1, keepdims=True) - squares, by_own, by_others
