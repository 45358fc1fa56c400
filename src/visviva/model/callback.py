"""Energies and constraints given as functions of the user: stresses, tangents and discrete gradients follow.

A function takes strains (n_e, n), one column per element, and returns one value per column; it is called with
any number of columns, so what differs between elements has to come in as a strain (a constant form will do).
First derivatives come from the complex step (exact to round-off) where values nearby agree with it, else from central
differences; second derivatives from central differences of the first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NotFinite, RunError, apart, named

Array = NDArray[np.float64]
LawCallback = Callable[..., None]

COMPLEX_STEP = 1e-40
RELATIVE_STEP = 6e-6  # about the cube root of the rounding unit: best for central differences
# Below these relative changes of the strains the energy error of the plain midpoint is under round-off; the
# second is for first derivatives from differences, whose rounding leaves less to gain from a correction.
TINY, TINY_DIFFERENCES = 1e-8, 1e-5
# Part of the strains by which values nearby are looked at, and rounding of these.
PROBE, NOISE = 1e-3, 1.5e-14
# Below this ratio of second to first differences of the stress, Simpson's rule is exact to round-off.
SMOOTH = 1e-4
# Part of an energy, or of what its derivatives say it has changed by where it counts from, that is its rounding.
ROUNDING = 4e-16


class Function:
    """A user's function of strains (n_e, n) with m values (m, n), and its derivatives.

    Parameters
    ----------
    function : callable
        Maps strains (n_e, n) to values (m, n); for m = 1 also to (n,).
    n_e, m : int
        Numbers of strains and values per element.
    label : str
        Whose function it is, for error messages.
    sizes : array (n_e,), optional
        Large changes of the strains, by which those of different units are weighed against each other, and differences
        told from rounding where strains vanish; 1 each if left out.
    origin : array (n_e,), optional
        What the function adds to its strains before it does anything else, 1 to those that count from C = I: what it
        sees then, and rounds, is never as small as they are. 0 each if left out.
    """

    def __init__(
        self,
        function: Callable[[Any], Any],
        n_e: int,
        m: int,
        label: str,
        sizes: Array | None = None,
        origin: Array | None = None,
    ) -> None:
        self.function, self.n_e, self.m, self.label = function, n_e, m, label
        self.sizes, self.origin = (
            np.full((n_e, 1), default) if given is None else np.asarray(given, dtype=float).reshape(n_e, 1)
            for given, default in ((sizes, 1.0), (origin, 0.0))
        )
        self._refuses_complex = False

    def raw(self, e: Any) -> NDArray[Any]:
        """The function's values (m, n), shape checked."""
        n = e.shape[1]
        # also called for shown fields, by each process for its own elements
        with apart(f"{self.label}: it"), named(f"{self.label}: it"):
            f = np.asarray(self.function(e))
        if f.shape not in ((self.m, n), (n,) if self.m == 1 else (self.m, n)):
            expected = f"({n},)" if self.m == 1 else f"({self.m}, {n})"
            raise RunError(
                f"{self.label}: it returned shape {f.shape} for strains {e.shape}, expected {expected}"
            )
        return f.reshape(self.m, n)

    def settled(self, e: Array) -> Array:
        """Strains (n_e, n) at which it is taken where `e` is given."""
        return e

    def value(self, e: Array) -> Array:
        """Values (m, n)."""
        f = np.asarray(self.raw(e), dtype=float)
        if not np.all(np.isfinite(f)):
            k = int(np.argmin(np.isfinite(f).all(axis=0)))
            raise NotFinite(f"{self.label}: it returned {f[:, k].tolist()} at the strains {e[:, k].tolist()}")
        return f

    def takes_complex(self, e: Array) -> NDArray[np.bool_]:
        """Whether the complex step holds (n,): asked at every point, as functions branch."""
        return self.checked_gradient(e)[1]

    def gradient(self, e: Array) -> Array:
        """First derivatives (m, n_e, n)."""
        return self.checked_gradient(e)[0]

    def checked_gradient(self, e: Array) -> tuple[Array, NDArray[np.bool_]]:
        """First derivatives, and whether they are by the complex step (n,); where it misleads, by differences.

        Nothing is remembered of what it did elsewhere, so that runs go on alike after restarts and looks.
        """
        found = None if self._refuses_complex else self._by_complex_step(e)
        if found is None:
            g = self._difference_gradient(e)  # which raises where the function does not hold here at all
            self._refuses_complex = True
            return g, np.zeros(e.shape[1], dtype=bool)
        g, holds = found
        if not holds.all():
            g[:, :, ~holds] = self._difference_gradient(e[:, ~holds])
        return g, holds

    def _by_complex_step(self, e: Array) -> tuple[Array, NDArray[np.bool_]] | None:
        """Gradients by the complex step, and whether values nearby agree; None if it refuses complex numbers."""
        with np.errstate(all="ignore"):
            try:
                return self._probed_gradient(e)
            except RunError:  # perhaps of a point nearby that is not in its domain
                pass
            try:
                return self._complex_gradient(e), np.ones(e.shape[1], dtype=bool)
            except RunError:
                return None

    def _complex_gradient(self, e: Array) -> Array:
        return np.asarray(self.raw(stepped(e)).imag.reshape(self.m, self.n_e, -1) / COMPLEX_STEP)

    def _probed_gradient(self, e: Array) -> tuple[Array, NDArray[np.bool_]]:
        """The complex step, and whether values on both sides of a point differ by what it says (n,).

        Absolute values, norms and real parts give complex numbers no derivative. Along one direction Simpson's rule
        in the derivatives gives the difference of values, up to a kink, which shows in their second difference, and
        to rounding. One call of the function does, and points that cannot be taken tell nothing.
        """
        n, probe = e.shape[1], probes(e + self.origin, self.sizes)
        sides = [e + sign * probe + 1j * COMPLEX_STEP * probe for sign in (1, -1)]
        f = self.raw(np.concatenate([stepped(e), *sides], axis=1))
        g = f[:, : -2 * n].imag.reshape(self.m, self.n_e, n) / COMPLEX_STEP
        after, before = f[:, -2 * n : -n], f[:, -n:]
        slopes = after.imag / COMPLEX_STEP, np.einsum("min,in->mn", g, probe), before.imag / COMPLEX_STEP
        said = (slopes[0] + 4 * slopes[1] + slopes[2]) / 3
        seen = after.real - before.real
        kink = np.abs(slopes[0] - 2 * slopes[1] + slopes[2])
        size = np.abs(after.real) + np.abs(before.real) + np.abs(slopes[0] - slopes[2]) / PROBE**2
        size += (np.abs(slopes[0]) + np.abs(slopes[2])) / PROBE + (np.abs(g) * self.sizes).max(axis=1)
        allowed = kink + 1e-6 * np.maximum(np.abs(said), np.abs(seen)) + NOISE * size
        return g, ~(np.abs(said - seen) > allowed).any(axis=0)

    def _difference_gradient(self, e: Array) -> Array:
        points, distance = neighbours(e, self.sizes, self.origin)
        f = self.value(points.reshape(self.n_e, -1)).reshape(self.m, 2, self.n_e, -1)
        return (f[:, 0] - f[:, 1]) / distance

    def hessian(self, e: Array, holds: NDArray[np.bool_] | None = None) -> Array:
        """Second derivatives (m, n_e, n_e, n); where the complex step `holds`, from first ones that are exact."""
        if holds is None:
            holds = self.takes_complex(e)
        H = np.empty((self.m, self.n_e, self.n_e, e.shape[1]))
        for there, gradient, stretch in (
            (holds, self._complex_gradient, 1.0),
            (~holds, self._difference_gradient, 20.0),
        ):
            if there.any():
                points, distance = neighbours(e[:, there], self.sizes, self.origin, stretch)
                g = gradient(points.reshape(self.n_e, -1)).reshape(self.m, self.n_e, 2, self.n_e, -1)
                H[..., there] = (g[:, :, 0] - g[:, :, 1]) / distance
        return 0.5 * (H + H.swapaxes(1, 2))

    def discrete_gradient(self, e0: Array, e1: Array, want_tangent: bool) -> tuple[Array, Array | None]:
        """``S`` with ``S . (e1 - e0) = f(e1) - f(e0)`` (Gonzalez 1996), and its derivative by `e1`.

        ``S = f'(em) + b M de / (de . M de)`` with the bracket ``b = df - f'(em) . de`` and ``M`` the inverse squares of
        `sizes`, so that no unit of a strain decides how ``b`` is shared. As a difference of values ``b`` drowns in
        rounding for small ``de``; there it is Simpson's rule in the gradients, whose rounding shrinks with ``de``, and
        finally nothing. Either changes the energy by less than round-off.
        """
        de, em = e1 - e0, 0.5 * (e0 + e1)
        # one call of the user's function for all points: a call costs more than what it computes
        g, holds = self.checked_gradient(np.concatenate([e0, em, e1], axis=1))
        g0, gm, g1 = np.split(g, 3, axis=2)
        at_middle, analytic = np.split(holds, 3)[1], np.all(np.split(holds, 3), axis=0)
        f0, f1 = np.split(self.value(np.concatenate([e0, e1], axis=1)), 2, axis=1)
        first, second = (g1 - g0) * de, (g0 - 2 * gm + g1) * de
        exact = f1 - f0 - (gm * de).sum(axis=1)
        bend, simpson = np.abs(second).sum(axis=1), second.sum(axis=1) / 6
        smooth = bend <= SMOOTH * (bends := np.abs(first).sum(axis=1))
        held = np.maximum(np.abs(f0) + np.abs(f1), (np.abs(gm) * self.sizes).max(axis=1))
        smooth |= (
            np.abs(simpson) * bend**2 <= ROUNDING * held * bends**2
        )  # what it leaves out is below rounding
        b = np.where(smooth & analytic, simpson, exact)
        seen = np.maximum(np.abs(e0 + self.origin), np.abs(e1 + self.origin))
        size = (seen * (de != 0) / self.sizes).max(axis=0)
        few = np.where(analytic, TINY, TINY_DIFFERENCES)
        tiny = np.abs(de / self.sizes).max(axis=0) <= few * size
        metric = self.sizes**-2.0
        along = metric * de
        inverse = np.where(tiny, 0.0, 1 / np.where(tiny, 1.0, (de * along).sum(axis=0)))
        c = b * inverse
        S = gm + c[:, None] * along
        if not want_tangent:
            return S, None
        half = 0.5 * self.hessian(em, at_middle)
        db = g1 - gm - np.einsum("mijn,jn->min", half, de) - 2 * c[:, None] * along
        D = half + np.einsum("in,mjn->mijn", along * inverse, db)
        return S, D + c[:, None, None] * (metric * np.eye(self.n_e))[:, :, None]


