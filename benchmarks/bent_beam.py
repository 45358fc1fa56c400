"""Notched beam in three-point bending: the largest load against that of linear fracture mechanics.

Span to height 4, a notch to half of the height: ``K = P S / W^(3/2) f``, f(1/2) = 2.66 (ASTM E399), at
``K^2 / E' = Gc``. The load follows the path of the crack through snap-back.

    python benchmarks/bent_beam.py [--length 0.03] [--cells 2] [--model AT1]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import visviva as vv
from visviva.examples.notch import lines

YOUNG, POISSON, TOUGHNESS, SPAN, DEPTH = 1.0, 0.2, 1e-8, 4.0, 0.5


def shape(a: float) -> float:
    """ASTM E399."""
    upper = 1.99 - a * (1 - a) * (2.15 - 3.93 * a + 2.7 * a * a)
    return 3 * np.sqrt(a) * upper / (2 * (1 + 2 * a) * (1 - a) ** 1.5)


def beam(length: float, cells: float, model: str) -> vv.System:
    """`cells` per length above the notch."""
    h = length / cells
    side = np.ceil(1.5 * length / h) * h / SPAN
    x, y = SPAN * lines(0.5 - side, 0.5 + side, h / SPAN, 0.03), lines(DEPTH, 0.9, h)
    unit = vv.RectangleMesh(size=(1, 1), counts=(len(x) - 1, len(y) - 1)).build()
    i, j = np.rint(unit.points * (len(x) - 1, len(y) - 1)).astype(int).T
    mesh = vv.Mesh(np.stack([x[i], y[j]], axis=1), unit.cells, face_sets=unit.face_sets)
    mesh = mesh.opened(
        lambda X: (np.abs(X[:, 0] - SPAN / 2) < 1e-9) & (X[:, 1] < DEPTH - 1e-9), lambda X: X[:, 0] > SPAN / 2
    )
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=length,
        model=model,  # type: ignore[arg-type]
        split="spectral",
    )
    X = mesh.points
    corners = np.flatnonzero((X[:, 1] < 1e-9) & ((X[:, 0] < 1e-9) | (X[:, 0] > SPAN - 1e-9)))
    loaded = np.flatnonzero((X[:, 1] > 1 - 1e-9) & (np.abs(X[:, 0] - SPAN / 2) < 0.06))
    middle = loaded[np.argmin(np.abs(X[loaded, 0] - SPAN / 2))]
    return vv.System(
        [
            solid,
            vv.Fixed(solid=solid, nodes=corners, directions=(False, True, False)),
            vv.Fixed(solid=solid, nodes=[middle], directions=(True, False, False)),
            vv.Prescribed(solid=solid, nodes=loaded, motion=(None, "-t", None), name="pressed"),
        ]
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--length", type=float, default=0.03)
    parser.add_argument("--cells", type=float, default=2.0)
    parser.add_argument("--model", default="AT1")
    parser.add_argument("--growth", type=float, default=0.02)
    parser.add_argument("--steps", type=int, default=60)
    args = parser.parse_args()
    system = beam(args.length, args.cells, args.model)
    solid = system.components[0]
    stiff = YOUNG / (1 - POISSON**2)
    expected = np.sqrt(TOUGHNESS * stiff) / (SPAN * shape(DEPTH))
    share = (0.375 if args.model == "AT1" else 0.5) / args.cells
    probe, area = vv.SupportForce(solid=solid, nodes=system.components[3].nodes), vv.CrackArea(solid=solid)
    begun, load = time.process_time(), [0.0]
    scheme = vv.CrackControl(growth=args.growth, unstable=True, most=args.steps)
    unit = 0.25 * expected * 20 / YOUNG
    print(f"{solid.grid.n_cells} cells")
    for report in vv.march(system, until=1.0, step=unit, scheme=scheme):
        load.append(-float(probe(system)[1]))
        print(
            f"{system.time:.4e} {load[-1] / expected:.4f} of the load, crack {area(system):.4f}, "
            f"{report.iterations} iterations, {time.process_time() - begun:.1f} s",
            flush=True,
        )
        if load[-1] < 0.5 * max(load):
            break
    ratio = max(load) / expected
    print(
        f"{args.model}, l = {args.length}, l / h = {args.cells}: largest load {max(load):.4e}, of linear fracture "
        f"mechanics {expected:.4e}: ratio {ratio:.4f}; with what cells add {ratio / np.sqrt(1 + share):.4f}"
    )


if __name__ == "__main__":
    main()
