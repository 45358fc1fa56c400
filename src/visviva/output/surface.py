"""Drawn and stored surface of one component."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError

# VTK's numbers for cells by their number of points
CELL_TYPES = {1: 1, 2: 3, 3: 5, 4: 9}
POLYGON = 7


@dataclass(frozen=True, eq=False)
class Surface:
    """Points of one component and the cells that connect them; of a solid, the cells that fill it.

    The motion moves the points and keeps the cells, so a frame of an animation is one array of
    current points per surface.

    Parameters
    ----------
    name
        Name of the component, unique in its system.
    points
        (n, 3) reference points, in m; in the body's own coordinates for a rigid body.
    cells
        Blocks of equal cells, each an (m, k) integer array of point indices from 0: k = 1 single
        points, 2 lines, 3 triangles, 4 quadrilaterals, more for plane polygons. A single block may
        be given without a list around it.
    types
        VTK's numbers of the cell types, one per block, where the number of points does not tell the type.

    Raises
    ------
    InputError
        If a shape is wrong, a number not finite or an index outside the points.

    Examples
    --------
    >>> rope = Surface("rope", [[0, 0, 0], [0, 0, -2]], [[0, 1]])
    >>> rope.points.shape, rope.cells[0].shape
    ((2, 3), (1, 2))
    """

    name: str
    points: NDArray[np.float64]
    cells: tuple[NDArray[np.int64], ...]
    types: tuple[int, ...]

    def __init__(
        self,
        name: str,
        points: ArrayLike,
        cells: ArrayLike | Sequence[ArrayLike],
        types: Sequence[int] | None = None,
    ) -> None:
        array = np.array(points, dtype=np.float64)
        if not name:
            raise InputError("a surface needs a name")
        if array.ndim != 2 or array.shape[1] != 3 or not len(array):
            raise InputError(f"surface of {name}: points must have the shape (n, 3), not {array.shape}")
        if not np.isfinite(array).all():
            raise InputError(f"surface of {name}: a point is not finite")
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "points", array)
        blocks = tuple(_block(name, block, len(array)) for block in _blocks(cells))
        told = tuple(CELL_TYPES.get(block.shape[1], POLYGON) for block in blocks)
        if types is not None and len(types) != len(blocks):
            raise InputError(f"surface of {name}: {len(types)} types of cells for {len(blocks)} blocks")
        object.__setattr__(self, "cells", blocks)
        object.__setattr__(self, "types", told if types is None else tuple(types))


def _blocks(cells: ArrayLike | Sequence[ArrayLike]) -> list[ArrayLike]:
    """Tell one block of cells from a list of blocks by its depth."""
    try:
        single = np.ndim(cells) == 2  # type: ignore[arg-type]
    except ValueError:  # blocks of different shapes do not form one array
        single = False
    return [cells] if single else list(cells)  # type: ignore[arg-type, list-item]


def _block(name: str, block: ArrayLike, n_points: int) -> NDArray[np.int64]:
    indices = np.array(block)
    if indices.ndim != 2 or indices.shape[1] < 1 or not np.issubdtype(indices.dtype, np.integer):
        raise InputError(f"surface of {name}: a block of cells is an (m, k) array of integers")
    if indices.size and (indices.min() < 0 or indices.max() >= n_points):
        raise InputError(f"surface of {name}: a cell refers to a point outside 0..{n_points - 1}")
    return indices.astype(np.int64)