class AcrossFree(Function):
    """An energy of C (6, n) in plane stress: ``W*(C11, C22, C12)``, the least of ``W(C)`` over C33."""

    def __init__(
        self, function: Callable[[Any], Any], n_e: int, m: int, label: str, sizes: Array | None = None
    ) -> None:
        super().__init__(function, n_e, m, label, sizes)
        self.inner = Function(function, n_e, m, label, sizes)

    def settled(self, C: Array) -> Array:
        """``C`` with the C33 that leaves no stress across the plane, by Newton's method in ln C33."""
        C = C.copy()
        C[2] = 1 / (C[0] * C[1] - C[3] ** 2)  # no change of volume
        s = 1e-5
        for _ in range(60):
            near = [C * np.where(np.arange(6) == 2, factor, 1.0)[:, None] for factor in (1 - s, 1, 1 + s)]
            stress = self.inner.gradient(np.concatenate(near, axis=1))[0, 2] * np.concatenate(near, axis=1)[2]
            less, here, more = np.split(stress, 3)
            slope = np.maximum((more - less) / (2 * s), np.abs(here))
            dy = -here / np.where(slope > 0, slope, 1.0)  # downhill, by a factor e at most
            C[2] *= np.exp(dy)
            if not np.abs(dy).max(initial=0.0) >= 1e-8:
                break
        return C

    def value(self, e: Array) -> Array:
        return self.inner.value(self.settled(e))

    def checked_gradient(self, e: Array) -> tuple[Array, NDArray[np.bool_]]:
        g, holds = self.inner.checked_gradient(self.settled(e))
        return without_third(g), holds

    def _complex_gradient(self, e: Array) -> Array:
        return without_third(self.inner._complex_gradient(self.settled(e)))

    def _difference_gradient(self, e: Array) -> Array:
        return without_third(self.inner._difference_gradient(self.settled(e)))


