"""Components whose directors vary along them: a beam of one element with two sections, a rigid body that is twisted."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva.body.rigid import RIGIDITY
from visviva.component.component import settings
from visviva.component.point import Attachable
from visviva.component.values import Number
from visviva.model.form import Strain, Vector, dot, strain
from visviva.model.law import quadratic
from visviva.model.model import Model

Array = NDArray[np.float64]


def about_axis(angle: float) -> Array:
    """Rotation about the third axis, its directors as columns."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)])


@dataclass(config=settings, eq=False, kw_only=True)
class TwistedBeam(Attachable):
    """A geometrically exact beam of one element along z, its second section turned by `twist` at the start.

    Own coordinates are those in the section and along the axis; positions and directors are linear in between.
    """

    length: Number = 1.0
    twist: Number = 1.0
    stiffness: Number = 20.0
    seed: int = 1

    moves_rigidly = False

    def share(self, X: Array) -> float:
        """Of the second section at a material point."""
        return float(X[2]) / self.length

    def between(self, k: int, share: float) -> Vector:
        """Position (k = 0) or director of a section, linear between the ends."""
        first, second = (Vector.of(self.motion.start + 12 * end + 3 * k) for end in (0, 1))
        return (1 - share) * first + share * second

    # --- attachment ----------------------------------------------------------------------------------------
    def place(self, X: Array) -> Vector:
        return self.between(0, self.share(X)) + self.turn(np.array([X[0], X[1], 0.0]), X)

    def turn(self, direction: Array, X: Array) -> Vector:
        a, b, c = (float(part) * self.between(1 + i, self.share(X)) for i, part in enumerate(direction))
        return a + b + c

    def local(self, x: Array) -> Array:
        return np.append(np.linalg.solve(self.directors(x)[:2, :2], x[:2]), x[2])

    def local_direction(self, d: Array, X: Array) -> Array:
        return np.linalg.solve(self.directors(X), d)

    def directors(self, X: Array) -> Array:
        """As columns, at the start."""
        return (1 - self.share(X)) * np.eye(3) + self.share(X) * about_axis(self.twist)

    # --- part in the system --------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        turns = np.eye(3), about_axis(self.twist)
        sections = [[(0, 0, end * self.length), *turns[end].T] for end in (0, 1)]
        w = 0.5 * np.random.default_rng(self.seed).standard_normal(3)
        rates = [[np.cross(w, vector) for vector in section] for section in sections]
        self.motion = model.field(self, "sections", sections, rates)

    def contribute(self, model: Model) -> None:
        multipliers = model.multipliers(self, "rigidity", 12, block=self)
        for end in (0, 1):
            start = self.motion.start + 12 * end
            mass = np.diag([0.5, 0.02, 0.03, 0.01])
            model.inertia(self, start, mass, (True, False, False, False))
            model.constrain(self, multipliers, RIGIDITY, first=6 * end, shift=start)
        x, _ = model.initial
        for e in self.strains():
            model.potential(self, "strain", e, quadratic(self.stiffness, e.value(x)))

    def strains(self) -> list[Strain]:
        """Stretch and shears, bending and torsion in the middle."""
        d, along = [self.between(i, 0.5) for i in (1, 2, 3)], []
        for k in range(4):
            first, second = (self.between(k, share) for share in (0.0, 1.0))
            along.append((1 / self.length) * (second - first))
        bends = [dot(d[i], along[1 + j]) - dot(d[j], along[1 + i]) for i, j in ((0, 1), (1, 2), (2, 0))]
        return [strain(dot(director, along[0])) for director in d] + bends

    def surface(self) -> Any:
        """A strip along the first director."""
        s = np.repeat(np.linspace(0, self.length, 5), 2)
        points = np.column_stack([np.tile([-0.1, 0.1], 5), np.zeros(10), s])
        rows = 2 * np.arange(4)[:, None]
        return points, np.vstack([rows + np.array(corners) for corners in ((0, 1, 2), (1, 3, 2))])


@dataclass(config=settings, eq=False, kw_only=True)
class TwistedBody(vv.RigidBody):
    """A rigid body whose own coordinates turn about its third axis by `twist` per length."""

    twist: Number = 1.0

    moves_rigidly = False

    def untwisted(self, X: Array) -> Array:
        """Coordinates that do not turn."""
        return about_axis(self.twist * X[2]) @ X

    def place(self, X: Array) -> Vector:
        return super().place(self.untwisted(X))

    def turn(self, direction: Array, X: Array) -> Vector:
        return super().turn(about_axis(self.twist * X[2]) @ direction, X)

    def local(self, x: Array) -> Array:
        X = super().local(x)
        return about_axis(-self.twist * X[2]) @ X

    def local_direction(self, d: Array, X: Array) -> Array:
        return about_axis(-self.twist * X[2]) @ super().local_direction(d, X)
