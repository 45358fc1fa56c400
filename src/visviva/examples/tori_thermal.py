"""Impact of two hollow tori, one of them hot: contact conducts.

The tori of Hesch & Betsch (2012), section 4.2, on a coarse mesh, here of a material that stores and conducts heat; the
left one is hot, expanded, and thrown at the cold one. Heat passes where they touch, the more the harder they press.
Energy is that of motion, strain and heat together; entropy never falls.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

COLD, HOT = 293.15, 393.15
GALLERY = {"around": 20, "until": 1.6}


def study(around: int = 40, until: float = 4.0, step: float = 0.02, conductance: float = 0.05) -> vv.Study:
    """So many cells `around` each torus; conductance by pressure (per area, temperature and pressure)."""
    counts = (around, max(8, 3 * around // 10), 1)
    ring = vv.HollowTorusMesh(major_radius=76.0, outer_minor_radius=24.0, wall=4.5, counts=counts).build()
    other = ring.rotated(np.pi / 2, axis=(1, 0, 0)).moved((225.0, 0.0, 46.0))
    rubber = vv.NeoHooke(young=2250.0, poisson=0.3)
    warm = vv.Heat(conductivity=5.0, capacity=1.0, expansion=1e-4, reference=COLD)
    left = vv.ThermoelasticSolid(
        mesh=ring, material=rubber, density=0.1, heat=warm, temperature=HOT, velocity=(30, 0, 23), name="left"
    )
    right = vv.ThermoelasticSolid(mesh=other, material=rubber, density=0.1, heat=warm, name="right")
    contact = vv.Contact(
        first=left,
        second=right,
        first_faces="outer",
        second_faces="outer",
        impact="conserving",
        name="contact",
    )
    touching = vv.HeatContact(contact=contact, conductance=lambda p: conductance * p, name="touching")
    probes = {
        "heat_per_time": lambda s: float(touching.heat.sum()),
        "hottest_of_right": lambda s: float(right.temperatures(s.x).max()),
        "entropy": lambda s: left.total_entropy(s.x) + right.total_entropy(s.x),
    }
    return vv.Study(
        vv.System([left, right, contact, touching]),
        until,
        step,
        probes=probes,
        fields=("temperature",),
        movie=True,
        title="Impact of a hot torus on a cold one",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Momenta and energy to round-off, and the cold torus is warmer where it was hit."""
    ledger = result.ledger
    momentum = np.linalg.norm([ledger.first(f"momentum_{axis}") for axis in "xyz"])
    for axis in "xyz":
        assert ledger.swing(f"momentum_{axis}") < 1e-9 * momentum, f"linear momentum along {axis} changes"
    result.assert_conserved("energy", tolerance=1e-9)
    _, right = (c for c in result.system.components if isinstance(c, vv.ThermoelasticSolid))
    if result.times[-1] > 2.5:
        assert right.temperatures(result.system.x).max() > COLD + 2
