"""Physics at points on bricks: several fields, internal variables; what later parts are built from."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

import visviva as vv
from visviva.body.element import Geometry, geometry, masses, solid_rule
from visviva.body.rigid import RIGIDITY
from visviva.component.component import Component, settings
from visviva.component.values import Number
from visviva.mesh.cells import CELLS
from visviva.model.field import Field, Role
from visviva.model.form import Vector, dot
from visviva.model.history import Evolving
from visviva.model.model import Model
from visviva.model.points import Group, PhysicsKind, add_points

Array = NDArray[np.float64]


@dataclass(config=settings, eq=False, kw_only=True)
class Block(Component):
    """A cube of ``counts`` distorted bricks with random initial velocities, no supports."""

    counts: tuple[int, int, int] = (2, 1, 1)
    cell: str = "hex8"
    speed: Number = 0.3
    density: Number = 1.0
    seed: int = 1

    def __post_init__(self) -> None:
        rng = np.random.default_rng(self.seed)
        mesh = vv.BoxMesh(size=(1.0, 0.9, 1.1), counts=self.counts, cell=self.cell).build()
        self.X = np.array(mesh.points)
        self.X += 0.1 / max(self.counts) * rng.uniform(-1, 1, self.X.shape)
        self.cells = np.array(mesh.cells[self.cell])
        self.rng = rng

    @cached_property
    def grid(self) -> Geometry:
        """Gradients and volumes at the points."""
        return geometry(self.X, self.cells, self.cell)

    @cached_property
    def N(self) -> Array:
        """Shape functions at the points."""
        return CELLS[self.cell].N(solid_rule(self.X, self.cells, self.cell).points)

    def scalars(self, model: Model, name: str, values: Any, role: Role) -> Field:
        """A value per node. Multipliers speak of what happens in a step."""
        at_nodes = np.broadcast_to(values, (len(self.X),))
        return model.field(self, name, at_nodes, role=role, instantaneous=role is not Role.MULTIPLIER)

    def move(self, model: Model) -> Field:
        """Positions, with random velocities."""
        v = self.speed * self.rng.standard_normal(self.X.shape)
        return model.field(self, "position", self.X, v, node=3)

    def build(
        self,
        model: Model,
        kind: PhysicsKind,
        fields: list[tuple[Field, str]],
        parameters: list[float],
        **law: Any,
    ) -> None:
        """The term; each field with its columns: "g" gradient, "v" value."""
        g, N = self.grid, self.N
        parts = {"g": g.gradients, "v": np.broadcast_to(N[None, :, :, None], (*g.gradients.shape[:3], 1))}
        groups = []
        for f, columns in fields:
            moves = f.role is Role.MOTION
            mass = masses(self.X, self.cells, self.cell, self.density) if moves else None
            weights = np.concatenate([parts[c] for c in columns], axis=3)
            groups.append(Group(f.start + f.node * self.cells, weights, mass, moves))
        self.term = add_points(model, self, kind, groups, g.volume, parameters, **law)

    def integral(self, values: Array) -> float:
        """Of a scalar field given at the nodes."""
        at_points = np.einsum("qa,ea->eq", self.N, values[self.cells])
        return float((self.grid.volume * at_points).sum())


@dataclass(config=settings, eq=False, kw_only=True)
class Viscoelastic(Block):
    """A Maxwell branch beside a neo-Hookean spring."""

    viscosity: Number = 2.0

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)

    def contribute(self, model: Model) -> None:
        self.build(
            model,
            PhysicsKind.VISCOELASTIC,
            [(self.motion, "g")],
            [20.0, 10.0, 8.0, self.viscosity],
        )


def maxwell_energy(e: Array, a: Array) -> Array:
    """The same as the core's, of C - I (6, n) and A - I."""

    def less_one(c: Array) -> Array:
        x, y, z, p, q, r = c
        first, second = x + y + z, x * y + y * z + z * x - p * p - q * q - r * r
        return first + second + x * (y * z - q * q) + p * (2 * q * r - p * z) - r * r * y

    log_j = 0.5 * np.log1p(less_one(e))
    weights = np.array([1.0, 1, 1, 2, 2, 2])[:, None]
    inner = (weights * e * a).sum(axis=0) + (e + a)[:3].sum(axis=0)
    branch = inner - np.log1p(less_one(a)) - 2 * log_j
    return 5.0 * (e[:3].sum(axis=0) - 2 * log_j) + 10.0 * log_j**2 + 4.0 * branch


