"""Buoyancy in the stabilisation of flows whose velocities and pressures are of equal order."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from visviva.model.term import Stencils, Term
from visviva.thermal.carried_heat import CarriedHeat

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class StabilisedLift(Term):
    """The force of `Buoyancy` within the residual of momentum that SUPG and PSPG weight.

    With the force f per volume, the velocity c that carries and the fluid's own tau,

        - tau (c . grad w) . f,   tau / rho grad q . f

    test velocities and pressures (Tezduyar 1991). The unknowns are those of `CarriedHeat`, then the pressures.

    Parameters
    ----------
    heat : CarriedHeat
    pressures : int array (m, k)
    weight : callable
        Force (d,) per volume and temperature.
    density, viscosity, convection : float
        Of the fluid; without convection, 0, nothing is carried along.
    stabilised : callable
        Factors (m,) of the metric, and directions (m, d) along which the residual is left out, of now.
    """

    kind = "stabilisation"
    brings = "dissipation"

    def __init__(
        self,
        heat: CarriedHeat,
        pressures: NDArray[np.int32],
        weight: Callable[[], Array],
        density: float,
        viscosity: float,
        convection: float,
        stabilised: Callable[[], tuple[Array, Array]],
    ) -> None:
        super().__init__()
        self.heat, self.weight, self.stabilised = heat, weight, stabilised
        self.unknowns = np.hstack([heat.unknowns, pressures])
        self.order = np.concatenate([heat.order, np.zeros(pressures.shape[1], dtype=np.int32)])
        self.density, self.viscosity, self.convection = density, viscosity, convection

    def _split(self, x: Array) -> tuple[Array, Array]:
        return self.heat.split(x[:, : -self.heat.e.N.shape[1]])

    def _at(self, s: Stencils) -> tuple[Array, ...]:
        """Force by temperature (m, d), temperature (m, q), c . grad N (m, q, k), tau (m, q), its slope by c."""
        e, (T, v) = self.heat.e, self._split(s.x)
        factors, blind = self.stabilised()
        weight = self.weight()
        by_T = weight - (blind @ weight)[:, None] * blind
        c = self.convection * np.einsum("qk,mkd->mqd", e.N, v)
        along = factors[:, None, None] * np.einsum("mqij,mqj->mqi", e.metric, c)
        in_time = 4 / s.step.h**2 if s.step.transport_factor else 0.0
        spread = (self.viscosity / self.density) ** 2 * factors[:, None] * e.square / 9
        tau = (in_time + np.sum(along * c, axis=-1) + spread) ** -0.5
        carried = np.einsum("mqkd,mqd->mqk", e.G, c, optimize=True)
        return by_T, (T - self.heat.zero) @ e.N.T, carried, tau, -(tau**3)[..., None] * along

    def residual(self, s: Stencils) -> Array:
        by_T, T, carried, tau, _ = self._at(s)
        e, m = self.heat.e, len(T)
        size = e.size * tau * T
        on_v = -np.einsum("mq,mqa,mi->mai", size, carried, by_T, optimize=True)
        on_p = np.einsum("mq,mqai,mi->ma", size / self.density, e.G, by_T, optimize=True)
        return np.hstack([np.zeros((m, e.N.shape[1])), on_v.reshape(m, -1), on_p])

    def tangent(self, s: Stencils) -> Array:
        by_T, T, carried, tau, slope = self._at(s)
        e, theta = self.heat.e, s.step.theta
        m, _, n, d = e.G.shape
        size, over = theta * e.size, theta * e.size / self.density
        lifts = np.einsum("mqai,mi->mqa", e.G, by_T, optimize=True)
        K = np.zeros((m, s.x1.shape[1], s.x1.shape[1]))
        velocity, pressure = slice(n, n + n * d), slice(n + n * d, None)
        by = np.einsum("mq,mqa,mi,qb->maib", -size * tau, carried, by_T, e.N, optimize=True)
        K[:, velocity, :n] = by.reshape(m, n * d, n)
        K[:, pressure, :n] = np.einsum("mq,mqa,qb->mab", over * tau, lifts, e.N, optimize=True)
        of_test = tau[..., None, None] * e.G + carried[..., None] * slope[:, :, None, :]
        by = np.einsum("mq,mqaj,mi,qb->maibj", -self.convection * size * T, of_test, by_T, e.N, optimize=True)
        K[:, velocity, velocity] = by.reshape(m, n * d, n * d)
        by = np.einsum("mq,mqa,mqj,qb->mabj", self.convection * over * T, lifts, slope, e.N, optimize=True)
        K[:, pressure, velocity] = by.reshape(m, n, n * d)
        return K

    def work(self, s: Stencils) -> Array:
        """Work (m,) on the velocities over the step, as the fluid books its own stabilisation."""
        _, v = self._split(s.x)
        n = self.heat.e.N.shape[1]
        on_v = self.residual(s)[:, n:-n].reshape(v.shape)
        return np.asarray(-s.step.h * np.sum(on_v * v, axis=(1, 2)))
