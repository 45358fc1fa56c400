"""Fluids: a mesh that stands still, and the velocities and pressures on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError, RunError
from visviva.base.places import OfPart
from visviva.body.solid_term import shared_out
from visviva.component.announcements import SharedOut
from visviva.component.component import settings
from visviva.component.meshed import Meshed
from visviva.component.momentum import Axes, axes_along, by_forces, joined
from visviva.component.values import Number, Pairs, VectorOrField, VectorOrFunction
from visviva.flow.conditions import Conditions
from visviva.flow.divergence import divergence_rows
from visviva.flow.elements import PAIRS, STABILISED, Batch, adapted, pressure_numbers
from visviva.flow.location import Location, Place
from visviva.flow.overlap import refuse_dry
from visviva.flow.sheet import SIGHT, normals
from visviva.flow.transfer import Transfer
from visviva.load.force import guarded
from visviva.load.gravity import Gravity
from visviva.mesh.faces import Faces, chosen_faces
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.periodic import Periods, numbering
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.component.component import RateConstraints
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.output.streamlines import StreamFunction

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(config=settings, eq=False, kw_only=True)
class Fluid(Meshed):
    """An incompressible Newtonian fluid that fills a mesh, paper (24) to (30) and (43).

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Plane or three-dimensional; it does not move. Every face of its boundary needs a condition: `NoSlip`,
        `VelocityBoundary`, `FreeSlip`, `Outlet` or `FluidTraction`, or to be periodic.
    density, viscosity : float
        Mass per volume and dynamic viscosity.
    elements : {'Q2Q1', 'P2P1', 'Q1Q1', 'P1P1'}, optional
        Degrees of velocity and pressure, on quadrilaterals and hexahedra (Q) or triangles and tetrahedra (P); quadratic
        ones make linear meshes quadratic. By default what the cells are. Pairs of equal order are stabilised (SUPG,
        PSPG, LSIC), see :doc:`/theory/flow`.
    velocity : (3,), or a function of positions (n, 3) with values (n, 3)
        At the start.
    body_force : (3,), expressions or callable
        Force per volume; expressions in t, x, y, z, ``("sin(y)", 0, 0)``; or ``f(t, X)`` of time and positions (n, 3)
        with values (n, 3).
    periodic : sequence of (str, str)
        Names of sets of faces whose nodes a translation takes onto each other; they share their unknowns. What is
        immersed passes them, on into the next period.
    dry : bool
        Allow solids, beams, shells, rigid bodies and thermal bodies that lie within the mesh and take no part in the
        flow; else they are refused.
    speed : float, optional
        A velocity that is large in it, by which those found are judged. By default the largest at the start; where
        nothing flows then that of a fall across its mesh by gravity and a constant `body_force`, or 1 (in the units of
        the model) without these: give it if they will be far from that.
    convection : bool
        Without it the flow is that of Stokes: so slow that fluid carries no momentum along. The equations are linear
        then, and one factorisation serves all steps of a length.

    Notes
    -----
    Where no outlet fixes the level of the pressure, one of its unknowns is held, and `pressures` have the mean zero.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.RectangleMesh(size=(2, 1), counts=(8, 4), cell="quad9")
    >>> water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    >>> profile = lambda t, X: X[:, 1:2] * (1 - X[:, 1:2]) * [4, 0, 0]
    >>> inlet = vv.VelocityBoundary(fluid=water, faces="x0", velocity=profile)
    >>> walls = [vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1")]
    >>> system = vv.System([water, inlet, *walls, vv.Outlet(fluid=water, faces="x1")])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> water.at([(1.0, 0.5)]).velocities(system.x).round(9).tolist()
    [[1.0, 0.0, 0.0]]
    """

    mesh: Mesh | MeshSource
    density: Number
    viscosity: Number
    elements: str | None = None
    velocity: VectorOrFunction = (0.0, 0.0, 0.0)
    body_force: VectorOrField = (0.0, 0.0, 0.0)
    periodic: Pairs = ()
    convection: bool = True
    dry: bool = False
    speed: Number | None = None

    def __post_init__(self) -> None:
        for name in ("density", "viscosity"):
            if not getattr(self, name) > 0:
                raise InputError(f"{self.label}: {name} = {getattr(self, name):g} is not positive")
        if self.speed is not None and not self.speed > 0:
            raise InputError(f"{self.label}: speed = {self.speed:g} is not positive")
        self.grid = self._checked_mesh()
        self.number, self.n_numbers = numbering(self.grid, self.periodic, self.label)
        self.pressure_number, self._n_pressures = pressure_numbers(self.grid, self.number)
        self._gravity = np.zeros(3)
        self.carried: dict[str, Callable[[Array], Array]] = {}
        given, what = self.body_force, "body force"
        self._force = OfPart(self.label, what, guarded(self.label, what, given)) if callable(given) else None
        start = self.force_at(0.0, self.points)
        if self.dimension == 2 and np.any(start[:, 2] != 0):
            raise InputError(f"{self.label}: a plane fluid cannot be loaded out of its plane")

    def _checked_mesh(self) -> Mesh:
        try:
            grid = (self.mesh.build() if isinstance(self.mesh, MeshSource) else self.mesh).check()
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        if grid.dimension != grid.points.shape[1] or grid.dimension < 2:
            raise InputError(
                f"{self.label}: its mesh has cells of dimension {grid.dimension} in {grid.points.shape[1]} dimensions; "
                "a fluid needs cells of volume, or plane cells with points (n, 2)"
            )
        return adapted(grid, self.elements, self.label)

    # --- geometry ------------------------------------------------------------------------------------------
    @property
    def is_stabilised(self) -> bool:
        """Whether velocities and pressures are of equal order."""
        return next(iter(self.grid.cells)) in STABILISED

    @cached_property
    def batches(self) -> list[Batch]:
        """Elements by cell type."""
        return [Batch(cell, self.grid.points, nodes) for cell, nodes in self.grid.cells.items()]

    @property
    def total_mass(self) -> float:
        return self.density * self.grid.volume

    def faces(self, chosen: str | Faces) -> Faces:
        """Faces (edges if plane) by the name of their set, 'all' for the whole boundary, or as given."""
        return chosen_faces(self.grid, chosen, self.label)

    # --- forces --------------------------------------------------------------------------------------------
    def force_at(self, time: float, X: Array) -> Array:
        """Body force (n, 3) per volume at a time and positions (n, 3), gravity included."""
        weight = self.density * self._gravity
        if self._force is None:
            return np.broadcast_to(self.body_force + weight, X.shape)
        found = self._force(time, X)
        if found.shape != X.shape or not np.isfinite(found).all():
            raise RunError(
                f"{self.label}: its body force has shape {found.shape} for positions {X.shape}, or is not finite at "
                f"t = {time:g}"
            )
        return found + weight

    def weigh(self, model: Model, acceleration: Array) -> None:
        self._gravity = self._gravity + np.asarray(acceleration, dtype=float)

    @property
    def outside_axes(self) -> Axes:
        _, across = by_forces(
            axes_along(self.periods.shifts)
        )  # what leaves on one side comes in on the other
        return joined(by_forces(axes_along(self.body_force)), ("", across))

    # --- what it contributes -------------------------------------------------------------------------------
    def announce(self, model: Model) -> None:
        self.carried = {}  # nodal fields that others make of the unknowns, by name

    def declare(self, model: Model) -> None:
        if not self.dry:
            refuse_dry(self, model)
        self._gravity = np.zeros(3)
        self.conditions = Conditions(self, model)
        self.transfer = Transfer(self.grid, self.number, self.number_unknowns, self.conditions.walls)
        v = np.zeros((self.n_numbers, self.dimension))
        v[self.number] = self.initial_velocities()
        self._starts_at = max(float(np.linalg.norm(v, axis=1).max()), self.conditions.speed)
        self._falls_at = self._speed_of_fall(model)
        is_balanced = self.conditions.closed and not self.periodic  # by pressures
        known = self.speed or self._starts_at or (0.0 if is_balanced else self._falls_at)
        self.flow = model.field(
            self,
            "velocity",
            v,
            role=Role.VELOCITY,
            scale=known or self._falls_at or 1.0,
            node=self.dimension,
            least=float(known > 0),
        )
        role = Role.FLUID_PRESSURE if self.is_stabilised else Role.MULTIPLIER
        self.pressure = model.field(self, "pressure", np.zeros(self._n_pressures), role=role, stage=1)
        if self.conditions.closed:
            model.hold(self.pressure, [0])

    def _speed_of_fall(self, model: Model) -> float:
        """Of what falls across the fluid by the forces on its volume that do not change.

        At rest pressures balance them to rounding, which is far less than this in all units.
        """
        pulls = [np.asarray(gravity.acceleration, dtype=float) for gravity in model.announced(self, Gravity)]
        if self._force is None:
            pulls.append(np.asarray(self.body_force, dtype=float) / self.density)
        size = float(np.linalg.norm(np.ptp(self.points, axis=0)))
        pull = np.sum(pulls, axis=0)[: self.dimension] if pulls else 0.0
        return float(np.sqrt(np.linalg.norm(pull) * size))

    def initial_velocities(self) -> Array:
        """Velocities (n, d) of the nodes at the start."""
        v = self.sampled(self.velocity)
        if self.dimension == 2 and np.any(v[:, 2] != 0):
            raise InputError(f"{self.label}: a plane fluid cannot flow out of its plane")
        return v[:, : self.dimension]

    @property
    def starts_at_once(self) -> bool:
        """True if the initial velocities differ from those prescribed at the boundary: an impulsive start."""
        v = self.initial_velocities()
        apart = [
            np.where(c.wanted(), c.velocities_at(0.0) - v, 0.0)
            for c in self.conditions.listed
            if c.prescribes
        ]
        return max((float(np.abs(a).max()) for a in apart), default=0.0) > 0.01 * self.conditions.speed

    def contribute(self, model: Model) -> None:
        self._loads: list[Any] = []  # functions that the core calls, which does not keep them alive
        own, first = shared_out(self.grid), 0
        self._own: list[Ints] = []  # elements of each batch that this one of several processes adds
        for batch in self.batches:
            self._own.append(np.flatnonzero(own[first : first + len(batch.nodes)]))
            first += len(batch.nodes)
        pairs = zip(self.batches, self._own, strict=True)
        self._terms = [self._term(model, batch, some) for batch, some in pairs]
        self._factors = [np.ones(len(batch.nodes)) for batch in self.batches]
        self._left_out = [np.zeros((len(batch.nodes), self.dimension)) for batch in self.batches]
        self._sealed: dict[Any, tuple[float, Array]] = {}
        self._thin: dict[Any, tuple[NDArray[np.bool_], Array]] = {}
        for term in self._terms:
            model.batch(term)
            model.announce(self, SharedOut(term))

    def seal(self, owner: object, factor: float, unknowns: Any) -> None:
        """Stabilise elements less all of whose velocities are among `unknowns`, those of every owner together.

        The `factor`, from 1, multiplies the metric that their part of the stabilisation is made of.
        """
        known = np.zeros(self.n_numbers, dtype=bool)
        known[(unknowns - self.flow.start) // self.dimension] = True
        self._sealed[owner] = factor, known[self.number]
        for i, (batch, term) in enumerate(zip(self.batches, self._terms, strict=True)):
            factors = [np.where(at[batch.nodes].all(axis=1), f, 1.0) for f, at in self._sealed.values()]
            self._factors[i] = np.max(factors, axis=0)
            term.scale_metric(self._factors[i][self._own[i]])

    def blind(self, owner: object, unknowns: Any, places: Array) -> None:
        """Stabilise elements, all of whose velocities are among `unknowns`, along a thin body at places (n, d) alone.

        Across it the pressure jumps, and what carries the jump, the force of the body, is not in their residual.
        """
        known = np.zeros(self.n_numbers, dtype=bool)
        known[(unknowns - self.flow.start) // self.dimension] = True
        self._thin[owner] = known[self.number], places.copy()
        for i, (batch, term) in enumerate(zip(self.batches, self._terms, strict=True)):
            directions = np.zeros((len(batch.nodes), self.dimension))
            for around, points in self._thin.values():
                mine = np.flatnonzero(around[batch.nodes].all(axis=1))
                if len(mine):
                    edge = float(np.median(batch.edges[mine]))
                    found = normals(self.periods.copies(points, SIGHT * edge), batch.middles[mine], edge)
                    is_thin = np.abs(found).max(axis=1) > 0
                    directions[mine[is_thin]] = found[is_thin]
            self._left_out[i] = directions
            term.blind(directions[self._own[i]])

    def node_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        """First unknown of the velocity of each node."""
        return self.number_unknowns(self.number[np.asarray(nodes)])

    def number_unknowns(self, numbers: Any) -> NDArray[np.int32]:
        """First unknown of the velocity of nodes by number, which nodes that stand for each other share."""
        return np.asarray(self.flow.start + self.dimension * np.asarray(numbers), dtype=np.int32)

    def pressure_unknowns(self, cell: str) -> NDArray[np.int32]:
        """Unknowns (m, p) of the pressures at the corners of the elements of a cell type."""
        return np.asarray(self.pressure.start + self.pressure_number[cell], dtype=np.int32)

    def _settled(self, batch: Batch) -> list[int]:
        """Pressures that the term of a batch finds at the end of a step, once: all, of the first batch.

        All processes know them.
        """
        first = self.pressure.start
        return list(range(first, first + self._n_pressures)) if batch is self.batches[0] else []

    def _term(self, model: Model, whole: Batch, some: Ints) -> _core.FlowTerm:
        """The core's, of some elements of a batch."""
        batch = Batch(whole.cell, whole.points, whole.nodes[some])
        gradients, volume = batch.geometry()
        pressures = self.pressure_unknowns(batch.cell)
        index = np.hstack([self.node_unknowns(batch.nodes), pressures[some]])
        term = _core.FlowTerm(
            self.density,
            self.viscosity,
            self.convection,
            np.ascontiguousarray(index),
            batch.N,
            batch.M,
            np.ascontiguousarray(gradients),
            np.ascontiguousarray(volume),
            np.ascontiguousarray(self.grid.points[batch.nodes]),
            batch.metric(),
            self._settled(whole),
        )
        term.name = self.label
        force = -1
        if self._is_loaded(model):
            load = self._loader(batch.places)
            self._loads.append(load)
            term.set_force(load, batch.places.size)
            force = model.account(self, "body force", "work")
        term.book_flow(
            model.index(self),
            model.account(self, "kinetic", "kinetic"),
            model.account(self, "viscosity", "dissipation"),
            model.account(self, "stabilisation", "dissipation") if self.is_stabilised else -1,
            force,
            model.account(self, "continuation", "work"),
        )
        return term

    def remarks(self) -> list[str]:
        found = []
        if self.speed is None and not self._starts_at and not self._falls_at:
            found.append(
                f"{self.label}: nothing flows at the start, and velocities are judged against 1; give speed=... if "
                "they will be far from that"
            )
        if not self.is_stabilised:
            return found
        pair = "Q2Q1" if next(iter(self.grid.cells)) in PAIRS["Q1Q1"] else "P2P1"
        return [
            *found,
            f"{self.label}: its stabilisation depends on the step, so that on a fixed mesh the flow converges with the "
            f"first order in the step under every scheme; elements={pair!r} keep the order of the scheme",
        ]

    def rate_constraints(self, state: State) -> RateConstraints | None:
        """Accelerations without divergence; pressures that are multipliers see to that by themselves."""
        if not self.is_stabilised:
            return None
        shape = self.pressure.size, len(state.x)
        flux = divergence_rows(self.batches, self.node_unknowns, self.pressure_number, shape)
        return np.array(self.pressure.unknowns), flux, np.zeros(self.pressure.size)

    def _is_loaded(self, model: Model) -> bool:
        """True if body forces may act on it."""
        weighed = bool(model.announced(self, Gravity))
        return weighed or self._force is not None or bool(np.any(self.body_force))

    def _loader(self, places: Array) -> Any:
        d = self.dimension
        X = np.pad(places.reshape(-1, d), ((0, 0), (0, 3 - d)))

        def load(time: float, values: Array) -> None:
            values[:] = self.force_at(time, X)[:, :d].ravel()

        return load

    # --- what it shows -------------------------------------------------------------------------------------
    def by_node(self, values: Array) -> Array:
        """Velocities of the nodes (n, 3), or their rates, from the unknowns of the system or the rates of these."""
        d = self.dimension
        v = values[self.flow.start : self.flow.start + self.flow.size].reshape(-1, d)[self.number]
        return np.pad(v, ((0, 0), (0, 3 - d)))

    def velocities(self, x: Array, v: Array) -> Array:
        """Velocities (n, 3) at the nodes at the unknowns `x`, which they are among, and rates `v`."""
        return self.by_node(x)

    def pressures(self, x: Array) -> Array:
        """Pressures (n,) at the nodes; where nothing fixes their level, their mean over the fluid is zero."""
        from visviva.flow.flow_fields import nodal_pressures

        return nodal_pressures(self.batches, self._corner_pressures(x), self.grid.n_nodes) - self.level(x)

    def level(self, x: Array) -> float:
        """Constant subtracted from the unknown pressures, so that their mean vanishes where nothing else fixes them."""
        from visviva.flow.flow_fields import mean_pressure

        return mean_pressure(self.batches, self._corner_pressures(x)) if self.conditions.closed else 0.0

    def _corner_pressures(self, x: Array) -> dict[str, Array]:
        """The unknown ones (m, p) of the elements of each cell type."""
        return {cell: x[self.pressure_unknowns(cell)] for cell in self.pressure_number}

    def positions(self, x: Array) -> Array:
        return self.points

    def gauges(self, state: State) -> dict[str, float]:
        from visviva.flow.flow_fields import courant

        if not state.has_inertia:
            return {}
        return {"CFL": courant(self.batches, self.by_node(state.x), state.last_step)}

    def widths(self) -> Mapping[str, int]:
        from visviva.flow.flow_fields import widths

        return widths(self.dimension) | dict.fromkeys(self.carried, 1)

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        from visviva.flow.flow_fields import flow_field

        return {name: flow_field(self, name)(x) for name in names}

    @cached_property
    def streams(self) -> StreamFunction:
        """Solver for its stream function."""
        from visviva.flow.flow_fields import streams

        return streams(self.drawn())

    @cached_property
    def location(self) -> Location:
        """Finds cells by places."""
        return Location(self.grid)

    @cached_property
    def periods(self) -> Periods:
        """By what its mesh continues across periodic faces."""
        return Periods(self.grid, self.periodic)

    def find(self, places: Array) -> tuple[Ints, Array]:
        """Cells (n,) of places (n, d) or their images in a periodic fluid, -1 outside, and reference coordinates."""
        cells, xi = np.full(len(places), -1), np.full(places.shape, np.nan)
        for image in self.periods.images(places):
            lost = cells < 0
            if not lost.any():
                break
            cells[lost], xi[lost] = self.location.find(image[lost])
        return cells, xi

    def wall_places(self, middle: Array) -> Array:
        """Nodes (n, d) of the boundary, but of periodic faces alone, and their images around the middle of a body."""
        nodes = np.unique(
            np.concatenate([c.chosen.nodes for c in self.conditions.listed] or [np.zeros(0, int)])
        )
        return np.vstack(list(self.periods.images(self.grid.points[nodes], middle)))

    def at(self, places: Any) -> Place:
        """Cells in which places (n, d) or (n, 3) lie, and unknowns with weights that interpolate there.

        Beyond periodic faces they are those of their images.

        Raises
        ------
        InputError
            If a place is outside.

        Examples
        --------
        >>> import visviva as vv
        >>> mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
        >>> air = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, velocity=lambda X: X * [1, -1, 0])
        >>> system = vv.System([air, vv.FluidTraction(fluid=air, faces="all", traction=(0, 0, 0))])
        >>> air.at([(0.25, 0.6)]).velocities(system.x).round(9).tolist()
        [[0.25, -0.6, 0.0]]
        """
        return Place(self, np.atleast_2d(np.asarray(places, dtype=float))[:, : self.dimension])
