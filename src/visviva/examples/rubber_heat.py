"""A rubber band that is stretched fast warms, and cools when it is let go (Gough and Joule).

Its elasticity is entropic, its free energy `mu T / T0 (tr C - 3) / 2`: pulled to a few times its length it warms by
`T0 (exp(mu (l^2 + 2 / l - 3) / 2 c T0) - 1)`. Here its end is pulled within 20 ms and then held, so that waves go back
and forth, which make it warmer here than there.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

SHEAR, CAPACITY, ROOM = 0.4e6, 1.8e6, 293.15


def study(
    stretch: float = 3.0,
    counts: tuple[int, int, int] = (16, 2, 1),
    pull: float = 0.02,
    until: float = 0.06,
    step: float = 0.0005,
) -> vv.Study:
    """A band of 100 x 10 x 2 mm whose end is pulled to `stretch` times its length within `pull` seconds, and held."""
    mesh = vv.BoxMesh(size=(0.1, 0.01, 0.002), counts=counts)
    heat = vv.Heat(conductivity=0.2, capacity=CAPACITY, reference=ROOM, moduli_slope=1 / ROOM)
    rubber = vv.NeoHooke(shear=SHEAR, bulk=4e7)
    band = vv.ThermoelasticSolid(mesh=mesh, material=rubber, density=950.0, heat=heat, name="band")
    way = 0.1 * (stretch - 1)
    grip = vv.Prescribed(
        solid=band, nodes="x1", motion=(f"{way!r}*smoothstep(t/{pull!r})", None, None), name="grip"
    )
    wall = vv.SymmetryPlane(solid=band, nodes="x0", normal=(1, 0, 0), name="wall")
    sides = [
        vv.SymmetryPlane(solid=band, nodes=f"{axis}0", normal=np.eye(3)[k], name=f"side {axis}")
        for k, axis in ((1, "y"), (2, "z"))
    ]
    probes = {
        "temperature": vv.TemperatureAt(body=band, at=(0.05, 0.005, 0.001)),
        "force": vv.SupportForce(solid=band, nodes="x1"),
    }
    return vv.Study(
        vv.System([band, grip, wall, *sides]),
        until,
        step,
        probes=probes,
        fields=("temperature",),
        title="A rubber band that is stretched warms",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Energy is balanced, and the band is as warm as one that is stretched evenly without exchange of heat."""
    (band,) = (c for c in result.system.components if isinstance(c, vv.ThermoelasticSolid))
    assert result.ledger.imbalance() < 1e-9, "the balance of energy is open"
    x = result.states[-1]
    length = np.ptp(band.positions(x)[:, 0]) / 0.1
    even = ROOM * np.expm1(SHEAR * (length**2 + 2 / length - 3) / (2 * CAPACITY * ROOM))
    found = float(band.temperatures(x).mean()) - ROOM
    assert abs(found - even) < 0.01 * even, f"it warmed by {found:.4f} K, not by {even:.4f}"
