"""The paper's two flaps in a channel beside NGSolve: alternating rounds, one process and one thread per measurement.

    python benchmarks/valve.py --python ngsolve=PATH [--n 256] [--steps 5] [--step 0.01] [--code visviva]

prints one markdown table of the first steps, in which the flaps open: CPU time of a step as median [least-greatest]
over the rounds, its ratio to ours, and the displacement of the lower tip along the channel at their end. The codes
solve the same case, NGSolve body-fitted, ours immersed; nodes of the velocities are as close to each other in both,
NGSolve's closer at the flaps. PATH is a Python interpreter that has the code; without it this one is tried.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from contenders import Contender, add_options, alternate, cost, part, present, show
from record import Record
from valve_case import ValveCase

OURS = Contender("visviva, immersed, Q1Q1", "ours_valve.py", "visviva", "immersed")
CONTENDERS = (
    OURS,
    Contender("NGSolve, body-fitted, P2P1, tangents kept", "peer_ngsolve_valve.py", "ngsolve", "kept"),
    Contender("NGSolve, body-fitted, P2P1, full Newton", "peer_ngsolve_valve.py", "ngsolve", "anew"),
)
COLUMNS = (
    "code", "equations", "iterations/step", "tangents/step", "CPU s/step", "ratio", "assembly, s/iteration",
    "solution, s/iteration", "peak MB", "tip",
)  # fmt: skip


def row(contender: Contender, records: Sequence[Record], ours: Sequence[Record]) -> list[str]:
    """One line of the table."""
    last = records[-1]
    parts = [part(records, name) for name in ("assembly", "solution")]
    return [
        contender.title,
        str(last.unknowns),
        f"{last.iterations / last.steps:.3g}",
        f"{last.tangents / last.steps:.3g}",
        *cost(records, ours),
        *(f"{seconds:.3g}" if seconds else "" for seconds in parts),
        f"{last.peak_mb:.0f}",
        f"{last.answer:.4f}",
    ]


def main() -> None:
    """Measure and print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_options(options)
    options.add_argument("--n", type=int, default=ValveCase.n, help="spaces between nodes along the channel")
    options.add_argument("--step", type=float, default=ValveCase.step, help="its length")
    chosen = options.parse_args()
    steps = chosen.steps or ValveCase.steps
    extra = [f"--n={chosen.n}", f"--steps={steps}", f"--step={chosen.step}"]
    figures = alternate(present(CONTENDERS, chosen), extra, chosen)
    title, ours = f"n = {chosen.n}, up to t = {steps * chosen.step:.2f}", figures.get(OURS, [])
    show(title, COLUMNS, (row(code, records, ours) for code, records in figures.items()))


if __name__ == "__main__":
    main()
