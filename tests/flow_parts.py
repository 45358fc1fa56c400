"""Fluids for the catalogue: distorted cells with every kind of boundary."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]
Components = list[Component]


def distorted(cell: str, counts: tuple[int, ...] = (2, 1, 1)) -> vv.Mesh:
    """A box of cells of which none is a parallelogram or parallelepiped."""
    flat = cell.startswith(("tri", "quad"))
    d = 2 if flat else 3
    shape: Any = vv.RectangleMesh if flat else vv.BoxMesh
    mesh = shape(size=(2.0, 1.2, 1.0)[:d], counts=counts[:d], cell=cell).build()
    X = mesh.points
    inside = np.prod(np.sin(np.pi * X / X.max(axis=0)), axis=1, keepdims=True)
    across = X[:, :1] * (0.1 + 0.05 * X[:, 1:2])  # straight sides that are not parallel to an axis
    moved = X + 0.05 * inside + np.pad(across * X[:, 1:2] / 1.2, ((0, 0), (1, d - 2)))
    return vv.Mesh(moved, mesh.cells, face_sets=mesh.face_sets)


def swirl(X: Array) -> Array:
    """A velocity without divergence."""
    v = np.stack([np.sin(2 * X[:, 1]), np.sin(1.5 * X[:, 0]), np.zeros(len(X))], axis=1)
    return np.asarray(0.7 * v + [0.5, 0.0, 0.4 if np.ptp(X[:, 2]) > 0 else 0.0])


def stream(cell: str, **options: Any) -> Components:
    """Flow through a box: pulsating inflow, outlet, wall, traction, slip on an oblique side and a body force."""
    plane = cell.startswith(("tri", "quad"))
    fluid = vv.Fluid(
        mesh=distorted(cell),
        density=1.3,
        viscosity=0.2,
        velocity=swirl,
        body_force=lambda t, X: np.sin(t + X[:, ::-1]) * ([1, 1, 0] if plane else 1),
        **options,
    )
    others = [s for s in fluid.grid.face_sets if s.startswith("z")]

    def inflow(t: float, X: Array) -> Array:
        return (1 + 0.3 * np.sin(3 * t)) * swirl(X)

    return [
        fluid,
        vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=inflow),
        vv.Outlet(fluid=fluid, faces="x1", pressure="0.4*cos(2*t)"),
        vv.NoSlip(fluid=fluid, faces="y0"),
        vv.FreeSlip(fluid=fluid, faces="y1"),
        *[vv.FluidTraction(fluid=fluid, faces=s, traction=lambda t, X: 0.1 * X * np.cos(t)) for s in others],
    ]


def enclosed(cell: str, **options: Any) -> Components:
    """A box whose lid moves, under gravity."""
    fluid = vv.Fluid(mesh=distorted(cell, (2, 2, 2)), density=1.3, viscosity=0.2, **options)
    sides = [s for s in fluid.grid.face_sets if s != "y1"]
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=slide)
    down = vv.Gravity(acceleration=(0.0, -2.0, 0.0))
    return [down, fluid, lid, *[vv.NoSlip(fluid=fluid, faces=s) for s in sides]]


def slide(t: float, X: Array) -> Array:
    """Along the oblique lid of the box, zero at its ends."""
    return np.asarray(np.sin(2 * t) * (X[:, :1] * (2.0 - X[:, :1])) * [1.0, 0.16, 0.0])


def torus(cell: str, **options: Any) -> Components:
    """A periodic square."""
    mesh = vv.RectangleMesh(size=(2.0, 2.0), counts=(3, 3), cell=cell)
    sides: Any = (("x0", "x1"), ("y0", "y1"))

    def eddies(X: Array) -> Array:
        x, y = np.pi * X[:, 0], np.pi * X[:, 1]
        return np.stack([np.sin(y) + 0.2, np.sin(x), np.zeros(len(X))], axis=1)

    fluid: Any = {"density": 1.3, "viscosity": 0.05, "velocity": eddies}
    return [vv.Fluid(mesh=mesh, periodic=sides, **fluid, **options)]
