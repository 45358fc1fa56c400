"""The linear equations of one instant, on which consistent states, checks and modes rest.

With the constant mass `M` and the gradients `G` of the constraints ``Phi(q, t) = 0`` they are ::

    M a + G^T mu = f,      G a = g

whose matrix the core's tangent holds for a step of no length. Redundant constraints make it singular; then a
small compliance of the scaled constraints is factored instead, and refinement with the exact matrix leaves
the solution of least multipliers. In what is factored meshes have their masses lumped to the nodes: that
leaves nothing to fill in, however large they are.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.base.differences import forward_curvature, forward_rate
from visviva.base.errors import InputError
from visviva.system.agreement import agreed_accelerations, agreed_curvatures, agreed_rates
from visviva.system.memory import returning
from visviva.system.scaling import by_weight, equilibration

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.model.field import Prescription
    from visviva.system.system import System

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

NO_STEP = 1e-3
"""Length of steps assumed before one is known."""
COMPLIANCE = 1e-12
"""Compliance of the scaled constraints that makes redundant ones solvable."""
SPURIOUS = 1e-6
"""The same of what is asked of accelerations alone: modes of pressures of equal order that push nothing stay small."""
MOST = 30
"""Refinements, whose corrections shrink by half at least."""
LIGHT = 1e-6
"""Mass of what has none, beside the scaled others: refinement takes off its effect."""
FEW = 3000
"""Equations up to which consistent masses are factored."""
REDUNDANT = 1e-9
"""A combination of scaled constraints whose gradient is shorter than this is redundant."""


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
    return _core.Step(time, _core.Step.NO_LENGTH, time, theta, theta, False, motion, transport)


def refuse_infinite(system: System, unknowns: Ints, values: Array) -> None:
    """Refuse what is not finite beside an unknown at the start, which numbers out of all proportion make."""
    if not np.isfinite(values).all():
        label, name = system.describe(int(unknowns[np.argmin(np.isfinite(values))]))
        raise InputError(
            f"{label}: masses, forces or scales of its {name} are not finite at the start; some number there, or of "
            "what acts there, is too large or too small"
        )


def inertia(system: System, a: Array) -> Array:
    """Inertia forces on all unknowns (n,), those that are held too, by accelerations (n,)."""
    factor = 1e6 * max(float(np.abs(a).max(initial=0.0)), 1.0)
    step = instant(system.time, leading=factor)
    with returning(system):
        system.core.dx[:] = a / factor
        moved = system.residual(step)
    forces: Array = moved - system.residual(step)
    return forces


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
    columns : sparse array (n, m)
        Along what multipliers push.
    added : array (k,)
        What the last k rows of G, which `add_rate_constraints` appends, shall give.
    """

    added: Array = np.zeros(0)

    def __init__(self, system: System) -> None:
        self.system = system
        system.core.find_neighbours()  # several processes have equations for what is coupled alone
        unknown = system.free_unknowns
        is_multiplier = np.zeros(len(system.x), dtype=bool)
        for f in system.model.fields:
            is_multiplier[f.start : f.start + f.size] = f.multiplier and f.instantaneous
        self._q = np.flatnonzero(system.order[unknown] > 0)
        self._m = np.flatnonzero(is_multiplier[unknown])
        self.coordinates, self.multipliers = unknown[self._q], unknown[self._m]
        A = self._tangent(leading=1.0)
        refuse_infinite(system, unknown, A @ np.ones(A.shape[1]))
        self.M = A[self._q][:, self._q].tocsr() if len(self._q) < A.shape[0] else A
        self.G = A[self._m][:, self._q].tocsr()
        self.columns = self._columns_in(A)
        scale = system.scale[self.coordinates]
        self.scale = np.where(scale > 0, scale, 1.0)
        self.reach = abs(self.G) @ np.maximum(self.scale, np.abs(system.x[self.coordinates]))
        self.reach[self.reach == 0] = 1.0

    def _columns_in(self, _: sp.csr_array) -> sp.csc_array:
        """Along what multipliers push (n, m): here what they hold, as the least change of a state has it."""
        columns: sp.csc_array = self.G.T
        return columns

    def _sizes(self, K: sp.csr_array) -> sp.csr_array:
        """What is scaled to entries near one, as rows and as columns."""
        return K

    @property
    def of_motion(self) -> NDArray[np.bool_]:
        """Which constraints (m,) have, with all that they share coordinates with, to do with motion alone."""
        import scipy.sparse as sp
        from scipy.sparse.csgraph import connected_components

        flows = self.system.order[self.coordinates] != 2
        _, part = connected_components(
            sp.block_array([[None, self.G], [self.G.T, None]], format="csr"), directed=False
        )
        m = self.G.shape[0]
        return np.asarray(~np.isin(part[:m], part[m:][flows]))

    def keep(self, rows: NDArray[np.bool_]) -> None:
        """Leave out all other constraints."""
        self._m, self.multipliers, self.reach = self._m[rows], self.multipliers[rows], self.reach[rows]
        self.G, self.columns = self.G[rows], self.columns[:, rows]

    def _tangent(self, **step: Any) -> sp.csr_array:
        return self.system.tangent(instant(self.system.time, **step))[1]

    def add_rate_constraints(self) -> None:
        """Append what components ask of accelerations alone, such as to follow a fluid, to the multipliers and to G."""

        import scipy.sparse as sp

        found = [c.rate_constraints(self.system) for c in self.system.components]
        asked = [f for f in found if f is not None]
        if not asked:
            return
        multipliers = np.concatenate([m for m, _, _ in asked])
        free = np.isin(multipliers, self.system.free_unknowns)
        rows = sp.vstack([G for _, G, _ in asked], format="csr")[free]
        values = np.concatenate([values for _, _, values in asked])[free]
        self.added = values - rows @ self.prescribed_acceleration()
        self.multipliers = np.concatenate([self.multipliers, multipliers[free]])
        self.metric = self.M  # masses of what a fluid displaces are taken off, and lumped ones may vanish
        more = rows[:, self.coordinates]
        self.G = sp.vstack([self.G, more], format="csr")
        self.columns = sp.hstack([self.columns, more.T], format="csc")

    # --- constraints ----------------------------------------------------------------------------------------
    def violation(self, delay: float = 0.0, offset: Array | None = None) -> Array:
        """Values (m,) of the constraints at time + `delay`, prescribed values shifted by `offset` (n,)."""
        step = instant(self.system.time + delay)
        signals = self.system.signals(instant(self.system.time)).copy()
        if offset is not None:
            signals[2] += offset
        r: Array = self.system.residual(step, signals)[self.multipliers[: len(self.reach)]]
        return r

    def _signal_curvatures(self) -> Array:
        return agreed_curvatures(self.system)

    def _by_signals(self, rate: Array) -> Array:
        h = self.moment
        return 0.5 / h * (self.violation(offset=h * rate) - self.violation(offset=-h * rate))

    @property
    def _sees_clock(self) -> bool:
        model = self.system.model
        return bool(model.terms) or any(e.law.callback is not None for e in model.elements)

    @property
    def moment(self) -> float:
        """Span from now over which functions of time are looked at: a step, as far as its length is known."""
        return self.system.clock.step or NO_STEP

    def drift(self, signals: Array | None = None, prescribed: Array | None = None) -> Array:
        """Partial time derivative (m,) of the constraints, or what these rates of signals and unknowns make of it."""
        system, total, alone = self.system, np.zeros(len(self.multipliers)), signals is not None
        if system.model.driving.signals:
            total = self._by_signals(
                system.signals(instant(system.time))[3].copy() if signals is None else signals
            )
        if system.model.driving.prescribed:
            h, v = self.moment, system.v if prescribed is None else prescribed
            along = h * self.prescribed(lambda p: v[p.unknowns])
            total = total + 0.5 / h * (self.values_at(along) - self.values_at(-along))
        if self._sees_clock and not alone:
            total = total + forward_rate(self.violation, 0.0, system.clock.step)
        return total

    def gradient_along(self, v: Array, later: float = 0.0, shift: float = 0.0) -> Array:
        """``G v`` with G taken at configurations moved by ``shift v`` and the clock `later`."""
        rate: Array = self._gradients_near(v, later, shift) @ v
        return rate

    def _gradients_near(self, v: Array, later: float = 0.0, shift: float = 0.0) -> sp.csr_array:
        system = self.system
        with returning(system):
            system.core.dx[self.coordinates] = shift * v
            A = system.tangent(instant(system.time + later, leading=1.0))[1]
        G: sp.csr_array = A[self._m][:, self._q]
        return G

    def _span(self, v: Array) -> float:
        """Distance along velocities at which differences are taken."""
        return 1e-3 / (float(np.max(np.abs(v) / self.scale, initial=0.0)) or 1.0)

    def bend(self, null: Array) -> Array:
        """Derivatives (n, r) along the velocities of the gradients of combinations (m, r) of constraints."""
        v = self.system.v[self.coordinates]
        return difference(lambda s: self._gradients_near(v, shift=s).T @ null, self._span(v))

    def convection(self) -> Array:
        """Second time derivative (m,) of the constraints without accelerations: what ``G a`` must balance."""
        system = self.system
        v = system.v[self.coordinates]
        total: Array = np.zeros(len(self.reach))
        if np.any(v):
            total = difference(lambda s: self.gradient_along(v, shift=s), self._span(v))
        if system.model.driving.signals:
            total = total + self._by_signals(self._signal_curvatures())
        if system.model.driving.prescribed:
            total = total + self._prescribed_convection()
        if self._sees_clock:
            # Functions of time may have no values before the start.
            mixed = forward_rate(lambda s: self.gradient_along(v, later=s), 0.0, self.moment)
            total = total + forward_curvature(self.violation, 0.0, self.moment) + 2 * mixed
        return total

    # --- prescribed unknowns --------------------------------------------------------------------------------
    def prescribed(self, of: Callable[[Prescription], Array]) -> Array:
        """A vector of all unknowns with what `of` gives for the prescribed ones, zero elsewhere."""
        full = np.zeros(len(self.system.x))
        for p in self.system.model.driving.prescribed:
            full[p.unknowns] = of(p)
        return full

    def prescribed_acceleration(self) -> Array:
        """Accelerations of the prescribed unknowns, or rates of those of order 1 such as velocities; zero elsewhere."""
        system, a = self.system, np.zeros(len(self.system.x))
        found = agreed_accelerations(system), agreed_rates(system)
        for p, second, rates in zip(system.model.driving.prescribed, *found, strict=True):
            a[p.unknowns] = np.where(system.order[p.unknowns] == 1, rates, second)
        return a

    def prescribed_inertia(self) -> Array:
        """Inertia forces (n,) on the coordinates by the accelerations of prescribed unknowns."""
        return inertia(self.system, self.prescribed_acceleration())[self.coordinates]

    def values_at(self, dx: Array) -> Array:
        """Values (m,) of the constraints at a trial increment of all unknowns."""
        with returning(self.system):
            self.system.core.dx[:] = dx
            return self.violation()

    def _bend(self, v: Array) -> Array:
        """Second derivatives (m,) of the constraints along `v`."""
        s = 0.1 / (float(np.abs(v * self.system.inverse_scale).max(initial=0.0)) or 1.0)
        bend: Array = (self.values_at(s * v) + self.values_at(-s * v) - 2 * self.violation()) / s**2
        return bend

    def _prescribed_convection(self) -> Array:
        """Part of the second time derivatives (m,) due to prescribed rates and accelerations."""
        free, a = self.system.v.copy(), self.prescribed_acceleration()
        free[~np.isin(np.arange(len(free)), self.coordinates)] = 0.0
        moved = free + self.prescribed(lambda p: self.system.v[p.unknowns])
        return self._bend(moved) - self._bend(free) + 0.5 * (self.values_at(a) - self.values_at(-a))

    # --- solution -------------------------------------------------------------------------------------------
    @cached_property
    def metric(self) -> sp.csr_array:
        """Mass with that of meshes lumped: what a change of positions or velocities is measured by."""

        import scipy.sparse as sp

        of_mesh = np.zeros(len(self.system.x), dtype=bool)
        for f in self.system.model.fields:
            of_mesh[f.start : f.start + f.size] = f.node > 1
        of_mesh = of_mesh[self.coordinates]
        if not of_mesh.any():
            return self.M
        kept = sp.diags_array((~of_mesh).astype(float))
        total, diagonal = self.M @ of_mesh.astype(float), self.M.diagonal()
        share = np.where(of_mesh, diagonal, 0.0)
        share *= total[of_mesh].sum() / share.sum() if share.sum() > 0 else 0.0
        return (kept @ self.M @ kept + sp.diags_array(share)).tocsr()

    def factor(self, compliance: float = COMPLIANCE) -> None:
        """Factor the scaled equations with a little mass where there is none and a little compliance."""

        import scipy.sparse as sp
        import scipy.sparse.linalg as spl

        n, m = len(self.coordinates), len(self.multipliers)
        if n + m == 0:  # all that moves is prescribed
            self._s = np.zeros(0)
            return
        K = sp.block_array([[self.metric, self.columns], [self.G, None]], format="csr")
        with np.errstate(all="ignore"):  # what is not finite is refused by name
            unit = by_weight(self.metric.diagonal(), self.scale)
            self._s = equilibration(self._sizes(K), np.concatenate([unit, np.zeros(m)]))
        refuse_infinite(self.system, np.r_[self.coordinates, self.multipliers], self._s)
        S = sp.diags_array(self._s)
        weightless = abs(self.metric).sum(axis=1) == 0
        little = sp.diags_array(np.r_[np.where(weightless, LIGHT, 0.0), -self._compliances(compliance)])
        K = (S @ K @ S + little).tocsc()
        if self.metric is not self.M and K[:n, :n].nnz == n:  # meshes alone
            with suppress(
                RuntimeError
            ):  # the compliance of redundant constraints was lost in their complement
                self._solve = by_complement(K, n)
                return
        self._solve = spl.splu(K, options={"Equil": False}).solve

    def _compliances(self, least: float) -> Array:
        """Of the scaled constraints (m,)."""
        n, m = len(self.added), len(self.multipliers)
        return np.repeat([least, max(least, SPURIOUS)], [m - n, n])

    def soft(self, f: Array, g: Array) -> Array:
        """Solution (n + m,) of the factored equations."""
        z: Array = self._s * self._solve(self._s * np.concatenate([f, g]))
        return z

    def refined(
        self, mass: sp.csr_array, f: Array, g: Array, improve: Callable[[Array], Array]
    ) -> tuple[Array, Array]:
        """The exact solution by corrections that `improve` finds from what is left of the right-hand side.

        What is left after the first need not be less than before, where the right-hand side holds rates of
        constraints alone: the corrections tell.
        """
        n, last = len(f), (np.inf, np.inf)
        z = np.zeros(n + len(g))
        if not len(z):
            return f, g
        for _ in range(MOST):
            change = improve(np.concatenate([f - mass @ z[:n] - self.columns @ z[n:], g - self.G @ z[:n]]))
            relative = np.abs(change / self._s)
            sizes = float(relative[:n].max(initial=0.0)), float(relative[n:].max(initial=0.0))
            if not any(size < 0.5 * before for size, before in zip(sizes, last, strict=True)):
                break
            z, last = z + change, sizes
        return z[:n], z[n:]

    def solve(self, f: Array, g: Array) -> tuple[Array, Array]:
        """``a`` (n,) and ``mu`` (m,) of ``M a + G^T mu = f``, ``G a = g`` with lumped masses of meshes.

        The multipliers are the least if constraints are redundant.
        """
        n = len(f)
        return self.refined(self.metric, f, g, lambda rest: self.soft(rest[:n], rest[n:]))

    def solve_consistent(self, f: Array, g: Array) -> tuple[Array, Array]:
        """The same with the consistent masses of meshes, by GMRES on the lumped ones where factors would fill much."""
        if self.metric is self.M:
            return self.solve(f, g)

        import scipy.sparse as sp
        import scipy.sparse.linalg as spl

        n, size = len(f), len(f) + len(g)
        if size <= FEW:
            S = sp.diags_array(self._s)
            K = S @ sp.block_array([[self.M, self.columns], [self.G, None]], format="csr") @ S
            weightless = abs(self.M).sum(axis=1) == 0
            little = sp.diags_array(np.r_[np.where(weightless, LIGHT, 0.0), -self._compliances(COMPLIANCE)])
            try:
                solve = spl.splu((K + little).tocsc(), options={"Equil": False}).solve
            except RuntimeError:  # exactly singular, as one little may take off the other
                pass
            else:
                return self.refined(self.M, f, g, lambda rest: self._s * solve(self._s * rest))
        times = lambda z: np.concatenate([self.M @ z[:n] + self.columns @ z[n:], self.G @ z[:n]])  # noqa: E731
        A = spl.LinearOperator((size, size), matvec=times, dtype=float)
        P = spl.LinearOperator((size, size), matvec=lambda r: self.soft(r[:n], r[n:]), dtype=float)

        def improve(rest: Array) -> Array:
            z: Array = spl.gmres(A, rest, M=P, rtol=1e-10, atol=0.0, restart=100, maxiter=3)[0]
            return z

        return self.refined(self.M, f, g, improve)

    def redundancies(self) -> Array:
        """Basis (m, r) of the multipliers that have no effect, by inverse iteration with a random block."""

        import scipy.sparse as sp

        n, m = len(self.coordinates), len(self.multipliers)
        if m == 0:
            return np.zeros((0, 0))
        random, k = np.random.default_rng(0), min(4, m)

        def soften(X: Array) -> Array:
            z: Array = -self._solve(np.vstack([np.zeros((n, X.shape[1])), X]))[n:]
            return z

        G = sp.diags_array(self._s[n:]) @ self.G @ sp.diags_array(self._s[:n])
        while True:
            X = np.linalg.qr(random.standard_normal((m, k)))[0]
            for _ in range(3):
                X = np.linalg.qr(soften(X))[0]
            _, length, V = np.linalg.svd(G.T @ X, full_matrices=False)
            null = length < REDUNDANT
            if null.sum() < k or k == m:
                basis: Array = self._s[n:, None] * (X @ V.T[:, null])
                return basis
            k = min(2 * k, m)


def by_complement(K: sp.csc_array, n: int) -> Callable[[Array], Array]:
    """Solution by the Schur complement of the first n equations, which are diagonal among themselves.

    Many constraints, the pressures of a flow in space for instance, fill much less that way.
    """

    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    inverse = 1 / K.diagonal()[:n]
    G, columns = K[n:, :n].tocsr(), K[:n, n:]
    left = (K[n:, n:] - G @ sp.diags_array(inverse) @ columns).tocsc()
    lu = spl.splu(left, permc_spec="MMD_AT_PLUS_A", options={"Equil": False, "SymmetricMode": True})

    def solve(r: Array) -> Array:
        weight = inverse.reshape(-1, *[1] * (r.ndim - 1))
        mu = lu.solve(r[n:] - G @ (weight * r[:n]))
        return np.concatenate([weight * (r[:n] - columns @ mu), mu])

    return solve


def difference(f: Callable[[float], Array], d: float) -> Array:
    """Derivative at 0 by five points."""
    return (8 * (f(d) - f(-d)) - (f(2 * d) - f(-2 * d))) / (12 * d)
