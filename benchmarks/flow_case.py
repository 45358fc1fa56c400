"""The flow that every code in the comparison runs, and the command line that all of them share.

A channel with n x n/4 square cells in which a parabolic profile pulsates, and that all start from. Codes with the same
elements and scheme (Taylor-Hood, midpoint, skew-symmetric convection) solve the same discrete problem: the velocity
along the channel in its middle, a node of all meshes, agrees to the tolerance after the last step.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FlowCase:
    """Everything in the units that the flow defines."""

    n: int = 256
    length: float = 4.0
    height: float = 1.0
    density: float = 100.0
    viscosity: float = 1.0
    step: float = 0.01
    steps: int = 5
    tolerance: float = 1e-8
    """Of the increments of velocity, relative to the velocity."""

    @property
    def counts(self) -> tuple[int, int]:
        """Cells along and across."""
        return self.n, self.n // 4

    @property
    def middle(self) -> tuple[float, float]:
        """Of the channel."""
        return self.length / 2, self.height / 2

    def strength(self, t: float) -> float:
        """Of the inflow."""
        return 1.0 + math.sin(2 * math.pi * t)

    def profile(self, y: Array) -> Array:
        """Velocity along the channel at unit strength."""
        return 4.0 * y * (self.height - y) / self.height**2


Run = Callable[[FlowCase, str], Record]
"""Of the case and a variant of the code."""


def main(run: Run, variants: tuple[str, ...]) -> None:
    """Command line of a code: prints one line of JSON, the fields of `Record`; the first variant is the default."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--variant", choices=variants, default=variants[0])
    parser.add_argument("--n", type=int, default=FlowCase.n, help="cells along the channel")
    parser.add_argument("--steps", type=int, default=FlowCase.steps)
    chosen = parser.parse_args()
    case = FlowCase(n=chosen.n, steps=chosen.steps)
    print(json.dumps(asdict(run(case, chosen.variant))), flush=True)
