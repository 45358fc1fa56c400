"""Ours and Exudyn on the same mechanisms: alternating rounds, one process and one core per measurement.

    python benchmarks/compare.py --rounds 5 --fast --json figures.json

prints one markdown table of the time per step as median [least-greatest] over the rounds, the ratios of the
medians, and the energy error (greatest |E - E0| by greatest kinetic energy) of a repeated, untimed run.
Columns stay empty for a code that is missing, and say so where a run fails.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cases import SIZES, build
from measure import Measurement

HERE = Path(__file__).resolve().parent
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Contender:
    """A column: a file with the command line of `measure` and one of its schemes."""

    title: str
    file: str
    scheme: str
    options: tuple[str, ...] = ()


Task = tuple[str, int]
Figures = dict[tuple[Task, Contender], list[Measurement]]


def contenders(fast: bool) -> tuple[Contender, ...]:
    """Ours first, then the peer's schemes."""
    options = ("--fast",) if fast else ()
    return (
        Contender("visviva", "ours.py", "energy-momentum"),
        Contender("Exudyn trapezoidal", "peer_exudyn.py", "trapezoidal", options),
        Contender("Exudyn generalised-α", "peer_exudyn.py", "generalised-alpha", options),
    )


def measure_apart(contender: Contender, task: Task, extra: Sequence[str]) -> Measurement:
    """One measurement in a process of its own; whatever goes wrong there becomes a failure in the table."""
    name, n = task
    command = [sys.executable, str(HERE / contender.file), "--case", name, "--n", str(n)]
    command += ["--scheme", contender.scheme, *contender.options, *extra]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=300, env=os.environ | ONE_THREAD, check=False
        )
    except subprocess.TimeoutExpired:
        return failed(contender, task, "more than 300 s")
    if done.returncode != 0 or not done.stdout.strip():
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return failed(contender, task, f"exit {done.returncode}: {reason}")
    return Measurement(**json.loads(done.stdout.strip().splitlines()[-1]))


def failed(contender: Contender, task: Task, reason: str) -> Measurement:
    """A measurement that holds nothing but the reason why there is none."""
    case = build(*task)
    return Measurement(contender.title, contender.scheme, *task, case.step, case.steps, failure=reason)


def alternate(
    task: Task, columns: Sequence[Contender], rounds: int, extra: Sequence[str]
) -> Iterator[tuple[Contender, Measurement]]:
    """All measurements of a case, the codes in turn within every round; the first round audits the states."""
    for turn in range(rounds):
        audited = [*extra, "--errors"] if turn == 0 else extra
        for column in columns:
            if (HERE / column.file).exists():
                yield column, measure_apart(column, task, audited)


def times(measurements: Sequence[Measurement], wall: bool) -> list[float]:
    """Microseconds per step of the measurements that succeeded."""
    values = [m.wall_us if wall else m.cpu_us for m in measurements]
    return [value for value in values if value is not None]


def time_cell(measurements: Sequence[Measurement], wall: bool) -> str:
    """Median [least-greatest], or the reason of a failure."""
    values = times(measurements, wall)
    if not values:
        return next((m.failure for m in measurements if m.failure), "")
    return f"{statistics.median(values):.4g} [{min(values):.4g}-{max(values):.4g}]"


def ratio_cell(peer: Sequence[Measurement], own: Sequence[Measurement], wall: bool) -> str:
    """How many times faster ours is, by the medians."""
    theirs, ours = times(peer, wall), times(own, wall)
    return f"{statistics.median(theirs) / statistics.median(ours):.2f}" if theirs and ours else ""


def error_cell(measurements: Sequence[Measurement]) -> str:
    """Energy error of the audited round."""
    return next((f"{m.energy_error:.1e}" for m in measurements if m.energy_error is not None), "")


def row(task: Task, columns: Sequence[Contender], figures: Figures, wall: bool) -> str:
    """One line of the table."""
    runs = [figures[task, column] for column in columns]
    steps = next((m.steps for measurements in runs for m in measurements), "")
    cells = [task[0], str(task[1]), str(steps)]
    cells += [time_cell(r, wall) for r in runs]
    cells += [ratio_cell(r, runs[0], wall) for r in runs[1:]]
    cells += [error_cell(r) for r in runs]
    return "| " + " | ".join(cells) + " |"


def header(columns: Sequence[Contender], wall: bool) -> str:
    """The two lines above the rows."""
    clock = "wall" if wall else "CPU"
    titles = ["case", "N", "steps"]
    titles += [f"{column.title}, {clock} µs/step" for column in columns]
    titles += [f"{column.title} / {columns[0].title}" for column in columns[1:]]
    titles += [f"energy error {column.title}" for column in columns]
    return "| " + " | ".join(titles) + " |\n|" + "---|" * len(titles)


PASSED_ON = ("--step", "--steps", "--error-steps")


def passed(flag: str, options: dict[str, Any]) -> list[str]:
    """The flag with its value, if it was given."""
    value = options[flag.strip("-").replace("-", "_")]
    return [] if value is None else [flag, value]


def parse() -> argparse.Namespace:
    """Command line options."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    options.add_argument("--rounds", type=int, default=3)
    options.add_argument("--case", choices=SIZES, action="append", help="only this one; may be repeated")
    options.add_argument("--n", type=int, action="append", help="only chains of this many links")
    options.add_argument("--step", help="step size in seconds")
    options.add_argument("--steps", help="number of steps")
    options.add_argument("--error-steps", help="number of steps of the audited run, if not as many")
    options.add_argument("--core", type=int, default=0, help="core that all processes are pinned to")
    options.add_argument("--fast", action="store_true", help="Exudyn without range checks and with AVX2")
    options.add_argument("--wall", action="store_true", help="tabulate wall time instead of CPU time")
    options.add_argument("--json", type=Path, help="write all measurements to this file")
    return options.parse_args()


def chosen_tasks(names: Sequence[str] | None, sizes: Sequence[int] | None) -> list[Task]:
    """The cases asked for; a choice of sizes concerns the chains alone."""
    tasks = [(name, n) for name in names or SIZES for n in SIZES[name]]
    return [task for task in tasks if not sizes or len(SIZES[task[0]]) == 1 or task[1] in sizes]


def main() -> None:
    """Measure, print the table row by row, write the raw figures."""
    chosen = parse()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {chosen.core})  # inherited by every measurement
    columns = contenders(chosen.fast)
    figures: Figures = defaultdict(list)
    extra = [part for flag in PASSED_ON for part in passed(flag, vars(chosen))]
    print(header(columns, chosen.wall), flush=True)
    for task in chosen_tasks(chosen.case, chosen.n):
        for column, measurement in alternate(task, columns, chosen.rounds, extra):
            figures[task, column].append(measurement)
        print(row(task, columns, figures, chosen.wall), flush=True)
    if chosen.json:
        everything = [asdict(m) for measurements in figures.values() for m in measurements]
        chosen.json.write_text(json.dumps(everything, indent=1) + "\n")


if __name__ == "__main__":
    main()
