"""What few cells over an interface cost: speeds of flat fronts and energies of flat interfaces beside closed forms.

    python benchmarks/front_speed.py [--distances 2.1 3 4 6 8]

A front of Allen & Cahn's equation with ``f' = c (c - a) (c - 1)``, M = kappa = 1, has the profile
``(1 - tanh(x / sqrt(8))) / 2``, ``sqrt(32)`` wide, and the speed ``(1 - 2 a) / sqrt(2)``. The interface of
``c^2 (1 - c)^2 / 4`` is as wide and has the tension ``sqrt(2) / 12``. Prints what of both is too much, in percent, of
speeds also under the weak drives that pull at interfaces of radii of 25 and 100 widths; -100 is a front that stands.
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
RADII = 25, 100
"""In widths: a drive of the tension over one of them gives the speed ``1 / R``."""
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


def speed(distances: float, cell: Cell, a: float = UNSTABLE, way: float = 12.0) -> float:
    """Over its closed form; by the area behind the front, over the last two thirds of its way, in widths."""
    energy = vv.PolynomialEnergy(coefficients=(0.0, 0.0, a / 2, -(1 + a) / 3, 0.25))
    exact = (1 - 2 * a) / np.sqrt(2)
    body = strip(distances, cell, (way + 6) * WIDTH, energy, 3 * WIDTH)
    result = vv.simulate(vv.System([body]), until=way * WIDTH / exact, step=0.05 * WIDTH / exact)
    late = len(result.times) // 3
    areas = [body.integral(x) for x in result.states[late:]]
    return float(np.polyfit(result.times[late:], areas, 1)[0] / exact)


def slowly(distances: float, cell: Cell, radius: float) -> float:
    """The speed under a weak drive."""
    return speed(distances, cell, 0.5 - 1 / (np.sqrt(2) * radius * WIDTH), way=3.0)


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
    print("cell     distances of nodes over the width   tension   speed    R/25   R/100")
    for cell in DISTANCES:
        for distances in given.distances:
            found = [
                tension(distances, cell),
                speed(distances, cell),
                *(slowly(distances, cell, R) for R in RADII),
            ]
            print(
                f"{cell:8s} {distances:34g} " + " ".join(f"{100 * of - 100:8.2f}" for of in found), flush=True
            )


if __name__ == "__main__":
    main()
