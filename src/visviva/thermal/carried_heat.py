"""Terms of heat that a fluid carries: transport and conduction, what leaves with it, buoyancy, viscous heating."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from visviva.body.element import geometry
from visviva.body.solid_fields import linear
from visviva.flow.elements import SIMPLICES, STABILISED, Batch
from visviva.mesh.cells import CELLS
from visviva.mesh.geometry import jacobians
from visviva.mesh.quadrature import Rule
from visviva.model.term import Stencils, Term

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Source = Callable[[float], Array]
"""Heat (m, q) per time and volume that arises at the points of elements, of time."""

LEAST = 1e-6
"""Part of what is large in residuals and slopes below which discontinuity capturing is smooth."""


class Carried:
    """Data of elements of one type: shape functions, their derivatives, volumes and the metric.

    Attributes
    ----------
    N, G, size : arrays (q, k), (m, q, k, d), (m, q)
        Shape functions, their gradients, volumes.
    N1, G1 : arrays (q, k), (m, q, k, d)
        The pressures' functions at the corners, zero at other nodes, and their gradients.
    laplace : array (m, q, k)
        Second derivatives of the shape functions, summed: of gradients that are interpolated by the same functions.
    metric, square, length : arrays (m, q, d, d), (m, q), (m,)
        Of the edges, halved in quadratic elements: 4 / l^2; nine times its square; size of an element.
    """

    def __init__(self, batch: Batch) -> None:
        self.nodes, self.N = batch.nodes, batch.N
        self.G, self.size = batch.geometry()
        d = self.G.shape[-1]
        halved = 1.0 if batch.cell in STABILISED else 4.0
        back = np.linalg.inv(jacobians(batch.points, batch.nodes, CELLS[batch.cell].dN(batch.rule.points)))
        self.N1 = at_corners(batch.cell, batch.rule.points)
        corners = linear(CELLS[batch.cell]).dN(batch.rule.points)
        others = self.G.shape[2] - corners.shape[1]
        self.G1 = np.pad(corners @ back, [(0, 0), (0, 0), (0, others), (0, 0)])
        self.metric = halved * np.swapaxes(back, -1, -2) @ batch.shape @ back
        self.square = (
            9 * np.sum(self.metric**2, axis=(-2, -1)) / d
        )  # as diffusion of little elements has it, Shakib (1991)
        self.length = batch.edges / np.sqrt(halved)
        self.laplace = self._laplacian(batch)

    def _laplacian(self, batch: Batch) -> Array:
        cell = CELLS[batch.cell]
        if batch.cell in STABILISED and cell.family in SIMPLICES:
            return np.zeros(self.G.shape[:3])
        at_nodes = Rule(cell.nodes, np.ones(len(cell.nodes)))
        there = geometry(batch.points, batch.nodes, batch.cell, rule=at_nodes).gradients  # (m, a, k, d)
        m, q, k, d = self.G.shape
        of_nodes = self.G.reshape(m, q, k * d)
        values = np.swapaxes(there, 2, 3).reshape(m, k * d, k)  # (m, (a, d), k)
        return np.asarray(of_nodes @ values)


def at_corners(cell: str, points: Array) -> Array:
    """Functions (q, k) of the corners of a cell at points, those of a fluid's pressures: zero for its other nodes."""
    found = linear(CELLS[cell]).N(points)
    return np.pad(found, [(0, 0), (0, len(CELLS[cell].nodes) - found.shape[1])])


