"""Conditions at the boundary of a fluid: walls, prescribed velocities, slip, outlets and tractions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.component import Component, settings
from visviva.errors import InputError, RunError
from visviva.flow.faces import FlowFaces, flow_faces, flux_weights
from visviva.flow.fluid import Fluid
from visviva.form import Form
from visviva.load.force import guarded
from visviva.timefunction import OfTime, forward_rate
from visviva.values import FaceSet, Motion, VectorOrFunction

if TYPE_CHECKING:
    from visviva.model import Model

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


SURGE = 10.0
"""Fluid that comes in through an opening this many times as fast as anything at the start is told of."""


@dataclass(config=settings, eq=False, kw_only=True)
class FluidBoundary(Component):
    """Base of conditions on `faces` of a `fluid`, by the name of their set, or 'all' for the whole boundary."""

    fluid: Fluid
    faces: FaceSet

    rank: ClassVar[int] = 0
    """Who has the nodes that several conditions share: the lowest."""
    prescribes: ClassVar[bool] = False
    """Whether it says at which velocity fluid passes."""

    def __post_init__(self) -> None:
        try:
            self.chosen = self.fluid.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    @property
    def is_open(self) -> bool:
        """Whether fluid may pass at a velocity that the flow finds."""
        return False

    def wanted(self) -> Mask:
        """Components (n_nodes, d) of the velocity that it holds, if nobody of lower rank does."""
        return np.zeros(self.fluid.grid.points.shape, dtype=bool)

    def velocities_at(self, time: float) -> Array:
        """Velocities (n_nodes, d) that it prescribes; zero elsewhere."""
        return np.zeros(self.fluid.grid.points.shape)

    def _on_nodes(self, directions: Any) -> Mask:
        mask = np.zeros(self.fluid.grid.points.shape, dtype=bool)
        mask[self.chosen.nodes] = directions
        return mask


@dataclass(config=settings, eq=False, kw_only=True)
class NoSlip(FluidBoundary):
    """A wall at rest: the fluid sticks to it.

    Nodes that it shares with other conditions are the wall's, the corners of a moving lid for instance.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9"), density=1.0, viscosity=1.0)
    >>> vv.System([water, vv.NoSlip(fluid=water, faces="all")]).n_coordinates
    18
    """

    def wanted(self) -> Mask:
        return self._on_nodes(True)

    def contribute(self, model: Model) -> None:
        model.index(self.fluid)
        numbers = self.fluid.conditions.share(self)
        model.hold(self.fluid.flow, numbers, np.zeros(len(numbers)))


@dataclass(config=settings, eq=False, kw_only=True)
class VelocityBoundary(FluidBoundary):
    """Faces with a prescribed velocity: inflow, outflow, moving walls.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    velocity : callable, or three of number, expression, table, callable or None
        ``f(t, X)`` of time and positions (n, 3) with values (n, 3), or for x, y and z whatever `TimeFunction` takes,
        None or "free" where the velocity is free.

    Notes
    -----
    The ledger books the power of what moves the fluid as "supply". Without an outlet, what flows in has to flow out;
    a difference below a thousandth, as interpolated profiles have it, is taken off the outflow, others are refused.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    >>> lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=("smoothstep(t)", 0, 0))
    >>> walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    >>> system = vv.System([water, lid, *walls])
    """

    velocity: Motion

    rank: ClassVar[int] = 1
    prescribes: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        d = self.fluid.dimension
        moved = (True,) * 3 if callable(self.velocity) else tuple(f is not None for f in self.velocity)
        self._moved = np.array(moved[:d])
        if not self._moved.any():
            raise InputError(f"{self.label}: it prescribes no component of the velocity")
        self._function = guarded(self.label, "velocity", self.velocity) if callable(self.velocity) else None
        try:
            start = self._at_nodes(0.0)
        except RunError as error:
            raise InputError(str(error)) from error
        if d == 2 and np.any(start[:, 2] != 0):
            raise InputError(f"{self.label}: a plane fluid cannot flow out of its plane")

    @property
    def is_open(self) -> bool:
        normal = np.abs(flux_weights(self.fluid.grid, self.chosen))
        return bool(normal[:, ~self._moved].max(initial=0.0) > 1e-9 * normal.max())

    def _at_nodes(self, time: float) -> Array:
        """Velocities (k, 3) of the nodes of its faces."""
        nodes = self.chosen.nodes
        if self._function is None:
            v = np.tile([0.0 if f is None else f(time) for f in self.velocity], (len(nodes), 1))
        else:
            v = np.asarray(self._function(time, self.fluid.points[nodes]), dtype=float)
        if v.shape != (len(nodes), 3) or not np.isfinite(v).all():
            raise RunError(
                f"{self.label}: its velocity has shape {v.shape} for {len(nodes)} positions (n, 3), or is not finite "
                f"at t = {time:g}"
            )
        return v

    def wanted(self) -> Mask:
        return self._on_nodes(self._moved)

    def velocities_at(self, time: float) -> Array:
        v = np.zeros(self.fluid.grid.points.shape)
        v[self.chosen.nodes] = self._at_nodes(time)[:, : self.fluid.dimension]
        return v

    def contribute(self, model: Model) -> None:
        model.index(self.fluid)
        fluid = self.fluid
        numbers = fluid.conditions.share(self)

        def values(time: float) -> Array:
            v = np.zeros((fluid._n_numbers, fluid.dimension))
            v[fluid._number[self.chosen.nodes]] = fluid.conditions.scaled(time, self.velocities_at(time))[
                self.chosen.nodes
            ]
            return v.ravel()[numbers]

        try:
            model.prescribe(self, fluid.flow, numbers, values, lambda time: self._rates(values, time))
        except RunError as error:
            raise InputError(str(error)) from error

    def _rates(self, values: Any, time: float) -> Array:
        rates: Array = forward_rate(values, time)
        return rates


@dataclass(config=settings, eq=False, kw_only=True)
class FreeSlip(FluidBoundary):
    """A frictionless wall or a plane of symmetry: nothing flows through, nothing drags.

    Walls across an axis cost unknowns; others are held by multipliers, one for each node.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9"), density=1.0, viscosity=1.0)
    >>> vv.System([water, vv.FreeSlip(fluid=water, faces="all")]).n_coordinates
    30
    """

    rank: ClassVar[int] = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        self._across = np.zeros(self.fluid.grid.points.shape, dtype=bool)  # of axes, by node
        oblique = np.zeros(self.chosen.n_faces, dtype=bool)
        for p in flow_faces(self.fluid.grid, self.chosen):
            part = np.abs(p.normal).max(axis=1)
            axes = part > 1e-9 * part.max(axis=1, keepdims=True)
            oblique[p.rows] = axes.sum(axis=1) > 1
            flat = p.on_face & ~oblique[p.rows, None]
            np.logical_or.at(self._across, p.nodes, flat[:, :, None] & axes[:, None, :])
        self._oblique = self.chosen.where(oblique)

    def wanted(self) -> Mask:
        return self._across

    def contribute(self, model: Model) -> None:
        model.index(self.fluid)
        numbers = self.fluid.conditions.share(self)
        model.hold(self.fluid.flow, numbers, np.zeros(len(numbers)))
        held = np.logical_or.reduce([c.wanted().all(axis=1) for c in self.fluid.conditions.listed])
        normals = self._normals()
        forms = [self._through(int(k), normals[k]) for k in self._oblique.nodes if not held[k]]
        if not forms:
            return
        multipliers = model.multipliers(self, "reaction", len(forms), block=self)
        for k, form in enumerate(forms):
            model.constrain(self, multipliers, [form], first=k)

    def _normals(self) -> Array:
        """Directions (n_nodes, d) across which nothing flows, so chosen that as a whole nothing flows through.

        Corners of quadratic triangles have no part in that; they take the mean of their faces.
        """
        normal, mean = flux_weights(self.fluid.grid, self._oblique), np.zeros(self.fluid.grid.points.shape)
        for p in flow_faces(self.fluid.grid, self._oblique):
            np.add.at(mean, p.nodes, p.on_face[:, :, None] * p.normal.sum(axis=1)[:, None, :])
        size, full = (np.linalg.norm(a, axis=1, keepdims=True) for a in (normal, mean))
        chosen = np.where(size > 1e-9 * full, normal, mean)
        return np.asarray(chosen / np.maximum(np.linalg.norm(chosen, axis=1, keepdims=True), 1e-300))

    def _through(self, node: int, normal: Array) -> Form:
        first = int(self.fluid.node_unknowns(node))
        return Form(tuple((first + c, float(n)) for c, n in enumerate(normal) if n != 0.0))


@dataclass(config=settings, eq=False, kw_only=True)
class Open(FluidBoundary):
    """Base of faces with tractions; kinetic energy leaves through them, and none enters."""

    rank: ClassVar[int] = 3
    is_developed: ClassVar[bool] = False
    """Whether parallel streams pass undisturbed."""

    @property
    def is_open(self) -> bool:
        return True

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        """Force per area (m, q, 3) on the fluid."""
        raise NotImplementedError

    def trouble(self, x: Array) -> str:
        """Where fluid comes in much faster than anything moved at the start."""
        v, usual = self.fluid.velocities(x)[:, : self.fluid.dimension], float(np.max(self.fluid.flow.scale))
        fastest, place = 0.0, np.zeros(3)
        for p in flow_faces(self.fluid.grid, self.chosen):
            outward = p.normal / np.linalg.norm(p.normal, axis=2, keepdims=True)
            into = -np.sum(np.einsum("mqk,mkd->mqd", p.N, v[p.nodes]) * outward, axis=2)
            if into.max(initial=0.0) > fastest:
                fastest, place = float(into.max()), p.X.reshape(-1, 3)[np.argmax(into)]
        if fastest < SURGE * usual:
            return ""
        where = place[: self.fluid.dimension].round(6).tolist()
        return (
            f"{self.label}: fluid comes back in at {where} with {fastest:.3g}, where {usual:.3g} was the largest "
            "speed at the start; move this boundary downstream of the eddies, raise what is outside slower, or shorten "
            "the step"
        )

    def contribute(self, model: Model) -> None:
        model.index(self.fluid)
        self._loads: list[Any] = []  # functions that the core calls, which does not keep them alive
        for p in flow_faces(self.fluid.grid, self.chosen):
            viscosity = self.fluid.viscosity if self.is_developed else 0.0
            index = np.ascontiguousarray(self.fluid.node_unknowns(p.nodes))
            term = _core.OpenTerm(self.fluid.density, viscosity, index, p.N, p.gradients, p.normal)
            load = self._loader(p)
            self._loads.append(load)
            term.set_load(load, p.normal.size)
            term.name = self.label
            term.book_open(model.account(self, "traction", "work"), model.account(self, "outflow", "work"))
            model.batch(term)

    def _loader(self, p: FlowFaces) -> Any:
        def load(time: float, values: Array) -> None:
            values[:] = self.traction_at(time, p)[:, :, : self.fluid.dimension].ravel()

        return load


@dataclass(config=settings, eq=False, kw_only=True)
class Outlet(Open):
    """An opening against a pressure, through which parallel streams leave undisturbed ("do nothing").

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces.
    pressure : number, expression, table or callable
        Outside, as a function of time, see `TimeFunction`.

    Notes
    -----
    ``mu dv/dn - p n = -pressure n``, and where fluid comes back ``- rho/2 (v.n)- v`` besides, which takes off the
    kinetic energy that it would bring (the directional do-nothing condition of Braack & Mucha 2014).

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    >>> ends = [vv.Outlet(fluid=water, faces="x0", pressure="sin(t)"), vv.Outlet(fluid=water, faces="x1")]
    >>> walls = [vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1")]
    >>> system = vv.System([water, *ends, *walls])
    """

    pressure: OfTime = 0.0
    is_developed: ClassVar[bool] = True

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        outward = p.normal / np.linalg.norm(p.normal, axis=2, keepdims=True)
        found = np.zeros(p.X.shape)
        found[:, :, : self.fluid.dimension] = -self.pressure(time) * outward
        return found


@dataclass(config=settings, eq=False, kw_only=True)
class FluidTraction(Open):
    """Faces on which a force per area acts: Cauchy's stress times the outward normal.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    traction : (3,) or callable
        Force per area; or ``f(t, X)`` of time and positions (n, 3) with values (n, 3).

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    >>> system = vv.System([water, vv.FluidTraction(fluid=water, faces="all", traction=lambda t, X: -X[:, 1:2] * X)])
    """

    traction: VectorOrFunction

    def __post_init__(self) -> None:
        super().__post_init__()
        given = callable(self.traction)
        self._function = guarded(self.label, "traction", self.traction) if given else None
        if not given and self.fluid.dimension == 2 and self.traction[2] != 0:
            raise InputError(f"{self.label}: a plane fluid cannot be loaded out of its plane")

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        if self._function is None:
            return np.broadcast_to(self.traction, p.X.shape)
        places = p.X.reshape(-1, 3)
        found = np.asarray(self._function(time, places), dtype=float)
        if found.shape != places.shape or not np.isfinite(found).all():
            raise RunError(
                f"{self.label}: its traction has shape {found.shape} for positions {places.shape}, or is not finite at "
                f"t = {time:g}"
            )
        return found.reshape(p.X.shape)
