"""Schemes on the thermoelastic double pendulum at growing steps: which keep both laws, and where each of them fails.

    PYTHONPATH=src python benchmarks/thermal_pendulum.py [--until 5] [--conductance 10]

A scheme is run at steps that double until it finds no end of a step, however small it is cut. The table tells the
largest change of the total energy, relative to that of the start, and the most that the entropy of both springs fell
in a step; the last columns are how many steps were tried again with a shorter one, and where it failed.
"""

from __future__ import annotations

import argparse

import numpy as np

import visviva as vv
from visviva.analysis.march import advance, begin
from visviva.examples import thermal_pendulum

SCHEMES = {
    "energy-momentum": vv.EnergyMomentum,
    "midpoint": vv.Midpoint,
    "variational midpoint": vv.VariationalMidpoint,
    "generalised alpha": vv.GeneralizedAlpha,
    "BDF2": vv.BDF2,
    "backward Euler": vv.BackwardEuler,
}
STEPS = [0.005 * 2**k for k in range(8)]


def run(scheme: vv.Scheme, step: float, until: float, conductance: float) -> tuple[float, float, int, str]:
    """Relative error of the energy, the most that entropy fell, how many steps were cut, and where it failed."""
    system = thermal_pendulum.study(conductance=conductance).system
    springs = [c for c in system.components if isinstance(c, vv.ThermalSpring)]
    entropy, failure = [entropy_of(springs, system)], ""
    result, books = begin(system, scheme, step=step)
    try:
        for _ in advance(result, books, until=until, step=step, adaptive=None):
            entropy.append(entropy_of(springs, system))
    except vv.RunError:
        failure = f"at t = {system.time:.3g}"
    energy = result.ledger["total"]
    error = float(np.max(np.abs(energy - energy[0]))) / abs(float(energy[0]))
    return error, max(0.0, float(-np.min(np.diff(entropy), initial=0.0))), result.statistics.rejected, failure


def entropy_of(springs: list[vv.ThermalSpring], system: vv.System) -> float:
    """That of both springs."""
    return float(sum(spring.entropy_at(system.x) for spring in springs))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--until", type=float, default=5.0)
    parser.add_argument("--conductance", type=float, default=10.0)
    given = parser.parse_args()
    print(f"{'scheme':<22}{'step':>8}{'energy error':>15}{'entropy fell':>15}{'cut':>6}  failed")
    for name, scheme in SCHEMES.items():
        for step in STEPS:
            error, fell, cut, failure = run(scheme(), step, given.until, given.conductance)
            print(f"{name:<22}{step:>8.3f}{error:>15.1e}{fell:>15.1e}{cut:>6}  {failure}", flush=True)
            if failure:
                break


if __name__ == "__main__":
    main()
