"""How far the tip of the valve's lower flap depends on the mesh of the fluid and on the step: one table.

    python benchmarks/valve_curves.py [--case 128x32:0.01 ...] [--until 1.0]

Cases are cells along and across, and the step. Displacements of the tip along the channel at two times of the opening,
the largest ones along and across, and the smallest one along after t = 0.5, with that across at the same time.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import valve

Array = NDArray[np.float64]

COLUMNS = (
    "cells", "step", "along, t=0.1", "t=0.2", "largest", "across, largest", "along, smallest", "across then", "CPU s"
)  # fmt: skip
CASES = ("64x16:0.01", "128x32:0.01", "256x64:0.01", "128x32:0.02", "128x32:0.005")


def curve(counts: tuple[int, int], step: float, until: float) -> tuple[Array, Array, float]:
    """Times (n,), displacements (n, 2) of the lower tip, and CPU seconds per step."""
    study = valve.study(mesh=counts, until=until, step=step)
    system, probe = study.system, study.probes["lower_tip"]
    times, tips, start = [0.0], [np.zeros(2)], time.process_time()
    for _ in vv.march(system, until=until, step=step):
        times.append(system.time)
        tips.append(np.asarray(probe(system))[:2])  # type: ignore[operator]
    return np.array(times), np.abs(tips), (time.process_time() - start) / (len(times) - 1)


def row(case: str, until: float) -> str:
    """One line of the table."""
    counts, step = case.split(":")
    along, across = (int(n) for n in counts.split("x"))
    t, tip, cost = curve((along, across), float(step), until)
    late = t >= min(0.5, 0.5 * until)
    least = np.flatnonzero(late)[np.argmin(tip[late, 0])]
    at = [np.interp(s, t, tip[:, 0]) for s in (0.1, 0.2)]
    values = (*at, tip[:, 0].max(), tip[:, 1].max(), *tip[least])
    return f"| {counts} | {step} | " + " | ".join(f"{v:.4f}" for v in values) + f" | {cost:.2f} |"


def main() -> None:
    """Run the cases and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", action="append", help="such as 128x32:0.01")
    parser.add_argument("--until", type=float, default=1.0)
    chosen = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|")
    for case in chosen.case or CASES:
        print(row(case, chosen.until), flush=True)


if __name__ == "__main__":
    main()
