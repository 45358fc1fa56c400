"""How far elements of equal order let constant temperatures go, away from the reference.

    python benchmarks/warm_stream.py [--across 8 16]

A stream at a Reynolds number of 60 and a Peclet number of 200 comes in at 400 into a channel that widens from 1 to 2
and is at 400 as well. Prints the largest distance of temperatures from 400 after 100 units of time, with the reference
at 300 and at 400.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def widening(cell: str, across: int) -> vv.Mesh:
    """A channel from 1 to 2 wide, whose floor sinks smoothly."""
    mesh = vv.RectangleMesh(size=(4, 1), counts=(4 * across, across), cell=cell).build()  # type: ignore[arg-type]
    X = mesh.points.copy()
    s = np.clip((X[:, 0] - 1) / 0.6, 0, 1)
    sinks = s**2 * (3 - 2 * s)
    X[:, 1] = X[:, 1] * (1 + sinks) - sinks
    return vv.Mesh(points=X, cells=mesh.cells, face_sets=mesh.face_sets)


def parabola(t: float, X: Array) -> Array:
    return 6 * X[:, 1:2] * (1 - X[:, 1:2]) * [1, 0, 0]


def apart(cell: str, across: int, reference: float) -> float:
    """Largest distance of temperatures from that of the inflow."""
    fluid = vv.Fluid(mesh=widening(cell, across), density=1.0, viscosity=1 / 60)
    heat = vv.FluidHeat(fluid=fluid, conductivity=5e-3, capacity=1.0, temperature=400.0, reference=reference)
    system = vv.System(
        [
            fluid,
            heat,
            vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=parabola),
            *[vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")],
            vv.Outlet(fluid=fluid, faces="x1"),
            vv.PrescribedTemperature(body=heat, nodes="x0", value=400.0),
        ]
    )
    vv.simulate(system, until=100.0, step=0.5, scheme=vv.BackwardEuler())
    return float(np.abs(heat.temperatures(system.x) - 400).max())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--across", type=int, nargs="+", default=[8, 16], help="cells over the width")
    counts = parser.parse_args().across
    print("cell   across  reference 300  reference 400")
    for cell, n in [("quad4", n) for n in counts] + [("quad9", counts[0])]:
        off = [apart(cell, n, reference) for reference in (300.0, 400.0)]
        print(f"{cell:5s}  {n:6d}  {off[0]:13.2g}  {off[1]:13.1e}")


if __name__ == "__main__":
    main()
