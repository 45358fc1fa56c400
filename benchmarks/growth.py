"""How time and memory grow with the number of unknowns, over three decades.

    python benchmarks/growth.py [--case statics ...] [--full] [--picture growth.png]

prints per case and size: equations, Newton iterations per step, iterations of the Krylov method for each of them
(0: factors), processor and wall-clock time per iteration in milliseconds, microseconds per equation, peak memory per
equation beyond what the imports take, and the slope: by which power of their number times have grown since the size
before. The last column says where that is more than theory
allows. One process and one thread per measurement; the first step, which makes patterns, is not timed but is in the
memory. `--full` goes on to a million unknowns and more, which takes an hour; `--picture` draws what is printed.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

HEAD = (
    f"{'size':>7s} {'equations':>10s} {'its':>5s} {'Krylov':>6s} {'cpu ms/it':>10s} {'wall ms/it':>10s} {'µs/eq':>7s} "
    f"{'kB/eq':>7s} {'slope':>6s}"
)


@dataclass(frozen=True)
class Figures:
    """Of one size: seconds per iteration, bytes beyond those of the imports."""

    size: int
    equations: int
    iterations: float
    krylov: float
    cpu: float
    wall: float
    memory: float

    def slope(self, before: Figures) -> float:
        """Power of the number of equations with which the processor's time has grown."""
        return float(np.log(self.cpu / before.cpu) / np.log(self.equations / before.equations))

    def line(self, slope: float | None) -> str:
        """Of the table."""
        per, kb = 1e6 * self.cpu / self.equations, self.memory / self.equations / 1e3
        head = f"{self.size:7d} {self.equations:10d} {self.iterations:5.1f} {self.krylov:6.1f} {1e3 * self.cpu:10.2f}"
        tail = f"{slope:6.2f}" if slope is not None else " " * 6
        return f"{head} {1e3 * self.wall:10.2f} {per:7.2f} {kb:7.2f} {tail}"


def peak() -> float:
    """Bytes that this process has had at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def budget(system: Any) -> dict[str, float]:
    """Bytes of what a large solid of hexahedra in statics will take, by item, from its sizes alone.

    Those of coarser grids and the number of vectors are counted from a run of a million equations.
    """
    import visviva as vv
    from visviva.mesh.quadrature import stiffness_rule

    mesh = next(c.grid for c in system.components if isinstance(c, vv.Solid))
    (name, cells), n, entries = *mesh.cells.items(), system.core.n_equations, len(system.core.csr[1])
    m, k, d = len(cells), cells.shape[1], mesh.points.shape[1]
    points = len(stiffness_rule(name).points)
    blocks = entries / d**2
    return {
        "mesh": mesh.points.nbytes + cells.nbytes,
        "places of nodes of elements and of their blocks": m
        * (8.0 * k * d + 8 * points + 2 * k**2 + 20 * k + 28),
        "matrix": 12.0 * entries,
        "neighbours of nodes": 8.0 * blocks + 80 * n / d,
        "its finest grid, in single precision": 4.0 * (entries + 2 * blocks),
        "coarser grids, ways between them, while they are made": 1700.0 * n / d,
        "vectors and rigid motions": 8.0 * n * (9 + 50),
    }


def measure(case: str, size: int) -> Figures:
    """In this process."""
    from growth_cases import CASES

    import visviva as vv

    start = peak()
    motion = CASES[case].build(size)
    system, h = motion.system, motion.step
    if case == "statics":
        items = budget(system)
        lines = [f"  {bytes_ / 1e9:7.3f} GB  {item}" for item, bytes_ in items.items()]
        print(*lines, f"  {sum(items.values()) / 1e9:7.3f} GB  expected in all", sep="\n", file=sys.stderr)
    marching = vv.march(system, until=(motion.steps + 0.5) * h, step=h, scheme=motion.scheme)
    next(marching)
    cpu, wall, iterations, before = time.process_time(), time.perf_counter(), 0, system.core.phases
    for _ in range(motion.steps - 1):
        iterations += next(marching).iterations
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    print(f"  {system.core.solver}", file=sys.stderr)
    counts = [system.core.phases[name] - before[name] for name in ("iterations", "solutions")]
    each = (counts[0] / counts[1], cpu / iterations, wall / iterations)
    return Figures(
        size, system.core.n_equations, iterations / (motion.steps - 1), *each, memory=peak() - start
    )


def measured(case: str, size: int) -> Figures:
    """In a process of its own."""
    command = [sys.executable, __file__, "--case", case, "--size", str(size)]
    done = subprocess.run(
        command, env={**os.environ, "OMP_NUM_THREADS": "1"}, stdout=subprocess.PIPE, text=True
    )
    if done.returncode:
        raise SystemExit(f"{case} of size {size} failed")
    return Figures(**json.loads(done.stdout.splitlines()[-1]))


def table(case: str, full: bool) -> list[Figures]:
    """Measure a case at its sizes and print it."""
    from growth_cases import CASES

    growing, rows = CASES[case], list[Figures]()
    print(f"\n{growing.title} ({case})\n{HEAD}")
    for size in growing.full if full else growing.modest:
        rows.append(measured(case, size))
        slope = rows[-1].slope(rows[-2]) if len(rows) > 1 else None
        faults = [f"grows faster than N^{growing.allowed}"] if slope and slope > growing.allowed else []
        if len(rows) > 1 and rows[-1].memory > 1e3 * growing.memory * rows[-1].equations:
            faults.append(f"more than {growing.memory} kB")
        print(rows[-1].line(slope), "; ".join(faults), flush=True)
    return rows


def draw(figures: dict[str, Sequence[Figures]], path: Path) -> None:
    """Time per iteration and memory by equations, both logarithmic."""
    import matplotlib.pyplot as plt
    from growth_cases import CASES

    figure, axes = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    for case, rows in figures.items():
        n = [row.equations for row in rows]
        axes[0].loglog(n, [row.cpu for row in rows], "o-", label=CASES[case].title)
        axes[1].loglog(n, [row.memory / row.equations / 1e3 for row in rows], "o-")
    ends = np.array(axes[0].get_xlim())
    axes[0].loglog(ends, 1e-5 * ends, "k:", label="10 µs per equation")
    axes[0].set(xlabel="equations", ylabel="seconds per iteration")
    axes[1].set(xlabel="equations", ylabel="kB per equation")
    axes[0].legend(fontsize="small")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Measure and print."""
    from growth_cases import CASES

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", action="append", choices=CASES)
    parser.add_argument("--full", action="store_true", help="up to a million unknowns and more")
    parser.add_argument("--picture", type=Path, help="file to draw to")
    parser.add_argument("--size", type=int, help="this size alone, in this process")
    given = parser.parse_args()
    if given.size:
        return print(json.dumps(asdict(measure(given.case[0], given.size))))
    figures = {case: table(case, given.full) for case in given.case or CASES}
    if given.picture:
        draw(figures, given.picture)
    return None


if __name__ == "__main__":
    main()
