"""Base of all joints: two frames, constraints as strains, coordinates by augmentation, reactions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.announcements import Asking
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.point import Attachable, Attached, Frame, Point, refuse_uncomposed
from visviva.component.values import Vector3
from visviva.model.form import Form, Strain, Vector, dot, strain
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.field import Field
    from visviva.model.model import Model

Array = NDArray[np.float64]


class Side:
    """One side of a joint: position and, where the component has directions, three directors."""

    def __init__(self, point: Point) -> None:
        self.point = point

    @cached_property
    def p(self) -> Vector:
        """Position of the point."""
        return self.point.position

    @cached_property
    def d1(self) -> Vector:
        """First direction of the frame."""
        return self._director(0)

    @cached_property
    def d2(self) -> Vector:
        """Second direction."""
        return self._director(1)

    @cached_property
    def d3(self) -> Vector:
        """Third direction: the axis."""
        return self._director(2)

    def _director(self, k: int) -> Vector:
        assert isinstance(self.point, Frame)
        return self.point.component.turn(self.point.axes[k], self.point.X)


@dataclass(config=settings, eq=False, kw_only=True)
class Joint(Component):
    """Base of joints: `constraints` is all that a joint defines.

    Parameters
    ----------
    a, b : component, Point or Frame
        What is joined. For a component, `at` and `axis` say where.
    at : array (3,)
        Place of the joint in the initial configuration.
    axis : array (3,)
        Its axis (third direction of both frames) in the initial configuration.
    first : array (3,)
        What the first direction of both frames is close to; chosen if not given.
    angle, stroke : bool
        Make the joint's angle (counting turns) or stroke a coordinate of the system.

    Examples
    --------
    A joint of your own, a pin on `b` in a plane slot of `a`, see :doc:`/howto/new_joint`:

    >>> import visviva as vv
    >>> class Slot(vv.Joint):
    ...     def constraints(self, A, B):
    ...         return [vv.dot(A.d1, B.p - A.p), vv.dot(A.d1, B.d3)]
    >>> ground, pin = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    >>> vv.System([ground, pin, Slot(a=ground, b=pin, at=(0, 0, 0))]).check().degrees_of_freedom
    4
    """

    outside_axes = NOWHERE

    a: Attached
    b: Attached
    at: Vector3 | None = None
    axis: Vector3 | None = None
    first: Vector3 | None = None
    angle: bool = False
    stroke: bool = False

    needs_frames = True
    needs_frame_b = True
    has_angle = False
    has_stroke = False

    def __post_init__(self) -> None:
        if self._component(self.a) is self._component(self.b):
            raise InputError(f"{self.label} joins {self._component(self.a).label} with itself")
        for wanted in ("angle", "stroke"):
            if getattr(self, wanted):
                self.refuse_without(wanted)

    @staticmethod
    def _component(side: Any) -> Attachable:
        component = side.component if isinstance(side, Point) else side
        if not isinstance(component, Attachable):
            raise InputError(f"a joint needs bodies, points or frames to join, not {side!r}")
        return component

    @property
    def partners(self) -> tuple[Attachable, Attachable]:
        """The two components that are joined."""
        return self._component(self.a), self._component(self.b)

    def _attach(self, side: Any) -> Point:
        framed = self.needs_frames and (side is self.a or self.needs_frame_b)
        if isinstance(side, Point):
            if framed and not isinstance(side, Frame):
                raise InputError(f"{self.label} needs frames; use {side.component.label}.frame(...)")
            return side
        if self.at is None:
            raise InputError(f"{self.label}: say where with at=(x, y, z), or give points or frames to join")
        if not framed:
            return side.point_at(self.at)  # type: ignore[no-any-return]
        axis = np.array([0.0, 0.0, 1.0]) if self.axis is None else self.axis
        return side.frame_at(self.at, axis, self.first)  # type: ignore[no-any-return]

    # --- what a joint defines ------------------------------------------------------------------------------
    def constraints(self, A: Side, B: Side) -> Sequence[Strain | Form]:
        """The constraints between the two sides."""
        raise NotImplementedError

    # --- part in the system --------------------------------------------------------------------------------
    def refuse_without(self, coordinate: str) -> None:
        """Refuse to be a joint that has no such coordinate."""
        if not getattr(self, f"has_{coordinate}"):
            raise InputError(f"{self.label}: a {type(self).__name__} joint has no {coordinate}")

    def usual_coordinate(self, coordinate: str | None) -> str:
        """The coordinate that is meant: the angle where the joint has one, unless said otherwise."""
        return coordinate or ("angle" if self.has_angle else "stroke")

    def declare(self, model: Model) -> None:
        self.sides = Side(self._attach(self.a)), Side(self._attach(self.b))
        self._coordinates: dict[str, Field] = {}
        asked = {asking.coordinate for asking in model.announced(self, Asking)}
        x, v = model.initial
        if self.angle or "angle" in asked:
            cosine, sine = angle_strains(*self.sides)
            angle = np.arctan2(sine.value(x), cosine.value(x))
            self._coordinates["angle"] = model.field(
                self, "angle", [angle], [self.rate("angle", x, v)], scale=1.0, stage=1
            )
        if self.stroke or "stroke" in asked:
            stroke = stroke_strain(*self.sides).value(x)
            self._coordinates["stroke"] = model.field(
                self, "stroke", [stroke], [self.rate("stroke", x, v)], scale=model.length_of(self), stage=1
            )

    def contribute(self, model: Model) -> None:
        self._strains = self._effective([strain(e) for e in self.constraints(*self.sides)], model.initial[0])
        n = len(self._strains)
        self._multipliers = model.multipliers(self, "reaction", n + len(self._coordinates), block=self)
        if n:
            model.constrain(self, self._multipliers, self._strains)
        k = n
        if "angle" in self._coordinates:
            ties = [*angle_strains(*self.sides), strain(self.coordinate("angle"))]
            model.constrain(self, self._multipliers, ties, first=k, law=Law(LawKind.ANGLE), n=1)
            k += 1
        if "stroke" in self._coordinates:
            tie = stroke_strain(*self.sides) - self.coordinate("stroke")
            model.constrain(self, self._multipliers, [tie], first=k)

    def _effective(self, strains: list[Strain], x: Array) -> list[Strain]:
        """The constraints that have unknowns: plane solids fulfil those across their plane by themselves."""
        kept = [e for e in strains if e.products or e.linear.weights]
        a, b = (c.label for c in self.partners)
        if any(abs(e.value(x)) > 1e-9 for e in strains if not (e.products or e.linear.weights)):
            raise InputError(
                f"{self.label} cannot join {a} and {b}, which stay in their planes: give both sides the same z, and "
                "an axis across the plane or in it"
            )
        if strains and not kept:
            raise InputError(
                f"{self.label} holds nothing: {a} and {b} stay in their planes anyway; leave it out"
            )
        return kept

    def coordinate(self, name: str | None = None) -> Form:
        """The joint's coordinate as a form; `name` where it has both an angle and a stroke."""
        refuse_uncomposed(self)
        if name is None:
            if len(self._coordinates) != 1:
                raise InputError(f"{self.label} has the coordinates {list(self._coordinates)}; say which")
            name = next(iter(self._coordinates))
        if name not in self._coordinates:
            raise InputError(
                f"{self.label} has no coordinate {name!r}: it has {list(self._coordinates)}; construct the joint "
                f"with {name}=True"
            )
        return self._coordinates[name].form()

    def measured(self, name: str) -> Strain:
        """A coordinate as a strain; the stroke is one of both sides where it is no coordinate of the system."""
        refuse_uncomposed(self)
        if name == "stroke" and name not in self._coordinates:
            return stroke_strain(*self.sides)
        return strain(self.coordinate(name))

    def rate(self, name: str, x: Array, v: Array) -> float:
        """Rate of the angle or stroke between both sides, be it a coordinate of the system or not."""
        return float(sum(slope * v[u] for u, slope in self._slope(name, x).items()))

    def generalised_reaction(self, x: Array) -> dict[int, float]:
        """Force of the joint on every unknown it touches, from the multipliers in `x`."""
        force: dict[int, float] = {}
        for k, e in enumerate(self._strains):
            lam = float(x[self._multipliers.start + k])
            for u, g in e.gradient(x).items():
                force[u] = force.get(u, 0.0) - lam * g
        for name in self._coordinates:
            for u, passed in self.passed_on(name, force, x).items():
                force[u] = force.get(u, 0.0) + passed
        for field in self._coordinates.values():
            force.pop(field.start, None)
        return force

    def action(self, x: Array) -> tuple[tuple[Attachable, Attachable], dict[int, float]]:
        """Two bodies and the force on every unknown by which they act on each other, as much as they react."""
        return self.partners, self.generalised_reaction(x)

    def passed_on(self, coordinate: str, force: Mapping[int, float], x: Array) -> dict[int, float]:
        """Forces on the unknowns of the bodies from that on a coordinate, which is massless."""
        passed = force.get(self._coordinates[coordinate].start, 0.0)
        return {u: passed * g for u, g in self._slope(coordinate, x).items()}

    def _slope(self, coordinate: str, x: Array) -> dict[int, float]:
        """Derivatives of a coordinate by the unknowns of the bodies."""
        if coordinate == "stroke":
            return stroke_strain(*self.sides).gradient(x)
        cosine, sine = angle_strains(*self.sides)
        c, s = cosine.value(x), sine.value(x)
        slope = {u: c * g / (c * c + s * s) for u, g in sine.gradient(x).items()}
        for u, g in cosine.gradient(x).items():
            slope[u] = slope.get(u, 0.0) - s * g / (c * c + s * s)
        return slope


def angle_strains(A: Side, B: Side) -> tuple[Strain, Strain]:
    """Cosine and sine of the angle of B's first director in A's plane of directors 1 and 2."""
    return dot(A.d1, B.d1), dot(A.d2, B.d1)


def stroke_strain(A: Side, B: Side) -> Strain:
    """Distance of B from A along A's third director."""
    return dot(A.d3, B.p - A.p)
