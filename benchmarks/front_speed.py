"""What few cells over an interface cost: speeds of flat fronts and energies of flat interfaces beside closed forms.

    python benchmarks/front_speed.py [--distances 2.1 3 4 6 8]

A front of Allen & Cahn's equation with ``f' = c (c - a) (c - 1)``, M = kappa = 1, has the profile
``(1 - tanh(x / sqrt(8))) / 2``, ``sqrt(32)`` wide, and the speed ``(1 - 2 a) / sqrt(2)``. The interface of
``c^2 (1 - c)^2 / 4`` is as wide and has the tension ``sqrt(2) / 12``. Prints what of both is too much, in percent.
"""

from __future__ import annotations

import argparse
from typing import Literal

import numpy as np

import visviva as vv
from visviva.phase.free_energy import FreeEnergy

WIDTH = np.sqrt(32)
UNSTABLE = 0.35
"""Value a, at which the common tangent tells nearly the width of the front."""
Cell = Literal["quad4", "quad9"]
DISTANCES: dict[Cell, int] = {"quad4": 1, "quad9": 2}
"""Of nodes along a cell."""


def strip(distances: float, cell: Cell, length: float, energy: FreeEnergy, begin: float) -> vv.AllenCahn:
    """A strip of so many distances of nodes over a width, with an interface at its place of the beginning."""
    size = WIDTH * DISTANCES[cell] / distances
    n = round(length / size)
    return vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(n * size, 1.0), counts=(n, 1), cell=cell),
        free_energy=energy,
        gradient_energy=1.0,
        order=lambda X: 0.5 - 0.5 * np.tanh((X[:, 0] - begin) / np.sqrt(8)),
    )


def speed(distances: float, cell: Cell) -> float:
    """Over its closed form; by the area behind the front, over the last two thirds of its way."""
    a = UNSTABLE
    energy = vv.PolynomialEnergy(coefficients=(0.0, 0.0, a / 2, -(1 + a) / 3, 0.25))
    exact = (1 - 2 * a) / np.sqrt(2)
    body = strip(distances, cell, 18 * WIDTH, energy, 3 * WIDTH)
    result = vv.simulate(vv.System([body]), until=12 * WIDTH / exact, step=0.05 * WIDTH / exact)
    late = len(result.times) // 3
    areas = [body.integral(x) for x in result.states[late:]]
    return float(np.polyfit(result.times[late:], areas, 1)[0] / exact)


def tension(distances: float, cell: Cell) -> float:
    """Over its closed form."""
    body = strip(distances, cell, 12 * WIDTH, vv.DoubleWell(barrier=0.25), 6 * WIDTH)
    system = vv.System([body])
    vv.simulate(system, until=200.0, step=2.0, scheme=vv.BackwardEuler())
    return float(sum(body.energies(system.x)) / (np.sqrt(2) / 12))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--distances", type=float, nargs="+", default=[2.1, 3, 4, 6, 8])
    given = parser.parse_args()
    print("cell     distances of nodes over the width   tension   speed")
    for cell in DISTANCES:
        for distances in given.distances:
            off = [100 * (of(distances, cell) - 1) for of in (tension, speed)]
            print(f"{cell:8s} {distances:34g} {off[0]:9.2f} {off[1]:7.2f}", flush=True)


if __name__ == "__main__":
    main()
