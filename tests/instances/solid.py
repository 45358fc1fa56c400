"""One trilinear brick of a hyperelastic solid: motion (order 2), a discrete gradient at eight points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from instances.shapes import CORNERS, gauss, hex8, neo_hooke
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.model.callback import energy_callback
from visviva.model.form import Form, Strain, Vector, dot
from visviva.model.law import Law, LawKind
from visviva.model.model import Model

Array = NDArray[np.float64]


def stored(e: Array) -> Array:
    """Stiffness and volume come as strains that do not change."""
    return e[6] * neo_hooke(e[:6])


@dataclass(config=settings, eq=False, kw_only=True)
class Brick(Component):
    """A distorted brick with random velocities; `fixed` holds its lower face."""

    stiffness: Number = 50.0
    density: Number = 1.0
    seed: int = 1
    speed: Number = 1.0
    fixed: bool = False

    def declare(self, model: Model) -> None:
        rng = np.random.default_rng(self.seed)
        self.X = 0.5 * CORNERS + 0.08 * rng.standard_normal((8, 3))
        held = np.repeat(CORNERS[:, 2] < 0, 3) & self.fixed
        v = np.where(held, 0.0, self.speed * rng.standard_normal(24))
        self.motion = model.field(self, "position", self.X, v, fixed=held)

    def contribute(self, model: Model) -> None:
        points, weights = gauss(2, 3)
        law = Law(LawKind.ENERGY_CALLBACK, callback=energy_callback(stored, 7, self.label))
        mass = np.zeros((8, 8))
        for xi, weight in zip(points, weights, strict=True):
            N, dN = hex8(xi)
            jacobian = self.X.T @ dN
            volume = weight * np.linalg.det(jacobian)
            mass += self.density * volume * np.outer(N, N)
            strains = self.cauchy_green(dN @ np.linalg.inv(jacobian))
            model.potential(self, "strain", [*strains, Form((), self.stiffness * volume)], law)
        model.inertia(self, self.motion.start, mass, (True,) * 8)

    def cauchy_green(self, dN: Array) -> list[Strain]:
        """``C = F^T F`` from the columns of ``F``, linear forms of the nodes."""
        F = [Vector.of(self.motion.start, dN[:, k]) for k in range(3)]
        return [dot(F[a], F[b]) for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
