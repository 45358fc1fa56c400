"""Structured meshes by counts of cells: values like shapes, with `build()`.

Every region is the image of grids on [0, 1]^n, so that nodes in the middle of edges lie on the geometry too.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, FiniteFloat
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED, Validated
from visviva.base.errors import InputError
from visviva.mesh.cells import Array
from visviva.mesh.grid import SIDES, Block, Grid, Names, assembled
from visviva.mesh.mesh import Mesh

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]
Counts2 = Annotated[tuple[Count, Count], LISTED]
Counts3 = Annotated[tuple[Count, Count, Count], LISTED]
Lengths2 = Annotated[tuple[Length, Length], LISTED]
Lengths3 = Annotated[tuple[Length, Length, Length], LISTED]
Place2 = Annotated[tuple[FiniteFloat, FiniteFloat], LISTED]
Place3 = Annotated[tuple[FiniteFloat, FiniteFloat, FiniteFloat], LISTED]
Places4 = Annotated[tuple[Place2, Place2, Place2, Place2], LISTED]
Angle = Annotated[float, Field(gt=0, le=2 * np.pi)]
PlaneCell = Literal["quad4", "quad8", "quad9", "tri3", "tri6"]
SolidCell = Literal["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"]
CONFIG = ConfigDict(extra="forbid", defer_build=True)
FULL = 2 * np.pi
WELD = 1e-9  # of the size: distance below which nodes of neighbouring blocks are one


Share = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Grade = Share | Annotated[tuple[Share, ...], LISTED]
Grading2 = Annotated[tuple[Grade, Grade], LISTED]
Grading3 = Annotated[tuple[Grade, Grade, Grade], LISTED]


def graded(places: Array, counts: tuple[int, ...], grading: tuple[Any, ...] | None) -> Array:
    """Coordinates (n, d) in [0, 1] of even blocks, moved to where blocks grow as told.

    Examples
    --------
    >>> graded(np.array([[0.0], [0.5], [1.0]]), (2,), (3.0,)).ravel().tolist()
    [0.0, 0.25, 1.0]
    """
    if grading is None:
        return places
    moved = []
    for k, (n, grade) in enumerate(zip(counts, grading, strict=True)):
        lengths = np.array(grade if isinstance(grade, tuple) else np.geomspace(1.0, grade, n), dtype=float)
        if len(lengths) != n:
            raise InputError(
                f"grading has {len(lengths)} lengths for {n} blocks along axis {k + 1}: give one each"
            )
        ends = np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
        moved.append(np.interp(places[:, k], np.linspace(0.0, 1.0, n + 1), ends))
    return np.column_stack(moved)


class MeshSource(metaclass=Validated):
    """Source of a mesh: a generator or a file."""

    @abstractmethod
    def build(self) -> Mesh:
        """The mesh."""


@dataclass(frozen=True, config=CONFIG)
class BoxMesh(MeshSource):
    """Mesh of a cuboid with edges along the axes.

    Parameters
    ----------
    size : three lengths
        Edge lengths along e1, e2, e3.
    counts : three numbers
        Blocks along each edge; tetrahedra (six) and wedges (two) divide blocks.
    cell : {"hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"}
    origin : point
        The corner with the least coordinates.
    grading : by axis a number or lengths, optional
        The last block's length by the first one's, with powers between; or relative lengths of all blocks.

    Notes
    -----
    Sets of faces: x0, x1, y0, y1, z0, z1.

    Examples
    --------
    >>> BoxMesh(size=(2, 1, 1), counts=(4, 2, 2)).build()
    <Mesh: 45 nodes, 16 hex8; sets: x0, x1, y0, y1, z0, z1>
    """

    size: Lengths3
    counts: Counts3
    cell: SolidCell = "hex8"
    origin: Place3 = (0.0, 0.0, 0.0)
    grading: Grading3 | None = None

    def build(self) -> Mesh:
        """The mesh."""
        grid = Grid(self.counts, self.cell)
        return grid.mesh(
            np.array(self.origin) + graded(grid.places, self.counts, self.grading) * self.size, SIDES
        )


@dataclass(frozen=True, config=CONFIG)
class RectangleMesh(MeshSource):
    """Plane mesh of a rectangle with edges along the axes.

    Parameters
    ----------
    size : two lengths
    counts : two numbers
        Blocks along each edge; triangles halve blocks.
    cell : {"quad4", "quad8", "quad9", "tri3", "tri6"}
    origin : point, (2,)
        The corner with the least coordinates.
    grading : by axis a number or lengths, optional
        The last block's length by the first one's, with powers between; or relative lengths of all blocks.

    Notes
    -----
    Sets of edges: x0, x1, y0, y1.

    Examples
    --------
    >>> RectangleMesh(size=(2, 1), counts=(4, 2), cell="quad9").build()
    <Mesh: 45 nodes, 8 quad9; sets: x0, x1, y0, y1>
    """

    size: Lengths2
    counts: Counts2
    cell: PlaneCell = "quad4"
    origin: Place2 = (0.0, 0.0)
    grading: Grading2 | None = None

    def build(self) -> Mesh:
        """The mesh."""
        grid = Grid(self.counts, self.cell)
        return grid.mesh(
            np.array(self.origin) + graded(grid.places, self.counts, self.grading) * self.size, SIDES[:2]
        )


@dataclass(frozen=True, config=CONFIG)
class QuadrilateralMesh(MeshSource):
    """Plane mesh of a quadrilateral with straight edges.

    Parameters
    ----------
    corners : four points, (4, 2)
        Anticlockwise.
    counts : two numbers
        Blocks along the first and second edge.
    cell : {"quad4", "quad8", "quad9", "tri3", "tri6"}

    Notes
    -----
    Sets of edges: y0 from the first corner to the second, then x1, y1, x0.

    Examples
    --------
    Cook's membrane:

    >>> cook = QuadrilateralMesh(corners=[(0, 0), (48, 44), (48, 60), (0, 44)], counts=(8, 8)).build()
    >>> round(cook.volume, 9), cook.faces("x1").n_faces
    (1440.0, 8)
    """

    corners: Places4
    counts: Counts2
    cell: PlaneCell = "quad4"

    def __post_init__(self) -> None:
        edges = np.roll(self.corners, -1, axis=0) - np.array(self.corners)
        following = np.roll(edges, -1, axis=0)
        if not np.all(edges[:, 0] * following[:, 1] > edges[:, 1] * following[:, 0]):
            raise InputError(
                f"the corners {self.corners} do not make a convex quadrilateral: give them anticlockwise"
            )

    def build(self) -> Mesh:
        """The mesh."""
        grid = Grid(self.counts, self.cell)
        return grid.mesh(_bilinear(grid.places, np.array(self.corners)), SIDES[:2])


def _bilinear(places: Array, corners: Array) -> Array:
    """Points of a quadrilateral (4, d) for places (n, 2) in the unit square."""
    u, v = places[:, 0, None], places[:, 1, None]
    a, b, c, d = corners
    return np.asarray((1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d)


@dataclass(frozen=True, config=CONFIG)
class HollowCylinderMesh(MeshSource):
    """Mesh of a tube along e3 that stands on the plane z = 0, or of a sector of it.

    Parameters
    ----------
    inner_radius, outer_radius, height : lengths
    counts : three numbers
        Blocks through the wall, around, along e3.
    cell : {"hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"}
    angle : float
        Of the sector, in radians from e1 towards e2; all round by default.

    Notes
    -----
    Sets of faces: inner, outer, bottom, top; of a sector also start, end.

    Examples
    --------
    >>> HollowCylinderMesh(inner_radius=1, outer_radius=2, height=1, counts=(2, 8, 1), angle=1.0).build()
    <Mesh: 54 nodes, 16 hex8; sets: inner, outer, start, end, bottom, top>
    """

    inner_radius: Length
    outer_radius: Length
    height: Length
    counts: Counts3
    cell: SolidCell = "hex8"
    angle: Angle = FULL

    def __post_init__(self) -> None:
        if self.inner_radius >= self.outer_radius:
            raise InputError(
                f"inner_radius {self.inner_radius} is not below outer_radius {self.outer_radius}"
            )
        _enough(self.counts[1], "around", self.angle / np.pi)

    def build(self) -> Mesh:
        """The mesh."""
        closed = self.angle == FULL
        grid = Grid(self.counts, self.cell, periodic=(1,) if closed else ())
        u, v, w = grid.places.T
        radius, phi = self.inner_radius + u * (self.outer_radius - self.inner_radius), v * self.angle
        points = np.column_stack([radius * np.cos(phi), radius * np.sin(phi), w * self.height])
        ends = (None, None) if closed else ("start", "end")
        return grid.mesh(points, (("inner", "outer"), ends, ("bottom", "top")))


@dataclass(frozen=True, config=CONFIG)
class HollowTorusMesh(MeshSource):
    """Mesh of a torus tube round e3, its centre at the origin.

    Parameters
    ----------
    major_radius : length
        From the centre to the middle of the tube.
    outer_minor_radius : length
        From the middle of the tube to its outer surface.
    wall : length
        Thickness of the tube.
    counts : three numbers
        Blocks around e3, around the tube, through the wall.
    cell : {"hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"}

    Notes
    -----
    Sets of faces: inner, outer. The defaults are the torus of Hesch & Betsch (2012).

    Examples
    --------
    >>> HollowTorusMesh().build()
    <Mesh: 12036 nodes, 8024 hex8; sets: inner, outer>
    """

    major_radius: Length = 76.0
    outer_minor_radius: Length = 24.0
    wall: Length = 4.5
    counts: Counts3 = (118, 34, 2)
    cell: SolidCell = "hex8"

    def __post_init__(self) -> None:
        if not self.wall < self.outer_minor_radius < self.major_radius:
            raise InputError(
                f"a hollow torus needs wall < outer_minor_radius < major_radius, not {self.wall}, "
                f"{self.outer_minor_radius}, {self.major_radius}"
            )
        for count, way in zip(self.counts[:2], ("around e3", "around the tube"), strict=True):
            _enough(count, way, 2.0)

    def build(self) -> Mesh:
        """The mesh."""
        grid = Grid(self.counts, self.cell, periodic=(0, 1))
        u, v, w = grid.places.T
        around, tube = FULL * u, FULL * v
        radius = self.outer_minor_radius - self.wall * (1 - w)
        arm = self.major_radius + radius * np.cos(tube)
        points = np.column_stack([arm * np.cos(around), arm * np.sin(around), radius * np.sin(tube)])
        return grid.mesh(points, ((None, None), (None, None), ("inner", "outer")))


def _enough(count: int, way: str, half_turns: float) -> None:
    """A block may not span half a turn or more."""
    least = int(half_turns) + 1
    if count < least:
        raise InputError(f"counts has {count} {way}: give at least {least}")


@dataclass(frozen=True, config=CONFIG)
class CylinderMesh(MeshSource):
    """Mesh of a solid cylinder along e3 that stands on the plane z = 0, or of a sector of it.

    A core of quadrilaterals about the axis lies in a ring.

    Parameters
    ----------
    radius, height : lengths
    counts : three numbers
        Blocks along half an edge of the core, through the ring, along e3; a full circle has eight times the
        first around it.
    cell : {"hex8", "hex20", "hex27", "tet4", "tet10", "wedge6"}
    angle : float
        Of the sector, in radians from e1 towards e2; all round by default.

    Notes
    -----
    Sets of faces: outer, bottom, top; of a sector also start, end.

    Examples
    --------
    >>> CylinderMesh(radius=1, height=2, counts=(1, 1, 2)).build()
    <Mesh: 51 nodes, 24 hex8; sets: bottom, top, outer>
    """

    radius: Length
    height: Length
    counts: Counts3
    cell: SolidCell = "hex8"
    angle: Angle = FULL

    def build(self) -> Mesh:
        """The mesh."""
        n_slices = int(np.ceil(self.angle / (np.pi / 2) - 1e-9))
        blocks = [block for k in range(n_slices) for block in self._slice(k, n_slices)]
        return assembled(blocks, self.cell, WELD * min(self.radius, self.height))

    def _slice(self, k: int, n_slices: int) -> Iterator[Block]:
        """Core and both halves of the ring of a slice; coordinates run outwards in all of them."""
        first, last = self.angle * k / n_slices, self.angle * (k + 1) / n_slices
        middle = (first + last) / 2
        start = "start" if k == 0 and self.angle != FULL else None
        end = "end" if k == n_slices - 1 and self.angle != FULL else None
        n_core, n_ring, n_along = self.counts
        polar = self.radius * np.array([0.0, 0.5, 0.6, 0.5])
        angles = np.array([0.0, first, middle, last])
        core = np.column_stack([polar * np.cos(angles), polar * np.sin(angles)])
        caps = ("bottom", "top")

        def in_core(p: Array) -> Array:
            return self._raised(_bilinear(p, core), p)

        def in_lower(p: Array) -> Array:
            return self._raised(self._ring(p[:, 0], p[:, 1], core[1], core[2], first, middle), p)

        def in_upper(p: Array) -> Array:
            return self._raised(self._ring(p[:, 1], p[:, 0], core[3], core[2], last, middle), p)

        yield (n_core, n_core, n_along), in_core, ((end, None), (start, None), caps)
        yield (n_ring, n_core, n_along), in_lower, ((None, "outer"), (start, None), caps)
        yield (n_core, n_ring, n_along), in_upper, ((end, None), (None, "outer"), caps)

    def _ring(self, out: Array, along: Array, a: Array, b: Array, start: float, end: float) -> Array:
        """Points between a straight edge from a to b and the arc outside it."""
        angle = start + along * (end - start)
        arc = self.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        edge = a + along[:, None] * (b - a)
        return edge + out[:, None] * (arc - edge)

    def _raised(self, flat: Array, places: Array) -> Array:
        return np.column_stack([flat, self.height * places[:, 2]])


@dataclass(frozen=True, config=CONFIG)
class SphereMesh(MeshSource):
    """Mesh of a solid ball about the origin: a bulged cube in a shell.

    Parameters
    ----------
    radius : length
    counts : two numbers
        Blocks along half an edge of the cube, through the shell; a great circle has eight times the first.
    cell : {"hex8", "hex20", "hex27", "tet4", "tet10"}

    Notes
    -----
    Set of faces: outer.

    Examples
    --------
    >>> SphereMesh(radius=1, counts=(2, 2)).build()
    <Mesh: 321 nodes, 256 hex8; sets: outer>
    """

    radius: Length
    counts: Counts2
    cell: Literal["hex8", "hex20", "hex27", "tet4", "tet10"] = "hex8"

    def build(self) -> Mesh:
        """The mesh."""
        octants = [(x, y, z) for z in (1, -1) for y in (1, -1) for x in (1, -1)]
        blocks = [block for signs in octants for block in self._octant(np.array(signs))]
        return assembled(blocks, self.cell, WELD * self.radius)

    def _octant(self, signs: Array) -> Iterator[Block]:
        """Cube and three parts of the shell; coordinates run outwards, so that mirrored octants fit."""
        n, m = self.counts
        mirrored = np.prod(signs) < 0
        order = [1, 0, 2] if mirrored else [0, 1, 2]

        def cube(p: Array) -> Array:
            return self.radius * signs * self._core(p[:, order])

        yield (n, n, n), cube, ((None, None),) * 3
        for axis in range(3):

            def shell(p: Array, axis: int = axis) -> Array:
                q = p[:, order]
                out = q[:, axis, None]
                on_cube = q.copy()
                on_cube[:, axis] = 1.0
                inner = self._core(on_cube)
                return self.radius * signs * (inner + out * (_bulged(on_cube, 1.0) - inner))

            counts = [n, n, n]
            counts[order.index(axis)] = m
            names: Names = [(None, "outer" if order[k] == axis else None) for k in range(3)]
            yield counts, shell, names

    def _core(self, p: Array) -> Array:
        return 0.5 * _bulged(p, 0.6)


def _bulged(p: Array, much: float) -> Array:
    """The cube [-1, 1]^3 bulged smoothly; with `much` 1 it is the unit ball."""
    x, y, z = much * np.square(p).T
    pairs = ((y, z), (z, x), (x, y))
    factors = [1 - (a + b) / 2 + a * b / 3 for a, b in pairs]
    return np.asarray(p * np.sqrt(np.column_stack(factors)))