def without_third(g: Array) -> Array:
    """Derivatives by C, of which those by C33 vanish."""
    g[:, 2] = 0.0
    return g


def stepped(e: Array) -> NDArray[np.complex128]:
    """Strains (n_e, n_e * n), each with an imaginary step."""
    z = np.repeat(e[:, None, :], len(e), axis=1).astype(complex)
    z += 1j * COMPLEX_STEP * np.eye(len(e))[:, :, None]
    return z.reshape(len(e), -1)


def probes(e: Array, sizes: Array) -> Array:
    """Points (n_e, n) at which the complex step is judged: a little along strains, by shares that nothing else has."""
    share = 1 - 0.5 * np.modf(0.618034 * np.arange(len(e)))[0]
    size = np.maximum(np.abs(e), 0.1 * sizes * np.abs(e / sizes).max(axis=0))
    along: Array = PROBE * share[:, None] * np.copysign(size, e)
    return along


def neighbours(e: Array, sizes: Array, origin: Array, stretch: float = 1.0) -> tuple[Array, Array]:
    """Both points of a central difference in every strain (n_e, 2, n_e, n), and their distances (n_e, n).

    Strains whose large changes are `sizes` (n_e, 1) may be of different units; they count from `origin` (n_e, 1).
    """
    seen = np.abs(e + origin)
    size = sizes * np.maximum(0.1 * (seen / sizes).max(axis=0), 1e-3)
    step = stretch * RELATIVE_STEP * np.maximum(seen, size)
    moved = np.eye(len(e))[:, :, None] * step
    points = e[:, None, None, :] + np.stack([moved, -moved], axis=1)
    distance = np.einsum("jjn->jn", points[:, 0] - points[:, 1])
    return points, distance


