"""An immersed elastic flag against published values, FSI1 of Turek & Hron (2006): what docs/theory/immersed.rst says.

    python benchmarks/immersed_accuracy.py [--fine 6] [--along 40] [--step 0.2] [--until 14]

The fluid's mesh has a hole for the cylinder; the flag behind it is immersed, on a mesh of its own. Backward Euler from
rest. References are those of body-fitted meshes.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples.cylinder import CENTRE, HEIGHT, RADIUS
from visviva.mesh.grid import assembled

Array = NDArray[np.float64]

LENGTH, BOX, END, THICK, CLEAR = 2.5, 0.4, 0.6, 0.02, 1.0001
LAST = 4.0
"""The last part of the time, about one swing of the flag."""
PUBLISHED = {"u_x": 2.270493e-5, "u_y": 8.208773e-4, "drag": 14.29426, "lift": 0.763746}
"""FeatFlow's level 7."""


def graded(t: Array) -> Array:
    """From 0 to the height of the channel, closer about the flag."""
    s, middle = np.asarray(2 * t - 1), CENTRE[1]
    return np.asarray(middle + np.where(s < 0, middle, HEIGHT - middle) * np.sinh(3.0 * s) / np.sinh(3.0))


def channel(fine: int) -> vv.Mesh:
    """A channel with a hole: four fans about the cylinder, rows along the flag and rows that lengthen downstream."""
    edges = (
        lambda t: np.column_stack([0 * t + BOX, graded(t)]),
        lambda t: np.column_stack([BOX * (1 - t), 0 * t + HEIGHT]),
        lambda t: np.column_stack([0 * t, HEIGHT * (1 - t)]),
        lambda t: np.column_stack([BOX * t, 0 * t]),
    )

    def fan(k: int, places: Array) -> Array:
        out, turn = places[:, :1], places[:, 1]
        edge, angle = edges[k](turn), (k - 0.5 + turn) * np.pi / 2
        arc = CENTRE + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
        return np.asarray(arc + np.expm1(1.5 * out) / np.expm1(1.5) * (edge - arc))

    def rows(places: Array, first: float, last: float, growth: float) -> Array:
        x = first + (last - first) * np.expm1(growth * places[:, 0]) / np.expm1(growth)
        return np.column_stack([x, graded(places[:, 1])])

    n, past = 2 * fine, END + 0.1
    fans = [
        ((n, n), lambda p, k=k: fan(k, p), (("cylinder", name), (None, None)))
        for k, name in enumerate((None, "y1", "x0", "y0"))
    ]
    beside = ((n, n), lambda p: rows(p, BOX, past, 1e-6), ((None, None), ("y0", "y1")))
    after = ((n, n), lambda p: rows(p, past, LENGTH, 2.5), ((None, "x1"), ("y0", "y1")))
    return assembled([*fans, beside, after], "quad9", 1e-9)


def flag_mesh(n: int, m: int) -> vv.Mesh:
    """The flag from the cylinder's arc (a hair outside of it) to its end."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(n, m), cell="quad9").build()
    y = CENTRE[1] + THICK * (flat.points[:, 1] - 0.5)
    left = CENTRE[0] + np.sqrt((CLEAR * RADIUS) ** 2 - (y - CENTRE[1]) ** 2)
    return vv.Mesh(
        np.column_stack([left + flat.points[:, 0] * (END - left), y]), flat.cells, face_sets=flat.face_sets
    )


def inflow(t: float, X: Array) -> Array:
    return np.outer(min(t, 1.0) * 0.2 * 6 * X[:, 1] * (HEIGHT - X[:, 1]) / HEIGHT**2, (1.0, 0.0, 0.0))


def flag(fine: int, along: int, step: float, until: float) -> None:
    """Print the end's displacement and the forces on cylinder and flag, at the end and their range before it."""
    water = vv.Fluid(mesh=channel(fine), density=1000.0, viscosity=1.0)
    solid = vv.Solid(
        mesh=flag_mesh(along, max(2, fine // 3)),
        material=vv.SaintVenantKirchhoff(shear=0.5e6, poisson=0.4),
        density=1000.0,
    )
    wet = vv.Immersed(solid=solid, fluid=water)
    parts = [
        water,
        vv.VelocityBoundary(fluid=water, faces="x0", velocity=inflow),
        *(vv.NoSlip(fluid=water, faces=side) for side in ("y0", "y1", "cylinder")),
        vv.Outlet(fluid=water, faces="x1"),
        solid,
        vv.Fixed(solid=solid, nodes="x0"),
        wet,
    ]
    system, start = vv.System(parts, vv.Newton(tolerance=1e-9)), time.process_time()
    end = int(np.argmin(np.linalg.norm(solid.points[:, :2] - (END, CENTRE[1]), axis=1)))
    rows: list[Array] = []
    for _ in vv.march(system, until=until, step=step, scheme=vv.BackwardEuler()):
        held = vv.FlowForce(fluid=water, faces="cylinder")(system)
        force = held + wet.forces(system.x).sum(axis=0)
        rows.append(np.hstack([solid.displacements(system.x)[end, :2], force[:2]]))
    print(f"fine = {fine}: {system.core.n_equations} equations, {time.process_time() - start:.0f} CPU s")
    last = np.array(rows[-round(LAST / step) :])
    for (name, reference), values in zip(PUBLISHED.items(), last.T, strict=True):
        print(
            f"  {name:5s} {values[-1]:12.5g} (from {values.min():.5g} to {values.max():.5g}), "
            f"body-fitted {reference:12.5g}: {100 * (values[-1] / reference - 1):+.1f} %"
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fine", type=int, default=6)
    parser.add_argument("--along", type=int, default=40, help="cells along the flag")
    parser.add_argument("--step", type=float, default=0.2)
    parser.add_argument("--until", type=float, default=14.0)
    given = parser.parse_args()
    flag(given.fine, given.along, given.step, given.until)


if __name__ == "__main__":
    main()
