"""The flying L with hot and cold faces to t = 15 at growing steps: what both laws of thermodynamics leave of it.

    PYTHONPATH=src python benchmarks/flying_l.py [--until 15] [--cells 2] [--viscous]

From the end of the push on (t = 1): the largest change of the total energy, and of linear and angular momentum,
relative to the largest values of the energy, of the momentum that the push gives one face, and of the angular momentum.
Over the whole run: the least that the entropy grew in a step, and all that it grew by; how many steps were cut.
"""

from __future__ import annotations

import argparse

import numpy as np

import visviva as vv
from visviva.examples import flying_l

STEPS = (0.025, 0.05, 0.1, 0.2)
PUSHED = float(np.linalg.norm(flying_l.FORCE)) / 4
"""Impulse of the push on one face: its force times the area under the hat."""


def run(
    step: float, until: float, cells: int, viscous: bool
) -> tuple[float, float, float, float, float, int]:
    """Relative errors of energy, momentum and angular momentum; the entropy's least and whole growth; steps cut."""
    study = flying_l.study(cells=cells, viscous=viscous, until=until, step=step)
    (body,) = (c for c in study.system.components if isinstance(c, vv.ThermoelasticSolid))
    entropy: list[float] = []
    result = vv.simulate(
        study.system, until=until, step=step, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    ledger = result.ledger
    free = ledger["time"] > 1 - 1e-9

    def kept(kind: str) -> np.ndarray:
        rows = np.column_stack([ledger[f"{kind}_{axis}"][free] for axis in "xyz"])
        return np.asarray(rows - rows[0])

    energy = np.ptp(ledger["total"][free]) / np.abs(ledger["total"]).max()
    turning = max(float(np.abs(ledger[f"angular_{axis}"]).max()) for axis in "xyz")
    grown = np.diff(entropy)
    return (
        float(energy),
        float(np.abs(kept("momentum")).max()) / PUSHED,
        float(np.abs(kept("angular")).max()) / turning,
        float(grown.min()),
        float(grown.sum()),
        result.statistics.rejected,
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--until", type=float, default=15.0)
    parser.add_argument("--cells", type=int, default=2, help="across its thickness")
    parser.add_argument("--viscous", action="store_true", help="with a branch whose dissipation heats it")
    given = parser.parse_args()
    print(
        f"{'step':>6}{'energy':>10}{'momentum':>10}{'angular':>10}{'least ds':>11}{'entropy made':>14}{'cut':>5}"
    )
    for step in STEPS:
        energy, momentum, angular, least, made, cut = run(step, given.until, given.cells, given.viscous)
        print(
            f"{step:6.3f}{energy:10.1e}{momentum:10.1e}{angular:10.1e}{least:11.2e}{made:14.6f}{cut:5d}",
            flush=True,
        )


if __name__ == "__main__":
    main()
