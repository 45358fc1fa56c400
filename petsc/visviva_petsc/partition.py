"""Cells of meshes shared out to processes."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def parts_of(grid: Any, n_parts: int) -> Ints:
    """Number of the part (n_cells,) of each cell: by METIS where there is `pymetis`, else cut by places."""
    if n_parts == 1 or grid.n_cells < 2 * n_parts or find_spec("pymetis") is None:
        return bisected(grid.centres, n_parts)
    import pymetis

    cells = [row for rows in grid.cells.values() for row in rows.tolist()]
    common = grid.dimension  # nodes that neighbours share at least
    return np.array(
        pymetis.part_mesh(n_parts, cells, gtype=pymetis.GType.DUAL, ncommon=common).element_part,
        dtype=np.int64,
    )


def bisected(places: Array, n_parts: int) -> Ints:
    """Parts of equal size, cut across the longest side again and again."""
    part = np.zeros(len(places), dtype=np.int64)

    def cut(some: Ints, first: int, n: int) -> None:
        if n == 1 or not len(some):
            part[some] = first
            return
        along = int(np.argmax(np.ptp(places[some], axis=0)))
        some = some[np.argsort(places[some, along], kind="stable")]
        middle = -(-len(some) * (n // 2) // n)
        cut(some[:middle], first, n // 2)
        cut(some[middle:], first + n // 2, n - n // 2)

    cut(np.arange(len(places)), 0, n_parts)
    return part
