"""Cells whose nodes are turned against each other so far that interpolated directors are directors no more."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TORN = 0.5
"""Change of products of directors at a node that is no turn."""


def most_turned(N: Array, own: Array, reference: Array) -> tuple[int, float]:
    """The cell whose interpolated directors lost most of their length and angles, and how much.

    Nodes that are turned against each other have directors of which the mean is shorter, and vanishes half a turn
    apart: with it go the strains that are measured along it, and the cell stretches, shears and bends without force.
    Cells whose nodes have no directors, as those of iterations that went astray, are not turned.

    Parameters
    ----------
    N : array, (q, k)
        Shape functions at the points of strains.
    own, reference : array, (m, k, r, 3)
        Directors of the cells at their nodes, now and in the reference.

    Returns
    -------
    cell : int
    change : float
        Largest change of a product ``d_i . d_j`` of interpolated directors from its reference; 1 where one vanishes.
    """
    change = np.abs(products(N, own) - products(N, reference)).max(axis=(1, 2, 3))
    at_nodes = np.eye(own.shape[1])
    torn = np.abs(products(at_nodes, own) - products(at_nodes, reference)).max(axis=(1, 2, 3)) > TORN
    change = np.where(torn, 0.0, change)
    cell = int(np.argmax(change))
    return cell, float(change[cell])


def products(N: Array, own: Array) -> Array:
    """Products ``d_i . d_j`` (m, q, r, r) of the interpolated directors."""
    m, k, r, c = own.shape
    d = (N @ own.reshape(m, k, r * c)).reshape(m, len(N), r, c)
    return np.asarray(d @ d.swapaxes(2, 3))


def turn(own: Array) -> float:
    """Largest angle in degrees between directors (k, r, 3) of two nodes of a cell; triads are turned by it."""
    cosine = np.einsum("aic,bic->ab", own, own)
    cosine = (cosine - 1) / 2 if own.shape[1] == 3 else cosine
    return float(np.degrees(np.arccos(np.clip(cosine.min(), -1, 1))))
