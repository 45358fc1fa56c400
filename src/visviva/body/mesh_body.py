"""Bodies on meshes that move: what loads, supports, contact, couplings, probes and pictures ask of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.base.html import table
from visviva.body.carriers import Carriers
from visviva.body.element import Geometry, geometry, volumes
from visviva.body.mesh_points import FacePoints, Points, cell_points, face_points
from visviva.body.touching import Skin
from visviva.component.component import short
from visviva.component.meshed import Meshed
from visviva.component.momentum import EVERYWHERE, NOWHERE, Axes
from visviva.component.point import Attachable
from visviva.component.values import Number, Vector3, VectorOrFunction
from visviva.mesh.faces import Faces, chosen_faces, chosen_nodes
from visviva.mesh.locate import locate
from visviva.mesh.quadrature import Rule
from visviva.model.field import Field, Vectors
from visviva.model.form import Form, Vector

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]


class MeshBody(Attachable, Meshed):
    """Base of bodies whose mesh moves along.

    What derives from it gives its nodes positions among the unknowns of the field `motion`, in `declare`, and says
    which masses they have, how stiff it is, and which forces its strains exert.

    Attributes
    ----------
    motion : Field
        Unknowns, once it is part of a system; `node_unknowns` tells those of the nodes' positions.
    density : float
        Mass per reference volume.
    thickness : float
        Across a plane mesh.
    velocity : (3,), or a function of reference positions (n, 3) with values (n, 3)
        At the start.
    angular_velocity : (3,)
        Initial rotation about the centre of mass.
    """

    motion: Field
    density: Number
    thickness: Number
    velocity: VectorOrFunction
    angular_velocity: Vector3

    has_directions = False
    moves_rigidly = False

    def __new__(cls, *args: Any, **kwargs: Any) -> MeshBody:
        if cls is MeshBody:  # which validation makes of a mapping
            raise InputError("a body on a mesh is asked for, such as vv.Solid")
        return super().__new__(cls)

    # --- what derives from it says -------------------------------------------------------------------------
    @property
    def outside_axes(self) -> Axes:
        return (
            EVERYWHERE if getattr(self, "mass_damping", 0.0) else NOWHERE
        )  # which brakes against a room at rest

    @property
    def axisymmetric(self) -> bool:
        """True if a plane mesh stands for a body of revolution."""
        return False

    @property
    def modulus(self) -> float:
        """Young's modulus at small strains, by which contact is stiff unless it is told."""
        raise NotImplementedError

    def _masses_of_nodes(self) -> Array:
        """Row sums (n,) of the mass matrix."""
        raise NotImplementedError

    def _widths_at_points(self) -> Mapping[str, int]:
        """Fields that its quadrature points have, by name, with their numbers of components."""
        raise NotImplementedError

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        """Fields of one component that its nodes carry, by name: values (n,) at the unknowns of the system."""
        return {}

    def _smoothed(self, names: tuple[str, ...], x: Array) -> dict[str, Array]:
        """Fields of the quadrature points at the nodes, (n,) or (n, components) each."""
        raise NotImplementedError

    def at_points(self, name: str, x: Array) -> Array:
        """A field at all quadrature points, (n_points, components), element after element."""
        raise NotImplementedError

    def nodal_forces(self, x: Array, cells: Mask | None = None) -> Array:
        """Forces (n, 3) of the strained elements on the nodes, of the chosen cells (n_cells,) or all."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        told = [(name, short(getattr(self, name))) for name in ("material", "density") if hasattr(self, name)]
        return table([*told, ("mass", f"{self.mass:.6g}")], title=self.label) + self.grid._repr_html_()

    # --- sets and their quadrature points ------------------------------------------------------------------
    def nodes(self, chosen: str | Faces | ArrayLike) -> Ints:
        """Nodes (k,) by the name of a set of nodes or faces, 'all', `Faces`, or their numbers.

        Raises
        ------
        InputError
            If there is no such set or node, or none in it.
        """
        return chosen_nodes(self.grid, chosen, self.label)

    def faces(self, chosen: str | Faces) -> Faces:
        """Faces (edges if plane) by the name of their set, 'all' for the whole boundary, or as given.

        Raises
        ------
        InputError
            If there is no such set, or none in it.
        """
        return chosen_faces(self.grid, chosen, self.label)

    def skin(self, chosen: str | Faces, fine: bool = False) -> Skin:
        """Surface of these faces that others touch: by default their nodes.

        Lines have points between their nodes too where it shall be `fine`.

        Raises
        ------
        InputError
            If there are no such faces.
        """
        import scipy.sparse as sp

        n, faces = self.grid.n_nodes, self.faces(chosen)
        every = np.arange(n)
        weights = sp.eye_array(n, format="csr")
        first = lambda: self.node_unknowns(every)  # noqa: E731
        return Skin(first, weights, self.points, every, faces, faces, self.dimension)

    def cell_points(self) -> Iterator[Points]:
        """Quadrature points of the cells for forces on the volume, type by type."""
        return cell_points(self.grid, thickness=self.thickness, axisymmetric=self.axisymmetric)

    def face_points(self, faces: Faces, *, on_sides: bool = False) -> Iterator[FacePoints]:
        """Quadrature points of faces for forces on them, type by type; of shells on their middle, or `on_sides`."""
        return face_points(self.grid, faces, thickness=self.thickness, axisymmetric=self.axisymmetric)

    @property
    def volumes(self) -> list[Array]:
        """Volumes (m, q) of the quadrature points in the reference configuration, one for each type of cells."""
        raise NotImplementedError

    def _geometry(self, cell: str, nodes: Ints, rule: Rule | None = None) -> Geometry:
        """Gradients and volumes of cells (m, k) of a type, by default at the points of internal forces."""
        thickness, axisymmetric = self.thickness, self.axisymmetric
        return geometry(
            self.grid.points, nodes, cell, rule=rule, thickness=thickness, axisymmetric=axisymmetric
        )

    # --- masses and the start ------------------------------------------------------------------------------
    @cached_property
    def nodal_mass(self) -> Array:
        """Share (n,) of every node in the mass."""
        return self._masses_of_nodes()

    @property
    def mass(self) -> float:
        """Total mass."""
        return float(self.nodal_mass.sum())

    @property
    def total_mass(self) -> float:
        return self.mass

    def mass_moment(self, x: Array) -> Array:
        moment: Array = self.carriers.mass @ self.carriers.vectors(x)
        return (
            moment * (0, 1, 0) if self.axisymmetric else moment
        )  # the revolution's centre is on its axis, y

    def weigh(self, model: Model, acceleration: Array) -> None:
        m = self.carriers.mass
        if np.any(m > 0):
            force = m[:, None] * np.asarray(acceleration)[None, : self.dimension]
            model.dead_forces(self, "gravity", self.carriers.unknowns(np.arange(len(m))), force)

    def _centre(self) -> Array:
        """Centre of mass (3,) in the reference; without mass the mean of the nodes."""
        X = self.carriers.points
        w = self.carriers.mass if self.density > 0 else np.ones(len(X))
        centre: Array = w @ X / w.sum()
        return centre

    def initial_velocities(self) -> Array:
        """Velocities (n, d) of the nodes at the start."""
        X, v = self.points, self.sampled(self.velocity)
        if self.axisymmetric and np.any(self.angular_velocity):
            raise InputError(
                f"{self.label}: what is axisymmetric does not turn in its model; leave out angular_velocity = "
                f"{np.asarray(self.angular_velocity).tolist()}, or mesh it in space"
            )
        if np.any(self.angular_velocity):
            v = v + np.cross(self.angular_velocity, X - self._centre())
        if self.dimension == 2 and np.any(v[:, 2] != 0):
            raise InputError(f"{self.label}: a plane solid cannot have velocities out of its plane")
        return v[:, : self.dimension]

    def move_reference(self, model: Model, nodes: Ints, by: Array) -> None:
        """Move nodes (k,) by (k, d or 3) in the reference configuration, where they start free of stress.

        For what fits surfaces to each other in `declare`: a body contributes what its reference is then.

        Raises
        ------
        InputError
            If cells are inverted by that.
        """
        d, points = self.dimension, self.grid.points.copy()
        points[nodes] += by[:, :d]
        self.grid = replace(self.grid, points=points).check()
        self.__dict__.pop("nodal_mass", None)
        place = self.node_unknowns(np.arange(len(points)))[:, None] - self.motion.start + np.arange(d)
        self.motion.values[place], self.motion.rates[place] = points, self.initial_velocities()
        model.refresh(self.motion)

    # --- attachment ----------------------------------------------------------------------------------------
    def node_unknowns(self, nodes: Any) -> NDArray[np.int32]:
        """First unknown of each node."""
        return np.asarray(self.motion.start + self.dimension * np.asarray(nodes), dtype=np.int32)

    def place(self, X: Array) -> Vector:
        nodes, N = locate(self.grid, X[: self.dimension], self.label)
        return self.combination(nodes, N)

    def turn(self, direction: Array, X: Array) -> Vector:
        raise InputError(
            f"{self.label} has no directions of its own: attach points to it, or frames to its faces by "
            "vv.RigidCoupling or vv.DistributedCoupling"
        )

    @property
    def carriers(self) -> Carriers:
        """Carriers of its places: the points that they are interpolated between, by default its nodes."""
        return Carriers(self)

    def combination(self, nodes: Any, weights: Any) -> Vector:
        """Weighted sum of nodal positions as a vector form."""
        kept = [
            (int(u), float(w)) for u, w in zip(self.node_unknowns(nodes), weights, strict=True) if w != 0.0
        ]
        parts = [Form(tuple((u + c, w) for u, w in kept)) for c in range(self.dimension)]
        x, y, z = (*parts, Form())[:3]
        return Vector((x, y, z))

    def local(self, x: Array) -> Array:
        return x

    def vectors(self, model: Model) -> Vectors:
        n = self.grid.n_nodes
        return self.node_unknowns(np.arange(n)).astype(np.int64), np.ones(n, dtype=bool), self.dimension

    # --- what it shows -------------------------------------------------------------------------------------
    def _samples(self, name: str, x: Array) -> Array:
        return super()._samples(name, x) if name in self._carried() else self.at_points(name, x)

    def widths(self) -> Mapping[str, int]:
        return {**self._widths_at_points(), **dict.fromkeys(self._carried(), 1)}

    def smoothed(self, names: Sequence[str], x: Array) -> dict[str, Array]:
        carried = self._carried()
        others = self._smoothed(tuple(n for n in names if n not in carried), x)
        return others | {n: carried[n](x) for n in names if n in carried}

    def positions(self, x: Array) -> Array:
        """Positions (n, 3) of the nodes at the unknowns `x` of the system."""
        return self.carriers.at_nodes(x)

    def displacements(self, x: Array) -> Array:
        """Displacements (n, 3) of the nodes from the reference configuration at the unknowns `x`."""
        return self.positions(x) - self.points

    def velocities(self, x: Array, v: Array) -> Array:
        """Velocities (n, 3) of the nodes at the unknowns `x` and rates `v` of the system."""
        return self.carriers.at_nodes(v)

    def volume(self, x: Array) -> float:
        """Present volume, that of the revolution if axisymmetric, else area if plane, at the unknowns `x`."""
        points = self.positions(x)[:, : self.dimension]
        cells = self.grid.cells.items()
        return float(sum(volumes(points, n, cell, axisymmetric=self.axisymmetric).sum() for cell, n in cells))

    def mean(self, name: str, x: Array) -> Array:
        """Means of a field over the elements, (n_cells,) or (n_cells, components)."""
        values, means = self.at_points(name, x), []
        for volume in self.volumes:
            part, values = np.split(values, [volume.size])
            part = part.reshape(*volume.shape, -1)
            means.append(np.einsum("mq,mqc->mc", volume, part) / volume.sum(axis=1)[:, None])
        mean = np.concatenate(means)
        return mean[:, 0] if mean.shape[1] == 1 else mean
