"""Measures: what user components and servo constraints look at, quadratic functions of the unknowns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.arguments import Validated
from visviva.base.errors import InputError
from visviva.component.announcements import Asking
from visviva.component.component import COMPOSITION, Component, mentioned, settings, system_of
from visviva.component.values import Vector3
from visviva.component.where import frame_of, point_of
from visviva.joint.joint import Joint
from visviva.model.form import Strain, Vector, dot, refuse_foreign, squared, strain

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.system.system import System

Director = Literal[1, 2, 3]


def remembers(system: System) -> bool:
    """True if materials or terms have histories, which stored states do not contain."""
    return bool(system.core.histories().size) or any(term.history for term, _ in system.model.terms)


def touches(system: System) -> bool:
    """True if there is contact: its forces belong to a step, not to a state."""
    return any(c.touches or c.rubs for c in system.components)


def refuse_elsewhere(probe: Any, system: System) -> None:
    """Refuse what reads a component of another system: its unknowns have the numbers of others here."""
    for c in mentioned(probe):
        if not c.is_fixed and system_of(c) is not system:
            elsewhere = " but in another; components of a copy are found by name, copy['name']"
            where = "" if system_of(c) is None else elsewhere
            raise InputError(f"{type(probe).__name__}: {c.label} is not in this system{where}")


def of_its_system(read: Callable[[Any, System], Any]) -> Callable[[Any, System], Any]:
    """The reading of a probe, after a look whether its components are in the system."""

    @wraps(read)
    def looked(self: Any, system: System) -> Any:
        refuse_elsewhere(self, system)
        return read(self, system)

    return looked


class Reading(metaclass=Validated):
    """Base of probes: a value read off the system that its components are in."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__call__" in vars(cls):
            cls.__call__ = of_its_system(cls.__call__)  # type: ignore[assignment, method-assign]

    @property
    def quantity(self) -> str:
        """Quantity, as `visviva.base.unit_labels` names it; nothing if it has no unit or none is known."""
        return ""

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of its components, where they are not x, y, z of vectors or numbers."""
        return ()

    def told_by_state(self, system: System) -> bool:
        """True if a stored state (unknowns, rates, time) tells it; others are recorded during the run."""
        return not remembers(system)

    def __call__(self, system: System) -> Any:
        """Present value, a number or an array (n,)."""
        raise NotImplementedError


class Measure(Reading):
    """Base: something with `strains`, numbers that are at most quadratic in the unknowns; also a probe."""

    def __call__(self, system: System) -> Any:
        """Present value, a number or an array (n,)."""
        values = [system.value(e) for e in self.strains()]
        return values[0] if len(values) == 1 else np.array(values)

    def announce(self, model: Model) -> None:
        """Announce for a component that it acts on this measure."""

    def strains(self) -> list[Strain]:
        """The strains, available once the components have been put into a system."""
        raise NotImplementedError


@dataclass(config=settings, frozen=True, kw_only=True)
class Position(Measure):
    """Coordinates (3,) of a point (length), or one coordinate along a direction.

    Parameters
    ----------
    of : component or Point
    at : array (3,), optional
        Place of the point at the start (length), if `of` is a component; by default its origin.
    direction : array (3,), optional
        Take the component along it alone, times its length.
    """

    of: Any
    at: Vector3 | None = None
    direction: Vector3 | None = None

    @property
    def quantity(self) -> str:
        return "length"

    @property
    def place(self) -> Vector:
        """The point."""
        return point_of("Position", self.of, self.at).position

    def strains(self) -> list[Strain]:
        x = self.place
        return [strain(c) for c in x] if self.direction is None else [strain(x.along(self.direction))]


@dataclass(config=settings, frozen=True, kw_only=True)
class SquaredDistance(Measure):
    """Squared distance of two points (length squared).

    Parameters
    ----------
    a, b : component or Point
        Of a component its origin.
    """

    a: Any
    b: Any

    @property
    def quantity(self) -> str:
        return "area"

    def strains(self) -> list[Strain]:
        a, b = (point_of("SquaredDistance", p).position for p in (self.a, self.b))
        return [squared(b - a)]


@dataclass(config=settings, frozen=True, kw_only=True)
class DirectorProduct(Measure):
    """Product of director `i` of frame `a` with director `j` of frame `b`: the cosine between them.

    Parameters
    ----------
    a, b : component or Frame
        With directors.
    i, j : {1, 2, 3}
        Which director of `a`, and which of `b`.
    """

    a: Any
    b: Any
    i: Director = 3
    j: Director = 3

    def strains(self) -> list[Strain]:
        a, b = (frame_of("DirectorProduct", f).directors for f in (self.a, self.b))
        return [dot(a[self.i - 1], b[self.j - 1])]


@dataclass(config=settings, frozen=True, kw_only=True)
class Offset(Measure):
    """Distance of the point `to` from the frame `a` along its director `i` (length), with its sign.

    Parameters
    ----------
    a : component or Frame
        Whose director and origin count.
    to : component or Point
        Of a component its origin.
    i : {1, 2, 3}
        Which director of `a`.
    """

    a: Any
    to: Any
    i: Director = 3

    @property
    def quantity(self) -> str:
        return "length"

    def strains(self) -> list[Strain]:
        frame, point = frame_of("Offset", self.a), point_of("Offset", self.to)
        return [dot(frame.directors[self.i - 1], point.position - frame.position)]


@dataclass(config=settings, frozen=True, kw_only=True)
class Direction(Measure):
    """Direction (3,) in space of an axis that goes with a body, given in its own coordinates.

    Parameters
    ----------
    of : component or Frame
        With directors.
    axis : array (3,)
        Components along the directors; its length is kept.
    """

    of: Any
    axis: Vector3

    def strains(self) -> list[Strain]:
        d1, d2, d3 = frame_of("Direction", self.of).directors
        x, y, z = self.axis.tolist()
        return [strain(component) for component in x * d1 + y * d2 + z * d3]


@dataclass(config=settings, frozen=True, kw_only=True)
class Separation(Reading):
    """Probe: distance of two points (length), such as the length of a rope.

    Parameters
    ----------
    a, b : component or Point
        Of a component its origin.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(3, 4, 0))
    >>> vv.Separation(a=ground, b=ball)(vv.System([ground, ball]))
    5.0
    """

    a: Any
    b: Any

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "length"

    def __call__(self, system: System) -> float:
        a, b = (point_of("Separation", p).position.value(system.x) for p in (self.a, self.b))
        return float(np.linalg.norm(b - a))


@dataclass(config=settings, frozen=True, kw_only=True)
class CentreOfMass(Reading):
    """Probe: centre of mass (3,), in space (length), of a component, or of several together.

    Parameters
    ----------
    of : component, or list of components
        With mass in all.

    Raises
    ------
    InputError
        When it is read: if they have no mass.

    Examples
    --------
    >>> import visviva as vv
    >>> a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=3.0, position=(4, 0, 0))
    >>> vv.CentreOfMass(of=[a, b])(vv.System([a, b])).tolist()
    [3.0, 0.0, 0.0]
    """

    of: Component | list[Component]

    def told_by_state(self, system: System) -> bool:
        return True

    @property
    def quantity(self) -> str:
        return "length"

    def __call__(self, system: System) -> Any:
        parts = self.of if isinstance(self.of, list | tuple) else [self.of]
        mass = sum(c.total_mass for c in parts)
        if mass == 0:
            raise InputError(f"CentreOfMass: {', '.join(c.label for c in parts)} has no mass")
        return np.sum([c.mass_moment(system.x) for c in parts], axis=0) / mass


@dataclass(config=settings, frozen=True, kw_only=True)
class JointCoordinate(Measure):
    """Angle (rad) or stroke (length) of a joint.

    It becomes a coordinate of the system for components that act on it. An angle, which counts turns, is read where it
    is a coordinate: by `angle` of the joint, or for a drive or another component. A stroke is read of all joints that
    have one.

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both; by default the angle.

    Raises
    ------
    InputError
        If the joint has no such coordinate; when it is read, for an angle that is no coordinate of the system.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, arm = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), angular_velocity=(0, 0, 5))
    >>> hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), angle=True)
    >>> result = vv.simulate(vv.System([ground, arm, hinge]), until=2.0, step=0.01)
    >>> float(result.history(vv.JointCoordinate(joint=hinge))[-1].round(2))
    10.0
    """

    joint: Joint
    coordinate: Literal["angle", "stroke"] | None = None

    @property
    def quantity(self) -> str:
        return "angle" if self.name == "angle" else "length"

    def __post_init__(self) -> None:
        self.joint.refuse_without(self.name)

    @property
    def name(self) -> str:
        """Chosen coordinate: the angle where the joint has one, unless said otherwise."""
        return self.joint.usual_coordinate(self.coordinate)

    def announce(self, model: Model) -> None:
        model.announce(self.joint, Asking(self.name))

    def strains(self) -> list[Strain]:
        return [self.joint.measured(self.name)]


@dataclass(config=settings, frozen=True)
class Custom(Measure):
    """Measures returned by a function without arguments: forms or strains, built when the system is."""

    function: Callable[[], Any]

    def strains(self) -> list[Strain]:
        made = self.function()
        return [strain(e) for e in (made if isinstance(made, Sequence) else [made])]


def measure_of(label: str, what: Any) -> Measure:
    """A measure from itself, a joint (its coordinate), a component or point (its three), or a function."""
    if isinstance(what, Measure):
        return what
    if isinstance(what, Joint):
        return JointCoordinate(joint=what)
    if callable(what):
        return Custom(what)
    point_of(label, what)
    return Position(of=what)


def measures_of(label: str, of: Sequence[Any]) -> list[Measure]:
    """One measure for each entry; at least one."""
    if not isinstance(of, list | tuple) or not of:
        raise InputError(
            f"{label} needs a list of measures: points, joints, or e.g. vv.SquaredDistance(a=..., b=...)"
        )
    return [measure_of(label, what) for what in of]


def strains_of(whose: Component, measures: Sequence[Measure]) -> list[Strain]:
    """All their strains, in order, for a component that is being composed; those of other systems are refused."""
    found = [e for m in measures for e in m.strains()]
    for e in found:
        refuse_foreign(whose.label, e, vars(whose)[COMPOSITION])
    return found