class CarriedHeat(Term):
    """``c (T' + div(v T)) - div(k grad T)`` of temperatures above the reference, with SUPG and capturing.

    The velocity's divergence vanishes against the pressures' functions alone. So transport is tested by these in the
    form that balances heat, and by what test functions have beyond them in the convective form, which keeps constants.

    The unknowns are the temperatures of an element's nodes and then their velocities.

    Parameters
    ----------
    elements : Carried
    unknowns : int array (m, k + k d)
    content, conductivity, reference : float
        Heat per volume and temperature, heat per length and temperature, the temperature without heat.
    heating : float
        Viscosity, where what it takes from the flow heats.
    is_stabilised : bool
        By SUPG.
    capturing : float
        Share of discontinuity capturing.
    scale : float
        A large difference of temperatures.
    """

    kind = "stored"

    def __init__(
        self,
        elements: Carried,
        unknowns: NDArray[np.int32],
        content: float,
        conductivity: float,
        reference: float,
        heating: float,
        is_stabilised: bool,
        capturing: float,
        scale: float,
    ) -> None:
        super().__init__()
        self.e, self.unknowns = elements, unknowns
        self.order = np.ones(unknowns.shape[1], dtype=np.int32)
        self.c, self.k, self.zero, self.mu = content, conductivity, reference, heating
        self.is_stabilised, self.capturing, self.scale = is_stabilised, capturing, scale
        self.sources: list[Source] = []

    # --- what happens at points ----------------------------------------------------------------------------
    def split(self, x: Array) -> tuple[Array, Array]:
        """Temperatures (m, k) and velocities (m, k, d) of the nodes."""
        k = self.e.N.shape[1]
        return x[:, :k], x[:, k:].reshape(len(x), k, -1)

    def _at(self, s: Stencils) -> tuple[Array, ...]:
        """Temperature above the reference, its slope, velocity, its gradient, ``v . grad`` (m, q, k) of N and N1."""
        T, v = self.split(s.x)
        e = self.e
        value, slope = (T - self.zero) @ e.N.T, np.einsum("mqkd,mk->mqd", e.G, T, optimize=True)
        at = np.einsum("qk,mkd->mqd", e.N, v)
        L = np.einsum("mki,mqkj->mqij", v, e.G, optimize=True)
        carried, through = (np.einsum("mqkd,mqd->mqk", G, at, optimize=True) for G in (e.G, e.G1))
        return value, slope, at, L, carried, through

    def _heating(self, L: Array) -> tuple[Array, Array]:
        """Heat (m, q) by viscosity, and its derivative (m, q, d, d) by the velocity's gradient."""
        both = self.mu * (L + np.swapaxes(L, -1, -2))
        return np.einsum("mqij,mqij->mq", both, L), 2 * both

    def _excess(self, s: Stencils, slope: Array, v: Array, L: Array) -> Array:
        """Residual (m, q) of the equation in the elements."""
        T, _ = self.split(s.x)
        rate = self.split(s.rate)[0] @ self.e.N.T
        R = self.c * (rate + np.sum(v * slope, axis=-1)) - self.k * np.einsum("mqk,mk->mq", self.e.laplace, T)
        R -= sum((f(s.step.te) for f in self.sources), np.zeros_like(R))
        return np.asarray(R - self._heating(L)[0] if self.mu else R)

    def _tau(self, v: Array) -> tuple[Array, Array]:
        """Time (m, q) that SUPG weighs by, and its derivative (m, q, d) by the velocity."""
        along = np.einsum("mqij,mqj->mqi", self.e.metric, v)
        tau = (np.sum(along * v, axis=-1) + (self.k / self.c) ** 2 * self.e.square) ** -0.5
        return tau, -(tau**3)[..., None] * along

    def _captured(self, R: Array, slope: Array) -> tuple[Array, Array, Array]:
        """Conductivity (m, q) of discontinuity capturing, its derivatives by the residual and the slope."""
        length = self.e.length[:, None]
        small, flat = LEAST * self.k * self.scale / length**2, LEAST * self.scale / length
        size, steep = np.sqrt(R**2 + small**2), np.sqrt(np.sum(slope**2, axis=-1) + flat**2)
        factor = 0.5 * self.capturing * length
        found = factor * (size - small) / steep
        return found, factor * R / (size * steep), -(found / steep**2)[..., None] * slope

    # --- the term ------------------------------------------------------------------------------------------
    def residual(self, s: Stencils) -> Array:
        value, slope, v, L, carried, through = self._at(s)
        rate, e, k = self.split(s.rate)[0] @ self.e.N.T, self.e, self.k
        found = np.zeros_like(s.x1)
        k_all, along = np.full_like(value, k), np.zeros_like(value)
        if self.is_stabilised or self.capturing:
            R = self._excess(s, slope, v, L)
            k_all = k_all + (self._captured(R, slope)[0] if self.capturing else 0.0)
            along = along + (self._tau(v)[0] * R if self.is_stabilised else 0.0)
        own = self.c * e.size * rate @ e.N
        own += self.c * (e.size * np.sum(v * slope, axis=-1)) @ (e.N - e.N1)
        own -= self.c * np.einsum("mqk,mq->mk", through, e.size * value, optimize=True)
        own += np.einsum("mqkd,mqd->mk", e.G, (e.size * k_all)[..., None] * slope, optimize=True)
        own += np.einsum("mqk,mq->mk", carried, e.size * along, optimize=True)
        found[:, : e.N.shape[1]] = own
        return found

    def tangent(self, s: Stencils) -> Array:
        value, slope, v, L, carried, through = self._at(s)
        e, c, th, n = self.e, self.c, s.step.theta, self.e.N.shape[1]
        m, q, _, d = e.G.shape
        w, N = e.size[..., None], np.broadcast_to(e.N, (m, q, n))
        by_T = product(c * s.step.transport_factor * w * N, N)
        flat = e.G.transpose(0, 1, 3, 2).reshape(m, q * d, n)
        each = np.repeat(e.size, d, axis=1)[..., None]
        by_T += product(th * self.k * each * flat, flat) - product(th * c * w * through, N)
        rest = np.broadcast_to(th * c * w * (e.N - e.N1), (m, q, n))
        by_T += product(rest, carried)
        turned = e.G1 * (-th * c * e.size * value)[..., None, None]
        by_v = np.einsum("mqaj,qb->mabj", turned, e.N, optimize=True)
        by_v += pairs(rest, e.N[:, :, None] * slope[:, :, None, :])
        if self.is_stabilised or self.capturing:
            R = self._excess(s, slope, v, L)
            R_T = c * (s.step.transport_factor * N + th * carried) - th * self.k * e.laplace
            R_v = th * c * e.N[:, :, None] * slope[:, :, None, :]
            if self.mu:
                R_v = R_v - th * np.einsum("mqij,mqbj->mqbi", self._heating(L)[1], e.G, optimize=True)
            if self.is_stabilised:
                tau, dtau = self._tau(v)
                test = w * tau[..., None] * carried
                by_T += product(test, R_T)
                by_v += pairs(test, R_v)
                by_v += np.einsum(
                    "mqaj,qb->mabj", e.G * (th * e.size * tau * R)[..., None, None], e.N, optimize=True
                )
                by_v += np.einsum(
                    "mqa,qb,mqj->mabj", w * carried, e.N, (th * R)[..., None] * dtau, optimize=True
                )
            if self.capturing:
                k_c, by_R, by_slope = self._captured(R, slope)
                along = np.einsum("mqkd,mqd->mqk", e.G, slope, optimize=True)
                by_T += product(th * np.repeat(e.size * k_c, d, axis=1)[..., None] * flat, flat)
                change = th * np.einsum("mqkd,mqd->mqk", e.G, by_slope, optimize=True)
                by_T += product(w * along, by_R[..., None] * R_T + change)
                by_v += pairs(w * along, by_R[..., None, None] * R_v)
        K = np.zeros((m, s.x1.shape[1], s.x1.shape[1]))
        K[:, :n, :n], K[:, :n, n:] = by_T, by_v.reshape(m, n, -1)
        return K

    def energy(self, s: Stencils) -> Array:
        """Heat (m,) above that of the reference."""
        T = self.split(s.x1)[0]
        return np.asarray(self.c * np.einsum("mq,mq->m", self.e.size, (T - self.zero) @ self.e.N.T))


