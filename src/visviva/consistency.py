"""Consistent states: positions and velocities on the constraints, accelerations and multipliers of a state.

Everything rests on the linear equations of one instant, with the constant mass `M` and the gradients `G` of
the constraints ``Phi(q, t) = 0``::

    M a + G^T mu = f,      G a = g

whose matrix the core's tangent holds for a step of no length. Redundant constraints make it singular; then a
small compliance of the scaled constraints is factored instead, and refinement with the exact matrix leaves
the solution of least multipliers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.errors import InputError

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model import Prescription
    from visviva.system import System

Array = NDArray[np.float64]

NO_LENGTH = 1e-100
"""Length of the step that stands for an instant: no clock notices it, and users may divide by it."""
COMPLIANCE = 1e-12
"""Compliance of the scaled constraints that makes redundant ones solvable."""
REDUNDANT = 1e-9
"""A combination of scaled constraints whose gradient is shorter than this is redundant."""
ROUND_OFF = 4e-15
"""Relative violation below which a constraint holds."""


def instant(time: float, *, theta: float = 0.0, leading: float = 0.0, rates: bool = False) -> Any:
    """The core's step at one instant.

    Parameters
    ----------
    theta : float
        1 for stiffness and the constraints' geometric part in the tangent, 0 for none.
    leading : float
        Factor of mass (order 2) and capacity (order 1) in the tangent.
    rates : bool
        Whether forces see the present velocities.
    """
    motion, transport = np.zeros((5, 4)), np.zeros((5, 4))
    motion[0, 1] = float(rates)
    motion[1, 0] = transport[0, 0] = leading
    return _core.Step(time, NO_LENGTH, time, theta, theta, False, motion, transport)


class Instant:
    """The linear equations of a system at its present state.

    Attributes
    ----------
    coordinates, multipliers : arrays of int
        Unknowns of the system in the order of the rows of M and of G.
    M, G : sparse arrays (n, n), (m, n)
        Mass (capacity for fields of order 1) and gradients of the constraints.
    reach : array (m,)
        What a constraint's value is measured by: its gradient times the size of the unknowns.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        unknown = system.free_unknowns
        is_multiplier = np.zeros(len(system.x), dtype=bool)
        for f in system.model.fields:
            is_multiplier[f.start : f.start + f.size] = f.multiplier
        self._q = np.flatnonzero(system.order[unknown] > 0)
        self._m = np.flatnonzero(is_multiplier[unknown])
        self.coordinates, self.multipliers = unknown[self._q], unknown[self._m]
        A = self._tangent(leading=1.0)
        self.M = A[self._q][:, self._q].tocsr()
        self.G = A[self._m][:, self._q].tocsr()
        self.columns = A[self._q][:, self._m].tocsr()
        scale = np.concatenate([f.scale for f in system.model.fields])[self.coordinates]
        self.scale = np.where(scale > 0, scale, 1.0)
        self.reach = abs(self.G) @ np.maximum(self.scale, np.abs(system.x[self.coordinates]))
        self.reach[self.reach == 0] = 1.0

    def _tangent(self, **step: Any) -> sp.csr_array:
        return self.system.tangent(instant(self.system.time, **step))[1]

    # --- constraints ----------------------------------------------------------------------------------------
    def violation(self, later: float = 0.0, ahead: Array | None = None) -> Array:
        """Values (m,) of the constraints, the clock `later`, prescribed functions changed by `ahead`."""
        step = instant(self.system.time + later)
        signals = self.system.signals(instant(self.system.time)).copy()
        if ahead is not None:
            signals[2] += ahead
        r: Array = self.system.residual(step, signals)[self.multipliers]
        return r

    def _by_signals(self, rate: Array) -> Array:
        return 0.5 * (self.violation(ahead=rate) - self.violation(ahead=-rate))

    @property
    def _sees_clock(self) -> bool:
        model = self.system.model
        return bool(model.terms) or any(e.law.callback is not None for e in model.elements)

    def drift(self) -> Array:
        """Partial time derivative (m,) of the constraints."""
        system, total = self.system, np.zeros(len(self.multipliers))
        if system.model.signals:
            total = self._by_signals(system.signals(instant(system.time))[3].copy())
        if system.model.prescribed:
            along = self.prescribed(lambda p: system.v[p.unknowns])
            total = total + 0.5 * (self._at(along) - self._at(-along))
        if self._sees_clock:
            total = total + difference(lambda s: self.violation(s), 1e-4)
        return total

    def gradient_along(self, v: Array, later: float = 0.0, shift: float = 0.0) -> Array:
        """``G v`` with G taken at configurations moved by ``shift v`` and the clock `later`."""
        system = self.system
        system.core.dx[self.coordinates] = shift * v
        A = system.tangent(instant(system.time + later, leading=1.0))[1]
        system.core.dx[:] = 0.0
        rate: Array = A[self._m][:, self._q] @ v
        return rate

    def convection(self) -> Array:
        """Second time derivative (m,) of the constraints without accelerations: what ``G a`` must balance."""
        system = self.system
        v = system.v[self.coordinates]
        span = 1e-3 / max(float(np.max(np.abs(v) / self.scale, initial=0.0)), 1.0)
        total = difference(lambda s: self.gradient_along(v, shift=s), span) if np.any(v) else 0.0 * self.reach
        if system.model.signals:
            functions = system.model.signals
            bend = difference(lambda s: np.array([f.rate(system.time + s) for f in functions]), 1e-3)
            total = total + self._by_signals(bend)
        if system.model.prescribed:
            total = total + self._prescribed_convection()
        if self._sees_clock:
            d = 5e-4
            values = [self.violation(k * d) for k in (-2, -1, 0, 1, 2)]
            second = (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (
                12 * d * d
            )
            total = total + second + 2 * difference(lambda s: self.gradient_along(v, later=s), 1e-4)
        return total

    # --- prescribed unknowns --------------------------------------------------------------------------------
    def prescribed(self, of: Callable[[Prescription], Array]) -> Array:
        """A vector of all unknowns with what `of` gives for the prescribed ones, zero elsewhere."""
        full = np.zeros(len(self.system.x))
        for p in self.system.model.prescribed:
            full[p.unknowns] = of(p)
        return full

    def prescribed_acceleration(self) -> Array:
        """Accelerations of the prescribed unknowns, zero elsewhere."""
        return self.prescribed(lambda p: p.acceleration(self.system.time))

    def prescribed_inertia(self) -> Array:
        """Inertia forces (n,) on the coordinates by the accelerations of prescribed unknowns."""
        system, a = self.system, self.prescribed_acceleration()
        factor = 1e6 * max(float(np.abs(a).max(initial=0.0)), 1.0)
        step = instant(system.time, leading=factor)
        system.core.dx[:] = a / factor
        moved = system.residual(step)
        system.core.dx[:] = 0.0
        force: Array = (moved - system.residual(step))[self.coordinates]
        return force

    def _at(self, dx: Array) -> Array:
        """Values (m,) of the constraints at a trial increment of all unknowns."""
        self.system.core.dx[:] = dx
        values = self.violation()
        self.system.core.dx[:] = 0.0
        return values

    def _bend(self, v: Array) -> Array:
        """Second derivatives (m,) of the constraints along `v`."""
        s = 0.1 / max(float(np.abs(v).max(initial=0.0)), 1.0)
        bend: Array = (self._at(s * v) + self._at(-s * v) - 2 * self.violation()) / s**2
        return bend

    def _prescribed_convection(self) -> Array:
        """What prescribed rates and accelerations add to the second time derivatives (m,)."""
        free, a = self.system.v.copy(), self.prescribed_acceleration()
        free[~np.isin(np.arange(len(free)), self.coordinates)] = 0.0
        moved = free + self.prescribed(lambda p: self.system.v[p.unknowns])
        return self._bend(moved) - self._bend(free) + 0.5 * (self._at(a) - self._at(-a))

    # --- solution -------------------------------------------------------------------------------------------
    def factor(self, compliance: float = COMPLIANCE) -> None:
        """Factor the scaled equations with a little mass where there is none and a little compliance."""

        import scipy.sparse as sp
        import scipy.sparse.linalg as spl

        n, m = len(self.coordinates), len(self.multipliers)
        self._exact = sp.block_array([[self.M, self.G.T], [self.G, sp.csr_array((m, m))]], format="csr")
        light = np.where(abs(self.M).sum(axis=1) == 0, 1e-3 * typical(self.M.diagonal()), 0.0)
        K = sp.block_array([[self.M + sp.diags_array(light), self.G.T], [self.G, None]], format="csr")
        self._s = equilibration(K)
        S = sp.diags_array(self._s)
        soft = sp.diags_array(np.r_[np.zeros(n), np.full(m, -compliance)])
        K = (S @ K @ S + soft).tocsc()
        self._lu = spl.splu(K, options={"Equil": False})

    def solve(self, f: Array, g: Array) -> tuple[Array, Array]:
        """``a`` (n,) and ``mu`` (m,) of ``M a + G^T mu = f``, ``G a = g``; least multipliers if redundant."""
        n = len(self.coordinates)
        right, best = np.concatenate([f, g]), np.inf
        z = np.zeros_like(right)
        for _ in range(6):
            rest = right - self._exact @ z
            size = float(np.abs(self._s * rest).max(initial=0.0))
            if not size < 0.5 * best:
                break
            best = size
            z = z + self._s * self._lu.solve(self._s * rest)
        return z[:n], z[n:]

    def redundancies(self) -> Array:
        """Basis (m, r) of the multipliers that have no effect, by inverse iteration with a random block."""

        import scipy.sparse as sp

        n, m = len(self.coordinates), len(self.multipliers)
        random, k = np.random.default_rng(0), min(4, m)

        def soften(X: Array) -> Array:
            z: Array = -self._lu.solve(np.vstack([np.zeros((n, X.shape[1])), X]))[n:]
            return z

        G = sp.diags_array(self._s[n:]) @ self.G @ sp.diags_array(self._s[:n])
        while m:
            X = np.linalg.qr(random.standard_normal((m, k)))[0]
            for _ in range(3):
                X = np.linalg.qr(soften(X))[0]
            _, length, V = np.linalg.svd(G.T @ X, full_matrices=False)
            null = length < REDUNDANT
            if null.sum() < k or k == m:
                basis: Array = self._s[n:, None] * (X @ V.T[:, null])
                return basis
            k = min(2 * k, m)
        return np.zeros((0, 0))


def typical(values: Array) -> float:
    """Median of the positive values, 1 without any."""
    positive = values[values > 0]
    return float(np.median(positive)) if len(positive) else 1.0


def equilibration(K: sp.csr_array) -> Array:
    """Factors that scale rows and columns of a symmetric matrix to largest entries near one."""

    import scipy.sparse as sp

    s = np.ones(K.shape[0])
    K = abs(K).tocsr()
    for _ in range(3):
        largest = K.max(axis=1).toarray().ravel()
        d = 1 / np.sqrt(np.where(largest > 0, largest, 1.0))
        s *= d
        K = (sp.diags_array(d) @ K @ sp.diags_array(d)).tocsr()
    return s


def difference(f: Callable[[float], Array], d: float) -> Array:
    """Derivative at 0 by five points."""
    return (8 * (f(d) - f(-d)) - (f(2 * d) - f(-2 * d))) / (12 * d)


# --- positions and velocities -------------------------------------------------------------------------------


@dataclass
class Correction:
    """How far a projection moved things.

    Attributes
    ----------
    before, after : float
        Largest relative violation of a constraint.
    moved : dict of str to float
        Largest change of an unknown (or rate), by component; in the units of the unknowns.
    """

    before: float
    after: float
    moved: dict[str, float]

    def __str__(self) -> str:
        if not self.moved:
            return f"consistent to {self.before:.1e}"
        largest = sorted(self.moved.items(), key=lambda item: -item[1])
        listed = ", ".join(f"{label} by {size:.3g}" for label, size in largest[:6])
        more = f" and {len(largest) - 6} more" if len(largest) > 6 else ""
        return f"violated by {self.before:.1e}, corrected to {self.after:.1e}: moved {listed}{more}"


def moved(system: System, change: Array) -> dict[str, float]:
    """Largest change of each component that changed by more than rounding."""
    sizes: dict[str, float] = {}
    noise = 1e-12 * float(np.abs(change).max(initial=0.0))
    for f in system.model.fields:
        if f.order > 0:
            size = float(np.abs(change[f.start : f.start + f.size]).max(initial=0.0))
            if size > noise:
                sizes[f.component.label] = max(size, sizes.get(f.component.label, 0.0))
    return sizes


def project_positions(system: System, at: Instant | None = None) -> Correction:
    """Move the configuration onto the constraints, as little as possible in the metric of mass.

    Gauss-Newton steps; where redundant constraints spoil them, damped ones.

    Returns
    -------
    Correction
        How far each component was moved; nothing is touched where the constraints hold to round-off.

    Raises
    ------
    InputError
        If no configuration satisfies the constraints; it names those that remain violated.
    """
    at = Instant(system) if at is None else at
    start = system.x.copy()
    first = worst(at)
    if first <= ROUND_OFF:
        return Correction(first, first, {})
    last = first
    for damped in (False, True):
        system.x[:] = start
        last = descend(system, damped)
        if last <= 1e-11:
            break
    else:
        message = contradiction(system)
        system.x[:] = start
        system.touch()
        raise InputError(message)
    system.touch()
    return Correction(first, last, moved(system, system.x - start))


def worst(at: Instant) -> float:
    """Largest relative violation."""
    size = float(np.abs(at.violation() / at.reach).max(initial=0.0))
    return size if np.isfinite(size) else np.inf


def descend(system: System, damped: bool) -> float:
    """Take Gauss-Newton steps until the violation no longer shrinks; returns what is left."""
    best, kept, stalled = np.inf, system.x.copy(), 0
    for _ in range(60 if damped else 25):
        at = Instant(system)
        size = worst(at)
        if size < 0.5 * best:
            stalled = 0
        elif stalled >= (12 if damped else 4) or best < 1e-13:
            break
        stalled += 1
        if size < best:
            best, kept = size, system.x.copy()
        if size <= ROUND_OFF / 4 or not np.isfinite(size):
            break
        at.factor(max(COMPLIANCE, 0.1 * size) if damped else COMPLIANCE)
        phi, zero = at.violation(), np.zeros(len(at.coordinates))
        z = at._s * at._lu.solve(at._s * np.concatenate([zero, -phi]))
        step = z[: len(zero)] if damped else at.solve(zero, -phi)[0]
        longest = float(np.abs(step / at.scale).max(initial=0.0))
        system.x[at.coordinates] += step * min(1.0, 0.5 / longest if longest > 0 else 1.0)
    system.x[:] = kept
    return best


def contradiction(system: System) -> str:
    """Names the constraints that remain violated at the present state."""
    at = Instant(system)
    relative = np.abs(at.violation() / at.reach)
    rigidity = {u for f in system.model.fields if f.multiplier and f.stage == 0 for u in f.unknowns}
    of_body = np.array([int(u) in rigidity for u in at.multipliers])
    if np.any(relative[~of_body] > 0.05 * relative.max()):
        relative[of_body] = 0.0  # bodies bend only because their joints pull
    named = []
    for k in np.argsort(-relative)[:4]:
        if relative[k] > 0.05 * relative.max():
            component, unknown = system.describe(int(at.multipliers[k]))
            named.append(f"{unknown} of {component} by {at.violation()[k]:.3g}")
    return (
        f"no configuration satisfies all constraints: violated remain {', '.join(named)} at the nearest "
        "configuration found. Correct the places, axes or lengths of these joints or of bodies they join, "
        "or start closer to a configuration that fits"
    )


def project_velocities(system: System, at: Instant | None = None) -> Correction:
    """Make the velocities satisfy the constraints' time derivatives, changed as little as possible in kinetic
    energy.

    Raises
    ------
    InputError
        If no velocities do (a motion is prescribed that the joints do not allow); it names the constraints.
    """
    if at is None:
        at = Instant(system)
        at.factor()
    v = system.v[at.coordinates].copy()
    drift = at.drift()
    reach = abs(at.G) @ np.maximum(at.scale, np.abs(v)) + np.abs(drift) + 1e-300
    defect = at.G @ v + drift
    before = float(np.abs(defect / reach).max(initial=0.0))
    if before <= ROUND_OFF:
        return Correction(before, before, {})
    change, _ = at.solve(np.zeros(len(v)), -defect)
    system.v[at.coordinates] = v + change
    rest = at.G @ (v + change) + drift
    after = float(np.abs(rest / reach).max(initial=0.0))
    if after > 1e-9:
        k = int(np.argmax(np.abs(rest / reach)))
        component, unknown = system.describe(int(at.multipliers[k]))
        system.v[at.coordinates] = v
        raise InputError(
            f"no velocities satisfy all constraints in the initial state: {unknown} of {component} "
            f"stays violated at the rate {rest[k]:.3g}. Check prescribed motions against what joints allow"
        )
    system.touch()
    full = np.zeros(len(system.x))
    full[at.coordinates] = change
    return Correction(before, after, moved(system, full))


# --- accelerations ------------------------------------------------------------------------------------------


def accelerations(system: System, at: Instant, still: bool = False) -> tuple[Array, Array]:
    """Accelerations (n,) and multipliers (m,) of the present state; `still` leaves the velocities out."""
    saved = system.x[at.multipliers].copy()
    system.x[at.multipliers] = 0.0
    force = system.residual(instant(system.time, theta=1.0, rates=not still))[at.coordinates]
    if system.model.prescribed and not still:
        force = force + at.prescribed_inertia()
    system.x[at.multipliers] = saved
    right = np.zeros(len(at.multipliers)) if still else -at.convection()
    return at.solve(-force, right)


def initial_acceleration(system: System, at: Instant | None = None) -> None:
    """Fill the history of schemes that start from accelerations, and the multipliers, consistently.

    Solves ``M a + f(q, v) + G^T lambda = 0`` with ``G a = -(G' v) v - ...``, parts prescribed in time
    included.
    """
    if at is None:
        at = Instant(system)
        at.factor()
    a, multipliers = accelerations(system, at)
    prescribed = at.prescribed_acceleration()
    for history in (system.core.a, system.core.w):
        history[:] = prescribed
        history[at.coordinates] = a
    system.x[at.multipliers] = multipliers
    system.touch()
    system.has_acceleration = True


def project_step(system: System, x0: Array, h: float, trial: Array) -> None:
    """Velocities at the end of a step of the variational midpoint scheme, whose solution was `trial`.

    The core leaves ``v* = 2 (q1 - q0) / h - v0``; what the position-momentum form asks for is ``M v1 = M v* +
    (h/2) G0^T lambda - G1^T mu`` with ``mu`` such that the rates of the constraints vanish.
    """
    x1 = system.x.copy()
    system.x[:] = x0
    columns = Instant(system).columns
    system.x[:] = x1
    at = Instant(system)
    at.factor()
    impulse = 0.5 * h * (columns @ trial[at.multipliers])
    system.v[at.coordinates], _ = at.solve(at.M @ system.v[at.coordinates] + impulse, -at.drift())
