"""Cells of solids with heat in plane stress, whose thickness follows strains in the plane and entropy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visviva.body.stressed_cells import StressedCells
from visviva.material.material import Material
from visviva.thermal.heat import HeatLaw

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
NEAR = 1e-5
"""By which share C33 is changed for the slope of the stress."""


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
    """Tensors ``C`` (n, 6) with the C33 at which nothing pulls across at entropies (n,): Newton's method in ln C33."""
    C = C.copy()
    C[:, 2] = 1 / (C[:, 0] * C[:, 1] - C[:, 3] ** 2)  # no change of volume
    shares = np.repeat([1 - NEAR, 1, 1 + NEAR], len(C))
    for _ in range(60):
        near = np.tile(C, (3, 1))
        near[:, 2] *= shares
        less, here, more = np.split(pull(near, np.tile(s, 3)) * near[:, 2], 3)
        slope = np.maximum((more - less) / (2 * NEAR), np.abs(here))
        step = -here / np.where(slope > 0, slope, 1.0)  # downhill, by a factor e at most
        C[:, 2] *= np.exp(step)
        if not np.abs(step).max(initial=0.0) >= 1e-10:
            break
    return C


def resting_entropy(heat: HeatLaw, material: Material, T: Array) -> Array:
    """Entropies (n,) of temperatures (n,) without strain in the plane."""
    given = heat.start_entropy(T)
    s, rest = given.copy(), np.tile([1.0, 1, 1, 0, 0, 0], (len(T), 1))
    for _ in range(500):  # what expansion across takes is a share of it
        C = settled(rest, s, lambda C, s: heat.respond(material, C, s)[1][:, 2])
        more = given - heat.start_entropy(heat.respond(material, C, s)[0])
        s += more
        if not np.abs(more).max(initial=0.0) > 1e-14 * np.abs(given).max(initial=0.0):
            break
    return s