def product(a: Array, b: Array) -> Array:
    """Sums (m, k, l) of products over points of (m, q, k) and (m, q, l)."""
    return np.asarray(np.swapaxes(a, 1, 2) @ b)


def pairs(a: Array, b: Array) -> Array:
    """Sums (m, k, l, d) of products over points of (m, q, k) and (m, q, l, d)."""
    m, q, n, d = b.shape
    return product(a, b.reshape(m, q, n * d)).reshape(m, a.shape[2], n, d)


class ViscousHeat(Term):
    """Viscous dissipation of the flow as heat; the unknowns are those of `CarriedHeat`."""

    kind = "viscous heating"
    brings = "heat"

    def __init__(self, heat: CarriedHeat) -> None:
        super().__init__()
        self.heat, self.unknowns, self.order = heat, heat.unknowns, heat.order

    def _found(self, s: Stencils) -> tuple[Array, Array]:
        _, v = self.heat.split(s.x)
        return self.heat._heating(np.einsum("mki,mqkj->mqij", v, self.heat.e.G, optimize=True))

    def residual(self, s: Stencils) -> Array:
        e, found = self.heat.e, np.zeros_like(s.x1)
        found[:, : e.N.shape[1]] = -(e.size * self._found(s)[0]) @ e.N
        return found

    def tangent(self, s: Stencils) -> Array:
        e, n = self.heat.e, self.heat.e.N.shape[1]
        by_v = np.einsum("mqij,mqbj->mqbi", self._found(s)[1], e.G, optimize=True)
        K = np.zeros((len(s.x1), s.x1.shape[1], s.x1.shape[1]))
        test = -s.step.theta * e.size[..., None] * e.N
        K[:, :n, n:] = pairs(test, by_v).reshape(len(K), n, -1)
        return K

    def work(self, s: Stencils) -> Array:
        return np.asarray(s.step.h * np.sum(self.heat.e.size * self._found(s)[0], axis=1))


