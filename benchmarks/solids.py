"""Solids beside DOLFINx, felupe, Kratos and NGSolve: alternating rounds, one process and one thread per measurement.

    python benchmarks/solids.py --python felupe=PATH --python ngsolve=PATH --python kratos=PATH --python dolfinx=PATH

prints one markdown table for each case: CPU time of a step as median [least-greatest] over the rounds and its ratio to
ours, the parts of one iteration of Newton's method, and the mean displacement that shows that all have solved the same
discrete problem. PATH is a Python interpreter that has the code; without it this one is tried, and a code that is
missing is left out with a word.
"""

from __future__ import annotations

import argparse

from contenders import Contender, Figures, add_options, alternate, cost, part, present, show
from solid_cases import BUILDERS, SolidCase

BOTH = ("torus", "block")
CASES = (("torus", 118), ("block", 20), ("block", 30))
OURS = Contender("visviva, energy-momentum in dynamics", "ours_solids.py", "visviva", "energy-momentum", BOTH)
CONTENDERS = (
    OURS,
    Contender("visviva, trapezoidal rule", "ours_solids.py", "visviva", "trapezoidal", ("torus",)),
    Contender("DOLFINx, MUMPS Cholesky", "peer_dolfinx.py", "dolfinx", "MUMPS", BOTH),
    Contender("DOLFINx, CG + GAMG", "peer_dolfinx.py", "dolfinx", "GAMG", ("block",)),
    Contender("felupe, PARDISO LU", "peer_felupe.py", "felupe", "PARDISO", BOTH),
    Contender("NGSolve, PARDISO", "peer_ngsolve.py", "ngsolve", "PARDISO", BOTH),
    Contender("Kratos, AMGCL", "peer_kratos.py", "KratosMultiphysics", "AMGCL", BOTH),
)
COLUMNS = (
    "code", "assembly, ms", "µs/brick", "solution, ms", "iterations/step", "CPU s/step", "ratio", "peak MB",
    "mean displacement",
)  # fmt: skip


def row(contender: Contender, case: SolidCase, figures: Figures) -> list[str]:
    """One line of the table; the parts are medians over the rounds."""
    records = figures[contender]
    last, assembly = records[-1], part(records, "assembly")
    cells = [
        contender.title,
        f"{1e3 * assembly:.3g}",
        f"{1e6 * assembly / len(case.cells):.3g}",
        f"{1e3 * part(records, 'solution'):.3g}",
        f"{last.iterations / last.steps:.3g}",
        *cost(records, figures.get(OURS, ())),
        f"{last.peak_mb:.0f}",
        f"{last.answer:.8f}",
    ]
    if any(r.energies for r in records):
        energies = next(r.energies for r in records if r.energies)
        cells.append(f"{max(abs(e - energies[0]) for e in energies) / abs(energies[0]):.1e}")
    return cells


def title(case: SolidCase) -> str:
    """What stands above the table."""
    text = f"{case.name} {case.n}: {len(case.cells)} bricks, {3 * len(case.points)} unknowns"
    known = case.mean_displacement == case.mean_displacement
    return f"{text}; mean displacement {case.mean_displacement}" if known else text


def parse() -> argparse.Namespace:
    """Command line options."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_options(options)
    options.add_argument("--case", choices=BUILDERS, action="append", help="only this one; may be repeated")
    options.add_argument("--n", type=int, action="append", help="only this size")
    options.add_argument("--step", type=float, help="step size")
    options.add_argument("--energies", action="store_true", help="also the greatest change of the energy")
    return options.parse_args()


def main() -> None:
    """Measure case by case and print the tables."""
    chosen = parse()
    codes = present(CONTENDERS, chosen)
    extra = ["--energies"] if chosen.energies else []
    extra += [f"--{name}={value}" for name in ("steps", "step") if (value := getattr(chosen, name))]
    for name, n in CASES:
        if (chosen.case and name not in chosen.case) or (chosen.n and n not in chosen.n):
            continue
        able = {code: interpreter for code, interpreter in codes.items() if name in code.cases}
        figures = alternate(able, ["--case", name, "--n", str(n), *extra], chosen)
        case = BUILDERS[name](n)
        columns = [*COLUMNS, *(["energy drift"] if chosen.energies else [])]
        show(title(case), columns, (row(code, case, figures) for code in figures))


if __name__ == "__main__":
    main()
