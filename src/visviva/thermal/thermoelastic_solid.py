"""Solids that deform and conduct heat: strain and entropy store energy together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.element import geometry, solid_rule
from visviva.body.mesh_points import Points
from visviva.body.solid import Solid
from visviva.body.solid_fields import FULL, Evaluated, components, of_points
from visviva.body.solid_term import Elements
from visviva.component.component import Component, settings
from visviva.component.values import NumberOrFunction
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import Rule, mass_rule
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.carrier import EntropyInput, EntropySupply, GivenTemperatures, HeatCarrier, Law
from visviva.thermal.heat import Heat
from visviva.thermal.held_temperature import HeldTemperature

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@plain_dataclass(frozen=True, eq=False)
class Evaluation:
    """What is asked of the term of a solid's cells: fields at points and forces on nodes, in Python."""

    solid: ThermoelasticSolid
    nodes: Ints
    gradients: Array
    volume: Array
    N: Array

    def points(self, x: Array, start: int, stop: int) -> tuple[Array, Array, Array, Array]:
        """Deformation gradient (m, q, 3, 3), temperature (m, q), stress (m, q, 6), energy (m, q)."""
        nodes = self.nodes[start:stop]
        F = np.einsum("mqkj,mki->mqij", self.gradients[start:stop], self.solid.positions(x)[nodes])
        C = components(np.swapaxes(F, -1, -2) @ F)
        s = x[self.solid.entropy.start + nodes] @ self.N.T
        T, S, e = self.solid.heat.respond(self.solid.material, C.reshape(-1, 6), s.ravel())
        return F, T.reshape(s.shape), S.reshape(C.shape), e.reshape(s.shape)

    def fields(self, x: Array, start: int, stop: int) -> Array:
        """Rows (m, q, 16) as the core's terms of solids give them."""
        F, _, S, e = self.points(x, start, stop)
        return np.concatenate([F.reshape(*e.shape, 9), S, e[..., None]], axis=-1)

    def forces(self, x: Array, start: int, stop: int) -> Array:
        """Residuals (m, k, 3) by nodes of the strained cells."""
        F, _, S, _ = self.points(x, start, stop)
        P = F @ S[..., FULL]
        return np.asarray(
            np.einsum("mq,mqij,mqkj->mki", self.volume[start:stop], P, self.gradients[start:stop])
        )


