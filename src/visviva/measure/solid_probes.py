"""Probes of solids: displacements, velocities, fields, extremes, forces on supports and in sections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, nearest
from visviva.body.director_body import DirectorBody, refuse_thin
from visviva.body.element import masses, nodal_masses
from visviva.body.mesh_body import MeshBody
from visviva.component.component import settings
from visviva.component.meshed import Meshed
from visviva.component.remembered import remembered
from visviva.component.values import Nodes, Vector3
from visviva.component.where import point_of
from visviva.load.support import SymmetryPlane
from visviva.measure.measures import Reading, remembers, touches
from visviva.measure.names import SINGLE, parts_of, quantity_of
from visviva.mesh.locate import locate

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class Displacement(Reading):
    """Probe: displacement (3,) of a point since the start, or along `direction`.

    Parameters
    ----------
    of : component or Point
    at : array (3,)
        Place of the point at the start, if `of` is a component.
    direction : array (3,)
        Record the component along it alone.
    """

    of: Any
    at: Vector3 | None = None
    direction: Vector3 | None = None

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "length"

    def __call__(self, system: System) -> Any:
        place = point_of("Displacement", self.of, self.at).position
        return along(place.value(system.x) - place.value(system.model.initial[0]), self.direction)


@dataclass(config=settings, frozen=True, kw_only=True)
class Velocity(Reading):
    """Probe: velocity (3,) of a point (length per time), or along a direction.

    Parameters
    ----------
    of : component or Point
    at : array (3,), optional
        Place of the point at the start (length), if `of` is a component; by default its origin.
    direction : array (3,), optional
        Take the component along it alone, times its length.
    """

    of: Any
    at: Vector3 | None = None
    direction: Vector3 | None = None

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "velocity"

    def __call__(self, system: System) -> Any:
        place = point_of("Velocity", self.of, self.at).position
        return along(place.rate(system.v), self.direction)


@dataclass(config=settings, frozen=True, kw_only=True)
class FieldAt(Reading):
    """Probe: a field of what has a mesh, smoothed to nodes, at a place.

    Parameters
    ----------
    solid : Solid, ThermalBody, CahnHilliard or another body on a mesh
    field : str
        See `Solid.nodal`; or a component of it, such as ``cauchy_xx``.
    at : array (3,)
        Reference position.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.LinearElastic(young=2.0, poisson=0.0)
    >>> bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(2, 1, 1)), material=steel)
    >>> system = vv.System([bar])
    >>> system.x[bar.node_unknowns(range(bar.grid.n_nodes))] *= 1.1
    >>> vv.FieldAt(solid=bar, field="cauchy", at=(1.5, 0.5, 0.5))(system)[:3].round(12).tolist()
    [0.2, 0.0, 0.0]
    """

    solid: Meshed
    field: str = "von_mises"
    at: Vector3 = (0.0, 0.0, 0.0)

    @property
    def quantity(self) -> str:
        return quantity_of(self.field)

    @property
    def parts(self) -> tuple[str, ...]:
        return parts_of(self.field, width_of(self.solid, self.field))

    def __post_init__(self) -> None:
        width_of(self.solid, self.field)
        _ = self._place

    @remembered("solid")
    def _place(self) -> tuple[Any, Array]:
        return locate(self.solid.grid, self.at[: self.solid.dimension], self.solid.label)

    def __call__(self, system: System) -> Any:
        (nodes, weights), (whole, part) = self._place, within(self.field)
        found = np.tensordot(weights, self.solid.smoothed([whole], system.x)[whole][nodes], axes=1)
        return found if part is None else found[part]


@dataclass(config=settings, frozen=True, kw_only=True)
class Extreme(Reading):
    """Probe: the largest or smallest value of a field of what has a mesh.

    Of stresses and strains it is over the quadrature points, of what nodes have, such as temperature or damage, over
    these.

    Parameters
    ----------
    solid : Solid, ThermalBody, CahnHilliard or another body on a mesh
    field : str
        See `Solid.nodal`; of a field with components, the extreme of each, or of one, such as ``cauchy_xx``.
    which : {'max', 'min'}

    Examples
    --------
    >>> import visviva as vv
    >>> wall = vv.BoxMesh(size=(0.2, 1, 1), counts=(4, 1, 1))
    >>> body = vv.ThermalBody(mesh=wall, conductivity=1.0, capacity=1.0, density=1.0, temperature=310.0)
    >>> vv.Extreme(solid=body, field="temperature")(vv.System([body]))
    310.0
    """

    solid: Meshed
    field: str = "von_mises"
    which: Literal["max", "min"] = "max"

    @property
    def quantity(self) -> str:
        return quantity_of(self.field)

    @property
    def parts(self) -> tuple[str, ...]:
        return parts_of(self.field, width_of(self.solid, self.field))

    def __post_init__(self) -> None:
        width_of(self.solid, self.field)

    def __call__(self, system: System) -> Any:
        whole, part = within(self.field)
        values = self.solid._samples(whole, system.x)
        found = values.max(axis=0) if self.which == "max" else values.min(axis=0)
        return float(found[part or 0]) if width_of(self.solid, self.field) == 1 else found


@dataclass(config=settings, frozen=True, kw_only=True)
class Volume(Reading):
    """Probe: present volume of a solid, of the whole revolution if it is axisymmetric, else its area if it is plane.

    Parameters
    ----------
    solid : Solid

    Examples
    --------
    >>> import visviva as vv
    >>> sheet = vv.RectangleMesh(size=(2.0, 0.5), counts=(2, 1))
    >>> pad = vv.Solid(mesh=sheet, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0)
    >>> vv.Volume(solid=pad)(vv.System([pad]))
    1.0
    """

    solid: MeshBody

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "volume" if self.solid.dimension == 3 or self.solid.axisymmetric else "area"

    def __call__(self, system: System) -> float:
        return self.solid.volume(system.x)


@dataclass(config=settings, frozen=True, kw_only=True)
class SupportForce(Reading):
    """Probe: force (3,) by which supports hold nodes of a solid: `Fixed`, `Prescribed`, `SymmetryPlane`.

    Joints have their `ReactionForce`, contact has its `ContactForce`. Forces are those of the last step:
    of the midpoint schemes, the means over it. Where functions of time drive motion those would alternate, and the
    forces of the present instant are taken (:doc:`/theory/schemes`).

    Parameters
    ----------
    solid : Solid
    nodes : str or array of int
        A set of the mesh, or numbers of nodes; all if not given.
    """

    solid: MeshBody
    nodes: Nodes | None = None

    def told_by_state(self, system: System) -> bool:
        return not (system.has_inertia or remembers(system) or touches(system))

    @property
    def quantity(self) -> str:
        return "force"

    def __post_init__(self) -> None:
        if self.nodes is not None:
            self.solid.nodes(self.nodes)

    def __call__(self, system: System) -> Array:
        force: Array = self.by_node(system).sum(axis=0)
        return force

    def _forces(self, system: System) -> Array:
        """Residual by unknown: means over the last step, by which momenta change, unless what is driven spoils them."""
        driving = system.model.driving
        if system.solves_means and system.has_inertia and (driving.is_driven or driving.prescribed):
            return system.present.holding_forces()
        return system.holding_forces()

    def by_node(self, system: System) -> Array:
        """Forces (n, 3) on all nodes, or control points of splines, zero on those that are free or not chosen."""
        solid = self.solid
        force = solid.carriers.vectors(self._held(system))
        for plane in system.model.announced(solid, SymmetryPlane):
            np.add.at(force, *plane.reactions(system))
        return self._chosen * force

    def _held(self, system: System) -> Array:
        """Forces by unknown, zero on those that are free."""
        motion, held = self.solid.motion, np.zeros(len(system.x))
        held[motion.start : motion.start + motion.size] = motion.fixed
        forces: Array = held * self._forces(system)
        return forces

    @property
    def _chosen(self) -> Array:
        """1 for the chosen nodes (n, 1), or control points of splines, else 0."""
        carriers = self.solid.carriers
        if self.nodes is None:
            return np.ones((len(carriers.points), 1))
        chosen = np.zeros((len(carriers.points), 1))
        chosen[carriers.held(self.solid.nodes(self.nodes))] = 1.0
        return chosen


@dataclass(config=settings, frozen=True, kw_only=True)
class SupportTorque(SupportForce):
    """Probe: torque (3,) of the same forces about a point in space, with the present lever arms.

    At clamped nodes of beams the torque that holds their directors is part of it.

    Parameters
    ----------
    solid : Solid
    nodes : str or array of int, optional
        A set of the mesh, or numbers of nodes; all if not given.
    about : array (3,)
        The point (length).
    """

    about: Vector3 = (0.0, 0.0, 0.0)

    @property
    def quantity(self) -> str:
        return "moment"

    def __call__(self, system: System) -> Array:
        arms = self.solid.carriers.vectors(system.x) - self.about
        torque: Array = np.cross(arms, self.by_node(system)).sum(axis=0)
        if isinstance(self.solid, DirectorBody):
            torque += (self._chosen * self.solid.turning(self._held(system), system.x)).sum(axis=0)
        return torque


@dataclass(config=settings, frozen=True, kw_only=True)
class SectionForce(Reading):
    """Probe: force (3,) that a solid transmits through a section.

    The elements whose centres lie behind a plane of the reference configuration act on the others through
    the nodes that both have; the force is what the part in front, where `normal` points, exerts on the part behind
    (a tensile force is positive along the normal). As a sum of nodal forces it is, in statics, in exact
    equilibrium with the loads on either part; what acts on the section's own nodes (weight, inertia, loads) belongs to
    both parts, by their shares in the volume there. What supports give to nodes of the section, as where it runs in
    zigzag along a held face, is shared among the elements that are held by a face.

    Parameters
    ----------
    solid : Solid
    point, normal : array (3,)
        The plane; only elements on either side are told by it, so the section follows their faces.
    """

    solid: MeshBody
    point: Vector3
    normal: Vector3

    @property
    def quantity(self) -> str:
        return "force"

    def __post_init__(self) -> None:
        refuse_thin("SectionForce", "vv.Resultants gives the forces in sections of beams", self.solid)
        d = self.solid.dimension
        side = (self.solid.grid.centres - self.point[:d]) @ self.normal[:d]
        if not (np.any(side > 0) and np.any(side <= 0)):
            raise InputError(
                f"{self.solid.label} has all elements on one side of the section at {self.point}"
            )

    @remembered("solid")
    def _behind(self) -> NDArray[np.bool_]:
        d = self.solid.dimension
        behind: NDArray[np.bool_] = np.asarray(
            (self.solid.grid.centres - self.point[:d]) @ self.normal[:d] <= 0
        )
        return behind

    @remembered("solid")
    def _shared(self) -> NDArray[np.bool_]:
        """Nodes of elements on both sides."""
        count = np.zeros((2, self.solid.grid.n_nodes), dtype=bool)
        first = 0
        for nodes in self.solid.grid.cells.values():
            side = self._behind[first : first + len(nodes)]
            count[0, nodes[side]] = count[1, nodes[~side]] = True
            first += len(nodes)
        shared: NDArray[np.bool_] = np.logical_and(*count)
        return shared

    @remembered("solid")
    def _share(self) -> Array:
        """Share (n, 1) of the elements in front in the volume at each node."""
        front, whole = (
            nodal_volume(self.solid, cells) for cells in (~self._behind, np.ones_like(self._behind))
        )
        return np.asarray(front / whole)[:, None]

    def by_node(self, system: System) -> Array:
        """Forces (n, 3) on the nodes of the section by what is in front of it."""
        front, behind = (
            self.solid.nodal_forces(system.x_with_reactions, side) for side in (~self._behind, self._behind)
        )
        force: Array = (front - self._shares() * (front + behind)) * self._shared[:, None]
        return force

    def _shares(self) -> Array:
        """Shares (n, 3) of what is in front: where supports hold, among the elements that they hold by a face."""
        shares = np.repeat(self._share, 3, axis=1)
        for c, held in enumerate(self._held().T):
            if np.any(held & self._shared):
                faced = self._faced(held)
                front, whole = (nodal_volume(self.solid, cells) for cells in (faced & ~self._behind, faced))
                there = held & (whole > 0)
                shares[there, c] = front[there] / whole[there]
        return shares

    def _held(self) -> NDArray[np.bool_]:
        """Which components of nodes (n, d) supports hold; of splines, whose control points have no faces, none."""
        fixed, n = self.solid.motion.fixed, self.solid.grid.n_nodes
        none = np.zeros((n, self.solid.dimension), dtype=bool)
        return np.asarray(fixed.reshape(none.shape)) if fixed.size == none.size else none

    def _faced(self, held: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Elements (n_cells,) with a face all nodes (n,) of which are held."""
        faces, faced = self.solid.faces("all"), np.zeros(len(self._behind), dtype=bool)
        for name, nodes in faces.cells.items():
            faced[faces.owners[name][held[nodes].all(axis=1)]] = True
        return faced

    def __call__(self, system: System) -> Array:
        force: Array = self.by_node(system).sum(axis=0)
        return force


