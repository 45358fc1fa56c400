"""Impact of two hollow tori, Hesch & Betsch (2012), section 4.2: 16,048 bricks, 72,216 unknowns, mortar with segments.

Major radius 76, outer minor radius 24, wall 4.5, neo-Hooke with E = 2250 and Poisson's ratio 0.3, density 0.1; the left
torus is thrown with (30, 0, 23). The paper does not say where the second torus is: here its axis is turned by a right
angle about x, so that the tubes cross, and its centre is at (225, 0, 46); without contact the tubes would touch first
at t = 1.02. The neo-Hooke energy is W = mu/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

import visviva as vv

COUNTS = {"full": (118, 34, 2), "coarse": (40, 12, 1)}
GALLERY = {"mesh": "coarse", "until": 2.0, "step": 0.02}


def study(
    mesh: Literal["full", "coarse"] = "full",
    impact: Literal["dissipative", "conserving"] = "dissipative",
    until: float = 5.0,
    step: float = 0.01,
) -> vv.Study:
    """The mesh of the paper or a coarse one; impact as in `visviva.Contact`."""
    source = vv.HollowTorusMesh(major_radius=76.0, outer_minor_radius=24.0, wall=4.5, counts=COUNTS[mesh])
    ring = source.build()
    other = ring.rotated(np.pi / 2, axis=(1, 0, 0)).moved((225.0, 0.0, 46.0))
    rubber = vv.NeoHooke(young=2250.0, poisson=0.3)
    left = vv.Solid(mesh=ring, material=rubber, density=0.1, velocity=(30, 0, 23), name="left")
    right = vv.Solid(mesh=other, material=rubber, density=0.1, name="right")
    contact = vv.Contact(
        first=left, second=right, first_faces="outer", second_faces="outer", impact=impact, name="contact"
    )
    probes = {
        "left_velocity": lambda s: left.nodal_mass @ left.velocities(s.x, s.v) / left.mass,
        "right_velocity": lambda s: right.nodal_mass @ right.velocities(s.x, s.v) / right.mass,
        "largest_pressure": lambda s: float(contact.pressures.max()),
        "active_gaps": lambda s: float(np.count_nonzero(contact.pressures)),
    }
    system = vv.System([left, right, contact])
    return vv.Study(
        system,
        until,
        step,
        probes=probes,
        moments=(2.0, 5.0),
        movie=True,
        title="Impact of two tori",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Momenta to round-off (angular ones start from zero: by the ring's radius); energy never grows."""
    ledger = result.ledger
    momentum = np.linalg.norm([ledger.first(f"momentum_{axis}") for axis in "xyz"])
    for axis in "xyz":
        assert ledger.swing(f"momentum_{axis}") < 1e-9 * momentum, f"linear momentum along {axis} changes"
        assert ledger.swing(f"angular_{axis}") < 1e-9 * 76 * momentum, (
            f"angular momentum about {axis} changes"
        )
    start = ledger.first("total")
    assert ledger.greatest("total") - start < 1e-9 * start, "energy has grown"
