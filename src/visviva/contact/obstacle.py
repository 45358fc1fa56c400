"""Exact shapes that surfaces touch: planes, and shapes held by the ground or by bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.body.point_mass import Ground
from visviva.body.shape import Box, Capsule, Core, Cylinder, Sphere
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.point import Attachable, Frame
from visviva.component.values import Vector3
from visviva.contact.contact_surface import NO_FACETS, Surface, of_vectors

if TYPE_CHECKING:
    from visviva.body.shape import Outline

Array = NDArray[np.float64]

HALF_SPACE = Core(0, (0.0, 0.0, 0.0), 0.0)


@dataclass(config=settings, eq=False, kw_only=True)
class Plane(Component):
    """A plane that keeps what touches it on the side of its normal.

    Parameters
    ----------
    on : Attachable, optional
        What it moves with; by default it is fixed in space, as plane solids need it.
    at : array (3,)
        A point of it initially.
    normal : array (3,)
        Towards the free side, of any length; in plane problems without a third component.

    Examples
    --------
    A ball of radius 0.1 that falls by 0.1 and keeps its energy when it bounces:

    >>> import visviva as vv
    >>> ball = vv.RigidBody(shape=vv.Sphere(radius=0.1), density=1000.0, position=(0, 0, 0.2))
    >>> floor = vv.Plane()
    >>> contact = vv.Contact(first=ball, second=floor, enforcement="penalty", stiffness=1e6)
    >>> result = vv.simulate(vv.System([ball, floor, contact, vv.Gravity()]), until=0.3, step=0.001)
    >>> result.assert_conserved("energy", tolerance=1e-9)
    """

    outside_axes = NOWHERE

    on: Attachable | None = None
    at: Vector3 = (0.0, 0.0, 0.0)
    normal: Vector3 = (0.0, 0.0, 1.0)

    def outline(self) -> Outline:
        return HALF_SPACE, (self.on or Ground()).frame_at(self.at, self.normal)


@dataclass(config=settings, eq=False, kw_only=True)
class Obstacle(Component):
    """A shape that others touch, held by the ground or by a body; it has no mass.

    Parameters
    ----------
    shape : Box, Sphere, Cylinder or Capsule
    on : Attachable, optional
        What it moves with; by default it is fixed in space, as plane solids need it.
    at : array (3,)
        Where its centre is initially.
    axis : array (3,)
        Third direction of its frame initially.
    first : array (3,), optional
        First direction of its frame, as far as it is across the axis.
    """

    outside_axes = NOWHERE

    shape: Box | Sphere | Cylinder | Capsule
    on: Attachable | None = None
    at: Vector3 = (0.0, 0.0, 0.0)
    axis: Vector3 = (0.0, 0.0, 1.0)
    first: Vector3 | None = None

    def outline(self) -> Outline:
        return self.shape.core, (self.on or Ground()).frame_at(self.at, self.axis, self.first)


def frame_surface(frames: list[Frame], size: float) -> Surface:
    """Frames as vertices: the origin, and the ends of the directions of length `size`, of each."""
    vectors = [end for f in frames for end in (f.position, *(f.position + size * d for d in f.directors))]
    return of_vectors(vectors, NO_FACETS, np.array([[c.constant for c in v] for v in vectors]))
