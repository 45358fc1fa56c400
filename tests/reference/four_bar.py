"""Four-bar mechanisms: IFToMM A02 (N parallel cranks, singular positions) and a planar crank-rocker."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipk

from .integrate import Array


def parallel_stiffness(loops: int = 2, gravity: float = 9.81) -> float:
    """k in th'' = -k cos th: ((N + 1)/3 + N) th'' + ((N + 1)/2 + N) g cos th = 0 for unit rods."""
    return ((loops + 1) / 2 + loops) / ((loops + 1) / 3 + loops) * gravity


def parallel_period(loops: int = 2, speed: float = 1.0, gravity: float = 9.81) -> float:
    """Time of one revolution, 4 K(-4 k / speed^2) / speed."""
    return float(4.0 * ellipk(-4.0 * parallel_stiffness(loops, gravity) / speed**2) / speed)


def parallel(times: ArrayLike, loops: int = 2, speed: float = 1.0, gravity: float = 9.81) -> dict[str, Array]:
    """A02: N + 1 unit rods hinged at (0,0), (1,0) ... joined by N unit rods at their tops; m = L = 1.

    Starts upright, B0 = (0, 1) with velocity (`speed`, 0), gravity along -y. On the parallelogram branch the
    angle chi from the upward vertical (clockwise) obeys chi'^2 = speed^2 + 4 k sin^2(chi/2), so sin(chi/2) =
    sn(speed t / 2 | m) with m = -4 k / speed^2 (negative parameter: imaginary modulus transformation).
    Columns t, x, y (of B0), rate, energy. `rate` is th' = -chi' with th the angle from +x.
    """
    t = np.asarray(times, dtype=float)
    k = parallel_stiffness(loops, gravity)
    p = 4.0 * k / speed**2
    s1, c1, d1, _ = ellipj(0.5 * speed * t * np.sqrt(1.0 + p), p / (1.0 + p))
    sn, cn = s1 / d1 / np.sqrt(1.0 + p), c1 / d1
    rate = -np.sqrt(speed**2 + 4.0 * k * sn**2)
    x, y = 2.0 * sn * cn, 1.0 - 2.0 * sn**2
    inertia, weight = (loops + 1) / 3 + loops, ((loops + 1) / 2 + loops) * gravity
    return {"t": t, "x": x, "y": y, "rate": rate, "energy": 0.5 * inertia * rate**2 + weight * y}


CRANK, COUPLER, ROCKER, GROUND = 0.5, 1.8, 1.5, 2.0
CRANK_RATE, CRANK_START, GRAVITY = 5.0, np.pi / 2, 9.81


def crank_rocker_geometry(angle: complex) -> tuple[list[complex], list[complex], list[complex]]:
    """Points A, B (as x, y of each) and slopes d(angle of rod)/d(crank angle) of crank, coupler, rocker.

    Crank pivot (0, 0), rocker pivot (2, 0), A = end of the crank, B above the line from A to the rocker
    pivot. Works for a complex `angle` too, for derivatives by a complex step.
    """
    ax, ay = CRANK * np.cos(angle), CRANK * np.sin(angle)
    dx, dy = GROUND - ax, -ay
    square = dx * dx + dy * dy
    along = (COUPLER**2 - ROCKER**2 + square) / (2.0 * square)
    across = np.sqrt(COUPLER**2 / square - along * along)
    bx, by = ax + along * dx - across * dy, ay + along * dy + across * dx
    # velocity of B: A' + beta' (ex x (B - A)) = gamma' (ex x (B - D)), two linear equations for beta', gamma'
    cx, cy, rx, ry = bx - ax, by - ay, bx - GROUND, by
    det = cy * rx - cx * ry
    beta = (ax * ry - ay * rx) / det
    gamma = (ax * cy - ay * cx) / det
    return [ax, ay, bx, by], [1.0, beta, gamma], [cx, cy, rx, ry]


def crank_rocker_energies(angle: complex) -> tuple[complex, complex]:
    """Inertia I(angle) with T = I angle'^2 / 2, and potential V; slender rods of 1 kg each, gravity along
    -y."""
    (ax, ay, _, by), (_, beta, gamma), (cx, cy, _, _) = crank_rocker_geometry(angle)
    mx, my = -ay - 0.5 * beta * cy, ax + 0.5 * beta * cx
    inertia = CRANK**2 / 3 + ROCKER**2 / 3 * gamma**2 + COUPLER**2 / 12 * beta**2 + mx * mx + my * my
    return inertia, GRAVITY * (0.5 * ay + 0.5 * (ay + by) + 0.5 * by)


def crank_rocker_rate(angle: float) -> float:
    """Crank rate from the energy integral I th'^2 / 2 + V = E0; the crank never stops with the default
    data."""
    inertia0, potential0 = crank_rocker_energies(CRANK_START)
    inertia, potential = crank_rocker_energies(angle)
    return float(np.sqrt((inertia0 * CRANK_RATE**2 + 2.0 * (potential0 - potential)) / inertia))


def crank_rocker_defect(angle: float) -> float:
    """I th'' + I_th th'^2 / 2 + V_th with th'' from the slope of `crank_rocker_rate`: zero up to the
    differences."""
    inertia, potential = crank_rocker_energies(angle + 1e-30j)
    rate, h = crank_rocker_rate(angle), 1e-5
    second = rate * (crank_rocker_rate(angle + h) - crank_rocker_rate(angle - h)) / (2.0 * h)
    return float(inertia.real * second + 1e30 * (0.5 * inertia.imag * rate**2 + potential.imag))


def crank_times(samples: int = 1024) -> tuple[float, Array, NDArray[np.complex128]]:
    """Revolution time T and Fourier series of t(th) = T (th - th0) / 2 pi + sum c_k (exp(i k th) - exp(i k
    th0)).

    dt/dth = 1 / rate is smooth and periodic, so its Fourier coefficients fall to round-off; returns (T, k,
    c_k), k > 0.
    """
    angles = 2.0 * np.pi * np.arange(samples) / samples
    coefficients = np.fft.rfft([1.0 / crank_rocker_rate(a) for a in angles])[: samples // 2] / samples
    k = np.arange(1.0, samples // 2)
    return float(2.0 * np.pi * coefficients[0].real), k, coefficients[1:] / (1j * k)


def crank_angles(times: ArrayLike, samples: int = 1024) -> Array:
    """Crank angle at `times` (any order) by Newton on the series of `crank_times`; `samples` is its accuracy
    knob."""
    period, k, c = crank_times(samples)

    def elapsed(th: Array) -> Array:
        wave = np.exp(1j * np.outer(th, k)) - np.exp(1j * k * CRANK_START)
        return np.asarray(period * (th - CRANK_START) / (2.0 * np.pi) + 2.0 * np.real(wave @ c))

    t = np.asarray(times, dtype=float)
    th: Array = CRANK_START + 2.0 * np.pi * t / period
    for _ in range(50):
        step = np.array([crank_rocker_rate(a) for a in th]) * (elapsed(th) - t)
        th = th - step
        if np.abs(step).max() < 1e-13 * max(1.0, np.abs(th).max()):
            return th
    raise RuntimeError("the crank angle did not converge")


def crank_rocker(times: ArrayLike, samples: int = 1024) -> dict[str, Array]:
    """Crank-rocker .5 / 1.8 / 1.5 / 2: crank upright, 5 rad/s counter-clockwise, E0 = 23.48832307490 J.

    Columns t, angle, rate, energy, ax, ay, bx, by at `times`, by quadrature of the energy integral (no time
    stepping).
    """
    angle = crank_angles(times, samples)
    rate = np.array([crank_rocker_rate(a) for a in angle])
    points = np.array([np.real(crank_rocker_geometry(a)[0]) for a in angle])
    inertia, potential = np.real([crank_rocker_energies(a) for a in angle]).T
    energy = 0.5 * inertia * rate**2 + potential
    return {"t": np.asarray(times, dtype=float), "angle": angle, "rate": rate, "energy": energy} | dict(
        zip(("ax", "ay", "bx", "by"), points.T, strict=True)
    )
