"""PFHub's benchmarks 1a (periodic) and 1b (no flux): energies beside those of pseudo-spectral solutions.

python benchmarks/spinodal.py [--case a] [--count 200] [--cell quad4] [--until 1e4] [--tolerance 3e-2]

The spectral solutions are of ETD-RK4 with a tolerance of 1e-5, 256 x 256 Fourier waves (a) and 200 x 200 cosines (b). A
code with a spacing of one is to be within 0.5 % until t = 100, within 2 % later.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import visviva as vv
from visviva.examples.spinodal import start

TIMES = (0, 1, 2, 3, 5, 10, 20, 30, 50, 100, 200, 300, 500, 700, 1000, 2000, 3000, 5000, 7000, 10000)
SPECTRAL = {
    "a": (319.1932497, 318.8603859, 318.5465585, 318.0954309, 316.4181572, 297.9668415, 212.9302774, 196.7024732,
          167.3638131, 136.9816489, 118.7151402, 109.2255374, 99.4523644, 92.9644474, 84.8407404, 61.6683426,
          51.4968180, 43.8508541, 39.4047012, 33.0785263),
    "b": (319.0431732, 318.8378527, 318.5686654, 318.2079971, 317.0182160, 304.1157217, 209.4343104, 195.1778616,
          166.6895437, 129.8796234, 111.4501532, 103.4416899, 92.2047775, 81.8541932, 73.9833934, 60.6316429,
          51.9130077, 47.3312610, 42.3694796, 38.7964596),
}  # fmt: skip
"""Energies at these times."""


def alloy(case: str, count: int, cell: str) -> vv.CahnHilliard:
    """A square of 200 with `count` cells along each side."""
    size, counts = (200, 200), (count, count)
    splines = cell.startswith("spline")
    mesh = (
        vv.SplineBox(size=size, counts=counts, degree=int(cell[-1]))
        if splines
        else vv.RectangleMesh(size=size, counts=counts, cell=cell)
    )
    return vv.CahnHilliard(
        mesh=mesh,
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=start,
        periodic=(("x0", "x1"), ("y0", "y1")) if case == "a" else (),
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", choices=("a", "b"), default="a")
    parser.add_argument("--count", type=int, default=200, help="cells along each side")
    parser.add_argument("--cell", default="quad4", help="type of cell, or spline2, spline3, spline4")
    parser.add_argument("--until", type=float, default=1e4)
    parser.add_argument(
        "--tolerance", type=float, default=1e-3, help="error of a step by the range of phases"
    )
    parser.add_argument("--newton", type=float, default=1e-8, help="tolerance of Newton's iteration")
    given = parser.parse_args()
    body = alloy(given.case, given.count, given.cell)
    system = vv.System([body], newton=vv.Newton(tolerance=given.newton))
    rule = vv.Adaptive(tolerance=given.tolerance, max_step=given.until)
    mass, began, steps, iterations = body.integral(system.x), time.process_time(), 0, 0
    rising = -np.inf
    print("      t      energy    spectral       off    steps  iterations  processor s")
    for t, reference in zip(TIMES, SPECTRAL[given.case], strict=True):
        if t > given.until:
            break
        if t > 0:
            result = vv.simulate(system, until=float(t), step=0.5, adaptive=rule)
            steps += result.statistics.steps
            iterations += result.statistics.iterations
            rising = max(rising, float(np.diff(result.ledger["potential_stored"]).max()))
        energy = sum(body.energies(system.x))
        seconds = time.process_time() - began
        print(
            f"{t:7g} {energy:11.5f} {reference:11.5f} {100 * (energy / reference - 1):+8.3f} % {steps:6d} "
            f"{iterations:8d} {seconds:10.1f}",
            flush=True,
        )
    print(
        f"mass off by {body.integral(system.x) / mass - 1:.1e}, largest change of the energy in a step {rising:.1e}"
    )


if __name__ == "__main__":
    main()