class Buoyancy(Term):
    """Weight of what has expanded (Boussinesq): ``-rho expansion (T - reference) g`` per volume.

    The unknowns are those of `CarriedHeat`; `weight` gives ``-rho expansion g`` (d,).
    """

    kind = "buoyancy"

    def __init__(self, heat: CarriedHeat, weight: Callable[[], Array]) -> None:
        super().__init__()
        self.heat, self.weight = heat, weight
        self.unknowns, self.order = heat.unknowns, heat.order

    def residual(self, s: Stencils) -> Array:
        e, (T, v) = self.heat.e, self.heat.split(s.x)
        lifted = (e.size * ((T - self.heat.zero) @ e.N.T)) @ e.N
        force = lifted[:, :, None] * self.weight()
        return np.hstack([np.zeros_like(T), -force.reshape(v.shape[0], -1)])

    def tangent(self, s: Stencils) -> Array:
        e, n = self.heat.e, self.heat.e.N.shape[1]
        mass = np.einsum("mq,qa,qb->mab", e.size, e.N, e.N, optimize=True)
        K = np.zeros((len(s.x1), s.x1.shape[1], s.x1.shape[1]))
        by_T = -s.step.theta * np.einsum("mab,i->maib", mass, self.weight())
        K[:, n:, :n] = by_T.reshape(len(K), -1, n)
        return K

    def work(self, s: Stencils) -> Array:
        _, v = self.heat.split(s.x)
        force = -self.residual(s)[:, self.heat.e.N.shape[1] :]
        return np.asarray(s.step.h * np.sum(force * v.reshape(force.shape), axis=1))


class HeatOutflow(Term):
    """Heat that leaves with the fluid; what comes in has the reference temperature, unless nodes there are held.

    The unknowns are the temperatures and then the velocities of the nodes of a face, N1 the pressures' functions there:
    as `CarriedHeat` tests, they let out what leaves, and the rest pulls what comes in to the reference.
    """

    kind = "outflow"
    brings = "heat"

    def __init__(
        self,
        unknowns: NDArray[np.int32],
        N: Array,
        N1: Array,
        across: Array,
        content: float,
        zero: float,
    ) -> None:
        super().__init__()
        self.unknowns, self.order = unknowns, np.ones(unknowns.shape[1], dtype=np.int32)
        self.N, self.N1, self.across, self.c, self.zero = N, N1, across, content, zero

    def _through(self, s: Stencils) -> tuple[Array, Array]:
        """Volume (m, q) that leaves per time, less what comes in, and temperature there above the reference."""
        k = self.N.shape[1]
        v = np.einsum("qk,mkd->mqd", self.N, s.x[:, k:].reshape(len(s.x1), k, -1))
        return np.sum(v * self.across, axis=-1), (s.x[:, :k] - self.zero) @ self.N.T

    def _tested(self, volume: Array) -> Array:
        """Derivative (m, q, k) by the volume of what it carries by temperature."""
        return np.where(volume[..., None] > 0, self.N1, self.N1 - self.N)

    def residual(self, s: Stencils) -> Array:
        volume, T = self._through(s)
        found = np.zeros_like(s.x1)
        found[:, : self.N.shape[1]] = np.einsum("mq,mqk->mk", self.c * volume * T, self._tested(volume))
        return found

    def tangent(self, s: Stencils) -> Array:
        volume, T = self._through(s)
        n, factor, test = self.N.shape[1], s.step.theta * self.c, self._tested(volume)
        K = np.zeros((len(s.x1), s.x1.shape[1], s.x1.shape[1]))
        K[:, :n, :n] = np.einsum("mq,mqa,qb->mab", factor * volume, test, self.N, optimize=True)
        across = (factor * T)[..., None] * self.across
        by_v = np.einsum("mqd,mqa,qb->mabd", across, test, self.N, optimize=True)
        K[:, :n, n:] = by_v.reshape(len(K), n, -1)
        return K

    def work(self, s: Stencils) -> Array:
        volume, T = self._through(s)
        return np.asarray(-s.step.h * self.c * np.sum(np.maximum(volume, 0.0) * T, axis=1))
