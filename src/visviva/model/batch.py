"""Batches of strains given by arrays: what components with many elements hand to the core at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva import _core
from visviva.model.law import Law

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Layout:
    """Data common to the elements of a batch: forms ``y = weight x`` and strains ``e = y + coefficient y y``.

    Attributes
    ----------
    n_x, n_y, n_e : int
        Unknowns, forms and strains of an element.
    forms : sequence of (form, unknown)
        Where the weights of an element belong.
    linear : sequence of (strain, form)
    products : sequence of (strain, form, form)
    coefficients : sequence of float
        One for every product.
    """

    n_x: int
    n_y: int
    n_e: int
    forms: Sequence[tuple[int, int]]
    linear: Sequence[tuple[int, int]] = ()
    products: Sequence[tuple[int, int, int]] = ()
    coefficients: Sequence[float] = ()


def strain_batch(
    layout: Layout, law: Law, index: ArrayLike, weights: ArrayLike, parameters: ArrayLike, signal: int = -1
) -> _core.StrainTerm:
    """Elements of one layout under a law.

    Parameters
    ----------
    layout : Layout
    law : Law
        Its parameters are not used, but those of each element.
    index : array_like of int, (n, n_x)
        Unknowns of each element.
    weights : array_like, (n, n_forms)
    parameters : array_like, (n, 2)
    signal : int
        Number of the function of time that drives them all.
    """
    index = np.asarray(index, dtype=np.int32)
    n = len(index)
    term = _core.StrainTerm(
        [layout.n_x, layout.n_y, layout.n_e, 0, law.kind],
        np.array(layout.forms, dtype=np.int32).reshape(-1, 2),
        np.array(layout.products, dtype=np.int32).reshape(-1, 3),
        np.array(layout.coefficients, dtype=float),
        np.array(layout.linear, dtype=np.int32).reshape(-1, 2),
        np.ones(len(layout.linear)),
        np.ascontiguousarray(index.T),
        np.ascontiguousarray(np.broadcast_to(weights, (n, len(layout.forms))).T),
        np.zeros((layout.n_y, n)),
        np.zeros((layout.n_e, n)),
        np.ascontiguousarray(np.broadcast_to(parameters, (n, 2)).T),
        np.full((1, n), signal, dtype=np.int32),
    )
    if law.callback is not None:
        term.set_callback(law.callback)
    return term


def along(d: int) -> Layout:
    """One strain, the projection of a node of `d` unknowns on a vector, given by the weights."""
    return Layout(d, 1, 1, [(0, c) for c in range(d)], [(0, 0)])


def components(d: int, k: int = 1) -> Layout:
    """The `d` components of a weighted sum of `k` nodes as strains; weights (d k): all of x first."""
    forms = [(c, d * a + c) for c in range(d) for a in range(k)]
    return Layout(d * k, d, d, forms, [(c, c) for c in range(d)])


def book(term: Any, account: list[int], component: list[int], n: int) -> None:
    """Tell a term where its energy, work, momentum and defects are booked."""
    term.book(np.array(account, dtype=np.int32).reshape(n), np.array(component, dtype=np.int32).reshape(n))
