"""Places where loads act: a component, a Point or Frame of it, or a component and the place `at`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from visviva.base.errors import InputError
from visviva.component.point import Attachable, Frame, Point

if TYPE_CHECKING:
    from visviva.model.form import Vector

POSSIBLE = "give a component, component.point(...) or component.frame(...)"


def point_of(label: str, on: Any, at: Any = None) -> Point:
    """The point `on`, or the point of the component `on` that is at `at` initially (by default its origin).

    Raises
    ------
    InputError
        If `on` is not something to attach to, or both a point and a place are given.
    """
    if isinstance(on, Point):
        if at is not None:
            raise InputError(f"{label}: both a point of {on.component.label} and a place are given; drop one")
        return on
    if not isinstance(on, Attachable):
        raise InputError(f"{label} acts on bodies and their points, not on {on!r}; {POSSIBLE}")
    return on.point() if at is None else on.point_at(at)


def frame_of(label: str, on: Any, at: Any = None) -> Frame:
    """The frame `on`, or the component's own directors at the same place as `point_of`."""
    if isinstance(on, Frame):
        return on
    point = point_of(label, on, at)
    return point.component.frame(point.X)


def movable(label: str, point: Point, forms: Vector) -> Vector:
    """The same forms, unless they have no unknowns: then the load would act on nothing."""
    if not any(form.weights for form in forms):
        raise InputError(f"{label} acts on {point.component.label}, which does not move; attach it to a body")
    return forms
