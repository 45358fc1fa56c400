"""Springs and dampers between points, linear or by a law of the user."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.point import Attached
from visviva.component.values import Function, Number, Vector3
from visviva.component.where import point_of
from visviva.load.force import guarded
from visviva.model.callback import energy_callback, rate_callback
from visviva.model.form import Strain, Vector, squared
from visviva.model.law import Law, LawKind, length, linear, viscous_length

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Spring(Component):
    """Spring and damper between two points.

    Parameters
    ----------
    a, b : component or Point
        What it connects; `at_a`, `at_b` say where on a component, its own origin if not given.
    stiffness, damping : float
        Tension ``stiffness (l - free_length) + damping dl/dt``; not negative.
    free_length : float
        Length without force; the initial length if not given. With 0, and a stiffness alone, the points may coincide.
    energy : callable
        Instead of a stiffness, the stored energy ``W(l)`` as a function of the length, elementwise on arrays.
        Tension and discrete gradient follow from it: energy is conserved to round-off.
    force : callable
        A law ``f(l, dl/dt)`` of the tension, elementwise on arrays, added to the rest; booked as work.
    at_a, at_b : array (3,), optional
        Places at the start (length) on components `a` and `b`.

    Notes
    -----
    The strain is the squared length, so momentum and angular momentum are conserved exactly.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.1, 0, 0))
    >>> spring = vv.Spring(a=ground, b=ball, energy=lambda l: 50 * (l - 1) ** 2 + 3 * (l - 1) ** 4)
    >>> result = vv.simulate(vv.System([ground, ball, spring]), until=1.0, step=0.01)
    >>> result.assert_conserved("energy", tolerance=1e-9)
    """

    outside_axes = NOWHERE

    a: Attached
    b: Attached
    stiffness: Number = 0.0
    damping: Number = 0.0
    free_length: Number | None = None
    energy: Function | None = None
    force: Function | None = None
    at_a: Vector3 | None = None
    at_b: Vector3 | None = None

    def __post_init__(self) -> None:
        A, B = self.points()
        if A is B:
            raise InputError(f"{self.label} connects a point of {A.component.label} with itself")
        for what in ("stiffness", "damping"):
            if getattr(self, what) < 0:
                raise InputError(f"{self.label}: {what} {getattr(self, what):g} is negative")
        if self.free_length is not None and self.free_length < 0:
            raise InputError(
                f"{self.label}: free_length {self.free_length:g} is negative, but no distance is; give the pull that "
                "is meant as a law of your own, force=lambda l, rate: ..."
            )
        if self.energy is not None and (self.stiffness or self.free_length is not None):
            raise InputError(
                f"{self.label}: energy replaces stiffness and free_length; give one or the other"
            )
        if not (self.stiffness or self.damping or self.energy or self.force):
            raise InputError(f"{self.label} does nothing; give it a stiffness, damping, energy or force")

    def points(self) -> tuple[Any, Any]:
        """The two points it connects."""
        return point_of(self.label, self.a, self.at_a), point_of(self.label, self.b, self.at_b)

    def lines(self) -> list[tuple[Vector, Vector]]:
        A, B = self.points()
        return [(A.position, B.position)]

    def contribute(self, model: Model) -> None:
        A, B = self.points()
        e = squared(B.position - A.position)
        l0 = float(np.sqrt(e.value(model.initial[0])))
        free = l0 if self.free_length is None else self.free_length
        pulls_alone = self.free_length == 0 and not (self.damping or self.energy or self.force)
        if l0 == 0 and not pulls_alone:
            raise InputError(
                f"{self.label}: its two points coincide initially, so it has no direction; move them apart, take a "
                "Bushing, or free_length=0 and a stiffness alone, which needs none"
            )
        if self.stiffness:  # without a length of its own it pulls in proportion to the way, in any direction
            law = length(self.stiffness, free) if free else linear(0.5 * self.stiffness)
            model.potential(self, "spring", e, law)
        if self.damping:
            model.dissipate(self, "damper", e, viscous_length(self.damping))
        self._user_laws(model, e)

    def _user_laws(self, model: Model, e: Strain) -> None:
        sizes = model.sizes_of([e])
        if self.energy is not None:
            W = guarded(self.label, "energy", self.energy)
            call = energy_callback(lambda e: W(np.sqrt(e[0])), 1, f"{self.label}, its energy", sizes)
            model.potential(self, "spring", e, Law(LawKind.ENERGY_CALLBACK, callback=call))
        if self.force is not None:
            f = guarded(self.label, "force", self.force)

            def stress(t: float, e: Any, rate: Any) -> Any:
                l = np.sqrt(e)
                return f(l, rate / (2 * l)) / (2 * l)

            call = rate_callback(stress, 1, f"{self.label}, its force", sizes)
            model.act(self, "spring force", e, Law(LawKind.RATE_CALLBACK, callback=call))


@dataclass(config=settings, eq=False, kw_only=True)
class Damper(Spring):
    """Damper between two points: tension ``damping dl/dt``, or a law ``force = f(l, dl/dt)`` of the user.

    Parameters
    ----------
    a, b : component or Point
        What it connects; `at_a`, `at_b` say where on a component, its own origin if not given.
    damping : float
        Force per velocity; not negative.
    force : callable
        A law ``f(l, dl/dt)`` of the tension, elementwise on arrays; booked as work.
    stiffness, free_length, energy
        See `Spring`: one that has them stores energy as well.
    at_a, at_b : array (3,), optional
        Places at the start (length) on components `a` and `b`.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(1, 0, 0))
    >>> damper = vv.Damper(a=ground, b=ball, force=lambda l, rate: 0.2 * rate * abs(rate))
    >>> system = vv.System([ground, ball, damper])
    """

    outside_axes = NOWHERE
