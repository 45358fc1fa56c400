"""Torque-free rigid body by Jacobi's elliptic functions, with attitude, period and flip interval.

J1 < J2 < J3, body components: J W' + W x J W = 0 with invariants 2 T and L^2. For L^2 > 2 T J2

    W = (s a1 cn, a2 sn, s a3 dn)(p t + u0 | m),   s = sign W3(0),

with a_i, p, m from the invariants; for L^2 < 2 T J2 the axes 1 and 3 change roles. Attitude R (body to space)
from the constant spatial angular momentum R J W: Euler angles 3-1-3 about L, phi' = |L| (J1 W1^2 + J2 W2^2) /
(J1^2 W1^2 + J2^2 W2^2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipj, ellipkinc, ellipkm1

from .integrate import Array

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def excess(j: Array, w: Array) -> Array:
    """L^2 - 2 T J_i for the three axes, as sums without cancellation."""
    return np.array([np.sum(j * w * w * (j - axis)) for axis in j])


def constants(inertia: ArrayLike, start: ArrayLike) -> tuple[Array, float, float, bool]:
    """Amplitudes (a1, a2, a3), rate p, 1 - m, and whether axes 1 and 3 changed roles."""
    j, w = np.asarray(inertia, dtype=float), np.asarray(start, dtype=float)
    swapped = bool(excess(j, w)[1] < 0.0)
    j1, j2, j3 = j[::-1] if swapped else j
    low, middle, high = excess(j, w)[::-1] if swapped else excess(j, w)
    high = -high
    a = np.sqrt([high / (j1 * (j3 - j1)), high / (j2 * (j3 - j2)), low / (j3 * (j3 - j1))])
    rate = np.sqrt((j3 - j2) * low / (j1 * j2 * j3))
    return a, float(rate), float((j3 - j1) * middle / ((j3 - j2) * low)), swapped


def angular_velocity(times: ArrayLike, inertia: ArrayLike, start: ArrayLike) -> Array:
    """Body components of the angular velocity at `times`, shape (n, 3)."""
    a, rate, complement, swapped = constants(inertia, start)
    m = 1.0 - complement
    w = np.asarray(start, dtype=float)[::-1] if swapped else np.asarray(start, dtype=float)
    sign = 1.0 if w[2] >= 0 else -1.0
    phase = ellipkinc(np.arctan2(w[1] / a[1], sign * w[0] / a[0]), m)
    sn, cn, dn, _ = ellipj(rate * np.asarray(times, dtype=float) + phase, m)
    result = np.stack([sign * a[0] * cn, a[1] * sn, sign * a[2] * dn], axis=-1)
    return result[..., ::-1] if swapped else result


def period(inertia: ArrayLike, start: ArrayLike) -> float:
    """Period of the angular velocity in the body, 4 K(m) / p."""
    _, rate, complement, _ = constants(inertia, start)
    return float(4.0 * ellipkm1(complement) / rate)


def flip_interval(small: float, inertia: ArrayLike = (1.0, 2.0, 3.0)) -> float:
    """Time between two flips of the body started with W = (small, 1, small): half a period."""
    return 0.5 * period(inertia, [small, 1.0, small])


def euler_frame(momentum: Array, precession: float) -> Array:
    """R3(phi) R1(theta) R3(psi) with body components of the momentum |L| (sin th sin psi, sin th cos psi, cos
    th)."""
    unit = momentum / np.linalg.norm(momentum)
    psi, st = np.arctan2(unit[0], unit[1]), np.hypot(unit[0], unit[1])

    def turn(angle: float) -> Array:
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    tilt = np.array([[1.0, 0.0, 0.0], [0.0, unit[2], -st], [0.0, st, unit[2]]])
    return np.asarray(turn(precession) @ tilt @ turn(psi))


def precession(times: Array, inertia: Array, start: ArrayLike) -> Array:
    """Integral of phi' from 0 to each time: Gauss-Legendre over panels of at most 1/40 of the period."""
    size = period(inertia, start) / 40.0
    total, angles, last = 0.0, [], 0.0
    magnitude = np.linalg.norm(inertia * np.asarray(start))
    for t in times:
        count = max(1, int(np.ceil(abs(t - last) / size)))
        edges = np.linspace(last, t, count + 1)
        half = 0.5 * (t - last) / count
        w = angular_velocity(0.5 * (edges[:-1] + edges[1:])[:, None] + half * NODES, inertia, start)
        part = inertia[:2] * w[..., :2] ** 2
        rate = magnitude * part.sum(axis=-1) / (inertia[:2] * part).sum(axis=-1)
        total += half * float((rate @ WEIGHTS).sum())
        angles.append(total)
        last = t
    return np.array(angles)


def attitude(times: ArrayLike, inertia: ArrayLike, start: ArrayLike) -> Array:
    """Rotation matrices R (body to space), R = I at t = 0, shape (n, 3, 3)."""
    t, j = np.asarray(times, dtype=float), np.asarray(inertia, dtype=float)
    first = euler_frame(j * np.asarray(start, dtype=float), 0.0)
    w = angular_velocity(t, j, start)
    angles = precession(t, j, start)
    return np.array([first.T @ euler_frame(j * wi, a) for wi, a in zip(w, angles, strict=True)])
