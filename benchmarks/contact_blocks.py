"""Two blocks in contact beside Kratos: alternating rounds, one process and one thread per measurement.

    python benchmarks/contact_blocks.py [--thousands 72] --python kratos=PATH

prints a markdown table: CPU time of a load step and of an iteration as median [least-greatest] over the rounds, their
ratios to ours, and the mean displacement across the surface in contact. The elements differ (neo-Hooke of another
form) and so do the multipliers, so displacements agree to some thousandths. PATH is a Python interpreter that has
KratosMultiphysics with its ContactStructuralMechanicsApplication; without it this one is tried.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from contact_case import COUNTS, ContactCase
from contenders import Contender, add_options, alternate, cost, present, show
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


def row(title: str, records: Sequence[Record], ours: Sequence[Record]) -> list[str]:
    """One line of the table."""
    last = records[-1]
    costs = [cell for unit in ("steps", "iterations") for cell in cost(records, ours, unit)]
    return [title, f"{last.iterations / last.steps:.3g}", *costs, f"{last.peak_mb:.0f}", f"{last.answer:.6f}"]


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
    ours = figures.get(OURS, [])
    show(f"{unknowns} unknowns", COLUMNS, (row(code.title, figures[code], ours) for code in figures))


if __name__ == "__main__":
    main()
