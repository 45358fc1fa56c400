"""Energies and constraints given as functions of the user: stresses, tangents and discrete gradients follow.

A function takes strains (n_e, n), one column per element, and returns one value per column; it is called with
any number of columns, so what differs between elements has to come in as a strain (a constant form will do).
First derivatives come from the complex step (exact to round-off) where the function allows complex arguments,
else from central differences; second derivatives from central differences of the first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import RunError, VisvivaError

Array = NDArray[np.float64]
LawCallback = Callable[..., None]

COMPLEX_STEP = 1e-40
RELATIVE_STEP = 6e-6  # about the cube root of the rounding unit: best for central differences
# Below these relative changes of the strains the energy error of the plain midpoint is under round-off; the
# second is for first derivatives from differences, whose rounding leaves less to gain from a correction.
TINY, TINY_DIFFERENCES = 1e-8, 1e-5
# Below this ratio of second to first differences of the stress, Simpson's rule is exact to round-off.
SMOOTH = 1e-4


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
    """

    def __init__(self, function: Callable[[Any], Any], n_e: int, m: int, label: str) -> None:
        self.function, self.n_e, self.m, self.label = function, n_e, m, label
        self._takes_complex: bool | None = None

    def raw(self, e: Any) -> NDArray[Any]:
        """The function's values (m, n), shape checked."""
        n = e.shape[1]
        try:
            f = np.asarray(self.function(e))
        except VisvivaError:
            raise
        except Exception as error:
            raise RunError(f"{self.label}: it raised {type(error).__name__}: {error}") from error
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
            raise RunError(f"{self.label}: it returned {f[:, k].tolist()} at the strains {e[:, k].tolist()}")
        return f

    def takes_complex(self, e: Array) -> bool:
        """Whether the complex step works; tried once, against differences near the first strains met."""
        if self._takes_complex is None:
            near = e + 0.01 * np.abs(e) + 1e-4
            with np.errstate(all="ignore"):
                try:
                    a, b = self._complex_gradient(near), self._difference_gradient(near)
                except (TypeError, ValueError, AttributeError, RunError):
                    a, b = np.zeros(1), np.ones(1)
                scale = np.abs(b).max()
                self._takes_complex = bool(np.abs(a - b).max() <= 1e-4 * scale)
        return self._takes_complex

    def gradient(self, e: Array) -> Array:
        """First derivatives (m, n_e, n)."""
        if self.takes_complex(e):
            return self._complex_gradient(e)
        return self._difference_gradient(e)

    def _complex_gradient(self, e: Array) -> Array:
        z = np.repeat(e[:, None, :], self.n_e, axis=1).astype(complex)
        z += 1j * COMPLEX_STEP * np.eye(self.n_e)[:, :, None]
        return self.raw(z.reshape(self.n_e, -1)).imag.reshape(self.m, self.n_e, -1) / COMPLEX_STEP

    def _difference_gradient(self, e: Array) -> Array:
        points, distance = neighbours(e)
        f = self.value(points.reshape(self.n_e, -1)).reshape(self.m, 2, self.n_e, -1)
        return (f[:, 0] - f[:, 1]) / distance

    def hessian(self, e: Array) -> Array:
        """Second derivatives (m, n_e, n_e, n)."""
        points, distance = neighbours(e, 1.0 if self.takes_complex(e) else 20.0)
        g = self.gradient(points.reshape(self.n_e, -1)).reshape(self.m, self.n_e, 2, self.n_e, -1)
        H = (g[:, :, 0] - g[:, :, 1]) / distance
        return 0.5 * (H + H.swapaxes(1, 2))

    def discrete_gradient(self, e0: Array, e1: Array, want_tangent: bool) -> tuple[Array, Array | None]:
        """``S`` with ``S . (e1 - e0) = f(e1) - f(e0)`` (Gonzalez 1996), and its derivative by `e1`.

        ``S = f'(em) + b / |de|^2 de`` with the bracket ``b = df - f'(em) . de``. As a difference of values
        ``b`` drowns in rounding for small ``de``; there it is Simpson's rule in the gradients, whose rounding
        shrinks with ``de``, and finally nothing. Either changes the energy by less than round-off.
        """
        de, em = e1 - e0, 0.5 * (e0 + e1)
        # one call of the user's function for all points: a call costs more than what it computes
        g0, gm, g1 = np.split(self.gradient(np.concatenate([e0, em, e1], axis=1)), 3, axis=2)
        f0, f1 = np.split(self.value(np.concatenate([e0, e1], axis=1)), 2, axis=1)
        first, second = (g1 - g0) * de, (g0 - 2 * gm + g1) * de
        exact = f1 - f0 - (gm * de).sum(axis=1)
        smooth = np.abs(second).sum(axis=1) <= SMOOTH * np.abs(first).sum(axis=1)
        analytic = self.takes_complex(em)
        b = np.where(smooth & analytic, second.sum(axis=1) / 6, exact)
        size = (np.maximum(np.abs(e0), np.abs(e1)) * (de != 0)).max(axis=0)
        tiny = np.abs(de).max(axis=0) <= (TINY if analytic else TINY_DIFFERENCES) * size
        inverse = np.where(tiny, 0.0, 1 / np.where(tiny, 1.0, (de * de).sum(axis=0)))
        c = b * inverse
        S = gm + c[:, None] * de
        if not want_tangent:
            return S, None
        half = 0.5 * self.hessian(em)
        db = g1 - gm - np.einsum("mijn,jn->min", half, de) - 2 * c[:, None] * de
        D = half + np.einsum("in,mjn->mijn", de * inverse, db)
        return S, D + c[:, None, None] * np.eye(self.n_e)[:, :, None]


