"""Jacobians and measures of many cells at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from visviva.mesh.cells import CELLS, Array, Ints
from visviva.mesh.quadrature import mass_rule

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

CHUNK = 2048  # cells whose Jacobians are held at a time


def jacobians(points: Array, nodes: Ints, derivatives: Array) -> Array:
    """Derivatives ``dX/dxi`` of the positions by the reference coordinates.

    Parameters
    ----------
    points : array, (n, d)
    nodes : array of int, (m, k)
        Cells of one type.
    derivatives : array, (q, k, dim)
        Of the shape functions.

    Returns
    -------
    array, (m, q, d, dim)
    """
    q, k, dim = derivatives.shape
    m, d = len(nodes), points.shape[1]
    X = points[nodes.T].reshape(k, m * d)
    J = derivatives.transpose(0, 2, 1).reshape(q * dim, k) @ X
    return np.asarray(J.reshape(q, dim, m, d).transpose(2, 0, 3, 1))


def measure(J: Array) -> Array:
    """Ratio of lengths, areas or volumes (...): signed where both dimensions agree."""
    if J.shape[-1] == J.shape[-2]:
        return determinant(J)
    return np.asarray(np.sqrt(determinant(np.swapaxes(J, -1, -2) @ J)))


def determinant(A: Array) -> Array:
    """Determinants (...) of small matrices (..., n, n), n up to 3; faster than by elimination."""
    a = np.moveaxis(A, (-2, -1), (0, 1))
    if len(a) == 1:
        return np.asarray(a[0, 0])
    if len(a) == 2:
        return np.asarray(a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0])
    minors = [a[1, i] * a[2, j] - a[1, j] * a[2, i] for i, j in ((1, 2), (2, 0), (0, 1))]
    return np.asarray(a[0, 0] * minors[0] + a[0, 1] * minors[1] + a[0, 2] * minors[2])


def chunks(nodes: Ints) -> Iterator[Ints]:
    """Cells of one type, some thousands at a time."""
    for start in range(0, len(nodes), CHUNK):
        yield nodes[start : start + CHUNK]


def volumes(points: Array, cells: Mapping[str, Ints]) -> Array:
    """Volume (area, length) of every cell (n_cells,), by the rule of its mass."""
    found = [np.zeros(0)]
    for name, nodes in cells.items():
        xi, w = mass_rule(name)
        dN = CELLS[name].dN(xi)
        found += [measure(jacobians(points, part, dN)) @ w for part in chunks(nodes)]
    return np.concatenate(found)


def centres(points: Array, cells: Mapping[str, Ints]) -> Array:
    """Positions (n_cells, d) of the centres of the reference cells."""
    found = [np.zeros((0, points.shape[1]))]
    for name, nodes in cells.items():
        N = CELLS[name].N(CELLS[name].centre[None])[0]
        found.append(np.einsum("mkd,k->md", points[nodes], N))
    return np.concatenate(found)


def normals(points: Array, cells: Mapping[str, Ints]) -> Array:
    """Outward unit normals (m, d) of faces in space, or of edges in the plane, at their middles."""
    found = [np.zeros((0, points.shape[1]))]
    for name, nodes in cells.items():
        cell = CELLS[name]
        middle = cell.centre[None]
        J = jacobians(points, nodes, cell.dN(middle))[:, 0]
        found.append(np.cross(J[..., 0], J[..., 1]) if J.shape[-1] == 2 else J[..., ::-1, 0] * [1.0, -1.0])
    every = np.concatenate(found)
    return np.asarray(every / np.linalg.norm(every, axis=1, keepdims=True))


def equal_rows(rows: Ints) -> tuple[Ints, Ints]:
    """Groups of equal rows of numbers that are not negative.

    Parameters
    ----------
    rows : array of int, (m, k)

    Returns
    -------
    first : array of int, (n_groups,)
        The first row of each group.
    group : array of int, (m,)
        The group of each row.
    """
    keys = _packed(rows)
    order = np.lexsort(keys)
    new = np.zeros(len(order), dtype=bool)
    new[:1] = True
    for key in keys:
        new[1:] |= np.diff(key[order]) != 0
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    return order[new], group


def _packed(rows: Ints) -> list[Ints]:
    """As few columns (m,) as hold the same information."""
    bits = max(int(rows.max(initial=0)).bit_length(), 1)
    width = 63 // bits
    keys = []
    for start in range(0, rows.shape[1], width):
        key = np.zeros(len(rows), dtype=np.int64)
        for column in rows[:, start : start + width].T:
            key = (key << bits) | column
        keys.append(key)
    return keys


def cell_axes(mesh: Mesh) -> Array:
    """Derivatives (n_cells, d, d) by the own coordinates in the middle of each cell, scaled to its volume.

    Examples
    --------
    >>> import visviva as vv
    >>> cell_axes(vv.RectangleMesh(size=(1, 2), counts=(1, 2)).build())[0].tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    found = []
    for name, nodes in mesh.cells.items():
        cell = CELLS[name]
        found.append(jacobians(mesh.points, nodes, cell.dN(cell.centre[None]))[:, 0])
    axes = np.concatenate(found)
    size = np.abs(np.linalg.det(axes))
    return np.asarray(axes * ((mesh.volumes / size) ** (1 / axes.shape[2]))[:, None, None])