def tensor(a: Array) -> Array:
    """(n, 3, 3) of (6, n)."""
    return np.moveaxis(a[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]], -1, 0)


def maxwell_update(e0: Array, e1: Array, a0: Array, h: float, viscosity: float = 2.0) -> Array:
    """``A' = -mu_v / (2 eta) (A C A - A)`` with C of the middle, by exact steps of the inverse: it is linear there."""
    C = np.eye(3) + tensor(0.5 * (e0 + e1))
    share = np.exp(-4.0 * h / viscosity)
    inverse = C + share * (np.linalg.inv(np.eye(3) + tensor(a0)) - C)
    A = np.linalg.inv(inverse) - np.eye(3)
    return np.moveaxis(A, 0, -1)[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]


@dataclass(config=settings, eq=False, kw_only=True)
class UserViscoelastic(Block):
    """The Maxwell branch as functions of Python, with internal variables of their own."""

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)

    def contribute(self, model: Model) -> None:
        law = Evolving(maxwell_energy, maxwell_update, 6, 6, f"{self.label}: its material")
        self.build(
            model,
            PhysicsKind.VISCOELASTIC,
            [(self.motion, "g")],
            [0.0, 0.0, 0.0, 1.0],
            energy=law,
            start=[0.0] * 6,
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Thermoelastic(Block):
    """Entropy per volume is transported; the temperature follows from it, see the pairing in the core."""

    warm: Number = 0.2
    capacity: Number = 0.2
    conductivity: Number = 0.5
    reference: Number = 20.0

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)
        s = self.capacity * np.log1p(self.warm * self.X[:, 0] ** 2)
        theta = self.reference * np.exp(s / self.capacity)
        self.entropy = self.scalars(model, "entropy", s, Role.CONTENT)
        self.temperature = self.scalars(model, "temperature", theta, Role.TEMPERATURE)

    def parameters(self) -> list[float]:
        """See `visviva/point/thermoelastic.hpp`."""
        rubber = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
        heat = [float(int(rubber.kind)), self.capacity, self.reference, 0.4, 0.0]
        k = self.conductivity
        constants = rubber.constants()
        more = [0.0] * 15  # in the reference, constant
        return [*heat, k, k, k, 0.0, 0.0, 0.0, *more, *constants, *[0.0] * (18 - len(constants))]

    def contribute(self, model: Model) -> None:
        self.build(
            model,
            PhysicsKind.THERMOELASTIC,
            [(self.motion, "g"), (self.entropy, "vg"), (self.temperature, "vg")],
            self.parameters(),
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Damaged(Block):
    """AT2 with a penalty against healing."""

    toughness: Number = 0.5

    def declare(self, model: Model) -> None:
        self.motion = self.move(model)
        self.damage = self.scalars(model, "damage", 0.0, Role.STATE)

    def contribute(self, model: Model) -> None:
        self.build(
            model,
            PhysicsKind.DAMAGE,
            [(self.motion, "g"), (self.damage, "vg")],
            [20.0, 10.0, self.toughness, 0.3, 1e-3, 1e4],
        )


@dataclass(config=settings, eq=False, kw_only=True)
class Separating(Block):
    """Cahn and Hilliard's equation with concentration and chemical potential."""

    barrier: Number = 4.0
    gradient: Number = 0.5
    mobility: Number = 0.3

    def declare(self, model: Model) -> None:
        c = 0.5 + 0.1 * self.rng.standard_normal(len(self.X))
        self.concentration = self.scalars(model, "concentration", c, Role.CONTENT)
        self.potential = self.scalars(model, "potential", self.potential_of(c), Role.MULTIPLIER)

    def potential_of(self, c: Array) -> Array:
        """``2 b c (1 - c) (1 - 2 c) - kappa laplace(c)`` by projection."""
        g, N = self.grid, self.N
        local = c[self.cells]
        at, slope = local @ N.T, np.einsum("eqad,ea->eqd", g.gradients, local)
        chemical = 2 * self.barrier * at * (1 - at) * (1 - 2 * at)
        rows = np.einsum("eq,eq,qa->ea", g.volume, chemical, N)
        rows += self.gradient * np.einsum("eq,eqad,eqd->ea", g.volume, g.gradients, slope)
        blocks = np.einsum("eq,qa,qb->eab", g.volume, N, N)
        M, r = np.zeros((len(c), len(c))), np.zeros(len(c))
        np.add.at(r, self.cells, rows)
        np.add.at(M, (self.cells[:, :, None], self.cells[:, None, :]), blocks)
        return np.asarray(np.linalg.solve(M, r))

    def contribute(self, model: Model) -> None:
        self.build(
            model,
            PhysicsKind.CAHN_HILLIARD,
            [(self.concentration, "vg"), (self.potential, "vg")],
            [self.barrier, self.gradient, self.mobility],
        )


def upper(matrix: Array) -> Array:
    """Upper triangle by rows."""
    return matrix[np.triu_indices(len(matrix))]


def line_mass(length: float) -> Array:
    """Packed mass per unit of line density of a linear element."""
    return length / 6 * np.array([2.0, 1.0, 2.0])


@dataclass(config=settings, eq=False, kw_only=True)
class DirectorBeam(Component):
    """A straight beam along x of linear elements with positions and directors at its nodes.

    `stiffness` along and about the directors d1, d2, d3, of which the third is the tangent; `force` at its end.
    """

    n: int = 3
    length: Number = 2.0
    stiffness: tuple[float, ...] = (60.0, 50.0, 100.0, 4.0, 3.0, 2.0)
    line_density: Number = 1.0
    inertia: tuple[float, float] = (0.02, 0.03)
    spin: tuple[float, float, float] = (0.4, -0.3, 0.2)
    clamped: bool = False
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def declare(self, model: Model) -> None:
        x = np.linspace(0, self.length, self.n + 1)
        q = np.zeros((self.n + 1, 4, 3))
        q[:, 0, 0] = x
        q[:, 1:] = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0)])
        omega = np.array(self.spin) * (1 + x[:, None])
        v = np.cross(omega[:, None], q)
        held = np.zeros_like(q, dtype=bool)
        held[0] = self.clamped
        v[held] = 0.0
        self.nodes = model.field(self, "node", q, v, node=12, fixed=held.ravel())

    def contribute(self, model: Model) -> None:
        h, start = self.length / self.n, self.nodes.start
        pairs = np.stack([np.arange(self.n), np.arange(1, self.n + 1)], axis=1)
        slope, value = np.array([-1 / h, 1 / h]), np.array([0.5, 0.5])
        director = np.stack([value, slope], axis=1)[None]
        groups = [Group(start + 12 * pairs, slope[None, :, None], self.line(self.line_density), True)]
        densities = (*self.inertia, 0.0)
        groups += [Group(start + 12 * pairs + 3 * i + 3, director, self.line(densities[i])) for i in range(3)]
        reference = np.tile([0.0, 0, 0.5, 0, 0, 0], (self.n, 1, 1))  # d3 . phi' - d3 . d3 / 2
        volume = np.full((self.n, 1), h)
        parameters = upper(np.diag(self.stiffness))
        add_points(model, self, PhysicsKind.BEAM, groups, volume, parameters, reference)
        multipliers = model.multipliers(self, "orthonormality", 6 * (self.n + 1), stage=0, block=self)
        for k in range(self.n + 1):
            if not (self.clamped and k == 0):
                model.constrain(self, multipliers, RIGIDITY, first=6 * k, shift=start + 12 * k)
        if self.clamped:
            model.hold(multipliers, np.arange(6))
        if any(self.force):
            tip = np.array([start + 12 * self.n])
            model.dead_forces(self, "tip", tip, np.array([self.force]))

    def line(self, density: float) -> Array:
        return density * np.tile(line_mass(self.length / self.n), (self.n, 1))


