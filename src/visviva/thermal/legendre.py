"""Internal energies of strains and entropy from free energies of strains and temperature, given by Python functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.model.callback import Function

Array = NDArray[np.float64]
STEP = 1e-40


class Internal:
    """The Legendre transform ``e(z, s) = psi(z, T) + T s`` with the temperature where ``-dpsi/dT = s``.

    Parameters
    ----------
    free : callable
        ``psi(z, T)`` of strains (n_e, n) and temperatures (n,), with values (n,), that takes complex numbers.
    n_e : int
        Number of strains.
    reference : float
        A temperature that it holds at.
    shift : array (n_e,), optional
        What strains of the core lack of those of `free`.
    """

    def __init__(
        self, free: Callable[[Any, Any], Any], n_e: int, reference: float, label: str, shift: Any = 0.0
    ) -> None:
        self.free, self.n_e, self.reference, self.label = free, n_e, reference, label
        self.shift = np.broadcast_to(np.asarray(shift, dtype=float), (n_e,))[:, None]

    def by_temperature(self, z: Array, T: Array) -> tuple[Array, Array]:
        """First and second derivative (n,) of the free energy by the temperature."""

        def first(T: Array) -> Array:
            return np.asarray(np.asarray(self.free(z, T + STEP * 1j)).imag / STEP)

        d = 1e-4 * T
        return first(T), (first(T + d) - first(T - d)) / (2 * d)

    def entropy(self, z: Array, T: Array) -> Array:
        """Entropies (n,)."""
        return -self.by_temperature(z, T)[0]

    def capacity(self, z: Array, T: Array) -> Array:
        """Heat capacities (n,) at constant strain."""
        return np.asarray(-T * self.by_temperature(z, T)[1])

    def temperature(self, z: Array, s: Array) -> Array:
        """Temperatures (n,) at entropies (n,), by Newton's method in their logarithm."""
        T = np.full(len(s), float(self.reference))
        for _ in range(60):
            first, second = self.by_temperature(z, T)
            step = np.clip((first + s) / (T * second), -1, 1)
            T = T * np.exp(-step)
            if not np.any(np.abs(step) > 3e-15):
                break
        return T

    def energy(self, rest: Array | None = None) -> Function:
        """Internal energy of strains of the core and entropy; its first derivatives need none of the temperature.

        Its capacity at strains `rest` (n_e, 1) of `free`, those of the core at zero by default, is a size of entropies.
        """

        def internal(e: Any) -> Any:
            z = e[: self.n_e] + self.shift
            T = self.temperature(np.real(z), np.real(e[self.n_e]))
            return self.free(z, T + 0 * e[self.n_e]) + T * e[self.n_e]

        rest = np.zeros((self.n_e, 1)) + self.shift if rest is None else rest
        capacity = np.abs(self.capacity(rest, np.array([self.reference])))
        sizes, origin = np.append(np.ones(self.n_e), capacity), np.append(self.shift, 0.0)
        return Function(internal, self.n_e + 1, 1, self.label, sizes, origin)
