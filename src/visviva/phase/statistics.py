"""Figures of phases: interface area, volumes, structure factor and the size of domains."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.body.space import Table
from visviva.mesh.cells import Ints

Array = NDArray[np.float64]


def interface_area(tables: Sequence[Table], c: Array, apart: float) -> float:
    """Area of interfaces (length in a plane times the thickness), ``integral of |grad c| / apart``."""
    total = sum(float((t.size * np.linalg.norm(t.slopes(c), axis=2)).sum()) for t in tables)
    return total / apart


def phase_volume(tables: Sequence[Table], c: Array, above: float, dimension: int) -> float:
    """Volume where the concentration is above a value, in cells of a dimension.

    What a quadrature point stands for counts by the part of it on that side of the plane on which its value and slope
    say that the concentration has this value.
    """
    total = 0.0
    for t in tables:
        value, spread = t.at(c) - above, spreads(t, c, dimension)
        share, cut = np.where(value > 0, 1.0, 0.0), spread > 2 * np.abs(value)
        share[cut] = 0.5 + value[cut] / spread[cut]
        total += float((t.size * share).sum())
    return total


def spreads(t: Table, c: Array, dimension: int) -> Array:
    """Differences (m, q) of a field across what each point of a cell stands for, if these are alike."""
    weight = t.size / t.size.sum(axis=1, keepdims=True)
    aside = t.X - np.einsum("mq,mqd->md", weight, t.X)[:, None]
    across = np.einsum("mqd,mpd->mqp", t.slopes(c), aside)
    variance = np.einsum(
        "mqp,mp->mq", across**2, weight
    )  # a twelfth of its square where values are spread evenly
    return np.asarray(np.sqrt(12 * variance) / t.size.shape[1] ** (1 / dimension))


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


def domain_size(
    tables: Sequence[Table], c: Array, size: ArrayLike, spacings: ArrayLike, periodic: Sequence[bool]
) -> float:
    """``2 pi / <k>``, the mean wavenumber weighed by the structure factor, of a box with edges `size`.

    All waves of four and more nodes at distances of `spacings` along the axes are counted. What quadrature points stand
    for is shared between the places of a grid of half these distances, linearly, and transformed (Hockney and Eastwood
    1988). Along axes that are not periodic the box goes on as its mirror image, as no flux goes through its ends: jumps
    between them would be waves of all lengths.
    """
    wide = np.flatnonzero(np.asarray(size) > 0)
    images = np.where(np.asarray(periodic)[wide], 1, 2)
    edges, apart = np.asarray(size)[wide] * images, np.asarray(spacings)[wide]
    shape = np.maximum(2, np.ceil(2 * edges / apart)).astype(int)
    k = np.meshgrid(
        *(2 * np.pi * np.fft.fftfreq(n, L / n) for n, L in zip(shape, edges, strict=True)), indexing="ij"
    )
    shared = [np.sinc(axis * L / n / (2 * np.pi)) ** 2 for axis, L, n in zip(k, edges, shape, strict=True)]
    S = np.abs(np.fft.fftn(_on_grid(tables, c, wide, edges, shape, images)) / np.prod(shared, axis=0)) ** 2
    S[np.any([np.abs(a) > np.pi / (2 * d) * (1 + 1e-9) for a, d in zip(k, apart, strict=True)], axis=0)] = 0.0
    S.flat[0] = 0.0
    if not S.sum() > 0:
        return float("inf")
    return float(2 * np.pi * S.sum() / (np.linalg.norm(k, axis=0) * S).sum())


def _on_grid(tables: Sequence[Table], c: Array, wide: Ints, edges: Array, shape: Ints, images: Ints) -> Array:
    """Integrals of deviations from the mean, shared between the places of a periodic grid that has mirror images."""
    volume = sum(float(t.size.sum()) for t in tables)
    mean = sum(float((t.size * t.at(c)).sum()) for t in tables) / volume
    ends = [end(t.X.reshape(-1, 3), axis=0) for t in tables for end in (np.min, np.max)]
    low = 0.5 * (np.min(ends, axis=0) + np.max(ends, axis=0))[wide] - 0.5 * edges / images
    total = np.zeros(shape)
    for t in tables:
        weight = (t.size * (t.at(c) - mean)).ravel()
        for image in product(*(range(n) for n in images)):
            at = (t.X.reshape(-1, 3)[:, wide] - low) / edges * shape
            at = np.where(image, shape - at, at)
            first = np.floor(at).astype(int)
            for corner in product((0, 1), repeat=len(wide)):
                share = np.prod(np.abs(1 - np.array(corner) - (at - first)), axis=1)
                np.add.at(total, tuple(((first + corner) % shape).T), share * weight)
    return total
