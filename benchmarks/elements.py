"""What solid elements cost: residual, and residual with tangent and scatter, in microseconds of CPU time per element.

    python benchmarks/elements.py [--repeat 20] [--threads]

Cubes of compressible neo-Hookean material at a state slightly deformed, one thread; best of some repetitions. The
second figure sets the matrix to zero, evaluates both in one pass and adds them to where they belong; what copying the
matrix to Python takes is subtracted. With `--threads` it measures the time by the clock instead, with the threads that
OMP_NUM_THREADS allows.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from profile_steps import best

import visviva as vv
from visviva.mesh.generate import SolidCell
from visviva.scheme import Scheme
from visviva.solve import prepare

COUNTS: dict[SolidCell, int] = {"hex8": 24, "tet4": 14, "hex20": 10, "hex27": 10, "tet10": 8}
SCHEMES: dict[str, Scheme] = {"statics": vv.Static(), "energy-momentum": vv.EnergyMomentum()}


def cube(cell: SolidCell, n: int) -> vv.System:
    """A cube of n x n x n cells, clamped at one face and stretched."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=cell),
        material=vv.NeoHooke(young=1000.0, poisson=0.3),
        density=1.0,
    )
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="x0")])
    system.x[:] *= 1.0 + 1e-3 * np.random.default_rng(0).standard_normal(len(system.x))
    return system


def costs(
    system: vv.System, scheme: Scheme, n_elements: int, repeat: int, threads: bool
) -> tuple[float, float]:
    """Microseconds per element of the residual, and of residual, tangent and scatter."""
    prepare(system, scheme)
    step = scheme.step(system.time, 0.01)
    core, signals = system.core, system.signals(step).copy()
    residual, values = np.zeros(len(system.x)), np.zeros(core.n_entries)
    other = values.copy()
    clock = time.perf_counter if threads else time.process_time
    r = best(lambda: core.assemble(step, signals, residual, None), repeat, clock)
    both = best(lambda: core.assemble(step, signals, residual, values), repeat, clock)
    copy = best(lambda: np.copyto(other, values), repeat, clock)
    return r / n_elements, (both - copy) / n_elements


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=20)
    parser.add_argument("--threads", action="store_true", help="time by the clock, with several threads")
    given = parser.parse_args()
    print(f"{'cell':6s} {'cells':>6s}  {'scheme':16s} {'residual':>9s} {'residual, tangent, scatter':>27s}")
    for cell, n in COUNTS.items():
        n_elements = (6 if cell.startswith("tet") else 1) * n**3
        for name, scheme in SCHEMES.items():
            r, both = costs(cube(cell, n), scheme, n_elements, given.repeat, given.threads)
            print(f"{cell:6s} {n_elements:6d}  {name:16s} {r:9.2f} {both:27.2f}")


if __name__ == "__main__":
    main()
