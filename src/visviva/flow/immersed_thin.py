"""Beams and shells that are carried along by the fluid around them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.body.solid_fields import linear
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Number
from visviva.flow.carried import Carried, Mask
from visviva.flow.location import Place
from visviva.mesh.cells import CELLS
from visviva.mesh.geometry import jacobians
from visviva.mesh.quadrature import mass_rule

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]

WALL = 0.1
"""Share of what can move in the fluid's velocity at a place, below which a wall beside it holds it there."""
LEAKY = 1.5
"""Nodes farther apart than this many edges of the cells around them let the fluid pass."""


@dataclass(config=settings, eq=False, kw_only=True)
class ImmersedThin(Carried):
    """A beam or shell within a fluid: the nodes of its line or middle move with the interpolated velocity.

    Parameters
    ----------
    body : Beam or Shell
        With its own density. It starts with the velocities of the fluid, its directors at rest.
    fluid : Fluid
        In space, or plane with a beam in its plane: a strip of width 1, whose section has the modulus of plane strain.
    displaced : float
        Volume of fluid that it takes the place of, per length of beams, per area of shells: thickness, in plane fluids
        times the width 1.
    damping, sealing, over_walls
        See `Immersed`. By default 0.05, as what is thinner than a cell has there.
    leaves : bool
        Of what is thin, refused.

    Raises
    ------
    InputError
        If a node lies outside of the fluid, nodes are too far apart for the cells around them, or it cannot bend in
        the fluid's plane.

    Notes
    -----
    As for `Immersed`, forces go onto the fluid by the transpose of the interpolation, here from a line or surface. It
    moves with (rho_s - rho_f) times the displaced volume; the rotary inertia of the displaced fluid is left out. Fluid
    in the place of a plane beam is on both of its sides.

    Examples
    --------
    >>> import visviva as vv
    >>> box = vv.RectangleMesh(size=(1, 1), counts=(8, 8), cell="quad4")
    >>> water = vv.Fluid(mesh=box, density=1.0, viscosity=0.1)
    >>> walls = vv.NoSlip(fluid=water, faces="all")
    >>> strip = vv.RectangleSection(width=1.0, height=0.02, young=1e4, density=2.0)
    >>> line = vv.LineMesh(points=[(0.5, 0, 0), (0.5, 0.5, 0)], count=5)
    >>> flap = vv.Beam(mesh=line, section=strip, first=(0, 0, 1))
    >>> held, wet = vv.Clamped(solid=flap, nodes="start"), vv.ImmersedThin(body=flap, fluid=water, displaced=0.02)
    >>> system = vv.System([water, walls, flap, held, wet])
    >>> round(wet.total_mass, 9)
    -0.01
    """

    outside_axes = NOWHERE

    body: MeshBody
    displaced: Number

    def __post_init__(self) -> None:
        super().__post_init__()
        label, body = self.label, self.body
        if type(body).skin is MeshBody.skin:
            raise InputError(f"{label}: {body.label} is not thin; immerse it by vv.Immersed(solid=...)")
        if not self.displaced >= 0:
            raise InputError(f"{label}: displaced = {self.displaced:g} is negative; give thickness or area")
        if self.leaves:
            raise InputError(f"{label}: leaves=True is for solids and rigid bodies; keep {body.label} inside")
        if np.any(body.angular_velocity) or (not callable(body.velocity) and np.any(body.velocity)):
            raise InputError(
                f"{label}: {body.label} starts with the velocity of {self.fluid.label}; leave out its own"
            )
        if self.fluid.dimension == 2 and (not body.has_directions or np.any(body.points[:, 2] != 0)):
            raise InputError(
                f"{label}: {self.fluid.label} is plane; what bends in its plane is a beam with its line at z = 0"
            )

    # --- part in the system ---------------------------------------------------------------------------------
    @property
    def carried(self) -> Component:
        return self.body

    is_thin = True

    def _places(self) -> Array:
        return np.asarray(self.body.points[:, : self.fluid.dimension])

    def declare(self, model: Model) -> None:
        super().declare(model)
        size = self.fluid.dimension * self.body.grid.n_nodes
        self.force = model.multipliers(self, "force", size, instantaneous=False)

    def contribute(self, model: Model) -> None:
        d, motion = self.fluid.dimension, self.body.motion
        places = self._located(self._places())
        self._refuse_gaps(places)
        numbers = self._numbers
        follows = ~motion.fixed[numbers]
        motion.rates[numbers[follows]] = self._velocities(places, self.fluid.flow.values)[follows]
        model.refresh(motion)
        pressed = follows | self._seen(places)
        model.hold(self.force, np.flatnonzero(~pressed.ravel()))
        self.followers = nodes = np.flatnonzero(pressed.any(axis=1))
        self._follow(
            model,
            self.body.node_unknowns(nodes),
            np.ones(len(nodes)),
            self.force.start + d * nodes,
            ~follows[nodes],
        )
        for k, of in zip(*np.nonzero(follows), strict=True):
            model.reductions.eliminate(int(motion.start + numbers[k, of]), int(self.force.start + d * k + of))
        self._displace(model)

    @property
    def _numbers(self) -> NDArray[np.int64]:
        """Of the positions of the nodes (n, d) in the field of the body's motion."""
        first = self.body.node_unknowns(np.arange(self.body.grid.n_nodes)).astype(np.int64)
        return np.asarray(first[:, None] - self.body.motion.start + np.arange(self.fluid.dimension))

    def _seen(self, places: Place) -> Mask:
        """True (n, d) for every axis of a node along which the fluid can move."""
        flow, d = self.fluid.flow, self.fluid.dimension
        unknowns, weights = self.fluid.transfer.at(places)
        free = ~flow.fixed[unknowns[:, :, None] - flow.start + np.arange(d)]
        return np.asarray(np.einsum("nk,nkc->nc", np.abs(weights), free) > WALL)

    def follow_start(self, state: State) -> None:
        """The velocities of the fluid have been made free of divergence: nodes that kept the old ones would swing."""
        motion, d = self.body.motion, self.fluid.dimension
        places = self._located(self.body.positions(state.x)[:, :d])
        free = ~motion.fixed[self._numbers]
        state.v[motion.start + self._numbers[free]] = self._velocities(
            places, state.x[self.fluid.flow.unknowns]
        )[free]

    def _refuse_gaps(self, places: Place) -> None:
        """Refuse nodes between which the fluid would pass."""
        points, d = self._places(), self.fluid.dimension
        edge = float(np.min(self.fluid.grid.volumes[places.cells])) ** (1 / d)
        for kind, cells in self.body.grid.cells.items():
            corners = points[cells[:, : CELLS[kind].n_corners]]
            sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() / (
                1 if CELLS[kind].n_nodes == CELLS[kind].n_corners else 2
            )
            if sides > LEAKY * edge:
                raise InputError(
                    f"{self.label}: nodes of {self.body.label} are {sides:.3g} apart and the cells of "
                    f"{self.fluid.label} around have {edge:.3g}: the fluid would pass between them; refine it "
                    f"{int(np.ceil(sides / edge))} times"
                )

    # --- the fluid that is not there --------------------------------------------------------------------------
    @cached_property
    def _masses(self) -> dict[str, Array]:
        """Masses (m, k, k) of fluid that cells displace between their nodes, negative."""
        found = {}
        for kind, cells in self.body.grid.cells.items():
            N = CELLS[kind].N(mass_rule(kind).points)
            weight = -self.fluid.density * self.displaced * self._sizes(kind, cells)
            found[kind] = np.einsum("mq,qa,qb->mab", weight, N, N)
        return found

    def _sizes(self, kind: str, cells: NDArray[np.int64]) -> Array:
        """Lengths of lines or areas of surfaces (m, q) that the points of cells stand for."""
        xi, w = mass_rule(kind)
        J = jacobians(self.body.points, cells, CELLS[kind].dN(xi))
        if CELLS[kind].dimension == 2:
            return np.asarray(w * np.linalg.norm(np.cross(J[..., 0], J[..., 1]), axis=2))
        return np.asarray(w * np.linalg.norm(J[..., 0], axis=2))

    def shares(self) -> Array:
        """Length of the line, or area of the middle, that each node (n,) at a corner of cells stands for."""
        found = np.zeros(self.body.grid.n_nodes)
        for kind, cells in self.body.grid.cells.items():
            corners = linear(CELLS[kind])
            np.add.at(
                found,
                cells[:, : CELLS[kind].n_corners],
                self._sizes(kind, cells) @ corners.N(mass_rule(kind).points),
            )
        return found

    def _displace(self, model: Model) -> None:
        for kind, cells in self.body.grid.cells.items():
            everywhere = np.ones(cells.shape[1], dtype=bool)
            vectors, masses = self.body.node_unknowns(cells), self._masses[kind]
            self._take_away(model, vectors, masses, everywhere, lambda: None)  # thin ones stay within

    @cached_property
    def _nodal_mass(self) -> Array:
        total = np.zeros(self.body.grid.n_nodes)
        for kind, cells in self.body.grid.cells.items():
            np.add.at(total, cells, self._masses[kind].sum(axis=2))
        return total

    @property
    def total_mass(self) -> float:
        return float(self._nodal_mass.sum())

    def mass_moment(self, x: Array) -> Array:
        return np.asarray(self._nodal_mass @ self.body.positions(x))

    def weigh(self, model: Model, acceleration: Array) -> None:
        force = self._nodal_mass[:, None] * np.asarray(acceleration)[None, : self.fluid.dimension]
        model.dead_forces(self, "gravity", self.body.node_unknowns(np.arange(len(force))), force)

    def point_name(self, k: int) -> str:
        return f"node {k} of {self.body.label}"

    # --- results ----------------------------------------------------------------------------------------------
    def forces(self, x: Array) -> Array:
        """Forces (n, 3) of the fluid on the nodes at the unknowns `x` of the system.

        Of the midpoint schemes they are those of the middle of the last step.
        """
        return self._forces(self.force, x)
