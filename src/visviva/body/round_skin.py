"""Points along the middle of a round bar, by which it touches others."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.body.beam_line import BeamLine
from visviva.body.touching import NO_FACES, Round, Skin
from visviva.mesh.cells import CELLS

if TYPE_CHECKING:
    import scipy.sparse as sp

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def round_skin(line: BeamLine, radius: float, fine: bool, vectors: Callable[[], NDArray[np.int32]]) -> Skin:
    """The nodes of a line, and where it shall be `fine` points between them that are a radius apart or less.

    The `vectors` are positions of all nodes, then first, second and third directors.
    """
    import scipy.sparse as sp

    n, k = len(line.points), line.cells.shape[1]
    spans = np.linalg.norm(np.diff(line.points[line.cells[:, [0, *range(2, k), 1]]], axis=1), axis=2)
    between = (
        np.maximum(np.ceil(spans.max(axis=1) / radius), 1).astype(int) if fine else np.ones(len(spans), int)
    )
    cell, xi, segments = points_of_cells(line.cells, n, between)
    N = CELLS[line.kind].N(xi[:, None])
    nodes = line.cells[cell]
    positions = rows(nodes, N, 4 * n)
    points: Array = np.asarray(positions[:, :n] @ line.points, dtype=float)
    shares = np.einsum("pa,paij->paij", N, line.turns[cell])
    columns = nodes[:, :, None] + n * (1 + np.arange(3))
    axes = [rows(columns.reshape(len(xi), -1), shares[:, :, i].reshape(len(xi), -1), 4 * n) for i in range(3)]
    every = sp.vstack(axes).tocsr()[np.arange(3 * len(xi)).reshape(3, -1).T.ravel()]
    lengths = np.linalg.norm(points[segments[:, 1]] - points[segments[:, 0]], axis=1)
    shared = np.bincount(segments.ravel(), np.repeat(lengths / 2, 2), minlength=len(points))
    nearest = nodes[np.arange(len(nodes)), np.argmax(N, axis=1)]
    areas = np.asarray(2 * radius * shared, dtype=float)
    bar = Round(radius, points, areas, every, segments)
    return Skin(vectors, positions, points, nearest, NO_FACES, NO_FACES, round=bar)


def points_of_cells(cells: Ints, n: int, between: Ints) -> tuple[Ints, Array, Ints]:
    """The cell and the coordinate in it of each point, nodes first, and the segments between neighbours.

    So many segments are `between` neighbouring nodes of each cell.
    """
    m, k = cells.shape
    at = np.linspace(-1, 1, k)[[0, k - 1, *range(1, k - 1)]]
    cell, xi = np.zeros(n, dtype=np.int64), np.zeros(n)
    cell[cells[::-1]], xi[cells[::-1]] = np.arange(m)[::-1, None], at
    own, place, segments, count = [cell], [xi], [], n
    for c, (nodes, q) in enumerate(zip(cells.tolist(), between.tolist(), strict=True)):
        inner = np.linspace(-1, 1, (k - 1) * q + 1)
        along = np.full(len(inner), -1)
        along[::q] = [nodes[0], *nodes[2:], nodes[1]]
        new = along < 0
        along[new] = count + np.arange(new.sum())
        count += int(new.sum())
        own.append(np.full(new.sum(), c))
        place.append(inner[new])
        segments.append(np.column_stack([along[:-1], along[1:]]))
    return np.concatenate(own), np.concatenate(place), np.concatenate(segments)


def rows(columns: Ints, values: Array, width: int) -> sp.csr_array:
    """A sparse matrix with the same number of entries in each row."""
    import scipy.sparse as sp

    found = sp.csr_array(
        (values.ravel(), (np.repeat(np.arange(len(columns)), columns.shape[1]), columns.ravel())),
        shape=(len(columns), width),
    )
    found.eliminate_zeros()
    return found
