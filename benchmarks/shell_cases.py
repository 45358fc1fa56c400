"""Figures of the cases of shells.py."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Plate:
    """A square plate of side 1, clamped at x = 0, with velocities across that grow with the square of x."""

    thickness: float = 0.02
    young: float = 1e7
    poisson: float = 0.3
    density: float = 1000.0
    speed: float = 3.0
    step: float = 0.01

    def velocity(self, x: Any) -> Any:
        return self.speed * x**2


@dataclass(frozen=True)
class Cylinder:
    """An eighth of the pinched cylinder, at a share of the largest force of its published tables."""

    radius: float = 100.0
    length: float = 200.0
    thickness: float = 1.0
    young: float = 30e3
    poisson: float = 0.3
    force: float = 12000.0
    share: float = 0.1
    load_steps: int = 20


PLATE, CYLINDER = Plate(), Cylinder()
