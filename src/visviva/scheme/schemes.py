"""Time integration schemes: small value objects that say where things are evaluated and how rates follow.

A scheme gives one step's numbers: the evaluation time of loads, where strain and constraint gradients are
taken (``x_theta = x0 + theta (x1 - x0)``), which stress rule holds, and two tables that express rates and the
history at the end of the step through the increment ``dx = x1 - x0`` and the history ``(v, a, w)`` at its
start. Rows of a table: rate at the evaluation point, second rate there, then ``v``, ``a``, ``w`` at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.arguments import Validated
from visviva.base.errors import InputError
from visviva.model.field import Role

if TYPE_CHECKING:
    from visviva.model.state import State

Row = Sequence[float] | NDArray[np.float64]
Table = Sequence[Row]
"""Five rows of four coefficients: of dx, v, a, w."""

NONE = (0.0, 0.0, 0.0, 0.0)
SHORTEST = 1e-100
"""Lengths of steps, so that masses over their squares are numbers; the longest is its inverse."""


@dataclass(frozen=True)
class Scheme(metaclass=Validated):
    """Base of all schemes.

    Attributes
    ----------
    order : int
        Order of accuracy in time of the motion; one test checks them all.
    needs_acceleration : bool
        Whether the history starts from consistent initial accelerations.
    projects_velocity : bool
        Whether velocities are projected onto the constraints after each step.
    history_at : tuple of float
        Moments that the two histories of motion belong to, in steps after the present.
    has_inertia : bool
        Whether masses take part; without them, what nothing holds has no equilibrium.
    has_growing_time : bool
        Whether time grows in every step; otherwise pictures and movies count steps.
    conserves_energy : bool
        Whether the energy balance closes to rounding whatever is in the system, by which the audit judges.
    conserves_momenta : bool
        Whether angular momentum is conserved, too; linear momentum is by all.
    """

    order: ClassVar[int] = 0
    theta: ClassVar[float] = 1.0
    theta_g: ClassVar[float | None] = None
    discrete_gradient: ClassVar[bool] = False
    needs_acceleration: ClassVar[bool] = False
    projects_velocity: ClassVar[bool] = False
    history_at: ClassVar[tuple[float, float]] = (0.0, 0.0)
    has_inertia: ClassVar[bool] = True
    has_growing_time: ClassVar[bool] = True
    conserves_energy: ClassVar[bool] = False
    conserves_momenta: ClassVar[bool] = False

    @property
    def dissipates(self) -> bool:
        """True if the scheme damps fast vibrations on purpose."""
        return False

    @property
    def keeps_swinging(self) -> bool:
        """True if new velocities are twice the mean rate less the old ones, so that errors alternate for ever."""
        return self.has_inertia and bool(self.motion(1.0)[2][1] == -1)

    @property
    def rings(self) -> bool:
        """True if what is of first order and fast beside a step alternates after a change, by more than half of it."""
        if not self.has_inertia:
            return False
        rates = np.array(self.transport(1.0)[2:], dtype=float)[:, 1:]  # after steps in which nothing changes
        least = float(np.linalg.eigvals(rates).real.min())
        return min(least, 1 - 1 / self.theta) < -0.5

    @property
    def solves_means(self) -> bool:
        """True if multipliers are means over the step rather than values at its end."""
        return self.has_inertia and self.theta < 1

    def refuse(self, state: State) -> None:
        """Raise `InputError` for systems that the scheme does not fit."""

    def motion(self, h: float) -> Table:
        """Table of a field of order 2."""
        raise NotImplementedError

    def transport(self, h: float) -> Table:
        """Table of a field of order 1."""
        raise NotImplementedError

    def first(self, h: float) -> Table:
        """Table of contents, fields of order 1 that do not flow, in the first step of a scheme with a history.

        Backward Euler: rates at the start, infinite where temperatures jump, do not enter. It costs no order.
        """
        rate = (1 / h, 0, 0, 0)
        return (rate, NONE, rate, rate, rate)

    def step(self, t0: float, h: float, *, begins: bool = False) -> _core.Step:
        """The numbers of the step from `t0` to ``t0 + h``; where it `begins`, no step has left a history."""
        refuse_extreme(h)
        theta_g = self.theta if self.theta_g is None else self.theta_g
        te = t0 + self.theta * h
        motion = np.array(self.motion(h), dtype=float)
        flow = np.array(self.transport(h), dtype=float)
        contents = np.array(self.first(h), dtype=float) if begins and self.needs_acceleration else flow
        tables = motion, contents, self.projects_velocity, flow
        return _core.Step(t0, h, te, self.theta, theta_g, self.discrete_gradient, *tables)


def refuse_extreme(h: float) -> None:
    """Refuse a length of a step whose square double precision does not hold; none at all is for the present moment."""
    if h != 0 and not SHORTEST <= abs(h) <= 1 / SHORTEST:
        raise InputError(
            f"step = {h:g} is not a length from {SHORTEST:g} to {1 / SHORTEST:g}: squares of others do not fit into "
            "numbers; take another one, or another unit of time"
        )


@dataclass(frozen=True)
class Midpoint(Scheme):
    """Implicit midpoint rule, paper (10): second order, conserves momenta, energy of quadratic potentials."""

    order: ClassVar[int] = 2
    theta: ClassVar[float] = 0.5
    conserves_momenta: ClassVar[bool] = True

    def motion(self, h: float) -> Table:
        second = (2 / h**2, -2 / h, 0.0, 0.0)
        return ((1 / h, 0, 0, 0), second, (2 / h, -1, 0, 0), NONE, NONE)

    def transport(self, h: float) -> Table:
        return ((1 / h, 0, 0, 0), NONE, (1 / h, 0, 0, 0), NONE, NONE)


@dataclass(frozen=True)
class EnergyMomentum(Midpoint):
    """Energy-momentum scheme: the midpoint rule with discrete gradients (Gonzalez 1996), paper eq. (23).

    Conserves energy, momenta and constraints to round-off for every material and joint.
    """

    discrete_gradient: ClassVar[bool] = True
    conserves_energy: ClassVar[bool] = True


@dataclass(frozen=True)
class VariationalMidpoint(Midpoint):
    """Discrete Euler-Lagrange equations of the midpoint Lagrangian, constraints at the nodes [3].

    Symplectic and momentum conserving; velocities are projected onto the constraints at the end of each step.
    """

    theta_g: ClassVar[float | None] = 0.0
    projects_velocity: ClassVar[bool] = True


@dataclass(frozen=True)
class BackwardEuler(Scheme):
    """Backward Euler: first order, dissipates."""

    order: ClassVar[int] = 1

    @property
    def dissipates(self) -> bool:
        return True

    def motion(self, h: float) -> Table:
        second = (1 / h**2, -1 / h, 0.0, 0.0)
        return ((1 / h, 0, 0, 0), second, (1 / h, 0, 0, 0), NONE, NONE)

    def transport(self, h: float) -> Table:
        return ((1 / h, 0, 0, 0), NONE, (1 / h, 0, 0, 0), NONE, NONE)


@dataclass(frozen=True)
class BDF2(Scheme):
    """Backward differentiation over two steps (Curtiss & Hirschfelder 1952): second order, damps what is fast.

    The history holds, of motion, the curvature ``2 (v0 - dx_last / h) / h`` of the parabola through the last step (`a`)
    and the mean acceleration in it (`w`); of fields of order 1 the mean rate in it (`a`). At the start the
    accelerations and rates of that moment stand for them.
    """

    order: ClassVar[int] = 2
    needs_acceleration: ClassVar[bool] = True

    @property
    def dissipates(self) -> bool:
        return True

    def motion(self, h: float) -> Table:
        v1 = np.array([1.5 / h, -0.5, 0.25 * h, 0])
        change = (v1 - [0, 1, 0, 0]) / h
        a1 = (v1 - [1 / h, 0, 0, 0]) * 2 / h
        return (v1, 1.5 * change - [0, 0, 0, 0.5], v1, a1, change)

    def transport(self, h: float) -> Table:
        v1 = (1.5 / h, 0, -0.5, 0)
        return (v1, NONE, v1, (1 / h, 0, 0, 0), NONE)


@dataclass(frozen=True)
class GeneralizedAlpha(Scheme):
    """Generalised-alpha (Chung & Hulbert 1993) in the form of Arnold & Bruels (2007) for constrained systems.

    After each step the rates are projected onto the constraints, accelerations and multipliers to match (stabilised
    index-2 form, Arnold, Bruels & Cardona 2015). Without that constraints have three histories that decay like rho^n
    and feed each other, and already a rotating wheel loses its motion.

    Parameters
    ----------
    rho : float
        Spectral radius at infinity, 0 (damps most) to 1 (damps nothing, for what moves freely alone).
    """

    rho: float = 0.9

    def __post_init__(self) -> None:
        if not 0 <= self.rho <= 1:
            raise InputError(f"GeneralizedAlpha: rho = {self.rho} is not a number from 0 to 1")

    order: ClassVar[int] = 2
    needs_acceleration: ClassVar[bool] = True
    projects_velocity: ClassVar[bool] = True

    def refuse(self, state: State) -> None:
        if self.rho < 1:
            return
        if stored := [f.component.label for f in state.model.fields if f.role is Role.CONTENT]:
            raise InputError(
                f"GeneralizedAlpha(rho=1) damps nothing, and what {stored[0]} holds would go to and fro for ever "
                "after a sudden change, and gain energy: take rho up to 0.8, BDF2(), or EnergyMomentum()"
            )
        if state.constrains_motion:
            raise InputError(
                "GeneralizedAlpha(rho=1) damps nothing, and in constrained motion (rigid bodies, joints) rounding "
                "across constraints would alternate for ever and grow: take rho below 1, or EnergyMomentum()"
            )

    @property
    def history_at(self) -> tuple[float, float]:  # type: ignore[override]
        """Acceleration-like variables are accelerations ``alpha_m - alpha_f`` steps later, to second order."""
        alpha_m, alpha_f, _, _ = self.parameters()
        return alpha_m - alpha_f, 0.0

    @property
    def dissipates(self) -> bool:
        return self.rho < 1

    def parameters(self) -> tuple[float, float, float, float]:
        """``alpha_m, alpha_f, gamma, beta``."""
        alpha_m, alpha_f = (2 * self.rho - 1) / (self.rho + 1), self.rho / (self.rho + 1)
        gamma = 0.5 + alpha_f - alpha_m
        return alpha_m, alpha_f, gamma, 0.25 * (gamma + 0.5) ** 2

    def motion(self, h: float) -> Table:
        am, af, gamma, beta = self.parameters()
        a1 = np.array([1 / (h * h * beta), -1 / (h * beta), -(0.5 - beta) / beta, 0.0])
        v1 = np.array([0, 1, h * (1 - gamma), 0]) + h * gamma * a1
        w1 = ((1 - am) * a1 + np.array([0, 0, am, -af])) / (1 - af)
        return (v1, w1, v1, a1, w1)

    def transport(self, h: float) -> Table:
        am, af, gamma, _ = self.parameters()
        a1 = np.array([1 / (h * gamma), 0, -(1 - gamma) / gamma, 0])
        w1 = ((1 - am) * a1 + np.array([0, 0, am, -af])) / (1 - af)
        return (w1, NONE, w1, a1, w1)


def load_step(t0: float, h: float) -> _core.Step:
    """The numbers of a load step: its end alone counts, without rates and inertia."""
    rest = np.zeros((5, 4))
    return _core.Step(t0, h, t0 + h, 1.0, 1.0, False, rest, rest, False)
