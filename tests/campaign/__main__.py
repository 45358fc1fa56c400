"""All campaigns, one after the other: ``python -m campaign`` in ``tests``; what follows is how much longer it may take.

``python -m campaign --scale 0.01`` takes a hundredth of the steps of long runs and kills each example twice.
"""

from __future__ import annotations

import argparse
import sys

from campaign import kill, long, schemes


def main() -> int:
    """Run all; the exit status tells whether anything is wrong."""
    parser = argparse.ArgumentParser(prog="campaign", description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of the full length")
    scale = parser.parse_args().scale
    wrong = kill.main(["--kills", str(max(2, round(6 * scale)))])
    wrong += long.main(["--scale", str(scale)])
    wrong += schemes.main()
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
