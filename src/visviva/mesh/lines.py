"""Meshes of lines by counts of cells: straight, through points, arcs and helices."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, FiniteFloat, GetPydanticSchema
from pydantic.dataclasses import dataclass

from visviva.base.arguments import LISTED
from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Array
from visviva.mesh.generate import CONFIG, Length, MeshSource, Place3
from visviva.mesh.mesh import Mesh

LineCell = Literal["line2", "line3", "line4"]
Count = Annotated[int, Field(ge=1)]
Rows = Annotated[tuple[Place3, ...], LISTED, Field(min_length=2)]
Places = Annotated[ArrayLike, GetPydanticSchema(lambda _, schema_of: schema_of(Rows))]
Direction = Annotated[ArrayLike, GetPydanticSchema(lambda _, schema_of: schema_of(Place3))]
FINE = 400
"""Pieces per span by which the length of a curve is measured."""


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class CurveMesh(MeshSource):
    """Base of meshes along one curve, in cells of equal length; its ends are the sets `start` and `end`."""

    count: Count = 1
    cell: LineCell = "line2"

    is_closed = False

    @abstractmethod
    def at(self, t: Array) -> Array:
        """Places (n, 3) at parameters (n,) from 0 to 1, which follow the curve at any speed."""

    def build(self) -> Mesh:
        """The mesh."""
        step = CELLS[self.cell].n_nodes - 1
        if self.is_closed and step * self.count < 3:
            raise InputError(
                f"{type(self).__name__}: count = {self.count} gives a closed line too few nodes; three or more"
            )
        n = step * self.count
        points = self.at(self._even(n + 1))
        first = step * np.arange(self.count)
        cells = np.stack([first, first + step, *(first + k for k in range(1, step))], axis=1)
        if self.is_closed:
            points, cells = points[:-1], cells % n
        ends = {} if self.is_closed else {"start": np.array([0]), "end": np.array([n])}
        return Mesh(points, {self.cell: cells}, node_sets=ends)

    def _even(self, n: int) -> Array:
        """Parameters (n,) at equal distances along the curve."""
        t = np.linspace(0, 1, FINE * (n - 1) + 1)
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.at(t), axis=0), axis=1))])
        even: Array = np.interp(np.linspace(0, length[-1], n), length, t)
        return even


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class LineMesh(CurveMesh):
    """Mesh of a straight line, or of a smooth one through points.

    Parameters
    ----------
    points : (n, 3)
        Two for a straight line; through more goes a cubic spline over the length of chords. For straight pieces with
        corners give each its own mesh.
    count : int
        Number of cells.
    cell : {"line2", "line3", "line4"}
    closed : bool
        Whether the curve returns smoothly to its first point.

    Examples
    --------
    >>> LineMesh(points=[(0, 0, 0), (2, 0, 0)], count=4).build()
    <Mesh: 5 nodes, 4 line2; sets: start, end>
    """

    points: Places
    closed: bool = False

    def __post_init__(self) -> None:
        apart = np.linalg.norm(np.diff(self._places, axis=0), axis=1)
        if not np.all(apart > 0):
            k = int(np.argmin(apart))
            raise InputError(f"LineMesh: points {k} and {k + 1} are the same, {self._places[k].tolist()}")
        if self.closed and len(self._places) < 4:
            raise InputError("LineMesh: a closed curve needs three points or more")

    @property
    def is_closed(self) -> bool:  # type: ignore[override]
        return self.closed

    @property
    def _places(self) -> Array:
        points = np.array(self.points, dtype=float)
        return np.concatenate([points, points[:1]]) if self.closed else points

    def at(self, t: Array) -> Array:
        p = self._places
        if len(p) == 2:
            return np.asarray(p[0] + t[:, None] * (p[1] - p[0]))
        from scipy.interpolate import CubicSpline

        chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
        ends = "periodic" if self.closed else "natural" if len(p) == 3 else "not-a-knot"
        return np.asarray(CubicSpline(chord / chord[-1], p, bc_type=ends)(t))


@dataclass(frozen=True, config=CONFIG, kw_only=True)
class ArcMesh(CurveMesh):
    """Mesh of an arc, or of a helix where it rises.

    Parameters
    ----------
    radius : length
    angle : float
        From start to end, in radians, anticlockwise about `axis`; 2 pi or more only where it rises.
    rise : float
        Along the axis from start to end.
    centre, axis : point
    start : direction, (3,)
        From the centre to where it starts, as far as that is normal to the axis.
    count : int
    cell : {"line2", "line3", "line4"}

    Notes
    -----
    An angle of 2 pi without rise closes the ring: it has no ends.

    Examples
    --------
    >>> import numpy as np
    >>> ArcMesh(radius=2.0, angle=np.pi / 2, count=2).build().points.round(3).tolist()
    [[2.0, 0.0, 0.0], [1.414, 1.414, 0.0], [0.0, 2.0, 0.0]]
    """

    radius: Length
    angle: FiniteFloat
    rise: FiniteFloat = 0.0
    centre: Direction = (0.0, 0.0, 0.0)
    axis: Direction = (0.0, 0.0, 1.0)
    start: Direction = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if self.angle == 0 or (self.rise == 0 and abs(self.angle) > 2 * np.pi + 1e-12):
            raise InputError(f"ArcMesh: angle = {self.angle:g} gives no arc; give one within 2 pi, or a rise")
        self._axes()

    @property
    def is_closed(self) -> bool:  # type: ignore[override]
        return self.rise == 0 and abs(self.angle) > 2 * np.pi - 1e-12

    def _axes(self) -> Array:
        """Directions (3, 3) by rows: to the start, along the arc there, and the axis."""
        e3, e1 = np.array(self.axis), np.array(self.start)
        size = np.linalg.norm(e3)
        e3 = e3 / size if size > 0 else e3
        e1 = e1 - (e1 @ e3) * e3
        if size == 0 or np.linalg.norm(e1) <= 1e-9 * np.linalg.norm(self.start):
            raise InputError(
                f"ArcMesh: start = {self.start} is along axis = {self.axis}, or one of them is zero"
            )
        e1 = e1 / np.linalg.norm(e1)
        return np.array([e1, np.cross(e3, e1), e3])

    def at(self, t: Array) -> Array:
        e1, e2, e3 = self._axes()
        angle = self.angle * t[:, None]
        ring = self.radius * (np.cos(angle) * e1 + np.sin(angle) * e2)
        return np.asarray(np.array(self.centre) + ring + self.rise * t[:, None] * e3)
