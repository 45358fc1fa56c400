"""How far the tip of the valve's lower flap depends on the mesh of the fluid and on the step: one table.

    python benchmarks/valve_curves.py [--case 128x32:0.01 ...] [--until 1.0]
    python benchmarks/valve_curves.py --until 0.2 [--sealing 1e4] [--cell quad9] [--first 1e-5]
    python benchmarks/valve_curves.py --case 256x64:0.01 --flaps beam
    python benchmarks/valve_curves.py --unequal [--case 256x64:0.01] [--until 1.5]

Cases are cells along and across, and the step. Displacements of the tip along the channel at three times of the
opening, the largest ones along and across, and the smallest one along after t = 0.5, with that across then. What
decides the opening: --sealing keeps stabilisation away from the flaps, --cell quad9 takes elements that need none, and
--first begins with a short step of backward Euler, which makes the flow what the sudden start asks for. --flaps makes
them of beams, or of the paper's linear elements without enhanced strains.

With --unequal the lower flap is twice as stiff, as in Gil et al. (2010), third example: the curve of the upper tip
beside theirs.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import valve

Array = NDArray[np.float64]

COLUMNS = (
    "cells", "step", "along, t=0.05", "t=0.1", "t=0.2", "largest", "across, largest", "along, smallest",
    "across then", "CPU s"
)  # fmt: skip
CASES = ("64x16:0.01", "128x32:0.01", "256x64:0.01", "128x32:0.02", "128x32:0.005")


START = (1.979, 0.907)
GIL = {
    0.1: (2.444, 1.129), 0.2: (2.569, 1.283), 0.3: (2.585, 1.310), 0.4: (2.576, 1.295), 0.5: (2.555, 1.249),
    0.6: (2.520, 1.177), 0.7: (2.463, 1.104), 0.8: (2.406, 1.055), 0.9: (2.420, 1.068), 1.0: (2.509, 1.167),
    1.25: (2.591, 1.321), 1.5: (2.565, 1.254),
}  # fmt: skip
"""Gil et al. (2010), third example: where the upper, softer tip is, read from their figure, and where it starts."""


def curve(
    counts: tuple[int, int],
    step: float,
    until: float,
    tip: str = "lower_tip",
    first: float = 0.0,
    **options: Any,
) -> tuple[Array, Array, float]:
    """Times (n,), displacements (n, 2) of a tip, and CPU seconds per step."""
    study = valve.study(mesh=counts, until=until, step=step, **options)
    system, probe = study.system, study.probes[tip]
    times, tips, start = [0.0], [np.zeros(2)], time.process_time()
    if first:
        for _ in vv.march(system, until=first, step=first, scheme=vv.BackwardEuler()):
            pass
    for _ in vv.march(system, until=until, step=step):
        times.append(system.time)
        tips.append(np.asarray(probe(system))[:2])  # type: ignore[operator]
    return np.array(times), np.abs(tips), (time.process_time() - start) / (len(times) - 1)


def parsed(case: str) -> tuple[tuple[int, int], float]:
    """Cells along and across, and the step."""
    counts, step = case.split(":")
    along, across = (int(n) for n in counts.split("x"))
    return (along, across), float(step)


def row(case: str, until: float, **options: Any) -> str:
    """One line of the table."""
    counts, step = case.split(":")
    t, tip, cost = curve(*parsed(case), until, **options)
    late = t >= min(0.5, 0.5 * until)
    least = np.flatnonzero(late)[np.argmin(tip[late, 0])]
    at = [np.interp(s, t, tip[:, 0]) for s in (0.05, 0.1, 0.2)]
    values = (*at, tip[:, 0].max(), tip[:, 1].max(), *tip[least])
    return f"| {counts} | {step} | " + " | ".join(f"{v:.4f}" for v in values) + f" | {cost:.2f} |"


def unequal(case: str, until: float) -> None:
    """Print the way of the softer tip beside Gil's."""
    t, tip, cost = curve(*parsed(case), until, "upper_tip", lower_young=2 * 5.6e6)
    theirs = np.abs(np.array([*GIL.values()]) - START)
    print(f"{case}, {cost:.2f} CPU s per step\n| t | along, across | Gil et al. |\n|---|---|---|")
    for at, gil in zip(GIL, theirs, strict=True):
        if at <= until + 1e-9:
            ours = [np.interp(at, t, tip[:, k]) for k in (0, 1)]
            print(f"| {at} | {ours[0]:.3f}, {ours[1]:.3f} | {gil[0]:.3f}, {gil[1]:.3f} |")
    for k, name in enumerate(("along", "across")):
        peak = theirs[np.array([*GIL]) <= until + 1e-9, k].max()
        print(
            f"largest {name} {tip[:, k].max():.3f} at t = {t[tip[:, k].argmax()]:.2f}, Gil et al. {peak:.3f}"
        )


def main() -> None:
    """Run the cases and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", action="append", help="such as 128x32:0.01")
    parser.add_argument("--until", type=float, default=1.0)
    parser.add_argument("--sealing", type=float, default=1.0, help="of the flaps")
    parser.add_argument("--cell", default="quad4", help="of the fluid: quad4 or quad9")
    parser.add_argument("--first", type=float, default=0.0, help="a step of backward Euler to begin with")
    parser.add_argument("--flaps", default="solid", help="of what they are: solid, linear or beam")
    parser.add_argument("--unequal", action="store_true", help="flaps of unequal stiffness, beside Gil's")
    chosen = parser.parse_args()
    if chosen.unequal:
        for case in chosen.case or CASES[1:3]:
            unequal(case, chosen.until)
        return
    print("| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|")
    for case in chosen.case or CASES:
        options = {"sealing": chosen.sealing, "cell": chosen.cell, "first": chosen.first}
        options["flaps"] = chosen.flaps
        print(row(case, chosen.until, **options), flush=True)


if __name__ == "__main__":
    main()
