"""Two blocks, one pushed onto the other and aside: the case as plain arrays, so that every code runs the same mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from record import Record, command

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

COUNTS = {9: ((14, 14, 7), (12, 12, 6)), 72: ((30, 30, 14), (26, 26, 12))}
"""Bricks of the lower and the upper block, by thousands of unknowns."""


@dataclass(frozen=True)
class Block:
    """Bricks in a box: points (n, 3), cells (m, 8), and nodes of the bottom and of the top in rows (k, 4)."""

    origin: tuple[float, float, float]
    size: tuple[float, float, float]
    counts: tuple[int, int, int]

    @cached_property
    def points(self) -> Array:
        """Positions (n, 3), those along z after those along y after those along x."""
        axes = [
            o + s * np.arange(n + 1) / n for o, s, n in zip(self.origin, self.size, self.counts, strict=True)
        ]
        z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        return np.column_stack([x.ravel(), y.ravel(), z.ravel()])

    @cached_property
    def cells(self) -> Ints:
        """Nodes (m, 8) of the bricks."""
        nx, ny, nz = self.counts
        k, j, i = (a.ravel() for a in np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij"))
        first = i + (nx + 1) * (j + (ny + 1) * k)
        corners = [0, 1, nx + 2, nx + 1]
        layer = (nx + 1) * (ny + 1)
        return first[:, None] + np.array([*corners, *(c + layer for c in corners)])

    @property
    def bottom(self) -> Ints:
        """Faces (k, 4) below, anticlockwise from outside."""
        nx, ny, _ = self.counts
        return self.cells[: nx * ny, [0, 3, 2, 1]]

    @property
    def top(self) -> Ints:
        """Faces (k, 4) above, anticlockwise from outside."""
        nx, ny, _ = self.counts
        return self.cells[-nx * ny :, 4:]


@dataclass(frozen=True)
class ContactCase:
    """The lower block is wider and clamped at its bottom, the top of the upper one is moved; statics."""

    thousands: int = 9
    steps: int = 5
    young: float = 1000.0
    poisson: float = 0.3
    motion: tuple[float, float, float] = (0.03, 0.0, -0.05)
    tolerance: float = 1e-8

    @cached_property
    def lower(self) -> Block:
        """The wider block."""
        return Block((-0.16, -0.14, 0.0), (1.3, 1.3, 0.5), COUNTS[self.thousands][0])

    @cached_property
    def upper(self) -> Block:
        """The block on it."""
        return Block((0.0, 0.0, 0.5), (1.0, 1.0, 0.5), COUNTS[self.thousands][1])


def main(run: Callable[[ContactCase, str], Record], variants: tuple[str, ...]) -> None:
    """Command line of a code, see `record.command`."""
    command(run, variants, ContactCase, "thousands")
