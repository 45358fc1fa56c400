"""Probes of motion: angular velocities, rates of joint coordinates, powers of components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.component.component import Component, settings
from visviva.component.where import frame_of
from visviva.joint.joint import Joint
from visviva.measure.measures import Reading

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


@dataclass(config=settings, frozen=True, kw_only=True)
class AngularVelocity(Reading):
    """Probe: angular velocity (3,) of a body, or of a frame, in space: half the sum of ``d_i x d_i'``.

    Parameters
    ----------
    of : component or Frame

    Examples
    --------
    >>> import visviva as vv
    >>> body = vv.RigidBody(mass=1.0, inertia=(1, 2, 3), angular_velocity=(0.1, 0.2, 0.3))
    >>> vv.AngularVelocity(of=body)(vv.System([body])).round(9).tolist()
    [0.1, 0.2, 0.3]
    """

    of: Any

    @property
    def quantity(self) -> str:
        return "angular_velocity"

    def told_by_state(self, system: System) -> bool:
        return True

    def __call__(self, system: System) -> Array:
        directors = frame_of("AngularVelocity", self.of).directors
        turns = [np.cross(d.value(system.x), d.rate(system.v)) for d in directors]
        return np.asarray(0.5 * np.sum(turns, axis=0))


@dataclass(config=settings, frozen=True, kw_only=True)
class JointRate(Reading):
    """Probe: rate of the angle or stroke of a joint.

    Parameters
    ----------
    joint : Joint
    coordinate : {'angle', 'stroke'}, optional
        The angle where the joint has one, unless said otherwise.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, arm = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1), angular_velocity=(0, 0, 2))
    >>> hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0))
    >>> rate = vv.JointRate(joint=hinge)
    >>> round(rate(vv.System([ground, arm, hinge])), 9)
    2.0
    """

    joint: Joint
    coordinate: Literal["angle", "stroke"] | None = None

    def __post_init__(self) -> None:
        self.joint.refuse_without(self.name)

    @property
    def name(self) -> str:
        """Chosen coordinate."""
        return self.joint.usual_coordinate(self.coordinate)

    @property
    def quantity(self) -> str:
        return "angular_velocity" if self.name == "angle" else "velocity"

    def told_by_state(self, system: System) -> bool:
        return True

    def __call__(self, system: System) -> float:
        return self.joint.rate(self.name, system.x, system.v)


@dataclass(config=settings, frozen=True, kw_only=True)
class Power(Reading):
    """Probe: mean power that a component has brought into the system over the last step; dampers take some out.

    It is the work that the ledger books for it by the length of the step, and zero before the first one.

    Parameters
    ----------
    of : component

    Examples
    --------
    >>> import visviva as vv
    >>> ball = vv.PointMass(mass=1.0, velocity=(2, 0, 0))
    >>> push = vv.Force(on=ball, force=(3, 0, 0))
    >>> system = vv.System([ball, push])
    >>> report = system.step(0.1)
    >>> round(vv.Power(of=push)(system), 9)  # 3 times the mean velocity 2.15
    6.45
    """

    of: Component

    @property
    def quantity(self) -> str:
        return "power"

    def told_by_state(self, system: System) -> bool:
        return False

    def __call__(self, system: System) -> float:
        if not any(self.of is c for c in system.components):
            raise InputError(f"Power: {self.of.label} is not in the system")
        number, h = system.model.index(self.of), system.last_step
        own = [
            k for k, a in enumerate(system.model.accounts) if a.component == number and a.category in BOOKED
        ]
        return float(np.asarray(system.core.work)[own].sum() / h) if h > 0 and own else 0.0


BOOKED = ("work", "dissipation", "heat")
"""Categories of accounts that the ledger sums as works."""
