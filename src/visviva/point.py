"""Points and frames: everything attaches to these, so no joint knows what it joins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.component import Attachable
from visviva.errors import InputError
from visviva.form import Vector

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Point:
    """A material point of a component: a constant linear form of its unknowns."""

    component: Attachable
    X: Array

    @property
    def position(self) -> Vector:
        """Position in space as a vector form."""
        return self.component.place(self.X)


@dataclass(frozen=True, eq=False)
class Frame(Point):
    """A material point with three material directions, rows of `axes`; the third is the axis of joints."""

    axes: Array

    def __post_init__(self) -> None:
        if not np.allclose(self.axes @ self.axes.T, np.eye(3), atol=1e-9) or np.linalg.det(self.axes) < 0:
            raise InputError(
                f"the frame on {self.component.label} has axes that are not right-handed and orthonormal: "
                f"{self.axes.tolist()}; use frame_at(x, axis) to get a triad from one axis"
            )

    @property
    def directors(self) -> tuple[Vector, Vector, Vector]:
        """The three directions in space as vector forms."""
        a, b, c = (self.component.turn(axis) for axis in self.axes)
        return a, b, c


def triad(axis: Any, first: Any = None) -> Array:
    """Right-handed orthonormal rows whose third is along `axis`; the first is the projection of `first`.

    Examples
    --------
    >>> triad((0, 0, 2)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    d3 = np.asarray(axis, dtype=float)
    size = np.linalg.norm(d3)
    if d3.shape != (3,) or not np.isfinite(size) or size == 0:
        raise InputError(f"an axis needs three finite numbers that are not all zero, not {axis}")
    d3 = d3 / size
    if first is None:
        first = np.eye(3)[int(np.argmin(np.round(np.abs(d3), 9)))]
    d1 = np.asarray(first, dtype=float) - np.dot(first, d3) * d3
    if np.linalg.norm(d1) < 1e-9:
        raise InputError(f"the first direction {first} is parallel to the axis {axis}")
    d1 = d1 / np.linalg.norm(d1)
    return np.array([d1, np.cross(d3, d1), d3])
