"""Solids whose phases separate: composition strains them, and stress drives diffusion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.body.element import solid_rule
from visviva.body.inverted import Upright
from visviva.body.solid import Solid
from visviva.body.solid_fields import Evaluated, of_each, summed
from visviva.body.solid_term import Elements
from visviva.body.space import Table
from visviva.body.stressed_cells import StressedCells
from visviva.component.component import settings
from visviva.component.values import Matrix, Number, NumberAtPlace, Pairs
from visviva.load.periodic_faces import PeriodicFaces
from visviva.mesh.cells import CELLS
from visviva.mesh.periodic import numbering, partners
from visviva.mesh.quadrature import mass_rule
from visviva.model.field import Field, Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.phase.cahn_hilliard import CahnHilliard
from visviva.phase.free_energy import FreeEnergy, UserFreeEnergy
from visviva.phase.interface import Interface
from visviva.phase.mobility import Mobility
from visviva.phase.phase_body import first_point, missed_mobility, stride

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
A, B = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]


class Chemistry(CahnHilliard):
    """The mixture of a solid, whose label is its name, integrated where the solid's strains are."""

    lumps = False
    cure = "take a free energy whose phases are less pure, or a polynomial such as vv.DoubleWell(low=..., high=...)"

    @property
    def label(self) -> str:
        return str(self.name)


