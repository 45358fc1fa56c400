"""How fast the heat converges that a face takes in where strains are singular and couple strongly.

    PYTHONPATH=src python benchmarks/held_heat.py

A cube is clamped at two opposite faces, one of which is brought from 300 to 302 and held there. Printed is the heat
that it has taken in at 0.11 c (1 + coupling) L^2 / k, relative to that of 6 hex20 along an edge, by the coupling
alpha^2 E T / c; and the most by which the temperature that conducts at its nodes is off.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

import visviva as vv

YOUNG, START, CAPACITY, RISE = 210e9, 300.0, 3.6e6, 2.0
COUPLINGS = (0.02, 1.0, 5.0)
ELEMENTS: list[tuple[str, Any, tuple[int, ...]]] = [
    ("hex8", "displacement", (2, 4, 8)),
    ("hex8", "enhanced", (2, 4, 8)),
    ("hex20", "displacement", (2, 4)),
]


def heated(cell: str, formulation: Any, count: int, coupling: float) -> tuple[float, float]:
    """The heat that has come in, and by how much held nodes are off."""
    heat = vv.Heat(
        conductivity=50.0,
        capacity=CAPACITY,
        expansion=float(np.sqrt(coupling * CAPACITY / (YOUNG * START))),
        reference=START,
    )
    cube = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(count, count, count), cell=cell),
        material=vv.NeoHooke(young=YOUNG, poisson=0.3),
        formulation=formulation,
        heat=heat,
    )
    clamped = [vv.Fixed(solid=cube, nodes=face) for face in ("x0", "x1")]
    held = vv.PrescribedTemperature(body=cube, nodes="x0", value=f"{START} + {RISE} * min(t / 400, 1)")
    system = vv.System([cube, *clamped, held])
    long = 1 + coupling
    result = vv.simulate(system, until=8000.0 * long, step=400.0 * long, scheme=vv.BDF2())
    off = np.abs(system.x[cube.temperature_unknowns(cube.nodes("x0"))] - START - RISE).max()
    return float(result.ledger["heat_supply"][-1]), float(off)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    finest = [heated("hex20", "displacement", 6, coupling)[0] for coupling in COUPLINGS]
    print("cells                  " + "".join(f"{f'coupling {k:g}':>14s}" for k in COUPLINGS), flush=True)
    worst = 0.0
    for cell, formulation, counts in ELEMENTS:
        for n in counts:
            found = [heated(cell, formulation, n, coupling) for coupling in COUPLINGS]
            worst = max(worst, *(off for _, off in found))
            row = "".join(
                f"{heat / exact - 1:+14.1%}" for (heat, _), exact in zip(found, finest, strict=True)
            )
            print(f"{n} {cell:6s}{formulation:15s}{row}", flush=True)
    print(f"held nodes conduct at what they are held at, to {worst:.0e}")


if __name__ == "__main__":
    main()