def energy_callback(
    energy: Callable[[Any], Any], n_e: int, label: str = "user energy", sizes: Array | None = None
) -> LawCallback:
    """The core's callback for an energy ``W(e)``, given as a function of strains (n_e, n) with values (n,).

    Examples
    --------
    >>> import numpy as np
    >>> from visviva.model.callback import Function
    >>> W = Function(lambda e: 0.5 * (np.sqrt(e[0]) - 1.0) ** 2, n_e=1, m=1, label="spring")
    >>> e0, e1 = np.array([[1.0]]), np.array([[4.0]])
    >>> S, _ = W.discrete_gradient(e0, e1, want_tangent=False)
    >>> round(float((S[0, 0] * (e1 - e0)).item()), 12)
    0.5
    """
    return callback_of(Function(energy, n_e, 1, label, sizes))


def callback_of(W: Function) -> LawCallback:
    """The core's callback for an energy with its derivatives."""

    def call(
        n: int, want_tangent: bool, t: float, h: float, discrete: bool, arrays: tuple[Array, ...]
    ) -> None:
        e0, e_eval, e1 = (a[:, :n] for a in arrays[:3])
        S, D, energies = arrays[5], arrays[6], arrays[11]
        energies[:, :n] = W.value(e1)
        if discrete:
            stress, tangent = W.discrete_gradient(e0, e1, want_tangent)
        else:
            stress, tangent = W.gradient(e_eval), W.hessian(e_eval) if want_tangent else None
        S[:, :n] = stress[0]
        if tangent is not None:
            D[:, :n] = tangent[0].reshape(W.n_e * W.n_e, n)

    return call


def constraint_callback(
    function: Callable[[Any], Any],
    n_e: int,
    n_m: int,
    label: str = "user constraint",
    sizes: Array | None = None,
) -> LawCallback:
    """The core's callback for constraints ``Phi(e) = 0``: strains (n_e, n) to values (n_m, n)."""
    Phi = Function(function, n_e, n_m, label, sizes)

    def call(
        n: int, want_tangent: bool, t: float, h: float, discrete: bool, arrays: tuple[Array, ...]
    ) -> None:
        e0, e_eval, e1, _, multipliers = (a[:, :n] for a in arrays[:5])
        D, values, J, Jt = arrays[6], arrays[8], arrays[9], arrays[10]
        values[:, :n] = Phi.value(e1)
        J[:, :n] = Phi.gradient(e1).reshape(n_m * n_e, n)
        if discrete:
            gradient, tangent = Phi.discrete_gradient(e0, e1, want_tangent)
        else:
            gradient, tangent = Phi.gradient(e_eval), Phi.hessian(e_eval) if want_tangent else None
        Jt[:, :n] = gradient.swapaxes(0, 1).reshape(n_e * n_m, n)
        if tangent is not None:
            D[:, :n] = np.einsum("mn,mijn->ijn", multipliers, tangent).reshape(n_e * n_e, n)

    return call


def rate_callback(
    stress: Callable[[float, Any, Any], Any],
    n_e: int,
    label: str = "user force",
    sizes: Array | None = None,
) -> LawCallback:
    """The core's callback for stresses ``S(t, e, de/dt)`` (n_e, n) of time, strains and rates (n_e, n)."""
    time = 0.0
    both = None if sizes is None else np.tile(sizes, 2)  # rates of one size in a unit of time
    S = Function(lambda z: stress(time, z[:n_e], z[n_e:]), 2 * n_e, n_e, label, both)

    def call(
        n: int, want_tangent: bool, t: float, h: float, discrete: bool, arrays: tuple[Array, ...]
    ) -> None:
        nonlocal time
        time = t
        z = np.concatenate([arrays[1][:, :n], arrays[3][:, :n]])
        arrays[5][:, :n] = S.value(z)
        if want_tangent:
            g = S.gradient(z)
            arrays[6][:, :n] = g[:, :n_e].reshape(n_e * n_e, n)
            arrays[7][:, :n] = g[:, n_e:].reshape(n_e * n_e, n)

    return call
