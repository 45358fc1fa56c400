"""Codes that are compared: who they are, whether they are installed, and a measurement in a process of its own."""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from record import Record

HERE = Path(__file__).resolve().parent
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Contender:
    """A line of the table: a file, the module it needs, its variant, and the cases it can run.

    The file's command line prints one line of JSON, the fields of `Record`.
    """

    title: str
    file: str
    module: str
    variant: str
    cases: tuple[str, ...] = ()


Figures = Mapping[Contender, Sequence[Record]]


def environment(interpreter: str) -> dict[str, str]:
    """One thread, and the tools beside the interpreter (NGSolve compiles its expressions) on the path."""
    path = f"{Path(interpreter).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    return os.environ | ONE_THREAD | {"PATH": path}


def is_there(module: str, interpreter: str) -> bool:
    """Whether the interpreter has the module."""
    command = [interpreter, "-c", f"import {module}"]
    try:
        done = subprocess.run(command, capture_output=True, env=environment(interpreter), check=False)
    except OSError:
        return False
    return done.returncode == 0


def measure(contender: Contender, interpreter: str, extra: Sequence[str], limit: float) -> Record | None:
    """One measurement in a process of its own; a failure is printed."""
    command = [interpreter, str(HERE / contender.file), "--variant", contender.variant, *extra]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=limit, env=environment(interpreter), check=False
        )
    except subprocess.TimeoutExpired:
        print(f"{contender.title}: more than {limit:g} s", flush=True)
        return None
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        print(f"{contender.title}: {(done.stderr.strip().splitlines() or ['no message'])[-1]}", flush=True)
        return None
    return Record(**json.loads(lines[-1]))


def add_options(options: argparse.ArgumentParser) -> None:
    """What every comparison can be told."""
    options.add_argument("--rounds", type=int, default=3)
    options.add_argument("--code", action="append", help="only titles with this word; may be repeated")
    options.add_argument("--steps", type=int, help="number of steps")
    options.add_argument("--limit", type=float, default=300.0, help="seconds until a measurement is given up")
    options.add_argument("--python", action="append", default=[], metavar="CODE=PATH")


def present(contenders: Sequence[Contender], chosen: argparse.Namespace) -> dict[Contender, str]:
    """The contenders asked for that are installed, with their interpreters."""
    given = dict(pair.split("=", 1) for pair in chosen.python)
    found: dict[Contender, str] = {}
    for c in contenders:
        if chosen.code and not any(word.lower() in c.title.lower() for word in chosen.code):
            continue
        keys = (c.module.lower(), c.module.lower().removesuffix("multiphysics"))
        interpreter = next((given[k] for k in keys if k in given), sys.executable)
        if is_there(c.module, interpreter):
            found[c] = interpreter
        else:
            print(f"{c.title}: left out, {interpreter} has no {c.module}", flush=True)
    return found


def alternate(
    codes: Mapping[Contender, str], extra: Sequence[str], chosen: argparse.Namespace
) -> dict[Contender, list[Record]]:
    """What these codes (with their interpreters) measure in so many rounds, in turn."""
    figures: dict[Contender, list[Record]] = defaultdict(list)
    for _ in range(chosen.rounds):
        for code, interpreter in codes.items():
            record = measure(code, interpreter, extra, chosen.limit)
            if record is not None:
                figures[code].append(record)
    return figures


def cost(records: Sequence[Record], ours: Sequence[Record], unit: str = "steps") -> list[str]:
    """CPU seconds of a step (or of one of the `iterations`) as median [least-greatest], and its ratio to ours."""
    times, own = ([r.cpu / getattr(r, unit) for r in group] for group in (records, ours))
    median = statistics.median(times)
    ratio = f"{median / statistics.median(own):.2f}" if own else ""
    return [f"{median:.3g} [{min(times):.3g}-{max(times):.3g}]", ratio]


def part(records: Sequence[Record], name: str) -> float:
    """CPU seconds that the assembly or the solution of an iteration takes, the median."""
    return statistics.median(getattr(r, name) / r.iterations for r in records)


def show(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a markdown table."""
    print(f"\n{title}\n\n| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)
