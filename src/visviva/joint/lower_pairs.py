"""Joints between two frames, each a few products of directors and the vector from one side to the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.arguments import refuse_unless
from visviva.base.errors import InputError
from visviva.component.announcements import Asking
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.joint.joint import Joint, Side, stroke_strain
from visviva.model.form import Form, Strain, Vector, dot, squared

if TYPE_CHECKING:
    from visviva.model.model import Model

Constraints = Sequence[Strain | Form]
TOGETHER = "positive; a Spherical joint keeps points together"


@dataclass(config=settings, eq=False, kw_only=True)
class Spherical(Joint):
    """Ball joint: the two points stay together (3 constraints).

    Parameters
    ----------
    a, b : component or Point
        What is joined; `at` says where on a component.
    at : array (3,)
        Place of both points at the start (length); needed unless `a` and `b` are points.
    """

    needs_frames = False

    def constraints(self, A: Side, B: Side) -> Constraints:
        return list(B.p - A.p)


@dataclass(config=settings, eq=False, kw_only=True)
class Revolute(Joint):
    """Hinge about the axis (5 constraints); coordinate: `angle`.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        A point of the hinge at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Axis of the hinge at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    angle : bool
        Make the angle of `b` about the axis (rad, counting turns) a coordinate of the system.
    """

    has_angle = True

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [*(B.p - A.p), dot(A.d3, B.d1), dot(A.d3, B.d2)]


@dataclass(config=settings, eq=False, kw_only=True)
class Prismatic(Joint):
    """Slider along the axis without rotation (5 constraints); coordinate: `stroke`.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        A point of the slider at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Direction in which it slides at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    stroke : bool
        Make the way of `b` along the axis (length) a coordinate of the system.
    """

    has_stroke = True

    def constraints(self, A: Side, B: Side) -> Constraints:
        p = B.p - A.p
        return [dot(A.d1, p), dot(A.d2, p), dot(A.d1, B.d2), dot(A.d2, B.d3), dot(A.d3, B.d1)]


@dataclass(config=settings, eq=False, kw_only=True)
class Cylindrical(Joint):
    """Slides along and turns about the axis (4 constraints); coordinates: `angle`, `stroke`.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        A point of the axis at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Axis that `b` slides along and turns about at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    angle : bool
        Make the angle of `b` about the axis (rad, counting turns) a coordinate of the system.
    stroke : bool
        Make the way of `b` along the axis (length) a coordinate of the system.
    """

    has_angle = True
    has_stroke = True

    def constraints(self, A: Side, B: Side) -> Constraints:
        p = B.p - A.p
        return [dot(A.d1, p), dot(A.d2, p), dot(A.d3, B.d1), dot(A.d3, B.d2)]


@dataclass(config=settings, eq=False, kw_only=True)
class Planar(Joint):
    """Moves in the plane normal to the axis and turns about the axis (3 constraints); coordinate: `angle`.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        A point of the plane at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Normal of the plane at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    angle : bool
        Make the angle of `b` about the axis (rad, counting turns) a coordinate of the system.
    """

    has_angle = True

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [dot(A.d3, B.p - A.p), dot(A.d3, B.d1), dot(A.d3, B.d2)]


@dataclass(config=settings, eq=False, kw_only=True)
class Screw(Cylindrical):
    """Cylindrical joint that advances by `pitch` per turn (5 constraints); coordinate: `angle`.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        A point of the axis at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Axis of the screw at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    angle : bool
        Make the angle of `b` about the axis (rad, counting turns) a coordinate of the system.
    pitch : float
        Way along the axis per turn (length), not zero; negative for a left-handed thread.
    """

    pitch: Number
    has_stroke = False

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_unless(
            self.pitch != 0, self, "pitch", "different from zero; a Revolute joint does not advance"
        )

    def announce(self, model: Model) -> None:
        model.announce(self, Asking("angle"))

    def constraints(self, A: Side, B: Side) -> Constraints:
        advance = stroke_strain(A, B) - self.pitch / (2 * np.pi) * self.coordinate("angle")
        return [*super().constraints(A, B), advance - advance.value(self._x0)]

    def contribute(self, model: Model) -> None:
        self._x0, _ = model.initial
        super().contribute(model)


@dataclass(config=settings, eq=False, kw_only=True)
class Universal(Joint):
    """Cardan joint: points together, first director of a normal to second director of b (4 constraints).

    These directors are the pins of the cross. Where the shafts are bent at the start, give the axis of the shaft of b
    as ``axis`` and the pin on a, which is normal to both shafts, as ``first``: other choices are joints with skew pins.

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        Centre of the cross at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Axis of the shaft of `b` at the start, of any length; z if not given.
    first : array (3,)
        The pin on `a`, normal to both shafts; chosen if not given.
    """

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [*(B.p - A.p), dot(A.d1, B.d2)]


@dataclass(config=settings, eq=False, kw_only=True)
class Rigid(Joint):
    """Weld: no relative motion (6 constraints).

    Parameters
    ----------
    a, b : component or Frame
        What is joined; `at`, `axis` and `first` say where on a component.
    at : array (3,)
        Where the frames are joined at the start (length); needed unless `a` and `b` are frames.
    axis : array (3,)
        Third direction of both frames at the start, of any length; z if not given.
    first : array (3,)
        What the first directors of both frames are close to at the start, made normal to the axis; chosen if not given.
    """

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [*(B.p - A.p), dot(A.d1, B.d2), dot(A.d2, B.d3), dot(A.d3, B.d1)]


@dataclass(config=settings, eq=False, kw_only=True)
class PointOnLine(Joint):
    """The point of b stays on the line through a along the axis (2 constraints); coordinate: `stroke`.

    Parameters
    ----------
    a : component or Frame
        What the line is on.
    b : component or Point
        Whose point stays on it.
    at : array (3,)
        Place of the point at the start (length); needed unless `a` is a frame and `b` a point.
    axis : array (3,)
        Direction of the line at the start, of any length; z if not given.
    first : array (3,)
        What the first director of the frame is close to at the start, made normal to the axis; chosen if not given.
    stroke : bool
        Make the way of the point along the axis (length) a coordinate of the system.
    """

    has_stroke = True
    needs_frame_b = False

    def constraints(self, A: Side, B: Side) -> Constraints:
        p = B.p - A.p
        return [dot(A.d1, p), dot(A.d2, p)]


@dataclass(config=settings, eq=False, kw_only=True)
class PointOnPlane(Joint):
    """The point of b stays in the plane through a normal to the axis (1 constraint).

    Parameters
    ----------
    a : component or Frame
        What the plane is on.
    b : component or Point
        Whose point stays in it.
    at : array (3,)
        Place of the point at the start (length); needed unless `a` is a frame and `b` a point.
    axis : array (3,)
        Normal of the plane at the start, of any length; z if not given.
    first : array (3,)
        What the first director of the frame is close to at the start, made normal to the axis; chosen if not given.
    """

    needs_frame_b = False

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [dot(A.d3, B.p - A.p)]


@dataclass(config=settings, eq=False, kw_only=True)
class Distance(Joint):
    """Massless rod between two points (1 constraint); its length is the initial distance if not given.

    Parameters
    ----------
    a, b : Point, or component
        What it connects; a component, one of the two at most, by the point of it that is at `at`.
    at : array (3,)
        Place at the start (length) of the point of a component.
    length : float, optional
        Positive; the distance at the start if not given.
    """

    length: Number | None = None
    needs_frames = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.length is not None:
            refuse_unless(self.length > 0, self, "length", TOGETHER)

    def declare(self, model: Model) -> None:
        super().declare(model)
        A, B = self.sides
        apart = float(np.sqrt(squared(B.p - A.p).value(model.initial[0])))
        self._length = apart if self.length is None else self.length
        if not self._length > 0:
            raise InputError(f"{self.label}: length {self._length:g} is not {TOGETHER}")

    def constraints(self, A: Side, B: Side) -> Constraints:
        return [0.5 * squared(B.p - A.p) - 0.5 * self._length**2]

    def lines(self) -> list[tuple[Vector, Vector]]:
        return [(self.sides[0].p, self.sides[1].p)]
