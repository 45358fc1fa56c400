"""The flag of Turek & Hron (2006) behind its cylinder, immersed: geometry, meshes and system, published values.

The channel's rows lie along the flag; how many there are over its thickness is free.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

import visviva as vv
from visviva.component.component import Component
from visviva.examples.cylinder import CENTRE, HEIGHT, RADIUS
from visviva.mesh.grid import Block, assembled

Array = NDArray[np.float64]

LENGTH, BOX, END, THICK, CLEAR = 2.5, 0.4, 0.6, 0.02, 1.0001
PUBLISHED = {"u_x": 2.270493e-5, "u_y": 8.208773e-4, "drag": 14.29426, "lift": 0.763746}
"""FSI1, FeatFlow's level 7."""
SWINGS = {
    "u_x": (-14.85e-3, 12.70e-3),
    "u_y": (1.30e-3, 81.6e-3),
    "drag": (215.06, 77.65),
    "lift": (0.61, 237.8),
}
FREQUENCY = 1.93
"""FSI2, mean and amplitude, FeatFlow's level 4 (Turek & Hron print 80.6e-3 for u_y and 2.0 for the frequency)."""


@dataclass(frozen=True)
class Kind:
    """Density of the flag, and the mean velocity of the inflow as a function of time."""

    density: float
    speed: Callable[[float], float]


FSI1 = Kind(1000.0, lambda t: 0.2 * min(t, 1.0))
FSI2 = Kind(10000.0, lambda t: 0.5 * (1 - np.cos(np.pi * min(t, 2.0) / 2)))


@dataclass(frozen=True)
class Rows:
    """Cells of the channel: over the flag's thickness, on each side of it with the same height, and `fine` around.

    `fine` cells go from the cylinder outwards and along the flag, half of them from the flag's sides to the walls.
    """

    fine: int = 12
    across: int = 2
    beside: int = 2

    @property
    def height(self) -> float:
        """Of the cells over the flag."""
        return THICK / self.across

    @property
    def half(self) -> float:
        """Half height of the rows of equal cells."""
        return THICK / 2 + self.beside * self.height


def grown(t: Array, start: float, end: float, first: float) -> Array:
    """From start to end, with the slope `first` at the start."""
    slope = first / abs(end - start)
    rate = brentq(lambda g: g / np.expm1(g) - slope, 1e-6, 30)
    return np.asarray(start + (end - start) * np.expm1(rate * t) / np.expm1(rate))


