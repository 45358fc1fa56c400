"""Heat that a fluid carries along."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError
from visviva.body.mesh_points import FacePoints, Points, face_points
from visviva.component.component import Component, settings
from visviva.component.values import Number, NumberAtPlace, Pairs
from visviva.flow.boundary_faces import flux_weights
from visviva.flow.conditions import Condition
from visviva.flow.fluid import Fluid
from visviva.load.gravity import Gravity
from visviva.mesh.faces import Faces, chosen_nodes
from visviva.mesh.quadrature import mass_rule
from visviva.model.field import Field, Role
from visviva.thermal.carried_heat import (
    Buoyancy,
    Carried,
    CarriedHeat,
    HeatOutflow,
    Source,
    ViscousHeat,
    at_corners,
)
from visviva.thermal.carrier import GivenTemperatures, HeatCarrier, HeatInput, Law, known_part, large_change
from visviva.thermal.lift import StabilisedLift

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
SOON = 1e-3
"""Time at which what grows from nothing is told from what stays so."""


@dataclass(config=settings, eq=False, kw_only=True)
class FluidHeat(HeatCarrier):
    """Temperatures of a fluid: ``rho c (T' + v . grad T) = div(k grad T) + heat``.

    Parameters
    ----------
    fluid : Fluid
    conductivity : float
        Heat flows with ``-k grad T`` per area (Fourier).
    capacity : float
        Heat per mass and temperature.
    temperature : float, expression in x, y, z, or function of positions (n, 3) with values (n,)
        At the start.
    reference : float, optional
        The temperature at which the heat content is zero and the density that of the fluid, and of what comes in
        through openings whose temperature nobody prescribes; by default the mean at the start. On elements of first
        order (quad4, tri3, hex8, tet4) constant temperatures away from it are kept only to their order, where streams
        bend: take that of the inflow. Those of second order keep all constants.
    expansion : float
        Growth of volume per temperature: what is warm weighs less (Boussinesq) where there is `Gravity`.
    viscous_heating : bool
        What viscosity takes from the flow becomes heat.
    stabilised : bool
        By upwinding along the flow (SUPG), which vanishes where the equation is met.
    capturing : float
        Share of discontinuity capturing, that takes over- and undershoots off steep fronts: 0 for none, up to 1.

    Notes
    -----
    Temperatures have the shape functions of the velocities, and may be relative. Conditions are those of solids:
    `PrescribedTemperature`, `HeatFlux`, `Convection`, `Radiation`, `HeatSource`, `HeatTie`, with the heat for their
    `body`; faces without any of them let none through but what the fluid carries out. Heat is balanced as a whole to
    the tolerance of the solver. The ledger books what leaves with the fluid as "outflow" and the work of
    expansion as "buoyancy". See :doc:`/theory/heat`.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="quad9")
    >>> air = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.71)
    >>> heat = vv.FluidHeat(fluid=air, conductivity=1.0, capacity=1.0, reference=0.0, expansion=0.71)
    >>> hot = vv.PrescribedTemperature(body=heat, nodes="x0", value=0.5)
    >>> cold = vv.PrescribedTemperature(body=heat, nodes="x1", value=-0.5)
    >>> walls, weight = vv.NoSlip(fluid=air, faces="all"), vv.Gravity(acceleration=(0, -1000, 0))
    >>> system = vv.System([air, heat, hot, cold, walls, weight])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> round(vv.HeatFlow(body=heat, nodes="x0")(system), 2)
    1.12
    """

    fluid: Fluid
    conductivity: Number
    capacity: Number
    temperature: NumberAtPlace = 0.0
    reference: Number | None = None
    expansion: Number = 0.0
    viscous_heating: bool = False
    stabilised: bool = True
    capturing: Number = 0.0

    def __post_init__(self) -> None:
        for name in ("conductivity", "capacity"):
            if not getattr(self, name) > 0:
                raise InputError(f"{self.label}: {name} = {getattr(self, name):g} is not positive")
        if not 0 <= self.capturing <= 1:
            raise InputError(f"{self.label}: capturing = {self.capturing:g} is not between 0 and 1")
        self.grid = self.fluid.grid
        given = self.temperature(self.points.copy()) if callable(self.temperature) else self.temperature
        self.start_temperatures = np.array(
            np.broadcast_to(np.asarray(given, dtype=float), (self.grid.n_nodes,))
        )
        if not np.all(np.isfinite(self.start_temperatures)):
            raise InputError(f"{self.label}: its temperature is not finite everywhere")
        self._zero = float(self.start_temperatures.mean()) if self.reference is None else self.reference

    # --- its mesh ------------------------------------------------------------------------------------------
    thickness = 1.0
    axisymmetric = False

    @property
    def points(self) -> Array:
        return self.fluid.points

    @property
    def periodic(self) -> Pairs:  # type: ignore[override]  # others have none
        return self.fluid.periodic

    @property
    def dimension(self) -> int:
        return self.fluid.dimension

    def nodes(self, chosen: str | Faces | ArrayLike) -> Ints:
        return chosen_nodes(self.grid, chosen, self.label)

    def faces(self, chosen: str | Faces) -> Faces:
        return self.fluid.faces(chosen)

    def cell_points(self) -> Iterator[Points]:
        for batch in self.fluid.batches:
            X = np.pad(batch.places, ((0, 0), (0, 0), (0, 3 - self.dimension)))
            yield Points(nodes=batch.nodes, N=batch.N, X=X, size=batch.geometry()[1])

    def face_points(self, faces: Faces) -> Iterator[FacePoints]:
        return face_points(self.grid, faces)

    # --- what it contributes -------------------------------------------------------------------------------
    def announce(self, model: Model) -> None:
        model.announce(self.fluid, self)

    def declare(self, model: Model) -> None:
        if len(model.announced(self.fluid, FluidHeat)) > 1:
            raise InputError(
                f"{self.label}: {self.fluid.label} has temperatures already; one vv.FluidHeat is enough"
            )
        start = np.zeros(self.fluid.n_numbers)
        start[self.fluid.number] = self.start_temperatures
        scale = large_change(start, self._zero)
        self._scale = scale
        least = known_part(self.start_temperatures - self._zero, scale)
        self.heat = model.field(self, "temperature", start, role=Role.CONTENT, scale=scale, least=least)
        self.fluid.carried["temperature"] = self.temperatures
        self._sources: list[list[Source]] = [[] for _ in self.fluid.batches]
        self._held: list[GivenTemperatures] = []

    @property
    def warmth(self) -> tuple[Field, Field]:
        return self.heat, self.heat

    def temperature_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        """The unknown of each node."""
        return np.asarray(self.heat.start + self.fluid.number[np.asarray(nodes)], dtype=np.int32)

    def _unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        """Of elements or faces (m, k): temperatures, then velocities."""
        first = self.fluid.node_unknowns(nodes)[:, :, None] + np.arange(self.dimension, dtype=np.int32)
        return np.hstack([self.temperature_unknowns(nodes), first.reshape(len(nodes), -1)])

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        shared = given.shared(owner.label, self.fluid.number)
        self._held.append(given)
        try:
            model.prescribe(owner, self.heat, shared.nodes, shared.values, shared.rates, shared.kinks)
        except RunError as error:
            raise InputError(str(error)) from error

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        for batch, sources in zip(self.fluid.batches, self._sources, strict=True):
            if points.nodes is batch.nodes:
                sources.append(lambda time: law(time, points.X, np.zeros_like(points.size))[0])
        model.term(owner, HeatInput(kind, self.temperature_unknowns(points.nodes), points, law))

    @property
    def content(self) -> float:
        """Heat per volume and temperature."""
        return self.fluid.density * self.capacity

    def contribute(self, model: Model) -> None:
        model.index(self.fluid)
        heating = self.fluid.viscosity if self.viscous_heating else 0.0
        for i, (batch, sources) in enumerate(zip(self.fluid.batches, self._sources, strict=True)):
            term = CarriedHeat(
                Carried(batch), self._unknowns(batch.nodes), self.content, self.conductivity, self._zero, heating,
                self.stabilised, self.capturing, self._scale,
            )  # fmt: skip
            term.sources = sources
            model.term(self, term)
            if heating:
                model.term(self, ViscousHeat(term))
            if self.expansion and model.announced(self.fluid, Gravity):
                self._lift(model, term, i)
        self._let_out(model)

    def _lift(self, model: Model, heat: CarriedHeat, batch: int) -> None:
        fluid = self.fluid
        model.term(self, Buoyancy(heat, self._weight))
        if fluid.is_stabilised:
            pressures = fluid.pressure_unknowns(fluid.batches[batch].cell)
            flow = fluid.density, fluid.viscosity, float(fluid.convection)
            model.term(
                self,
                StabilisedLift(
                    heat,
                    pressures,
                    self._weight,
                    *flow,
                    lambda: (fluid._factors[batch], fluid._left_out[batch]),
                ),
            )

    def _weight(self) -> Array:
        """Force (d,) per volume and temperature."""
        acceleration = self.fluid._gravity[: self.dimension]
        return np.asarray(-self.fluid.density * self.expansion * acceleration)

    def _let_out(self, model: Model) -> None:
        d = self.dimension
        for condition in model.announced(self.fluid, Condition):
            if not (condition.is_open or condition.prescribes):
                continue
            faces = condition.chosen
            for cell, p in zip(faces.cells, face_points(self.grid, faces), strict=True):
                across = (p.size[:, :, None] * p.normal)[:, :, :d]
                shapes = p.N, at_corners(cell, mass_rule(cell).points)
                model.term(
                    self, HeatOutflow(self._unknowns(p.nodes), *shapes, across, self.content, self._zero)
                )

    def remarks(self) -> list[str]:
        found = self._on_reference()
        if self.expansion and not np.any(self.fluid._gravity):
            found.append(f"{self.label}: its expansion lifts nothing without vv.Gravity")
        return found

    def _on_reference(self) -> list[str]:
        """On fluid that comes in at other temperatures than the reference, which equal orders do not keep."""
        if not self.fluid.is_stabilised or not hasattr(self, "_held"):  # or not in a system yet
            return []
        brought = [T for time in (0.0, SOON) for T in self._brought(time)]
        apart = max(brought, key=lambda T: abs(T - self._zero), default=self._zero)
        if abs(apart - self._zero) <= 1e-6 * max(abs(apart), abs(self._zero)):
            return []
        return [
            f"{self.label}: fluid comes in at {apart:g}, and the reference is {self._zero:g}; with velocities and "
            "pressures of equal order temperatures are off by a share of the difference where the stream bends; give "
            "reference=..., that of the inflow, or take elements of second order, 'Q2Q1' or 'P2P1'"
        ]

    def _brought(self, time: float) -> Iterator[float]:
        """Temperatures that are held where prescribed velocities lead into the fluid."""
        enters = np.zeros(self.grid.n_nodes, dtype=bool)
        for condition in self.fluid.conditions.listed:
            if condition.prescribes:
                parts = flux_weights(self.grid, condition.chosen) * condition.velocities_at(time)
                enters |= parts.sum(axis=1) < -1e-9 * np.abs(parts).max(initial=0.0)
        for given in self._held:
            yield from given.values(time)[enters[given.nodes]]

    # --- what it shows -------------------------------------------------------------------------------------
    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the nodes at the unknowns `x` of the system."""
        return np.array(x[self.temperature_unknowns(np.arange(self.grid.n_nodes))])
