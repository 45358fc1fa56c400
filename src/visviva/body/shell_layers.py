"""Layers of a shell whose directors stretch: how strains in space follow from what its nodes do."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from visviva.body.shell_surface import ShellSurface
from visviva.mesh.cells import CELLS

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
EDGES = np.array([(0, 1), (1, 2), (3, 2), (0, 3), (0, 2), (1, 3)])
"""Corners whose distances the strain map of the core knows: edges along their coordinates, then diagonals."""
CORNERS = {"quad4": [0, 1, 2, 3], "tri3": [0, 1, 2, 2]}
"""Nodes at the four corners of the map, of the cells whose directors may stretch: two corners of triangles are one."""
A, B = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])
"""Components 11, 22, 33, 12, 23, 31 of symmetric tensors."""
N_RAW = 15
"""Strains of the map: squared distances (6), transverse shear at four edges, squared lengths of four directors, and the
enhanced strain."""


class Layers(NamedTuple):
    """Points of layers: of m cells, s points on the surface and k across.

    Attributes
    ----------
    turn : array, (m, s, k, 6, 15)
        What makes ``C - I`` in the directions of the material of the strains of the map.
    reference : array, (m, s, k, 15)
        Those of the reference.
    volume : array, (m, s, k)
    """

    turn: Array
    reference: Array
    volume: Array


def raw_strains(x: Array, d: Array) -> Array:
    """Strains (..., 15) of the map, of places and directors (..., 4, 3) of the nodes; the enhanced one is none."""
    start, end = EDGES.T
    edge = x[..., end, :] - x[..., start, :]
    mean = 0.5 * (d[..., end[:4], :] + d[..., start[:4], :])
    parts = [(edge**2).sum(axis=-1), (edge[..., :4, :] * mean).sum(axis=-1), (d**2).sum(axis=-1)]
    return np.concatenate([*parts, np.zeros((*x.shape[:-2], 1))], axis=-1)


def convected(kind: str, xi: Array) -> Array:
    """Components (s, 6, 15) of the metric along the cells' coordinates by strains of the map, at points (s, 2)."""
    N, dN = CELLS[kind].N_dN(xi)
    R = np.zeros((len(xi), 6, N_RAW))
    pairs = [0, 1, 2, 3, 4, 5] if kind == "quad4" else [0, 1, 3]
    start, end = np.array(CORNERS[kind])[EDGES[pairs]].T
    for k in (0, 1, 3):
        a, b = dN[:, :, A[k]], dN[:, :, B[k]]
        R[:, k, pairs] = -0.5 * (a[:, start] * b[:, end] + b[:, start] * a[:, end])
    r, s = xi.T
    if kind == "quad4":
        R[:, 5, 6], R[:, 5, 8], R[:, 4, 7], R[:, 4, 9] = (1 - s) / 4, (1 + s) / 4, (1 + r) / 4, (1 - r) / 4
    else:  # constant along every side (MITC3)
        R[:, 5, 6], R[:, 5, 7], R[:, 5, 9] = 1 - s, -s, s
        R[:, 4, 6], R[:, 4, 7], R[:, 4, 9] = r, r, 1 - r
    R[:, 2, 10 : 10 + N.shape[1]], R[:, 2, 14] = N, 1.0
    return R


def at_corners(kind: str, heights: Array) -> Array:
    """Weights (k, 2 n, 8) of positions, then directors, of n nodes in what the map is made of, at heights (k,).

    These are the first four edges of places, and the directors of the corners.
    """
    corners = CORNERS[kind]
    n = max(corners) + 1
    found = np.zeros((len(heights), 2 * n, 8))
    for k, (start, end) in enumerate(EDGES[:4].tolist()):
        for corner, sign in ((start, -1.0), (end, 1.0)):
            found[:, corners[corner], k] += sign
            found[:, n + corners[corner], k] += sign * heights
    found[:, [n + c for c in corners], range(4, 8)] = 1.0
    return found


def full(c: Array) -> Array:
    """Tensors (..., 3, 3) of their components (..., 6)."""
    return np.asarray(c[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])


def of_components(F: Array) -> Array:
    """Matrix that takes components (..., 6) of C to those of ``F C F^T``."""
    left, right = F[..., A, :], F[..., B, :]
    both = left[..., A] * right[..., B] + (A != B) * (left[..., B] * right[..., A])
    return np.asarray(both)


def turned(angles: Array) -> Array:
    """Directions (k, 3, 3), as rows, that are turned about the third by angles (k,) in degrees."""
    cosine, sine = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    found = np.zeros((len(angles), 3, 3))
    found[:, 0, 0], found[:, 0, 1], found[:, 1, 0] = cosine, sine, -sine
    found[:, 1, 1], found[:, 2, 2] = cosine, 1.0
    return found


def root(M: Array) -> Array:
    """Inverse square roots of symmetric positive matrices (..., 3, 3)."""
    w, v = np.linalg.eigh(M)
    return np.asarray((v / np.sqrt(w)[..., None, :]) @ np.swapaxes(v, -1, -2))


def layers(surface: ShellSurface, cells: Ints, heights: Array, weights: Array, angles: Array) -> Layers:
    """Points of some cells (m,) at heights (k,) with their weights and angles (k,) of the material.

    The metric of the reference is that of the map, so that even stretches of curved shells are even.
    """
    xi, w = surface.rule
    N, dN = CELLS[surface.kind].N_dN(xi)
    nodes = surface.cells[cells]
    d = surface.directors[surface.turns[cells]][:, None]
    x = surface.points[nodes][:, None] + heights[:, None, None] * d  # (m, k, n, 3)
    corners = CORNERS[surface.kind]
    raw = raw_strains(x[:, :, corners], np.broadcast_to(d, x.shape)[:, :, corners])
    R = convected(surface.kind, xi)
    tangents = np.einsum("mkna,snb->mskba", x, dN)
    across = np.einsum("mkna,sn->mska", np.broadcast_to(d, x.shape), N)
    axes = surface.axes[cells]
    frame = np.concatenate([axes, np.cross(axes[..., :1, :], axes[..., 1:, :])], axis=2)  # (m, s, 3, 3)
    J = np.einsum("mskba,msia->mskbi", np.concatenate([tangents, across[..., None, :]], axis=3), frame)
    G = full(np.einsum("sij,mkj->mski", R, raw))
    back = np.linalg.inv(J)  # [i, b]
    back = root(back @ G @ np.swapaxes(back, -1, -2)) @ back
    turn = np.einsum("mskij,sjl->mskil", of_components(turned(angles) @ back), R)
    volume = w[:, None] * weights * np.sqrt(np.linalg.det(G))
    reference = np.broadcast_to(raw[:, None], (*volume.shape, N_RAW))
    return Layers(turn, reference, volume)
