"""Flow in a channel beside DOLFINx, Kratos and NGSolve: alternating rounds, one process and one thread per measurement.

    python benchmarks/flow.py --python dolfinx=PATH --python kratos=PATH --python ngsolve=PATH

prints one markdown table: CPU time of a step as median [least-greatest] over the rounds and its ratio to ours with
the same kind of elements, and the velocity in the middle of the channel: with elements of Taylor and Hood all solve
the same discrete problem. PATH is a Python interpreter that has the code; without it this one is tried, and a code
that is missing is left out with a word.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from contenders import Contender, add_options, alternate, cost, part, present, show
from flow_case import FlowCase
from record import Record

OURS = {
    kind: Contender(f"visviva, {kind}", "ours_flow.py", "visviva", kind, (kind,)) for kind in ("Q2Q1", "Q1Q1")
}
CONTENDERS = (
    *OURS.values(),
    Contender("DOLFINx, Q2Q1, MUMPS", "peer_dolfinx_flow.py", "dolfinx", "Q2Q1", ("Q2Q1",)),
    Contender("NGSolve, Q2Q1, PARDISO", "peer_ngsolve_flow.py", "ngsolve", "PARDISO", ("Q2Q1",)),
    Contender("Kratos, Q1Q1, AMGCL", "peer_kratos_flow.py", "KratosMultiphysics", "AMGCL", ("Q1Q1",)),
)
COLUMNS = ("code", "iterations/step", "CPU s/step", "ratio", "assembly, µs/cell", "peak MB", "velocity")


def row(contender: Contender, records: Sequence[Record], ours: Sequence[Record], cells: int) -> list[str]:
    """One line of the table."""
    last, assembly = records[-1], part(records, "assembly")
    return [
        contender.title,
        f"{last.iterations / last.steps:.3g}",
        *cost(records, ours),
        f"{1e6 * assembly / cells:.3g}" if assembly else "",
        f"{last.peak_mb:.0f}",
        f"{last.answer:.8f}",
    ]


def main() -> None:
    """Measure and print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_options(options)
    options.add_argument("--n", type=int, default=FlowCase.n, help="cells along the channel")
    chosen = options.parse_args()
    extra = [f"--n={chosen.n}", *([f"--steps={chosen.steps}"] if chosen.steps else [])]
    figures = alternate(present(CONTENDERS, chosen), extra, chosen)
    along, across = FlowCase(n=chosen.n).counts
    rows = (
        row(code, records, figures.get(OURS[code.cases[0]], []), along * across)
        for code, records in figures.items()
    )
    show(f"{along} x {across} cells", COLUMNS, rows)


if __name__ == "__main__":
    main()
