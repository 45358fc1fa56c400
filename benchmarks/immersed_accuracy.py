"""Immersed elastic solids against published values of body-fitted meshes: what docs/theory/immersed.rst says.

    python benchmarks/immersed_accuracy.py [CASE ...]

Cases: fsi1 fsi2 fsi2_short_steps fsi2_fine fsi2_finer crowded volume half_cylinder.

fsi1: the flag of Turek & Hron (2006) at rest, on finer and finer meshes. fsi2: the heavier one, from rest until its
swing no longer grows; a line per second, and in the end the distance to the published one. crowded: the first with
more and more nodes of the solid. volume: body-fitted, what a solid that keeps its volume changes. half_cylinder: Liu
et al. (2014).
"""

from __future__ import annotations

import argparse
import time
import warnings

import flag_fitted
import half_cylinder
import numpy as np
from flag_case import FREQUENCY, FSI2, PUBLISHED, SWINGS, Flag, Rows, channel
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

MESHES = ((Rows(12, 2), (14, 1)), (Rows(12, 4), (14, 2)), (Rows(24, 8, 4), (28, 4)))
"""Of channel and flag, from coarse to fine: the flag's nodes are farther apart than those of the velocity."""
LAST = 2.0


def fsi1() -> None:
    for rows, cells in MESHES:
        begin, case = time.process_time(), Flag(channel(rows), cells)
        states = case.march(14.0, 0.2)
        last = states[states[:, 0] > 14.0 - LAST, 1:]
        print(
            f"fsi1, {rows.across} cells over the flag, {cells[0]} x {cells[1]} in it: {case.system.core.n_equations} "
            f"equations, {time.process_time() - begin:.0f} CPU s"
        )
        for (name, reference), values in zip(PUBLISHED.items(), last.T, strict=True):
            off, moves = values[-1] / reference - 1, np.ptp(values) / abs(values[-1])
            print(
                f"  {name:5s} {values[-1]:12.5g}, body-fitted {reference:12.5g}: {100 * off:+.1f} %; "
                f"moves by {100 * moves:.1e} % in the last {LAST:g} s",
                flush=True,
            )


def fsi2(until: float = 18.5, step: float = 0.02, across: int = 2) -> None:
    """BDF2, cells `across` the flag: how far its end and the forces swing, second by second and in the end."""
    begin, case, rows = time.process_time(), Flag(channel(Rows(12, across)), (14, across // 2), FSI2), []
    print(f"fsi2: {case.system.core.n_equations} equations")
    for second in np.arange(1, np.ceil(until) + 1):
        rows += case.march(min(second, until), step, vv.BDF2()).tolist()
        parts = ", ".join(
            f"{name} {m:.4g} +- {s:.4g}"
            for name, (m, s) in zip(SWINGS, swing(np.array(rows), 1.0), strict=True)
        )
        spent = f"{len(rows)} steps, {case.system.stepper.rejected} retried, {time.process_time() - begin:.0f} CPU s"
        print(f"  t = {case.system.time:.4g}: {parts}; {spent}", flush=True)
    compare_swings(np.array(rows))


def swing(rows: Array, last: float) -> list[tuple[float, float]]:
    """Mean of the extremes and amplitude of the columns after time in the last seconds."""
    states = rows[rows[:, 0] > rows[-1, 0] - last, 1:]
    return [((c.max() + c.min()) / 2, np.ptp(c) / 2) for c in states.T]


def compare_swings(rows: Array) -> None:
    """The last two seconds beside the published swing."""
    for (name, published), found in zip(SWINGS.items(), swing(rows, LAST), strict=True):
        print(
            f"  {name:5s} {found[0]:.4g} +- {found[1]:.4g}, body-fitted {published[0]:.4g} +- {published[1]:.4g}: "
            f"amplitude {100 * (found[1] / published[1] - 1):+.1f} %"
        )
    t, u = rows[rows[:, 0] > rows[-1, 0] - LAST][:, [0, 2]].T
    u = u - u.mean()
    up = np.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    through = t[up] - u[up] * (t[up + 1] - t[up]) / (u[up + 1] - u[up])
    often = (len(through) - 1) / (through[-1] - through[0])
    print(f"  frequency {often:.3f} Hz, body-fitted {FREQUENCY}: {100 * (often / FREQUENCY - 1):+.1f} %")


def crowded() -> None:
    rows = Rows(12, 4)
    for cells in ((14, 2), (28, 2), (40, 2)):
        case = Flag(channel(rows), cells)
        places, unseen, least = case.unseen()
        states = case.march(14.0, 0.2)
        print(
            f"crowded, {cells[0]} x {cells[1]} cells in the flag: {places} nodes, {unseen} patterns unseen (least "
            f"{least:.1e}); u_y {states[-1, 2]:.4g}, moves by "
            f"{100 * np.ptp(states[states[:, 0] > 12, 2]) / abs(states[-1, 2]):.1e} % in the last 2 s, "
            f"{case.system.stepper.rejected} steps retried"
        )
    case = Flag(channel(rows), (14, 2))
    case.march(14.0, 0.2)
    for step in (1.0, 4.0, 20.0):
        states = case.march(case.system.time + 10 * step, step)
        print(
            f"crowded, 14 x 2: steps of {step:g} s: u_y from {states[:, 2].min():.5g} to {states[:, 2].max():.5g}"
        )


def volume() -> None:
    for poisson, (alone, both) in flag_fitted.together(Rows(16, 4), (0.4, 0.4999)).items():
        print(
            f"volume, body-fitted, Poisson's ratio {poisson:g}: u_x {alone[0]:.4g}, u_y {alone[1]:.4g} under the load "
            f"of the straight flag; in balance u_x {both[0]:.4g}, u_y {both[1]:.4g}, drag {both[2]:.4g}, "
            f"lift {both[3]:.4g}",
            flush=True,
        )


def half() -> None:
    for name, fitted in half_cylinder.FITTED.items():
        material = half_cylinder.MATERIALS[name]
        for per_unit in (8, 16, 24, 32):
            u, area = half_cylinder.bend(per_unit, material())
            print(
                f"half cylinder, {name}, {per_unit} quad9 per unit: top moves by {u[0]:.4f}, {u[1]:.4f} (body-fitted "
                f"{fitted}: {100 * (u[0] / fitted - 1):+.1f} %), area {area:.4f}",
                flush=True,
            )
        u, area = half_cylinder.bend(16, material(), "quad4")
        print(
            f"half cylinder, {name}, 16 quad4 per unit: {u[0]:.4f}, {u[1]:.4f}, area {area:.4f}", flush=True
        )


def short() -> None:
    fsi2(16.0, 0.01)


def fine() -> None:
    fsi2(17.0, 0.01, 4)


def finer() -> None:
    fsi2(12.0, 0.01, 8)


CASES = {
    "fsi1": fsi1,
    "fsi2": fsi2,
    "fsi2_short_steps": short,
    "fsi2_fine": fine,
    "fsi2_finer": finer,
    "crowded": crowded,
    "volume": volume,
    "half_cylinder": half,
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", default=[*CASES], help=", ".join(CASES))
    warnings.simplefilter("ignore")
    for name in parser.parse_args().cases:
        CASES[name]()


if __name__ == "__main__":
    main()
