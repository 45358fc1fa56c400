"""Shapes of bodies: small values that give mass properties and a surface for display and contact.

Every shape lives in a frame of its own, lengths in the unit of the model; the axis of round shapes is e3.
"""

from abc import abstractmethod
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import ConfigDict, Field, FiniteFloat, GetPydanticSchema, NonNegativeInt
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED, Validated
from visviva.base.errors import InputError
from visviva.body.inertia import MassProperties, euler_tensor, inertia_tensor
from visviva.body.triangles import (
    Array,
    Surface,
    Triangles,
    arc,
    check_closed,
    halve,
    load_trimesh,
    read,
    revolve,
)
from visviva.component.point import Frame


def _rows_of(item: Any) -> Any:
    """Annotation of a table (n, 3): array-like for the caller, validated and kept as tuples of three."""
    rows = Annotated[tuple[tuple[item, item, item], ...], LISTED]
    return GetPydanticSchema(lambda _, schema_of: schema_of(rows))


Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Lengths = Annotated[tuple[Length, Length, Length], LISTED]
PointRows = Annotated[ArrayLike, _rows_of(FiniteFloat)]
TriangleRows = Annotated[ArrayLike, _rows_of(NonNegativeInt)]
CONFIG = ConfigDict(extra="forbid", defer_build=True)


class Core(NamedTuple):
    """A shape as a core with a round layer about it: distances to it are known exactly.

    Attributes
    ----------
    kind : int
        0 half space below the plane of e1 and e2, 1 box, 2 cylinder.
    half : three lengths
        Half the size of the core along e1, e2, e3; zero for a ball.
    radius : length
        Of the layer.
    """

    kind: int
    half: tuple[float, float, float]
    radius: float


Outline = tuple[Core, Frame]
"""An exact shape and the frame it is given in."""


class Shape(metaclass=Validated):
    """Interface of a shape: two methods, from which the rest follows."""

    @property
    def core(self) -> Core | None:
        """The shape in closed form; None if only its triangles are known."""
        return None

    @property
    def feelers(self) -> tuple[Array, float]:
        """Points (n, 3) at which the shape touches others, and the radius of balls about them."""
        return self.surface()[0], 0.0

    def facets(self) -> Surface:
        """The surface for contact: points (n, 3) and facets (m, 4), -1 where they have three corners."""
        points, triangles = self.surface()
        return points, np.pad(triangles, ((0, 0), (0, 1)), constant_values=-1)

    @property
    def faces(self) -> dict[str, Triangles]:
        """Facets of the surface, by the name of the face that they are part of; those alone that have names."""
        return {}

    @property
    @abstractmethod
    def volume(self) -> float:
        """Enclosed volume."""

    @property
    def centre(self) -> Array:
        """Centre of volume (3,) in the shape's frame."""
        return np.zeros(3)

    @property
    @abstractmethod
    def second_moment(self) -> Array:
        """Second moment ``∫ x xᵀ dV`` (3, 3) of the volume about its centre, in the shape's axes."""

    @abstractmethod
    def surface(self, resolution: int = 32) -> Surface:
        """Closed triangle surface: points (n, 3) and triangles (m, 3), anticlockwise as seen from outside.

        `resolution` is the number of segments round a full circle; shapes without curved faces ignore it.
        """

    def inertia(self, density: float) -> MassProperties:
        """Mass, centre of mass (3,) and inertia tensor (3, 3) about it, for a uniform `density`.

        Raises
        ------
        InputError
            If the density is not a positive finite number.

        Examples
        --------
        >>> mass, centre, inertia = Box((1.0, 2.0, 3.0)).inertia(density=2.0)
        >>> mass, inertia.diagonal().tolist()
        (12.0, [13.0, 10.0, 5.0])
        """
        if not (np.isfinite(density) and density > 0.0):
            raise InputError(f"density is {density}: give a positive number, mass per volume")
        return MassProperties(
            density * self.volume, self.centre, inertia_tensor(density * self.second_moment)
        )


