"""Cells of solids with heat in plane stress, whose thickness follows strains in the plane and entropy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import RunError
from visviva.body.stressed_cells import StressedCells
from visviva.material.material import Material
from visviva.thermal.heat import HeatLaw

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
NEAR = 1e-5
"""By which share C33 is changed for the slope of the stress."""
MOST = 60
"""Newton's iterations."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SheetCells(StressedCells):
    """Cells without stress across.

    Attributes
    ----------
    entropies : callable
        Those at the points (m, q) from the unknowns and nodes (m, k).
    pull : callable
        The stress across (n,) from C (n, 6) and entropies (n,).
    """

    entropies: Callable[[Array, Ints], Array]
    pull: Callable[[Array, Array], Array]

    def strains(self, x: Array, some: slice = slice(None)) -> tuple[Array, Array]:
        F, C = super().strains(x, some)
        C = settled(C.reshape(-1, 6), self.entropies(x, self.nodes[some]).ravel(), self.pull).reshape(C.shape)
        F[..., 2, 2] = np.sqrt(C[..., 2])
        return F, C


def settled(C: Array, s: Array, pull: Callable[[Array, Array], Array]) -> Array:
    """Tensors ``C`` (n, 6) with the C33 at which nothing pulls across at what `pull` takes (n,), as entropies.

    By Newton's method in ln C33.

    Raises
    ------
    RunError
        If it is not found.
    """
    C = C.copy()
    C[:, 2] = 1 / (C[:, 0] * C[:, 1] - C[:, 3] ** 2)  # no change of volume
    shares = np.repeat([1 - NEAR, 1, 1 + NEAR], len(C))
    step = np.zeros(len(C))
    for _ in range(MOST):
        near = np.tile(C, (3, 1))
        near[:, 2] *= shares
        with np.errstate(all="ignore"):  # what is not finite is not found
            less, here, more = np.split(pull(near, np.tile(s, 3)) * near[:, 2], 3)
            slope = np.maximum((more - less) / (2 * NEAR), np.abs(here))
            step = -here / np.where(slope > 0, slope, 1.0)  # downhill, by a factor e at most
        C[:, 2] *= np.exp(step)
        if np.abs(step).max(initial=0.0) < 1e-10:
            return C
    k = int(np.argmax(~(np.abs(step) < 1e-10)))
    raise RunError(
        f"plane stress: no thickness is found at which nothing pulls across, where C is {C[k].round(6).tolist()} and "
        f"the entropy or temperature {s[k]:.6g}: the material has no such state, or cells are distorted"
    )


def resting_entropy(heat: HeatLaw, material: Material, T: Array) -> Array:
    """Entropies (n,) of temperatures (n,) without strain in the plane."""
    distinct, number = np.unique(T, return_inverse=True)

    def entropies(C: Array, T: Array) -> Array:
        """Those of temperatures without strain, and what the strain takes at one temperature."""
        s = heat.start_entropy(T)
        return s + (s - heat.start_entropy(heat.respond(material, C, s)[0]))

    def pull(C: Array, T: Array) -> Array:
        return heat.respond(material, C, entropies(C, T))[1][:, 2]

    C = settled(np.tile([1.0, 1, 1, 0, 0, 0], (len(distinct), 1)), distinct, pull)
    return np.asarray(entropies(C, distinct)[number])
