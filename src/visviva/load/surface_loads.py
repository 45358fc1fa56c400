"""Loads on faces of solids: traction, pressure, elastic foundation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.body.mesh_body import MeshBody
from visviva.body.mesh_points import FacePoints
from visviva.component.announcements import Facing
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import FaceSet, Number, VectorOrFunction
from visviva.load.distributed import Distribution, Gathered
from visviva.mesh.cells import CELLS
from visviva.model.batch import Layout, along, strain_batch
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class OnFaces(Component):
    """Base of what acts on `faces` of a `solid`, by the name of their set, or 'all' for the whole boundary."""

    solid: MeshBody
    faces: FaceSet

    def __post_init__(self) -> None:
        try:
            self._faces = self.solid.faces(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    def announce(self, model: Model) -> None:
        model.announce(self.solid, Facing(self, self._faces))


@dataclass(config=settings, eq=False, kw_only=True)
class OnSides(OnFaces):
    """Base of what may act on the sides of shells or on their `middle`."""

    middle: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        on_sides = any(CELLS[kind].dimension == 2 for kind in self._faces.cells)
        if self.middle and not (self.solid.is_thin and on_sides):
            raise InputError(f"{self.label}: middle=True is for the sides of shells; leave it out")

    def points(self) -> list[FacePoints]:
        """Quadrature points where it acts."""
        return list(self.solid.face_points(self._faces, on_sides=not self.middle))


@dataclass(config=settings, eq=False, kw_only=True)
class Traction(OnSides):
    """Dead load per reference area.

    Parameters
    ----------
    solid : Solid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    middle : bool
        Whether it acts on the middle of a shell, and per area there, instead of on the side that `faces` name.
    traction : array (3,) or callable
        Force per reference area; or ``f(t, X)`` of time and reference positions (n, 3) with values (n, 3).
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
    >>> system = vv.System([block, vv.Traction(solid=block, faces="z1", traction=(0, 0, 2.0), times="cos(t)")])
    """

    traction: VectorOrFunction
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.traction))

    def __post_init__(self) -> None:
        super().__post_init__()
        self._distribution = Distribution(self.label, "traction", self.solid, self.traction, self.times)

    def contribute(self, model: Model) -> None:
        self._distribution.contribute(model, self, self.points())


@dataclass(config=settings, eq=False, kw_only=True)
class Pressure(OnSides):
    """Pressure on faces, positive where it pushes into the solid.

    Parameters
    ----------
    solid : Solid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    middle : bool
        Whether it acts on the middle of a shell instead of on the side that `faces` name, as in shell theory.
    pressure : number, expression, table or callable
        As a function of time, see `TimeFunction`.
    follower : bool
        It acts along the normals and on the areas of the deformed surface; otherwise on those of the reference.

    Notes
    -----
    The ledger books its work; with energy-momentum and midpoint rules the balance closes to round-off, and a
    pressure all around a body changes neither of its momenta: it acts on the surface in the middle of the step. Its
    work is then pressure times change of area exactly in the plane; volumes are cubic, so in space that holds to second
    order in the step. The tangent of a follower pressure is exact and not symmetric.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.SphereMesh(radius=1.0, counts=(2, 2))
    >>> ball = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
    >>> system = vv.System([ball, vv.Pressure(solid=ball, faces="all", pressure="10*t")])
    """

    pressure: OfTime
    follower: bool = True

    def contribute(self, model: Model) -> None:
        points = self.points()
        if any(p.dN.shape[-1] < self.solid.dimension - 1 for p in points):
            raise InputError(
                f"{self.label}: edges of {self.solid.label} have no side that a pressure could act on; give their "
                "force per length by vv.Traction"
            )
        if not self.follower:
            dead = Gathered(self.solid, points)
            model.nodal_loads(
                self, "pressure", dead.first, dead.forces([-p.normal for p in points]), self.pressure
            )
            return
        signal = model.signal(self, self.pressure)
        for p in points:
            index = element_unknowns(self.solid, p)
            layout, weights = self._normals(p)
            term = strain_batch(layout, Law(LawKind.FOLLOWER), index, weights, (0.0, 0.0), signal)
            model.strain_batch(self, "pressure", "work", term, len(index))

    def _normals(self, p: FacePoints) -> tuple[Layout, Array]:
        """Places and forces per pressure at the quadrature points as strains (6) of the nodes of each face."""
        if self.solid.dimension == 3:
            N, first, second = p.of_vectors(p.N), *(p.of_vectors(p.dN[..., c]) for c in range(2))
            first = -p.weights[:, None] * first
            point = np.concatenate([N, N, N, first, first, first, second, second, second], axis=2)
            return space_normals(N.shape[2]), point.reshape(-1, point.shape[2])
        N, slope = p.of_vectors(p.N), p.of_vectors(p.dN[..., 0])
        k = N.shape[2]
        if self.solid.axisymmetric:
            parts = [N, N, slope, slope, -2 * np.pi * p.weights[:, None] * N]
            return ring_normals(k), np.concatenate(parts, axis=2).reshape(-1, 5 * k)
        flat = -self.solid.thickness * p.weights[:, None] * slope
        return edge_normals(k), np.concatenate([N, N, flat, -flat], axis=2).reshape(-1, 4 * k)


def element_unknowns(solid: MeshBody, p: FacePoints) -> NDArray[np.int32]:
    """Unknowns (m q, d v) of the vectors of each face, once for each quadrature point."""
    d, vectors = solid.dimension, p.unknowns(solid)
    each = (vectors[:, :, None] + np.arange(d)).reshape(len(vectors), -1)
    return np.repeat(each, len(p.weights), axis=0)


def node_forms(d: int, k: int, first: int) -> list[tuple[int, int]]:
    """Forms `first` ...: the components of a weighted sum of k nodes of d unknowns."""
    return [(first + c, d * a + c) for c in range(d) for a in range(k)]


def space_normals(k: int) -> Layout:
    """Strains x (3) and a x b (3) of the forms x, a, b, sums over k nodes in space."""
    forms = [*node_forms(3, k, 0), *node_forms(3, k, 3), *node_forms(3, k, 6)]
    cyclic = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    products = [(3 + i, 3 + j, 6 + l) for i, j, l in cyclic] + [(3 + i, 3 + l, 6 + j) for i, j, l in cyclic]
    return Layout(3 * k, 9, 6, forms, [(c, c) for c in range(3)], products, [1.0] * 3 + [-1.0] * 3)


def edge_normals(k: int) -> Layout:
    """Strains x (2), 0, y', x', 0 of the forms x, y', x', sums over k nodes in the plane."""
    forms = [*node_forms(2, k, 0), *[(2, 2 * a + 1) for a in range(k)], *[(3, 2 * a) for a in range(k)]]
    return Layout(2 * k, 4, 6, forms, [(0, 0), (1, 1), (3, 2), (4, 3)])


def ring_normals(k: int) -> Layout:
    """Strains x (2), 0, r (a_y, -a_x), 0 of the forms x, a and the radius r, sums over k nodes in the plane."""
    forms = [*node_forms(2, k, 0), *node_forms(2, k, 2), *[(4, 2 * a) for a in range(k)]]
    products = [(3, 4, 3), (4, 4, 2)]
    return Layout(2 * k, 5, 6, forms, [(0, 0), (1, 1)], products, [1.0, -1.0])


@dataclass(config=settings, eq=False, kw_only=True)
class ElasticFoundation(OnFaces):
    """Springs, and dampers, from faces to their reference places.

    Parameters
    ----------
    solid : Solid
    faces : str or Faces
        Name of a set of faces, or 'all'.
    normal, tangential : float
        Stiffness per reference area across the reference surface, and along it.
    damping : float
        Force per velocity and reference area, in all directions.

    Examples
    --------
    >>> import visviva as vv
    >>> mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    >>> block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e3, poisson=0.3), density=1.0)
    >>> system = vv.System([block, vv.ElasticFoundation(solid=block, faces="z0", normal=50.0), vv.Gravity()])
    """

    normal: Number = 0.0
    tangential: Number = 0.0
    damping: Number = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for what in ("normal", "tangential", "damping"):
            if getattr(self, what) < 0:
                raise InputError(f"{self.label}: {what} {getattr(self, what):g} is negative")

    def contribute(self, model: Model) -> None:
        d = self.solid.dimension
        for p in self.solid.face_points(self._faces):
            extra = (self.normal - self.tangential) * p.size
            self._act(model, p, p.normal[:, :, :d], extra, LawKind.QUADRATIC)
            for direction in np.eye(d):
                every = np.broadcast_to(direction, p.normal[:, :, :d].shape)
                self._act(model, p, every, self.tangential * p.size, LawKind.QUADRATIC)
                self._act(model, p, every, self.damping * p.size, LawKind.VISCOUS)

    def _act(self, model: Model, p: FacePoints, direction: Array, factor: Array, kind: LawKind) -> None:
        """A law of the displacements along directions (m, q, d)."""
        if not np.any(factor):
            return
        d, n = self.solid.dimension, factor.size
        weights = np.einsum("mqk,mqc->mqkc", p.of_vectors(p.N), direction).reshape(n, -1)
        free = np.einsum("mqc,mqc->mq", direction, p.X[:, :, :d]).ravel()
        term = strain_batch(
            along(weights.shape[1]),
            Law(kind),
            element_unknowns(self.solid, p),
            weights,
            np.column_stack([factor.ravel(), free]),
        )
        what, category = ("damper", "dissipation") if kind is LawKind.VISCOUS else ("foundation", "potential")
        model.strain_batch(self, what, category, term, n)
