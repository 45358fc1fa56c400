"""A step of a mixture in space: GMRES with contents beside their potentials, and factors.

python benchmarks/mixture_step.py [--counts 16 32 64] [--factors] [--step 0.2] [--steps 3]

Cubes of hexahedra of edge 1 with PFHub's free energy, periodic. Steps begin with waves of some tenths of the range, so
that all of the nonlinearity is there. Processor time of one thread.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.analysis.march import prepare


def start(X: NDArray[np.float64]) -> NDArray[np.float64]:
    """Waves along and across."""
    waves = 0.1 * np.cos(0.3 * X[:, 0]) * np.cos(0.25 * X[:, 1] + 0.2 * X[:, 2])
    return np.asarray(0.5 + waves + 0.05 * np.cos(0.7 * X[:, 2]))


def alloy(n: int) -> vv.CahnHilliard:
    """A cube of n^3 cells."""
    return vv.CahnHilliard(
        mesh=vv.BoxMesh(size=(n, n, n), counts=(n, n, n)),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=start,
        periodic=[("x0", "x1"), ("y0", "y1"), ("z0", "z1")],
    )


def measure(n: int, linear: vv.Iterative | vv.Direct, step: float, steps: int) -> None:
    """Print every step."""
    body = alloy(n)
    system = vv.System([body], newton=vv.Newton(tolerance=1e-8, linear=linear))
    scheme, mass = vv.EnergyMomentum(), body.integral(system.x)
    prepare(system, scheme)
    for _ in range(steps):
        began = time.process_time()
        report = system.step(step, scheme)
        seconds = time.process_time() - began
        print(
            f"{n}^3, {system.core.solver}: {seconds:.2f} s, {report.iterations} iterations, "
            f"{report.factorizations} tangents, energy {sum(body.energies(system.x)):.8g}, mass off by "
            f"{body.integral(system.x) / mass - 1:.0e}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--counts", type=int, nargs="+", default=[16, 32, 64])
    parser.add_argument("--factors", action="store_true", help="factors too")
    parser.add_argument("--step", type=float, default=0.2)
    parser.add_argument("--steps", type=int, default=3)
    given = parser.parse_args()
    for n in given.counts:
        measure(
            n,
            vv.Iterative(method="gmres", preconditioner="mixture", tolerance=1e-3),
            given.step,
            given.steps,
        )
        if given.factors:
            measure(n, vv.Direct(), given.step, given.steps)


if __name__ == "__main__":
    main()
