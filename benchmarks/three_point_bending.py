"""Notched beam bent at three points: the force against a published curve.

Miehe, Hofacker & Welschinger (2010): 8 mm x 2 mm, a notch 0.4 mm wide and high, E = 20.8 kN/mm^2, nu = 0.3, Gc = 5e-4
kN/mm, l = 0.06 mm, plane strain, AT2, spectral split. Digitised: slope 0.965 kN/mm between 0.0104 and 0.0211 mm, peak
0.03475 kN at 0.0390 mm.
One half is computed. It stands on the last `--stand` mm of its lower side, and is pressed down `--press` mm beside the
middle; 0 is a single node.

    python benchmarks/three_point_bending.py [--size 0.015] [--stand 0.1] [--press 0.25] [--step 1e-3]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import visviva as vv
from visviva.examples.notch import lines

PEAK, AT, STIFFNESS = 0.03475, 0.0390, 0.965
LENGTH, TOUGHNESS = 0.06, 5e-4


def half_beam(size: float) -> vv.Mesh:
    """Columns of cells from the notch's side and the middle above it to the end, fine where the crack runs."""
    x = np.append(3.9 * lines(0.0, 0.05, size / 3.9, coarse=0.03), (3.95, 4.0))
    rows = round(2 / size)
    grid = vv.RectangleMesh(size=(4, 2), counts=(len(x) - 1, rows), grading=(tuple(np.diff(x)), 1.0)).build()
    X, Y = grid.points[:, 0], grid.points[:, 1]
    side = np.clip(0.2 * (1 - Y / 0.4), 0, None)
    mesh = vv.Mesh(np.stack([side + X * (4 - side) / 4, Y], axis=1), grid.cells, face_sets=grid.face_sets)
    return mesh.with_nodes("middle", lambda X: (X[:, 0] < 1e-9) & (X[:, 1] > 0.4 - 1e-9))


def beam(size: float, stand: float, press: float, kind: str = "AT2", split: str = "spectral") -> vv.System:
    """The half with its supports; t is the displacement in mm."""
    mesh = half_beam(size)
    mesh = mesh.with_nodes("stand", lambda X: (X[:, 1] < 1e-9) & (X[:, 0] > 4 - max(stand, 1e-9) - 1e-9))
    mesh = mesh.with_nodes("press", lambda X: (X[:, 1] > 2 - 1e-9) & (X[:, 0] < press + 1e-9))
    solid = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=20.8, poisson=0.3),
        toughness=TOUGHNESS,
        length=LENGTH,
        model=kind,
        split=split,
        name="beam",
    )
    middle = vv.SymmetryPlane(solid=solid, nodes="middle", normal=(1, 0, 0), name="middle")
    held = vv.Fixed(solid=solid, nodes="stand", directions=(False, True, False), name="stand")
    moved = vv.Prescribed(solid=solid, nodes="press", motion=(None, "-t", None), name="press")
    return vv.System([solid, middle, held, moved])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=float, default=0.015)
    parser.add_argument("--stand", type=float, default=0.1)
    parser.add_argument("--press", type=float, default=0.25)
    parser.add_argument("--step", type=float, default=1e-3)
    parser.add_argument("--until", type=float, default=0.06)
    given = parser.parse_args()
    system = beam(given.size, given.stand, given.press)
    solid, began = system.components[0], time.process_time()
    force = vv.SupportForce(solid=solid, nodes="stand")
    print(f"{solid.grid.n_cells} cells, {system.core.n_equations} equations")
    scheme = vv.AlternateMinimization(energy_tolerance=1e-5, newton=5, unstable=True, halvings=2)
    peak, stiffness = (0.0, 0.0), 0.0
    for _ in vv.march(system, until=given.until, step=given.step, scheme=scheme):
        f = 2 * abs(float(np.asarray(force(system))[1]))
        stiffness = stiffness or f / system.time
        peak = max(peak, (f, system.time))
        if f < 0.5 * peak[0]:
            break
    print(
        f"stiffness {stiffness:.4f} kN/mm ({stiffness / STIFFNESS:.3f} of that published), peak {peak[0]:.5f} kN "
        f"({peak[0] / PEAK:.3f}) at {peak[1]:.4f} mm ({peak[1] / AT:.3f}), crack "
        f"{2 * solid.crack_energy(system.x) / TOUGHNESS:.3f} mm, {time.process_time() - began:.0f} s"
    )


if __name__ == "__main__":
    main()
