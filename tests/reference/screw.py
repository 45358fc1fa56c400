"""Vertical screw joint to the ground, frictionless: one coordinate, closed form.

Translation z = (pitch / 2 pi) phi = h phi (a positive pitch advances along the axis for a positive turn), so
(J + m h^2) phi'' = -m g h. Reactions on the body: force m (z'' + g) along e3 and torque J phi'' about it;
they do no work together, F h + M = 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .integrate import Array


def screw(
    times: ArrayLike,
    mass: float = 2.0,
    inertia: float = 0.05,
    pitch: float = 0.3,
    gravity: float = 9.81,
    rate: float = 0.0,
) -> dict[str, Array]:
    """t, angle, rate, z, force and torque on the body; default phi'' = -17.17000334493, z(1) =
    -0.40990363579."""
    t = np.asarray(times, dtype=float)
    h = pitch / (2.0 * np.pi)
    second = -mass * gravity * h / (inertia + mass * h * h)
    angle = rate * t + 0.5 * second * t * t
    force = np.full_like(t, mass * (h * second + gravity))
    return {
        **{"t": t, "angle": angle, "rate": rate + second * t, "z": h * angle},
        **{"force": force, "torque": np.full_like(t, inertia * second)},
    }
