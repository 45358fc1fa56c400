"""Dzhanibekov's wing nut: a free body spinning about its middle axis flips over and over.

With principal moments 1, 2, 3 and a disturbance of 0.1 it flips every 11.498 s (half of Jacobi's period).
"""

from __future__ import annotations

import visviva as vv


def study(disturbance: float = 0.1, spin: float = 1.0, until: float = 40.0, step: float = 0.05) -> vv.Study:
    """A box with the principal moments 1, 2, 3, spinning about its second axis."""
    rate = (disturbance, spin, disturbance)
    box = vv.Box(size=(4.9, 3.46, 0.2))  # nearly the edges that belong to these moments
    body = vv.RigidBody(mass=1.0, inertia=(1, 2, 3), shape=box, angular_velocity=rate, name="body")
    system = vv.System([body])
    axes = {"d1": (1, 0, 0), "d2": (0, 1, 0), "d3": (0, 0, 1)}
    probes = {name: vv.Direction(of=body, axis=axis) for name, axis in axes.items()}
    return vv.Study(
        system, until, step, probes=probes, trails=("d2",), units="SI", title="Free body (Dzhanibekov)"
    )


def check(result: vv.Result) -> None:
    """Energy and all momenta."""
    result.assert_conserved("energy", "angular_x", "angular_y", "angular_z", "constraints")
