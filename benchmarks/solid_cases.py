"""The solids that every code in the comparison runs: plain numpy data, independent of all of them.

Both are meshes of eight-node hexahedra with 2 x 2 x 2 points of integration and a neo-Hooke material with the energy
mu/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2 of the Cauchy-Green tensor C and J^2 = det C. The mean displacement of the
nodes after the last step proves that a code has solved the same discrete problem.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
TOLERANCE = 1e-8
"""Of Newton's method: forces left over, relative to the forces that act."""


@dataclass(frozen=True)
class SolidCase:
    """A mesh with its motion; statics if `density` is zero, else the trapezoidal rule with consistent masses.

    Nodes `held` (n,) are moved by their rows of `motion` (n, 3) in every step; in statics `motion` is also a fair guess
    of how the others move. Cells (m, 8) have the lower nodes first, each four counter-clockwise.
    """

    name: str
    n: int
    points: Array
    cells: Ints
    young: float
    poisson: float
    density: float
    velocity: Array
    held: NDArray[np.bool_]
    motion: Array
    step: float
    steps: int
    mean_displacement: float

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants lambda and mu."""
        mu = self.young / (2 * (1 + self.poisson))
        return 2 * mu * self.poisson / (1 - 2 * self.poisson), mu


def bricks(counts: tuple[int, int, int], periodic: int) -> tuple[Array, Ints]:
    """Places (n, 3) in the unit cube and cells of a grid, first coordinate fastest; the first `periodic` ones close."""
    closed = np.arange(3) < periodic
    extent = np.array(counts) + ~closed
    number = np.arange(np.prod(extent)).reshape(extent[::-1]).transpose()
    lower = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corners = np.array([*lower, *((i, j, 1) for i, j, _ in lower)])
    block = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    i, j, k = np.moveaxis((block + corners) % extent, -1, 0)
    places = np.stack(np.unravel_index(np.arange(number.size), extent[::-1])[::-1], axis=1)
    return places / np.array(counts), number[i, j, k]


def block(n: int) -> SolidCase:
    """A cube of n^3 bricks; of its opposite faces one is clamped and one moved by (0.05, 0, 0.05) in every step."""
    points, cells = bricks((n, n, n), 0)
    x = points[:, 0]
    held = (x == 0) | (x == 1)
    motion = np.outer(x, (0.05, 0.0, 0.05))
    mean = {20: 0.07122556, 30: 0.07121680}.get(n, np.nan)
    still = np.zeros_like(points)
    return SolidCase("block", n, points, cells, 1000.0, 0.3, 0.0, still, held, motion, 1.0, 2, mean)


def torus(n: int = 118) -> SolidCase:
    """The hollow torus of Hesch & Betsch (2012) in flight with a slow spin: n bricks around, 34 x 2 across."""
    places, cells = bricks((n, 34, 2), 2)
    around, tube = 2 * np.pi * places[:, 0], 2 * np.pi * places[:, 1]
    radius = 24.0 - 4.5 * (1 - places[:, 2])
    arm = 76.0 + radius * np.cos(tube)
    points = np.stack([arm * np.cos(around), arm * np.sin(around), radius * np.sin(tube)], axis=1)
    velocity = np.array([30.0, 0.0, 23.0]) + np.cross((0.1, 0.2, 0.3), points)
    free = np.zeros(len(points), dtype=bool)
    mean = 1.79584434 if n == 118 else np.nan
    still = np.zeros_like(points)
    return SolidCase("torus", n, points, cells, 2250.0, 0.3, 0.1, velocity, free, still, 0.01, 4, mean)


BUILDERS: dict[str, Callable[[int], SolidCase]] = {"block": block, "torus": torus}
