"""Rigid bodies in directors: 12 coordinates, 6 constraints of rigidity, constant mass (paper, (4)-(9))."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.inertia import MassProperties, check_inertia, euler_tensor, inertia_tensor
from visviva.body.shape import AnyShape, Box
from visviva.component.component import settings
from visviva.component.point import Attachable, handedness, orthonormality
from visviva.component.values import Matrix, Number, Vector3
from visviva.model.form import Strain, Vector, dot

if TYPE_CHECKING:
    from visviva.body.shape import Outline
    from visviva.model.field import Field
    from visviva.model.model import Model

Array = NDArray[np.float64]

FLAT = 1e-4
"""Share of the length of a prism that is drawn in a plane system: it lies just above the plane."""


@dataclass(config=settings, eq=False, kw_only=True)
class RigidBody(Attachable):
    """A rigid body.

    Its inertia comes from exactly one of: `inertia` or `euler` with `mass`, or `shape` with `density` (or
    `mass`).

    Parameters
    ----------
    mass : float
        Mass.
    inertia : array (3,) or (3, 3)
        Inertia tensor about the centre of mass, in body axes; three numbers are principal values.
    euler : array (3,) or (3, 3)
        Euler tensor ``E = tr(J)/2 I - J`` instead of the inertia tensor (paper eq. (8)).
    centre : array (3,)
        Centre of mass in body coordinates.
    shape : Box, Sphere, Cylinder, Cone, Capsule or SurfaceMesh
        Gives mass properties with `density`, and the picture.
    density : float
        Mass per volume of the shape.
    position : array (3,)
        Where the origin of the body coordinates is initially.
    rotation : array (3, 3)
        Initial directors as columns.
    velocity : array (3,)
        Initial velocity of the origin of the body coordinates.
    angular_velocity : array (3,)
        Initial angular velocity in space.
    name : str
        How it is called in messages and results.

    Examples
    --------
    >>> import visviva as vv
    >>> brick = vv.RigidBody(shape=vv.Box(size=(1, 2, 3)), density=1000.0, name="brick")
    >>> brick.mass_properties().mass
    6000.0
    """

    mass: Number | None = None
    inertia: Matrix | None = None
    euler: Matrix | None = None
    centre: Vector3 | None = None
    shape: AnyShape | None = None
    density: Number | None = None
    position: Vector3 = (0.0, 0.0, 0.0)
    rotation: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    velocity: Vector3 = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        R = self.rotation
        if R.shape != (3, 3) or orthonormality(R.T) > 1e-6:
            raise InputError(f"{self.label}: rotation {R.tolist()} has no orthonormal columns (directors)")
        if handedness(R) < 0:
            raise InputError(f"{self.label}: rotation {R.tolist()} is left-handed; swap two directors")
        from_shape = self.shape is not None and self.inertia is None and self.euler is None
        if (self.centre if from_shape else self.density) is not None:
            what, others = ("centre", "a shape alone") if from_shape else ("density", "inertia or euler")
            raise InputError(f"{self.label}: {what} means nothing beside {others}; leave it out")
        try:
            check_inertia(self.mass_properties().inertia)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    def mass_properties(self) -> MassProperties:
        """Mass, centre of mass (3,) and inertia tensor (3, 3) about it, in body coordinates."""
        if self.shape is not None and self.inertia is None and self.euler is None:
            return self._from_shape(self.shape)
        if self.mass is None or (self.inertia is None) == (self.euler is None):
            raise InputError(
                f"{self.label}: give mass with inertia, or mass with euler, or shape with density (or mass)"
            )
        if self.mass <= 0:
            raise InputError(f"{self.label}: mass {self.mass:g} is not positive")
        given: Any = self.inertia if self.inertia is not None else self.euler
        tensor: Array = np.diag(given) if given.shape == (3,) else given
        J = tensor if self.inertia is not None else inertia_tensor(tensor)
        return MassProperties(float(self.mass), np.zeros(3) if self.centre is None else self.centre, J)

    def _from_shape(self, shape: AnyShape) -> MassProperties:
        if (self.density is None) == (self.mass is None):
            raise InputError(f"{self.label}: a shape needs either density or mass")
        for what in ("density", "mass"):
            value = getattr(self, what)
            if value is not None and value <= 0:
                raise InputError(f"{self.label}: {what} {value:g} is not positive")
        density = self.density if self.mass is None else self.mass / shape.volume
        assert density is not None
        return shape.inertia(density)

    def mass_matrix(self) -> Array:
        """Constant mass (4, 4) between origin and directors: ``[[m, m s], [m s, E]]``, paper eq. (7)."""
        return mass_matrix(self.mass_properties())

    is_flat = False
    """Whether its section alone is shown, of a prism in a plane system."""

    # --- attachment ----------------------------------------------------------------------------------------
    def place(self, X: Array) -> Vector:
        return Vector.of(self._field.start, (1.0, *X.tolist()))

    def turn(self, direction: Array, X: Array) -> Vector:
        return Vector.of(self._field.start + 3, direction.tolist())

    def local(self, x: Array) -> Array:
        X: Array = self.rotation.T @ (x - self.position)
        return X

    def local_direction(self, d: Array, X: Array) -> Array:
        D: Array = self.rotation.T @ d
        return D

    @property
    def motion(self) -> Field:
        """Its unknowns: origin and directors."""
        return self._field

    @property
    def directors(self) -> tuple[Vector, Vector, Vector]:
        """The three directors as vector forms."""
        a, b, c = (Vector.of(self._field.start + 3 + 3 * k) for k in range(3))
        return a, b, c

    # --- part in the system --------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        R, w = self.rotation, self.angular_velocity
        q = np.concatenate([self.position, *R.T])
        v = np.concatenate([self.velocity, *(spin(*w.tolist()) @ R).T])
        scale = np.r_[np.full(3, model.length_of(self)), np.ones(9)]
        self._field = model.field(self, "configuration", q, v, scale=scale)

    def contribute(self, model: Model) -> None:
        self._multipliers = model.multipliers(self, "rigidity", 6, stage=0, block=self._field.block)
        model.reductions.rigid.append([*self._field.unknowns, *self._multipliers.unknowns])
        model.inertia(self, self._field.start, self.mass_matrix(), (True, False, False, False))
        model.constrain(self, self._multipliers, RIGIDITY, shift=self._field.start)

    def weights(self) -> list[tuple[float, Vector]]:
        m, centre, _ = self.mass_properties()
        return [(m, self.place(centre))]

    def outline(self) -> Outline | None:
        core = self.shape.core if self.shape is not None else None
        return None if core is None else (core, self.frame())

    def feelers(self) -> tuple[Array, float] | None:
        return None if self.shape is None else self.shape.feelers

    def surface(self) -> Any:
        points, triangles = (
            self.shape.surface() if self.shape is not None else inertia_box(self.mass_properties())
        )
        return (points * (1, 1, FLAT), triangles) if self.is_flat else (points, triangles)


def mass_matrix(properties: MassProperties) -> Array:
    """Mass (4, 4) between the origin and the directors of a body."""
    m, centre, J = properties
    M = np.empty((4, 4))
    M[0, 0], M[0, 1:], M[1:, 0] = m, m * centre, m * centre
    M[1:, 1:] = euler_tensor(J) + m * centre[:, None] * centre
    # masses and moments of inertia compare in no units, but by a length
    reach = np.sqrt(M[1:, 1:].diagonal().max() / m)
    size = np.sqrt(m) * np.array([1.0, reach, reach, reach])
    M[np.abs(M) < 1e-15 * np.outer(size, size)] = 0.0
    return M


def spin(x: float, y: float, z: float) -> Array:
    """The matrix of the cross product with (x, y, z)."""
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rigidity() -> tuple[Strain, ...]:
    """Orthonormality of three directors, unknowns 3 ... 11."""
    d1, d2, d3 = (Vector.of(3 + 3 * k) for k in range(3))
    return *(0.5 * dot(d, d) - 0.5 for d in (d1, d2, d3)), dot(d1, d2), dot(d1, d3), dot(d2, d3)


RIGIDITY = rigidity()
"""The constraints of a body whose unknowns start at 0; all bodies share them."""


def inertia_box(properties: MassProperties) -> Any:
    """Surface of the homogeneous box with the same inertia, edges no thinner than 1/50 of the longest."""
    m, centre, J = properties
    euler, axes = np.linalg.eigh(euler_tensor(J))
    edges = np.sqrt(12 * np.maximum(euler, 0) / m)
    longest = float(edges.max()) or 1.0
    points, triangles = Box(size=tuple(np.maximum(edges, longest / 50).tolist())).surface()
    right_handed = axes * np.sign(np.linalg.det(axes))
    return centre + points @ right_handed.T, triangles
