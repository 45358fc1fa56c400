"""Bodies that conduct heat and do not move."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError, nearest
from visviva.body.element import Geometry, geometry, is_curved
from visviva.body.mesh_points import FacePoints, Points, cell_points, face_points
from visviva.body.solid_fields import Valued, means
from visviva.body.solid_term import shared_out
from visviva.component.announcements import SharedOut
from visviva.component.component import Component, settings
from visviva.component.meshed import Meshed, refuse_thickness
from visviva.component.values import Matrix, Number, NumberAtPlace, positive_tensor
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces, chosen_faces, chosen_nodes
from visviva.mesh.generate import MeshSource
from visviva.mesh.mesh import Mesh
from visviva.mesh.quadrature import mass_rule, stiffness_rule
from visviva.model.field import Field, Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.model.term import Stencils, Term
from visviva.thermal.capacity import capacity_of
from visviva.thermal.carrier import GivenTemperatures, HeatCarrier, HeatInput, Law, known_part, large_change

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
FIELDS = {"temperature": 1, "heat_flux": 3}


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalBody(Meshed, HeatCarrier):
    """A body that stores and conducts heat on a mesh that stands still: ``c T' = div(k grad T)``.

    Parameters
    ----------
    mesh : Mesh, or a generator or file that gives one
        Three-dimensional, or plane.
    conductivity : float, or array (3,) or (3, 3)
        Isotropic, along the axes, or a symmetric tensor; heat flows with ``-k grad T`` per area (Fourier).
    capacity : float, or rows of temperature and capacity
        Heat per mass and temperature; per volume where `density` is 1. Between the rows of a table, six at most, it is
        linear, beyond its ends it stays.
    density : float
    temperature : float, expression in x, y, z, or function of positions (n, 3) with values (n,)
        At the start.
    reference : float
        The temperature at which conductivity and capacity are as given, and the heat content is zero.
    conductivity_slope, capacity_slope : float
        Their change per temperature, as a share of what they are at the reference: ``k (1 + slope (T - reference))``.
    thickness : float
        Of a plane body; what is axisymmetric has none.
    axisymmetric : bool
        A plane mesh stands for a revolution; its coordinates are (radius, axis).

    Notes
    -----
    Temperatures may be relative, in degrees Celsius say, since nothing here asks for the absolute ones; the ledger
    then has no entropy. The heat content is booked as stored energy. With `EnergyMomentum` and `BackwardEuler` it
    changes by exactly what flows in, however the capacity depends on the temperature; `BDF2` and `GeneralizedAlpha`
    apply their formulas to the heat content. No scheme misses latent heat that a step jumps over.

    Examples
    --------
    >>> import visviva as vv
    >>> bar = vv.BoxMesh(size=(1, 0.1, 0.1), counts=(10, 1, 1))
    >>> body = vv.ThermalBody(mesh=bar, conductivity=2.0, capacity=1.0)
    >>> cold = vv.PrescribedTemperature(body=body, nodes="x0", value=0.0)
    >>> hot = vv.PrescribedTemperature(body=body, nodes="x1", value=10.0)
    >>> system = vv.System([body, cold, hot])
    >>> _ = vv.quasi_static(system, until=1.0, step=1.0)
    >>> float(vv.TemperatureAt(body=body, at=(0.25, 0, 0))(system).round(12))
    2.5
    """

    mesh: Mesh | MeshSource
    conductivity: Number | Matrix
    capacity: Number | tuple[tuple[Number, Number], ...] = 1.0
    density: Number = 1.0
    temperature: NumberAtPlace = 0.0
    reference: Number = 0.0
    conductivity_slope: Number = 0.0
    capacity_slope: Number = 0.0
    thickness: Number = 1.0
    axisymmetric: bool = False

    def __post_init__(self) -> None:
        if not self.density > 0:
            raise InputError(f"{self.label}: density = {self.density:g} is not positive")
        try:
            self.grid = (self.mesh.build() if isinstance(self.mesh, MeshSource) else self.mesh).check()
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        if self.grid.dimension != self.grid.points.shape[1]:
            raise InputError(
                f"{self.label}: its mesh has cells {', '.join(self.grid.cells)}; it needs cells of volume, or plane "
                "cells with points (n, 2)"
            )
        refuse_thickness(self.label, self.thickness, self.grid.dimension, self.axisymmetric)
        if self.axisymmetric and (self.grid.dimension == 3 or self.grid.points[:, 0].min() < 0):
            raise InputError(f"{self.label}: axisymmetric is for plane meshes at positive radius")
        self._tensor = positive_tensor(self.label, "the conductivity", self.conductivity)
        self._stores = capacity_of(self.label, self.capacity, self.capacity_slope, self.reference)
        self.start_temperatures = self._initial()
        if beyond := self.beyond_slopes(self.start_temperatures):
            raise InputError(beyond)

    def _initial(self) -> Array:
        given = self.temperature(self.points.copy()) if callable(self.temperature) else self.temperature
        start = np.array(np.broadcast_to(np.asarray(given, dtype=float), (self.grid.n_nodes,)))
        if not np.all(np.isfinite(start)):
            raise InputError(f"{self.label}: its temperature is not finite everywhere")
        return start

    @property
    def conducts_evenly(self) -> bool:
        """Whether its tangent is symmetric: conductivity does not depend on the temperature."""
        return self.conductivity_slope == 0

    def beyond_slopes(self, temperatures: Array) -> str:
        """Say which of conductivity and capacity is not positive at some of these temperatures; empty if none."""
        for what in ("conductivity", "capacity"):
            slope = getattr(self, f"{what}_slope")
            least = 1 + slope * (temperatures - self.reference)
            if np.any(least <= 0):
                worst = float(temperatures[np.argmin(least)])
                return (
                    f"{self.label}: its {what} is not positive at a temperature of {worst:g}; {what}_slope = {slope:g} "
                    f"holds from the reference {self.reference:g} to {self.reference - 1 / slope:g}"
                )
        return ""

    # --- its mesh ------------------------------------------------------------------------------------------
    def nodes(self, chosen: str | Faces | ArrayLike) -> Ints:
        """Nodes (k,) by the name of a set of nodes or faces, 'all', `Faces`, or their numbers.

        Raises
        ------
        InputError
            If there is no such set or node.
        """
        return chosen_nodes(self.grid, chosen, self.label)

    def faces(self, chosen: str | Faces) -> Faces:
        """Faces (edges if plane) by the name of their set, 'all' for the whole boundary, or as given."""
        return chosen_faces(self.grid, chosen, self.label)

    def cell_points(self) -> Iterator[Points]:
        """Quadrature points of the cells for sources, type by type."""
        return cell_points(self.grid, thickness=self.thickness, axisymmetric=self.axisymmetric)

    def face_points(self, faces: Faces) -> Iterator[FacePoints]:
        """Quadrature points of faces for what flows through them, type by type."""
        return face_points(self.grid, faces, thickness=self.thickness, axisymmetric=self.axisymmetric)

    @cached_property
    def _geometries(self) -> list[Geometry]:
        """Gradients and volumes of the cells, type by type."""
        extra: Any = {"thickness": self.thickness, "axisymmetric": self.axisymmetric}
        cells = self.grid.cells.items()
        return [geometry(self.grid.points, n, cell, rule=mass_rule(cell), **extra) for cell, n in cells]

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        T = self.start_temperatures
        scale = large_change(T)
        least = known_part(T, scale)
        self.heat = model.field(self, "temperature", T, role=Role.CONTENT, scale=scale, least=least)

    @property
    def warmth(self) -> tuple[Field, Field]:
        return self.heat, self.heat

    def temperature_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        """The unknown of each node."""
        return np.asarray(self.heat.start + np.asarray(nodes), dtype=np.int32)

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        model.prescribe(owner, self.heat, given.nodes, given.values, given.rates, given.kinks)

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        model.term(owner, HeatInput(kind, self.temperature_unknowns(points.nodes), points, law))

    def contribute(self, model: Model) -> None:
        stores = self._stores.times(self.density)
        constants = [stores.c, self.reference, *stores.parameters(), *self._tensor, self.conductivity_slope]
        kind = PhysicsKind.CONDUCTION if stores.is_constant else PhysicsKind.LATENT_CONDUCTION
        # What remembers where a step began one process has as a whole, and goes on with any number of them.
        remembers = not stores.is_constant
        own, first = np.ones(self.grid.n_cells, dtype=bool) if remembers else shared_out(self.grid), 0
        for (cell, nodes), g in zip(self.grid.cells.items(), self._geometries, strict=True):
            some, first = (
                own[first : first + len(nodes)],
                first + len(nodes),
            )  # or none: terms are numbered alike
            N = CELLS[cell].N(mass_rule(cell).points)
            gradients, volume = g.gradients[some], g.volume[some]
            m, q, k, d = gradients.shape
            weights = np.zeros((m, q, k, 4))
            weights[..., 0], weights[..., 1 : 1 + d] = N, gradients
            group = Group(self.temperature_unknowns(nodes[some]), weights)
            term = add_points(model, self, kind, [group], volume, constants)
            if not remembers:
                model.announce(self, SharedOut(term))

        if self.conductivity_slope or self.capacity_slope:
            unknowns = self.temperature_unknowns(np.arange(self.grid.n_nodes))
            model.term(self, Bounds(unknowns, self.beyond_slopes))

    def trouble(self, x: Array) -> str:
        return self.beyond_slopes(self.temperatures(x))

    # --- what it shows -------------------------------------------------------------------------------------
    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the nodes at the unknowns `x` of the system."""
        return np.array(x[self.heat.start : self.heat.start + self.heat.size])

    def positions(self, x: Array) -> Array:
        return self.points

    def velocities(self, x: Array, v: Array) -> Array:
        return np.zeros_like(self.points)

    def widths(self) -> Mapping[str, int]:
        return FIELDS

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        for name in names:
            if name not in FIELDS:
                raise InputError(f"{self.label} has no field {name!r}{nearest(name, FIELDS)}")
        return {n: self.temperatures(x) if n == "temperature" else self.heat_flux(x) for n in names}

    def heat_flux(self, x: Array) -> Array:
        """Heat (n, 3) that flows per area and time, at the nodes.

        In every element the polynomial of least squares through what flows at the points of quadrature is taken to its
        nodes, and a node has the mean of its elements, as stresses of a `Solid`; at walls elements of first order give
        that of half a cell inside (`HeatFlow` tells what passes).
        """
        T = self.temperatures(x)
        return np.pad(means(self.grid, self.dimension, self._fluxes(T)), ((0, 0), (0, 3 - self.dimension)))

    def _fluxes(self, T: Array) -> Iterator[Valued]:
        """What flows at the points of quadrature, of each type of cell."""
        K = self._tensor[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]][: self.dimension, : self.dimension]
        for cell, nodes in self.grid.cells.items():
            rule = stiffness_rule(cell, is_curved(self.grid.points, nodes, cell))
            g = geometry(self.grid.points, nodes, cell, rule=rule)
            slope = np.einsum("mqkd,mk->mqd", g.gradients, T[nodes])
            there = T[nodes] @ CELLS[cell].N(rule.points).T
            conductivity = 1 + self.conductivity_slope * (there - self.reference)
            yield cell, nodes, g.volume, -conductivity[:, :, None] * (slope @ K)


class Bounds(Term):
    """Ends a run whose temperatures leave the range where conductivity and capacity are positive."""

    kind = "bounds"

    def __init__(self, unknowns: NDArray[np.int32], trouble: Callable[[Array], str]) -> None:
        super().__init__()
        self.unknowns, self.order, self._trouble = unknowns[:, None], np.ones(1, dtype=np.int32), trouble

    def residual(self, s: Stencils) -> Array:
        return np.zeros_like(s.x1)

    def tangent(self, s: Stencils) -> Array:
        return np.zeros((len(s.x1), 1, 1))

    def work(self, s: Stencils) -> Array:
        return np.zeros(len(s.x1))

    def accept(self, s: Stencils) -> None:
        if beyond := self._trouble(s.x1[:, 0]):
            raise RunError(beyond)
