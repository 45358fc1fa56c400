"""Deformable solids: a mesh, a material, and the strains between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError, nearest
from visviva.base.places import of_places, refuse_gathered
from visviva.base.world import world
from visviva.body import formulation as forms
from visviva.body.element import masses, nodal_masses, solid_rule
from visviva.body.formulation import Formulation
from visviva.body.inverted import flattest
from visviva.body.mesh_body import MeshBody
from visviva.body.solid_fields import QUANTITIES, Evaluated, Fields, evaluated, quantity, smoothed
from visviva.body.solid_term import Elements, brick_term, own_energy, rayleigh, shared_out, whole
from visviva.component.announcements import SharedOut, Wetting, shared_numbers
from visviva.component.component import settings
from visviva.component.meshed import refuse_thickness
from visviva.component.values import Number, NumberAtPlace, Vector3, VectorOrFunction
from visviva.material.material import Material
from visviva.mesh.cells import CELLS
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import Rule
from visviva.model.callback import callback_of
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
SQUEEZED = 0.1
"""Elements with less of their volume than this are named when a step fails."""
Plane = Literal["strain", "stress", "axisymmetric"]


@dataclass(config=settings, eq=False, kw_only=True)
class Solid(MeshBody):
    """A body of finite elements, in the total Lagrangian description of the paper's section 2.2.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Three-dimensional, or plane.
    material : Material
        Its energy; several solids may share one.
    density : float
        Mass per reference volume; 0 for statics without gravity.
    plane : {'strain', 'stress', 'axisymmetric'}
        What a plane mesh means. In plane stress the thickness changes so that nothing pulls across. Axisymmetric
        meshes have the coordinates (radius, axis), and all quantities are those of the whole revolution.
    formulation : {'displacement', 'F-bar', 'enhanced', 'mixed'}
        Against locking, see :doc:`/theory/solids`. 'F-bar' (quad4, hex8) scales the change of volume to that of the
        element's centre; 'enhanced' (quad4, hex8) adds strains, for bending too; 'mixed' has pressures: linear in each
        quad9, hex20, hex27, continuous for tri6, tet10 and, stabilised, tri3, tet4, wedge6, for incompressible
        materials too; constant in each quad4, hex8 (the mean dilatation), for nearly incompressible ones.
    thickness : float
        Of a plane solid; what is axisymmetric has none.
    velocity : (3,), or a function of reference positions (n, 3) with values (n, 3)
    angular_velocity : (3,)
        Initial rotation about the centre of mass.
    thermal_strain : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,)
        Expansion coefficient times rise of temperature: the strain, the same in all directions, that heat alone would
        leave. Finite strains are measured from there, ``(1 + e)^3 W(C / (1 + e)^2)``. It does not change in time.
        Elements of 'F-bar' have that of their centre.
    lumped : bool
        Diagonal mass matrix instead of the consistent one.
    mass_damping, stiffness_damping : float
        Rayleigh damping: forces ``mass_damping * M v``, and stresses ``stiffness_damping`` times the moduli of small
        strains times the rate of Green's strain, which leave rigid motions alone. With 'F-bar' and 'mixed' the shear
        modulus alone counts: viscosity of the volume would lock.
    tangent : {'exact', 'start'}, optional
        'start' takes the stress in the geometric stiffness from the start of the step: Newton's iteration then
        converges linearly, but from far away, and needs few tangents. For thin stiff solids in long steps of
        the energy-momentum scheme, immersed ones thinner than the fluid's cells by default; others, and 'F-bar' and
        'mixed', do not heed it.

    Examples
    --------
    >>> import visviva as vv
    >>> block = Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=vv.NeoHooke(young=1e3, poisson=0.3))
    >>> vv.System([block]).n_coordinates
    81
    """

    mesh: Mesh | MeshSource
    material: Material
    density: Number = 0.0
    plane: Plane = "strain"
    formulation: Formulation = "displacement"
    thickness: Number = 1.0
    velocity: VectorOrFunction = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    thermal_strain: NumberAtPlace = 0.0
    lumped: bool = False
    mass_damping: Number = 0.0
    stiffness_damping: Number = 0.0
    tangent: Literal["exact", "start"] | None = None

    def __post_init__(self) -> None:
        for name in ("density", "mass_damping", "stiffness_damping"):
            if getattr(self, name) < 0:
                raise InputError(f"{self.label}: {name} = {getattr(self, name):g} is negative")
        self.grid = self._checked_mesh()
        if self.grid.dimension == 3 and self.plane != "strain":
            raise InputError(
                f"{self.label}: plane = {self.plane!r} is for plane meshes, and its mesh is not plane"
            )
        refuse_thickness(self.label, self.thickness, self.grid.dimension, self.axisymmetric)
        if self.tangent == "start" and self.body_material.energy is not None:
            raise InputError(
                f"{self.label}: tangent='start' needs a material of the core instead of a UserMaterial"
            )
        forms.check(
            self.label,
            self.formulation,
            self.grid,
            self.body_material,
            stress_free_across=self.plane == "stress",
            heated=self._is_heated,
        )
        if not callable(self.thermal_strain) and not self.thermal_strain > -1:
            raise InputError(
                f"{self.label}: thermal_strain = {self.thermal_strain:g} leaves no volume; it must exceed -1"
            )
        if self.grid.dimension == 2 and self.axisymmetric and self.grid.points[:, 0].min() < 0:
            raise InputError(f"{self.label}: an axisymmetric mesh has points at negative radius")

    def _checked_mesh(self) -> Mesh:
        try:
            grid = (self.mesh.build() if isinstance(self.mesh, MeshSource) else self.mesh).check()
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        d = grid.points.shape[1]
        if grid.dimension != d:
            raise InputError(
                f"{self.label}: its mesh has cells {', '.join(grid.cells)} of dimension {grid.dimension} in {d} "
                "dimensions; a solid needs cells of volume, or plane cells with points (n, 2)"
            )
        return grid

    @property
    def _is_shared_out(self) -> bool:
        """Whether each of several processes has some of its elements; else the first one has all."""
        return type(self) is Solid

    @property
    def _is_heated(self) -> bool:
        return callable(self.thermal_strain) or bool(self.thermal_strain)

    # --- geometry, mass and stiffness ----------------------------------------------------------------------
    @property
    def body_material(self) -> Material:
        """The material of its cells; heated ones may take it from elsewhere."""
        return self.material

    @property
    def axisymmetric(self) -> bool:
        return self.plane == "axisymmetric"

    @property
    def modulus(self) -> float:
        lam, mu = self.body_material.lame
        return 3 * mu if not np.isfinite(lam) else mu * (3 * lam + 2 * mu) / (lam + mu)

    def _masses_of_nodes(self) -> Array:
        cells = self.grid.cells.items()
        return nodal_masses(
            self.grid.n_nodes, ((nodes, self._cell_masses(cell, nodes)) for cell, nodes in cells)
        )

    def _cell_masses(self, cell: str, nodes: Ints) -> Array:
        """Masses (m, pairs) of cells between pairs of their nodes."""
        return masses(
            self.grid.points,
            nodes,
            cell,
            self.density,
            thickness=self.thickness,
            axisymmetric=self.axisymmetric,
            lumped=self.lumped,
        )

    def mass_blocks(self, model: Model) -> Iterator[tuple[Ints, Array]]:
        if self.dimension < 3 or not self.density:
            return
        for cell, nodes in self.grid.cells.items():
            a, b = np.triu_indices(nodes.shape[1])
            mass = np.zeros((len(nodes), nodes.shape[1], nodes.shape[1]))
            mass[:, a, b] = mass[:, b, a] = self._cell_masses(cell, nodes)
            yield self.node_unknowns(nodes).astype(np.int64), mass

    # --- what it contributes -------------------------------------------------------------------------------
    def _start(self) -> tuple[Array, Array]:
        """Positions and rates (n, d) of what its places are made of."""
        return self.grid.points, self.initial_velocities()

    def declare(self, model: Model) -> None:
        d = self.dimension
        self.motion = model.field(self, "position", *self._start(), scale=model.length_of(self), node=d)
        if self.formulation == "enhanced":  # d modes per element, without inertia; damping needs their rates
            role = Role.MOTION if self.stiffness_damping > 0 else Role.STATE
            zero = np.zeros((self.grid.n_cells, d, d))
            own = np.repeat(np.arange(len(zero)), d * d)
            self._inner = model.field(
                self, "enhanced", zero, role=role, scale=model.length_of(self), stage=1, node=d, element=own
            )
        elif self.formulation == "mixed":
            self._pressure_numbers, own = forms.pressure_numbers(self.grid, shared_numbers(model, self))
            if self.body_material.split().bulk > forms.STIFFEST * self.body_material.lame[1]:
                own[:] = -1
            self._declare_pressures(model, own)

    def _declare_pressures(self, model: Model, own: Ints) -> None:
        """Make the unknowns of pressures, each of the element `own` (n,) alone, or of several (-1)."""
        free = bool(np.isinf(self.body_material.split().bulk))
        free = free and not any(cell in forms.STABILISED for cell in self.grid.cells)
        role = Role.MULTIPLIER if free else Role.SOLID_PRESSURE
        self._inner = model.field(self, "pressure", 0.0 * own, role=role, stage=1, element=own)

    def contribute(self, model: Model) -> None:
        thin = (
            any(around.is_thin for around in model.announced(self, Wetting))
            and self.body_material.energy is None
        )
        self._starts_stress = (self.tangent or ("start" if thin else "exact")) == "start"
        self._energy = own_energy(
            self.label,
            self.body_material,
            self.formulation,
            in_plane=self.dimension == 2 and not self.axisymmetric,
            across_free=self.plane == "stress",
        )
        # the core does not keep it alive
        self._callback = callback_of(self._energy) if self._energy else None
        self._elements: list[Elements] = []
        self._open_accounts(model)
        own = shared_out(self.grid) if self._is_shared_out else np.ones(self.grid.n_cells, dtype=bool)
        first = 0
        for cell, nodes in self.grid.cells.items():
            some = np.flatnonzero(own[first : first + len(nodes)])
            here = nodes if len(some) == len(nodes) else nodes[some]
            elements = self._elements_of(model, cell, here, first, some)
            model.batch(elements.term)  # of none too: all processes number their terms alike
            if self._is_shared_out:
                model.announce(self, SharedOut(elements.term))
            self._elements += [elements] if len(some) else []
            first += len(nodes)

    def _elements_of(self, model: Model, cell: str, nodes: Ints, first: int, some: Ints) -> Elements:
        """Elements with their nodes (m, k), some of those of their type, numbered from `first`, and their term."""
        if cell == "hex8" and self.formulation == "displacement":
            term, volume = self._bricks(nodes)
        else:
            term, volume = self._kept(cell, nodes, first, some)
        term.name = self.label
        thermal = (
            self._thermal(cell, nodes, solid_rule(self.grid.points, nodes, cell)) if self._is_heated else None
        )
        self._complete(term, cell, nodes, thermal)
        numbers = first + some
        term.book_solid(*self._open_accounts(model), model.index(self), numbers.astype(np.int32))
        return Elements(cell=cell, nodes=nodes, numbers=numbers, thermal=thermal, term=term, volume=volume)

    def _bricks(self, nodes: Ints) -> tuple[Any, Array]:
        """Term of bricks (m, 8), which works out gradients and masses by itself, and volumes (m, q) of its points."""
        return brick_term(
            self.body_material,
            self.node_unknowns(nodes),
            self.grid.points,
            nodes,
            0.0 if self.lumped else self.density,
            self._cell_masses("hex8", nodes) if self.lumped and self.density > 0 else None,
            self._damping(len(nodes)),
        )

    def _kept(self, cell: str, nodes: Ints, first: int, some: Ints) -> tuple[Any, Array]:
        """Term that keeps gradients and masses, and volumes (m, q) of its points."""
        points, d = self.grid.points, self.dimension
        g = self._geometry(cell, nodes)
        index, parameters = self.node_unknowns(nodes), self.body_material.parameters(len(nodes))
        kind = self.body_material.kind
        mass = self._cell_masses(cell, nodes) if self.density > 0 else None
        if self.formulation == "enhanced":
            modes = self._inner.start + (first + some)[:, None] * d * d + d * np.arange(d)
            index = np.hstack([index, modes])
            g = forms.enhanced(points, nodes, cell, g)
            mass = None if mass is None else forms.without_mass(mass, nodes.shape[1], d)
        elif self.formulation == "mixed":
            split = self.body_material.split()
            kind, parameters = split.kind, np.tile(split.constants, (len(nodes), 1))
            index = np.hstack([index, self._inner.start + self._pressure_numbers[cell][some]])
        index = np.ascontiguousarray(index, dtype=np.int32)
        arrays = g.gradients, g.volume, parameters, g.hoop, mass, self._damping(len(nodes))
        return _core.SolidTerm(int(kind), self.body_material.small, index, *arrays), g.volume

    @property
    def _is_damped(self) -> bool:
        return self.mass_damping > 0 or self.stiffness_damping > 0

    def _damping(self, n: int) -> Array | None:
        """Constants (n, 3) of damping."""
        if not self._is_damped:
            return None
        constants = rayleigh(
            self.body_material,
            self.formulation,
            self.mass_damping,
            self.stiffness_damping,
            across_free=self.plane == "stress",
        )
        return np.tile(constants, (n, 1))

    def _complete(self, term: Any, cell: str, nodes: Ints, thermal: Array | None) -> None:
        """Tell the term what it has beside the strains of its cells."""
        term.set_plane_stress(self.plane == "stress" and self._callback is None)
        term.start_stress = self._starts_stress
        if thermal is not None:
            term.set_thermal(thermal)
        if self.formulation == "F-bar":
            middle = forms.centre(self.grid.points, nodes, cell, axisymmetric=self.axisymmetric)
            hoop = None if middle.hoop is None else middle.hoop[:, 0]
            term.set_centre(middle.gradients[:, 0], hoop)
        elif self.formulation == "mixed":
            split = self.body_material.split()
            rule = solid_rule(self.grid.points, nodes, cell)
            shapes = forms.pressure_shapes(self.grid, cell, nodes, rule.points)
            compliance = forms.pressure_compliance(
                self.grid,
                cell,
                nodes,
                bulk=split.bulk,
                shear=self.body_material.lame[1],
                thickness=self.thickness,
                axisymmetric=self.axisymmetric,
            )
            term.set_pressure(shapes, compliance, split.measure, self._inner.multiplier)
        if self._callback is not None:
            term.set_callback(self._callback)

    def _open_accounts(self, model: Model) -> tuple[int, int, int]:
        """Places in the ledger of strain energy, kinetic energy and damping; the same where no elements are."""
        kinetic = model.account(self, "kinetic", "kinetic") if self.density > 0 else -1
        dissipated = model.account(self, "damping", "dissipation") if self._is_damped else -1
        return model.account(self, "strain", "potential"), kinetic, dissipated

    def _thermal(self, cell: str, nodes: Ints, rule: Rule) -> Array:
        """Thermal strains (m, q) at the points of elements; those of F-bar grow like their centre."""
        xi = rule.points
        if self.formulation == "F-bar":
            xi = np.broadcast_to(CELLS[cell].nodes.mean(axis=0), xi.shape)
        return self._free_strains_at(CELLS[cell].N(xi) @ self.points[nodes])

    def _free_strains_at(self, places: Array) -> Array:
        """Thermal strains (m, q) at places (m, q, 3)."""
        if not callable(self.thermal_strain):
            return np.full(places.shape[:2], float(self.thermal_strain))
        X = places.reshape(-1, 3)
        strain = of_places(self.label, "thermal_strain", self.thermal_strain, X, (len(X),))
        if not np.all(strain > -1):
            raise InputError(
                f"{self.label}: thermal_strain = {strain.min():g} leaves no volume; it must exceed -1"
            )
        if len(X):
            change = np.abs(strain - strain.mean())[:, None]
            refuse_gathered(self.label, "thermal_strain", self.thermal_strain, X, strain, change)
        return strain.reshape(places.shape[:2])

    # --- what it shows -------------------------------------------------------------------------------------
    def _evaluated(self, x: Array) -> Iterator[Evaluated]:
        return evaluated(self._elements, x, self.body_material, self.formulation, self._energy)

    def _widths_at_points(self) -> Mapping[str, int]:
        return {name: width for name, (width, _) in QUANTITIES.items()}

    def _whole(self, values: Sequence[Array], numbers: Sequence[Ints]) -> Array:
        """Values (m, ...) of all elements from those of the elements here, by their numbers."""
        alone = world().size == 1 or not self._is_shared_out
        if alone and len(values) == 1:
            return values[0]
        return np.concatenate(values) if alone else whole(values, numbers)

    def _smoothed(self, names: tuple[str, ...], x: Array) -> dict[str, Array]:
        return smoothed(self.grid, names, self._evaluated(x), add_up=self._is_shared_out)

    @property
    def volumes(self) -> list[Array]:
        made = self._elements
        if not self._is_shared_out:
            return [part.volume for part in made]
        found: dict[str, tuple[list[Array], list[Ints]]] = {cell: ([], []) for cell in self.grid.cells}
        for part in made:
            found[part.cell][0].append(part.volume)
            found[part.cell][1].append(part.numbers)
        return [self._whole(*parts) for parts in found.values()]

    def fields(self, x: Array, cell: str | None = None) -> Fields:
        """Strains and stresses (m, q, ...) at the q quadrature points of the m elements at the unknowns `x`.

        Parameters
        ----------
        x : array
            Unknowns of the system, e.g. ``system.x`` or ``result.states[k]``.
        cell : str
            Which cell type, if the mesh has several.
        """
        if cell is None and len(self.grid.cells) > 1:
            raise InputError(f"{self.label} has the cells {', '.join(self.grid.cells)}; say of which")
        if cell not in (None, *self.grid.cells):
            raise InputError(f"{self.label} has no cells {cell!r}{nearest(str(cell), self.grid.cells)}")
        parts = [(k, part) for name, _, k, _, part in self._evaluated(x) if cell in (None, name)]
        numbers = [k for k, _ in parts]
        F, S, W = (
            self._whole([getattr(p, n) for _, p in parts], numbers) for n in ("F", "second_piola", "energy")
        )
        return Fields(F, S, W, self.body_material.small)

    def at_points(self, name: str, x: Array) -> Array:
        width, function = quantity(name)
        found: dict[str, tuple[list[Array], list[Ints]]] = {cell: ([], []) for cell in self.grid.cells}
        for cell, _, numbers, volume, part in self._evaluated(x):
            found[cell][0].append(function(part).reshape(*volume.shape, width))
            found[cell][1].append(numbers)
        return np.concatenate([self._whole(*parts).reshape(-1, width) for parts in found.values()])

    def trouble(self, x: Array) -> str:
        cells = ((nodes, numbers, part.J) for _, nodes, numbers, _, part in self._evaluated(x))
        return super().trouble(x) or flattest(self, x, cells, SQUEEZED)

    def nodal_forces(self, x: Array, cells: NDArray[np.bool_] | None = None) -> Array:
        total = np.zeros((self.grid.n_nodes, 3))
        for part in self._elements:
            n, k = part.nodes.shape
            force = part.term.forces(np.ascontiguousarray(x, dtype=float), 0, n)[:, :k]
            if cells is not None:
                force *= cells[part.numbers, None, None]
            for c in range(self.dimension):
                total[:, c] -= np.bincount(part.nodes.ravel(), force[:, :, c].ravel(), len(total))
        if self._is_shared_out:
            world().sum(total)
        return total
