"""Actions on a system from outside, for which its momenta are not meant to be conserved."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

from visviva.component.component import Component
from visviva.component.meshed import Meshed
from visviva.component.point import Attachable, Point
from visviva.contact.obstacle import Obstacle, Plane
from visviva.flow.fluid import Fluid
from visviva.joint.joint import Joint

if TYPE_CHECKING:
    from visviva.system.system import System


def outside(system: System) -> list[Component]:
    """Components that exchange momentum with what is in no system: given loads, weight, supports, the ground.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball, other = vv.Ground(), *(vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (1, 2))
    >>> free = vv.Spring(a=ball, b=other, stiffness=1.0, name="free")
    >>> held = vv.Spring(a=ground, b=ball, stiffness=1.0, name="held")
    >>> [c.name for c in outside(vv.System([ground, ball, other, free, held, vv.Gravity(name="weight")]))]
    ['held', 'weight']
    """
    return [c for c in system.components if is_outside(c)]


def is_outside(component: Component) -> bool:
    """Whether a component itself acts from outside."""
    if component.is_fixed or isinstance(component, Plane | Obstacle):
        return False  # acts by what attaches to it
    if isinstance(component, Fluid):
        return not component.periodic  # what flows through a boundary takes its momentum along
    if isinstance(component, Attachable | Meshed):
        return False
    return not component.acts_between or any(map(is_ground, partners(component)))


def partners(component: Component) -> Iterator[Any]:
    """Components that a component refers to."""
    for f in fields(component) if is_dataclass(component) else ():
        value = getattr(component, f.name)
        yield from value if isinstance(value, list | tuple) else (value,)


def is_ground(value: Any) -> bool:
    """Whether a reference is to the ground, or to what is held by it."""
    if isinstance(value, Point):
        return value.component.is_fixed
    if isinstance(value, Plane | Obstacle):
        return value.on is None or value.on.is_fixed
    return isinstance(value, Component) and (
        value.is_fixed or (isinstance(value, Joint) and is_outside(value))
    )
