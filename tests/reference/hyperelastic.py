"""Energies of materials in principal stretches, written down again, and what follows in simple states."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_bvp
from scipy.optimize import root

Array = NDArray[np.float64]
Energy = Callable[[Array], Array]
"""Of stretches (3, ...), which may be complex."""


def invariants(l: Array) -> tuple[Array, Array, Array]:
    a, b, c = l * l
    return a + b + c, a * b + b * c + c * a, l[0] * l[1] * l[2]


def split(l: Array) -> tuple[Array, Array, Array]:
    """Both isochoric invariants less 3, and the volume ratio."""
    I1, I2, J = invariants(l)
    return I1 * J ** (-2 / 3) - 3, I2 * J ** (-4 / 3) - 3, J


def simo(J: Array) -> Array:
    return (J * J - 1 - 2 * np.log(J)) / 4


def saint_venant(lam: float, mu: float) -> Energy:
    def energy(l: Array) -> Array:
        e = (l * l - 1) / 2
        return lam / 2 * e.sum(axis=0) ** 2 + mu * (e * e).sum(axis=0)

    return energy


def neo_hooke(lam: float, mu: float) -> Energy:
    def energy(l: Array) -> Array:
        I1, _, J = invariants(l)
        return mu / 2 * (I1 - 3) - mu * np.log(J) + lam / 2 * np.log(J) ** 2

    return energy


def mooney(a: float, b: float, bulk: float) -> Energy:
    def energy(l: Array) -> Array:
        i, k, J = split(l)
        return a * i + b * k + bulk * simo(J)

    return energy


def mooney_coupled(a: float, b: float, c: float) -> Energy:
    def energy(l: Array) -> Array:
        I1, I2, J = invariants(l)
        return a * (I1 - 3) + b * (I2 - 3) - 2 * (a + 2 * b) * np.log(J) + c / 2 * (J - 1) ** 2

    return energy


def yeoh(c: tuple[float, float, float], bulk: float) -> Energy:
    def energy(l: Array) -> Array:
        i, _, J = split(l)
        return c[0] * i + c[1] * i**2 + c[2] * i**3 + bulk * simo(J)

    return energy


def gent(mu: float, limit: float, bulk: float) -> Energy:
    def energy(l: Array) -> Array:
        i, _, J = split(l)
        return -mu * limit / 2 * np.log(1 - i / limit) + bulk * simo(J)

    return energy


def ogden(mu: ArrayLike, alpha: ArrayLike, bulk: float) -> Energy:
    def energy(l: Array) -> Array:
        J = l[0] * l[1] * l[2]
        terms = zip(np.atleast_1d(mu), np.atleast_1d(alpha), strict=True)
        return sum(m / a * ((l**a).sum(axis=0) * J ** (-a / 3) - 3) for m, a in terms) + bulk * simo(J)

    return energy


def blatz_ko(mu: float, nu: float) -> Energy:
    beta = 2 * nu / (1 - 2 * nu)

    def energy(l: Array) -> Array:
        I1, _, J = invariants(l)
        return mu / 2 * (I1 - 3) + mu / beta * (J**-beta - 1)

    return energy


def fibred(mu: float, k1: float, k2: float, kappa: float, bulk: float, angle: float) -> Energy:
    """Gasser, Ogden & Holzapfel with fibres at plus and minus `angle` from the first axis in the first plane."""

    def energy(l: Array) -> Array:
        i, _, J = split(l)
        along = J ** (-2 / 3) * (np.cos(angle) ** 2 * l[0] ** 2 + np.sin(angle) ** 2 * l[1] ** 2)
        e = kappa * i + (1 - 3 * kappa) * (along - 1)
        e = np.where(e.real > 0, e, 0)
        return mu / 2 * i + k1 / k2 * (np.exp(k2 * e * e) - 1) + bulk * simo(J)

    return energy


def nominal(W: Energy, l: ArrayLike) -> Array:
    """Nominal stresses (3, ...) along the axes, dW/dl by complex steps."""
    l = np.asarray(l, dtype=complex)
    stress = []
    for k in range(3):
        moved = l.copy()
        moved[k] += 1e-30j
        stress.append(W(moved).imag / 1e-30)
    return np.array(stress)


def state(W: Energy, given: dict[int, float], pressure: float = 0.0) -> tuple[Array, Array]:
    """Stretches and nominal stresses where some stretches are given and a pressure acts on the other faces."""
    free = [k for k in range(3) if k not in given]

    def full(l: Array) -> Array:
        stretch = np.ones(3)
        stretch[list(given)] = list(given.values())
        stretch[free] = l
        return stretch

    def unbalanced(l: Array) -> Array:
        stretch = full(l)
        P = nominal(W, stretch) + pressure * np.prod(stretch) / stretch
        return P[free]

    start = np.prod(list(given.values())) ** (-0.5 / len(free)) if given else 1.0
    found = root(unbalanced, np.full(len(free), start), tol=1e-13)
    assert np.abs(unbalanced(found.x)).max() < 1e-10
    return full(found.x), nominal(W, full(found.x))


def inflated(W: Energy, inner: float, outer: float, pressure: float, shape: str) -> Array:
    """Radial displacements inside and outside of a sphere or long cylinder under inner pressure (following).

    Equilibrium dP_r/dR + k (P_r - P_t)/R = 0 for r(R), k = 2 in the sphere, 1 in the cylinder, by collocation.
    """
    k = 2 if shape == "sphere" else 1

    def stresses(R: Array, y: Array) -> tuple[Array, Array]:
        hoop = y[0] / R
        along = hoop if shape == "sphere" else np.ones_like(hoop)
        P = nominal(W, np.array([y[1], hoop, along]))
        return P[0], P[1]

    def slopes(R: Array, y: Array) -> Array:
        """y = (r, r'): r'' from the chain rule on P_r(r', r/R)."""
        P, T = stresses(R, y)
        d = 1e-6
        along, across = np.array([[0], [d]]), np.array([[d], [0]])
        by_stretch = (stresses(R, y + along)[0] - stresses(R, y - along)[0]) / (2 * d)
        by_radius = (stresses(R, y + across)[0] - stresses(R, y - across)[0]) / (2 * d)
        by_place = (stresses(R + d, y)[0] - stresses(R - d, y)[0]) / (2 * d)
        return np.array([y[1], -(k * (P - T) / R + by_radius * y[1] + by_place) / by_stretch])

    def ends(a: Array, b: Array) -> Array:
        inside = stresses(np.array([inner]), a[:, None])[0][0] + pressure * (a[0] / inner) ** k
        return np.array([inside, stresses(np.array([outer]), b[:, None])[0][0]])

    R = np.linspace(inner, outer, 41)
    found = solve_bvp(slopes, ends, R, np.array([R, np.ones_like(R)]), tol=1e-9, max_nodes=20000)
    assert found.success, found.message
    return np.array([found.y[0, 0] - inner, found.y[0, -1] - outer])
