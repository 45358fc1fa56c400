"""Solids that deform and conduct heat: strain and entropy store energy together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.body import formulation as forms
from visviva.body.element import Geometry, solid_rule
from visviva.body.inverted import Upright
from visviva.body.mesh_points import Points
from visviva.body.solid import Solid
from visviva.body.solid_fields import Evaluated, of_each, summed
from visviva.body.solid_term import Elements
from visviva.body.stressed_cells import StressedCells
from visviva.component.announcements import shared_numbers
from visviva.component.component import Component, settings
from visviva.component.values import NumberAtPlace
from visviva.load.periodic_faces import shared_values
from visviva.material.material import Material
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import Rule, mass_rule
from visviva.model.entropies import PRODUCED
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.carrier import EntropyInput, GivenTemperatures, HeatCarrier, Law, known_part
from visviva.thermal.celsius import refuse_below_zero
from visviva.thermal.dilated_cells import CentreCells, PressedCells
from visviva.thermal.heat import Heat, HeatLaw
from visviva.thermal.held_step import HeldStep
from visviva.thermal.projection import Projected, Projection
from visviva.thermal.sheet_cells import SheetCells, resting_entropy
from visviva.thermal.thermoelastic_checks import coupling_remarks, refuse_others

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
POINTWISE = (
    PhysicsKind.THERMOELASTIC,
    PhysicsKind.THERMOELASTIC_IN_PLANE,
    PhysicsKind.THERMOELASTIC_OF_REVOLUTION,
)
DILATED = {
    "F-bar": (
        PhysicsKind.THERMOELASTIC_FBAR,
        PhysicsKind.THERMOELASTIC_FBAR_IN_PLANE,
        PhysicsKind.THERMOELASTIC_FBAR_OF_REVOLUTION,
    ),
    "mixed": (
        PhysicsKind.THERMOELASTIC_MIXED,
        PhysicsKind.THERMOELASTIC_MIXED_IN_PLANE,
        PhysicsKind.THERMOELASTIC_MIXED_OF_REVOLUTION,
    ),
}
"""Physics in space, in a plane and of revolution; with a change of volume that is not that of the point."""


@dataclass(config=settings, eq=False, kw_only=True)
class ThermoelasticSolid(Solid, Upright, HeatCarrier):
    """A solid whose nodes have entropies and temperatures beside positions.

    Takes the arguments of `Solid`, in space or in a plane, and

    Parameters
    ----------
    heat : Heat, or UserHeat
        How it stores and conducts heat. With `UserHeat` there is no `material`.
    temperature : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,), optional
        Absolute, at the start; by default the reference of `heat`.

    Notes
    -----
    The entropy per reference volume is a field of order 1; its balance is tested with the shape functions, and the
    temperature, a field of the same shape functions, is the algorithmic one of the step, ``D_s e``, weakly. With the
    energy-momentum scheme the total energy of an isolated body is kept to round-off, however temperatures differ from
    place to place, and its entropy never falls (partitioned discrete gradients: Romero 2010, Gross & Betsch 2011).
    The ledger books the internal energy as "stored". Where heat and strain couple strongly, ``alpha^2 E T / c`` beyond
    0.1, linear cells of displacements lock as those of nearly incompressible materials do: take another formulation, or
    quadratic ones. Temperatures of F-bar and mixed elements are those of the strain that their material feels. Mixed
    ones have the change of volume ln J as an unknown, and in the same space the pressures that make it that of the
    motion (Hu and Washizu): both laws hold as in elements of displacements.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1.2e-5)
    >>> block = vv.ThermoelasticSolid(
    ...     mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
    ...     material=vv.NeoHooke(young=210e9, poisson=0.3),
    ...     density=7850.0,
    ...     heat=steel,
    ...     temperature=lambda X: 300 + 50 * X[:, 0],
    ... )
    >>> system = vv.System([block])
    >>> float(block.temperatures(system.x).max().round())
    350.0
    """

    heat: HeatLaw
    material: Material | None = None  # type: ignore[assignment]
    temperature: NumberAtPlace | None = None
    balances_entropy = True

    def __post_init__(self) -> None:
        try:
            self.heat.material(self.material)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        super().__post_init__()
        given = self.heat.reference if self.temperature is None else self.temperature
        found = given(self.points.copy()) if callable(given) else given
        self.start_temperatures = np.array(np.broadcast_to(np.asarray(found, dtype=float), self.grid.n_nodes))
        refuse_below_zero(self.label, self.start_temperatures)
        self._refuse_others()

    @property
    def body_material(self) -> Material:
        return self.heat.material(self.material)

    def _refuse_others(self) -> None:
        refuse_others(self)
        if self._is_heated or self._is_damped or self.lumped:
            raise InputError(f"{self.label}: takes no thermal_strain, damping or lumped masses")

    def remarks(self) -> list[str]:
        return [*super().remarks(), *coupling_remarks(self)]

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        super().declare(model)
        self._number = shared_numbers(model, self)
        T = shared_values(self, "temperature", self._number, self.start_temperatures)
        s = self._resting_entropy(T)
        scale = float(np.abs(np.diff(self.heat.start_entropy(np.array([1.0, 2.0]) * self.heat.reference)))[0])
        least = known_part(T, self.heat.reference)
        self.entropy = model.field(self, "entropy", s, role=Role.CONTENT, scale=scale, least=least)
        self.algorithmic = model.field(
            self, "temperature", T, role=Role.TEMPERATURE, scale=self.heat.reference
        )
        if len(T) == self.grid.n_nodes:
            self.entropy.beside = self.algorithmic.beside = self.motion
        self._is_held = False

    def _declare_pressures(self, model: Model, own: Ints) -> None:
        """Make the change of volume, ln J, and behind each of its unknowns the pressure that tests it."""
        twice = np.repeat(own, 2)
        self._inner = model.field(self, "volume", 0.0 * twice, role=Role.STATE, stage=1, element=twice)

    def _vectors(self, nodes: Ints, first: int) -> Ints:
        """First unknowns (m, k) of the positions of cells, and of the modes that enhance their strains."""
        positions = self.node_unknowns(nodes)
        if self.formulation != "enhanced":
            return np.asarray(positions, dtype=np.int64)
        d, numbers = self.dimension, first + np.arange(len(nodes))
        modes = self._inner.start + d * d * numbers[:, None] + d * np.arange(d)
        return np.hstack([positions, modes])

    def _geometry(self, cell: str, nodes: Ints, rule: Rule | None = None) -> Geometry:
        g = super()._geometry(cell, nodes, rule)
        return forms.enhanced(self.grid.points, nodes, cell, g) if self.formulation == "enhanced" else g

    def _groups(self, cell: str, nodes: Ints, first: int, g: Geometry, rule: Rule) -> list[Group]:
        """Positions, entropies and temperatures of cells, with values and gradients of the latter, and what else."""
        N = CELLS[cell].N(rule.points)
        k = nodes.shape[1]
        gradients = g.gradients[:, :, :k]
        of_value = np.broadcast_to(N[None, :, :, None], (*gradients.shape[:3], 1))
        scalar = np.concatenate([of_value, gradients], axis=3)
        mass = self._cell_masses(cell, nodes) if self.density > 0 else None
        if mass is not None and self.formulation == "enhanced":
            mass = forms.without_mass(mass, k, self.dimension)
        of_vectors = g.columns
        if self.formulation == "F-bar":
            centre = np.broadcast_to(self._centre_of(cell, nodes).columns, of_vectors.shape)
            of_vectors = np.concatenate([of_vectors, centre], axis=3)
        groups = [
            Group(self._vectors(nodes, first), of_vectors, mass, True),
            Group(self.entropy.start + self._number[nodes], scalar),
            Group(self.algorithmic.start + self._number[nodes], scalar),
        ]
        if self.formulation == "mixed":
            shapes = forms.pressure_shapes(self.grid, cell, nodes, rule.points)[..., None]
            own = self._volumes(cell)
            groups = [groups[0], Group(own, shapes), *groups[1:], Group(own + 1, shapes)]
        return groups

    def _centre_of(self, cell: str, nodes: Ints) -> Geometry:
        """Gradients at the centres of cells."""
        return forms.centre(self.grid.points, nodes, cell, axisymmetric=self.axisymmetric)

    @property
    def averages(self) -> tuple[Ints, Ints]:
        """Pressures of mixed elements, and the changes of volume whose equations tell them at an instant."""
        if self.formulation != "mixed":
            return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        volumes = np.unique(np.concatenate([self._volumes(cell).ravel() for cell in self.grid.cells]))
        return volumes + 1, volumes

    def _volumes(self, cell: str) -> Ints:
        """Unknowns (m, p) of the change of volume of cells."""
        return np.asarray(self._inner.start + 2 * self._pressure_numbers[cell])

    def _stressed(self, cell: str, nodes: Ints, first: int, rule: Rule) -> StressedCells:
        g, N = self._geometry(cell, nodes, rule), CELLS[cell].N(rule.points)
        vectors = self._vectors(nodes, first)

        def entropies(x: Array, of: Ints) -> Array:
            return np.asarray(self._entropies(x)[of] @ N.T)

        def respond(x: Array, of: Ints, C: Array) -> tuple[Array, Array]:
            _, S, e = self._state(entropies(x, of), C)
            return S, e

        def deforming(x: Array, some: slice) -> Array:
            found = x[vectors[some, :, None] + np.arange(self.dimension)]
            return np.pad(found, ((0, 0), (0, 0), (0, 3 - self.dimension)))

        common = (nodes, g.gradients, g.volume, N, deforming, respond, g.hoop)
        if self.formulation == "F-bar":
            return CentreCells(*common, centre=self._centre_of(cell, nodes))
        if self.formulation == "mixed":
            shapes = forms.pressure_shapes(self.grid, cell, nodes, rule.points)
            return PressedCells(*common, shapes=shapes, numbers=self._volumes(cell))
        if self.plane == "stress":
            return SheetCells(*common, entropies=entropies, pull=self._pull)
        return StressedCells(*common)

    def _resting_entropy(self, T: Array) -> Array:
        """Entropies (k,) of temperatures (k,) without strain."""
        if self.plane == "stress":
            try:
                return resting_entropy(self.heat, self.body_material, T)
            except RunError as error:
                raise InputError(f"{self.label}: {error}") from None
        return self.heat.start_entropy(T)

    def _pull(self, C: Array, s: Array) -> Array:
        """Stress 33 (n,) of C (n, 6) and entropies (n,)."""
        return self.heat.respond(self.body_material, C, s)[1][:, 2]

    def _state(self, s: Array, C: Array) -> tuple[Array, Array, Array]:
        """Temperatures (m, q), stresses (m, q, 6) and energies (m, q) of entropies (m, q) and C (m, q, 6)."""
        T, S, e = self.heat.respond(self.body_material, C.reshape(-1, 6), s.ravel())
        return T.reshape(s.shape), S.reshape(C.shape), e.reshape(s.shape)

    def _made(self, model: Model, cell: str, nodes: Ints, first: int) -> Elements:
        rule = mass_rule(cell)  # the entropies' own rule would leave some of them without a temperature
        g = self._geometry(cell, nodes, rule)
        groups, constants = (
            self._groups(cell, nodes, first, g, rule),
            self.heat.parameters(self.body_material),
        )
        kind = g.chosen(DILATED.get(self.formulation, POINTWISE))
        if self.plane == "stress":
            kind = PhysicsKind.THERMOELASTIC_IN_SHEET
        energy = self.heat.energy(g.chosen((3, 2, 3)) if self.formulation == "F-bar" else 0)
        self._conducts.append(add_points(model, self, kind, groups, g.volume, constants, energy=energy))
        self._evaluations.append(self._stressed(cell, nodes, first, rule))
        shown = rule if self.formulation == "enhanced" else solid_rule(self.grid.points, nodes, cell)
        return self._stressed(cell, nodes, first, shown).elements(cell, first)

    def contribute(self, model: Model) -> None:
        self._elements, self._energy, self._starts_stress = [], None, False
        self._evaluations = []
        self._conducts: list[Any] = []
        first = 0
        for cell, nodes in self.grid.cells.items():
            self._elements.append(self._made(model, cell, nodes, first))
            first += len(nodes)
        unknowns, account = np.asarray(self.entropy.unknowns), model.account(self, "conduction", PRODUCED)
        sizes = self._integrals(np.abs)
        model.entropies.store(unknowns, self._content, unknowns, account, self._conducts, sizes)

    @property
    def _content(self) -> Array:
        """Integrals (k,) of the shape functions: what entropies weigh."""
        return self._integrals(np.asarray)

    def _integrals(self, of: Callable[[Array], Array]) -> Array:
        """Integrals (k,) of something of the shape functions."""
        total = np.zeros(self.entropy.size)
        for part in self._evaluations:
            np.add.at(total, self._number[part.nodes], part.volume @ of(part.N))
        return total

    def temperature_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.algorithmic.start + self._number[nodes], dtype=np.int32)

    def balance_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.entropy.start + self._number[nodes], dtype=np.int32)

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        shared = given.shared(owner.label, self._number)
        nodes, values = shared.nodes, shared.values
        now, self._is_held = values(0.0), True
        refuse_below_zero(owner.label, now)
        self.entropy.values[nodes] = self._resting_entropy(now)
        self.algorithmic.values[nodes] = now
        model.refresh(self.entropy)
        model.refresh(self.algorithmic)
        supply = model.multipliers(owner, "supply", len(nodes), instantaneous=False)
        of_nodes = [self.entropy.start + nodes, self.algorithmic.start + nodes, np.asarray(supply.unknowns)]
        table = np.asarray(np.stack(of_nodes, axis=1), dtype=np.int32)
        model.term(owner, HeldStep(table, values, lambda x: self._shared_temperatures(x)[nodes]))

    def start(self, state: State, scheme: Scheme) -> None:
        """Begin statics with one temperature, where none is held.

        What is steady does not depend on the start, but the iteration would first balance the entropy that differences
        of temperature make there, which what is held weakly loses only at quite other temperatures.
        """
        super().start(state, scheme)
        flows = any(np.any(row) for row in scheme.transport(1.0))
        if flows or self._is_held or not state.is_given or not np.ptp(self.start_temperatures):
            return
        mean = np.full(self.entropy.size, self.start_temperatures.mean())
        state.x[self.algorithmic.unknowns] = mean
        state.x[self.entropy.unknowns] = self._resting_entropy(mean)
        state.core.invalidate()

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        unknowns = np.hstack([self.balance_unknowns(points.nodes), self.temperature_unknowns(points.nodes)])
        model.term(owner, EntropyInput(kind, np.asarray(unknowns, dtype=np.int32), points, law))

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        return summed(self.grid, ((part.nodes, part.forces(x)) for part in self._evaluations), cells)

    # --- what it shows -------------------------------------------------------------------------------------
    def _evaluated(self, x: Array) -> Iterator[Evaluated]:
        return of_each(self._elements, x)

    @cached_property
    def _projection(self) -> Projection:
        parts = [Projected(self._number[part.nodes], part.N, part.volume) for part in self._evaluations]
        return Projection(self.entropy.size, parts)

    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the nodes at the unknowns `x` of the system.

        They are the projection of those of strain and entropy at the quadrature points, as the ones that conduct are.
        """
        return self._shared_temperatures(x)[self._number]

    def _shared_temperatures(self, x: Array) -> Array:
        """Temperatures (k,) of numbers that nodes share."""
        return self._projection([self._temperatures_at(x, part) for part in self._evaluations])

    def _temperatures_at(self, x: Array, part: StressedCells) -> Array:
        """Temperatures (m, q) at quadrature points."""
        return self._state(self._entropies(x)[part.nodes] @ part.N.T, part.strains(x)[1])[0]

    def _entropies(self, x: Array) -> Array:
        """Entropies (n,) per volume of the nodes at the unknowns `x` of the system."""
        return np.asarray(x[self.entropy.start + self._number])

    def total_entropy(self, x: Array) -> float:
        """Of the whole body at the unknowns `x` of the system."""
        return float(self._content @ x[self.entropy.start : self.entropy.start + self.entropy.size])

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        return {**super()._carried(), "temperature": self.temperatures}

    def invalid(self, x: Array) -> str:
        """Temperatures of the step below absolute zero, or at which slopes leave nothing positive."""
        if found := super().invalid(x):
            return found
        T = self.temperatures_across(x).ravel()
        beyond = self.heat.beyond_slopes(T) if isinstance(self.heat, Heat) else ""
        return f"{self.label}: {beyond}" if beyond else ""

    def trouble(self, x: Array) -> str:
        steep = self.heat.stores.steepness if isinstance(self.heat, Heat) else ""
        found = [super().trouble(x), f"The capacity of {self.label} {steep}" if steep else ""]
        return ". ".join(word for word in found if word)
