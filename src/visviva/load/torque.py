"""Torques on bodies and frames, dead and follower, and pairs between two bodies.

A torque ``m`` acts on the three directors by forces ``f_i = t x d_i`` with ``(tr(D) I - D) t = m``,
``D = sum d_i d_i^T`` at the evaluation point, so that ``sum d_i x f_i = m`` exactly also where the directors
of the middle of a step are not orthonormal: angular momentum changes by ``h m`` to round-off.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.component.component import Component, settings
from visviva.component.momentum import ABOUT_ANY, NOWHERE, Axes, axes_along
from visviva.component.point import Attached, Frame
from visviva.component.values import Vector3
from visviva.component.where import frame_of, movable
from visviva.load.force import carried
from visviva.model.form import Form, Vector
from visviva.model.law import Law, LawKind

if TYPE_CHECKING:
    from visviva.model.model import Model


@dataclass(config=settings, eq=False, kw_only=True)
class Torque(Component):
    """Dead torque: constant in space, times a function of time.

    Parameters
    ----------
    on : component or Frame
        What it acts on; it must have directors.
    torque : array (3,)
        Torque in space.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    A torque constant in space has no potential; its work is booked in the ledger as "torque".

    Examples
    --------
    >>> import visviva as vv
    >>> top = vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    >>> system = vv.System([top, vv.Torque(on=top, torque=(0, 0, 4))])
    >>> result = vv.simulate(system, until=1.0, step=0.1)
    >>> round(float(result.ledger["angular_z"][-1]), 12)
    4.0
    """

    on: Attached
    torque: Vector3
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return "", axes_along(self.torque)

    def contribute(self, model: Model) -> None:
        act(model, self, frame_of(self.label, self.on), Vector.constant(self.torque), self.times)


@dataclass(config=settings, eq=False, kw_only=True)
class FollowerTorque(Component):
    """Torque with constant components in the directors of what it acts on, times a function of time.

    Parameters
    ----------
    on : component or Frame
        What it acts on; it must have directors.
    torque : array (3,)
        Components along the directors.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    It has no potential; its work is booked in the ledger as "torque".
    """

    on: Attached
    torque: Vector3
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return ABOUT_ANY

    def contribute(self, model: Model) -> None:
        frame = frame_of(self.label, self.on)
        act(model, self, frame, carried(frame.directors, self.torque), self.times)


@dataclass(config=settings, eq=False, kw_only=True)
class SemitangentialTorque(Component):
    """Torque by dead forces on a cross that turns along: half of it stays in space, half turns with the frame.

    Parameters
    ----------
    on : component or Frame
        What it acts on; it must have directors.
    torque : array (3,)
        Torque in space at the start.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.

    Notes
    -----
    Forces along the initial directors E act on the directors d by the potential ``-M_i (d_j . E_k - d_k . E_j) / 2``,
    with i, j, k cyclic, the components ``M_i`` of the torque along E (Ziegler 1968). For a turn about its own axis by
    an angle it is ``M cos(angle)``. As it has a potential, tangents are symmetric and stability is told.

    Examples
    --------
    >>> import visviva as vv
    >>> body = vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    >>> system = vv.System([body, vv.SemitangentialTorque(on=body, torque=(0, 0, 4))])
    >>> _ = vv.simulate(system, until=0.1, step=0.01)
    """

    on: Attached
    torque: Vector3
    times: OfTime | None = None

    @property
    def outside_axes(self) -> Axes:
        return ABOUT_ANY

    def contribute(self, model: Model) -> None:
        d = frame_of(self.label, self.on).directors
        x, _ = model.initial
        E = [director.value(x) for director in d]
        total = Form()
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            share = 0.5 * float(self.torque @ E[i])
            total = total + share * (d[j].along(E[k]) - d[k].along(E[j]))
        if not total.weights:
            raise InputError(f"{self.label}: torque = {self.torque.tolist()} acts on nothing that moves")
        model.load(self, "torque", total, 1.0, self.times)


@dataclass(config=settings, eq=False, kw_only=True)
class TorquePair(Component):
    """Internal torque: `torque` on `b` and its opposite on `a`, which conserves angular momentum exactly.

    Parameters
    ----------
    a, b : component or Frame
        The two bodies.
    torque : array (3,)
        Torque on `b`; components in the directors of `carrier` if given, else in space.
    carrier : component or Frame
        Whose directors turn the torque along, for instance `a`.
    times : number, expression, table or callable
        Factor as a function of time, see `TimeFunction`.
    """

    outside_axes = NOWHERE

    a: Attached
    b: Attached
    torque: Vector3
    carrier: Any = None
    times: OfTime | None = None

    def contribute(self, model: Model) -> None:
        a, b = frame_of(self.label, self.a), frame_of(self.label, self.b)
        if a.component is b.component:
            raise InputError(f"{self.label} acts between {a.component.label} and itself")
        m = Vector.constant(self.torque)
        if self.carrier is not None:
            m = carried(frame_of(self.label, self.carrier).directors, self.torque)
        act(model, self, b, m, self.times)
        act(model, self, a, -1.0 * m, self.times)


def act(model: Model, owner: Component, frame: Frame, torque: Vector, times: Any) -> None:
    """Add a torque on the directors of a frame."""
    d1, d2, d3 = frame.directors
    movable(owner.label, frame, d1 + d2 + d3)
    model.act(owner, "torque", [*d1, *d2, *d3, *torque], Law(LawKind.TORQUE), times)
