"""Bodies carried by the fluid around them: places that follow its velocities, and the fluid they displace."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.component.announcements import Wetting
from visviva.component.component import settings, system_of
from visviva.flow.fluid import Fluid
from visviva.flow.leaving import Displaced, gone_through
from visviva.flow.location import Place
from visviva.flow.sheet import THIN, extents_around, thin
from visviva.flow.transfer import Transfer
from visviva.mesh.geometry import cell_axes
from visviva.model.batch import book

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.component.component import RateConstraints
    from visviva.model.field import Field
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Cells = NDArray[np.int64]
Mask = NDArray[np.bool_]


THIN_DAMPING, THIN_TANGENTS = 0.05, 2
"""Default settings of bodies thinner than a cell, see `Immersed` and `Newton`."""
BARELY = 2.0
"""Bodies thicker than this times a thin one everywhere are taken not to become thin."""
NEARBY = 1e-5
"""Part of a cell's edge over which changes of the velocity along the way of a point are measured."""
AHEAD, MARGIN = 3, 0.45
"""The sparsity pattern of the coupling covers this many further steps at the present velocity, plus this part of a
cell's edge."""


@dataclass(config=settings, eq=False, kw_only=True)
class Carried(Wetting):
    """Base of bodies whose points follow a `fluid`, ahead by the part `damping` of a step's change of velocity.

    The fluid's elements around are stabilised less, by a metric that is larger by the factor `sealing`. What covers
    a part of the fluid's boundary is refused unless `over_walls`, and so is what leaves the fluid unless it `leaves`.
    """

    fluid: Fluid
    damping: float | None = None
    sealing: float = 1.0
    over_walls: bool = False
    leaves: bool = False
    contributes_last = True

    def __post_init__(self) -> None:
        if not 1.0 <= self.sealing < np.inf:
            raise InputError(f"{self.label}: sealing = {self.sealing} is not a number from 1")
        if self.sealing > 1 and not self.fluid.is_stabilised:
            raise InputError(
                f"{self.label}: sealing = {self.sealing:g} is for stabilised elements; leave it out, "
                f"those of {self.fluid.label} are not"
            )
        if self.damping is not None and not 0.0 <= self.damping <= 0.5:
            raise InputError(f"{self.label}: damping = {self.damping} is not a number from 0 to 0.5")

    def _places(self) -> Array:
        """Its points (n, d) at the start."""
        raise NotImplementedError

    @cached_property
    def _edge(self) -> float:
        """Edge of a square or cube as large as the cells around its points at the start."""
        cells = self._located(self._places()).cells
        return float(np.median(self.fluid.grid.volumes[cells]) ** (1 / self.fluid.dimension))

    @cached_property
    def _axes(self) -> Array:
        """Edges (n, d, d) by columns of cells that are made squares and cubes, so that they turn with the mesh."""
        return cell_axes(self.fluid.grid)

    @cached_property
    def may_be_thin(self) -> bool:
        """True if the body is somewhere thin at the start, or hardly thicker than the limit for thin bodies."""
        extents, _ = extents_around(self._places(), self._edge)
        return bool(thin(extents, BARELY * THIN * self._edge).any())

    @property
    def used_damping(self) -> float:
        """Value given by the user, or the default of thin bodies."""
        return (THIN_DAMPING if self.is_thin else 0.0) if self.damping is None else self.damping

    @property
    def least_tangents(self) -> int:
        return THIN_TANGENTS if self.is_thin else 0

    def declare(self, model: Model) -> None:
        model.index(self.carried), model.index(self.fluid)
        self._gravity = np.zeros(self.fluid.dimension)
        self._displaced_fluid: list[tuple[Ints, Array]] = []
        if model.announced(self.carried, Carried) != [self]:
            raise InputError(f"{self.label}: {self.carried.label} is immersed twice")

    def _follow(
        self, model: Model, vectors: Ints, weights: Array, multipliers: Cells, held: Mask | None = None
    ) -> None:
        """Let points, sums of vectors with first unknowns (n, k) and weights (n, k), move as the fluid does.

        What is `held` (n, d) does not, nor does the fluid there.
        """
        transfer = self.fluid.transfer
        reach = self._reacher(transfer) if self._tells_reach else None
        n = len(multipliers)
        self._points = vectors.reshape(n, -1), weights.reshape(n, -1), multipliers
        # which the core does not keep alive
        self._calls = self._finder(transfer), self._lost, self._coupler(transfer), reach
        term = _core.ImmersedTerm(
            self.fluid.dimension,
            transfer.width,
            self.used_damping,
            self.leaves,
            np.ascontiguousarray(vectors, dtype=np.int32),
            np.ascontiguousarray(weights, dtype=float),
            np.ascontiguousarray(multipliers, dtype=np.int32),
            np.zeros((n, self.fluid.dimension), dtype=bool) if held is None else held,
            *self._calls,
        )
        term.name = self.label
        self.term = term
        lost = model.account(self, "immersed damping", "dissipation")
        book(term, [model.account(self, "constraint", "constraint"), lost], [model.index(self)] * 2, 2)
        model.batch(term)

    @property
    def displaced_fluid(self) -> list[tuple[Ints, Array]]:
        return self._displaced_fluid

    def _take_away(
        self, model: Model, vectors: Ints, mass: Array, is_place: Mask, share: Callable[[], Array | None]
    ) -> None:
        """Take away the inertia of fluid, by negative masses (m, k, k) between vectors with first unknowns (m, k).

        Of what leaves the fluid, by the `share` (m,) of each that is within.
        """
        d, account = self.fluid.dimension, model.account(self, "displaced", "kinetic")
        m, k = vectors.shape
        unknowns = np.asarray(vectors[:, :, None] + np.arange(d), dtype=np.int32)
        self._displaced_fluid.append((unknowns, mass))
        if self.leaves:
            model.term(self, Displaced(unknowns.reshape(m, -1), mass, is_place, share, lambda: self._gravity))
            return
        pairs = np.argwhere((mass != 0).any(axis=0))
        term = _core.InertiaTerm(
            2,
            k,
            d,
            np.ascontiguousarray(pairs, dtype=np.int32),
            np.ascontiguousarray(mass[:, pairs[:, 0], pairs[:, 1]].T),
            np.ascontiguousarray(unknowns.reshape(m, -1).T),
            is_place.astype(np.int32),
        )
        book(term, [account] * m, [model.index(self)] * m, m)
        model.batch(term)

    @property
    def costs(self) -> dict[str, float]:
        """CPU seconds that finding its points in the fluid has taken so far, and what they may follow later."""
        return {"location": self.term.location}

    @property
    def _within(self) -> Mask | None:
        """Mask of points (n,) that the fluid holds in the step evaluated last, None before any."""
        return self.term.within

    def _located(self, places: Array) -> Place:
        """Position in the fluid of places (n, d) of the start."""
        found = self.fluid.find(places)
        if np.any(found[0] < 0):
            where = self._outside(places[np.argmin(found[0])])
            raise InputError(f"{self.label}: {self.carried.label} {where}")
        return Place(self.fluid, places, found)

    def _velocities(self, places: Place, flow: Array) -> Array:
        """Velocities (n, d) of the fluid with the unknowns `flow` at places."""
        unknowns, weights = self.fluid.transfer.at(places)
        nodal = flow[unknowns[:, :, None] - self.fluid.flow.start + np.arange(self.fluid.dimension)]
        return np.asarray(np.einsum("nk,nkc->nc", weights, nodal))

    def rate_constraints(self, state: State) -> RateConstraints | None:
        """Points are accelerated as the fluid they move with."""
        import scipy.sparse as sp

        d, (vectors, weights, multipliers) = self.fluid.dimension, self._points
        axes = np.arange(d)
        own, move = (
            np.einsum("nk,nkc->nc", weights, y[vectors[:, :, None] + axes]) for y in (state.x, state.v)
        )
        unknowns, shares = self.fluid.transfer.at(self._located(own))
        n, shape = len(own), (d * len(own), len(state.x))

        def spread(first: Ints, by: Array) -> sp.csr_array:
            columns = first[:, None, :] + axes[:, None]
            rows = np.broadcast_to(np.arange(d * n).reshape(n, d, 1), columns.shape)
            values = np.broadcast_to(by[:, None, :], columns.shape)
            return sp.coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsr()

        ahead = self._carried_along(own, move, state.x)
        gradients = spread(vectors, weights) - spread(unknowns, shares)
        return (multipliers[:, None] + axes).ravel(), gradients, ahead.ravel()

    def _carried_along(self, places: Array, velocities: Array, x: Array) -> Array:
        """Rate of the fluid's velocity (n, d) seen by moving points, at the unknowns `x` of the system."""
        edge = float(np.min(self.fluid.grid.volumes)) ** (1 / self.fluid.dimension)
        span = NEARBY * edge / max(float(np.abs(velocities).max()), 1e-300)
        ends = [places + side * span * velocities for side in (-0.5, 0.5)]
        for end in ends:
            end[self.fluid.find(end)[0] < 0] = np.nan
        inside = ~np.isnan(ends[0] + ends[1]).any(axis=1)
        before, after = (
            self._velocities(
                self._located(np.where(inside[:, None], end, places)), x[self.fluid.flow.unknowns]
            )
            for end in ends
        )
        return np.asarray((after - before) / span)

    def _finder(self, transfer: Transfer) -> Callable[[Array, Array], tuple[Ints, Array]]:
        def find(starts: Array, places: Array) -> tuple[Ints, Array]:
            cells, xi = self.fluid.find(places)
            strays = [k for k in np.flatnonzero(cells < 0) if self._wrong_way(starts[k], places[k])]
            if strays:  # predicted badly: they follow the fluid from where they are
                cells[strays], xi[strays] = self.fluid.find(starts[strays])
            within = cells >= 0
            unknowns = np.full((len(places), transfer.width), self.fluid.flow.start, dtype=np.int32)
            weights = np.zeros(unknowns.shape)
            unknowns[within], weights[within] = transfer.at(
                Place(self.fluid, places[within], (cells[within], xi[within]))
            )
            return unknowns, weights

        return find

    def _lost(self, starts: Array, ends: Array) -> tuple[int, str] | None:
        """A point that may not end a step where it would, and why."""
        for k in np.flatnonzero(self.fluid.find(ends)[0] < 0):
            if why := self._wrong_way(starts[k], ends[k]):
                return int(k), f"{self.point_name(int(k))} {self._outside(ends[k])}, {why}"
        return None

    def _wrong_way(self, start: Array, place: Array) -> str:
        """Why a point may not go from a place (d,) to one outside: only through openings, and if the body leaves."""
        if self.leaves and self.fluid.find(start[None, :])[0][0] < 0:
            return ""  # it has left before
        wall, is_open = gone_through(self.fluid, place, self._time or 0.0)
        if self.leaves and is_open:
            return ""
        cure = "leaves=True lets go of it there" if is_open else "keep it away by shorter steps or vv.Contact"
        return f"beyond {'its mesh' if wall is None else wall.label}; {cure}"

    def point_name(self, k: int) -> str:
        """A point by its number, for messages."""
        return f"point {k} of {self.carried.label}"

    def _coupler(self, transfer: Transfer) -> Callable[[Array, Array], tuple[Ints, Ints]]:
        def couple(places: Array, moves: Array) -> tuple[Ints, Ints]:
            return self._around(transfer, places, np.arange(0, AHEAD + 0.25, 0.5), moves)

        return couple

    def _around(self, transfer: Transfer, places: Array, ahead: Array, moves: Array) -> tuple[Ints, Ints]:
        """First unknowns of the fluid's cells at and around places after `ahead` moves, see `Transfer.within`."""
        n, d = places.shape
        inside = self.fluid.find(places)[0]
        axes = np.where((inside >= 0)[:, None, None], self._axes[inside], 0.0)
        corners = np.array(list(itertools.product((-1, 1), repeat=d)))
        around = MARGIN * np.einsum("nij,cj->cni", axes, corners)
        cells, _ = self.fluid.find((places + around + ahead[:, None, None, None] * moves).reshape(-1, d))
        points = np.broadcast_to(np.arange(n), (len(ahead), len(corners), n)).ravel()
        return transfer.within(n, points[cells >= 0], cells[cells >= 0])

    @property
    def _tells_reach(self) -> bool:
        """True if the fluid's elements around it need another stabilisation."""
        return self.fluid.is_stabilised and (self.sealing > 1 or self.may_be_thin)

    def _reacher(self, transfer: Transfer) -> Callable[[Array], None]:
        def reach(places: Array) -> None:
            _, unknowns = self._around(transfer, places, np.zeros(1), np.zeros_like(places))
            if self.sealing > 1:
                self.fluid.seal(self, self.sealing, unknowns)
            if self.may_be_thin:
                self.fluid.blind(self, unknowns, places)

        return reach

    def _outside(self, place: Array) -> str:
        where = ", ".join(f"{c:.4g}" for c in place)
        when = "" if self._time is None else f" in the step from t = {self._time:g}"
        return f"lies outside of {self.fluid.label} at ({where}){when}"

    @property
    def _time(self) -> float | None:
        system = system_of(self)
        return None if system is None else float(system.time)

    def _forces(self, force: Field, x: Array) -> Array:
        """Forces (n, 3) of the fluid on the points at the unknowns `x` of the system."""
        d = self.fluid.dimension
        values = -x[force.start : force.start + force.size].reshape(-1, d)
        return np.pad(values, ((0, 0), (0, 3 - d)))
