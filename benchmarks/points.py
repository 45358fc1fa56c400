"""What physics at points costs: residual, and residual with tangent and scatter, in microseconds of CPU time per cell.

    python benchmarks/points.py [--repeat 20]

The instances of the tests at a thousand cells or more, under the energy-momentum scheme, one thread; best of some
repetitions. Compare with `elements.py`.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from elements import SCHEMES, costs
from instances import points

import visviva as vv
from visviva.component.component import Component

BRICKS = (10, 10, 10)
CASES: dict[str, tuple[Callable[[], Component], int]] = {
    "viscoelastic brick": (lambda: points.Viscoelastic(counts=BRICKS), 1000),
    "the same in Python": (lambda: points.UserViscoelastic(counts=BRICKS), 1000),
    "thermoelastic brick": (lambda: points.Thermoelastic(counts=BRICKS), 1000),
    "damaged brick": (lambda: points.Damaged(counts=BRICKS), 1000),
    "separating brick": (lambda: points.Separating(counts=BRICKS), 1000),
    "director beam": (lambda: points.DirectorBeam(n=1000, length=500.0), 1000),
    "four-node shell": (lambda: points.DirectorShell(counts=(32, 32)), 1024),
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=20)
    repeat = parser.parse_args().repeat
    print(f"{'physics':20s} {'cells':>6s} {'residual':>9s} {'residual, tangent, scatter':>27s}")
    for name, (build, n) in CASES.items():
        r, both = costs(vv.System([build()]), SCHEMES["energy-momentum"], n, repeat, time.process_time)
        print(f"{name:20s} {n:6d} {r:9.2f} {both:27.2f}", flush=True)


if __name__ == "__main__":
    main()