@dataclass(config=settings, frozen=True, kw_only=True)
class SectionTorque(SectionForce):
    """Probe: torque (3,) of the same forces about the mean of the section's nodes, or a fixed point.

    Parameters
    ----------
    solid : Solid
    point, normal : array (3,)
        Plane of the section in the reference, see `SectionForce`.
    about : array (3,), optional
        Fixed point (length).
    """

    about: Vector3 | None = None

    @property
    def quantity(self) -> str:
        return "moment"

    def __call__(self, system: System) -> Array:
        x = self.solid.positions(system.x)
        about = x[self._shared].mean(axis=0) if self.about is None else self.about
        torque: Array = np.cross(x - about, self.by_node(system)).sum(axis=0)
        return torque


def nodal_volume(body: MeshBody, cells: NDArray[np.bool_]) -> Array:
    """Share (n,) of every node in the reference volume, positive, of the chosen cells (n_cells,)."""
    first, parts = 0, []
    for cell, nodes in body.grid.cells.items():
        volume = masses(body.grid.points, nodes, cell, 1.0, axisymmetric=body.axisymmetric, lumped=True)
        parts.append((nodes, volume * cells[first : first + len(nodes), None]))
        first += len(nodes)
    return nodal_masses(body.grid.n_nodes, parts)


def width_of(body: Meshed, field: str) -> int:
    """Number of components of a field, which may be a component itself.

    Raises
    ------
    InputError
        With the nearest valid name, and all.
    """
    widths, (whole, part) = body.widths(), within(field)
    if whole not in widths:
        close = nearest(field, widths)
        every = f" It has {', '.join(sorted(widths))}." if close.endswith("?") else "."
        tensors = [f"{name}_{parts_of(name, n)[0]}" for name, n in widths.items() if parts_of(name, n)]
        such = f" Components are fields, too, such as {tensors[0]}" if tensors else ""
        raise InputError(f"{body.label}: there is no field {field!r}{close}{every}{such}")
    return widths[whole] if part is None else 1


def within(field: str) -> tuple[str, int | None]:
    """The field that a component such as ``cauchy_xx`` is of, and its number there; None for whole fields."""
    return SINGLE.get(field, (field, None))


def along(vector: Array, direction: Array | None) -> Any:
    """The vector, or its component along a direction."""
    return vector if direction is None else float(vector @ direction)
