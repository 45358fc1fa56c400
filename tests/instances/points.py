"""Physics at points on bricks: several fields, internal variables; what later parts are built from."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva import _core
from visviva.body.element import geometry, masses, solid_rule
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.mesh.cells import CELLS
from visviva.model.field import Field, Role
from visviva.model.model import Model

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Block(Component):
    """A cube of ``counts`` distorted bricks with random initial velocities, no supports."""

    counts: tuple[int, int, int] = (2, 1, 1)
    cell: str = "hex8"
    density: Number = 1.0
    speed: Number = 0.3
    seed: int = 1

    def __post_init__(self) -> None:
        rng = np.random.default_rng(self.seed)
        mesh = vv.BoxMesh(size=(1.0, 0.9, 1.1), counts=self.counts, cell=self.cell).build()
        self.X = np.array(mesh.points)
        self.X += 0.1 / max(self.counts) * rng.uniform(-1, 1, self.X.shape)
        self.cells = np.array(mesh.cells[self.cell])
        self.rng = rng

    def scalars(self, model: Model, name: str, values: Any, role: Role) -> Field:
        """A value per node."""
        return model.field(self, name, np.broadcast_to(values, (len(self.X),)), role=role)

    def move(self, model: Model) -> Field:
        """Positions, with random velocities."""
        v = self.speed * self.rng.standard_normal(self.X.shape)
        return model.field(self, "position", self.X, v, node=3)

    def build(
        self, model: Model, kind: Any, fields: list[tuple[Field, str]], parameters: list[float]
    ) -> _core.PointTerm:
        """The term; each field with its columns: "g" gradient, "v" value."""
        g = geometry(self.X, self.cells, self.cell)
        rule = solid_rule(self.X, self.cells, self.cell)
        N = np.broadcast_to(CELLS[self.cell].N(rule.points)[None, :, :, None], (*g.gradients.shape[:3], 1))
        parts = {"g": g.gradients, "v": N}
        groups, index = [], []
        for f, columns in fields:
            moves = f.role is Role.MOTION
            mass = masses(self.X, self.cells, self.cell, self.density) if moves and self.density else None
            weights = np.ascontiguousarray(np.concatenate([parts[c] for c in columns], axis=3))
            groups.append((weights, mass, moves))
            index.append(f.start + (3 if moves else 1) * self.cells)
        par = np.ascontiguousarray(np.broadcast_to(parameters, (*g.volume.shape, len(parameters))))
        term = _core.PointTerm(kind, np.hstack(index).astype(np.int32), groups, g.volume, par, None)
        term.name = self.label
        kinetic = model.account(self, "kinetic", "kinetic") if self.density else -1
        lost = model.account(self, "dissipated", "dissipation")
        term.book_point(model.account(self, "stored", "potential"), kinetic, lost, model.index(self))
        model.batch(term)
        self.volume, self.N = g.volume, N[..., 0]
        return term

    def integral(self, values: Array) -> float:
        """Of a scalar field given at the nodes."""
        at_points = np.einsum("eqa,ea->eq", self.N, values[self.cells])
        return float((self.volume * at_points).sum())


@dataclass(config=settings, eq=False, kw_only=True)
class Viscoelastic(Block):
    """A Maxwell branch beside a neo-Hookean spring."""

    viscosity: Number = 2.0

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)

    def contribute(self, model: Model) -> None:
        self.term = self.build(
            model,
            _core.PhysicsKind.VISCOELASTIC,
            [(self.motion, "g")],
            [20.0, 10.0, 8.0, self.viscosity],
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Thermoelastic(Block):
    """Entropy per volume is transported; the temperature follows from it, see the pairing in the core."""

    warm: Number = 0.2
    capacity: Number = 3.0
    conductivity: Number = 0.5
    reference: Number = 1.5

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)
        s = self.capacity * np.log1p(self.warm * self.X[:, 0] ** 2)
        theta = self.reference * np.exp(s / self.capacity)
        self.entropy = self.scalars(model, "entropy", s, Role.CONTENT)
        self.temperature = self.scalars(model, "temperature", theta, Role.MULTIPLIER)

    def contribute(self, model: Model) -> None:
        self.term = self.build(
            model,
            _core.PhysicsKind.THERMOELASTIC,
            [(self.motion, "g"), (self.entropy, "v"), (self.temperature, "vg")],
            [20.0, 10.0, 4.0, self.capacity, self.reference, self.conductivity],
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Damaged(Block):
    """AT2 with a penalty against healing."""

    toughness: Number = 0.5
    speed: Number = 1.0

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)
        self.damage = self.scalars(model, "damage", 0.0, Role.STATE)

    def contribute(self, model: Model) -> None:
        self.term = self.build(
            model,
            _core.PhysicsKind.DAMAGE,
            [(self.motion, "g"), (self.damage, "vg")],
            [20.0, 10.0, self.toughness, 0.3, 1e-3, 1e4],
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Separating(Block):
    """Cahn and Hilliard's equation with concentration and chemical potential."""

    barrier: Number = 4.0
    gradient: Number = 0.02
    mobility: Number = 0.3

    def declare(self, model: Model) -> None:
        c = 0.5 + 0.1 * self.rng.standard_normal(len(self.X))
        self.concentration = self.scalars(model, "concentration", c, Role.CONTENT)
        self.potential = self.scalars(model, "potential", 0.0, Role.MULTIPLIER)

    def contribute(self, model: Model) -> None:
        self.density = 0.0
        self.term = self.build(
            model,
            _core.PhysicsKind.CAHN_HILLIARD,
            [(self.concentration, "vg"), (self.potential, "vg")],
            [self.barrier, self.gradient, self.mobility],
        )
