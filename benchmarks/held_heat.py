"""How far the temperature that conducts is from the one that is held, where strains are singular.

    PYTHONPATH=src python benchmarks/held_heat.py [--counts 2 4 6]

A cube is clamped at two opposite faces, one of which is brought from 300 to 320 and held there. Printed is the least
temperature that conducts at its nodes, by the coupling alpha^2 E T / c and the number of cells along an edge.
"""

from __future__ import annotations

import argparse

import numpy as np

import visviva as vv

YOUNG, START, CAPACITY, RISE = 210e9, 300.0, 3.6e6, 20.0


def conducting(count: int, coupling: float) -> float:
    """The least temperature of the last step at nodes that are held."""
    heat = vv.Heat(
        conductivity=50.0,
        capacity=CAPACITY,
        expansion=float(np.sqrt(coupling * CAPACITY / (YOUNG * START))),
        reference=START,
    )
    cube = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(count, count, count)),
        material=vv.NeoHooke(young=YOUNG, poisson=0.3),
        density=7850.0,
        heat=heat,
        temperature=START,
    )
    clamped = [vv.Fixed(solid=cube, nodes=face) for face in ("x0", "x1")]
    held = vv.PrescribedTemperature(body=cube, nodes="x0", value=f"{START} + {RISE} * min(t / 400, 1)")
    system = vv.System([cube, *clamped, held])
    vv.simulate(system, until=800.0, step=400.0, scheme=vv.BackwardEuler())
    return float(system.x[cube.algorithmic.start + cube.nodes("x0")].min())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--counts", type=int, nargs="+", default=(2, 4, 6))
    counts = parser.parse_args().counts
    print("coupling" + "".join(f"{f'{n} cells':>10s}" for n in counts))
    for coupling in (1e-3, 0.02, 1.0, 5.0):
        print(f"{coupling:8g}" + "".join(f"{conducting(n, coupling):10.2f}" for n in counts), flush=True)


if __name__ == "__main__":
    main()
