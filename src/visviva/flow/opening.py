"""Openings in the boundary of a fluid: outlets and tractions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError, RunError, named
from visviva.base.places import OfPart
from visviva.base.timefunction import OfTime
from visviva.component.component import settings
from visviva.component.values import VectorOrFunction
from visviva.flow.boundary import FluidBoundary
from visviva.flow.boundary_faces import FlowFaces, flow_faces
from visviva.load.force import guarded

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]

SURGE, LOST = 10.0, 1e6
"""Fluid that comes in through an opening this many times as fast as anything at the start is told of; where it is
faster still, the iteration has lost its way, and an opening is not known to be the cause."""


@dataclass(config=settings, eq=False, kw_only=True)
class Open(FluidBoundary):
    """Base of faces with tractions, through which fluid carries its kinetic energy."""

    rank: ClassVar[int] = 3
    is_developed: ClassVar[bool] = False
    """Whether parallel streams pass undisturbed."""
    directional: ClassVar[bool]
    """Whether fluid that comes in brings no kinetic energy."""

    @property
    def is_open(self) -> bool:
        return True

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        """Force per area (m, q, 3) on the fluid."""
        raise NotImplementedError

    def trouble(self, x: Array) -> str:
        """Place at which fluid comes in much faster than anything moved at the start, in words."""
        v, usual = self.fluid.by_node(x)[:, : self.fluid.dimension], float(np.max(self.fluid.flow.scale))
        fastest, place = 0.0, np.zeros(3)
        for p in flow_faces(self.fluid.grid, self.chosen):
            outward = p.normal / np.linalg.norm(p.normal, axis=2, keepdims=True)
            into = -np.sum(np.einsum("mqk,mkd->mqd", p.N, v[p.nodes]) * outward, axis=2)
            if into.max(initial=0.0) > fastest:
                fastest, place = float(into.max()), p.X.reshape(-1, 3)[np.argmax(into)]
        if not SURGE * usual <= fastest <= LOST * usual:
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
            carried = self.fluid.density if self.fluid.convection else 0.0
            term = _core.OpenTerm(carried, viscosity, self.directional, index, p.N, p.gradients, p.normal)
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
    kinetic energy that it would bring (the directional do-nothing condition of Braack & Mucha 2014). Where fluid comes
    in through such an opening for good, a part ``rho v^2/2`` of the pressure accelerates it: a channel between two
    outlets carries less than one between given pressures. `FluidTraction` gives Cauchy's stress alone, of which the
    viscous part at the end of a channel is a shear that varies across it.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    >>> ends = [vv.Outlet(fluid=water, faces="x0", pressure="sin(t)"), vv.Outlet(fluid=water, faces="x1")]
    >>> walls = [vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1")]
    >>> system = vv.System([water, *ends, *walls])
    """

    pressure: OfTime = 0.0
    directional: ClassVar[bool] = True
    is_developed: ClassVar[bool] = True

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        outward = p.normal / np.linalg.norm(p.normal, axis=2, keepdims=True)
        found = np.zeros(p.X.shape)
        with named(f"{self.label}: its pressure"):
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
    directional : bool
        Where fluid comes in, act by ``rho/2 (v.n) v`` besides, as `Outlet` does: it then brings no kinetic energy, and
        eddies that cross the boundary cannot feed themselves (Braack & Mucha 2014). That is no longer Cauchy's stress:
        a channel between given tractions carries less.

    Notes
    -----
    Fluid that comes in brings its kinetic energy, which the ledger books as work of the outflow.

    Examples
    --------
    >>> import visviva as vv
    >>> water = vv.Fluid(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), density=1.0, viscosity=1.0)
    >>> system = vv.System([water, vv.FluidTraction(fluid=water, faces="all", traction=lambda t, X: -X[:, 1:2] * X)])
    """

    traction: VectorOrFunction
    directional: bool = False  # type: ignore[misc]

    def __post_init__(self) -> None:
        super().__post_init__()
        given = callable(self.traction)
        function = guarded(self.label, "traction", self.traction) if given else None
        self._function = OfPart(self.label, "traction", function) if function else None
        if not given and self.fluid.dimension == 2 and self.traction[2] != 0:
            raise InputError(f"{self.label}: a plane fluid cannot be loaded out of its plane")

    def traction_at(self, time: float, p: FlowFaces) -> Array:
        if self._function is None:
            return np.broadcast_to(self.traction, p.X.shape)
        places = p.X.reshape(-1, 3)
        found = self._function(time, places)
        if found.shape != places.shape or not np.isfinite(found).all():
            raise RunError(
                f"{self.label}: its traction has shape {found.shape} for positions {places.shape}, or is not finite at "
                f"t = {time:g}"
            )
        return found.reshape(p.X.shape)
