"""Servo-controlled rotary crane: exact controls of the load path by differential flatness.

The load follows r(t) = r0 + (rf - r0) s(t / T) with s = 126 x^5 - 420 x^6 + 540 x^7 - 315 x^8 + 70 x^9. Its
equation m r'' = -m g e3 + S (p - r)/|p - r| fixes the rope direction along a = r'' + g e3, so the trolley is
where that line meets the plane z = 0, p = r - (r_3 / a_3) a. Then u = |p|, alpha = arg p, L = |r - p|, theta
= (L - L0)/r_w, and with the rope tension S = m |a| and the rope's pull F = -m a on the trolley

    bridge torque   d/dt[(J + M u^2) alpha'] - (p x F)_3,   J = 218.9434, M = 53
    trolley force   M (u'' - u alpha'^2) - F . p / u
    winch torque    0.02 theta'' - S r_w.

Signs: each control acts on its own coordinate (alpha, u, theta); theta unwinds the rope.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from . import crane
from .integrate import Array, read_table, write_table

START = np.array([1.5, 0.0, -1.2])
END = np.array([0.5, 1.5, -0.8])
DURATION = 5.0
SHAPE = Polynomial([0, 0, 0, 0, 0, 126.0, -420.0, 540.0, -315.0, 70.0])
COLUMNS = [
    *("t", "alpha", "u", "theta", "length", "bridge_torque", "trolley_force", "winch_torque", "tension"),
    *("x", "y", "z", "alpha_rate", "u_rate", "theta_rate"),
]


def load_path(t: float, derivative: int = 0) -> Array:
    """Prescribed load position or one of its time derivatives, shape (3,); constant before 0 and after T."""
    x = np.clip(t / DURATION, 0.0, 1.0)
    shape = SHAPE.deriv(derivative) if derivative else SHAPE
    offset = START if derivative == 0 else np.zeros(3)
    return np.asarray(offset + (END - START) * shape(x) / DURATION**derivative)


def trolley_path(t: float) -> tuple[Array, Array, Array, Array]:
    """Trolley position and its first two derivatives in the plane, shape (2,) each, and a = r'' + g e3."""
    r, v, a, j, s = (load_path(t, k) for k in range(5))
    a = a + np.array([0.0, 0.0, crane.GRAVITY])
    w0 = a[:2] / a[2]
    w1 = (j[:2] - j[2] * w0) / a[2]
    w2 = (s[:2] - s[2] * w0 - 2.0 * j[2] * w1) / a[2]
    z0, z1, z2 = r[2], v[2], a[2] - crane.GRAVITY
    p2 = a[:2] - z2 * w0 - 2.0 * z1 * w1 - z0 * w2
    return r[:2] - z0 * w0, v[:2] - z1 * w0 - z0 * w1, p2, a


def length_derivatives(p: Array, dp: Array, ddp: Array, t: float) -> tuple[float, float, float]:
    """Rope length |r - p| and its first two derivatives."""
    planar = [load_path(t, k) - np.append(x, 0.0) for k, x in enumerate((p, dp, ddp))]
    length = float(np.linalg.norm(planar[0]))
    rate = planar[0] @ planar[1] / length
    return length, rate, (planar[0] @ planar[2] + planar[1] @ planar[1] - rate**2) / length


def controls(t: float) -> Array:
    """One row of `COLUMNS`."""
    p, dp, ddp, a = trolley_path(t)
    u = np.hypot(*p)
    alpha_rate, u_rate = (p[0] * dp[1] - p[1] * dp[0]) / u**2, p @ dp / u
    inertial = crane.TROLLEY_AND_WINCH * ddp + crane.LOAD * a[:2]
    swing = crane.AXIS_INERTIA * ((p[0] * ddp[1] - p[1] * ddp[0]) - 2.0 * u * u_rate * alpha_rate) / u**2
    bridge = swing + p[0] * inertial[1] - p[1] * inertial[0]
    length, rate, second = length_derivatives(p, dp, ddp, t)
    tension = crane.LOAD * np.linalg.norm(a)
    winch = crane.WINCH_INERTIA * second / crane.WINCH_RADIUS - tension * crane.WINCH_RADIUS
    theta = (length - crane.ROPE_LENGTH) / crane.WINCH_RADIUS
    head = [t, np.arctan2(p[1], p[0]), u, theta, length, bridge, inertial @ p / u, winch, tension]
    return np.array([*head, *load_path(t), alpha_rate, u_rate, rate / crane.WINCH_RADIUS])


def solution(times: ArrayLike) -> dict[str, Array]:
    """Columns `COLUMNS` at any `times`."""
    rows = np.array([controls(t) for t in np.atleast_1d(np.asarray(times, dtype=float))])
    return dict(zip(COLUMNS, rows.T, strict=True))


def cached() -> dict[str, Array]:
    """The same columns at t = 0, 0.25 ... 5 from tests/data."""
    return read_table("crane_servo.csv")


def write() -> None:
    """Regenerate the table."""
    table = solution(np.linspace(0.0, DURATION, 21))
    head = "Servo-controlled rotary crane, exact solution by differential flatness, own computation;\n"
    head += "definition: tests/reference/crane_servo.py (r0 = (1.5, 0, -1.2), rf = (0.5, 1.5, -0.8), T = 5)"
    write_table("crane_servo.csv", head, COLUMNS, np.column_stack([table[c] for c in COLUMNS]))
