"""The paper's two flaps in a channel as every code in the comparison runs them, see `visviva.examples.valve`."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class ValveCase:
    """Everything in the units that the case defines; the codes differ in their discretisations."""

    n: int = 256
    """Spaces between the nodes of the fluid's velocity along the channel, away from the flaps."""
    length: float = 8.0
    height: float = 1.61
    flap: float = 0.7
    thickness: float = 0.0212
    right: float = 2.0
    density: float = 10.0
    viscosity: float = 1.0
    young: float = 5.6e6
    poisson: float = 0.4
    step: float = 0.01
    steps: int = 5
    tolerance: float = 1e-8
    """Of the increments of velocity, relative to the velocity."""
    damping: float = 0.05
    """How far beyond the middle of a step the velocity is taken that moves the flaps."""

    @property
    def lame(self) -> tuple[float, float]:
        """Constants lambda and mu of the flaps."""
        mu = self.young / (2 * (1 + self.poisson))
        return 2 * mu * self.poisson / (1 - 2 * self.poisson), mu

    @property
    def tip(self) -> tuple[float, float]:
        """Middle of the lower flap's free end."""
        return self.right - self.thickness / 2, self.flap

    def strength(self, t: float) -> float:
        """Of the inflow, a factor of y (height - y)."""
        return 5.0 * (math.sin(2 * math.pi * t) + 1.1)
