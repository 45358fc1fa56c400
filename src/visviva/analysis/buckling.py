"""Linear buckling: load parameters at which the stiffness along the path of equilibria becomes singular."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.analysis.factors import factored
from visviva.analysis.linearized import (
    refuse_first_order,
    refuse_softening,
    refuse_unfit,
    refuse_unsymmetric,
    symmetric,
)
from visviva.analysis.multiples import completed
from visviva.analysis.shapes import Shapes
from visviva.base.arguments import positive, whole
from visviva.base.errors import InputError, RunError
from visviva.component.component import refuse_changed
from visviva.scheme.schemes import load_step
from visviva.system.agreement import refuse_different_arguments
from visviva.system.freedom import refuse_free
from visviva.system.growing import growing_unknowns, refuse_growth
from visviva.system.instant import COMPLIANCE, difference
from visviva.system.memory import returning, undisturbed
from visviva.system.scaling import equilibration
from visviva.system.stability import bears
from visviva.system.steps import next_kink

if TYPE_CHECKING:
    import scipy.sparse as sp

    from visviva.system.system import System

Array = NDArray[np.float64]

AHEAD = 1e-3
"""Distance, relative to the size of the model, over which the path is followed for the rate of the stiffness."""
TOUCHING = 1e-6
"""The same where something touches, which is to go on doing so."""
MORE = 1e-3
"""Change of reactions for the rate of the stiffness where something touches."""
LATER, CLOSER, TRIALS = 1e-3, 0.1234, 8
"""Change of the load parameter, relative to it and 1, for the rate of loads: the first one, and how others follow."""
AGREED, DISPUTED = 1e-6, 1e-2
"""Rates of loads over two changes that differ by less, relative to them, need no third, and by more are none."""
SOFT = (
    "bodies are held as a whole, so either the load is critical already, or this is softer than rounding of what is "
    "stiff beside it, as a wire is in bending whose length is a million times its thickness: make it thicker or "
    "shorter, and scale the factors of slender bars with the fourth power of their thickness"
)
ROUNDING = 2e-15
"""Changes of the tangent by loads are zero that are smaller than this, where its diagonal is scaled to 1."""
REAL = 1e-6
"""Imaginary part, relative to its size, up to which a root is real."""
SURE = 1e-3
"""How far a factor may be from the Rayleigh quotient of its vector: what is farther is rounding of infinite ones."""


@dataclass
class Buckling(Shapes):
    """Critical load parameters, those nearest to the present one first; print it for a table.

    Attributes
    ----------
    system : System
        With the configuration that they are about.
    factors : array (k,)
        Load parameters (times). From an unloaded state under loads with ``times="t"`` they are the factors by which
        these loads are multiplied.
    shapes : array (k, unknowns)
        Directions in which the structure then gives way; the largest move relative to the scales of unknowns is 1.
    """

    factors: Array

    def __str__(self) -> str:
        lines = [" mode   load parameter   moves most"]
        lines += [f"{k + 1:5d}{f:17.9g}   {self.leader(k)}" for k, f in enumerate(self.factors)]
        return "\n".join(lines)


def buckling(system: System, n: int = 6, *, tolerance: float = 1e-6) -> Buckling:
    """Linear buckling about the present configuration, which must be an equilibrium.

    Time is the load parameter: from its present value t on the equilibrium moves by ``u' s`` with the loads that grow
    with time, and the stiffness becomes ``K(t) + s K'``. Factors are the ``t + s`` at which that is singular.

    Parameters
    ----------
    n : int
        How many factors at most, those nearest to the present load parameter, on both sides of it.
    tolerance : float
        How far the configuration may be from equilibrium, relative to the size of the model. Damage may be 0.01 from
        its balance, or this if it is more.

    Returns
    -------
    Buckling
        Factors and shapes.

    Raises
    ------
    InputError
        If the configuration is no equilibrium, no load begins to grow with time, or forces have no potential; the
        message names it.
    RunError
        If the factors were not found.

    Notes
    -----
    K' is the geometric stiffness of the rates of stresses and of reactions in the present configuration: what the
    structure deforms on the way is neglected, as in the classical theory. Where that is much (arches, caps), go close
    to the critical load with `quasi_static` first: factors are exact where the stiffness becomes singular.

    Loads grow as they do just after t. Where all begin with no slope, as ``times="t**2"`` and the centrifugal forces of
    a frame with ``times="t"`` do from 0, there is no K': go to a t where they grow first.

    Contact counts as it is, as in `modes`. Damages that rest stay as they are. Refused by name are damages that grow
    with the loads or follow a history field, follower loads and what else has no potential, fields of first order in
    time, and what nothing holds.

    Examples
    --------
    A rigid bar on a spherical hinge, held at its top by springs k across: it falls over under ``k l``.

    >>> import visviva as vv
    >>> ground, top = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, 2))
    >>> bar = vv.Distance(a=ground.point(), b=top.point())
    >>> feet = (ground.point((-1, 0, 2)), 3.0), (ground.point((0, -1, 2)), 5.0)
    >>> springs = [vv.Spring(a=foot, b=top.point(), stiffness=k) for foot, k in feet]
    >>> press = vv.Force(on=top, force=(0, 0, -1), times="t")
    >>> vv.buckling(vv.System([ground, top, bar, *springs, press]), n=2).factors.round(9).tolist()
    [6.0, 10.0]
    """
    from visviva.system.system import refuse_no_system

    refuse_no_system("buckling", system)
    refuse_changed(system)
    whole("buckling", "n", n)
    positive("buckling", "tolerance", tolerance)
    refuse_different_arguments("buckling", n=n, tolerance=tolerance)
    refuse_first_order("buckling", system)
    refuse_free(system)
    refuse_unfit("buckling", system)
    refuse_softening("buckling", system)
    with undisturbed(system):
        tangent = balanced(system, tolerance)
        loads = load_rates(tangent)
        path = loads.prescribed - tangent.solve(loads.residual)
        rate = stiffness_rate(tangent, path, loads)
        factors, z = critical(tangent, rate, n)
    shapes = np.zeros((len(factors), len(system.x)))
    shapes[:, tangent.unknowns] = z.T
    largest_move = np.abs(shapes * np.where(system.order > 0, system.inverse_scale, 0.0)).max(
        axis=1, initial=0.0
    )
    return Buckling(system, shapes / largest_move[:, None], factors + system.time)


@dataclass
class Tangent:
    """The factored tangent (n, n) of the free unknowns at the present state; what stands for forces comes last."""

    system: System
    places: NDArray[np.int64] = field(init=False)
    A: sp.csr_array = field(init=False)

    def __post_init__(self) -> None:
        import scipy.sparse as sp

        system, free = self.system, self.system.free_unknowns
        kept, forces = np.flatnonzero(~growing_unknowns(system)[free]), bears(system)[free]
        self.places = kept[np.argsort(forces[kept], kind="stable")]
        self.unknowns, m = free[self.places], int(forces.sum())
        self.A = self.of(load_step(system.time, 0.0))
        refuse_unsymmetric("buckling", system, self.A, self.unknowns)
        self.scale = equilibration(symmetric(self.A), system.scale[self.unknowns])
        S = sp.diags_array(self.scale)
        soft = sp.diags_array(np.r_[np.zeros(len(kept) - m), np.full(m, COMPLIANCE)])
        scaled = S @ symmetric(self.A) @ S - soft
        self._solve = factored(scaled, m, system, self.unknowns, "buckling", SOFT)

    def of(self, step: Any) -> sp.csr_array:
        """The tangent at the end of a step, by the increments that are tried."""
        return self.system.tangent(step)[1][self.places][:, self.places].tocsr()

    def solve(self, r: Array) -> Array:
        """Solution (n,) in free unknowns of equations whose right-hand side is that of all unknowns."""
        r, z = r[self.unknowns], np.zeros(len(self.unknowns))
        for _ in range(3):  # takes off the effect of the compliance of constraints
            z += self.scale * self._solve(self.scale * (r - self.A @ z))
        full = np.zeros(len(self.system.x))
        full[self.unknowns] = z
        return full

    def scaled(self, z: Array) -> Array:
        """Solution of the equations in scaled unknowns."""
        return self._solve(z)


def balanced(system: System, tolerance: float) -> Tangent:
    """The tangent of the present equilibrium, in which what stands for forces gets its static values."""
    step, forces = load_step(system.time, 0.0), system.order == 0
    refuse_growth("buckling", system, tolerance)
    for _ in range(2):  # reactions decide on the stiffness, too
        tangent = Tangent(system)
        d = -tangent.solve(system.residual(step))
        moves = np.where(forces, 0.0, np.abs(d * system.inverse_scale))
        if moves.max(initial=0.0) > tolerance:
            k = int(np.argmax(moves))
            component, unknown = system.describe(k)
            raise InputError(
                f"buckling: the present configuration is no equilibrium: {unknown} of {component} would move by "
                f"{d[k]:.3g}; call vv.quasi_static or vv.equilibrium first"
            )
        system.x[forces] += d[forces]
        system.invalidate()
    return Tangent(system)


@dataclass(frozen=True)
class LoadRates:
    """Rates by the load parameter of residuals (n,), of prescribed unknowns (n,) and of the tangent in place.

    Those of the tangent are known up to a `rounding`, where its diagonal is scaled to 1.
    """

    residual: Array
    prescribed: Array
    tangent: sp.csr_array
    rounding: float


def load_rates(tangent: Tangent) -> LoadRates:
    """Rates just after now: loads may have kinks here and further on, and may not be defined before."""
    system = tangent.system
    now, dx = system.time, system.core.dx
    span = LATER * max(abs(now), 1.0)
    far = 0.5 * (next_kink(system, now + 2 * span) - now)

    def loads(d: float) -> Array:
        step = load_step(now, d)
        system.prescribe(step)
        found = np.array([system.residual(step), dx])
        dx[:] = 0.0
        return found

    def tangents(d: float) -> Array:
        data: Array = tangent.of(load_step(now, d)).data
        return data[None]

    (residual, prescribed), d, grows = onset(loads, far)
    if grows:
        data = slope(tangents, d)
    else:  # loads that only stiffen or soften
        data, d, grows = onset(tangents, far)
    if not grows:
        raise InputError(
            f"buckling: no load grows from the load parameter {now:g} on at a rate that could be told; let one grow "
            "with time, times='t', or where loads begin with no slope, as 't**2' and centrifugal forces do from 0, go "
            "to where they grow first: vv.quasi_static(system, until=...)"
        )
    by_loads, scale = tangent.A.tocoo(), tangent.scale
    noise = ROUNDING / (d * scale[by_loads.row] * scale[by_loads.col])
    by_loads.data = np.where(np.abs(data[0]) > noise, data[0], 0.0)
    return LoadRates(residual, prescribed, by_loads.tocsr(), ROUNDING / d)


def slope(f: Callable[[float], Array], d: float) -> Array:
    """Rate just after 0 of rows of functions by three points; zero where it is rounding beside their change."""
    start = f(0.0)
    one, two = f(d) - start, f(2 * d) - start
    rate: Array = (4 * one - two) / (2 * d)
    rate[np.abs(rate).max(axis=1) * d <= AGREED * np.abs(two).max(axis=1)] = 0.0
    return rate


def onset(f: Callable[[float], Array], far: float) -> tuple[Array, float, bool]:
    """Rate (r, n) just after 0 of rows of functions, over which distance it was found, and whether there is one.

    Of several distances, `far` the largest, that is taken which agrees best with the next: nearer than kinks that are
    not known.
    """
    d, rate, best = far, slope(f, far), (np.inf, f(0.0), far)
    for _ in range(TRIALS):
        closer = slope(f, CLOSER * d)
        size = np.maximum(np.abs(rate).max(axis=1), np.abs(closer).max(axis=1))
        misfit = float((np.abs(closer - rate).max(axis=1) / np.where(size > 0, size, 1.0)).max())
        if misfit < best[0]:
            best = misfit, rate, d
        if misfit <= AGREED:
            break
        d, rate = CLOSER * d, closer
    misfit, rate, d = best
    return rate, d, misfit <= DISPUTED and bool(rate.any())


def stiffness_rate(tangent: Tangent, rate: Array, loads: LoadRates) -> sp.csr_array:
    """Derivative of the tangent along a rate of all unknowns, by the stresses, by the reactions and by the loads.

    The discrete gradient takes stresses from both ends of a step and directions from its end alone if that is where
    strains are varied. A step that ends at the present state and starts ``a u'`` before it has the present geometry,
    half of the present stresses, and half of those ``a`` ago.
    """
    system = tangent.system
    core, now, forces = system.core, system.time, bears(system)
    moves, reactions = np.where(forces, 0.0, rate), np.where(forces, rate, 0.0)
    present = system.x.copy()

    def stressed(a: float) -> Any:
        system.x[:] = present - a * moves
        core.dx[:] = a * moves
        return tangent.of(energetic_step(now))

    def reacted(a: float) -> Any:
        core.dx[:] = a * reactions
        return tangent.of(load_step(now, 0.0))

    touches = any(c.touches for c in system.components)
    size = float(np.abs(moves * system.inverse_scale).max(initial=0.0))
    largest, force = abs(tangent.A).max(), float(np.abs(reactions).max(initial=0.0))
    with returning(system):
        by_stress: Any = difference(stressed, (TOUCHING if touches else AHEAD) / (size or 1.0))
    with returning(system):  # linear: far enough for them to count beside the stiffness
        by_reactions: Any = difference(reacted, MORE if touches else AHEAD * largest / (force or 1.0))
    refuse_following(tangent, loads)
    found: sp.csr_array = (loads.tangent + by_reactions - 2 * by_stress).tocsr()
    return found


def refuse_following(tangent: Tangent, loads: LoadRates) -> None:
    """Refuse loads without potential, in the units of the stiffness: unknowns may see loads in their columns alone."""
    import scipy.sparse as sp

    S = sp.diags_array(tangent.scale)
    found = abs(S @ (loads.tangent - loads.tangent.T) @ S).tocoo()
    found.data = np.maximum(found.data - loads.rounding, 0.0) / (abs(S @ loads.tangent @ S).max() or 1.0)
    if found.nnz:
        k = int(np.argmax(found.data))
        lack = float(found.data[k]), int(found.row[k])
        refuse_unsymmetric("buckling", tangent.system, loads.tangent, tangent.unknowns, lack)


def energetic_step(time: float) -> _core.Step:
    """A load step of no length whose stresses are discrete gradients."""
    rest = np.zeros((5, 4))
    return _core.Step(time, 0.0, time, 1.0, 1.0, True, rest, rest, False)


def critical(tangent: Tangent, rate: sp.csr_array, n: int) -> tuple[Array, Array]:
    """Changes s (k,) of the load parameter nearest to 0 at which ``A + s A'`` is singular, and vectors (., k)."""
    import scipy.sparse as sp
    import scipy.sparse.linalg as spl

    S = sp.diags_array(tangent.scale)
    A, rate = S @ symmetric(tangent.A) @ S, symmetric(S @ rate @ S)
    times = lambda z: -tangent.scaled(rate @ np.ravel(z))  # noqa: E731

    random = np.random.default_rng(0)

    def nearest(operator: Any, n: int = 4) -> tuple[Array, Array]:
        inverse, z = real_pairs(*largest(operator, n, random.standard_normal(len(tangent.scale))))
        s = -(z * (A @ z)).sum(axis=0) / (z * (rate @ z)).sum(axis=0)
        sure = np.abs(s * inverse - 1) <= SURE
        return s[sure], z[:, sure]

    operator = spl.LinearOperator(A.shape, matvec=times, dtype=float)
    s, z = nearest(operator, 2 * n + 4)
    order = np.argsort(np.abs(s))[:n]
    s, z = completed(operator, s[order], z[:, order], rate, np.abs, nearest)
    return s, tangent.scale[:, None] * z


def largest(operator: Any, n: int, start: Array) -> tuple[NDArray[Any], NDArray[Any]]:
    """Eigenvalues of largest size and their vectors; all of small operators.

    Each search has a `start` of its own: the same one has no part in the copies that the first left out.
    """
    import scipy.sparse.linalg as spl

    size = operator.shape[0]
    if n >= size - 2:
        values, vectors = np.linalg.eig(operator @ np.eye(size))
        return values, vectors
    try:
        values, vectors = spl.eigs(operator, k=n, which="LM", v0=start)
    except spl.ArpackError as error:
        raise RunError(f"buckling: the lowest {n} factors were not found; ask for fewer") from error
    return values, vectors


def real_pairs(values: NDArray[Any], vectors: NDArray[Any]) -> tuple[Array, Array]:
    """Eigenvalues (j,) of those (k,) that are real and not zero, with real vectors (n, j).

    Rounding makes pairs with conjugate vectors of double ones: both parts of these are vectors.
    """
    real = (np.abs(values.imag) <= REAL * np.abs(values)) & (np.abs(values) > 0)
    return values.real[real], np.where(values.imag < 0, vectors.imag, vectors.real)[:, real]
