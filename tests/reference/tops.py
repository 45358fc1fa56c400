"""Tops with a fixed point: Geradin & Cardona's heavy top, Lagrange's top in steady and cuspidal motion."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk

from .integrate import Array, axis_rotation, cross, read_table, skew, solve, write_table

GRAVITY = 9.81


def heavy_top(times: ArrayLike, rtol: float = 1e-13) -> dict[str, Array]:
    """Heavy top m = 15, J_com = diag(.234375, .46875, .234375), com (0, 1, 0) in the body, fixed point at the
    origin.

    J_O W' + W x J_O W = X x R^T (0, 0, -m g), R' = R [W]x, R(0) = I, W(0) = (0, 150, -4.61538); times[0] = 0.
    Keys t; x (com), W (body), of shape (n, 3); R (n, 3, 3); energy, momentum3 (n,).
    """
    mass, arm = 15.0, np.array([0.0, 1.0, 0.0])
    diagonal = np.array([0.234375 + mass, 0.46875, 0.234375 + mass])

    def rhs(_: float, y: Array) -> Array:
        r, w = y[:9].reshape(3, 3), y[9:]
        moment = cross(arm, -mass * GRAVITY * r[2]) - cross(w, diagonal * w)
        return np.concatenate([(r @ skew(w)).ravel(), moment / diagonal])

    states = solve(rhs, [*np.eye(3).ravel(), 0.0, 150.0, -4.61538], times, rtol)
    r, w = states[:, :9].reshape(-1, 3, 3), states[:, 9:]
    spin = w * diagonal
    energy = 0.5 * np.sum(w * spin, axis=1) + mass * GRAVITY * (r @ arm)[:, 2]
    momentum3 = np.sum(r[:, 2] * spin, axis=1)
    return {
        "t": np.asarray(times, float),
        "x": r @ arm,
        "W": w,
        "R": r,
        "energy": energy,
        "momentum3": momentum3,
    }


HEAVY_COLUMNS = [
    "t",
    "x",
    "y",
    "z",
    "W1",
    "W2",
    "W3",
    *(f"R{i}{j}" for i in "123" for j in "123"),
    "energy",
    "momentum3",
]


def heavy_top_cached() -> dict[str, Array]:
    """Columns `HEAVY_COLUMNS` of the heavy top at t = 0, 0.1 ... 2."""
    return read_table("heavy_top.csv")


def write_heavy_top() -> None:
    """Regenerate the table (a few seconds)."""
    a = heavy_top(np.linspace(0.0, 2.0, 21))
    r = a["R"].reshape(-1, 9)
    rows = np.column_stack([a["t"], a["x"], a["W"], r, a["energy"], a["momentum3"]])
    head = "Heavy top of Geradin & Cardona (m = 15, fixed point), own computation,\n"
    head += "Dormand-Prince 8(5,3), rtol 1e-13;"
    head += " x y z com, W body angular velocity, R body to space; definition: tests/reference/tops.py"
    write_table("heavy_top.csv", head, HEAVY_COLUMNS, rows)


CONE_MASS = 2700.0 * np.pi * 0.05**2 * 0.1 / 3.0


@dataclass(frozen=True)
class Cone:
    """Cone r = .05, h = .1, density 2700, tip fixed at the origin; axis 3 is the axis of symmetry."""

    mass: float = CONE_MASS
    centre: float = 0.075  # distance of the com from the tip, 3 h / 4
    axial: float = 0.3 * CONE_MASS * 0.05**2
    transverse_com: float = CONE_MASS * (0.15 * 0.05**2 + 0.0375 * 0.1**2)

    @property
    def transverse(self) -> float:
        """Moment of inertia about a transverse axis through the tip."""
        return self.transverse_com + self.mass * self.centre**2

    @property
    def weight_moment(self) -> float:
        """m g l."""
        return self.mass * GRAVITY * self.centre


CONE = Cone()
NUTATION, PRECESSION = np.pi / 3, 10.0


def steady_spin(top: Cone = CONE, nutation: float = NUTATION, precession: float = PRECESSION) -> float:
    """Spin psi' of steady precession: m g l / (J3 wp) + (A - J3) / J3 wp cos th0 (135.6 rad/s for the
    cone)."""
    ratio = (top.transverse - top.axial) / top.axial
    return float(top.weight_moment / (top.axial * precession) + ratio * precession * np.cos(nutation))


def steady(times: ArrayLike) -> dict[str, Array]:
    """Exact steady precession: R = R3(wp t) R1(th0) R3(ws t), com = l R e3; gravity along -e3.

    Keys t; x, v (com), omega (spatial angular velocity), each (n, 3); R (n, 3, 3).
    """
    t = np.asarray(times, dtype=float)
    tilt = axis_rotation([1, 0, 0], NUTATION)
    spin = steady_spin()
    e3 = np.array([0.0, 0.0, 1.0])
    r = np.array([axis_rotation(e3, PRECESSION * s) @ tilt @ axis_rotation(e3, spin * s) for s in t])
    axis = r[:, :, 2]
    v = CONE.centre * PRECESSION * np.cross(e3, axis)
    return {"t": t, "x": CONE.centre * axis, "v": v, "omega": PRECESSION * e3 + spin * axis, "R": r}


def cuspidal_data() -> tuple[float, float, float, float]:
    """(u1, u2, rate, parameter) of cos th(t) = u1 + (u2 - u1) sn^2(rate t + K | m) for zero precession at the
    start.

    u'^2 = (u2 - u) [b (1 - u^2) - a^2 (u2 - u)] with u2 = cos th0, a = J3 W3 / A, b = 2 m g l / A; roots u1 <
    u2 < u3.
    """
    a = CONE.axial * steady_spin() / CONE.transverse
    b = 2.0 * CONE.weight_moment / CONE.transverse
    u2 = np.cos(NUTATION)
    u1, u3 = np.sort(np.roots([b, -(a**2), a**2 * u2 - b]).real)
    return float(u1), float(u2), float(np.sqrt(b * (u3 - u1)) / 2.0), float((u2 - u1) / (u3 - u1))


def cuspidal_period() -> float:
    """Nutation period 2 K(m) / rate."""
    _, _, rate, parameter = cuspidal_data()
    return float(2.0 * ellipk(parameter) / rate)


def cuspidal(times: ArrayLike) -> dict[str, Array]:
    """Cuspidal motion of the cone: th0 = pi/3, th' = phi' = 0, psi' = `steady_spin()` at t = 0.

    Keys t, nutation, precession, height (of the com), each (n,). phi' = a (u2 - u) / (1 - u^2), by
    quadrature.
    """
    u1, u2, rate, m = cuspidal_data()
    a = CONE.axial * steady_spin() / CONE.transverse

    def cosine(t: ArrayLike) -> Array:
        return np.asarray(u1 + (u2 - u1) * ellipj(rate * np.asarray(t) + ellipk(m), m)[0] ** 2)

    def turning(t: float) -> float:
        u = cosine(t)
        return float(a * (u2 - u) / (1.0 - u * u))

    t = np.asarray(times, dtype=float)
    pieces = [quad(turning, t0, t1, epsabs=1e-14, epsrel=1e-13, limit=200)[0] for t0, t1 in pairwise(t)]
    first = quad(turning, 0.0, t[0], epsabs=1e-14, epsrel=1e-13, limit=200)[0]
    precession = first + np.concatenate([[0.0], np.cumsum(pieces)])
    u = cosine(t)
    return {"t": t, "nutation": np.arccos(u), "precession": precession, "height": CONE.centre * u}


def cuspidal_advance() -> float:
    """Precession per nutation period, radians."""
    return float(np.diff(cuspidal([0.0, cuspidal_period()])["precession"])[0])


def symmetric_top(times: ArrayLike, rtol: float = 1e-13) -> dict[str, Array]:
    """Heavy symmetric top A = .05, C = .02, m g l = .5, th0 = .3, th' = phi' = 0, psi' = 50; times[0] = 0.

    A th'' = sin th (A phi'^2 cos th - C W3 phi' + m g l), phi' = C W3 (cos th0 - cos th) / (A sin^2 th), W3 =
    50. Keys t, nutation, precession, nutation_rate, energy.
    """
    a, c, mgl, start, w3 = 0.05, 0.02, 0.5, 0.3, 50.0

    def turning(th: ArrayLike) -> Array:
        return np.asarray(c * w3 * (np.cos(start) - np.cos(th)) / (a * np.sin(th) ** 2))

    def rhs(_: float, y: Array) -> Array:
        p = turning(y[0])
        return np.array([y[1], np.sin(y[0]) * (a * p * p * np.cos(y[0]) - c * w3 * p + mgl) / a, p])

    th, rate, phi = solve(rhs, [start, 0.0, 0.0], times, rtol).T
    kinetic = 0.5 * a * (rate**2 + (turning(th) * np.sin(th)) ** 2) + 0.5 * c * w3**2
    energy = kinetic + mgl * np.cos(th)
    return {
        "t": np.asarray(times, float),
        "nutation": th,
        "precession": phi,
        "nutation_rate": rate,
        "energy": energy,
    }


def symmetric_top_maximum() -> float:
    """Largest nutation angle: second root of th'^2 = 0, (C W3)^2 (u0 - u) = 2 A m g l (1 - u^2), u = cos
    th."""
    u0, ratio = np.cos(0.3), (0.02 * 50.0) ** 2 / (2.0 * 0.05 * 0.5)
    return float(np.arccos(brentq(lambda u: ratio * (u0 - u) - (1.0 - u * u), 0.5, u0 - 1e-9, xtol=1e-16)))
