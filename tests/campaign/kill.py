"""Six examples are killed with ``kill -9`` at random moments, resumed, and must end in the bits of unbroken runs.

Every attempt is a process of its own, which may die before it has imported anything, while it writes its first state,
between any two writes and while it draws nothing. Tables, kept states, restart state and trajectory are compared.

Prints the table with ``python -m campaign.kill`` in ``tests``; ``--kills`` says how often each example is killed.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from saved import saved_arrays

import visviva as vv
from visviva.output import Trajectory, load_state
from visviva.scene.gallery import example
from visviva.study.run import run

CASES: dict[str, dict[str, Any]] = {
    "crane": {"until": 2.0, "step": 0.004},
    "four_bar": {"until": 4.0, "step": 0.01},
    "flexible_slider_crank": {"until": 0.25},
    "torus": {"counts": (24, 8, 1), "until": 0.25, "step": 0.0025},
    "cylinder": {"case": "2D-2", "fine": 1, "until": 0.5, "step": 0.01},
    "valve": {"mesh": "coarse", "until": 0.02, "step": 0.0025},
}
"""Mechanisms, an elastic mechanism, a solid, a flow, and solids immersed in a flow."""
TABLES = ("ledger.csv", "probes.csv", "states.npy")


@dataclass(frozen=True)
class Outcome:
    """What became of an example."""

    name: str
    steps: int
    saved: tuple[float, ...]
    """Times of the states that the kills left; -1 for none."""
    difference: str

    def __str__(self) -> str:
        places = ", ".join("none" if t < 0 else f"{t:.4g}" for t in self.saved)
        verdict = f"WRONG: {self.difference}" if self.difference else "the same bits"
        return f"{self.name:24s}{self.steps:>7d}{len(self.saved):>7d}  {verdict:16s}{places}"


def study(name: str) -> vv.Study:
    """An example, short enough to be run often."""
    composed: vv.Study = example(name).study(**CASES[name])
    return composed


def attempt(name: str, directory: Path) -> None:
    """Begin a run, or go on with it."""
    resume = (directory / "state.h5").exists()
    run(study(name), directory, resume=resume, save_every=0.0, pictures=False, progress=False)


def outcome(name: str, kills: int, rng: np.random.Generator) -> Outcome:
    """Kill an example so many times, and compare."""
    with tempfile.TemporaryDirectory() as scratch:
        whole, killed = Path(scratch) / "whole", Path(scratch) / "killed"
        start = time.monotonic()
        finish(name, whole)
        seconds, places = time.monotonic() - start, list[float]()
        while len(places) < kills:
            if killed_once(name, killed, rng.uniform(0, seconds)):
                state = killed / "state.h5"
                places.append(float(load_state(state)["stepper"].values["time"]) if state.exists() else -1.0)
            elif found := difference(whole, killed):
                return Outcome(name, steps_of(whole), tuple(places), found)
            else:  # it came to its end before, and is begun again
                shutil.rmtree(killed)
        finish(name, killed)
        return Outcome(name, steps_of(whole), tuple(places), difference(whole, killed))


def steps_of(directory: Path) -> int:
    """Steps of a run."""
    return int(load_state(directory / "state.h5")["statistics"].values["steps"])


def launched(name: str, directory: Path) -> subprocess.Popen[bytes]:
    """A process that runs an example into a directory."""
    command = [sys.executable, "-m", "campaign.kill", "--attempt", name, str(directory)]
    places = Path(vv.__file__).parents[1], Path(__file__).parents[1]
    return subprocess.Popen(command, env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, places))})


def finish(name: str, directory: Path) -> None:
    """Run to the end."""
    with launched(name, directory) as process:
        if process.wait() != 0:
            raise RuntimeError(f"{name} could not be resumed in {directory}")


def killed_once(name: str, directory: Path, seconds: float) -> bool:
    """Kill an attempt after so many seconds; whether it was still running then."""
    with launched(name, directory) as process:
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            return True
        return False


def difference(one: Path, other: Path) -> str:
    """In what two directories differ; empty if in no bit."""
    for table in TABLES:
        if (one / table).read_bytes() != (other / table).read_bytes():
            return table
    a, b = saved_arrays(one), saved_arrays(other)
    unequal = [n for n in sorted({*a, *b}) if n not in a or n not in b or a[n].tobytes() != b[n].tobytes()]
    if unequal:
        return f"state.h5: {unequal[0]}"
    with Trajectory(one / "trajectory.vtkhdf") as p, Trajectory(other / "trajectory.vtkhdf") as q:
        if p.times.tolist() != q.times.tolist():
            return "times of trajectory.vtkhdf"
        for k in range(len(p.times)):
            values, others = p.values(k, k + 1), q.values(k, k + 1)
            if any(values[name].tobytes() != others[name].tobytes() for name in values):
                return f"trajectory.vtkhdf at t = {p.times[k]:g}"
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; the exit status tells whether anything is wrong."""
    parser = argparse.ArgumentParser(prog="campaign.kill", description=__doc__)
    parser.add_argument("--kills", type=int, default=6, help="of each example")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--attempt", nargs=2, metavar=("NAME", "DIRECTORY"), help="one run, to be killed")
    given = parser.parse_args(arguments)
    if given.attempt:
        attempt(given.attempt[0], Path(given.attempt[1]))
        return 0
    rng, wrong = np.random.default_rng(given.seed), 0
    print(f"{'example':24s}{'steps':>7s}{'kills':>7s}  {'verdict':16s}states left at t =")
    for name in CASES:
        found = outcome(name, given.kills, rng)
        print(found, flush=True)
        wrong += bool(found.difference)
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