@dataclass(config=settings, eq=False, kw_only=True)
class DirectorShell(Component):
    """A flat rectangle of four-node elements with unit directors at the nodes; shear after Dvorkin & Bathe."""

    size: tuple[float, float] = (1.0, 0.8)
    counts: tuple[int, int] = (2, 2)
    thickness: Number = 0.1
    young: Number = 1e3
    poisson: Number = 0.3
    density: Number = 10.0
    spin: Number = 0.5

    def declare(self, model: Model) -> None:
        mesh = vv.RectangleMesh(size=self.size, counts=self.counts, cell="quad4").build()
        self.X, self.cells = np.array(mesh.points), np.array(mesh.cells["quad4"])
        q = np.zeros((len(self.X), 2, 3))
        q[:, 0, :2], q[:, 1, 2] = self.X, 1.0
        omega = self.spin * np.stack([1 - self.X[:, 1], self.X[:, 0], self.X[:, 0] * self.X[:, 1]], axis=1)
        self.nodes = model.field(self, "node", q, np.cross(omega[:, None], q), node=6)

    def stiffness(self) -> Array:
        """Of membrane, bending and shear strains (8, 8)."""
        E, nu, h = self.young, self.poisson, self.thickness
        plane = E / (1 - nu**2) * np.array([(1, nu, 0), (nu, 1, 0), (0, 0, (1 - nu) / 2)])
        C = np.zeros((8, 8))
        C[:3, :3], C[3:6, 3:6] = h * plane, h**3 / 12 * plane
        C[6, 6] = C[7, 7] = 5 / 6 * h * E / (2 * (1 + nu))
        return C

    def columns(self) -> tuple[Array, Array]:
        """Columns of positions and directors, see the strain map."""
        cell, xi = CELLS["quad4"], solid_rule(self.X, self.cells, "quad4").points
        scale = 2 * np.array(self.counts) / np.array(self.size)
        tying = np.array([(0.0, -1), (0, 1), (-1, 0), (1, 0)])
        dN, N_tying, dN_tying = cell.dN(xi) * scale, cell.N(tying), cell.dN(tying) * scale
        position, director = np.zeros((2, len(xi), 4, 6))
        position[..., :2] = director[..., :2] = dN
        for k, (axis, across, sign) in enumerate(((0, 1, -1), (0, 1, 1), (1, 0, -1), (1, 0, 1))):
            share = 0.5 * (1 + sign * xi[:, across])
            position[..., 2 + k] = share[:, None] * dN_tying[k, :, axis]
            director[..., 2 + k] = N_tying[k]
        return position, director

    def contribute(self, model: Model) -> None:
        start, volume = self.nodes.start, geometry(self.X, self.cells, "quad4").volume
        plane = masses(self.X, self.cells, "quad4", self.density)
        inertia = (self.thickness * plane, self.thickness**3 / 12 * plane)
        groups = [
            Group(start + 6 * self.cells + 3 * k, weights, inertia[k], k == 0)
            for k, weights in enumerate(self.columns())
        ]
        reference = np.zeros((*volume.shape, 8))
        reference[..., :2] = 0.5
        add_points(model, self, PhysicsKind.SHELL, groups, volume, upper(self.stiffness()), reference)
        multipliers = model.multipliers(self, "length", len(self.X), stage=0, block=self)
        fixed = self.nodes.fixed.reshape(-1, 6)[:, 3:].all(axis=1)
        model.hold(multipliers, np.flatnonzero(fixed))
        for k in np.flatnonzero(~fixed):
            d = Vector.of(start + 6 * k + 3)
            model.constrain(self, multipliers, [0.5 * dot(d, d) - 0.5], first=k)
