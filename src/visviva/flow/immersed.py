"""Solids that are carried along by the fluid around them."""

from __future__ import annotations

import warnings
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.director_body import refuse_thin
from visviva.body.element import masses, nodal_masses
from visviva.body.on_splines import OnSplines
from visviva.body.solid import Solid
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.flow.carried import Carried, Cells, Mask
from visviva.flow.location import Place
from visviva.flow.overlap import inside_mesh, refuse_covering
from visviva.flow.sheet import normals

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]

WALL = 0.1
"""Share of what can move in the fluid's velocity at a place, below which a wall beside it holds it there."""
LEAKY = 1.5
"""Elements of solids that are larger than the cells around them by this factor let the fluid pass."""


@dataclass(config=settings, eq=False, kw_only=True)
class Immersed(Carried):
    """A solid within a fluid: its nodes move with the interpolated velocity, paper (31) to (44).

    Parameters
    ----------
    solid : Solid
        Of any material, with its own density. It starts with the velocities of the fluid.
    fluid : Fluid
        It also fills the place of the solid.
    damping : float
        From 0, which damps nothing, to 0.5, where nodes follow the velocities at the end of the step: they go ahead by
        this part of what the velocities change by in the step. Takes away the swinging from step to step that
        stiff solids cause, at the cost of an error of that part of a step in time. By default 0.05 for solids that are
        thinner than the cells around, which the check says, and 0 for others.
    sealing : float
        From 1, for fluids with stabilised elements: their metric around the solid is multiplied by it, so that
        stabilisation lets less of the fluid through thin solids, at the cost of pressures that swing from node to node
        there (Kamensky et al. 2015).
    over_walls : bool
        Allow the solid to cover a part of the fluid's boundary, where the fluid cannot move with it.
    leaves : bool
        Let go of nodes that leave the fluid through an opening: from there on they move by themselves. Without it a
        step that takes a node out is refused.
    massless : bool
        Allow a solid without density; it then takes the inertia of the fluid away that it displaces.

    Raises
    ------
    InputError
        If a node of the solid lies outside of the fluid, the solid covers its boundary or has no density, or the
        dimensions differ.
    RunError
        If a node leaves the fluid later, however short the step: into a wall, or without `leaves`.

    Notes
    -----
    The nodes follow ``q1 - q0 = h I v_m`` (34), or the rate that another scheme takes of them, with the interpolation
    ``I`` where the scheme evaluates forces on the predicted way: linear in the velocities and of the order of the
    scheme. The forces of the solid go onto the fluid by the transpose,
    so that the power is the same on both sides, and momenta and energy balance exactly.

    The solid replaces the inertia and weight of the fluid it displaces, ``(rho_s - rho_f)`` of (39). Its stress is
    added to that of the fluid: inside, the material is visco-elastic with the viscosity of the fluid, and the pressure
    keeps its volume. Nodes that a support holds do not follow the fluid (35).

    Nodes of the solid should be about as far apart as those of the velocity: farther apart the fluid passes between
    them, closer together a stiff solid at rest may creep, see :doc:`/theory/immersed`.

    Examples
    --------
    >>> import visviva as vv
    >>> box = vv.RectangleMesh(size=(1, 1), counts=(8, 8), cell="quad4")
    >>> flow = vv.Fluid(mesh=box, density=1.0, viscosity=0.1, velocity=lambda X: [1, -1, 0] * (X - [0.5, 0.5, 0]))
    >>> patch = vv.RectangleMesh(size=(0.2, 0.2), counts=(2, 2), origin=(0.4, 0.4))
    >>> soft = vv.Solid(mesh=patch, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)
    >>> around = vv.VelocityBoundary(fluid=flow, faces="all", velocity=lambda t, X: [1, -1, 0] * (X - [0.5, 0.5, 0]))
    >>> system = vv.System([flow, around, soft, vv.Immersed(solid=soft, fluid=flow)])
    >>> soft.velocities(system.x, system.v)[0].round(9).tolist()
    [-0.1, 0.1, 0.0]
    """

    outside_axes = NOWHERE

    solid: Solid
    massless: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_thin(self.label, "immerse it by vv.ImmersedThin(body=...)", self.solid)
        if isinstance(self.solid, OnSplines):
            raise InputError(
                f"{self.label}: {self.solid.label} is on splines, which no fluid carries yet; mesh it"
            )
        if self.solid.density == 0 and not self.massless:
            raise InputError(
                f"{self.label}: {self.solid.label} has no density and would take the inertia of {self.fluid.label} "
                "away where it is; give it one, or allow that by massless=True"
            )
        if self.solid.dimension != self.fluid.dimension:
            raise InputError(
                f"{self.label}: {self.solid.label} is of dimension {self.solid.dimension} and {self.fluid.label} of "
                f"dimension {self.fluid.dimension}"
            )
        if self.solid.axisymmetric or self.solid.plane == "stress":
            raise InputError(f"{self.label}: {self.solid.label} must be in plane strain, as the fluid is")
        if np.any(self.solid.velocity) or np.any(self.solid.angular_velocity):
            raise InputError(
                f"{self.label}: {self.solid.label} starts with the velocity of {self.fluid.label}; leave out its own"
            )
        if self.solid.thickness != 1.0:
            raise InputError(f"{self.label}: {self.solid.label} must have the thickness 1 of a plane fluid")

    # --- part in the system ---------------------------------------------------------------------------------
    @property
    def carried(self) -> Component:
        return self.solid

    def _places(self) -> Array:
        return np.asarray(self.solid.grid.points)

    def declare(self, model: Model) -> None:
        super().declare(model)
        size = self.solid.dimension * self.solid.grid.n_nodes
        self.force = model.multipliers(self, "force", size, instantaneous=False)

    def contribute(self, model: Model) -> None:
        d, motion = self.solid.dimension, self.solid.motion
        places, follows = self._located(self.solid.grid.points), ~motion.fixed
        if not self.over_walls:
            grid = self.solid.grid
            covered = inside_mesh(grid, self.fluid.wall_places(grid.points.mean(axis=0)))
            refuse_covering(self.label, self.solid, self.fluid, covered)
        motion.rates[follows] = self._start(places, self.fluid.flow.values)
        model.refresh(motion)
        pressed = follows | self._seen(places)
        model.hold(self.force, np.flatnonzero(~pressed))
        self._nodes = np.flatnonzero(pressed.reshape(-1, d).any(axis=1))
        self._follow(
            model,
            self.solid.node_unknowns(self._nodes),
            np.ones(len(self._nodes)),
            self.force.start + d * self._nodes,
            ~follows.reshape(-1, d)[self._nodes],
        )
        for k in np.flatnonzero(follows if not self.leaves else []):  # what leaves has equations of its own
            model.reductions.eliminate(int(motion.start + k), int(self.force.start + k))
        self._displace(model)
        self._compare_sizes(places.cells)

    def _seen(self, places: Place) -> Mask:
        """True (n d,) for every axis of a node along which the fluid can move: held nodes stop it, except at walls."""
        flow, d = self.fluid.flow, self.fluid.dimension
        unknowns, weights = self.fluid.transfer.at(places)
        free = ~flow.fixed[unknowns[:, :, None] - flow.start + np.arange(d)]
        return np.asarray(np.einsum("nk,nkc->nc", np.abs(weights), free) > WALL).ravel()

    def follow_start(self, state: State) -> None:
        """The velocities of the fluid have been made free of divergence: nodes that kept the old ones would swing."""
        motion, flow = self.solid.motion, self.fluid.flow
        places = self._located(self.solid.positions(state.x)[:, : self.solid.dimension])
        free = motion.start + np.flatnonzero(~motion.fixed)
        state.v[free] = self._start(places, state.x[flow.unknowns])

    @cached_property
    def is_thin(self) -> bool:
        """True if the body is thin at most of its nodes."""
        points = self._places()
        return self.may_be_thin and bool(np.mean(normals(points, points, self._edge).any(axis=1)) > 0.5)

    def remarks(self) -> list[str]:
        """Remarks on what was chosen for a thin solid, and on what only the user can choose."""
        if not self.is_thin:
            return []
        thin, found = f"{self.label}: {self.solid.label} is thinner than a cell", []
        if self.damping is None:
            found.append(
                f"{thin}, so that its nodes go ahead by {self.used_damping:g} of a step's change of velocity, an error "
                "of that part of a step in time; damping=0 leaves that out"
            )
        if self.solid.tangent is None and self.solid.body_material.energy is None:
            found.append(
                f"{thin}, so that its tangents take their stress from the start of a step (tangent='exact')"
            )
        if self.fluid.is_stabilised and self.fluid.starts_at_once:
            found.append(
                f"{thin}, and {self.fluid.label} does not start with the velocities of its boundary: the first step "
                "sees half of them; take one of a thousandth of the others first"
            )
        return found

    def _start(self, places: Place, flow: Array) -> Array:
        """Rates of nodes that nothing holds: the velocities at their places of a fluid with the unknowns `flow`."""
        return np.asarray(self._velocities(places, flow).ravel()[~self.solid.motion.fixed])

    def _compare_sizes(self, cells: Cells) -> None:
        """Warn where the fluid could pass between the nodes of the solid."""
        d = self.solid.dimension
        solid, fluid = (
            np.max(self.solid.grid.volumes) ** (1 / d),
            np.min(self.fluid.grid.volumes[cells]) ** (1 / d),
        )
        if solid > LEAKY * fluid:
            warnings.warn(
                f"{self.label}: the fluid leaks between the nodes of {self.solid.label}: its largest element has a "
                f"size of {solid:.3g}, and the cells of {self.fluid.label} around have {fluid:.3g}; refine it "
                f"{int(np.ceil(solid / fluid))} times in every direction",
                stacklevel=2,
            )

    # --- the fluid that is not there --------------------------------------------------------------------------
    def _masses(self, cell: str) -> Array:
        """Masses (m, pairs) of fluid in the elements of the solid, negative."""
        return -masses(
            self.solid.grid.points,
            self.solid.grid.cells[cell],
            cell,
            self.fluid.density,
            lumped=self.solid.lumped,
        )

    def _displace(self, model: Model) -> None:
        for cell, nodes in self.solid.grid.cells.items():
            k = nodes.shape[1]
            a, b = np.triu_indices(k)
            mass = np.zeros((len(nodes), k, k))
            mass[:, a, b] = mass[:, b, a] = self._masses(cell)
            vectors, everywhere = self.solid.node_unknowns(nodes), np.ones(k, dtype=bool)
            self._take_away(model, vectors, mass, everywhere, partial(self._wet, nodes))

    def _wet(self, nodes: Cells) -> Array | None:
        """The part of elements (m,) that displaces fluid: as long as all of their nodes are within, they do."""
        if self._within is None:
            return None
        gone = np.isin(nodes, self._nodes[~self._within])
        return np.asarray(~gone.any(axis=1), dtype=float)

    @property
    def followers(self) -> Cells:
        """Nodes (k,) of the solid that follow the fluid or press on it, once it is part of a system."""
        return self._nodes

    def point_name(self, k: int) -> str:
        return f"node {self._nodes[k]} of {self.solid.label}"

    @property
    def total_mass(self) -> float:
        return -self.fluid.density * self.solid.grid.volume

    def mass_moment(self, x: Array) -> Array:
        return np.asarray(self._nodal_mass @ self.solid.positions(x))

    @cached_property
    def _nodal_mass(self) -> Array:
        cells = self.solid.grid.cells.items()
        return nodal_masses(self.solid.grid.n_nodes, ((nodes, self._masses(cell)) for cell, nodes in cells))

    def weigh(self, model: Model, acceleration: Array) -> None:
        if self.leaves:
            self._gravity = self._gravity + np.asarray(acceleration)[: self.solid.dimension]
            return
        force = self._nodal_mass[:, None] * np.asarray(acceleration)[None, : self.solid.dimension]
        nodes = np.arange(len(force))
        model.dead_forces(self, "gravity", self.solid.node_unknowns(nodes), force)

    # --- results ----------------------------------------------------------------------------------------------
    def gauges(self, state: State) -> dict[str, float]:
        whole = self.solid.grid.volume
        change = abs(self.solid.volume(state.x) / whole - 1)
        return {"area change" if self.solid.dimension == 2 else "volume change": change}

    def forces(self, x: Array) -> Array:
        """Forces (n, 3) of the fluid on the nodes of the solid at the unknowns `x` of the system.

        Of the midpoint schemes they are those of the middle of the last step.
        """
        return self._forces(self.force, x)
