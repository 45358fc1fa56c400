"""Frames on faces of solids: directors tied to a set of faces, so that every joint and load can attach to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.mesh_body import MeshBody
from visviva.component.announcements import Holding
from visviva.component.component import settings
from visviva.component.point import Attachable
from visviva.component.values import FaceSet
from visviva.model.field import Vectors
from visviva.model.form import Form, Strain, Vector, dot

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Coupling(Attachable):
    """Base of massless frames on `faces` of a `solid`: own origin in their centre, own axes those of space.

    The frame has a position and directors, as a rigid body has, with their orthonormality; what derives from this
    ties them to the nodes of the faces. In the plane it has two directors, and the third is constant.
    """

    solid: MeshBody
    faces: FaceSet

    def __post_init__(self) -> None:
        if self.solid.has_directions:
            raise InputError(
                f"{self.label}: {self.solid.label} has frames of its own; join it by beam.frame(s)"
            )
        try:
            faces, self._skin = self.solid.faces(self.faces), self.solid.skin(self.faces)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None
        if self.solid.axisymmetric and self.solid.dimension == 2:
            raise InputError(
                f"{self.label}: an axisymmetric solid does not turn with a frame; attach a point"
            )
        area = np.zeros((self.solid.grid.n_nodes, 1))
        for p in self.solid.face_points(faces):
            area += p.spread(np.ones((*p.size.shape, 1)), len(area))
        self._nodes = faces.nodes
        owner = self._skin.nodes[self._skin.used]  # shells have two points at a node, on either side
        self._share = (area[:, 0] / np.maximum(np.bincount(owner, minlength=len(area)), 1))[
            owner
        ] / area.sum()
        X = self._skin.points[self._skin.used]
        self._centre = self._share @ X
        self._arms = X - self._centre
        spread = np.linalg.eigvalsh(self._arms.T @ (self._share[:, None] * self._arms))
        self._size = float(np.sqrt(spread.sum()))
        if spread[4 - self.solid.dimension] < 1e-12 * spread.sum():
            raise InputError(
                f"{self.label}: the nodes of its faces lie on a line; a frame could turn about it"
            )

    # --- attachment ----------------------------------------------------------------------------------------
    def place(self, X: Array) -> Vector:
        return self._origin + self.turn(X, X)

    def turn(self, direction: Array, X: Array) -> Vector:
        x, y, z = (float(c) * d for c, d in zip(direction, self._directors, strict=True))
        return x + y + z

    def local(self, x: Array) -> Array:
        X: Array = x - self._centre
        return X

    is_rigid = False
    is_massless = True

    def vectors(self, model: Model) -> Vectors:
        d = self.solid.dimension
        starts = [self._position.start + d * np.arange(1), self._turning.start + d * np.arange(d)]
        return np.concatenate(starts), np.arange(d + 1) == 0, d

    # --- part in the system --------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        d = self.solid.dimension
        velocity, spin = self._initial_rates()
        turning = np.cross(spin, np.eye(3))[:d, :d]
        position = model.field(
            self,
            "position",
            self._centre[:d],
            velocity[:d],
            scale=model.length_of(self),
            block=self,
            stage=1,
            node=d,
        )
        directors = model.field(self, "directors", np.eye(d), turning, scale=1.0, block=self, stage=1, node=d)
        self._position, self._turning = position, directors
        self._origin = vector_of(position, 0)
        self._directors = [vector_of(directors, k) for k in range(d)]
        if d == 2:
            self._directors.append(Vector.constant((0.0, 0.0, 1.0)))

    def _initial_rates(self) -> tuple[Array, Array]:
        """Velocity of the centre (3,) and angular velocity (3,) that fit those of the nodes best."""
        d, w, X = self.solid.dimension, self._share, self._arms
        owner = self._skin.nodes[self._skin.used]
        beside = self._skin.points[self._skin.used] - self.solid.points[owner]
        nodal = np.pad(self.solid.initial_velocities()[owner], ((0, 0), (0, 3 - d)))
        nodal = nodal + np.cross(self.solid.angular_velocity, beside)
        velocity = w @ nodal
        moment = w @ np.cross(X, nodal - velocity)
        inertia = (w @ (X * X).sum(axis=1)) * np.eye(3) - X.T @ (w[:, None] * X)
        return velocity, np.linalg.pinv(inertia, hermitian=True) @ moment  # the edges of a plate lie on lines

    def contribute(self, model: Model) -> None:
        model.index(self.solid)
        d = self._directors[: self.solid.dimension]
        rigidity = [0.5 * dot(e, e) - 0.5 for e in d]
        rigidity += [dot(d[i], d[j]) for i in range(len(d)) for j in range(i + 1, len(d))]
        multipliers = model.multipliers(self, "rigidity", len(rigidity), block=self)
        model.constrain(self, multipliers, rigidity)
        self.tie(model)

    def tie(self, model: Model) -> None:
        """Add the constraints between frame and nodes."""
        raise NotImplementedError

    def _vanishing(self, difference: Vector) -> list[Form]:
        """The components of a vector form that the solid has."""
        return list(difference)[: self.solid.dimension]


@dataclass(config=settings, eq=False, kw_only=True)
class RigidCoupling(Coupling):
    """A frame that makes faces of a solid rigid: every node keeps its place in it.

    Parameters
    ----------
    solid : Solid or Shell
    faces : str or Faces
        Name of a set of faces, or 'all'; of shells a set of edges, or the side 'upper' or 'lower'.

    Notes
    -----
    ``point(X)`` and ``frame(X)`` count `X` from the centre of the faces, ``point_at(x)`` and ``frame_at(x)`` take
    places in space, as joints do by `at`.

    The constraints, three linear ones per node and the orthonormality of the directors, are independent and at
    most quadratic, so energy and momenta are conserved exactly. Nodes that something else holds as well make them
    redundant: hold the frame by a joint instead.

    Examples
    --------
    >>> import visviva as vv
    >>> beam = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)), material=vv.NeoHooke(young=1e3, poisson=0.3),
    ...                 density=1.0)
    >>> end, ground = RigidCoupling(solid=beam, faces="x0"), vv.Ground()
    >>> hinge = vv.Revolute(a=ground, b=end, at=(0, 0.5, 0.5), axis=(0, 1, 0))
    >>> vv.System([beam, end, ground, hinge]).check().degrees_of_freedom
    49
    """

    is_rigid = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self.solid.carriers.refuse_each_node(self.label, "take vv.DistributedCoupling")

    def announce(self, model: Model) -> None:
        model.announce(self.solid, Holding(self, self._nodes, None))

    def tie(self, model: Model) -> None:
        d = self.solid.dimension
        arms = self.solid.points[self._nodes] - self._centre
        held = [self._skin.director(int(node)) for node in self._nodes]
        n = d * len(self._nodes) + 2 * sum(map(len, held))
        multipliers, first = model.multipliers(self, "tie", n, block=self), 0
        for node, X, directors in zip(self._nodes, arms, held, strict=True):
            apart = self.solid.combination([node], [1.0]) - self.place(X)
            model.constrain(self, multipliers, self._vanishing(apart), first=first)
            first += d
            for director, D in directors:  # its length is held, so that two of its components are free
                across = [dot(director, self.turn(e, X)) for e in axes_across(D)]
                model.constrain(self, multipliers, across, first=first)
                first += 2


@dataclass(config=settings, eq=False, kw_only=True)
class DistributedCoupling(Coupling):
    """A frame that follows the mean motion of faces of a solid and leaves them free to deform.

    Its origin is the mean of the nodes by their shares of the area, its directors turn with the rotation that fits
    them best (the polar decomposition of their mean deformation). Forces on it are spread over the nodes by area.

    Parameters
    ----------
    solid : Solid or Shell
    faces : str or Faces
        Name of a set of faces, or 'all'; of shells a set of edges, or the side 'upper' or 'lower'.

    Notes
    -----
    ``point(X)`` and ``frame(X)`` count `X` from the centre of the faces, ``point_at(x)`` and ``frame_at(x)`` take
    places in space, as joints do by `at`.

    The constraints ``phi = sum w_a x_a``, ``d_i . M e_j = d_j . M e_i`` with ``M = sum w_a x_a (x) X_a``, and
    orthonormality are at most quadratic, so energy and momenta are conserved exactly.

    Examples
    --------
    >>> import visviva as vv
    >>> beam = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)), material=vv.NeoHooke(young=1e3, poisson=0.3),
    ...                 density=1.0)
    >>> end, ground = DistributedCoupling(solid=beam, faces="x0"), vv.Ground()
    >>> hinge = vv.Revolute(a=ground, b=end, at=(0, 0.5, 0.5), axis=(0, 1, 0))
    >>> vv.System([beam, end, ground, hinge]).check().degrees_of_freedom
    55
    """

    def tie(self, model: Model) -> None:
        d = self.solid.dimension
        mean = self._vanishing(self._origin - self._skin.combination(self._share))
        fit = self._fit()
        multipliers = model.multipliers(self, "tie", len(mean) + len(fit), block=self)
        model.constrain(self, multipliers, mean)
        for k, e in enumerate(fit):
            model.constrain(self, multipliers, [e], first=d + k)

    def _fit(self) -> list[Strain]:
        """Constraint values, zero when the directors are the rotation in the mean deformation of the nodes."""
        d = range(self.solid.dimension)
        weights = self._share[:, None] * self._arms / self._size**2
        M = [self._skin.combination(weights[:, j]) for j in d]
        D = self._directors
        return [dot(D[i], M[j]) - dot(D[j], M[i]) for i in d for j in d if i < j]


def axes_across(D: Array) -> tuple[Array, Array]:
    """Two orthonormal directions across a unit vector."""
    e = np.eye(3)[int(np.argmin(np.abs(D)))]
    first = np.cross(D, e) / np.linalg.norm(np.cross(D, e))
    return first, np.cross(D, first)


def vector_of(field: Field, node: int) -> Vector:
    """A node of a field as a vector, two components of which may be all it has."""
    x, y, z = (*(field.form(field.node * node + c) for c in range(field.node)), Form())[:3]
    return Vector((x, y, z))
