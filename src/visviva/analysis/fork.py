"""Bifurcations of equilibrium paths: told by the count of falling directions, left along the critical mode."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.load_steps import Equilibrium
from visviva.base.errors import InputError
from visviva.scheme.schemes import load_step
from visviva.system.stability import falling_directions

Array = NDArray[np.float64]

NEAR = 1e-2
"""Part of the first arc, to which a critical point is located."""
ACROSS = 1e-3
"""Cosine between a mode and the loads up to which it is across: at a limit point it is not."""


@dataclass
class Fork:
    """Looks for the first bifurcation on the way of a system from its present equilibrium on.

    Attributes
    ----------
    falling : int
        In how many directions energy falls from the equilibrium accepted last.
    """

    equations: Equilibrium
    falling: int = field(init=False)

    def __post_init__(self) -> None:
        self.system = self.equations.system
        self.equations.linearise(self.system.time)
        self.falling = self._count(self.system.time)

    def _count(self, time: float) -> int:
        found = falling_directions(self.system, load_step(self.system.time, time - self.system.time))
        if found is None:
            raise InputError(
                f"vv.ArcLength(branch=...): at the load parameter {time:.6g} it cannot be told in how many directions "
                "energy falls, as the tangent is not symmetric, too large, or that of a contact; leave branch out, and "
                "disturb the structure by a small load"
            )
        return found

    def is_passed(self, time: float) -> bool:
        """Whether the trial state at a load parameter lies beyond a critical point."""
        return self._count(time) != self.falling

    def go_on(self, time: float) -> None:
        """Take the trial state for the one accepted last."""
        self.falling = self._count(time)


def critical_mode(equations: Equilibrium, slope: Array) -> Array | None:
    """The direction (n,) in which the present state gives way, of length 1; None if loads drive it: a limit point.

    Inverse iteration with the factored tangent, in unknowns relative to their scales; the largest entry is positive.
    """
    system, now = equations.system, equations.system.time
    moving = equations.free & (system.order > 0)
    inverse_scale = np.where(moving, system.inverse_scale, 0.0)
    equations.linearise(now)
    z = np.where(moving, np.random.default_rng(0).standard_normal(len(slope)), 0.0)
    for _ in range(8):
        y = z * inverse_scale
        z = equations.solve(now, y / np.linalg.norm(y) * inverse_scale)
    y = z * inverse_scale
    y *= np.sign(y[np.argmax(np.abs(y))]) / np.linalg.norm(y)
    drive = np.where(moving, slope, 0.0) * system.scale
    if abs(float(y @ drive)) > ACROSS * float(np.linalg.norm(drive)):
        return None
    return np.asarray(y * system.scale)
