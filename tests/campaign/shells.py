"""Shells of every type of cells: the linear obstacle course, and tables of Sze, Liu & Lo (2004) up to their full loads.

Prints both with ``python -m campaign.shells`` in ``tests``; all of it takes some ten minutes, the course alone
(``course``) two. Columns of the course are 8, 16 and 32 nodes from node to node along a side, their numbers what is
found by what is published; ``quad4+`` is four-node cells of enhanced membrane. Tables with dents that snap are followed
by their arc length, and compared by the load under which the published deflection is reached.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from verification.shell_cases import (
    CASES,
    bent,
    corner,
    part_of_cylinder,
    pinched_hemisphere,
    sheet,
    symmetric,
)
from verification.shell_tables import HEMISPHERE, OPEN_CYLINDER, open_cylinder

import visviva as vv

Array = NDArray[np.float64]
KINDS = ("quad4", "quad4+", "quad9", "tri3", "tri6")


def course() -> None:
    """Print the obstacle course."""
    for name, (found, options) in CASES.items():
        for kind in KINDS:
            if name == "closed hemisphere" and not kind.startswith("quad"):
                continue
            more = {"membrane": "enhanced"} if kind.endswith("+") else {}
            values = (found(n, kind.strip("+"), **options, **more) for n in (8, 16, 32))
            print(f"{name:35s}{kind:7s}", *(f"{value:8.4f}" for value in values), flush=True)


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

    mesh = bent((2 * np.pi, 4.0), (10 * n, n), to, kind)
    shell = vv.Shell(mesh=mesh, section=sheet(0.03, 21e6), slits="open")
    load = vv.Traction(solid=shell, faces="x0", traction=(0, 0, 0.8), times="t")
    system = vv.System([shell, vv.Clamped(solid=shell, nodes="x1"), load])
    ends = [corner(shell, "x0", "y0"), corner(shell, "x0", "y1")]
    table = {0.2: (6.725, 9.160), 0.6: (11.257, 14.674), 1.0: (13.891, 17.528)}
    for share in path(system, list(table), 0.1):
        found = shell.displacements(system.x)[ends, 2]
        show(f"slit annular plate, {n} x {10 * n} {kind}, at {share} of the load", found, table[share])


def hemisphere(n: int, kind: str) -> None:
    """3.4."""
    shell, others, ends = pinched_hemisphere(n, kind, 200.0)
    system = vv.System([shell, *others])
    for share in path(system, list(HEMISPHERE), 0.05):
        u = shell.displacements(system.x)
        found = u[ends[0], 0], -u[ends[1], 1]
        show(f"hemisphere, {n} x {n} {kind}, at {share} of the load", found, HEMISPHERE[share])


def pulled_cylinder(counts: tuple[int, int], kind: str) -> None:
    """3.5, with its snap at half the load by the path's length."""
    system, found = open_cylinder(counts, kind)
    for share in path(system, [share for share in OPEN_CYLINDER if share < 0.5], 0.05):
        show(f"open cylinder, {counts} {kind}, at {share} of the load", found(system.x), OPEN_CYLINDER[share])
    vv.arc_length(system, step=0.01, until=0.53)
    for share in path(system, [share for share in OPEN_CYLINDER if share > 0.53], 0.05):
        show(f"open cylinder, {counts} {kind}, at {share} of the load", found(system.x), OPEN_CYLINDER[share])


def reached(rows: Sequence[tuple[float, ...]], deflection: float) -> Array:
    """What is found, the load first, where the deflection, the second, is first reached on the path."""
    path = np.array(rows)
    k = int(np.flatnonzero((path[:-1, 1] <= deflection) & (path[1:, 1] > deflection))[0])
    share = (deflection - path[k, 1]) / (path[k + 1, 1] - path[k, 1])
    return np.asarray((1 - share) * path[k] + share * path[k + 1])