@dataclass(config=settings, eq=False, kw_only=True)
class MixtureSolid(Solid, Upright):
    """A solid whose phases separate by diffusion, strained by its composition, so that stress drives diffusion too.

    Takes the arguments of `Solid` but those of damping, `thermal_strain` and `tangent`, in space or in plane strain,
    with ``formulation="displacement"``, and

    Parameters
    ----------
    free_energy, gradient_energy, concentration, mobility
        See `CahnHilliard`.
    periodic : sequence of (str, str)
        Pairs of sets of faces, of equal meshes, that are taken for the same. How far apart their positions stay, with
        what mean strain, `PeriodicFaces` of the same pairs says, which is needed besides, as it needs these pairs.
    eigenstrain : float, or (float, float, float)
        Strain per concentration that it alone would leave (Vegard): the same in all directions, or along the axes.
    reference : float
        Concentration at which there is no such strain, and the material is as given.
    moduli : sequence of float
        Further coefficients m_k of its stiffness ``1 + m_1 (c - c0) + m_2 (c - c0)^2 + m_3 (c - c0)^3``.

    Notes
    -----
    The energy per reference volume is ``f(c) + grad c . K grad c / 2 + m(c) W(F0^-T C F0^-1)`` with ``F0 = 1 + (c - c0)
    eigenstrain``, any material's W; gradients and diffusion are those of the reference. One discrete gradient in
    (C, c, grad c) gives stress and potential: with the energy-momentum scheme kinetic, elastic, chemical and gradient
    energy together fall by exactly what diffusion dissipates, and the ledger has one sum of them. Without density the
    stress is in balance while diffusion marches, from the start on: positions without mass are first moved into it.

    Examples
    --------
    >>> import visviva as vv
    >>> import numpy as np
    >>> alloy = vv.MixtureSolid(
    ...     mesh=vv.RectangleMesh(size=(8, 8), counts=(8, 8)),
    ...     material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
    ...     density=1.0,
    ...     free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
    ...     gradient_energy=2.0,
    ...     mobility=5.0,
    ...     concentration=lambda X: 0.5 + 0.05 * np.cos(0.8 * X[:, 0]),
    ...     eigenstrain=0.05,
    ...     reference=0.5,
    ... )
    >>> result = vv.simulate(vv.System([alloy]), until=0.5, step=0.05)
    >>> result.conservation()["energy"] < 1e-10
    True
    """

    free_energy: FreeEnergy
    gradient_energy: Number | Matrix
    concentration: NumberAtPlace
    mobility: Number | Mobility = 1.0
    periodic: Pairs = ()
    eigenstrain: Number | tuple[Number, Number, Number] = 0.0
    reference: Number = 0.0
    moduli: Annotated[tuple[Number, ...], LISTED] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        self._refuse_others()
        self.chemistry = Chemistry(
            name=self.label,
            mesh=self._given_mesh(),
            free_energy=self.free_energy,
            gradient_energy=self.gradient_energy,
            concentration=self.concentration,
            mobility=self.mobility,
            periodic=self.periodic,
            thickness=self.thickness,
        )
        self.space = self.chemistry.space
        self._strains = np.broadcast_to(np.asarray(self.eigenstrain, dtype=float), (3,))
        self._moduli = np.array([1.0, *self.moduli, *[0.0] * (3 - len(self.moduli))])
        self._refuse_lost(self.chemistry.start_values)

    def _refuse_others(self) -> None:
        if self.formulation != "displacement" or self.plane == "stress" or self.axisymmetric:
            raise InputError(
                f"{self.label}: a mixture needs formulation = 'displacement' in space or in plane strain, not "
                f"{self.formulation!r} and plane = {self.plane!r}"
            )
        if self.material.small or self.material.energy is not None:
            raise InputError(
                f"{self.label}: {type(self.material).__name__} is no material of finite strains of the core; for small "
                "strains take vv.SaintVenantKirchhoff"
            )
        if isinstance(self.free_energy, UserFreeEnergy):
            raise InputError(f"{self.label}: needs a free energy of the core, such as vv.PolynomialEnergy")
        if self._is_heated or self._is_damped or self.tangent:
            raise InputError(f"{self.label}: takes no thermal_strain, damping or tangent")
        if len(self.moduli) > 3:
            raise InputError(f"{self.label}: moduli has {len(self.moduli)} coefficients, 3 are known")

    def _refuse_lost(self, c: Array) -> None:
        """Refuse concentrations at the start that leave no length or stiffness."""
        lost = np.flatnonzero(self._least(c) <= 0)
        if len(lost):
            raise InputError(f"{self.label}: at the start {self._said(float(c[lost[0]]))}")

    def _least(self, c: Array) -> Array:
        """What concentrations leave least of: the stiffness, or the length along an axis, as shares."""
        off = c - self.reference
        shares = 1 + off[..., None] * self._strains
        return np.asarray(np.minimum(self._stiffness(off), shares.min(axis=-1)))

    def _said(self, c: float) -> str:
        off = c - self.reference
        if (m := float(self._stiffness(np.array(off)))) <= 0:
            left = f"a stiffness of {m:.4g} times that of its material by moduli = {self.moduli}"
        else:
            shares = (1 + off * self._strains).tolist()
            left = f"lengths of {min(shares):.4g} times those of its material by eigenstrain = {self.eigenstrain}"
        return (
            f"a concentration of {c:.6g} leaves {left}, with the reference {self.reference:g}: give coefficients that "
            "leave some at all concentrations that occur"
        )

    def invalid(self, x: Array) -> str:
        """Points where concentrations leave no length or stiffness, or the mobility."""
        c = self.coefficients(x)
        lost = first_point(self.label, self.space, c, lambda values: self._least(values) <= 0, self._said)
        self.chemistry._refuse_thin_beyond(c)
        return lost or missed_mobility(self.chemistry, self.label, c) or super().invalid(x)

    def _stiffness(self, off: Array) -> Array:
        return np.asarray(np.polynomial.polynomial.polyval(off, self._moduli))

    def interface(self, time: float = 0.0) -> Interface | None:
        """The flat interface between its phases at a time, without stress."""
        return self.chemistry.interface(time)

    def remarks(self) -> list[str]:
        return [*super().remarks(), *self.chemistry.remarks()]

    def _refuse_torn(self, model: Model) -> None:
        """Refuse sides whose concentrations are one while their positions are not."""
        sides = model.announced(self, PeriodicFaces)
        for pair in self.periodic:
            a, b = partners(self.grid, *pair, self.label).T
            if not any(np.array_equal(s.leaders[a], s.leaders[b]) for s in sides):
                raise InputError(
                    f"{self.label}: periodic has {pair!r}, whose concentrations are one, while "
                    "positions there move freely: add vv.PeriodicFaces(solid=..., pairs=...) of this pair, whose "
                    "strain is that of the cell, or leave the pair out"
                )
        together = numbering(self.grid, self.periodic, self.label)[0]
        for s in sides:
            for a, b in (
                pair for pair in s.pairs if np.ptp(together[partners(self.grid, *pair, "")], axis=1).any()
            ):
                raise InputError(
                    f"{self.label}: {s.label} joins the positions of {(a, b)!r}, beyond which its concentrations do "
                    f"not go on: add the pair to its periodic, periodic=[({a!r}, {b!r})]"
                )

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        self._refuse_torn(model)
        super().declare(model)
        self.phase = self.chemistry.field_in(model, self)
        self.potential: Field | None = model.field(
            self, "potential", 0 * self.phase.values, role=Role.POTENTIAL
        )

    def contribute(self, model: Model) -> None:
        self._elements, self._energy, self._starts_stress = [], None, False
        self._evaluations = []
        first = 0
        for table, parts in zip(self.space.cells(), self._parts(), strict=True):
            self._elements.append(self._mixed(model, table, *parts, first))
            first += len(table.numbers)

    def _given_mesh(self) -> Any:
        """Of the mixture."""
        return self.grid

    def _parts(self) -> Iterator[tuple[str, StressedCells, StressedCells, Array | None]]:
        """Cells of each type where mixture and strains are integrated, where stresses are shown, and their masses."""
        for cell, nodes in self.grid.cells.items():
            rules = mass_rule(cell), solid_rule(self.grid.points, nodes, cell)
            at, looks = (self._cells(cell, nodes, rule) for rule in rules)
            yield cell, at, looks, self._cell_masses(cell, nodes) if self.density > 0 else None

    def _cells(self, cell: str, nodes: Ints, rule: Any) -> StressedCells:
        g = self._geometry(cell, nodes, rule)
        N = CELLS[cell].N(rule.points)
        return self._stressed_cells(nodes, g.gradients, g.volume, N, lambda x, of: self.values(x)[of] @ N.T)

    def _stressed_cells(
        self, nodes: Ints, gradients: Array, volume: Array, N: Array, mixed: Callable[[Array, Ints], Array]
    ) -> StressedCells:
        """Cells that are `mixed` so at their points (m, q), by the unknowns and their nodes or control points."""

        def vectors(x: Array, some: slice) -> Array:
            return self.carriers.vectors(x)[nodes[some]]

        def respond(x: Array, of: Ints, C: Array) -> tuple[Array, Array]:
            c = mixed(x, of)
            W, S = self.respond(C.reshape(-1, 6), c.ravel())
            return S.reshape(C.shape), W.reshape(c.shape)

        return StressedCells(nodes, gradients, volume, N, vectors, respond)

    def _mixed(
        self,
        model: Model,
        table: Table,
        cell: str,
        at: StressedCells,
        looks: StressedCells,
        mass: Array | None,
        first: int,
    ) -> Elements:
        kind = PhysicsKind.MIXTURE_IN_PLANE if self.dimension == 2 else PhysicsKind.MIXTURE_SOLID
        groups = [Group(self.carriers.unknowns(at.nodes), at.gradients, mass, True)]
        groups += [Group(f.start + table.numbers, table.columns()) for f in (self.phase, self.potential) if f]
        term = add_points(model, self, kind, groups, at.volume, self.constants())
        term.limit(1, stride(self.chemistry))
        self.chemistry.drive(model, self, term)
        self._evaluations.append(at)
        return looks.elements(cell, first)

    def constants(self) -> list[float]:
        """Of the core, see ``visviva/point/mixture.hpp``."""
        own = self.material.constants()
        rest = [0.0] * (_core.MATERIAL_PARAMETERS - len(own))
        solid = [self.reference, *self._moduli, *self._strains, float(int(self.material.kind))]
        return [*self.chemistry.constants(), *solid, *own, *rest]

    def respond(self, C: Array, c: Array) -> tuple[Array, Array]:
        """Elastic energies (n,) and second Piola-Kirchhoff stresses (n, 6) at C (n, 6) and concentrations (n,)."""
        off = c - self.reference
        stretch = 1 / (1 + off[:, None] * self._strains)
        share, m = stretch[:, A] * stretch[:, B], self._stiffness(off)
        W, S, _ = self.material.respond(C * share)
        return m * W, m[:, None] * share * S

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        return summed(self.grid, ((part.nodes, part.forces(x)) for part in self._evaluations), cells)

    # --- what it shows -------------------------------------------------------------------------------------
    def _evaluated(self, x: Array) -> Iterator[Evaluated]:
        return of_each(self._elements, x)

    def values(self, x: Array) -> Array:
        """Concentrations (n,) at the nodes at the unknowns `x` of the system."""
        return self.space.at_nodes(self.coefficients(x))

    def coefficients(self, x: Array) -> Array:
        """Of the concentration among the unknowns `x` of the system."""
        return np.asarray(x[self.phase.start : self.phase.start + self.phase.size])

    def potentials(self, x: Array) -> Array:
        """Chemical potentials (n,) at the nodes, with the part of stress; means as in `CahnHilliard`."""
        assert self.potential is not None
        return self.space.at_nodes(x[self.potential.start : self.potential.start + self.potential.size])

    def integral(self, x: Array) -> float:
        """Of the concentration over the reference volume, at the unknowns `x`."""
        c = self.coefficients(x)
        return float(sum((t.size * t.at(c)).sum() for t in self.space.cells()))

    def elastic_energy(self, x: Array) -> float:
        """Energy of strains at the unknowns `x`."""
        parts = ((p.volume * p.fields(x, 0, len(p.nodes))[..., 15]).sum() for p in self._evaluations)
        return float(sum(parts))

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        return {**super()._carried(), "concentration": self.values, "potential": self.potentials}
