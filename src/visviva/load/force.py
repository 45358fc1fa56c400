"""Forces at points: dead, follower, or any function of time, position and velocity."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError, RunError, named
from visviva.base.timefunction import OfTime
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.point import Attached
from visviva.component.values import Vector3, VectorOrFunction
from visviva.component.where import frame_of, movable, point_of
from visviva.model.callback import rate_callback
from visviva.model.form import Vector, strain
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Force(Component):
    """Dead force at a point, or a force that is a function of the user.

    Parameters
    ----------
    on : component or Point
        What it acts on.
    at : array (3,)
        Where on the component, in the initial configuration; its own origin if not given.
    force : array (3,) or callable
        Force in space; or ``f(t, x, v) -> (3,)`` of time, position (3,) and velocity (3,) of the point, taken
        at the evaluation point of the scheme (the middle of the step for energy-momentum).
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    The ledger books ``force . dx`` as work "force", so the balance closes to round-off.
    A function needs no derivatives; it is called once per iteration, for about 30 microseconds each, which
    ``benchmarks/user_price.py`` measures.

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=2.0)
    >>> system = vv.System([ball, vv.Force(on=ball, force=(4, 0, 0), times="cos(t)")])
    >>> drag = lambda t, x, v: -0.5 * v
    >>> other = vv.PointMass(mass=2.0, velocity=(1, 0, 0))
    >>> system = vv.System([other, vv.Force(on=other, force=drag)])
    """

    on: Attached
    force: VectorOrFunction
    at: Vector3 | None = None
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return by_forces(axes_along(self.force))

    def __post_init__(self) -> None:
        point_of(self.label, self.on, self.at)
        if callable(self.force) and self.times is not None:
            raise InputError(f"{self.label}: a force that is a function has time in it; drop times")

    def contribute(self, model: Model) -> None:
        point = point_of(self.label, self.on, self.at)
        x = movable(self.label, point, point.position)
        if callable(self.force):
            add_user_force(model, self, "force", list(x), self.force)
        else:
            model.load(self, "force", x.along(self.force), 1.0, self.times)


@dataclass(config=settings, eq=False, kw_only=True)
class FollowerForce(Component):
    """Force with constant components in the directors of a frame: a thruster, a jet.

    Parameters
    ----------
    on : component or Frame
        What it acts on; for a component, its own directors carry the force.
    at : array (3,)
        Where on the component, in the initial configuration; its own origin if not given.
    force : array (3,)
        Components along the three directors.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Examples
    --------
    >>> import visviva as vv
    >>> rocket = vv.RigidBody(mass=2.0, inertia=(1, 1, 1))
    >>> system = vv.System([rocket, vv.FollowerForce(on=rocket, force=(0, 0, 10), times=[[0, 1], [3, 0]])])
    """

    on: Attached
    force: Vector3
    at: Vector3 | None = None
    times: OfTime | None = None

    def __post_init__(self) -> None:
        point_of(self.label, self.on, self.at)

    def contribute(self, model: Model) -> None:
        frame = frame_of(self.label, self.on, self.at)
        x = movable(self.label, frame, frame.position)
        force = carried(frame.directors, self.force)
        model.act(self, "force", [*x, *force], Law(LawKind.FOLLOWER), self.times)


def carried(directors: tuple[Vector, Vector, Vector], components: Any) -> Vector:
    """The vector with these components (3,) along the directors."""
    d1, d2, d3 = (float(c) * d for c, d in zip(components, directors, strict=True))
    return d1 + d2 + d3


def add_user_force(
    model: Model, owner: Component, kind: str, of: list[Any], force: Callable[..., Any]
) -> None:
    """Generalised forces ``force(t, e, de/dt)``, all (n_e,), conjugate to the strains or forms `of`."""
    f, n = guarded(owner.label, "force", force), len(of)

    def stress(t: float, e: Any, rate: Any) -> Any:
        S = np.empty_like(e)
        for k in range(e.shape[1]):
            value = np.asarray(f(t, e[:, k], rate[:, k]))
            if value.shape != (n,):
                raise RunError(f"{owner.label}: its force has shape {value.shape}, expected ({n},)")
            S[:, k] = -value
        return S

    label, sizes = f"{owner.label}, its force", model.sizes_of([strain(e) for e in of])
    model.act(owner, kind, of, Law(LawKind.RATE_CALLBACK, callback=rate_callback(stress, n, label, sizes)))


def guarded(label: str, what: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """The user's function; what it raises becomes an error of the component."""

    def call(*arguments: Any) -> Any:
        with named(f"{label}: its {what}"):
            return function(*arguments)

    return call