def channel(rows: Rows) -> vv.Mesh:
    """A channel with a hole for the cylinder, in layers below, along and above the flag.

    Sets of edges: x0, x1, y0, y1, cylinder.
    """
    n, b, y = rows.fine, rows.half, CENTRE[1]
    layers = (
        (n, "y0", lambda t: grown(1 - t, y - b, 0.0, n * rows.height)),
        (rows.across + 2 * rows.beside, None, lambda t: y + b * (2 * t - 1)),
        (n, "y1", lambda t: grown(t, y + b, HEIGHT, n * rows.height)),
    )
    turn = np.arcsin(b / RADIUS)
    angles = np.array([-np.pi / 4, -turn, turn, np.pi / 4])
    blocks: list[Block] = [_fan(k, n) for k in (1, 2, 3)]
    for k, (count, wall, heights) in enumerate(layers):
        walls = (wall if wall == "y0" else None, wall if wall == "y1" else None)
        blocks.append(
            ((n, count), _behind(heights, angles[k : k + 2], k == 1), (("cylinder", None), (None, None)))
        )
        for first, last, growth, end, along in (
            (BOX, END, -1.0, None, n),
            (END, END + 0.1, 1.0, None, n // 2),
            (END + 0.1, LENGTH, 2.5, "x1", n),
        ):
            blocks.append(((along, count), _along(heights, first, last, growth), ((None, end), walls)))
    return assembled(blocks, "quad9", 1e-9)


def _fan(k: int, n: int) -> Block:
    """A quarter between the cylinder and the walls."""
    name = (None, "y1", "x0", "y0")[k]
    corners = np.array([(BOX, 0.0), (BOX, HEIGHT), (0.0, HEIGHT), (0.0, 0.0)])

    def place(p: Array) -> Array:
        angle = (k - 0.5 + p[:, 1]) * np.pi / 2
        edge = corners[k] + p[:, 1:] * (corners[(k + 1) % 4] - corners[k])
        return _from_cylinder(p[:, :1], angle, edge)

    return (n, n), place, (("cylinder", name), (None, None))


def _from_cylinder(out: Array, angle: Array, edge: Array) -> Array:
    arc = CENTRE + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.asarray(arc + np.expm1(out) / np.expm1(1.0) * (edge - arc))


def _behind(heights: Callable[[Array], Array], angles: Array, straight: bool) -> Callable[[Array], Array]:
    def place(p: Array) -> Array:
        y = heights(p[:, 1])
        even = angles[0] + (angles[1] - angles[0]) * p[:, 1]
        angle = np.arcsin((y - CENTRE[1]) / RADIUS) if straight else even
        return _from_cylinder(p[:, :1], angle, np.column_stack([0 * y + BOX, y]))

    return place


def _along(
    heights: Callable[[Array], Array], first: float, last: float, growth: float
) -> Callable[[Array], Array]:
    def place(p: Array) -> Array:
        x = first + (last - first) * np.expm1(growth * p[:, 0]) / np.expm1(growth)
        return np.column_stack([x, heights(p[:, 1])])

    return place


def flag_mesh(n: int, m: int) -> vv.Mesh:
    """The flag from the cylinder's arc (a hair outside of it) to its end."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(n, m), cell="quad9").build()
    y = CENTRE[1] + THICK * (flat.points[:, 1] - 0.5)
    left = CENTRE[0] + np.sqrt((CLEAR * RADIUS) ** 2 - (y - CENTRE[1]) ** 2)
    return vv.Mesh(
        np.column_stack([left + flat.points[:, 0] * (END - left), y]), flat.cells, face_sets=flat.face_sets
    )


def profile(X: Array, mean: float) -> Array:
    """Velocities (n, 3) of the inflow."""
    return np.outer(mean * 6 * X[:, 1] * (HEIGHT - X[:, 1]) / HEIGHT**2, (1.0, 0.0, 0.0))


def conditions(water: vv.Fluid, speed: Callable[[float], float], still: Sequence[str]) -> list[Component]:
    """The inflow with a mean velocity, sides where the water sticks, and the outlet."""
    return [
        vv.VelocityBoundary(fluid=water, faces="x0", velocity=lambda t, X: profile(X, speed(t))),
        *(vv.NoSlip(fluid=water, faces=side) for side in still),
        vv.Outlet(fluid=water, faces="x1"),
    ]


class Flag:
    """The system, and the displacement of the flag's end with the forces on cylinder and flag.

    Parameters
    ----------
    mesh : Mesh
        Of the channel.
    cells : (int, int)
        Of the flag, along and across.
    kind : Kind
    damping : float
        Of the immersed flag.
    """

    def __init__(
        self, mesh: vv.Mesh, cells: tuple[int, int], kind: Kind = FSI1, damping: float = 0.0
    ) -> None:
        water = vv.Fluid(mesh=mesh, density=1000.0, viscosity=1.0)
        solid = vv.Solid(
            mesh=flag_mesh(*cells),
            material=vv.SaintVenantKirchhoff(shear=0.5e6, poisson=0.4),
            density=kind.density,
        )
        self.water, self.solid = water, solid
        self.wet = vv.Immersed(solid=solid, fluid=water, damping=damping)
        self.system = vv.System(
            [
                water,
                *conditions(water, kind.speed, ("y0", "y1", "cylinder")),
                solid,
                vv.Fixed(solid=solid, nodes="x0"),
                self.wet,
            ],
            vv.Newton(tolerance=1e-9),
        )
        self.end = int(np.argmin(np.linalg.norm(solid.points[:, :2] - (END, CENTRE[1]), axis=1)))

    def state(self) -> Array:
        """Displacement of the end, drag and lift (4,)."""
        held = vv.FlowForce(fluid=self.water, faces="cylinder")(self.system)
        force = held + self.wet.forces(self.system.x).sum(axis=0)
        return np.hstack([self.solid.displacements(self.system.x)[self.end, :2], force[:2]])

    def march(self, until: float, step: float, scheme: vv.Scheme | None = None) -> Array:
        """Times and states (n, 5) after every step, of backward Euler by default."""
        steps = vv.march(self.system, until=until, step=step, scheme=scheme or vv.BackwardEuler())
        return np.array([[self.system.time, *self.state()] for _ in steps])

    def unseen(self, small: float = 1e-2) -> tuple[int, int, float]:
        """How many places follow the fluid, how many patterns of them no flow moves by more than `small`, and by how
        much the least moves: singular values of the interpolation."""
        from scipy.linalg import svdvals

        at = self.water.at(self.solid.positions(self.system.x)[self.wet._nodes, :2])
        weights = np.zeros((len(at.nodes), self.water.grid.n_nodes))
        np.add.at(weights, (np.arange(len(at.nodes))[:, None], at.nodes), at.weights)
        for side in ("x0", "y0", "y1", "cylinder"):
            weights[:, self.water.grid.nodes(side)] = 0
        values = svdvals(weights[:, np.any(weights != 0, axis=0)])
        values = np.pad(values, (0, max(0, len(weights) - len(values))))
        return len(weights), int(np.sum(values < small)), float(values.min())
