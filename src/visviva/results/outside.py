"""Who acts on whom: from outside of a system, for which its momenta are not meant to be conserved, and within it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.component.component import Component
from visviva.component.momentum import EVERYWHERE, Axes
from visviva.component.point import Point
from visviva.contact.obstacle import Obstacle, Plane
from visviva.joint.joint import Joint

if TYPE_CHECKING:
    from visviva.model.field import Owner
    from visviva.model.model import Model
    from visviva.system.system import System


def outside(system: System) -> list[tuple[Component, Axes]]:
    """Components that exchange momentum with what is in no system, and along and about which axes.

    These are given loads, weight, supports, the ground.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball, other = vv.Ground(), *(vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (1, 2))
    >>> free = vv.Spring(a=ball, b=other, stiffness=1.0, name="free")
    >>> held = vv.Spring(a=ground, b=ball, stiffness=1.0, name="held")
    >>> [(c.name, *axes) for c, axes in outside(vv.System([ground, ball, other, free, held, vv.Gravity()]))]
    [('held', 'xyz', 'xyz'), ('gravity', 'z', 'xy')]
    """
    acting = ((c, outside_axes(c)) for c in system.components)
    return [(c, axes) for c, axes in acting if any(axes)]


def outside_axes(component: Component) -> Axes:
    """Axes of a component itself, all of them if it acts between others one of which is the ground."""
    if isinstance(component, Plane | Obstacle):
        return component.outside_axes  # what it moves with acts by what attaches to it
    return EVERYWHERE if any(map(is_ground, partners(component))) else component.outside_axes


def partners(component: Any) -> Iterator[Any]:
    """Components that a component refers to, and whatever else it is made of."""
    for f in fields(component) if is_dataclass(component) else ():
        value = getattr(component, f.name)
        yield from value if isinstance(value, list | tuple) else (value,)


def hanging_together(model: Model, some: Iterable[Owner]) -> set[int]:
    """Numbers of components with those that refer to them or are referred to, in turn; across the ground goes nothing.

    With these are those that do not tell whom they act on, such as forces on functions of the user.

    Examples
    --------
    >>> import visviva as vv
    >>> a, b, c = (vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (1, 2, 3))
    >>> spring, push = vv.Spring(a=a, b=b, stiffness=1.0), vv.Force(on=c, force=(1, 0, 0))
    >>> hanging_together(vv.System([a, b, c, spring, push]).model, [b])
    {0, 1, 3}
    """
    if not (found := set(map(model.index, some))):
        return found
    rest, near = list(found), neighbours(model)
    found |= untold(model)
    while rest:
        new = near[rest.pop()] - found
        found |= new
        rest += new
    return found


def groups(model: Model) -> NDArray[np.int64]:
    """Of each component the number of the first that it hangs together with; across the ground goes nothing.

    Examples
    --------
    >>> import visviva as vv
    >>> a, b, c = (vv.PointMass(mass=1.0, position=(x, 0, 0)) for x in (1, 2, 3))
    >>> spring, push = vv.Spring(a=a, b=b, stiffness=1.0), vv.Force(on=c, force=(1, 0, 0))
    >>> groups(vv.System([a, b, c, spring, push]).model).tolist()
    [0, 0, 2, 0, 2]
    """
    near, found = neighbours(model), np.full(len(model.components), -1)
    for k in range(len(near)):
        rest = [k] if found[k] < 0 else []
        while rest:
            if found[one := rest.pop()] < 0:
                found[one] = k
                rest += near[one]
    return found


def neighbours(model: Model) -> list[set[int]]:
    """Of each component the numbers of those that it refers to, or that refer to it."""
    near = others_of(model)
    for k, others in enumerate([set(those) for those in near]):
        for other in others:
            near[other].add(k)
    return near


def untold(model: Model) -> set[int]:
    """Numbers of components that neither have unknowns nor tell whom they act on."""
    owners = {model.index(f.component) for f in model.fields}
    return {k for k, others in enumerate(others_of(model)) if not others and k not in owners}


def others_of(model: Model) -> list[set[int]]:
    """Of each component the numbers of those that it refers to."""
    numbers = {c: k for k, c in enumerate(model.components)}
    return [{numbers[c] for c in referred(component) if c in numbers} for component in model.components]


def referred(value: Any) -> Iterator[Any]:
    """Components with unknowns that a component refers to, also by points and measures."""
    for partner in partners(value):
        if isinstance(partner, Component):
            yield from () if partner.is_fixed else (partner,)
        elif is_dataclass(partner):
            yield from referred(partner)


def is_ground(value: Any) -> bool:
    """Whether a reference is to the ground, or to what is held by it."""
    if isinstance(value, Point):
        return value.component.is_fixed
    if isinstance(value, Plane | Obstacle):
        return value.on is None or value.on.is_fixed
    return isinstance(value, Component) and (
        value.is_fixed or (isinstance(value, Joint) and any(outside_axes(value)))
    )
