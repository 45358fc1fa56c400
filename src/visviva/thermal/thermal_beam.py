"""Beams that conduct heat: mean temperatures of their sections and slopes across them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.places import of_places
from visviva.body.beam import Beam
from visviva.body.beam_shapes import shape_of
from visviva.body.mesh_points import Points
from visviva.body.profiles import Profile
from visviva.component.component import Component, settings
from visviva.component.values import Function, Number, NumberAtPlace
from visviva.model.entropies import PRODUCED
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.carrier import EntropyInput, GivenTemperatures, HeatCarrier, HeatPort, Law, known_part
from visviva.thermal.celsius import refuse_below_zero
from visviva.thermal.heat import Heat
from visviva.thermal.held_step import HeldStep
from visviva.thermal.projection import Projected, Projection
from visviva.thermal.thermoelastic_checks import strained_at_the_start

if TYPE_CHECKING:
    from visviva.mesh.faces import Faces
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
ENDS = np.array([-1.0, 1.0])


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalBeam(Beam, HeatCarrier):
    """A beam whose sections have a mean temperature and its slopes along d1 and d2: they stretch and bend it.

    Takes the arguments of `Beam`, with homogeneous profiles, and

    Parameters
    ----------
    heat : Heat
        Of the material. Its `moduli_slope` and what depends on the temperature are not for beams.
    temperature : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,), optional
        Mean at the start, absolute; by default the reference of `heat`.
    slopes : (2,), or a function of reference positions (n, 3) with values (n, 2)
        Of the temperature along d1 and d2 at the start.

    Notes
    -----
    With the stiffness C of the section and strains e the free energy per length is
    ``e.C e / 2 - (T - T0) m.e - T_1 m_1.e - T_2 m_2.e + c A <T - T0 - T ln(T / T0)>``, where m, m_1 and m_2 are C times
    the strain and the curvatures that heat alone would leave: it expands, and a difference across the section curves
    it. The mean <> is that of four points as far from the axes of the section as its radii of gyration: its area and
    second moments are theirs, so that slopes store heat and even out at any temperature. Temperatures are linear in
    each cell. Heat flows along by all three temperatures, and evens the slopes out across the section. The sides are
    insulated but for `HeatSource`, a power per length, and `HeatExchange`; nodes within cells of three and four nodes
    take it by the temperatures of the ends of their cell, and are held together with these alone.
    Energy and entropy are those of `ThermoelasticSolid`: kept to round-off, and never falling.

    Examples
    --------
    >>> import visviva as vv
    >>> bar = vv.ThermalBeam(
    ...     mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=10),
    ...     section=vv.RectangleSection(width=0.1, height=0.1, young=210e9, density=7850.0),
    ...     heat=vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1.2e-5),
    ...     temperature=lambda X: 300 + 50 * X[:, 0],
    ... )
    >>> system = vv.System([bar, vv.Clamped(solid=bar, nodes="start")])
    >>> float(bar.temperatures(system.x).max().round(1))
    350.0
    """

    heat: Heat
    temperature: NumberAtPlace | None = None
    slopes: tuple[Number, Number] | Function = (0.0, 0.0)
    balances_entropy = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._refuse_others()
        n, heat = self.grid.n_nodes, self.heat
        given = heat.reference if self.temperature is None else self.temperature
        found = given(self.points.copy()) if callable(given) else given
        self.start_temperatures = np.array(np.broadcast_to(np.asarray(found, dtype=float), n))
        across = (
            of_places(self.label, "slopes", self.slopes, self.points, (n, 2))
            if callable(self.slopes)
            else self.slopes
        )
        self.start_slopes = np.array(np.broadcast_to(across, (n, 2)))
        self._refuse_below_zero(self.label, self.start_temperatures, self.start_slopes)

    def remarks(self) -> list[str]:
        young = float((self.stiffness[:, 2, 2] / self._areas).max())
        return [
            *super().remarks(),
            *strained_at_the_start(self.label, self.heat, young, self.start_temperatures),
        ]

    def _refuse_below_zero(self, label: str, T: Array, across: Array) -> None:
        """Mean temperatures (n,) and slopes (n, 2), at the contour of the section."""
        least = float((T[:, None] + across @ self.sections[0].contour().T).min(initial=np.inf))
        refuse_below_zero(label, least)

    def _refuse_others(self) -> None:
        heat = self.heat
        for section in self.sections:
            if not isinstance(section, Profile):
                raise InputError(
                    f"{self.label}: {type(section).__name__} does not say where its material is; heat needs a "
                    "homogeneous profile, such as vv.RectangleSection"
                )
        if np.any(self._damping != 0) or self._held_strains:
            raise InputError(f"{self.label}: takes no damping and no rigid strains")
        if (
            heat.moduli_slope
            or heat.conductivity_slope
            or not heat.stores.is_constant
            or not heat.is_isotropic
        ):
            raise InputError(
                f"{self.label}: moduli, capacity and conductivity of beams are constant and isotropic; take a "
                "ThermoelasticSolid for others"
            )

    # --- its temperatures ----------------------------------------------------------------------------------
    @cached_property
    def _corners(self) -> Ints:
        """Nodes (c,) that have temperatures: ends of cells."""
        return np.unique(self.line.cells[:, :2])

    @cached_property
    def _place(self) -> Ints:
        """Of every node (n,) among those, or -1."""
        place = np.full(self.grid.n_nodes, -1)
        place[self._corners] = np.arange(len(self._corners))
        return place

    @cached_property
    def _to_ends(self) -> Array:
        """Shares (k, 2) of the temperatures at the ends of a cell in those at its nodes."""
        xi = shape_of(self.line.kind).nodes[:, 0]
        return np.column_stack([0.5 * (1 - xi), 0.5 * (1 + xi)])

    def declare(self, model: Model) -> None:
        super().declare(model)
        nodes, heat = self._corners, self.heat
        T, across = self.start_temperatures[nodes], self.start_slopes[nodes]
        A, c = self._areas[0], heat.stores.c
        s = self._entropies(T, across)
        extent = self._radii[0]
        n = len(nodes)
        scale, least = np.tile(c * A * np.concatenate([[1.0], extent]), n), known_part(T, heat.reference)
        self.entropy = model.field(self, "entropy", s, role=Role.CONTENT, scale=scale, node=3, least=least)
        values = np.column_stack([T, across])
        sizes = np.tile(heat.reference * np.concatenate([[1.0], 1 / extent]), n)
        self.algorithmic = model.field(
            self, "temperature", values, role=Role.TEMPERATURE, scale=sizes, node=3
        )
        self._refuse_unlike()

    def _refuse_unlike(self) -> None:
        if np.ptp(self._areas) > 1e-12 * self._areas.max() or np.any(
            np.ptp(self._second_moments, axis=0) > 1e-12 * self._second_moments.max()
        ):
            raise InputError(f"{self.label}: its sections are not alike; give each a ThermalBeam of its own")

    @cached_property
    def _areas(self) -> Array:
        return self.by_cell(lambda s: s.area)

    @cached_property
    def _second_moments(self) -> Array:
        """Integrals (m, 2) of the squares of the coordinates along d1 and d2."""
        return self.by_cell(lambda s: s.second_moments)

    @cached_property
    def _radii(self) -> Array:
        """Radii of gyration (m, 2) along d1 and d2: how far from the axes the points of the sections are."""
        return np.sqrt(self._second_moments / self._areas[:, None])

    def _entropies(self, T: Array, across: Array) -> Array:
        """Entropies (n, 3) of mean temperatures (n,) and slopes (n, 2) without strains."""
        radii, own = self._radii[0], self.heat.stores.c * self._areas[0]
        by = np.arctanh(radii * across / T[:, None])
        mean = np.log(T / self.heat.reference) - np.log(np.cosh(by)).sum(axis=1)
        return np.asarray(own * np.column_stack([mean, radii * by]))

    def _unknowns(self, nodes: Ints, first: int) -> Ints:
        return np.asarray(first + 3 * self._place[nodes])

    # --- what it contributes -------------------------------------------------------------------------------
    def contribute(self, model: Model) -> None:
        self._conducts: list[Any] = []
        self._content = np.zeros(len(self._corners))
        super().contribute(model)
        self._means = self.entropy.start + 3 * np.arange(len(self._corners))
        account = model.account(self, "conduction", PRODUCED)
        model.entropies.store(self._means, self._content, self._means, account, self._conducts)

    @cached_property
    def _heat_places(self) -> tuple[Array, Array]:
        """Coordinates (q,) of the points, and lengths (m, q) that they stand for.

        Cells of two nodes have one point for strains, which would leave one temperature undone, and two for heat.
        """
        xi, length = self._strains.places, self._strains.length
        if len(xi) > 1:
            return xi, length
        return np.polynomial.legendre.leggauss(2)[0], np.repeat(0.5 * length, 2, axis=1)

    def _add_strained(self, model: Model, cells: Ints) -> None:
        nodes = self.line.cells[cells]
        groups = self._strains.groups(cells, self.node_unknowns(nodes), self.director_unknowns(nodes))
        reference = self._strains.reference[cells]
        xi, length = self._heat_places[0], self._heat_places[1][cells]
        if len(xi) > reference.shape[1]:
            groups = [Group(g.unknowns, np.repeat(g.weights, 2, axis=1), None, g.is_position) for g in groups]
            reference = np.repeat(reference, 2, axis=1)
        _, _, speed = self.line.slopes(xi[:, None])
        scalar = np.empty((len(cells), len(xi), 2, 2))
        scalar[..., 0] = 0.5 * (1 + xi[:, None] * ENDS)
        scalar[..., 1] = 0.5 * ENDS / speed[cells][:, :, None]
        ends = nodes[:, :2]
        groups += [Group(self._unknowns(ends, f.start), scalar) for f in (self.entropy, self.algorithmic)]
        all_strains = np.concatenate([reference, np.zeros((*reference.shape[:2], 12))], axis=2)
        at_points = np.repeat(self._parameters(cells)[:, None], len(xi), axis=1)
        term = add_points(model, self, PhysicsKind.HEATED_BEAM, groups, length, at_points, all_strains)
        self._conducts.append(term)
        np.add.at(self._content, self._place[ends], np.einsum("mq,mqk->mk", length, scalar[..., 0]))

    @cached_property
    def _thermal(self) -> Array:
        """Forces and moments (m, 3, 6) by the strain, and its slopes, that heat leaves: z + x2 K1 - x1 K2."""
        C = self.stiffness
        return np.stack([C[:, 2], -C[:, 4], C[:, 3]], axis=1)

    def _parameters(self, cells: Ints) -> Array:
        """See ``visviva/point/heat_stores.hpp``: (m, p)."""
        heat, C = self.heat, self.stiffness[cells]
        a, b = np.triu_indices(6)
        A = self._areas[cells, None]
        c, k = heat.stores.c, float(np.asarray(heat.conductivity))
        coupling = [heat.expansion * m for m in self._thermal[cells].swapaxes(0, 1)]
        zero = np.full_like(A, heat.reference)
        return np.hstack(
            [
                C[:, a, b],
                *coupling,
                c * A,
                zero,
                self._radii[cells],
                k * A,
            ]
        )

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        held, (ends, _) = self._place[given.nodes] >= 0, self._ends_of(given.nodes)
        lost = np.flatnonzero(~held & ~np.isin(ends, given.nodes).all(axis=1))
        if len(lost):
            a, b = ends[lost[0]]
            raise InputError(
                f"{owner.label}: node {given.nodes[lost[0]]} of {self.label} lies within a cell, and is as warm as the "
                f"ends of that, nodes {a} and {b}, make it; hold these"
            )
        nodes, now = given.nodes[held], given.values(0.0)[held]
        self._refuse_below_zero(owner.label, now, self.start_slopes[nodes])
        at = 3 * self._place[nodes]
        self.entropy.values.reshape(-1, 3)[self._place[nodes]] = self._entropies(
            now, self.start_slopes[nodes]
        )
        self.algorithmic.values[at] = now
        model.refresh(self.entropy)
        model.refresh(self.algorithmic)
        supply = model.multipliers(owner, "supply", len(nodes), instantaneous=False)
        unknowns = [self.entropy.start + at, self.algorithmic.start + at, np.asarray(supply.unknowns)]
        table = np.asarray(np.stack(unknowns, axis=1), dtype=np.int32)
        model.term(
            owner, HeldStep(table, lambda t: given.values(t)[held], lambda x: self.temperatures(x)[nodes])
        )

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        ends = points.nodes[:, :2]
        linear = Points(nodes=ends, N=points.N @ self._to_ends, X=points.X, size=points.size)
        unknowns = np.hstack([self._unknowns(ends, f.start) for f in (self.entropy, self.algorithmic)])
        model.term(owner, EntropyInput(kind, np.asarray(unknowns, dtype=np.int32), linear, law))

    def temperature_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return self._unknowns(nodes, self.algorithmic.start).astype(np.int32)

    def balance_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return self._unknowns(nodes, self.entropy.start).astype(np.int32)

    def heat_port(self, nodes: Ints, weights: Array, modes: Array | None = None) -> HeatPort:
        ends, shares = self._ends_of(nodes)
        total = np.zeros(self.grid.n_nodes)
        np.add.at(total, ends, weights[:, None] * shares)
        found = np.flatnonzero(total)
        return super().heat_port(found, total[found], modes)

    def _ends_of(self, nodes: Ints) -> tuple[Ints, Array]:
        """Corners (k, 2) by whose temperatures nodes (k,) have theirs, and the shares (k, 2) of both."""
        cells = self.line.cells
        order = np.argsort(cells, axis=None)  # of a node its first place
        cell, a = np.divmod(order[np.searchsorted(cells.ravel(), nodes, sorter=order)], cells.shape[1])
        return cells[cell, :2], self._to_ends[a]

    def face_points(self, faces: Faces, *, on_sides: bool = False) -> Any:
        """There are none: a beam is a line.

        Raises
        ------
        InputError
        """
        raise InputError(
            f"{self.label} is a line; heat comes in by vv.HeatSource per length, or vv.HeatExchange"
        )

    # --- what it shows -------------------------------------------------------------------------------------
    @cached_property
    def _projection(self) -> Projection:
        xi, length = self._heat_places
        numbers, N = self._place[self.line.cells[:, :2]], 0.5 * (1 + xi[:, None] * ENDS)
        return Projection(len(self._corners), [Projected(numbers, N, length)])

    def section_temperatures(self, x: Array) -> Array:
        """Mean temperature and its slopes (n, 3) along d1 and d2 at the nodes, of strains and entropies."""
        return self._spread(self._projection([self._at_points(x)]))

    def _at_points(self, x: Array) -> Array:
        """Mean temperature and its slopes (m, q, 3) at the points where heat is balanced."""
        heat, part, radii = self.heat, self._projection.parts[0], self._radii[0]
        s = x[self.entropy.start : self.entropy.start + self.entropy.size].reshape(-1, 3)
        e = np.broadcast_to(self.strains(x), (*part.sizes.shape, 6))
        beside = part.N @ s[part.numbers] - heat.expansion * np.einsum("mik,mqk->mqi", self._thermal, e)
        y = beside / (heat.stores.c * self._areas[0] * np.array([1.0, *radii]))
        first, second = np.cosh(y[..., 1]), np.cosh(y[..., 2])
        by = [first * second, np.sinh(y[..., 1]) * second / radii[0], first * np.sinh(y[..., 2]) / radii[1]]
        return np.asarray(heat.reference * np.exp(y[..., :1]) * np.stack(by, axis=-1))

    def _spread(self, values: Array) -> Array:
        """Values (n, j) of all nodes by those of the corners."""
        found = np.empty((self.grid.n_nodes, values.shape[1]))
        for a, shares in enumerate(self._to_ends):
            found[self.line.cells[:, a]] = np.einsum(
                "j,mjc->mc", shares, values[self._place[self.line.cells[:, :2]]]
            )
        return found

    def temperatures(self, x: Array) -> Array:
        """Mean temperatures (n,) of the sections at the nodes, at the unknowns `x` of the system."""
        return np.asarray(self.section_temperatures(x)[:, 0])

    def total_entropy(self, x: Array) -> float:
        """Of the whole body at the unknowns `x` of the system."""
        return float(self._content @ x[self._means])

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        return {**super()._carried(), "temperature": self.temperatures}

    def resultants(self, x: Array) -> Array:
        """Forces and moments (m, q, 6) in the sections, with those that heat leaves."""
        heat, found, T = self.heat, super().resultants(x), self._at_points(x)
        if found.shape[1] < T.shape[1]:
            T = T.mean(axis=1, keepdims=True)  # of the points of heat about the one of strains
        rise = T - np.array([heat.reference, 0.0, 0.0])
        return np.asarray(found - heat.expansion * np.einsum("mqi,mik->mqk", rise, self._thermal))
