"""Solids whose cells may not turn inside out, though their energies would not tell."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.body.solid_fields import CHUNK
from visviva.body.stressed_cells import StressedCells
from visviva.component.limited import Limited

if TYPE_CHECKING:
    from visviva.body.mesh_body import MeshBody

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Ratios = tuple[Ints, Ints, Array]
"""Nodes (m, k), numbers (m,) and ratios of volumes (m, q) of some cells."""


class Upright(Limited):
    """Of a `Solid` with terms of points, which know nothing of their cell; the terms of `Solid` look at it."""

    _evaluations: list[StressedCells]  # all cells, where they are integrated

    def invalid(self, x: Array) -> str:
        """The cell that is inside out most, at a point where it is integrated and still carries."""
        body: Any = self
        return flattest(body, x, self._ratios(x), 0.0) or super().invalid(x)

    def _ratios(self, x: Array) -> Iterator[Ratios]:
        first = 0
        for part in self._evaluations:
            numbers = first + np.arange(len(part.nodes))
            for start in range(0, len(numbers), CHUNK):
                some = slice(start, start + CHUNK)
                J = np.where(self._carries(x, part, some), part.ratios(x, some), np.inf)
                yield part.nodes[some], numbers[some], J
            first += len(numbers)

    def _carries(self, x: Array, part: StressedCells, some: slice) -> NDArray[np.bool_] | bool:
        """Whether there is something to turn at the points (m, q) of some cells."""
        return True


def flattest(body: MeshBody, x: Array, cells: Iterable[Ratios], limit: float) -> str:
    """The cell with the least ratio of volumes, if that is at the limit or below it; else nothing.

    One that has none, as what moves it is no number, is told at once.
    """
    least, found = limit, ""
    for nodes, numbers, J in cells:
        lowest = J.min(axis=1)
        e = int(np.argmin(lowest))  # the first without a number, if there is one
        if not lowest[e] > least:
            least = float(lowest[e])
            found = _told(body, x, nodes[e], int(numbers[e]), least)
        if np.isnan(least):
            break
    return found


def _told(body: MeshBody, x: Array, nodes: Ints, number: int, ratio: float) -> str:
    at = ", ".join(f"{c:.4g}" for c in body.carriers.vectors(x)[nodes].mean(axis=0))
    state = "of no finite volume" if np.isnan(ratio) else "inverted" if ratio <= 0 else "nearly flat"
    return f"element {number} of {body.label} near ({at}) is {state} (det F = {ratio:.3g})"
