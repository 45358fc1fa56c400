"""Flying spaghetti: a free, very flexible beam that is pushed and turned at one end, then left to itself.

The beam of Simo & Vu-Quoc (1988) leans in the plane of x and y. A force along x and a moment about a slanted axis grow
and fade within five seconds; from then on energy, momentum and angular momentum stay what they are.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

PULSE = [[0.0, 0.0], [2.5, 200.0], [5.0, 0.0]]


def study(
    count: int = 16, bending: float = 500.0, until: float = 10.0, step: float = 0.02, quadratic: bool = False
) -> vv.Study:
    """A beam of length 10 with `count` elements, of two nodes or, if `quadratic`, of three."""
    section = vv.GivenSection(
        stiffness=(1e4, 1e4, 1e4, bending, bending, bending),
        mass=1.0,
        moments=(10.0, 10.0, 0.0),
        outline=[(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)],
    )
    line = vv.LineMesh(points=[(6, 0, 0), (0, 8, 0)], count=count, cell="line3" if quadratic else "line2")
    beam = vv.Beam(mesh=line, section=section, first=(0, 0, 1), name="beam")
    end = beam.frame(0.0)
    push = vv.Force(on=end, force=(0.1, 0, 0), times=PULSE, name="push")
    turn = vv.Torque(on=end, torque=(0, -0.5, -1), times=PULSE, name="turn")
    probes = {
        "loaded_end": vv.Position(of=beam, at=(6, 0, 0)),
        "free_end": vv.Position(of=beam, at=(0, 8, 0)),
    }
    return vv.Study(
        vv.System([beam, push, turn]),
        until,
        step,
        vv.EnergyMomentum(),
        probes,
        trails=("loaded_end", "free_end"),
        title="Flying spaghetti",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """After the loads have gone nothing of energy and momenta changes."""
    t, ledger = np.array(result.ledger["time"]), result.ledger
    free = t >= 5.0 + 1e-9
    if not np.any(free):
        return
    for name in ("total", "momentum_x", "angular_x", "angular_y", "angular_z"):
        change = np.ptp(ledger[name][free])
        assert change <= 1e-9 * max(1.0, np.abs(ledger["total"]).max()), f"{name} changes by {change}"
