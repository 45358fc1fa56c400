"""Couplings between the coordinates of joints: rope over a winch, gear, rack and pinion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import refuse_unless
from visviva.base.errors import InputError
from visviva.component.announcements import Asking
from visviva.component.component import settings, system_of
from visviva.component.limited import Limited
from visviva.component.point import Attachable
from visviva.component.values import Number
from visviva.joint.joint import Joint, Side
from visviva.model.form import Form, Strain, Vector, product, squared

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Constraints = Sequence[Strain | Form]
ROUNDING = 1e-10
"""Part of the forces that rounding makes of positions, and of all reactions, that no tension is told from."""


@dataclass(config=settings, eq=False, kw_only=True)
class RopeOverWinch(Joint, Limited):
    """Inextensible massless rope from `a` to `b`, paid out by a winch: ``|p| = length + radius angle``.

    `winch` is the revolute joint whose angle counts; the rope leaves at the point `a`. Written quadratically,
    ``(|p|^2 - (length + radius angle)^2) / (2 length)``, so that its multiplier is about the rope's tension.
    The rope is always taut, and never pushes: steps in which it would, where a real one goes slack, fail by its name. A
    rope that can go slack is a `Beam` of little bending stiffness, or a `Spring` whose `energy` is zero below the
    rope's length.

    Parameters
    ----------
    a, b : Point, or component
        Where the rope leaves the winch, and where it ends; a component, one of the two at most, by the point of it
        that is at `at`.
    at : array (3,)
        Place at the start (length) of the point of a component.
    winch : Joint
        With an angle, whose growth pays out the rope.
    radius : float
        Of the winch, rope per angle (length); positive.
    length : float
        Of the rope between both points where the angle is zero; positive.

    Raises
    ------
    StepFailure
        By a run, at the step in which the tension turns negative.

    Examples
    --------
    A drum that is turned faster than its load can fall, from the torque ``g J / r = 9.81`` on:

    >>> import visviva as vv
    >>> ground, drum = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    >>> load = vv.PointMass(mass=5.0, position=(0, 0, -2))
    >>> axle = vv.Revolute(a=ground, b=drum, at=(0, 0, 0), axis=(0, 1, 0))
    >>> rope = vv.RopeOverWinch(a=drum.point(), b=load.point(), winch=axle, radius=1.0, length=2.0, name="rope")
    >>> turn = vv.JointForce(joint=axle, force="10*t")
    >>> hoist = vv.System([ground, drum, load, axle, rope, turn, vv.Gravity()])
    >>> try:
    ...     vv.simulate(hoist, until=2.0, step=0.01)
    ... except vv.StepFailure as error:
    ...     print("RopeOverWinch 'rope' pushes" in str(error), round(error.time, 2))
    True 0.98
    """

    winch: Joint
    radius: Number
    length: Number
    needs_frames = False

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_unless(self.length > 0, self, "length", "positive")
        refuse_unless(
            self.radius > 0, self, "radius", "positive; to pay out the other way turn the winch's axis"
        )
        self.winch.refuse_without("angle")

    def announce(self, model: Model) -> None:
        model.announce(self.winch, Asking("angle"))

    def invalid(self, x: Array) -> str:
        tension = float(x[self._multipliers.start])
        if tension >= 0.0 or tension >= -self._rounding(x):
            return ""
        return (
            f"{self.label} pushes by {-tension:.3g} where a rope goes slack; one that can is a vv.Beam of little "
            "bending stiffness, or a vv.Spring whose energy is zero below its length"
        )

    def _rounding(self, x: Array) -> float:
        """Tension that rounding makes, of positions in a step and of what other reactions leave."""
        system = system_of(self)
        mass, step = sum(c.total_mass for c in self.partners), system.clock.step
        by_place = mass * self.length / step**2 if system.has_inertia and step else 0.0
        return ROUNDING * (by_place + float(np.abs(x[system.is_lasting_constraint]).max()))

    def constraints(self, A: Side, B: Side) -> Constraints:
        L = self.radius * self.winch.coordinate("angle") + self.length
        return [1 / (2 * self.length) * (squared(B.p - A.p) - product(L, L))]

    def lines(self) -> list[tuple[Vector, Vector]]:
        return [(self.sides[0].p, self.sides[1].p)]


@dataclass(config=settings, eq=False, kw_only=True)
class _Coupling(Joint):
    """One linear relation between two joint coordinates that keeps its initial value."""

    a: Joint  # type: ignore[assignment]
    b: Joint  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.a is self.b:
            raise InputError(f"{self.label} couples {self.a.label} with itself")
        for joint, coordinate in self.coupled():
            joint.refuse_without(coordinate)

    def coupled(self) -> tuple[tuple[Joint, str], tuple[Joint, str]]:
        """Both joints with the coordinate of each."""
        raise NotImplementedError

    def announce(self, model: Model) -> None:
        for joint, coordinate in self.coupled():
            model.announce(joint, Asking(coordinate))

    def relation(self) -> Form:
        raise NotImplementedError

    @property
    def partners(self) -> tuple[Attachable, Attachable]:
        """The bodies on the sides b of both joints."""
        return self.a.partners[1], self.b.partners[1]

    def declare(self, model: Model) -> None:
        self._coordinates = {}

    def contribute(self, model: Model) -> None:
        self.sides = self.a.sides[1], self.b.sides[1]
        form = self.relation()
        self._strains = [Strain((), form - form.value(model.initial[0]))]
        self._multipliers = model.multipliers(self, "reaction", 1, stage=2, block=self)
        model.constrain(self, self._multipliers, self._strains)

    def generalised_reaction(self, x: Array) -> dict[int, float]:
        """Force of the teeth on every unknown of bodies, which coordinates pass on."""
        force: dict[int, float] = {}
        for joint, coordinate in self.coupled():
            for u, passed in joint.passed_on(coordinate, super().generalised_reaction(x), x).items():
                force[u] = force.get(u, 0.0) + passed
        return force

    def action(self, x: Array) -> tuple[tuple[Attachable, Attachable], dict[int, float]]:
        """Of the joint `b` alone: the teeth need not push both wheels by as much."""
        joint, coordinate = self.coupled()[1]
        return joint.partners, joint.passed_on(coordinate, super().generalised_reaction(x), x)


@dataclass(config=settings, eq=False, kw_only=True)
class Gear(_Coupling):
    """Angle of joint `a` plus `ratio` times the angle of joint `b` stays constant (1 constraint).

    `ReactionTorque` is the torque of the teeth on the body at the side `b` of joint `b`; divided by the pitch radius of
    that wheel it is the load of the teeth. Only angles are coupled, so that bearings do not feel it.

    Parameters
    ----------
    a, b : Joint
        Two joints with angles, which become coordinates of the system.
    ratio : float
        Of the angle of `a` to that of `b`, with the opposite sign; not zero. Wheels that mesh outside have the ratio of
        their radii, b to a, one inside the other its negative.

    Examples
    --------
    A wheel of pitch radius 0.2 drives one of 0.3, which a brake holds:

    >>> import visviva as vv
    >>> ground, wheels = vv.Ground(), [vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(x, 0, 0)) for x in (0, 0.5)]
    >>> axles = [vv.Revolute(a=ground, b=w, at=w.position, axis=(0, 0, 1)) for w in wheels]
    >>> gear = vv.Gear(a=axles[0], b=axles[1], ratio=0.3 / 0.2)
    >>> loads = vv.JointForce(joint=axles[0], force=-2.0), vv.Motor(joint=axles[1], motion=0.0)
    >>> system = vv.System([ground, *wheels, *axles, gear, *loads])
    >>> report = system.step(0.1)
    >>> torque = vv.ReactionTorque(joint=gear)(system)
    >>> round(float(torque[2]) / 0.3, 9)  # the teeth's load, 2 / 0.2
    10.0
    """

    ratio: Number

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_unless(
            self.ratio != 0, self, "ratio", "different from zero; a Rigid joint or a Motor holds an angle"
        )

    def coupled(self) -> tuple[tuple[Joint, str], tuple[Joint, str]]:
        return (self.a, "angle"), (self.b, "angle")

    def relation(self) -> Form:
        total: Form = self.a.coordinate("angle") + self.ratio * self.b.coordinate("angle")
        return total


@dataclass(config=settings, eq=False, kw_only=True)
class RackAndPinion(_Coupling):
    """Stroke of the rack's joint `b` follows `radius` times the angle of pinion joint `a` (1 constraint).

    `ReactionForce` is the load of the teeth on the body at the side `b` of joint `b`.

    Parameters
    ----------
    a : Joint
        With an angle: that of the pinion.
    b : Joint
        With a stroke: that of the rack.
    radius : float
        Pitch radius of the pinion, stroke per angle (length); positive.
    """

    radius: Number

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_unless(
            self.radius > 0, self, "radius", "positive; for the other sense turn the axis of a joint"
        )

    def coupled(self) -> tuple[tuple[Joint, str], tuple[Joint, str]]:
        return (self.a, "angle"), (self.b, "stroke")

    def relation(self) -> Form:
        slip: Form = self.b.coordinate("stroke") - self.radius * self.a.coordinate("angle")
        return slip
