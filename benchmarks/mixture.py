"""A mixture that separates, beside DOLFINx: alternating rounds, one process and one thread per measurement.

    python benchmarks/mixture.py --python dolfinx=PATH [--n 96 200]

prints a markdown table for each mesh of n x n squares of two triangles: CPU time of a step as median [least-greatest]
over the rounds and its ratio to ours, and the deviation of the concentrations after the last step: both solve the same
discrete problem. PATH is a Python interpreter that has DOLFINx.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from contenders import Contender, add_options, alternate, cost, part, present, show
from record import Record

OURS = Contender("visviva", "ours_mixture.py", "visviva", "own")
CONTENDERS = (OURS, Contender("DOLFINx, MUMPS", "peer_dolfinx_mixture.py", "dolfinx", "MUMPS"))
COLUMNS = ("code", "iterations/step", "CPU s/step", "ratio", "assembly, ms", "peak MB", "deviation")


def row(contender: Contender, records: Sequence[Record], ours: Sequence[Record]) -> list[str]:
    """One line of the table."""
    last = records[-1]
    return [
        contender.title,
        f"{last.iterations / last.steps:.3g}",
        *cost(records, ours),
        f"{1e3 * part(records, 'assembly'):.3g}",
        f"{last.peak_mb:.0f}",
        f"{last.answer:.10f}",
    ]


def main() -> None:
    """Measure and print the tables."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_options(options)
    options.add_argument("--n", type=int, nargs="+", default=[96, 200], help="squares along a side")
    chosen = options.parse_args()
    codes = present(CONTENDERS, chosen)
    for n in chosen.n:
        extra = [f"--n={n}", *([f"--steps={chosen.steps}"] if chosen.steps else [])]
        figures = alternate(codes, extra, chosen)
        rows = (row(code, records, figures.get(OURS, [])) for code, records in figures.items())
        show(f"{n} x {n} squares", COLUMNS, rows)


if __name__ == "__main__":
    main()
