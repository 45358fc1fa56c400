"""Generated bad input: mutated scenes, constructor arguments, meshes and command lines, by seeds.

A case fails where the process dies or hangs, where an error is raised that is none of the package's, where a Python
traceback or an unexpected error reaches the command line, where a message runs over lines or is endless, or where input
that means nothing is accepted without a word. Every case follows from its number alone.

``python -m campaign.generated 1000`` in ``tests`` runs 1,000; ``python -m campaign.generated 17 18`` number 17 alone,
with what it was and what came of it.
"""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from random import Random
from types import FrameType

import visviva as vv
from campaign import mutations
from visviva import cli

LIMIT = 20
"""Seconds that a case may take."""
LONGEST = 1500
"""Characters of a message."""


class Hang(BaseException):
    """A case that took too long."""


def outcome(case: mutations.Case, folder: Path) -> str:
    """What is wrong with how a case went; nothing if it went as it should."""
    with contextlib.chdir(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # meant for a human who looks on
        return of_call(case) if case.call else of_command(case)


def of_command(case: mutations.Case) -> str:
    """The same, of a command line."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main(case.command)
    told = err.getvalue()
    if "Traceback" in told or cli.UNEXPECTED in told:
        return f"unexpected: {told[-400:]}"
    if code not in (0, cli.BAD_INPUT, cli.FAILED):
        return f"exit code {code}"
    if case.is_bad and code != cli.BAD_INPUT:
        return f"accepted without a word (exit code {code}): {told[-200:]}"
    if code == cli.BAD_INPUT and not 0 < len(told) < LONGEST:
        return f"a message of {len(told)} characters"
    return (
        f"a message of several lines: {told!r}"
        if code == cli.BAD_INPUT and len(told.splitlines()) > 2
        else ""
    )


def of_call(case: mutations.Case) -> str:
    """The same, of a constructor or function."""
    assert case.call
    try:
        case.call()
    except vv.VisvivaError as error:
        return "" if len(str(error)) < LONGEST else f"a message of {len(str(error))} characters"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:300]}"
    return "accepted without a word" if case.is_bad else ""


def stop(_: int, __: FrameType | None) -> None:
    raise Hang


def run(seeds: range) -> Iterator[tuple[int, str, str]]:
    """Number, description and fault of the cases, one after the other in this process."""
    signal.signal(signal.SIGALRM, stop)
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            case = mutations.case(Random(seed), seed, Path(folder))
            print(f"begin {seed} {case.what}", file=sys.__stdout__, flush=True)
            signal.alarm(LIMIT)
            try:
                fault = outcome(case, Path(folder))
            except Hang:
                fault = f"hangs for more than {LIMIT} s"
            finally:
                signal.alarm(0)
        yield seed, case.what, fault


def work(first: int, last: int) -> None:
    """Run cases and print their faults, for the process that watches."""
    from visviva.study import drawings

    drawings.draw_run = lambda *_, **__: []  # type: ignore[assignment]  # pictures take seconds
    for seed, what, fault in run(range(first, last)):
        print(f"end {seed} {'FAULT ' + what + ': ' + ' '.join(fault.split()) if fault else ''}", flush=True)


def campaign(first: int, last: int) -> list[str]:
    """Faults of the cases from `first` to `last`, run in a process of their own that may die."""
    faults = []
    while first < last:
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path]),
        }
        command = [sys.executable, "-m", "campaign.generated", "--work", str(first), str(last)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as worker:
            assert worker.stdout
            begun = f"{first} before the first case"
            for line in worker.stdout:
                word, _, rest = line.rstrip("\n").partition(" ")
                if word == "begin":
                    begun = rest
                elif word == "end" and "FAULT" in rest:
                    faults.append(rest.replace(" FAULT", ":", 1))
        if worker.returncode == 0:
            break
        faults.append(f"{begun}: the process died with {worker.returncode}")
        first = int(begun.split()[0]) + 1
    return faults


def main(arguments: list[str]) -> int:
    """Run the campaign that the arguments ask for."""
    if arguments[:1] == ["--work"]:
        work(int(arguments[1]), int(arguments[2]))
        return 0
    numbers = [int(a) for a in arguments] or [150]
    first, last = (0, numbers[0]) if len(numbers) == 1 else (numbers[0], numbers[1])
    faults = campaign(first, last)
    print("\n".join(faults))
    print(f"{last - first} cases, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
