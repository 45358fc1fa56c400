"""How well immersed solids keep their area, and what mends it: what docs/theory/immersed.rst says.

    python benchmarks/immersed_volume.py [disc half_cylinder] [--until 3.0]

The fluid keeps the volume of a solid whatever its material does, so that Poisson's ratio only decides how strongly the
solid resists what the interpolation loses. disc: a soft disc in a driven cavity (the case of the tests). half_cylinder:
the case of immersed_accuracy.py on linear cells, where most is lost.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any, Literal

import half_cylinder
import numpy as np

import visviva as vv

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from discs import disc

MESHES: tuple[tuple[int, Literal["quad4", "quad9"]], ...] = ((16, "quad9"), (32, "quad4"))
STEP = 0.04
RATIOS: dict[float, dict[str, Any]] = {0.45: {}, 0.49: {}, 0.499: {"formulation": "F-bar"}}
"""Poisson's ratios of the disc, and what they ask of its elements."""


def cavity(cells: int, kind: str, until: float, poisson: float, **options: Any) -> tuple[float, float]:
    """Largest change of the disc's area on its way as a part of it, and the smallest x of its centre."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(cells, cells), cell=kind)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.01)
    rubber = vv.NeoHooke(shear=0.1, poisson=poisson)
    solid = vv.Solid(mesh=disc(0.2, (0.6, 0.5), 6), material=rubber, density=1.0, **options)
    walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("x0", "x1", "y0")]
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=(1.0, 0.0, 0.0))
    system = vv.System(
        [fluid, lid, *walls, solid, vv.Immersed(solid=solid, fluid=fluid)], vv.Newton(tolerance=1e-9)
    )
    changes, path = [], []
    for _ in vv.march(system, until=until, step=STEP):
        changes.append(solid.volume(system.x) / solid.grid.volume - 1)
        path.append((solid.nodal_mass @ solid.positions(system.x)[:, 0]) / solid.mass)
    return changes[int(np.argmax(np.abs(changes)))], float(min(path))


def discs(until: float) -> None:
    """A row per mesh and remedy."""
    for cells, kind in MESHES:
        for poisson, options in RATIOS.items():
            begin = time.process_time()
            change, left = cavity(cells, kind, until, poisson, **options)
            print(
                f"disc, {cells} x {cells} {kind}, Poisson's ratio {poisson}: area changes by {100 * change:+.3f} % "
                f"at most, smallest x {left:.4f}, {time.process_time() - begin:.1f} CPU s",
                flush=True,
            )


def half() -> None:
    """The half cylinder on linear cells."""
    for law in (vv.SaintVenantKirchhoff, vv.NeoHooke):
        for poisson in (half_cylinder.POISSON, 0.49, 0.499):
            u, area = half_cylinder.bend(16, law(shear=half_cylinder.SHEAR, poisson=poisson), "quad4")
            print(
                f"half cylinder, {law.__name__}, 16 quad4 per unit, Poisson's ratio {poisson:.4g}: area {area:.4f}, "
                f"top moves by {u[0]:.4f}, {u[1]:.4f}",
                flush=True,
            )


def main() -> None:
    """Run the cases and print what comes out."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", default=["disc", "half_cylinder"], help="disc, half_cylinder")
    parser.add_argument("--until", type=float, default=3.0, help="of the disc")
    chosen = parser.parse_args()
    for name in chosen.cases:
        discs(chosen.until) if name == "disc" else half()


if __name__ == "__main__":
    main()
