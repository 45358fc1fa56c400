"""Forces of constraints and supports at the present instant.

The midpoint rules solve for the mean forces of a step. New rates are there twice the mean rate less the old ones, which
the rates of a smooth motion do not follow exactly: a twelfth of h^2 times their second derivative has to be taken off.
Who starts from the exact rates therefore alternates about that for ever, by the second order of h in the rates, and
in the mean forces, their differences over h, by the first. The variational rule takes half of the impulse of a node
from either side. What positions and rates ask of the forces at the instant is of second order with all of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from visviva.system.actuated import Actuated
from visviva.system.agreement import agreed_curvatures, agreed_rates
from visviva.system.averaged import settle_averages
from visviva.system.consistency import accelerations
from visviva.system.instant import NO_STEP, Instant, difference, instant
from visviva.system.memory import undisturbed

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.model import Model
    from visviva.system.system import System

Array = NDArray[np.float64]


class Present:
    """Multipliers and forces of one state, found once however many ask for them.

    Attributes
    ----------
    state : array
        Unknowns, rates and time that they belong to.
    x : array (n,)
        The unknowns, with the multipliers of lasting constraints at this instant.
    v, a : array (n,)
        Rates that the constraints allow, which what alternates has in its mean, and accelerations.
    """

    def __init__(self, system: System) -> None:
        self.state = state_of(system)
        self._system = system
        with undisturbed(system):
            settle_averages(system)  # on which accelerations depend
            self.x = system.x.copy()
            found = in_the_core(system) if is_plain(system) else None
            self.v, self.a, (of, multipliers) = found or by_the_equations(system)
        self.x[of] = multipliers

    def is_of(self, system: System) -> bool:
        """Whether the system is still in this state."""
        return np.array_equal(self.state, state_of(system))

    def holding_forces(self) -> Array:
        """Residual (n,) by unknown: at fixed unknowns, the forces that hold them or move them as prescribed."""
        system = self._system
        with undisturbed(system):
            system.x[:], system.v[:] = self.x, self.v
            force = system.residual(instant(system.time, theta=1.0, rates=True))
            return force + inertia(system, self.a)


def state_of(system: System) -> Array:
    """Unknowns, rates and time in one array."""
    return np.concatenate([system.x, system.v, [system.time]])


Found = tuple[Array, Array, tuple[NDArray[np.int64], Array]]
"""Rates, accelerations, and numbers and values of multipliers."""


def by_the_equations(system: System) -> Found:
    """For systems of any kind."""
    at = Actuated(system)
    at.factor()
    for p, rates in zip(system.model.driving.prescribed, agreed_rates(system), strict=True):
        system.v[p.unknowns] = rates
    if len(at.multipliers):
        v = system.v[at.coordinates]
        system.v[at.coordinates] += at.solve(np.zeros(len(v)), -(at.G @ v + at.drift()))[0]
    at.add_rate_constraints()
    if len(at.added):
        at.factor()
    a = at.prescribed_acceleration()
    a[at.coordinates], multipliers = accelerations(system, at)
    return system.v.copy(), a, (at.multipliers, multipliers)


# --- mechanisms, whose steps take a hundredth of the time of the above ----------------------------------------

MASSES: WeakKeyDictionary[Model, tuple[NDArray[np.int64], sp.csr_array]] = WeakKeyDictionary()
"""Coordinates and their masses by model."""
AHEAD = 3e-3
"""Part of the fastest unknown's size by which it is moved along its rate to see how constraints change."""


def is_plain(system: System) -> bool:
    """Whether the core solves for rates, and constraints depend on unknowns and functions of time alone."""
    model = system.model
    looks_at_clock = model.terms or any(e.law.callback is not None for e in model.elements)
    return bool(system.core.projects_rates and not model.driving.prescribed and not looks_at_clock)


