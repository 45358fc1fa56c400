"""The mixture that both codes of the comparison separate, that of DOLFINx's demonstration of Cahn and Hilliard.

Linear triangles on a unit square with sides that let nothing through, from random concentrations about .63. Steps of
the midpoint rule, the potential in the middle of a step: concentrations after the last step agree to the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from record import Record, command

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MixtureCase:
    """Everything in the units of the demonstration."""

    n: int = 96
    barrier: float = 100.0
    """Of the energy ``barrier c^2 (1 - c)^2``."""
    gradient_energy: float = 1e-2
    mobility: float = 1.0
    mean: float = 0.63
    noise: float = 0.02
    step: float = 5e-6
    steps: int = 10
    tolerance: float = 1e-8
    """Of the increments of concentration, relative to the concentration."""

    def start(self, x: Array, y: Array) -> Array:
        """Concentrations as random as whole numbers of a grid can make them, the same in all codes."""
        i, j = np.rint(x * self.n), np.rint(y * self.n)
        scattered = np.modf(np.abs(np.sin(12.9898 * i + 78.233 * j) * 43758.5453))[0]
        return np.asarray(self.mean + self.noise * (0.5 - scattered))


def main(run: Callable[[Any, str], Record], variants: tuple[str, ...]) -> None:
    """Command line of a code, see `record.command`."""
    command(run, variants, MixtureCase, "n")
