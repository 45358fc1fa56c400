"""How much of its momentum the fluid within rigid bodies lacks: what passes between marks does not move along."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.flow.immersed_body import ImmersedBody
from visviva.flow.location import Place
from visviva.flow.marks import lattice, winding

if TYPE_CHECKING:
    from visviva.system.system import System

Array = NDArray[np.float64]

FINER = 2
"""Places are so many times closer to each other than the marks, between which the fluid passes."""


class Lag:
    """Compares the mean velocity of the fluid within a rigid body with that of the body, over a run.

    The fluid in the place of the body, of mass m, is to move as the body does. What its momentum lacks is set off
    against the largest of three: the impulse of the multipliers so far, m times the change of the body's velocity, and
    m times the velocity of its parts. Slips are those in the middle of steps, as velocities swing; what was there
    before the first step, of a fluid that was not rigid, does not count.

    Attributes
    ----------
    memory : array (15,)
        Slip and velocity of the body at the start, slip now, impulse so far (3 each), the largest momentum so far, and
        the integrals over time of what was lacking and of that.
    """

    def __init__(self, wet: ImmersedBody) -> None:
        points, triangles = wet.shape.surface()
        inside = lattice(points, wet.distance / FINER, wet.fluid.dimension == 2)
        inside = inside[winding(points[triangles], inside) > 0.5]
        self.wet, self._mass = wet, -wet.total_mass
        self._places = inside if len(inside) else wet.marks
        self.memory = np.full(15, np.nan)

    @property
    def part(self) -> float:
        """Of the momentum that was lacking, in the mean over time."""
        lacking, whole = self.memory[13:]
        return float(lacking / whole) if whole > 0 else 0.0

    def begin(self, system: System) -> None:
        """Begin at the present state."""
        slip, velocity, speed = self._look(system)
        self.memory = np.concatenate([slip, velocity, slip, np.zeros(3), [self._mass * speed, 0, 0]])

    def add(self, system: System) -> None:
        """Take in the step that led to the present state, unless a part of the body is outside then."""
        slip0, velocity0, before, impulse = self.memory[:12].reshape(4, 3)
        slip, velocity, speed = self._look(system)
        if np.isnan([*slip, *slip0]).any():
            return
        h, most = system.last_step, self.memory[12]
        impulse += h * self.wet.forces(system.x).sum(axis=0)
        moves = self._mass * max(speed, float(np.linalg.norm(velocity - velocity0)))
        self.memory[12] = max(most, moves, float(np.linalg.norm(impulse)))
        middle = 0.5 * (before + slip)
        lacks = min(np.linalg.norm(middle), np.linalg.norm(middle - slip0))
        self.memory[13:] += h * self._mass * lacks, h * 0.5 * (most + self.memory[12])
        before[:] = slip

    def _look(self, system: System) -> tuple[Array, Array, float]:
        """Mean velocity of the fluid within as the body sees it, that of the body there, and of its parts in squares.

        The first is not a number if a part of the body is outside.
        """
        fluid, X = self.wet.fluid, self._places
        d, first = fluid.dimension, self.wet.body.motion.start
        weights = np.hstack([np.ones((len(X), 1)), X])[:, : d + 1]
        unknowns = first + 3 * np.arange(d + 1)[:, None] + np.arange(d)
        places, moves = (weights @ y[unknowns] for y in (system.x, system.v))
        found = fluid.find(places)
        if (found[0] < 0).any():
            flows = np.full_like(moves, np.nan)
        else:
            flows = Place(fluid, places, found).velocities(system.x)[:, :d]
        mean, velocity = (np.pad(a.mean(axis=0), (0, 3 - d)) for a in (flows - moves, moves))
        return mean, velocity, float(np.sqrt((moves**2).sum(axis=1).mean()))


def lags_of(system: System) -> tuple[Lag, ...]:
    """Those of all rigid bodies in fluids, from the present state on; of statics none."""
    bodies = [c for c in system.components if isinstance(c, ImmersedBody)] if system.has_inertia else []
    found = tuple(Lag(wet) for wet in bodies)
    for lag in found:
        lag.begin(system)
    return found


def resume(lags: tuple[Lag, ...], memories: Array | None, system: System) -> None:
    """Go on with what a run that was saved remembered, or begin at the present state if it did not."""
    for k, lag in enumerate(lags):
        if memories is None:
            lag.begin(system)
        else:
            lag.memory = np.array(memories[k])
