"""Probes of fluids: forces on faces, flow rates, fields at places, what is left of the divergence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.component.component import settings
from visviva.component.remembered import remembered
from visviva.component.values import FaceSet, Vector3
from visviva.flow.boundary_faces import flow_faces, flux_weights
from visviva.flow.flow_fields import courant, divergence, flow_field
from visviva.flow.fluid import Fluid
from visviva.flow.location import Place
from visviva.measure.measures import Reading
from visviva.measure.names import PARTS, parts_of, quantity_of

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class FlowForce(Reading):
    """Probe: force (3,) of a fluid on faces where its velocity is held, drag and lift.

    It is the residual of the equations that the held velocities leave unanswered, which is as exact as the energy of
    the flow and in exact balance with all other forces, and not an integral of tractions. Forces are those of the last
    step: of the midpoint schemes, `EnergyMomentum` among them, those that acted in its middle, half a step before the
    velocities, pressures and `WallShear` of the state; other schemes balance forces at its end. Nodes at the rim of
    the faces that other faces hold, too, such as the corners of an inlet and a wall, bring a share of the force on
    those, of first order in the mesh. In a closed box, where nothing says how high the pressure is, forces are those
    of another level than `Fluid.pressures` shows; their sum over the whole boundary is the same.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    """

    fluid: Fluid
    faces: FaceSet

    def told_by_state(self, system: System) -> bool:
        return False

    @property
    def quantity(self) -> str:
        return "force"

    def __post_init__(self) -> None:
        self.fluid.faces(self.faces)

    def __call__(self, system: System) -> Array:
        nodes = self.fluid.faces(self.faces).nodes
        unknowns = np.unique(self.fluid.node_unknowns(nodes))[:, None] + np.arange(self.fluid.dimension)
        held = self.fluid.flow.fixed[unknowns - self.fluid.flow.start]
        force = -np.sum(np.where(held, system.holding_forces()[unknowns], 0.0), axis=0)
        return np.pad(force, (0, 3 - self.fluid.dimension))


@dataclass(config=settings, frozen=True, kw_only=True)
class FlowRate(Reading):
    """Probe: volume per time that leaves a fluid through faces.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all'.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 2))
    >>> water = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, velocity=(3, 0, 0))
    >>> system = vv.System([water, vv.FluidTraction(fluid=water, faces="all", traction=(0, 0, 0))])
    >>> float(vv.FlowRate(fluid=water, faces="x1")(system))
    3.0
    """

    fluid: Fluid
    faces: FaceSet

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "flow_rate"

    def __post_init__(self) -> None:
        _ = self._weights

    @remembered("fluid")
    def _weights(self) -> Array:
        return flux_weights(self.fluid.grid, self.fluid.faces(self.faces))

    def __call__(self, system: System) -> float:
        v = self.fluid.velocities(system.x, system.v)[:, : self.fluid.dimension]
        return float(np.sum(self._weights * v))


@dataclass(config=settings, frozen=True, kw_only=True)
class FlowField(Reading):
    """Probe: a field of a fluid at a place.

    Parameters
    ----------
    fluid : Fluid
    field : {'velocity', 'speed', 'pressure', 'vorticity', 'velocity_gradient', 'stress', 'stream_function'}
    at : array (3,)
        Position.
    """

    fluid: Fluid
    field: str = "velocity"
    at: Vector3 = (0.0, 0.0, 0.0)

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return quantity_of(self.field)

    @property
    def parts(self) -> tuple[str, ...]:
        return parts_of(self.field, len(PARTS.get(self.field, ())))

    def __post_init__(self) -> None:
        flow_field(self.fluid, self.field)
        _ = self._place

    @remembered("fluid")
    def _place(self) -> Place:
        return self.fluid.at(self.at)

    def __call__(self, system: System) -> Any:
        if self.field == "pressure":
            return float(self._place.pressures(system.x)[0])
        return self._place.of_nodes(flow_field(self.fluid, self.field)(system.x))[0]


@dataclass(config=settings, frozen=True, kw_only=True)
class WallShear(Reading):
    """Probe: mean shear stress (3,) that a fluid exerts on faces, along them, where its normal looks out of the fluid.

    It is read off the gradients of the velocity at the faces' points, of one order less than the force of `FlowForce`,
    and belongs to the present instant, the end of the last step; `FlowForce` of the midpoint schemes to its middle.

    Parameters
    ----------
    fluid : Fluid
    faces : str or Faces
        Name of a set of faces, or 'all'.

    Examples
    --------
    A shear flow of rate 3 with the viscosity 0.5 drags its wall along:

    >>> import visviva as vv
    >>> mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 2), cell="quad9")
    >>> oil = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.5, velocity=lambda X: X[:, [1, 2, 2]] * (3, 0, 0))
    >>> system = vv.System([oil, vv.FluidTraction(fluid=oil, faces="all", traction=(0, 0, 0))])
    >>> vv.WallShear(fluid=oil, faces="y0")(system).round(9).tolist()
    [1.5, 0.0, 0.0]
    """

    fluid: Fluid
    faces: FaceSet

    def __post_init__(self) -> None:
        self.fluid.faces(self.faces)

    @property
    def quantity(self) -> str:
        return "stress"

    def told_by_state(self, system: System) -> bool:
        return True

    def __call__(self, system: System) -> Array:
        v, d = self.fluid.by_node(system.x), self.fluid.dimension
        total, area = np.zeros(3), 0.0
        for part in flow_faces(self.fluid.grid, self.fluid.faces(self.faces)):
            L = np.einsum("mki,mqkj->mqij", v[part.nodes][..., :d], part.gradients)
            size = np.linalg.norm(part.normal, axis=2)
            n = part.normal / size[..., None]
            t = -self.fluid.viscosity * np.einsum("mqij,mqj->mqi", L + np.swapaxes(L, 2, 3), n)
            along = t - np.einsum("mqi,mqi->mq", t, n)[..., None] * n
            total[:d] += np.einsum("mq,mqi->i", size, along)
            area += float(size.sum())
        return total / area


@dataclass(config=settings, frozen=True, kw_only=True)
class Courant(Reading):
    """Probe: largest part of a cell that a fluid passed in the last step (CFL number); 0 before the first.

    Steps may be as long as accuracy allows: all schemes are implicit. About 1 resolves what the flow carries along.

    Parameters
    ----------
    fluid : Fluid

    Examples
    --------
    >>> import visviva as vv
    >>> square = vv.RectangleMesh(size=(1, 1), counts=(4, 4))
    >>> stream = {"velocity": (2, 0, 0), "periodic": (("x0", "x1"), ("y0", "y1"))}
    >>> air = vv.Fluid(mesh=square, density=1.0, viscosity=1.0, **stream)
    >>> system = vv.System([air])
    >>> _ = vv.simulate(system, until=0.1, step=0.1)
    >>> round(vv.Courant(fluid=air)(system), 9)  # 2 times 0.1 in cells of 0.25
    0.8
    """

    fluid: Fluid

    def told_by_state(self, system: System) -> bool:
        return False

    def __call__(self, system: System) -> float:
        return courant(self.fluid.batches, self.fluid.by_node(system.x), system.last_step)


@dataclass(config=settings, frozen=True, kw_only=True)
class Divergence(Reading):
    """Probe: root mean square of the divergence of a fluid's velocity over its volume (1 per time).

    Parameters
    ----------
    fluid : Fluid
    """

    fluid: Fluid

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "rate"

    def __call__(self, system: System) -> float:
        return divergence(self.fluid.batches, self.fluid.by_node(system.x))
