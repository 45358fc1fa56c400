"""A closed loop of a rigid body, two beams and a shell conserves energy and momenta over ten thousand steps.

Prints the largest changes with ``python -m campaign.loops`` in ``tests``; ``--scale 0.01`` takes a hundredth of the
steps.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from loops import closed_loop, largest_changes

STEPS, MOST = 10_000, 1e-10


def main(arguments: Sequence[str] | None = None) -> int:
    """Run it; the exit status tells whether anything changes by more than round-off of so many steps."""
    parser = argparse.ArgumentParser(prog="campaign.loops", description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of the full length")
    steps = max(10, round(STEPS * parser.parse_args(arguments).scale))
    found = largest_changes(closed_loop(), steps)
    print(
        f"closed loop, {steps} steps: " + ", ".join(f"{name} {change:.1e}" for name, change in found.items())
    )
    return int(max(found.values()) > MOST)


if __name__ == "__main__":
    sys.exit(main())
