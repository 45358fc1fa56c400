"""What each scheme does to plain rotation: a free rotor, a heavy top and a slider-crank over many turns.

``python benchmarks/rotation.py`` prints the table of docs/theory/schemes.rst. All mechanisms conserve energy: it says
what part of it is lost (minus: gained) in so many turns, in steps of an angle of 0.1.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np

import visviva as vv
from visviva.examples import heavy_top, slider_crank

RATE = 10.0
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


def rotor() -> vv.System:
    """A free body that spins about an axis of its inertia, `RATE` turns in 2 pi units of time."""
    return vv.System([vv.RigidBody(mass=1.0, inertia=(1, 2, 2.5), angular_velocity=(0, 0, RATE))])


def top() -> vv.System:
    """The heavy top, spinning with `RATE` about its axis and precessing slowly."""
    return vv.System(heavy_top.study(spin=RATE, precession=-0.2, gravity=0.1).system.components)


def crank() -> vv.System:
    """The slider-crank without its motor, running freely."""
    parts = slider_crank.study(rate=RATE).system.components
    return vv.System([c for c in parts if not isinstance(c, vv.Motor)])


MECHANISMS: dict[str, Callable[[], vv.System]] = {
    "free rotor": rotor,
    "heavy top": top,
    "slider-crank": crank,
}


def run(system: vv.System, scheme: vv.Scheme, turns: int, angle: float = 0.1) -> tuple[float, float]:
    """Part of the kinetic energy lost in so many turns, and the violation of the constraints' rates at the end."""
    h = angle / RATE
    result = vv.simulate(
        system, until=round(turns * 2 * np.pi / angle) * h, step=h, scheme=scheme, every=10**9
    )
    ledger = result.ledger
    lost = (ledger["total"][0] - ledger["total"][-1]) / ledger["kinetic"][0]
    return float(lost), float(ledger["defect_velocity"][-1] / RATE)


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
