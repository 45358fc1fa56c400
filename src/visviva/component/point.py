"""Points and frames: everything attaches to these, so no joint knows what it joins."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.arguments import place
from visviva.base.errors import InputError
from visviva.component.component import COMPOSITION, Component
from visviva.component.momentum import NOWHERE, Axes
from visviva.model.field import Vectors
from visviva.model.form import Vector

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State

Array = NDArray[np.float64]


def owned(made: Callable[..., Vector]) -> Callable[..., Vector]:
    """A method that makes forms of a component's unknowns, which then know the system that numbered these."""

    @wraps(made)
    def of_its_system(self: Attachable, *args: Any) -> Vector:
        return made(self, *args).owned(vars(self).get(COMPOSITION))

    return of_its_system


class Attachable(Component):
    """A component that others can be attached to: its material points are linear forms of its unknowns."""

    has_directions = True
    moves_rigidly = True  # one frame carries all its points; otherwise directions depend on where they are
    is_massless = False  # frames that go with another component

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for name in ("place", "turn"):
            if name in vars(cls):
                setattr(cls, name, owned(vars(cls)[name]))

    @property
    def outside_axes(self) -> Axes:
        return NOWHERE  # what acts on it does

    def place(self, X: Array) -> Vector:
        """Position of the material point `X` (3,), given in the component's own coordinates."""
        raise NotImplementedError

    def turn(self, direction: Array, X: Array) -> Vector:
        """A material direction (3,) at the material point `X` (3,), both given in the component's own coordinates."""
        raise InputError(f"{self.label} has no directions to attach a frame to; attach a point instead")

    def local(self, x: Array) -> Array:
        """Own coordinates of the material point that is at `x` initially."""
        raise NotImplementedError

    def local_direction(self, d: Array, X: Array) -> Array:
        """Own coordinates at the material point `X` of a direction given in space initially."""
        return d

    def vectors(self, model: Model) -> Vectors | None:
        """Vectors of the component: first unknowns (n,), mask of positions (n,), and their components, 2 or 3.

        Positions move along under a translation, directors do not. None for what cannot move.
        """
        nodes = model.nodes.get(self)
        if nodes is None:
            return None
        starts, is_position = zip(*nodes, strict=True)
        return np.array(starts), np.array(is_position), 3

    def wrench(self, state: State, force: Mapping[int, float], about: Array) -> tuple[Array, Array] | None:
        """Force (3,) and torque (3,) about a point of forces by unknown; None for what cannot move."""
        vectors = self.vectors(state.model)
        if vectors is None:
            return None
        starts, is_position, width = vectors
        by_unknown = np.zeros(len(state.x))
        by_unknown[list(force)] = list(force.values())
        index, beyond = starts[:, None] + np.arange(width), ((0, 0), (0, 3 - width))
        f, x = np.pad(by_unknown[index], beyond), np.pad(state.x[index], beyond)
        arms = x - np.where(is_position[:, None], about, 0.0)
        return f[is_position].sum(axis=0), np.cross(arms, f).sum(axis=0)

    def feelers(self) -> tuple[Array, float] | None:
        """Points (n, 3), in own coordinates, at which it touches others, and the radius of balls about them."""
        return None

    def point(self, X: Any = (0.0, 0.0, 0.0)) -> Point:
        """The material point with own coordinates `X` (3,).

        Those of rigid bodies count from the centre of mass along the body's axes, those of couplings from the centre of
        their faces; those of solids, beams and shells are places of the reference. `point_at` takes places in space.
        """
        return Point(self, place(self.label, "X", X))

    def point_at(self, x: Any) -> Point:
        """The material point that is at `x` (3,) in the initial configuration."""
        return self.point(self.local(place(self.label, "x", x)))

    def frame(self, X: Any = (0.0, 0.0, 0.0), axes: Any = ((1, 0, 0), (0, 1, 0), (0, 0, 1))) -> Frame:
        """Point and three orthonormal directions, given by rows in own coordinates."""
        return Frame(self, place(self.label, "X", X), place(self.label, "axes", axes, (3, 3)))

    def frame_at(self, x: Any, axis: Any = (0.0, 0.0, 1.0), first: Any = None) -> Frame:
        """Frame at `x` with third direction `axis` (and the first close to `first`), in space initially."""
        X = self.local(place(self.label, "x", x))
        return self.frame(X, np.array([self.local_direction(d, X) for d in triad(axis, first)]))


