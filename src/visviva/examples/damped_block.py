"""A viscoelastic block falls on the ground and bounces: what its stress loses warms it, to the last digit.

The rubber relaxes within a tenth of a second. All energy that the bounces lose is heat of the block.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

ROOM = 293.15
CAPACITY = 1.8e6


def study(
    height: float = 1.0,
    counts: tuple[int, int, int] = (3, 3, 3),
    until: float = 1.2,
    step: float = 0.004,
) -> vv.Study:
    """A cube of one metre, `height` above the ground, which takes no energy of impacts."""
    block = vv.ThermoviscoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=counts, origin=(0, 0, height)),
        material=vv.NeoHooke(young=3e5, poisson=0.4),
        density=1000.0,
        heat=vv.Heat(conductivity=0.2, capacity=CAPACITY, expansion=1e-4, reference=ROOM),
        branches=vv.prony((0.5,), (0.05,), shift=vv.Arrhenius(energy=40e3, reference=ROOM)),
        name="block",
    )
    floor = vv.Plane(name="floor")
    contact = vv.Contact(first=block, first_faces="z0", second=floor, impact="conserving", name="contact")
    parts = [block, floor, contact, vv.Gravity()]
    probes = {
        "warming": lambda s: float(block.temperatures(s.x).mean()) - ROOM,
        "entropy": lambda s: block.total_entropy(s.x),
    }
    return vv.Study(
        vv.System(parts),
        until,
        step,
        probes=probes,
        fields=("temperature",),
        title="A block that bounces and warms",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Energy is kept, although the bounces fade; entropy never falls."""
    (block,) = (c for c in result.system.components if isinstance(c, vv.ThermoviscoelasticSolid))
    result.assert_conserved("energy", tolerance=1e-9)
    entropy = np.array([block.total_entropy(x) for x in result.states])
    assert np.min(np.diff(entropy)) > -1e-12 * CAPACITY, "entropy fell"
    if np.abs(result.ledger["work_dissipated"]).max() > 1.0:  # it has come to the ground
        assert block.temperatures(result.states[-1]).mean() > ROOM, "the block did not warm"
