"""A Stokes cell: biquadratic velocities (order 1), linear pressures (order 0), free at its edges."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sl
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from instances.shapes import gauss, quad9
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.model.term import Stencils, Term

Array = NDArray[np.float64]


def cell(viscosity: float) -> tuple[Array, Array, Array]:
    """Mass (18, 18), viscous matrix (18, 18) and divergence (3, 18) of the square from -1 to 1."""
    M, A, B = np.zeros((18, 18)), np.zeros((18, 18)), np.zeros((3, 18))
    for xi, weight in zip(*gauss(3, 2), strict=True):
        N, dN = quad9(xi)
        strain = np.zeros((3, 18))  # D11, D22, sqrt(2) D12
        strain[0, 0::2], strain[1, 1::2] = dN[:, 0], dN[:, 1]
        strain[2, 0::2], strain[2, 1::2] = dN[:, 1] / np.sqrt(2), dN[:, 0] / np.sqrt(2)
        M += weight * np.kron(np.outer(N, N), np.eye(2))
        A += weight * 2 * viscosity * strain.T @ strain
        B += weight * np.outer([1.0, *xi], strain[0] + strain[1])
    return M, A, B


class Storage(Term):
    """Inertia of unknowns that are velocities."""

    kind = "kinetic"
    stores = "kinetic"

    def __init__(self, unknowns: NDArray[np.int32], M: Array) -> None:
        super().__init__()
        self.unknowns, self.order, self.M = unknowns, np.ones(len(M), dtype=np.int32), M

    def residual(self, s: Stencils) -> Array:
        return s.rate @ self.M

    def tangent(self, s: Stencils) -> Array:
        return s.step.transport_factor * self.M[None]

    def energy(self, s: Stencils) -> Array:
        kinetic: Array = 0.5 * np.einsum("ni,ij,nj->n", s.x1, self.M, s.x1)
        return kinetic


class Flow(Term):
    """Viscous stress and pressure; the divergence vanishes at the end of the step."""

    kind = "viscosity"

    def __init__(self, unknowns: NDArray[np.int32], A: Array, B: Array) -> None:
        super().__init__()
        self.unknowns, self.A, self.B = unknowns, A, B
        self.order = np.r_[np.ones(len(A), dtype=np.int32), np.zeros(len(B), dtype=np.int32)]

    def residual(self, s: Stencils) -> Array:
        v, p = s.x[:, : len(self.A)], s.x1[:, len(self.A) :]
        return np.concatenate([v @ self.A - p @ self.B, -s.x1[:, : len(self.A)] @ self.B.T], axis=1)

    def tangent(self, s: Stencils) -> Array:
        return np.block([[s.step.theta * self.A, -self.B.T], [-self.B, np.zeros((len(self.B),) * 2)]])[None]

    def work(self, s: Stencils) -> Array:
        n = len(self.A)
        power: Array = -np.einsum("ni,ni->n", self.residual(s)[:, :n], s.x[:, :n])
        return s.step.h * power


@dataclass(config=settings, eq=False, kw_only=True)
class StokesCell(Component):
    """Random initial velocities without divergence."""

    viscosity: Number = 0.3
    seed: int = 1

    def declare(self, model: Model) -> None:
        self.M, self.A, self.B = cell(self.viscosity)
        free = sl.null_space(self.B)
        v = free @ np.random.default_rng(self.seed).standard_normal(free.shape[1])
        self.velocity = model.field(self, "velocity", v, role=Role.VELOCITY)
        self.pressure = model.field(self, "pressure", np.zeros(3), role=Role.MULTIPLIER, stage=1)

    def contribute(self, model: Model) -> None:
        v = np.array([self.velocity.unknowns], dtype=np.int32)
        p = np.array([self.pressure.unknowns], dtype=np.int32)
        model.term(self, Storage(v, self.M))
        model.term(self, Flow(np.concatenate([v, p], axis=1), self.A, self.B))
