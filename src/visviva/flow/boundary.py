"""Conditions at the boundary of a fluid that hold velocities: walls, prescribed velocities, slip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.differences import forward_rate
from visviva.base.errors import InputError, RunError
from visviva.component.component import settings
from visviva.component.values import FaceSet, Motion
from visviva.flow.boundary_faces import flow_faces, flux_weights
from visviva.flow.conditions import Condition
from visviva.flow.fluid import Fluid
from visviva.load.force import guarded
from visviva.mesh.periodic import refuse_apart
from visviva.model.form import Form

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(config=settings, eq=False, kw_only=True)
class FluidBoundary(Condition):
    """Base of conditions on faces of a fluid that hold velocities.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all' for the whole boundary.
    """

    fluid: Fluid
    faces: FaceSet

    def __post_init__(self) -> None:
        try:
            self.chosen = self.fluid.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    def _on_nodes(self, directions: Any) -> Mask:
        mask = np.zeros(self.fluid.grid.points.shape, dtype=bool)
        mask[self.chosen.nodes] = directions
        return mask


@dataclass(config=settings, eq=False, kw_only=True)
class NoSlip(FluidBoundary):
    """A wall at rest: the fluid sticks to it.

    Nodes that it shares with other conditions are the wall's, the corners of a moving lid for instance.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all' for the whole boundary.

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
            v, nodes = np.zeros((fluid.n_numbers, fluid.dimension)), self.chosen.nodes
            wanted = self.velocities_at(time)
            refuse_apart(self.label, "velocity", fluid.number[nodes], wanted[nodes], time)
            v[fluid.number[nodes]] = fluid.conditions.scaled(time, wanted)[nodes]
            return v.ravel()[numbers]

        def rates(time: float, step: float) -> Array:
            found: Array = forward_rate(values, time, step)
            return found

        try:
            model.prescribe(self, fluid.flow, numbers, values, rates)
        except RunError as error:
            raise InputError(str(error)) from error


@dataclass(config=settings, eq=False, kw_only=True)
class FreeSlip(FluidBoundary):
    """A frictionless wall or a plane of symmetry: nothing flows through, nothing drags.

    Walls across an axis cost unknowns; others are held by multipliers, one for each node.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all' for the whole boundary.

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
