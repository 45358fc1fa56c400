"""Heat alone on growing meshes with multigrid, and a thermoelastic torus beside the elastic one.

    python benchmarks/heat.py [--largest 1e6] [--around 24] [--step 0.02]

Heat: a cube of hexahedra, one side held, one that exchanges heat; seconds of one processor for a time step once the
hierarchy is made, and for the step that makes it. A million nodes take about 9 GB.

Torus: the left one of the impact of two tori on a coarse mesh, spinning; assembly of residual and tangent, and the mean
of some steps, whether they make a tangent anew or not.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def seconds(call: Callable[[], object], times: int = 1) -> float:
    """Of the processor, the least of some."""
    found = []
    for _ in range(times):
        start = time.process_time()
        call()
        found.append(time.process_time() - start)
    return min(found)


def cube(n: int) -> vv.System:
    """A cube of n^3 hexahedra."""
    body = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)),
        conductivity=1.0,
        temperature=lambda X: np.sin(3 * X[:, 0]) * X[:, 1],
    )
    held = vv.PrescribedTemperature(body=body, nodes="x0", value="1 + t")
    return vv.System([body, held, vv.Convection(body=body, faces="x1", coefficient=2.0, ambient=3.0)])


def heat_alone(largest: float) -> None:
    """Prints a line for every size."""
    print("heat alone:   nodes   first step   others, s per step and per million nodes    memory, GB")
    for n in (20, 40, 60, 80, 99):
        nodes = (n + 1) ** 3
        if nodes > largest:
            break
        system = cube(n)
        steps = vv.march(system, until=1.0, step=0.01)
        first = seconds(lambda steps=steps: next(steps))
        later = seconds(lambda steps=steps: next(steps), 3)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(f"{nodes:20d} {first:12.2f} {later:12.3f} {1e6 * later / nodes:12.2f} {memory:25.2f}")
    print(system.linear_explanation)


def torus(around: int, kind: type[vv.Solid], **options: object) -> vv.System:
    """A hollow torus that spins."""
    mesh = vv.HollowTorusMesh(
        major_radius=76.0, outer_minor_radius=24.0, wall=4.5, counts=(around, max(8, 3 * around // 10), 1)
    )
    rubber = vv.NeoHooke(young=2250.0, poisson=0.3)
    spin = (0.1, 0.2, 0.3)
    return vv.System([kind(mesh=mesh, material=rubber, density=0.1, angular_velocity=spin, **options)])


def measured(system: vv.System, length: float) -> Array:
    """Seconds of the assembly of residual and tangent, and of a whole step of a length in the mean."""
    step, n = vv.EnergyMomentum().step(0.0, length), 20
    signals, residual, values = system.signals(step), np.zeros(len(system.x)), np.zeros(system.core.n_entries)
    assembly = seconds(lambda: system.core.assemble(step, signals, residual, values), 5)
    steps = vv.march(system, until=1000 * length, step=length)
    next(steps)
    return np.array([assembly, seconds(lambda: [next(steps) for _ in range(n)], 3) / n])


def tori(around: int, length: float) -> None:
    """Prints the elastic and the thermoelastic torus, and their ratios."""
    warm = vv.Heat(conductivity=5.0, capacity=1.0, expansion=1e-4)
    heated = torus(around, vv.ThermoelasticSolid, heat=warm, temperature=lambda X: 293.15 + X[:, 0] / 10)
    found = []
    print("torus:        unknowns   assembly    step, s")
    for name, system in (("elastic", torus(around, vv.Solid)), ("thermoelastic", heated)):
        found.append(measured(system, length))
        print(f"{name:14s}{len(system.x):8d} {found[-1][0]:10.4f} {found[-1][1]:8.4f}")
    ratio = found[1] / found[0]
    print(f"{'ratio':22s} {ratio[0]:10.2f} {ratio[1]:8.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--largest", type=float, default=1e6, help="nodes of the largest cube, 0 for none")
    parser.add_argument("--around", type=int, default=24, help="cells around the torus")
    parser.add_argument("--step", type=float, default=0.02, help="length of the torus' steps")
    given = parser.parse_args()
    if given.largest > 0:
        heat_alone(given.largest)
    tori(given.around, given.step)


if __name__ == "__main__":
    main()
