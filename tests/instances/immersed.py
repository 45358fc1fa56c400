"""A solid tetrahedron that moves with the velocities of a background brick: the immersed idea.

The unknowns are background velocities (order 1). The solid has none: its nodes are the term's history and
move by ``x1 = x0 + h I v``, with the interpolation ``I`` taken where the nodes are at the start of the step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from instances.shapes import CORNERS, gauss, hex8, neo_hooke
from instances.stokes import Storage
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.model.callback import Function
from visviva.model.field import Role
from visviva.model.model import Model
from visviva.model.term import Stencils, Term

Array = NDArray[np.float64]

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


class PulledBack(Term):
    """Strain energy of the solid, pulled back to the background's velocities by the interpolation."""

    kind = "strain"

    def __init__(self, unknowns: NDArray[np.int32], X: Array, stiffness: float) -> None:
        super().__init__()
        self.unknowns, self.order = unknowns, np.ones(24, dtype=np.int32)
        self.history["position"] = X
        edges = (X[1:] - X[0]).T
        self.dN = np.concatenate([-np.ones((1, 3)), np.eye(3)]) @ np.linalg.inv(edges)
        size = stiffness * np.linalg.det(edges) / 6
        self.energy_of = Function(lambda C: size * neo_hooke(C), 6, 1, "immersed solid")

    def interpolation(self) -> Array:
        """``I`` (12, 24) from background velocities to those of the nodes."""
        return np.concatenate([np.kron(hex8(x)[0], np.eye(3)) for x in self.history["position"]])

    def strains(self, x: Array) -> Array:
        """``C`` (6, 1) at nodal positions (4, 3)."""
        C = self.dN.T @ x @ x.T @ self.dN
        return np.array([[C[a, b]] for a, b in PAIRS])

    def strain_gradient(self, x: Array) -> Array:
        """Derivative (6, 12) of the strains by the nodal positions."""
        F = x.T @ self.dN
        rows = [np.outer(self.dN[:, a], F[:, b]) + np.outer(self.dN[:, b], F[:, a]) for a, b in PAIRS]
        return np.array([r.ravel() for r in rows])

    def positions(self, s: Stencils) -> tuple[Array, Array, Array]:
        """Nodal positions at start, evaluation point and end of the step."""
        x0 = self.history["position"]
        dx = s.step.h * (self.interpolation() @ s.x[0]).reshape(4, 3)
        return x0, x0 + s.step.theta * dx, x0 + dx

    def stress(self, s: Stencils, tangent: bool) -> tuple[Array, Array]:
        """Stress (6,) and its derivative (6, 12) by the nodal positions at the end."""
        x0, xt, x1 = self.positions(s)
        if s.step.discrete_gradient:
            S, D = self.energy_of.discrete_gradient(self.strains(x0), self.strains(x1), tangent)
            chain = self.strain_gradient(x1)
        else:
            et = self.strains(xt)
            S, D = self.energy_of.gradient(et), self.energy_of.hessian(et) if tangent else None
            chain = s.step.theta * self.strain_gradient(xt)
        return S[0, :, 0], np.zeros((6, 12)) if D is None else D[0, :, :, 0] @ chain

    def residual(self, s: Stencils) -> Array:
        _, xt, _ = self.positions(s)
        S, _ = self.stress(s, False)
        return (self.interpolation().T @ self.strain_gradient(xt).T @ S)[None]

    def tangent(self, s: Stencils) -> Array:
        _, xt, _ = self.positions(s)
        S, D = self.stress(s, True)
        stress = sum(S[k] * np.outer(self.dN[:, a], self.dN[:, b]) for k, (a, b) in enumerate(PAIRS))
        geometric = s.step.theta * np.kron(stress + np.transpose(stress), np.eye(3))
        K = geometric + self.strain_gradient(xt).T @ D
        to_solid = self.interpolation()
        return (s.step.h * s.step.theta * to_solid.T @ K @ to_solid)[None]

    def energy(self, s: Stencils) -> Array:
        return self.energy_of.value(self.strains(self.positions(s)[2]))[0]

    def accept(self, s: Stencils) -> None:
        self.history["position"] = self.positions(s)[2]


@dataclass(config=settings, eq=False, kw_only=True)
class ImmersedSolid(Component):
    """A background cube from -1 to 1 with random velocities and a tetrahedron in its middle."""

    stiffness: Number = 20.0
    density: Number = 1.0
    speed: Number = 0.3
    seed: int = 1

    def declare(self, model: Model) -> None:
        rng = np.random.default_rng(self.seed)
        self.velocity = model.field(
            self, "velocity", self.speed * rng.standard_normal(24), role=Role.VELOCITY
        )

    def contribute(self, model: Model) -> None:
        shape = [(w, hex8(xi)[0]) for xi, w in zip(*gauss(2, 3), strict=True)]
        M = self.density * np.kron(sum(w * np.outer(N, N) for w, N in shape), np.eye(3))
        unknowns = np.array([self.velocity.unknowns], dtype=np.int32)
        model.term(self, Storage(unknowns, M))
        X = 0.3 * np.concatenate([CORNERS[:1], CORNERS[1:2], CORNERS[3:4], CORNERS[4:5]])
        self.solid = PulledBack(unknowns, X, self.stiffness)
        model.term(self, self.solid)
