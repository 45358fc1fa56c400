"""Solids that crack, by a phase field of damage."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.differences import forward_rate
from visviva.base.errors import InputError
from visviva.body.element import geometry, solid_rule
from visviva.body.inverted import Upright
from visviva.body.solid import Solid
from visviva.body.solid_fields import Evaluated, of_each, summed
from visviva.body.solid_term import Elements
from visviva.body.stressed_cells import StressedCells
from visviva.component.announcements import shared_numbers
from visviva.component.component import settings
from visviva.component.values import Number, NumberAtPlace, NumberOrFunction
from visviva.load.periodic_faces import shared_values
from visviva.mesh.cells import CELLS
from visviva.mesh.quadrature import mass_rule
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.phase.crack_law import NORMALISED, CrackLaw, Irreversibility, Model, SplitName

if TYPE_CHECKING:
    from visviva.model.model import Model as Equations
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
HEATED = {
    PhysicsKind.FRACTURE: PhysicsKind.HEATED_FRACTURE,
    PhysicsKind.FRACTURE_IN_PLANE: PhysicsKind.HEATED_FRACTURE_IN_PLANE,
    PhysicsKind.FRACTURE_OF_REVOLUTION: PhysicsKind.HEATED_FRACTURE_OF_REVOLUTION,
}
"""The same with free strains."""
REMEMBERING = {
    PhysicsKind.FRACTURE: PhysicsKind.HISTORY_FRACTURE,
    PhysicsKind.FRACTURE_IN_PLANE: PhysicsKind.HISTORY_FRACTURE_IN_PLANE,
    PhysicsKind.FRACTURE_OF_REVOLUTION: PhysicsKind.HISTORY_FRACTURE_OF_REVOLUTION,
}
"""The same with a history field."""
CARRIES = 0.9
"""Damage from which on a point is broken, and its cell may turn inside out there."""
ROUNDING = 1e-9
"""Integrals of shape functions below this part of their mean are none: those of corners of tri6."""


@dataclass(config=settings, eq=False, kw_only=True)
class FracturingSolid(Solid, Upright):
    """A solid that cracks: its nodes have damages beside positions.

    Takes the arguments of `Solid` but those of damping, `thermal_strain` and `tangent`, with
    ``formulation="displacement"``, in space, plane strain or axisymmetric (cracks are of revolution then, areas and
    energies those of the whole turn), and

    Parameters
    ----------
    toughness : float
        Energy per area of crack, G_c.
    length : float
        Half of the width over which a crack is smeared, l; cells where cracks run should be half of it or finer.
    model : {'AT2', 'AT1'}
        Local energy of damage: quadratic, so that damage grows from the first strain on, or linear, so that it waits
        for the stress of its threshold (Ambrosio & Tortorelli; Pham, Amor, Marigo & Maurini 2011).
    split : {'none', 'volumetric', 'spectral'}
        Which part of the energy drives cracks: all of it; all but that of shrinking volume (Amor, Marigo & Maurini
        2009); or that of principal strains in tension (Miehe, Welschinger & Hofacker 2010), Green's strains of
        `SaintVenantKirchhoff`, logarithmic ones of `Hencky`.
    residual : float
        Share of the stiffness that full damage leaves.
    damage : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,)
        At the start, 0 to 1: cracks that are there already, where it is 1 at all nodes of a row of cells. At a line of
        nodes alone it is a crack that still carries: the cells beside it are damaged in part (`Mesh.opened` cuts).
    irreversibility : {'active set', 'history'}
        How damage is kept from shrinking. By active sets, nodes that would shrink rest: exact, without work, and the
        ledger closes. So the integral of no node's shape function may be negative: cells are tri3, quad4, quad9, tri6
        of straight edges (not of revolution), hex8, hex27, tet4 or wedge6. By the history field (Miehe, Hofacker &
        Welschinger 2010) the largest energy W+ that there has been at a point drives its damage in place of what there
        is: an energy that is no longer stored counts on, and the ledger's balance tells how much; for comparison with
        other programs. It takes no `damage` and no `free_strain`.
    free_strain : float, or callable, optional
        The strain, the same in all directions, that heat or drying alone would leave; or ``f(t, X)`` of time and
        reference positions (n, 3) with values (n,). Both parts of the energy are ``(1 + e)^3 W(C / (1 + e)^2)``; what
        it does to the solid is booked as work "prescribed motion".

    Notes
    -----
    The energy ``g(d) W+(C) + W-(C) + G_c / (c l) (w(d) + l^2 |grad d|^2)``, ``g = (1 - k) (1 - d)^2 + k``, is least in
    d among damages that do not shrink: at every node damage rests or a balance holds, found by active sets, so that
    what holds it back does no work. The ledger has all of the energy as "stored", that of cracks too. Statics find
    damages together with positions (`Static`), to and fro (`AlternateMinimization`), or through snap-back
    (`CrackControl`); `EnergyMomentum` keeps the sum of kinetic, elastic and crack energy. Runs in time begin with
    damages in balance with what is given; steps that balance forces in their middle (`EnergyMomentum`, `Midpoint`)
    fail where damage ends far from its balance, as where a load on it jumps: `BackwardEuler`, `BDF2` and
    `GeneralizedAlpha` follow that.

    Examples
    --------
    >>> import visviva as vv
    >>> glass = vv.SaintVenantKirchhoff(young=70e9, poisson=0.22)
    >>> plate = vv.FracturingSolid(
    ...     mesh=vv.RectangleMesh(size=(0.01, 0.01), counts=(10, 10)),
    ...     material=glass,
    ...     toughness=8.0,
    ...     length=2e-3,
    ... )
    >>> system = vv.System([plate])
    >>> float(plate.damages(system.x).max()), plate.crack_energy(system.x)
    (0.0, 0.0)
    """

    toughness: Number
    length: Number
    model: Model = "AT2"
    split: SplitName = "none"
    residual: Number = 1e-6
    damage: NumberAtPlace = 0.0
    irreversibility: Irreversibility = "active set"
    free_strain: NumberOrFunction | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("toughness", "length"):
            if not getattr(self, name) > 0:
                raise InputError(f"{self.label}: {name} = {getattr(self, name):g} is not positive")
        if not 0 < self.residual < 1:
            raise InputError(
                f"{self.label}: residual = {self.residual:g} must lie between 0 and 1: without any stiffness cracked "
                "nodes have no place; 1e-6 is common"
            )
        self._refuse_others()
        self.law = CrackLaw(
            self.label, self.material, self.toughness, self.length, self.model, self.split, self.residual
        )
        _ = self.law.number
        self._refuse_coarse()
        self.start_damages = self._given_damages()
        self._refuse_beside_history()
        self._refuse_turned_bounds()

    def _given_damages(self) -> Array:
        n = self.grid.n_nodes
        given = np.asarray(
            self.damage(self.points.copy()) if callable(self.damage) else self.damage, dtype=float
        )
        if given.shape not in ((), (n,)):
            raise InputError(
                f"{self.label}: the function damage gave shape {given.shape} for positions ({n}, 3); give shape ({n},)"
            )
        outside = given[~((given >= 0) & (given <= 1))]
        if outside.size:
            worst = outside.ravel()[np.argmax(np.nan_to_num(np.abs(outside.ravel()), nan=np.inf))]
            raise InputError(f"{self.label}: a damage of {worst:g} is outside 0 ... 1")
        return np.array(np.broadcast_to(given, n))

    def _refuse_others(self) -> None:
        if self.formulation != "displacement" or self.plane == "stress":
            what = "plane = 'stress'" if self.plane == "stress" else f"formulation = {self.formulation!r}"
            raise InputError(
                f"{self.label}: {what} does not crack yet; take formulation = 'displacement' in space, or with "
                "plane = 'strain' or 'axisymmetric'"
            )
        if self.material.small or self.material.energy is not None:
            raise InputError(
                f"{self.label}: {type(self.material).__name__} is no material of finite strains of the core; for small "
                "strains take vv.SaintVenantKirchhoff"
            )
        if self._is_heated or self._is_damped or self.tangent:
            raise InputError(
                f"{self.label}: takes no thermal_strain, damping or tangent; strains of heat are its free_strain"
            )

    @property
    def unbooked(self) -> str:
        """Why the ledger lacks some of what its energy changes by; empty if it does not."""
        if self.irreversibility == "active set":
            return ""
        return f"has irreversibility = {self.irreversibility!r}, whose forces on damages are no gradient of the energy"

    def _refuse_beside_history(self) -> None:
        if self.irreversibility == "active set":
            return
        if self.free_strain is not None:
            raise InputError(
                f"{self.label}: irreversibility = 'history' knows no free_strain yet; take 'active set'"
            )
        if np.any(self.start_damages):
            raise InputError(
                f"{self.label}: irreversibility = 'history' would heal a damage of {self.start_damages.max():g} at the "
                "start, which no strain has made; cut the mesh open by Mesh.opened, or take 'active set'"
            )

    def _refuse_turned_bounds(self) -> None:
        """Refuse cells where what drives a node's damage has the other sign: grow and shrink change places there."""
        if self.irreversibility != "active set":
            return
        shares = self._volumes_of_nodes()
        worst = int(shares.argmin())
        if shares[worst] >= -ROUNDING * shares.mean():
            return
        kinds = [cell for cell, nodes in self.grid.cells.items() if worst in nodes]
        cells = (
            "tri3, quad4, quad9, or tri6 of straight edges"
            if self.dimension == 2
            else "hex8, hex27, tet4 or wedge6"
        )
        raise InputError(
            f"{self.label}: the shape function of node {worst} at {np.round(self.points[worst], 6).tolist()} has the "
            f"negative integral {shares[worst]:.3g} over its cells {', '.join(kinds)}: damage kept from shrinking node "
            f"by node would grow there without load, and heal; take {cells}{self._other_way}"
        )

    _other_way: ClassVar[str] = ", or irreversibility = 'history'"
    """What else than other cells keeps damage from shrinking."""

    def start(self, state: State, scheme: Scheme) -> None:
        super().start(state, scheme)
        if self.irreversibility == "history" and scheme.theta < 1 and not scheme.discrete_gradient:
            raise InputError(
                f"{self.label}: irreversibility = 'history' follows damages at ends of steps, and {scheme} asks for "
                "them in the middle, where they would swing: take vv.EnergyMomentum(), vv.BDF2() or 'active set'"
            )

    def _refuse_coarse(self) -> None:
        """Refuse a length of cracks that no cell resolves."""
        size = min(
            float(edges(self.grid.points, nodes, cell).min()) for cell, nodes in self.grid.cells.items()
        )
        if self.length < size:
            raise InputError(
                f"{self.label}: length = {self.length:g} is below the size of its smallest cell, {size:.4g}; a crack "
                f"needs cells of {0.5 * self.length:.3g} or finer where it runs: refine the mesh, or smear it wider"
            )

    def _carries(self, x: Array, part: StressedCells, some: slice) -> NDArray[np.bool_] | bool:
        return np.asarray(self.damages(x)[part.nodes[some]] @ part.N.T < CARRIES)

    def remarks(self) -> list[str]:
        return [*self._on_cells(), *self._on_lines()]

    def _on_lines(self) -> list[str]:
        """On cracks at the start that are lines of nodes, which carry: see ``benchmarks/line_of_damage.py``."""
        broken = self.start_damages >= 1 - 1e-9
        open_ = np.zeros(len(broken), dtype=bool)
        for nodes in self.grid.cells.values():
            open_[nodes[broken[nodes].all(axis=1)]] = True
        if (alone := int(np.count_nonzero(broken & ~open_))) == 0:
            return []
        return [
            f"{self.label}: {alone} nodes are broken at the start in no cell that is so as a whole: what they are to "
            "part is held together by the cells beside them; give damage = 1 at all nodes of a row of cells, or cut "
            "the mesh by Mesh.opened"
        ]

    def _on_cells(self) -> list[str]:
        """On cells that are long for the length of cracks."""
        sizes = [lengths(self.grid.points, nodes, cell) for cell, nodes in self.grid.cells.items()]
        finest, coarsest = min(float(s.min()) for s in sizes), max(float(s.max()) for s in sizes)
        enough = 0.5 * self.length * (1 + 1e-9)
        if finest > enough:
            more = 100 * finest / (NORMALISED[self.model] * self.length)
            return [
                f"{self.label}: its finest cells, {finest:.3g} long, are larger than half the length {self.length:g} "
                f"of a crack, which costs {more:.0f} % more if it crosses them that way"
                f"{'; damages may exceed 1' if self.model == 'AT1' else ''}"
            ]
        if coarsest > enough:
            return [
                f"{self.label}: some of its cells are up to {coarsest:.3g} long; a crack of the length {self.length:g} "
                "costs more where it crosses what is longer than half of that"
            ]
        return []

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Equations) -> None:
        super().declare(model)
        self._number = shared_numbers(model, self)
        start = shared_values(self, "damage", self._number, self.start_damages)
        self.damaged = model.field(self, "damage", start, role=Role.STATE, scale=1.0)
        held = self.irreversibility == "active set"
        sizes = np.bincount(self._number, self._volumes_of_nodes()) / (2 * self.length)
        model.grow(self.damaged, sizes, held)
        if self.free_strain is not None:
            self._stretched = model.field(self, "free strain", self._free_strains(0.0), role=Role.STATE)

    def _free_strains(self, time: float) -> Array:
        n, given = self.grid.n_nodes, self.free_strain
        found = np.asarray(
            given(time, self.points.copy()) if callable(given) else np.full(n, given), dtype=float
        )
        if found.shape != (n,) or not np.all(found > -1):
            raise InputError(
                f"{self.label}: free_strain gave shape {found.shape}, or values that do not all exceed -1, at t = "
                f"{time:g}; give strains, shape ({n},)"
            )
        return found

    def _free_rates(self, time: float, step: float) -> Array:
        rates: Array = forward_rate(self._free_strains, time, step)
        return rates

    def free_strains(self, x: Array) -> Array:
        """Free strains (n,) of the nodes at the unknowns `x` of the system."""
        if self.free_strain is None:
            return np.zeros(self.grid.n_nodes)
        return np.asarray(x[self._stretched.start : self._stretched.start + self._stretched.size])

    def _volumes_of_nodes(self) -> Array:
        """Shares (n,) of the nodes in the volume."""
        total = np.zeros(self.grid.n_nodes)
        for points in self.cell_points():
            total += points.spread(np.ones((*points.size.shape, 1)), len(total))[:, 0]
        return total

    def contribute(self, model: Equations) -> None:
        if self.free_strain is not None:
            every = np.arange(self.grid.n_nodes)
            model.prescribe(self, self._stretched, every, self._free_strains, self._free_rates)
        self._elements, self._energy, self._starts_stress = [], None, False
        self._evaluations = []
        first = 0
        for cell, nodes in self.grid.cells.items():
            self._elements.append(self._made(model, cell, nodes, first))
            first += len(nodes)

    def _evaluation(self, cell: str, nodes: Ints, rule: Any) -> StressedCells:
        g = self._geometry(cell, nodes, rule)
        N = CELLS[cell].N(rule.points)

        def vectors(x: Array, some: slice) -> Array:
            return np.asarray(self.positions(x)[nodes[some]])

        def respond(x: Array, of: Ints, C: Array) -> tuple[Array, Array]:
            stretch = self._stretches(x, of, N)
            d, inner = self.damages(x)[of] @ N.T, C / stretch[..., None] ** 2
            W, S = self.law.respond(inner.reshape(-1, 6), d.ravel())
            return stretch[..., None] * S.reshape(C.shape), stretch**3 * W.reshape(d.shape)

        return StressedCells(nodes, g.gradients, g.volume, N, vectors, respond, g.hoop)

    def _stretches(self, x: Array, of: Ints, N: Array) -> Array:
        """Stretches (m, q) that heat alone would leave between nodes (m, k)."""
        return np.asarray(1 + self.free_strains(x)[of] @ N.T)

    def _made(self, model: Equations, cell: str, nodes: Ints, first: int) -> Elements:
        at = self._evaluation(
            cell, nodes, mass_rule(cell)
        )  # damages have mass of their own in the local energy
        value = np.broadcast_to(at.N[None, :, :, None], (*at.gradients.shape[:3], 1))
        scalar = np.concatenate([value, at.gradients], axis=3)
        kind, weights = PhysicsKind.FRACTURE, at.gradients
        if self.dimension == 2:
            kind = PhysicsKind.FRACTURE_IN_PLANE
            if at.hoop is not None:
                kind = PhysicsKind.FRACTURE_OF_REVOLUTION
                weights = np.concatenate([weights, at.hoop[..., None]], axis=3)
        mass = self._cell_masses(cell, nodes) if self.density > 0 else None
        groups = [
            Group(self.node_unknowns(nodes), weights, mass, True),
            Group(self.damaged.start + self._number[nodes], scalar),
        ]
        self._add_cells(model, kind, groups, at, scalar)
        self._evaluations.append(at)
        looks = self._evaluation(cell, nodes, solid_rule(self.grid.points, nodes, cell))
        return looks.elements(cell, first)

    def _add_cells(
        self, model: Equations, kind: PhysicsKind, groups: list[Group], at: StressedCells, scalar: Array
    ) -> None:
        """Add cells with positions and damages, and what else their nodes have, weighted like damages by `scalar`."""
        if self.free_strain is not None:
            kind = HEATED[kind]
            groups.append(Group(self._stretched.start + at.nodes, scalar[..., :1]))
        if self.irreversibility == "history":
            kind = REMEMBERING[kind]
        add_points(model, self, kind, groups, at.volume, self.law.parameters())

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        return summed(self.grid, ((part.nodes, part.forces(x)) for part in self._evaluations), cells)

    # --- what it shows -------------------------------------------------------------------------------------
    def _evaluated(self, x: Array) -> Iterator[Evaluated]:
        return of_each(self._elements, x)

    def damages(self, x: Array) -> Array:
        """Damages (n,) of the nodes at the unknowns `x` of the system: 0 sound, 1 cracked."""
        return np.asarray(x[self.damaged.start + self._number])

    def crack_energy(self, x: Array) -> float:
        """Energy of its cracks; divided by the toughness their area, in the plane times the thickness."""
        total = 0.0
        for part in self._evaluations:
            d = self.damages(x)[part.nodes]
            slope = np.einsum("mqkj,mk->mqj", part.gradients, d)
            total += float((part.volume * self.law.crack_energy(d @ part.N.T, slope)).sum())
        return total

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        return {**super()._carried(), "damage": self.damages}


STRETCHED = 1.5
"""Length of cells that are long in one direction, over the root of their area or volume."""


def edges(points: Array, nodes: Ints, cell: str) -> Array:
    """Sizes (m,) of cells, half as large where nodes lie between corners."""
    d = points.shape[1]
    volume = geometry(points, nodes, cell).volume.sum(axis=1)
    share = {"tri": 1 / 2, "tet": 1 / 6}.get(cell[:3], 1.0)
    size: Array = (volume / share) ** (1 / d)
    return size / (2 if CELLS[cell].middles else 1)


def lengths(points: Array, nodes: Ints, cell: str) -> Array:
    """Sizes (m,) of cells, their lengths if they are stretched."""
    kind, size = CELLS[cell], edges(points, nodes, cell)
    J = np.einsum("mki,kj->mij", points[nodes], kind.dN(kind.centre[None])[0]) * np.ptp(kind.nodes, axis=0)
    length = np.linalg.norm(J, 2, axis=(1, 2)) / (2 if kind.middles else 1)
    return np.where(length > STRETCHED * size, length, size)
