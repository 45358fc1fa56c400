"""Beams as they are drawn: their sections along the line, joined by quadrilaterals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visviva.body.beam_line import BeamLine

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Swept:
    """Sections at the nodes of every cell.

    Attributes
    ----------
    line : BeamLine
    contours : array, (m, c, 2)
        Polygon of the section of every cell.
    """

    line: BeamLine
    contours: Array

    @cached_property
    def nodes(self) -> Ints:
        """The node (m k c,) whose section each point belongs to."""
        return np.repeat(self.line.cells.ravel(), self.contours.shape[1])

    def points(self, phi: Array, directors: Array) -> Array:
        """Points (m k c, 3) of positions (n, 3) and directors (n, 3, 3) of the nodes; rates of rates likewise."""
        own = np.einsum("mkij,mkjc->mkic", self.line.turns[:, :, :2], directors[self.line.cells])
        arms = np.einsum("mpi,mkic->mkpc", self.contours, own)
        found: Array = (phi[self.line.cells][:, :, None] + arms).reshape(-1, 3)
        return found

    @cached_property
    def cells(self) -> list[Ints]:
        """Quadrilaterals between the sections, and polygons at free ends."""
        (m, k), c = self.line.cells.shape, self.contours.shape[1]
        order = [0, *range(2, k), 1]
        start = (np.arange(m)[:, None] * k + order) * c
        a, b = start[:, :-1, None], start[:, 1:, None]
        here, there = np.arange(c), (np.arange(c) + 1) % c
        sides = np.stack([a + here, a + there, b + there, b + here], axis=3).reshape(-1, 4)
        count = np.bincount(self.line.cells[:, :2].ravel(), minlength=len(self.line.points))
        free = count[self.line.cells[:, :2]] == 1
        lids = np.concatenate([start[free[:, 0], 0], start[free[:, 1], -1]])[:, None] + here
        return [sides, lids] if len(lids) else [sides]
