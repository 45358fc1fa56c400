"""Single-edge notched plate in tension or shear: the force against published curves, the price of a step.

Miehe, Hofacker & Welschinger (2010): 1 mm x 1 mm, a notch from the left edge to the middle, below held, above moved up
or aside; E = 210 GPa, nu = 0.3, Gc = 2.7 N/mm, l = 0.015 mm, plane strain, AT2. Digitised peaks: in tension 0.7012 kN,
in shear 0.5312 kN at 0.0098 mm. There the left and the right side keep their height; with --free they do not.

    python benchmarks/notched_plate.py [--shear [--free]] [--size 0.005] [--step 5e-5] [--scheme static|crack]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import visviva as vv
from visviva.examples.notch import lines, notched

LENGTH, TOUGHNESS = 0.015, 2.7e-3  # mm, kN/mm


def model(size: float, shear: bool, split: str, kind: str = "AT2", free: bool = False) -> vv.System:
    """The plate with its supports; in shear the sides keep their height unless they are `free`."""
    half = round(0.04 / size) * size
    x = lines(0.5 - half if shear else 0.5, 1, size)
    y = lines(0.0 if shear else 0.5 - half, 0.5 + half, size)
    plate = vv.FracturingSolid(
        mesh=notched(x, y, 0.5, 0.5),
        material=vv.SaintVenantKirchhoff(young=210.0, poisson=0.3),
        toughness=TOUGHNESS,
        length=LENGTH,
        model=kind,
        split=split,
        name="plate",
    )
    held = vv.Fixed(solid=plate, nodes="y0")
    motion = ("t", "0", None) if shear else ("0", "t", None)
    moved = vv.Prescribed(solid=plate, nodes="y1", motion=motion, name="moved")
    sides = np.union1d(plate.nodes("x0"), plate.nodes("x1"))
    sides = np.setdiff1d(sides, np.union1d(plate.nodes("y0"), plate.nodes("y1")))
    level = vv.Fixed(solid=plate, nodes=sides, directions=(False, True, False), name="sides")
    return vv.System([plate, held, moved, *([level] if shear and not free else [])])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--shear", action="store_true")
    parser.add_argument("--free", action="store_true")
    parser.add_argument("--size", type=float, default=0.005)
    parser.add_argument("--step", type=float, default=5e-5)
    parser.add_argument("--until", type=float, default=None)
    parser.add_argument("--split", default=None)
    parser.add_argument("--kind", default="AT2")
    parser.add_argument("--newton", type=int, default=5)
    parser.add_argument("--tolerance", type=float, default=1e-5)
    parser.add_argument("--scheme", default="alternate")
    args = parser.parse_args()
    split = args.split or ("spectral" if args.shear else "none")
    system = model(args.size, args.shear, split, args.kind, args.free)
    plate = system.components[0]
    until = args.until or (0.015 if args.shear else 0.0062)
    print(f"{plate.grid.n_cells} cells, {system.core.n_equations} equations; {system.linear_explanation}")
    force = vv.SupportForce(solid=plate, nodes="y1")
    if args.scheme == "static":
        scheme = vv.Static(unstable=True)
    elif args.scheme == "crack":
        scheme = vv.CrackControl(growth=0.01, unstable=True, most=400)
    else:
        scheme = vv.AlternateMinimization(
            energy_tolerance=args.tolerance, newton=args.newton, unstable=True, halvings=2
        )
    peak, begun = (0.0, 0.0), time.perf_counter()
    for report in vv.march(system, until=until, step=args.step, scheme=scheme):
        f = np.asarray(force(system))[0 if args.shear else 1]
        peak = max(peak, (abs(f), system.time))
        print(
            f"{system.time:.6f} mm {f:9.5f} kN, crack {plate.crack_energy(system.x) / TOUGHNESS:.4f} mm, "
            f"d {plate.damages(system.x).max():.3f}, {report.iterations} iterations, "
            f"{time.perf_counter() - begun:.1f} s",
            flush=True,
        )
        if abs(f) < 0.05 * peak[0]:
            break
    print(f"peak {peak[0]:.4f} kN at {peak[1]:.6f} mm")


if __name__ == "__main__":
    main()
