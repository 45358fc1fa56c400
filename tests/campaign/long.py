"""Long runs take no more memory than short ones: a million steps of a mechanism, a hundred thousand of a solid.

The resident memory of the process is looked at ten times in a run into a directory, with everything that is written
there. After the first fifth of the steps it may not grow by more than a hundredth.

Prints the table with ``python -m campaign.long`` in ``tests``; ``--scale 0.01`` takes a hundredth of the steps.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import visviva as vv
from visviva.examples import cantilever, pendulum
from visviva.study.recorder import Recorder
from visviva.study.run import run

ROOM = 0.01
"""Part by which memory may grow: the allocator's own hoards come and go."""


@dataclass(frozen=True)
class Outcome:
    """Resident bytes after every tenth of the steps, and what the audit says of energy."""

    name: str
    steps: int
    resident: tuple[int, ...]
    energy: float
    seconds: float

    @property
    def growth(self) -> float:
        """Largest growth after the first fifth, as a part."""
        return max(self.resident[2:]) / self.resident[1] - 1

    def __str__(self) -> str:
        verdict = "WRONG: it grows" if self.growth > ROOM else "constant"
        megabytes = f"{self.resident[1] / 1e6:>11.1f}{self.resident[-1] / 1e6:>11.1f}"
        return (
            f"{self.name:14s}{self.steps:>9d}{megabytes}{self.energy:>12.1e}{self.seconds:>9.0f}  {verdict}"
        )


def mechanism(steps: int) -> vv.Study:
    """A pendulum of a rigid rod."""
    return pendulum.study(until=0.001 * steps, step=0.001)


def solid(steps: int) -> vv.Study:
    """A short cantilever that a force keeps swinging."""
    return cantilever.study(counts=(2, 1, 1), cell="hex8", until=0.001 * steps, step=0.001)


CASES = {"pendulum": (mechanism, 1_000_000), "cantilever": (solid, 100_000)}


def resident() -> int:
    """Resident bytes of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def outcome(name: str, steps: int) -> Outcome:
    """Run one in this process and look at its memory."""
    seen: list[int] = []
    write = Recorder.write

    def writing(recorder: Recorder, step: int, row: Any) -> None:
        write(recorder, step, row)
        if step * 10 >= (len(seen) + 1) * steps:
            seen.append(resident())

    start = time.monotonic()
    Recorder.write = writing  # type: ignore[method-assign]
    try:
        with tempfile.TemporaryDirectory() as scratch:
            result = run(CASES[name][0](steps), scratch, pictures=False, progress=False)
            energy = result.conservation()["energy"]
            seen.append(resident())  # with the audit
    finally:
        Recorder.write = write  # type: ignore[method-assign]
    return Outcome(name, result.statistics.steps, tuple(seen), energy, time.monotonic() - start)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; the exit status tells whether anything is wrong."""
    parser = argparse.ArgumentParser(prog="campaign.long", description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of the steps to take")
    scale, wrong = parser.parse_args(arguments).scale, 0
    print(
        f"{'run':14s}{'steps':>9s}{'MB at 1/5':>11s}{'MB at end':>11s}{'energy':>12s}{'seconds':>9s}  memory"
    )
    for name, (_, steps) in CASES.items():
        found = outcome(name, round(scale * steps))
        print(found, flush=True)
        wrong += found.growth > ROOM
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