@dataclass(frozen=True, config=CONFIG)
class Box(Shape):
    """Cuboid about the origin with edges along the axes; its faces are 'x0', 'x1', 'y0', 'y1', 'z0', 'z1'.

    Parameters
    ----------
    size : three lengths
        Full edge lengths along e1, e2, e3.
    """

    size: Lengths

    @property
    def volume(self) -> float:
        return float(np.prod(self.size))

    @property
    def second_moment(self) -> Array:
        return np.diag(self.volume * np.square(self.size) / 12)

    @property
    def core(self) -> Core:
        a, b, c = self.size
        return Core(1, (a / 2, b / 2, c / 2), 0.0)

    def surface(self, resolution: int = 32) -> Surface:
        corners, faces = self.facets()
        return corners, halve(faces)

    def facets(self) -> Surface:
        corners = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        return corners * self.size, np.array(faces)

    @property
    def faces(self) -> dict[str, Triangles]:
        names = ("z0", "z1", "y0", "y1", "x0", "x1")  # in the order of the facets
        return {name: np.array([k]) for k, name in enumerate(names)}


@dataclass(frozen=True, config=CONFIG)
class Sphere(Shape):
    """Ball about the origin.

    Parameters
    ----------
    radius : length
    """

    radius: Length

    @property
    def volume(self) -> float:
        return 4 / 3 * np.pi * self.radius**3

    @property
    def second_moment(self) -> Array:
        return self.volume * self.radius**2 / 5 * np.eye(3)

    @property
    def core(self) -> Core:
        return Core(1, (0.0, 0.0, 0.0), self.radius)

    @property
    def feelers(self) -> tuple[Array, float]:
        return np.zeros((1, 3)), self.radius

    def surface(self, resolution: int = 32) -> Surface:
        return revolve(arc(self.radius, -90, 90, max(resolution // 2, 2)), resolution)


@dataclass(frozen=True, config=CONFIG)
class Cylinder(Shape):
    """Circular cylinder along e3, its centre at the origin; its faces are 'z0', 'z1' and 'side'.

    As the first surface of a `Contact` it is a polygon of 32 corners, which rolls and rubs by its rims; see there.

    Parameters
    ----------
    radius, length : lengths
    """

    radius: Length
    length: Length

    @property
    def volume(self) -> float:
        return np.pi * self.radius**2 * self.length

    @property
    def second_moment(self) -> Array:
        across, along = self.radius**2 / 4, self.length**2 / 12
        return self.volume * np.diag([across, across, along])

    @property
    def core(self) -> Core:
        return Core(2, (self.radius, self.radius, self.length / 2), 0.0)

    def surface(self, resolution: int = 32) -> Surface:
        r, z = self.radius, self.length / 2
        return revolve(np.array([(0, -z), (r, -z), (r, z), (0, z)]), resolution)

    @property
    def faces(self) -> dict[str, Triangles]:
        bottom, *side, top = np.split(np.arange(len(self.surface()[1])), 4)
        return {"z0": bottom, "z1": top, "side": np.concatenate(side)}


@dataclass(frozen=True, config=CONFIG)
class Cone(Shape):
    """Circular cone standing on its tip: tip at the origin, axis along +e3, flat base at ``height e3``.

    Its faces are 'side' and 'z1', the base.

    The centre of mass lies at ``¾ height e3``, so that a top spins about the origin of its shape.

    Parameters
    ----------
    radius : length
        Of the base.
    height : length
        From tip to base.

    Examples
    --------
    >>> Cone(radius=0.05, height=0.1).centre.round(15).tolist()
    [0.0, 0.0, 0.075]
    """

    radius: Length
    height: Length

    @property
    def volume(self) -> float:
        return np.pi / 3 * self.radius**2 * self.height

    @property
    def centre(self) -> Array:
        return np.array([0.0, 0.0, 0.75 * self.height])

    @property
    def second_moment(self) -> Array:
        across, along = 3 / 20 * self.radius**2, 3 / 80 * self.height**2
        return self.volume * np.diag([across, across, along])

    def surface(self, resolution: int = 32) -> Surface:
        return revolve(np.array([(0, 0), (self.radius, self.height), (0, self.height)]), resolution)

    @property
    def faces(self) -> dict[str, Triangles]:
        side, base = np.split(np.arange(len(self.surface()[1])), 2)
        return {"side": side, "z1": base}


@dataclass(frozen=True, config=CONFIG)
class Capsule(Shape):
    """Cylinder along e3 with half a ball on either end, its centre at the origin.

    Parameters
    ----------
    radius : length
        Of cylinder and ends.
    length : length
        Of the cylinder alone, between the centres of the two half balls.
    """

    radius: Length
    length: Length

    @property
    def volume(self) -> float:
        return Sphere(self.radius).volume + Cylinder(self.radius, self.length).volume

    @property
    def second_moment(self) -> Array:
        r, half = self.radius, self.length / 2
        ball, middle = Sphere(r), Cylinder(r, self.length)
        # A half ball, its centroid 3/8 r from its flat side, pushed outwards by half the length.
        outwards = ball.volume * (2 * half * 3 / 8 * r + half**2)
        return ball.second_moment + middle.second_moment + np.diag([0.0, 0.0, outwards])

    @property
    def core(self) -> Core:
        return Core(1, (0.0, 0.0, self.length / 2), self.radius)

    @property
    def feelers(self) -> tuple[Array, float]:
        return np.array([(0.0, 0.0, -self.length / 2), (0.0, 0.0, self.length / 2)]), self.radius

    def surface(self, resolution: int = 32) -> Surface:
        quarter, shift = max(resolution // 4, 1), (0, self.length / 2)
        lower, upper = arc(self.radius, -90, 0, quarter) - shift, arc(self.radius, 0, 90, quarter) + shift
        return revolve(np.vstack([lower, upper]), resolution)


@dataclass(frozen=True, config=CONFIG)
class SurfaceMesh(Shape):
    """Body enclosed by a triangle mesh, from a file or given directly.

    The triangles must enclose a positive volume: every edge belongs to exactly two of them, and they run
    anticlockwise as seen from outside. Where the triangles of one connected surface contradict each other,
    they are turned outwards; whatever leaves a doubt is refused. Surfaces that cut through themselves are not
    detected.

    Parameters
    ----------
    file : path, optional
        STL, OBJ or PLY, in the model's unit of length. Equal points are merged.
    points : array_like, (n, 3), optional
    triangles : array_like of int, (m, 3), optional
        Rows of `points`, which neighbours share.

    Raises
    ------
    ValueError
        If the mesh cannot be read, is open, contradicts itself or is inside out; the message names the cure.

    Notes
    -----
    Needs the package trimesh: ``pip install "visviva[mesh]"``.

    Examples
    --------
    >>> points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> tetrahedron = SurfaceMesh(points=points, triangles=[(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    >>> round(tetrahedron.volume, 12), tetrahedron.centre.round(12).tolist()
    (0.166666666667, [0.25, 0.25, 0.25])
    """

    file: Path | None = None
    points: PointRows = Field(default=(), repr=False)
    triangles: TriangleRows = Field(default=(), repr=False)

    def __post_init__(self) -> None:
        given = np.size(self.points) > 0, np.size(self.triangles) > 0
        if given not in ((False, False), (True, True)) or given[0] == (self.file is not None):
            raise InputError("a surface mesh takes either `file` or both `points` and `triangles`")
        _ = self._centred  # a mesh that cannot be used is refused here and now

    @cached_property
    def _closed(self) -> Surface:
        if self.file is not None:
            return check_closed(*read(self.file))
        return check_closed(np.array(self.points, dtype=np.float64), np.array(self.triangles, dtype=np.int64))

    @cached_property
    def _centred(self) -> Any:  # trimesh.Trimesh
        """The mesh moved near the origin: the sums of its moments lose digits with the distance."""
        points, triangles = self._closed
        return load_trimesh().Trimesh(points - self._shift, triangles, process=False)

    @cached_property
    def _shift(self) -> Array:
        return np.asarray(self._closed[0].mean(axis=0))

    @property
    def volume(self) -> float:
        return float(self._centred.volume)

    @property
    def centre(self) -> Array:
        return np.asarray(self._centred.center_mass + self._shift)

    @property
    def second_moment(self) -> Array:
        return euler_tensor(self._centred.moment_inertia)

    def surface(self, resolution: int = 32) -> Surface:
        points, triangles = self._closed
        return points.copy(), triangles.copy()


AnyShape = Box | Sphere | Cylinder | Cone | Capsule | SurfaceMesh