@dataclass(frozen=True, eq=False)
class Point:
    """A material point of a component: a constant linear form of its unknowns."""

    component: Attachable
    X: Array

    @property
    def position(self) -> Vector:
        """Position in space as a vector form, once the component is part of a system."""
        try:
            return self.component.place(self.X)
        except AttributeError:
            refuse_uncomposed(self.component)
            raise


@dataclass(frozen=True, eq=False)
class Frame(Point):
    """A material point with three material directions, rows of `axes`; the third is the axis of joints."""

    axes: Array

    def __post_init__(self) -> None:
        if orthonormality(self.axes) > 1e-9 or handedness(self.axes) < 0:
            raise InputError(
                f"the frame on {self.component.label} has axes that are not right-handed and orthonormal: "
                f"{self.axes.tolist()}; use frame_at(x, axis) to get a triad from one axis"
            )

    @property
    def directors(self) -> tuple[Vector, Vector, Vector]:
        """The three directions in space as vector forms."""
        try:
            a, b, c = (self.component.turn(axis, self.X) for axis in self.axes)
        except AttributeError:
            refuse_uncomposed(self.component)
            raise
        return a, b, c


def refuse_uncomposed(component: Component) -> None:
    """Say what is missing where a component is asked for its unknowns before a system has given it any."""
    if not hasattr(component, "_system"):
        raise InputError(
            f"{component.label} is not part of a system yet: what is asked for is a form of its unknowns, which "
            "vv.System([...]) numbers; compose the system first"
        ) from None


def triad(axis: Any, first: Any = None) -> Array:
    """Right-handed orthonormal rows whose third is along `axis`; the first is the projection of `first`.

    Examples
    --------
    >>> triad((0, 0, 2)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    d3 = unit(vector(axis))
    if d3 is None:
        raise InputError(f"an axis needs three finite numbers that are not all zero, not {axis}")
    if first is None:
        sizes = [round(abs(c), 9) for c in d3]
        first = np.eye(3)[sizes.index(min(sizes))]
    given = vector(first)
    along = dot(given, d3)
    d1 = unit([g - along * d for g, d in zip(given, d3, strict=True)], 1e-9)
    if d1 is None:
        raise InputError(f"the first direction {first} is parallel to the axis {axis}")
    return np.array([d1, cross(d3, d1), d3])


# --- three numbers as plain Python: much quicker than arrays of them ----------------------------------------
Three = Sequence[float]


def vector(value: Any) -> list[float]:
    """Whatever is given, as a list of numbers."""
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.shape != (3,):
        raise InputError(f"a direction is 3 numbers, not {value!r}")
    listed: list[float] = numbers.tolist()
    return listed


def dot(a: Three, b: Three) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Three, b: Three) -> list[float]:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a: Three, least: float = 0.0) -> list[float] | None:
    """Three numbers divided by their length; None if that is not finite or not above `least`."""
    size = math.hypot(*a) if len(a) == 3 else math.nan
    return [c / size for c in a] if least < size < math.inf else None


def orthonormality(rows: Array) -> float:
    """By how much the rows of a matrix (3, 3) fail to be orthonormal."""
    a, b, c = rows.tolist()
    defects = dot(a, a) - 1, dot(b, b) - 1, dot(c, c) - 1, dot(a, b), dot(b, c), dot(c, a)
    return max(map(abs, defects))


def handedness(matrix: Array) -> float:
    """Determinant of a matrix (3, 3): positive for a right-handed triad."""
    a, b, c = matrix.tolist()
    return dot(a, cross(b, c))


if TYPE_CHECKING:
    Attached = Attachable | Point
else:
    Attached = Any  # checked by what uses it, which says more than a union can
"""What joints, forces and springs attach to."""
