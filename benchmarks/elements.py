"""What solid elements cost: residual, and residual with tangent and scatter, in microseconds of CPU time per element.

    python benchmarks/elements.py [--repeat 20] [--threads]

Cubes of compressible neo-Hookean material at a state slightly deformed, one thread; best of some repetitions. The
second figure sets the matrix to zero, evaluates both in one pass and adds them to where they belong; what copying the
matrix to Python takes is subtracted. With `--threads` it measures bricks by the clock instead, in turn with one thread
and with two, and prints how many times faster two are.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from profile_steps import best

import visviva as vv
from visviva.analysis.march import prepare
from visviva.mesh.generate import SolidCell
from visviva.scheme.schemes import Scheme

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
    system: vv.System, scheme: Scheme, n_elements: int, repeat: int, clock: Callable[[], float]
) -> tuple[float, float]:
    """Microseconds per element of the residual, and of residual, tangent and scatter."""
    prepare(system, scheme)
    step = scheme.step(system.time, 0.01)
    core, signals = system.core, system.signals(step).copy()
    residual, values = np.zeros(len(system.x)), np.zeros(len(system.pattern[1]))
    other = values.copy()
    r = best(lambda: core.assemble(step, signals, residual, None), repeat, clock)
    both = best(lambda: core.assemble(step, signals, residual, values), repeat, clock)
    copy = best(lambda: np.copyto(other, values), repeat, clock)
    return r / n_elements, (both - copy) / n_elements


def table(cells: list[SolidCell], repeat: int, clock: Callable[[], float]) -> None:
    """Print what elements of these kinds cost."""
    print(f"{'cell':6s} {'cells':>6s}  {'scheme':16s} {'residual':>9s} {'residual, tangent, scatter':>27s}")
    for cell in cells:
        n_elements = (6 if cell.startswith("tet") else 1) * COUNTS[cell] ** 3
        for name, scheme in SCHEMES.items():
            r, both = costs(cube(cell, COUNTS[cell]), scheme, n_elements, repeat, clock)
            print(f"{cell:6s} {n_elements:6d}  {name:16s} {r:9.2f} {both:27.2f}", flush=True)


def bricks(threads: int, repeat: int) -> NDArray[np.float64]:
    """The table of bricks by the clock, made by a process with so many threads: [scheme][residual, both]."""
    command = [sys.executable, __file__, "--bricks", "--repeat", str(repeat)]
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return np.array([[float(k) for k in line.split()[-2:]] for line in done.stdout.splitlines()[1:]])


def compare_threads(repeat: int, rounds: int = 3) -> None:
    """Print the shortest times of one thread and of two, measured in turn."""
    shortest = np.full((2, len(SCHEMES), 2), np.inf)
    for _ in range(rounds):
        for k in range(2):
            shortest[k] = np.minimum(shortest[k], bricks(k + 1, repeat))
    print(f"{'hex8':16s} {'one thread':>14s} {'two':>14s} {'times faster':>14s}")
    for i, name in enumerate(SCHEMES):
        columns = [*shortest[:, i], shortest[0, i] / shortest[1, i]]
        print(f"{name:16s} " + " ".join(f"{r:6.2f}, {both:6.2f}" for r, both in columns))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=20)
    parser.add_argument("--threads", action="store_true", help="compare one thread with two")
    parser.add_argument("--bricks", action="store_true", help="bricks alone, by the clock")
    given = parser.parse_args()
    if given.threads:
        compare_threads(given.repeat)
    elif given.bricks:
        table(["hex8"], given.repeat, time.perf_counter)
    else:
        table(list(COUNTS), given.repeat, time.process_time)


if __name__ == "__main__":
    main()
