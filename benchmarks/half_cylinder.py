"""An elastic half cylinder on the floor of a channel, immersed in a very viscous fluid (Liu et al. 2014)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from half_cylinder_case import CENTRE, FLOOR, HEIGHT, LAME, LENGTH, RADIUS, SHEAR
from numpy.typing import NDArray

import visviva as vv
from visviva.material.material import Material
from visviva.mesh.grid import assembled

Array = NDArray[np.float64]

POISSON = LAME / (2 * (LAME + SHEAR))
FITTED = {"linear elastic": 0.1437, "Saint-Venant-Kirchhoff": 0.1136, "neo-Hooke": 0.1503}
"""Displacement of the top along the channel at rest, body-fitted, of solids that keep their volume, by
`half_cylinder_fitted.py --sizes 0.025`."""
MATERIALS: dict[str, Callable[[], Material]] = {
    "linear elastic": lambda: vv.LinearElastic(young=2 * SHEAR * (1 + POISSON), poisson=POISSON),
    "Saint-Venant-Kirchhoff": lambda: vv.SaintVenantKirchhoff(shear=SHEAR, poisson=POISSON),
    "neo-Hooke": lambda: vv.NeoHooke(shear=SHEAR, poisson=POISSON),
}


def half_disc(n: int) -> vv.Mesh:
    """A box of 2 n x n cells and three blocks around it; edges on the floor are the set y0."""
    s = RADIUS / 2

    def around(first: float, start: Array, end: Array) -> Callable[[Array], Array]:
        def place(p: Array) -> Array:
            turn = p[:, 1:]
            inner = start + turn * (end - start)
            span = np.arctan2(end[1], end[0]) - np.arctan2(start[1], start[0])
            angle = first + turn * span
            return np.asarray(inner + p[:, :1] * (RADIUS * np.hstack([np.cos(angle), np.sin(angle)]) - inner))

        return place

    a, b, c, d = (np.array(p) * s for p in ((1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)))
    mesh = assembled(
        [
            ((2 * n, n), lambda p: s * (p * (2, 1) - (1, 0)), ((None, None), ("y0", None))),
            ((n, n), around(0.0, a, b), ((None, None), ("y0", None))),
            ((n, 2 * n), around(np.pi / 4, b, c), ((None, None), (None, None))),
            ((n, n), around(3 * np.pi / 4, c, d), ((None, None), (None, "y0"))),
        ],
        "quad9",
        1e-9,
    )
    return vv.Mesh(mesh.points + CENTRE, mesh.cells, face_sets=mesh.face_sets)


def channel(per_unit: int, cell: str) -> vv.Mesh:
    """Squares up to twice the half cylinder's place, longer cells after it."""
    rows = round(HEIGHT * per_unit)

    def near(p: Array) -> Array:
        return np.column_stack([3 * p[:, 0], FLOOR + HEIGHT * p[:, 1]])

    def far(p: Array) -> Array:
        x = 3 + (LENGTH - 3) * np.expm1(1.5 * p[:, 0]) / np.expm1(1.5)
        return np.column_stack([x, FLOOR + HEIGHT * p[:, 1]])

    walls = ("y0", "y1")
    return assembled(
        [((3 * per_unit, rows), near, (("x0", None), walls)), ((rows, rows), far, ((None, "x1"), walls))],
        cell,
        1e-9,
    )


def inflow(t: float, X: Array) -> Array:
    grown = 0.5 * (1 - np.cos(np.pi * min(t, 2.0) / 2))
    return np.outer(grown * (1 + 2 * X[:, 1]) * (1 - X[:, 1]), (1.0, 0.0, 0.0))


def bend(per_unit: int, material: Material, cell: Literal["quad4", "quad9"] = "quad9") -> tuple[Array, float]:
    """Displacement (2,) of the top at t = 4, and the solid's area per that of the start."""
    fluid = vv.Fluid(mesh=channel(per_unit, cell), density=1.0, viscosity=1.0)
    solid = vv.Solid(mesh=half_disc(max(2, per_unit // 4)), material=material, density=1.0)
    system = vv.System(
        [
            fluid,
            vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=inflow),
            *(vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")),
            vv.FluidTraction(fluid=fluid, faces="x1", traction=(0, 0, 0)),
            solid,
            vv.Fixed(solid=solid, nodes="y0"),
            vv.Immersed(solid=solid, fluid=fluid),
        ],
        vv.Newton(tolerance=1e-8),
    )
    for _ in vv.march(system, until=4.0, step=0.1, scheme=vv.BackwardEuler()):
        pass
    top = int(np.argmin(np.linalg.norm(solid.points[:, :2] - CENTRE - (0, RADIUS), axis=1)))
    return solid.displacements(system.x)[top, :2], solid.volume(system.x) / solid.grid.volume
