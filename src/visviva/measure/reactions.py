"""Reaction forces and torques of joints and motors, from their multipliers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.arguments import refuse_other
from visviva.base.errors import InputError
from visviva.component.component import settings
from visviva.joint.joint import Joint
from visviva.measure.measures import Reading, remembers, touches

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]


def reaction(system: System, joint: Joint) -> tuple[Array, Array]:
    """Force (3,) and torque (3,) that a joint exerts on its partner `b`, torque about the joint's point on b.

    They belong to the present instant with every scheme, see :doc:`/theory/schemes`. Impulses, at kinks of what drives
    and in impacts, have no part in them.

    Examples
    --------
    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=2.0)
    >>> rope = vv.Spherical(a=ground, b=ball, at=(0, 0, 0))
    >>> system = vv.System([ground, ball, rope, vv.Gravity(acceleration=(0, 0, -10))])
    >>> report = system.step(0.1)
    >>> vv.reaction(system, rope)[0].round(9).tolist()
    [0.0, 0.0, 20.0]
    """
    refuse_other("reaction", "joint", joint, Joint, "a joint of the system")
    if not any(joint is c for c in system.components):
        raise InputError(f"reaction: {joint.label} is not in the system")
    about = joint.sides[1].p.value(system.x)
    (a, b), force = joint.action(system.x_with_reactions)
    own = b.wrench(system, force, about)
    if own is None:
        other = a.wrench(system, force, about)
        assert other is not None
        return -other[0], -other[1]
    return own


@dataclass(config=settings, frozen=True, kw_only=True)
class ReactionForce(Reading):
    """Probe: force (3,), in space, that a joint exerts on its partner `b`.

    Parameters
    ----------
    joint : Joint
        Of the system; of a `RackAndPinion`, the force of its teeth.
    """

    joint: Joint

    def told_by_state(self, system: System) -> bool:
        return not (remembers(system) or touches(system))

    @property
    def quantity(self) -> str:
        return "force"

    def __call__(self, system: System) -> Array:
        """Present value."""
        return reaction(system, self.joint)[0]


@dataclass(config=settings, frozen=True, kw_only=True)
class ReactionTorque(Reading):
    """Probe: torque (3,), in space, that a joint exerts on its partner `b`, about the joint's point on b.

    Parameters
    ----------
    joint : Joint
        Of the system; of a `Gear`, the torque of its teeth.
    """

    joint: Joint

    def told_by_state(self, system: System) -> bool:
        return not (remembers(system) or touches(system))

    @property
    def quantity(self) -> str:
        return "moment"

    def __call__(self, system: System) -> Array:
        """Present value."""
        return reaction(system, self.joint)[1]
