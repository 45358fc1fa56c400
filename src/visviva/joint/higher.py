"""Couplings between the coordinates of joints: rope over a winch, gear, rack and pinion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pydantic.dataclasses import dataclass

from visviva.base.arguments import refuse_unless
from visviva.base.errors import InputError
from visviva.component.announcements import Asking
from visviva.component.component import settings
from visviva.component.values import Number
from visviva.joint.joint import Joint, Side
from visviva.model.form import Form, Strain, Vector, product, squared

if TYPE_CHECKING:
    from visviva.model.model import Model

Constraints = Sequence[Strain | Form]


@dataclass(config=settings, eq=False, kw_only=True)
class RopeOverWinch(Joint):
    """Inextensible massless rope from `a` to `b`, paid out by a winch: ``|p| = length + radius angle``.

    `winch` is the revolute joint whose angle counts; the rope leaves at the point `a`. Written quadratically,
    ``(|p|^2 - (length + radius angle)^2) / (2 length)``, so that its multiplier is about the rope's tension.
    The rope is always taut: where one would go slack, it pushes, and `ReactionForce` has the sign of that. A rope that
    can go slack is a `Beam` of little bending stiffness, or a `Spring` whose `energy` is zero below the rope's length.
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

    def constraints(self, A: Side, B: Side) -> Constraints:
        L = self.radius * self.winch.coordinate("angle") + self.length
        return [1 / (2 * self.length) * (squared(B.p - A.p) - product(L, L))]

    def lines(self) -> list[tuple[Vector, Vector]]:
        return [(self.sides[0].p, self.sides[1].p)]


@dataclass(config=settings, eq=False, kw_only=True)
class _Coupling(Joint):
    """One linear relation between two joint coordinates that keeps its initial value."""

    a: Joint
    b: Joint

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

    def declare(self, model: Model) -> None:
        self._coordinates = {}

    def contribute(self, model: Model) -> None:
        form = self.relation()
        self._strains = [Strain((), form - form.value(model.initial[0]))]
        self._multipliers = model.multipliers(self, "reaction", 1, stage=2, block=self)
        model.constrain(self, self._multipliers, self._strains)


@dataclass(config=settings, eq=False, kw_only=True)
class Gear(_Coupling):
    """Angle of joint `a` plus `ratio` times the angle of joint `b` stays constant (1 constraint)."""

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
    """Stroke of the rack's joint `b` follows `radius` times the angle of pinion joint `a` (1 constraint)."""

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
