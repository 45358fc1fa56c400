"""What each scheme does to plain rotation: a free rotor, a heavy top and a slider-crank over many turns.

``python benchmarks/rotation.py`` prints the table of docs/theory/schemes.rst. All mechanisms conserve energy: it says
what part of it is lost (minus: gained) in so many turns, in steps of an angle of 0.1.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

import visviva as vv

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from rotating import MECHANISMS, RATE, run

SCHEMES = (
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BDF2(),
    vv.BackwardEuler(),
    vv.GeneralizedAlpha(rho=0.99),
    vv.GeneralizedAlpha(rho=0.9),
    vv.GeneralizedAlpha(rho=0.5),
    vv.GeneralizedAlpha(rho=0.0),
)


def shown(lost: float) -> str:
    return "0" if abs(lost) < 1e-10 else f"{lost:.1e}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=100)
    turns = parser.parse_args().turns
    print(f"   * - Loss in {turns} turns, h ω = 0.1")
    for name in MECHANISMS:
        print(f"     - {name}")
    for scheme in SCHEMES:
        print(f"   * - ``{scheme}``")
        for build in MECHANISMS.values():
            try:
                lost, _ = run(build(), scheme, turns)
                print(f"     - {shown(lost)}", flush=True)
            except vv.StepFailure as failure:
                print(f"     - fails at t ω / 2 π = {failure.time * RATE / 2 / np.pi:.3g}", flush=True)


if __name__ == "__main__":
    main()
