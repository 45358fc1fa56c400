"""Frames that spin steadily: centrifugal and Coriolis forces on all that has mass."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.base.timefunction import OfTime, TimeFunction
from visviva.component.component import Component, settings
from visviva.component.momentum import Axes, axes_along, by_forces
from visviva.component.values import Vector3
from visviva.model.term import Stencils, Term

if TYPE_CHECKING:
    from visviva.model.model import Model
    from visviva.model.state import State
    from visviva.scheme.schemes import Scheme

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class RotatingFrame(Component):
    """Positions and velocities of the whole system are those seen in a frame that spins at a constant rate.

    Parameters
    ----------
    angular_velocity : array (3,)
        Of the frame.
    about : array (3,)
        A point of the axis.
    times : number, expression, table or callable
        Factor of the angular velocity as a function of the load parameter, for statics alone.

    Notes
    -----
    With the constant mass matrix M of positions and directors, which turns with them, the equations of motion get
    ``M (Omega x (Omega x x) + 2 Omega x v)``. Supports and the ground spin along; forces that are fixed in space, such
    as gravity across the axis, turn in this frame and have to be given so. What spins steadily rests here: `Static`
    finds how far it is stretched and bent, `modes` its vibrations, forward and backward.

    Plane and axisymmetric solids have no positions in space and are refused: mesh them in space, a cell thick, with
    `SymmetryPlane` on the sides that stay plane.

    Examples
    --------
    A mass m on a spring k at radius r from the axis: it stretches to ``k r / (k - m Omega^2)``.

    >>> import visviva as vv
    >>> ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    >>> spring = vv.Spring(a=ground.point((1, 0, 0)), b=ball.point(), stiffness=100.0, free_length=0.0)
    >>> frame = vv.RotatingFrame(angular_velocity=(0, 0, 5), times="t")
    >>> system = vv.System([ground, ball, spring, frame])
    >>> result = vv.quasi_static(system, until=1.0, step=0.25)
    >>> round(float(system.x[0]), 9)
    1.333333333
    """

    angular_velocity: Vector3
    about: Vector3 = (0.0, 0.0, 0.0)
    times: OfTime | None = None

    contributes_last = True

    @property
    def outside_axes(self) -> Axes:
        return by_forces(
            "".join(c for c in "xyz" if axes_along(self.angular_velocity) != c)
        )  # across its axis

    def contribute(self, model: Model) -> None:
        others = [c for c in model.components if isinstance(c, RotatingFrame) and c is not self]
        if others:
            raise InputError(
                f"{self.label}: {others[0].label} is another frame; the whole system is seen from one, so give one "
                "the sum of the angular velocities"
            )
        for component in model.components:
            blocks = list(component.mass_blocks(model))
            vectors = component.vectors(model)
            in_plane = vectors is not None and vectors[2] < 3
            if in_plane or (not blocks and component.total_mass > 0):
                raise InputError(
                    f"{self.label}: {component.label} has no positions in space that could spin with it; "
                    "mesh what is plane or axisymmetric in space, with vv.SymmetryPlane on its sides"
                )
            places = set() if vectors is None else {*np.asarray(vectors[0])[np.asarray(vectors[1])].tolist()}
            for starts, mass in blocks:
                is_place = np.isin(starts, list(places))
                model.term(self, Spin(self, starts, mass, is_place))

    def start(self, state: State, scheme: Scheme) -> None:
        if scheme.has_inertia and self.times is not None:
            raise InputError(
                f"{self.label}: its angular velocity changes with time, which only statics takes as a load parameter; "
                "leave times out"
            )


class Spin(Term):
    """Centrifugal and Coriolis forces on elements with masses (n, k, k) between vectors that begin at (n, k)."""

    kind = "centrifugal"

    def __init__(
        self, frame: RotatingFrame, starts: NDArray[np.integer], mass: Array, is_place: NDArray[np.bool_]
    ) -> None:
        super().__init__()
        n, k = starts.shape
        self.unknowns = (starts[:, :, None] + np.arange(3)).reshape(n, -1).astype(np.int32)
        self.order = np.full(3 * k, 2, dtype=np.int32)
        self._centre = np.where(is_place[:, :, None], np.asarray(frame.about), 0.0).reshape(n, -1)
        x, y, z = np.asarray(frame.angular_velocity, dtype=float)
        spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        self._turn, self._pull = (
            np.einsum("nab,ij->naibj", mass, of).reshape(n, 3 * k, 3 * k) for of in (2 * spin, spin @ spin)
        )
        self._times: TimeFunction | None = frame.times
        if frame.times is None:
            self.energy = self._energy

    def _factor(self, t: float) -> float:
        return 1.0 if self._times is None else float(self._times(t))

    def _force(self, x: Array) -> Array:
        return np.asarray(np.einsum("nab,nb->na", self._pull, x - self._centre))

    def residual(self, s: Stencils) -> Array:
        w = self._factor(s.step.te)
        turned: Array = w * np.einsum("nab,nb->na", self._turn, s.rate)
        total: Array = turned + w * w * self._force(s.x)
        return total

    def tangent(self, s: Stencils) -> Array:
        w = self._factor(s.step.te)
        of_rate: Array = w * s.step.rate_factor * self._turn
        total: Array = of_rate + w * w * s.step.theta * self._pull
        return total

    def _energy(self, s: Stencils) -> Array:
        return np.asarray(0.5 * ((s.x1 - self._centre) * self._force(s.x1)).sum(axis=1))
