"""Elements whose strains are sampled at points of their own and whose energy is quadratic in all of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visviva import _core
from visviva.model.field import Owner
from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Sampling(Protocol):
    """Sampling of strains: interpolated vectors, products of which are added up.

    Attributes
    ----------
    weights : array, (v, k)
        Of the k vectors of an element in those interpolated.
    products : int array, (p, 3)
        Strain, and the two interpolated vectors whose product is part of it.
    factors : array, (p,)
    """

    @property
    def weights(self) -> Array: ...
    @property
    def products(self) -> Ints: ...
    @property
    def factors(self) -> Array: ...


def add_assumed(
    model: Model,
    component: Owner,
    sampling: Sampling,
    unknowns: NDArray[np.integer],
    stiffness: Array,
    reference: Array,
) -> None:
    """Add elements (m) with the energy ``1/2 (e - reference) . stiffness (e - reference)``, booked as "stored".

    Parameters
    ----------
    sampling : Sampling
        Of n strains.
    unknowns : int array, (m, k)
        First unknowns of the vectors of each element.
    stiffness : array, (m, n, n)
    reference : array, (m, n)
        Strains that the energy does not see.
    """
    a, b = np.triu_indices(reference.shape[1])
    term = _core.AssumedTerm(
        np.ascontiguousarray(unknowns, dtype=np.int32),
        np.ascontiguousarray(sampling.weights),
        np.ascontiguousarray(sampling.products, dtype=np.int32),
        np.ascontiguousarray(sampling.factors),
        np.ascontiguousarray(stiffness[:, a, b]),
        np.ascontiguousarray(reference),
    )
    term.name = component.label
    term.energy_account = model.account(component, "stored", "potential")
    model.batch(term)
