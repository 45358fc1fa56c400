"""Energies of the user with internal variables: what remembers, and loses energy.

An energy ``W(e, h)`` sees strains (n_e, n) and internal variables (n_h, n), a column per point; an update says where
the variables end up in a step. The discrete gradient is that of W in both, so that the energy lost in a step is exactly
``-D_h W . (h1 - h0)``, which the ledger books.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import NotFinite, RunError, named
from visviva.model.callback import Function, LawCallback

Array = NDArray[np.float64]
Update = Callable[[Any, Any, Any, float], Any]


class Evolving(Function):
    """An energy of strains and internal variables with the update of these.

    Parameters
    ----------
    energy : callable
        Maps strains (n_e, n) and internal variables (n_h, n) to energies (n,).
    update : callable
        Maps strains at the start and the end of a step (where schemes without discrete gradients evaluate stresses),
        variables at its start, and its length, which is positive, to variables (n_h, n) at its end. It may be called
        with any strains, and its results must follow from its arguments alone.
    n_e, n_h : int
        Numbers of strains and of internal variables per point.
    """

    def __init__(
        self, energy: Callable[[Any, Any], Any], update: Update, n_e: int, n_h: int, label: str
    ) -> None:
        super().__init__(lambda z: energy(z[:n_e], z[n_e:]), n_e + n_h, 1, label)
        self.update, self.n_strains, self.n_h = update, n_e, n_h

    def end(self, e0: Array, e1: Array, h0: Array, h: float) -> Array:
        """Internal variables (n_h, n) at the end of a step, checked; where no time passes they stay."""
        if not h > 0:
            return h0.copy()
        with named(f"{self.label}: its update"):
            found = np.asarray(self.update(e0.copy(), e1.copy(), h0.copy(), h), dtype=float)
        if found.shape != h0.shape:
            raise RunError(f"{self.label}: its update returned shape {found.shape}, expected {h0.shape}")
        if not np.all(np.isfinite(found)):
            k = int(np.argmin(np.isfinite(found).all(axis=0)))
            raise NotFinite(
                f"{self.label}: its update returned {found[:, k].tolist()} at the strains {e1[:, k].tolist()}"
            )
        return found

    def slope(self, e0: Array, e1: Array, h0: Array, h: float) -> Array:
        """Derivatives (n_h, n_e, n) of the variables at the end by the strains there, by central differences."""
        n = self.n_strains
        if not h > 0:
            return np.zeros((self.n_h, *e1.shape))
        size = 6e-6 * np.maximum(np.abs(e1), np.maximum(0.1 * np.abs(e1).max(axis=0), 1e-3))
        parts = []
        for k in range(n):
            d = np.zeros_like(e1)
            d[k] = size[k]
            ahead, behind = (self.end(e0, e1 + s * d, h0, h) for s in (1, -1))
            parts.append((ahead - behind) / (2 * size[k]))
        return np.stack(parts, axis=1)


def evolving_callback(W: Evolving) -> LawCallback:
    """The core's callback for an energy with internal variables."""
    n_e = W.n_strains

    def call(
        n: int, want_tangent: bool, t: float, h: float, discrete: bool, arrays: tuple[Array, ...]
    ) -> None:
        e0, at, e1 = (a[:, :n] for a in arrays[:3])
        S, D, energies, h0, h1, lost = (
            arrays[5],
            arrays[6],
            arrays[11],
            arrays[12],
            arrays[13],
            arrays[14],
        )
        reached = e1 if discrete else at
        h1[:] = W.end(e0, reached, h0, h)
        z0, z1 = np.concatenate([e0, h0]), np.concatenate([e1, h1])
        energies[:, :n] = W.value(z1)
        if discrete:
            stress, moduli = W.discrete_gradient(z0, z1, want_tangent)
        else:
            z = np.concatenate([at, h1])
            stress, moduli = W.gradient(z), W.hessian(z) if want_tangent else None
        S[:, :n] = stress[0, :n_e]
        lost[0, :n] = -(stress[0, n_e:] * (h1 - h0)).sum(axis=0)
        if moduli is not None:
            T = moduli[0, :n_e, :n_e] + np.einsum(
                "ihn,hjn->ijn", moduli[0, :n_e, n_e:], W.slope(e0, reached, h0, h)
            )
            D[:, :n] = T.reshape(n_e * n_e, n)

    return call
