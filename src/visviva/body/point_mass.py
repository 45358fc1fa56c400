"""Point masses and the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.shape import Sphere
from visviva.component.component import settings
from visviva.component.point import Attachable
from visviva.component.values import Number, Vector3
from visviva.model.form import Vector

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
MARKER = 0.03  # radius of the ball that is drawn, in lengths of the model


@dataclass(config=settings, eq=False, kw_only=True)
class PointMass(Attachable):
    """A particle; it has one point, and no directions.

    Parameters
    ----------
    mass : float
        Positive.
    position : array (3,)
        At the start (length).
    velocity : array (3,)
        At the start (length per time).

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=2.0, position=(0, 0, 1), velocity=(1, 0, 0))
    >>> result = vv.simulate(vv.System([ball, vv.Gravity(acceleration=(0, 0, -10))]), until=1.0, step=0.1)
    >>> vv.Position(of=ball)(result.system).round(9).tolist()
    [1.0, 0.0, -4.0]
    """

    mass: Number
    position: Vector3 = (0.0, 0.0, 0.0)
    velocity: Vector3 = (0.0, 0.0, 0.0)

    has_directions = False

    def __post_init__(self) -> None:
        if self.mass <= 0:
            raise InputError(f"{self.label}: mass {self.mass:g} is not positive")

    def declare(self, model: Model) -> None:
        self._field = model.field(self, "position", self.position, self.velocity, scale=model.length_of(self))

    def contribute(self, model: Model) -> None:
        model.inertia(self, self._field.start, [[self.mass]], (True,))

    def place(self, X: Array) -> Vector:
        if np.any(X != 0):
            raise InputError(f"{self.label}: a point mass has only the point (0, 0, 0), not {X.tolist()}")
        return self._field.vector()

    def local(self, x: Array) -> Array:
        return np.zeros(3)

    def feelers(self) -> tuple[Array, float]:
        return np.zeros((1, 3)), 0.0

    def weights(self) -> list[tuple[float, Vector]]:
        return [(self.mass, self._field.vector())]

    def surface(self) -> Any:
        return Sphere(radius=MARKER * float(self._field.scale[0])).surface(resolution=12)


@dataclass(config=settings, eq=False, kw_only=True)
class Ground(Attachable):
    """Fixed body, whose own coordinates are those of space."""

    name: str | None = "ground"

    is_fixed = True

    def place(self, X: Array) -> Vector:
        return Vector.constant(X)

    def turn(self, direction: Array, X: Array) -> Vector:
        return Vector.constant(direction)

    def local(self, x: Array) -> Array:
        return x
