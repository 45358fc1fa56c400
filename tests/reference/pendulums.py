"""Pendulums: simple (elliptic functions), double (point masses), spring pendulum, all in closed form or to
1e-12."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipj, ellipk

from .integrate import Array, solve


def simple_period(length: float = 1.0, gravity: float = 9.81, amplitude: float = np.pi / 2) -> float:
    """T = 4 K(k^2) / w0, k = sin(amplitude / 2), w0 = sqrt(g / L)."""
    return float(4.0 * ellipk(np.sin(amplitude / 2) ** 2) / np.sqrt(gravity / length))


def simple(
    times: ArrayLike, mass: float = 1.0, length: float = 1.0, gravity: float = 9.81
) -> dict[str, Array]:
    """IFToMM A01: point mass released from rest at (-L, 0), pivot at the origin, gravity along -y.

    phi = 2 asin(k cd(w0 t | k^2)), k^2 = 1/2, measured from the downward vertical towards -x; tension
    N = 3 m g cos phi (energy plus Newton along the bar). Columns t, x, y, vx, vy, tension.
    """
    t = np.asarray(times, dtype=float)
    w0, k = np.sqrt(gravity / length), np.sqrt(0.5)
    sn, cn, dn, _ = ellipj(w0 * t, k * k)
    phi = 2.0 * np.arcsin(k * cn / dn)
    rate = -2.0 * k * w0 * (1.0 - k * k) * sn / dn**2 / np.cos(phi / 2)  # cd' = -(1 - m) sn / dn^2
    x, y = -length * np.sin(phi), -length * np.cos(phi)
    tension = 3.0 * mass * gravity * np.cos(phi)
    return {"t": t, "x": x, "y": y, "vx": y * rate, "vy": -x * rate, "tension": tension}


def double(times: ArrayLike, gravity: float = 9.81, rtol: float = 3e-14) -> dict[str, Array]:
    """Two unit point masses on massless unit bars, both bars along +x at rest at t = 0, gravity along -y.

    Angles p1, p2 from the downward vertical (first time must be 0):
        2 p1'' + cos(p1 - p2) p2'' + sin(p1 - p2) p2'^2 + 2 g sin p1 = 0
        p2'' + cos(p1 - p2) p1'' - sin(p1 - p2) p1'^2 + g sin p2 = 0
    Chaotic: compare for t <= 5. Columns t, x1, y1, x2, y2, energy.
    """

    def rhs(_: float, s: Array) -> Array:
        p1, p2, w1, w2 = s
        c, d = np.cos(p1 - p2), np.sin(p1 - p2)
        force = [-d * w2**2 - 2.0 * gravity * np.sin(p1), d * w1**2 - gravity * np.sin(p2)]
        return np.array([w1, w2, *np.linalg.solve([[2.0, c], [c, 1.0]], force)])

    p1, p2, w1, w2 = solve(rhs, [np.pi / 2, np.pi / 2, 0.0, 0.0], times, rtol).T
    x1, y1 = np.sin(p1), -np.cos(p1)
    x2, y2 = x1 + np.sin(p2), y1 - np.cos(p2)
    energy = w1**2 + 0.5 * w2**2 + np.cos(p1 - p2) * w1 * w2 + gravity * (y1 + y2)
    return {"t": np.asarray(times, float), "x1": x1, "y1": y1, "x2": x2, "y2": y2, "energy": energy}


SPRING_START = np.array([1.1, 0.0, 0.0, 2.0])
SPRING_END = np.array([0.09991917576658, 1.07765681031737, -1.98372231715598, 0.62278471235252])
SPRING_STEPS = (0.02, 0.01, 0.005, 0.0025)
# Position error |q_h(10) - q(10)| of three schemes at SPRING_STEPS, computed for this project.
SPRING_ERRORS = {
    "energy-momentum": (1.6684e-2, 3.8414e-3, 9.3641e-4, 2.3256e-4),
    "midpoint": (1.6276e-2, 3.7404e-3, 9.1217e-4, 2.2657e-4),
    "trapezoidal": (1.8324e-2, 4.4707e-3, 1.1095e-3, 2.7682e-4),
}


def spring(
    times: ArrayLike, stiffness: float = 100.0, rest: float = 1.0, start: ArrayLike = SPRING_START
) -> Array:
    """Planar spring pendulum, unit mass, no gravity: q'' = -k (|q| - l) q / |q|; rows (x, y, vx, vy).

    Conserved: H = |v|^2 / 2 + k (|q| - l)^2 / 2 = 2.5 and x vy - y vx = 2.2 for the default data.
    """

    def rhs(_: float, s: Array) -> Array:
        r = np.hypot(s[0], s[1])
        return np.concatenate([s[2:], -stiffness * (1.0 - rest / r) * s[:2]])

    return solve(rhs, start, times)


def spring_midpoint(step: float, end: float = 10.0) -> Array:
    """State at `end` by the implicit midpoint rule with exact fixed-point convergence, for the error
    table."""
    s = SPRING_START.copy()
    for _ in range(round(end / step)):
        new = s
        for _ in range(200):
            m = 0.5 * (s + new)
            r = np.hypot(m[0], m[1])
            last, new = new, s + step * np.array([m[2], m[3], *(-100.0 * (1.0 - 1.0 / r) * m[:2])])
            if np.abs(new - last).max() < 1e-15:
                break
        s = new
    return s
