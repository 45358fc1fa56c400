"""Temperatures of solids that are held at the ends of steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.solid_fields import components
from visviva.model.term import Stencils, Term
from visviva.thermal.heat import HeatLaw

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class HeldTemperature(Term):
    """Constraint that the temperature of strain and entropy at a node, in the mean of its cells, is the given one.

    An element is a cell with one of its nodes; its unknowns are the positions of the cell's nodes, the node's entropy,
    and its supply of entropy, whose equation this is. It speaks of the end of a step: a temperature held within
    the step would leave those of its ends to swing about it.

    Parameters
    ----------
    unknowns : int array (m, 3 k + 2)
    gradients : array (m, k, 3)
        Of the cell's shape functions at the node.
    share : array (m,)
        Of the cell in the mean.
    number : int array (m,)
        Which of the `values` is the node's.
    """

    kind = "supply"
    brings = "heat"
    is_alone = True

    def __init__(
        self,
        heat: HeatLaw,
        material: Any,
        unknowns: NDArray[np.int32],
        gradients: Array,
        share: Array,
        number: Ints,
        values: Callable[[float], Array],
    ) -> None:
        super().__init__()
        self.heat, self.material, self.unknowns = heat, material, unknowns
        self.gradients, self.share, self.number, self.values = gradients, share, number, values
        self.order = np.array([2] * (unknowns.shape[1] - 2) + [1, 0], dtype=np.int32)

    def temperatures(self, x: Array) -> Array:
        """Each element's part (m,) of what is held, at the unknowns `x` of the system."""
        here = x[self.unknowns]
        return np.asarray(self.share * self._slopes(here)[1][0])

    def _slopes(self, x1: Array) -> tuple[Array, tuple[Array, Array, Array]]:
        """Deformation gradients (m, 3, 3), and temperatures with their slopes, at the end."""
        F, C = self._strains(x1)
        return F, self.heat.temperature_slopes(self.material, C, x1[:, -2])

    def _strains(self, x1: Array) -> tuple[Array, Array]:
        """Deformation gradients (m, 3, 3) and C (m, 6) at the end."""
        places = x1[:, :-2].reshape(len(x1), -1, 3)
        F = np.einsum("mkj,mki->mij", self.gradients, places)
        return F, components(np.swapaxes(F, -1, -2) @ F)

    def residual(self, s: Stencils) -> Array:
        found = np.zeros_like(s.x1)
        T = self._slopes(s.x1)[1][0]
        found[:, -1] = self.share * (T - self.values(s.step.t1)[self.number])
        return found

    def tangent(self, s: Stencils) -> Array:
        F, (_, by_entropy, by_strain) = self._slopes(s.x1)
        found = np.zeros((*s.x1.shape, s.x1.shape[1]))
        by_place = 2 * np.einsum("m,mij,mjl,mkl->mki", self.share, F, by_strain, self.gradients)
        found[:, -1, :-2], found[:, -1, -2] = by_place.reshape(len(F), -1), self.share * by_entropy
        return found

    def work(self, s: Stencils) -> Array:
        return np.zeros(len(s.x1))
