"""Two blocks in contact beside Kratos: alternating rounds, one process and one thread per measurement.

    python benchmarks/contact_blocks.py [--thousands 72] --python kratos=PATH

prints a markdown table: CPU time of a load step and of an iteration as median [least-greatest] over the rounds, their
ratios to ours, and the mean displacement across the surface in contact. The elements differ (neo-Hooke of another
form) and so do the multipliers, so displacements agree to some thousandths. PATH is a Python interpreter that has
KratosMultiphysics with its ContactStructuralMechanicsApplication; without it this one is tried.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Sequence

from contact_case import COUNTS, ContactCase
from contenders import Contender, add_options, alternate, present
from record import Record

OURS = Contender("visviva, mortar, multipliers", "ours_contact.py", "visviva", "mortar")
CONTENDERS = (
    OURS,
    Contender("Kratos, ALM mortar, AMGCL", "peer_kratos_contact.py", "KratosMultiphysics", "AMGCL"),
)
COLUMNS = (
    "code",
    "iterations/step",
    "CPU s/step",
    "ratio",
    "CPU s/iteration",
    "ratio",
    "peak MB",
    "mean u_z",
)


def spread(values: Sequence[float]) -> str:
    """Median [least-greatest]."""
    return f"{statistics.median(values):.3g} [{min(values):.3g}-{max(values):.3g}]"


def row(title: str, records: Sequence[Record], ours: Sequence[Record]) -> str:
    """One line of the table."""
    cells, last = [title, f"{records[-1].iterations / records[-1].steps:.3g}"], records[-1]
    for part in ("steps", "iterations"):
        times, own = ([r.cpu / getattr(r, part) for r in rs] for rs in (records, ours))
        ratio = f"{statistics.median(times) / statistics.median(own):.2f}" if own else ""
        cells += [spread(times), ratio]
    return "| " + " | ".join([*cells, f"{last.peak_mb:.0f}", f"{last.answer:.6f}"]) + " |"


def main() -> None:
    """Measure and print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_options(options)
    options.add_argument("--thousands", type=int, choices=COUNTS, default=9, help="of unknowns")
    chosen = options.parse_args()
    extra = [f"--thousands={chosen.thousands}", *([f"--steps={chosen.steps}"] if chosen.steps else [])]
    figures = alternate(present(CONTENDERS, chosen), extra, chosen)
    case = ContactCase(chosen.thousands)
    unknowns = 3 * (len(case.lower.points) + len(case.upper.points))
    print(f"\n{unknowns} unknowns\n\n| " + " | ".join(COLUMNS) + " |\n|" + "---|" * len(COLUMNS))
    for code in figures:
        print(row(code.title, figures[code], figures.get(OURS, [])), flush=True)


if __name__ == "__main__":
    main()
