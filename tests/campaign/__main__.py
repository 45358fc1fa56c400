"""All campaigns, one after the other: ``python -m campaign`` in ``tests``.

``python -m campaign --scale 0.01`` takes a hundredth of the steps of long runs, kills each example twice, and makes 150
bad inputs.
"""

from __future__ import annotations

import argparse
import sys

from campaign import generated, kill, long, loops, schemes, shells


def main() -> int:
    """Run all; the exit status tells whether anything is wrong."""
    parser = argparse.ArgumentParser(prog="campaign", description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of the full length")
    scale = parser.parse_args().scale
    wrong = kill.main(["--kills", str(max(2, round(6 * scale)))])
    wrong += long.main(["--scale", str(scale)])
    wrong += loops.main(["--scale", str(scale)])
    wrong += schemes.main()
    wrong += shells.main(["course"])
    wrong += generated.main([str(max(150, round(1000 * scale)))])
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
