"""Mechanisms that rotate for many turns, for tests and ``benchmarks/rotation.py``; all of them conserve energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import visviva as vv
from visviva.examples import heavy_top, slider_crank

RATE = 10.0


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
