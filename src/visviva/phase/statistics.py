"""Figures of phases: interface area, volumes, structure factor and the size of domains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.body.space import Table

Array = NDArray[np.float64]


def interface_area(tables: Sequence[Table], c: Array, apart: float) -> float:
    """Area of interfaces (length in a plane times the thickness), ``integral of |grad c| / apart``."""
    total = sum(float((t.size * np.linalg.norm(t.slopes(c), axis=2)).sum()) for t in tables)
    return total / apart


def phase_volume(tables: Sequence[Table], c: Array, above: float) -> float:
    """Volume where the concentration is above a value, by quadrature points."""
    return float(sum(t.size[t.at(c) > above].sum() for t in tables))


def structure_factor(tables: Sequence[Table], c: Array, waves: ArrayLike) -> Array:
    """``|integral of (c - mean) exp(-i k . X)|^2 / volume`` (n,) of wave vectors k (n, 2 or 3).

    Raises
    ------
    InputError
        If these are no such vectors.
    """
    k = np.asarray(waves, dtype=float)
    if k.ndim != 2 or k.shape[1] not in (2, 3) or not np.all(np.isfinite(k)):
        raise InputError(
            f"structure_factor: waves are finite vectors (n, 2) or (n, 3), not of shape {k.shape}"
        )
    volume = sum(float(t.size.sum()) for t in tables)
    mean = sum(float((t.size * t.at(c)).sum()) for t in tables) / volume
    total = np.zeros(len(k), dtype=complex)
    for t in tables:
        weight = (t.size * (t.at(c) - mean)).ravel()
        places = t.X.reshape(-1, 3)[:, : k.shape[1]]
        for n, wave in enumerate(k):
            total[n] += (weight * np.exp(-1j * (places @ wave))).sum()
    return np.asarray(np.abs(total) ** 2 / volume)


def domain_size(tables: Sequence[Table], c: Array, size: Sequence[float], waves: int = 16) -> float:
    """``2 pi / <k>``, the mean wavenumber weighed by the structure factor, of a box with edges `size`.

    Up to so many `waves` fit along each edge. In a box that is not periodic, ends spread the longest waves.
    """
    axes = [2 * np.pi * np.arange(-waves if a else 0, waves + 1) / L for a, L in enumerate(size)]
    k = np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")], axis=1)
    norm = np.linalg.norm(k, axis=1)
    k, norm = k[norm > 0], norm[norm > 0]
    S = structure_factor(tables, c, k)
    if not S.sum() > 0:
        return float("inf")
    return float(2 * np.pi * S.sum() / (norm * S).sum())
