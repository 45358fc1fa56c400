"""Shells of every type of cells: the linear obstacle course, and tables of Sze, Liu & Lo (2004) up to their full loads.

Prints both with ``python -m campaign.shells`` in ``tests``; all of it takes some ten minutes, the course alone
(``course``) one. Columns of the course are 8, 16 and 32 nodes from node to node along a side, their numbers what is
found by what is published. Load steps end where they find no equilibrium.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from verification.shell_cases import CASES, bent, corner, part_of_cylinder, sheet, symmetric

import visviva as vv

Array = NDArray[np.float64]
KINDS = ("quad4", "quad9", "tri3", "tri6")


def course() -> None:
    """Print the obstacle course."""
    for name, (found, options) in CASES.items():
        for kind in KINDS:
            print(
                f"{name:33s}{kind:6s}",
                *(f"{found(n, kind, **options):8.4f}" for n in (8, 16, 32)),
                flush=True,
            )


def path(system: vv.System, shares: Sequence[float], step: float) -> Iterator[float]:
    """Follow a load to shares of it."""
    for share in shares:
        try:
            vv.quasi_static(system, until=share, step=step)
        except vv.NoEquilibrium:
            print(f"    no equilibrium is found beyond {system.time:.3f} of the load")
            return
        yield share


def slit_plate(n: int, kind: str) -> None:
    """3.3."""

    def to(a: Array, r: Array) -> Array:
        return np.stack([(6 + r) * np.sin(a), (6 + r) * np.cos(a), 0 * a], axis=1)

    shell = vv.Shell(mesh=bent((2 * np.pi, 4.0), (10 * n, n), to, kind), section=sheet(0.03, 21e6))
    load = vv.Traction(solid=shell, faces="x0", traction=(0, 0, 0.8), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x1"), load])
    ends = [corner(shell, "x0", "y0"), corner(shell, "x0", "y1")]
    table = {0.2: (6.725, 9.160), 0.6: (11.257, 14.674), 1.0: (13.891, 17.528)}
    for share in path(system, list(table), 0.1):
        show(
            f"slit annular plate, {n} x {10 * n} {kind}",
            share,
            shell.displacements(system.x)[ends, 2],
            table[share],
        )


def pinched_tube(n: int, kind: str) -> None:
    """3.6: the way of the load, and of the point a quarter around."""
    shell = vv.Shell(mesh=part_of_cylinder(100.0, 100.0, np.pi / 2, n, kind), section=sheet(1.0, 30e3, 0.3))
    held = vv.Fixed(solid=shell, nodes="x0", directions=(True, False, True))
    top, side = corner(shell, "x1", "y0"), corner(shell, "x1", "y1")
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -3000.0), times="t")
    system = vv.System([shell, held, *symmetric(shell, y="x1", x="y0", z="y1"), load])
    table = {0.1: (23.164, -2.391), 0.25: (61.877, 14.905), 0.5: (73.79, 25.381), 1.0: (83.102, 34.272)}
    for share in path(system, list(table), 0.025):
        u = shell.displacements(system.x)
        show(f"pinched cylinder, {n} x {n} {kind}", share, [-u[top, 2], u[side, 0]], table[share])


PLY = {"thickness": 1.0, "young": 2068.5, "across": 517.125, "poisson": 0.3, "shear": 795.6}
HALF = {
    (): {0.1: 16.1, 0.3: 66.41, 0.5: 132.653, 1.0: 171.505},
    (0, 90, 0): {0.1: 37.92, 0.3: 162.896, 0.5: 180.68, 1.0: 200.983},
    (90, 0, 90): {0.1: 22.722, 0.3: 102.357, 0.5: 138.74, 1.0: 178.386},
}


def pinched_half(n: int, kind: str, angles: tuple[float, ...]) -> None:
    """3.7, one material or plies."""
    plies = tuple(vv.Ply(angle=angle, **PLY) for angle in angles)
    section: Any = vv.Laminate(plies=plies) if plies else sheet(3.0, 2068.5, 0.3)
    mesh = part_of_cylinder(101.6, 304.8, np.pi / 2, n, kind)
    shell = vv.Shell(mesh=mesh, section=section, first=(0, 1, 0))
    sides = [
        vv.SymmetryPlane(solid=shell, nodes=np.setdiff1d(shell.nodes(edge), shell.nodes("x0")), normal=normal)
        for edge, normal in (("y0", (1, 0, 0)), ("y1", (0, 0, 1)))
    ]
    top = corner(shell, "x1", "y0")
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -1000.0), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x0"), *sides, load])
    table = HALF[angles]
    for share in path(system, list(table), 0.025):
        found = -shell.displacements(system.x)[top, 2]
        show(f"half cylinder {angles or ''}, {n} x {n} {kind}", share, [found], (table[share],))


def show(name: str, share: float, found: Any, expected: Sequence[float]) -> None:
    pairs = "   ".join(f"{a:8.3f} ({b:7.3f})" for a, b in zip(found, expected, strict=True))
    print(f"{name:44s} at {share:5.3f} of the load: {pairs}", flush=True)


def main(arguments: Sequence[str] = ()) -> int:
    """Print what is asked for: all, or the course alone."""
    warnings.filterwarnings("ignore", message=".*do not meet")
    course()
    if "course" in arguments:
        return 0
    for n, kind in ((6, "quad9"), (8, "quad9"), (10, "quad4")):
        slit_plate(n, kind)
    for angles in HALF:
        pinched_half(24, "quad4", angles)
        pinched_half(24, "quad9", angles)
    for kind in ("quad4", "quad9"):
        pinched_tube(32, kind)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
