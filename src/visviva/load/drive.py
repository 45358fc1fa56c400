"""Drives on the coordinate of a joint: motor (prescribed motion), force or torque, spring, damper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime
from visviva.component.announcements import Asking
from visviva.component.component import Component, settings
from visviva.component.momentum import NOWHERE
from visviva.component.values import Number
from visviva.joint.joint import Joint
from visviva.model.form import Form
from visviva.model.law import quadratic, viscous

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State


@dataclass(config=settings, eq=False, kw_only=True)
class OnJoint(Component):
    """Base of what acts on the coordinate of a joint.

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke, which becomes a coordinate of the system.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both; by default the angle.
    """

    outside_axes = NOWHERE

    joint: Joint
    coordinate: Literal["angle", "stroke"] | None = None

    def __post_init__(self) -> None:
        self.joint.refuse_without(self.joint.usual_coordinate(self.coordinate))

    def announce(self, model: Model) -> None:
        model.announce(self.joint, Asking(self.joint.usual_coordinate(self.coordinate)))

    @property
    def form(self) -> Form:
        """The coordinate as a form."""
        return self.joint.coordinate(self.joint.usual_coordinate(self.coordinate))

    def not_negative(self, what: str) -> None:
        """Refuse a negative number."""
        if getattr(self, what) < 0:
            raise InputError(f"{self.label}: {what} {getattr(self, what):g} is negative")


@dataclass(config=settings, eq=False, kw_only=True)
class Motor(OnJoint):
    """Holds the coordinate of a joint at ``motion(t)``, whatever torque or force that takes: a position, no speed.

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke, which becomes a coordinate of the system.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both.
    motion : number, expression, table or callable
        The coordinate itself as a function of time, an angle in radians, see `TimeFunction`: ``"2*pi*t"`` is one turn
        per unit of time, a number holds it. At t = 0 it has to fit the bodies, which start with its rate.

    Notes
    -----
    `effort` is the torque or force that it exerts, `Power` the work per time of it; a given torque is a `JointForce`,
    and a given speed the integral of that over time.

    At the points of a table velocities jump with its slope, and the ledger books the work of that impulse;
    where the rate of an expression or a function jumps they swing about the new rate with energy-momentum and midpoint
    rules: round it off, e.g. with ``smoothstep``.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 2))
    >>> axle = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    >>> motor = vv.Motor(joint=axle, motion="t**2")
    >>> system = vv.System([ground, wheel, axle, motor])
    >>> _ = vv.simulate(system, until=1.0, step=0.01)
    >>> round(float(system.value(axle.coordinate())), 9), round(motor.effort(system), 6)
    (1.0, 4.0)
    """

    motion: OfTime

    def contribute(self, model: Model) -> None:
        self._multipliers = model.multipliers(self, "reaction", 1, stage=2)
        model.constrain(self, self._multipliers, [self.form], targets=[self.motion])

    def effort(self, state: State) -> float:
        """Torque (on an angle) or force (on a stroke) that the motor exerts, positive along the coordinate.

        It belongs to the present instant with every scheme. At a kink of the motion it leaves out the impulse there.
        """
        return -float(state.x_with_reactions[self._multipliers.start])


@dataclass(config=settings, eq=False, kw_only=True)
class JointForce(OnJoint):
    """Torque on an angle or force on a stroke, as a function of time; its work is booked as "joint force".

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke, which becomes a coordinate of the system.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both; by default the angle.
    force : number, expression, table or callable
        Torque about the axis or force along it, on `b` and its opposite on `a`, as a function of
        time, see `TimeFunction`.
    """

    force: OfTime

    def contribute(self, model: Model) -> None:
        model.load(self, "joint force", self.form, 1.0, self.force)


@dataclass(config=settings, eq=False, kw_only=True)
class JointSpring(OnJoint):
    """Linear spring on a coordinate: torque or force ``-stiffness (q - free)``.

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke, which becomes a coordinate of the system.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both; by default the angle.
    stiffness : float
        Torque per angle (rad), or force per length; not negative.
    free : float, optional
        Angle (rad) or stroke without torque or force; that of the start if not given.
    """

    stiffness: Number
    free: Number | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.not_negative("stiffness")

    def contribute(self, model: Model) -> None:
        free = self.form.value(model.initial[0]) if self.free is None else self.free
        model.potential(self, "spring", self.form, quadratic(self.stiffness, free))


@dataclass(config=settings, eq=False, kw_only=True)
class JointDamper(OnJoint):
    """Linear damper on a coordinate: torque or force ``-damping dq/dt``.

    Parameters
    ----------
    joint : Joint
        With an angle or a stroke, which becomes a coordinate of the system.
    coordinate : {'angle', 'stroke'}, optional
        Of a joint that has both; by default the angle.
    damping : float
        Torque per angular velocity, or force per velocity; not negative.
    """

    damping: Number

    def __post_init__(self) -> None:
        super().__post_init__()
        self.not_negative("damping")

    def contribute(self, model: Model) -> None:
        model.dissipate(self, "damper", self.form, viscous(self.damping))