def in_the_core(system: System) -> Found | None:
    """By the core's solver for rates, with differences of the constraints along the motion; None where it cannot.

    Of rigid bodies that solver finds motions that keep them rigid, and no multipliers: so they start from such ones.
    """
    constraint, step = system.is_lasting_constraint, instant(system.time)
    signals, solution = system.signals(step).copy(), np.zeros(len(system.x))
    system.x[constraint] = 0.0
    given = system.v.copy()
    turn_rigidly(system)
    along = Motion(system, np.zeros(len(system.x)))
    left = np.where(constraint, along.rate(), inertia(system, system.v - given))
    before = system.x.copy(), given
    if not system.core.solve_instant(step, signals, left, solution):
        system.x[:], system.v[:] = before
        return None
    system.v[:] += np.where(constraint, 0.0, solution)
    spins = turn_rigidly(system)
    along = Motion(system, spins)
    force = system.residual(instant(system.time, theta=1.0, rates=True)) + inertia(system, spins)
    system.core.solve_instant(step, signals, np.where(constraint, along.second_rate(), force), solution)
    of_bodies = [unknowns[12:] for unknowns in system.model.reductions.rigid]
    of = np.setdiff1d(np.flatnonzero(constraint), np.ravel(of_bodies))
    return system.v.copy(), spins + np.where(constraint, 0.0, solution), (of, solution[of])


def turn_rigidly(system: System) -> Array:
    """Give the directors of rigid bodies rates ``w x d``; returns the accelerations (n,) ``w x (w x d)``."""
    a = np.zeros(len(system.x))
    if system.model.reductions.rigid:
        numbers = np.array([unknowns[3:12] for unknowns in system.model.reductions.rigid], dtype=int)
        d, rates = (u[numbers].reshape(-1, 3, 3) for u in (system.x, system.v))
        w = 0.5 * np.cross(d, rates).sum(axis=1)[:, None, :]
        turned = np.cross(w, d)
        system.v[numbers], a[numbers] = turned.reshape(-1, 9), np.cross(w, turned).reshape(-1, 9)
    return a


def inertia(system: System, a: Array) -> Array:
    """Inertia forces (n,) of accelerations: by masses, and at unknowns that are held by `inertia_of_held`.

    Masses do not change as long as the model is the same. Differences of residuals alone would not do, as contact
    answers to what is moved, however little.
    """
    if system.model not in MASSES:
        at = Instant(system)
        MASSES[system.model] = at.coordinates, at.M
    coordinates, masses = MASSES[system.model]
    is_free = len(system.free_unknowns) == len(a)
    force = np.zeros(len(a)) if is_free else inertia_of_held(system, a)
    force[coordinates] = masses @ a[coordinates]
    return force


def inertia_of_held(system: System, a: Array) -> Array:
    """The same (n,) by increments that move next to nothing, which serves unknowns without equations as well."""
    size = 1e6 * max(float(np.abs(a).max(initial=0.0)), 1.0)
    step = instant(system.time, leading=size)
    without = system.residual(step)
    system.core.dx[:] = a / size
    force: Array = system.residual(step) - without
    system.core.dx[:] = 0.0
    return force


class Motion:
    """Constraints along ``x + s v + s^2 a / 2``, with functions of time that go on by their rates and second rates."""

    def __init__(self, system: System, a: Array) -> None:
        self._system, self._a = system, a
        self._step = instant(system.time)
        self._signals = system.signals(self._step).copy()
        self._rates = np.zeros((2, self._signals.shape[1]))
        if system.model.driving.signals:
            self._rates[:] = self._signals[3], agreed_curvatures(system)

    def _values(self, s: float) -> Array:
        signals = self._signals.copy()
        signals[:3] += s * self._rates[0] + 0.5 * s * s * self._rates[1]
        self._system.core.dx[:] = s * self._system.v + 0.5 * s * s * self._a
        values = self._system.residual(self._step, signals)
        self._system.core.dx[:] = 0.0
        return values

    @property
    def _span(self) -> float:
        system = self._system
        fastest = float((np.abs(system.v) * system.inverse_scale).max(initial=0.0))
        return AHEAD / fastest if fastest > 0 else system.clock.step or NO_STEP

    def rate(self) -> Array:
        """First derivative by s."""
        return difference(self._values, self._span)

    def second_rate(self) -> Array:
        """Second derivative by s."""
        d = self._span
        far, near = (self._values(k * d) + self._values(-k * d) for k in (2, 1))
        rate: Array = (16 * near - far - 30 * self._values(0.0)) / (12 * d * d)
        return rate