def follow(
    system: vv.System, row: Callable[[vv.System], tuple[float, ...]], step: float
) -> list[tuple[float, ...]]:
    """The path by its length to the full load."""
    rows = [row(system)]

    def stop(system: vv.System) -> bool:
        rows.append(row(system))
        return False

    vv.arc_length(system, step=step, until=1.0, steps=2000, scheme=vv.ArcLength(longest=1.5), stop=stop)
    return rows


def pinched_tube(n: int, kind: str) -> None:
    """3.6: the load, and the way of the point a quarter around, by that of the load."""
    shell = vv.Shell(mesh=part_of_cylinder(100.0, 100.0, np.pi / 2, n, kind), section=sheet(1.0, 30e3, 0.3))
    held = vv.Fixed(solid=shell, nodes="x0", directions=(True, False, True))
    top, side = corner(shell, "x1", "y0"), corner(shell, "x1", "y1")
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, -3000.0), times="t")
    system = vv.System([shell, held, *symmetric(shell, y="x1", x="y0", z="y1"), load])

    def row(system: vv.System) -> tuple[float, ...]:
        u = shell.displacements(system.x)
        return system.time, -u[top, 2], u[side, 0]

    rows = follow(system, row, 0.01)
    for share, (way, aside) in TUBE.items():
        found = reached(rows, way)
        show(f"pinched cylinder, {n} x {n} {kind}, at {way}", [found[0], found[2]], [share, aside])


TUBE = {
    0.05: (9.561, -0.233), 0.1: (23.164, -2.391), 0.15: (36.208, -2.154), 0.175: (51.499, 6.792), 0.2: (56.373, 10.448),
    0.25: (61.877, 14.905), 0.35: (68.229, 20.365), 0.5: (73.79, 25.381), 0.75: (79.339, 30.604), 1.0: (83.102, 34.272),
}  # fmt: skip
"""Share of the load: deflection under it, and a quarter around."""
PLY = {"thickness": 1.0, "young": 2068.5, "across": 517.125, "poisson": 0.3, "shear": 795.6}
HALF = {
    (): {0.1: 16.1, 0.2: 37.582, 0.3: 66.41, 0.35: 94.669, 0.5: 132.653, 0.75: 156.584, 1.0: 171.505},
    (0, 90, 0): {
        0.1: 37.92,
        0.15: 93.433,
        0.2: 141.562,
        0.3: 162.896,
        0.5: 180.68,
        0.75: 192.52,
        1.0: 200.983,
    },
    (90, 0, 90): {0.1: 22.722, 0.2: 54.455, 0.3: 102.357, 0.5: 138.74, 0.75: 161.854, 1.0: 178.386},
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
    rows = follow(system, lambda s: (s.time, -shell.displacements(s.x)[top, 2]), 0.02)
    for share, way in HALF[angles].items():
        show(f"half cylinder {angles or ''}, {n} x {n} {kind}, at {way}", [reached(rows, way)[0]], [share])


def show(name: str, found: Any, expected: Sequence[float]) -> None:
    pairs = "   ".join(f"{a:8.3f} ({b:7.3f})" for a, b in zip(found, expected, strict=True))
    print(f"{name:60s} {pairs}", flush=True)


def main(arguments: Sequence[str] = ()) -> int:
    """Print what is asked for: all, or the course alone."""
    course()
    if "course" in arguments:
        return 0
    for n, kind in ((6, "quad9"), (8, "quad9"), (10, "quad4")):
        slit_plate(n, kind)
    for n, kind in ((16, "quad9"), (32, "quad9"), (32, "quad4"), (32, "tri6")):
        hemisphere(n, kind)
    for counts, kind in (((16, 24), "quad9"), ((24, 36), "quad9"), ((24, 36), "quad4"), ((24, 36), "tri6")):
        pulled_cylinder(counts, kind)
    for angles in HALF:
        pinched_half(32, "quad4", angles)
    pinched_tube(40, "quad4")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