@dataclass(config=settings, eq=False, kw_only=True)
class ThermoelasticSolid(Solid, HeatCarrier):
    """A solid whose nodes have entropies and temperatures beside positions.

    Takes the arguments of `Solid`, on meshes in space with ``formulation="displacement"``, and

    Parameters
    ----------
    heat : Heat
        How it stores and conducts heat.
    temperature : float, or a function of reference positions (n, 3) with values (n,), optional
        Absolute, at the start; by default the reference of `heat`.

    Notes
    -----
    The entropy per reference volume is a field of order 1; its balance is tested with the shape functions, and the
    temperature, a field of the same shape functions, is the algorithmic one of the step, ``D_s e``, weakly. With the
    energy-momentum scheme the total energy of an isolated body is kept to round-off, however temperatures differ from
    place to place, and its entropy never falls (partitioned discrete gradients: Romero 2010, Gross & Betsch 2011).
    The ledger books the internal energy as "stored".

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

    heat: Heat
    temperature: NumberOrFunction | None = None
    balances_entropy = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._refuse_others()
        given = self.heat.reference if self.temperature is None else self.temperature
        found = given(self.points) if callable(given) else given
        self.start_temperatures = np.array(np.broadcast_to(np.asarray(found, dtype=float), self.grid.n_nodes))
        if not np.all(self.start_temperatures > 0):
            raise InputError(
                f"{self.label}: a temperature of {self.start_temperatures.min():g} is not above absolute zero; give "
                "kelvin"
            )

    def _refuse_others(self) -> None:
        if self.grid.dimension != 3:
            raise InputError(
                f"{self.label}: needs a mesh in space; a plane problem is one layer of cells there"
            )
        if self.formulation != "displacement":
            raise InputError(f"{self.label}: formulation = {self.formulation!r} does not conduct heat yet")
        if self.material.small or self.material.energy is not None:
            raise InputError(
                f"{self.label}: {type(self.material).__name__} is no material of finite strains of the core; for small "
                "strains take vv.SaintVenantKirchhoff"
            )
        if self._is_heated or self._is_damped or self.lumped:
            raise InputError(f"{self.label}: takes no thermal_strain, damping or lumped masses")
        if self.heat.expansion and not np.isfinite(self.material.lame[0]):
            raise InputError(
                f"{self.label}: an incompressible material cannot expand; make its bulk modulus finite"
            )

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        super().declare(model)
        T, zero = self.start_temperatures, self.heat.reference
        s = self.heat.capacity * np.log(T / zero)
        self.entropy = model.field(self, "entropy", s, role=Role.CONTENT, scale=self.heat.capacity)
        self.algorithmic = model.field(self, "temperature", T, role=Role.TEMPERATURE)

    def _made(self, model: Model, cell: str, nodes: Ints, first: int) -> Elements:
        rule = mass_rule(cell)  # the entropies' own rule would leave some of them without a temperature
        g, N = geometry(self.grid.points, nodes, cell, rule=rule), CELLS[cell].N(rule.points)
        of_value = np.broadcast_to(N[None, :, :, None], (*g.gradients.shape[:3], 1))
        scalar = np.concatenate([of_value, g.gradients], axis=3)
        mass = self._cell_masses(cell, nodes) if self.density > 0 else None
        groups = [
            Group(self.node_unknowns(nodes), g.gradients, mass, True),
            Group(self.entropy.start + nodes, scalar),
            Group(self.algorithmic.start + nodes, scalar),
        ]
        constants = self.heat.parameters(self.material)
        add_points(model, self, PhysicsKind.THERMOELASTIC, groups, g.volume, constants)
        self._evaluations.append(Evaluation(self, nodes, g.gradients, g.volume, N))
        shown = solid_rule(self.grid.points, nodes, cell)
        g, N = geometry(self.grid.points, nodes, cell, rule=shown), CELLS[cell].N(shown.points)
        looks: Any = Evaluation(self, nodes, g.gradients, g.volume, N)
        return Elements(cell=cell, nodes=nodes, first=first, thermal=None, term=looks, volume=g.volume)

    def contribute(self, model: Model) -> None:
        self._elements, self._energy, self._starts_stress = [], None, False
        self._evaluations: list[Evaluation] = []
        first = 0
        for cell, nodes in self.grid.cells.items():
            self._elements.append(self._made(model, cell, nodes, first))
            first += len(nodes)
        self.volumes = [elements.volume for elements in self._elements]

    def temperature_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.algorithmic.start + nodes, dtype=np.int32)

    def balance_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.entropy.start + nodes, dtype=np.int32)

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        nodes, values = given.nodes, given.values
        now = values(0.0)
        if np.any(now <= 0):
            raise InputError(
                f"{owner.label}: a temperature of {now.min():g} is not above absolute zero; give kelvin"
            )
        self.entropy.values[nodes] = self.heat.capacity * np.log(now / self.heat.reference)
        self.algorithmic.values[nodes] = now
        model.refresh(self.entropy)
        model.refresh(self.algorithmic)
        supply = model.multipliers(owner, "supply", len(nodes), instantaneous=False)
        numbers = np.asarray(supply.unknowns)
        of_nodes = np.stack([self.entropy.start + nodes, self.algorithmic.start + nodes, numbers], axis=1)
        model.term(owner, EntropySupply(np.asarray(of_nodes, dtype=np.int32)))
        place, cells_of = np.full(self.grid.n_nodes, -1), np.zeros(self.grid.n_nodes)
        place[nodes] = np.arange(len(nodes))
        for of_cell in self.grid.cells.values():
            cells_of += np.bincount(of_cell.ravel(), minlength=len(cells_of))
        for cell, of_cell in self.grid.cells.items():
            e, a = np.nonzero(place[of_cell] >= 0)
            some, held = of_cell[e], of_cell[e, a]
            at_nodes = Rule(CELLS[cell].nodes, np.ones(len(CELLS[cell].nodes)))
            gradients = geometry(self.grid.points, some, cell, rule=at_nodes).gradients[np.arange(len(e)), a]
            positions = (self.node_unknowns(some)[:, :, None] + np.arange(3)).reshape(len(e), -1)
            own = np.stack([self.entropy.start + held, numbers[place[held]]], axis=1)
            unknowns = np.asarray(np.hstack([positions, own]), dtype=np.int32)
            term = HeldTemperature(
                self.heat, self.material, unknowns, gradients, 1 / cells_of[held], place[held], values
            )
            model.term(owner, term)

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        unknowns = np.hstack([self.entropy.start + points.nodes, self.algorithmic.start + points.nodes])
        model.term(owner, EntropyInput(kind, np.asarray(unknowns, dtype=np.int32), points, law))

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        total, first = np.zeros((self.grid.n_nodes, 3)), 0
        for part in self._evaluations:
            n = len(part.nodes)
            force = part.forces(x, 0, n)
            if cells is not None:
                force *= cells[first : first + n, None, None]
            np.subtract.at(total, part.nodes, force)
            first += n
        return total

    # --- what it shows -------------------------------------------------------------------------------------
    def _evaluated(self, x: Array) -> Iterator[Evaluated]:
        for part in self._elements:
            numbers = slice(part.first, part.first + len(part.nodes))
            fields = of_points(part.term.fields(x, 0, len(part.nodes)), False)
            yield part.cell, part.nodes, numbers, part.volume, fields

    @cached_property
    def _projection(self) -> Any:
        """Solves with the matrix of the shape functions' products."""
        import scipy.sparse as sp
        from scipy.sparse.linalg import factorized

        n, total = self.grid.n_nodes, None
        for part in self._evaluations:
            block = np.einsum("mq,qa,qb->mab", part.volume, part.N, part.N)
            row, column = np.broadcast_arrays(part.nodes[:, :, None], part.nodes[:, None, :])
            matrix = sp.coo_array((block.ravel(), (row.ravel(), column.ravel())), shape=(n, n))
            total = matrix if total is None else total + matrix
        return factorized(sp.csc_array(total))

    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the nodes at the unknowns `x` of the system: those of strain and entropy there."""
        total = np.zeros(self.grid.n_nodes)
        for part in self._evaluations:
            T = part.points(x, 0, len(part.nodes))[1]
            np.add.at(total, part.nodes, np.einsum("mq,mq,qk->mk", part.volume, T, part.N))
        return np.asarray(self._projection(total))

    def total_entropy(self, x: Array) -> float:
        """Of the whole body at the unknowns `x` of the system."""
        s = x[self.entropy.start : self.entropy.start + self.entropy.size]
        return float(sum((p.volume * (s[p.nodes] @ p.N.T)).sum() for p in self._evaluations))

    def widths(self) -> Mapping[str, int]:
        return {**super().widths(), "temperature": 1}

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        others = super().smoothed([n for n in names if n != "temperature"], x)
        return others | ({"temperature": self.temperatures(x)} if "temperature" in names else {})

    def trouble(self, x: Array) -> str:
        T = x[self.algorithmic.start : self.algorithmic.start + self.algorithmic.size]
        if np.any(T <= 0):
            a = int(np.argmin(T))
            at = ", ".join(f"{c:.4g}" for c in self.points[a])
            return f"node {a} of {self.label} near ({at}) has a temperature of {T[a]:.4g} K"
        return super().trouble(x)