class AcrossFree(Function):
    """An energy of C (6, n) in plane stress: ``W*(C11, C22, C12)``, the least of ``W(C)`` over C33."""

    def __init__(self, function: Callable[[Any], Any], n_e: int, m: int, label: str) -> None:
        super().__init__(function, n_e, m, label)
        self.inner = Function(function, n_e, m, label)

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

    def takes_complex(self, e: Array) -> bool:
        return self.inner.takes_complex(e)

    def value(self, e: Array) -> Array:
        return self.inner.value(self.settled(e))

    def gradient(self, e: Array) -> Array:
        g = self.inner.gradient(self.settled(e))
        g[:, 2] = 0.0
        return g


def neighbours(e: Array, stretch: float = 1.0) -> tuple[Array, Array]:
    """Both points of a central difference in every strain (n_e, 2, n_e, n), and their distances (n_e, n)."""
    size = np.maximum(0.1 * np.abs(e).max(axis=0), 1e-3)
    step = stretch * RELATIVE_STEP * np.maximum(np.abs(e), size)
    moved = np.eye(len(e))[:, :, None] * step
    points = e[:, None, None, :] + np.stack([moved, -moved], axis=1)
    distance = np.einsum("jjn->jn", points[:, 0] - points[:, 1])
    return points, distance


def energy_callback(energy: Callable[[Any], Any], n_e: int, label: str = "user energy") -> LawCallback:
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
    return callback_of(Function(energy, n_e, 1, label))


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
    function: Callable[[Any], Any], n_e: int, n_m: int, label: str = "user constraint"
) -> LawCallback:
    """The core's callback for constraints ``Phi(e) = 0``: strains (n_e, n) to values (n_m, n)."""
    Phi = Function(function, n_e, n_m, label)

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
    stress: Callable[[float, Any, Any], Any], n_e: int, label: str = "user force"
) -> LawCallback:
    """The core's callback for stresses ``S(t, e, de/dt)`` (n_e, n) of time, strains and rates (n_e, n)."""
    time = 0.0
    S = Function(lambda z: stress(time, z[:n_e], z[n_e:]), 2 * n_e, n_e, label)

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
