"""Flows against published values on several meshes: the tables of docs/theory/flow.rst.

    python benchmarks/flow_accuracy.py [street | cavity | duct] [--fine 8] [--step 0.005]

`street` is benchmark 2D-2 of Schaefer & Turek: the coarse mesh runs up to a regular street, on which the wanted one
goes on. `cavity` compares the lid-driven cavity on both centre lines.
`duct` is the steady benchmark 3D-1Z, by GMRES from `--fine 3` on.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import cavity, cylinder

Array = NDArray[np.float64]

COARSE, REGULAR, PERIODS = 5, 5.0, 2.4
"""Mesh and time that a regular street takes, and for how long the finer one goes on."""


def street(fine: int, step: float) -> None:
    """Print the extremes of the last period."""
    study = cylinder.study("2D-2", fine=COARSE, until=REGULAR, step=0.01)
    followed(study)
    finer = cylinder.study("2D-2", fine=fine, until=PERIODS, step=step, velocity=velocities(study.system))
    found = cylinder.street(followed(finer))
    print(f"fine = {fine}, h = {step}: {finer.system.n_coordinates} velocities")
    for name, value, reference in zip(found._fields, found, cylinder.STREET, strict=True):
        print(
            f"  {name:15s} {value:9.5f}  reference {reference:9.5f}  {100 * (value / reference - 1):+.2f} %"
        )


def followed(study: vv.Study) -> Array:
    """Rows (n, 4) of time, coefficients and difference of pressures of a whole run."""
    steps = vv.march(study.system, until=study.until, step=study.step, scheme=study.scheme)
    return np.array([(study.system.time, *cylinder.coefficients(study.system)) for _ in steps])


def velocities(system: vv.System) -> object:
    """The present velocities as a function of positions; places between chord and arc of the cylinder move out."""
    (water,) = (c for c in system.components if isinstance(c, vv.Fluid))
    x = system.x.copy()

    def at(X: Array) -> Array:
        arm = X[:, :2] - cylinder.CENTRE
        distance = np.linalg.norm(arm, axis=1, keepdims=True)
        outside = 1.004 * cylinder.RADIUS
        near = cylinder.CENTRE + arm * (outside / distance)
        v = water.at(np.where(distance < outside, near, X[:, :2])).velocities(x)
        return np.where(distance < 1.0001 * cylinder.RADIUS, 0.0, v)

    return at


def cavities() -> None:
    """Print the largest distances from the reference on both centre lines, in percent of the lid's speed."""
    for reynolds, count, elements in (
        (100, 12, "Q2Q1"),
        (400, 20, "P2P1"),
        (1000, 24, "Q2Q1"),
        (100, 32, "Q1Q1"),
    ):
        study = cavity.study(reynolds, count, elements)
        result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
        off = 100 * np.abs(cavity.deviations(result)).max(axis=1)
        print(f"Re {reynolds}, {count} x {count} {elements}: u {off[0]:.2f} %, v {off[1]:.2f} %")


def duct(fine: int) -> None:
    """Print the coefficients in space, and the CPU time."""
    study, start = cylinder.study("3D-1Z", fine=fine), time.process_time()
    study.system.newton = vv.Newton(tolerance=1e-6, keep_factor=0.0)
    drag, lift, difference = followed(study)[-1, 1:]
    seconds = time.process_time() - start
    print(
        f"fine = {fine}: {study.system.core.n_equations} equations, drag {drag:.5f} (6.18533), lift {lift:.6f} "
        f"(0.009401), difference of pressures {difference:.4f} (0.165 to 0.175), {seconds:.1f} CPU s\n"
        f"{study.system.linear_explanation}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", nargs="?", choices=("street", "cavity", "duct"), default="street")
    parser.add_argument("--fine", type=int, default=8)
    parser.add_argument("--step", type=float, default=0.005)
    given = parser.parse_args()
    if given.what == "street":
        street(given.fine, given.step)
    elif given.what == "duct":
        duct(given.fine)
    else:
        cavities()


if __name__ == "__main__":
    main()
