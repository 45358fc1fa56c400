"""Coarsening in space: a random alloy of two fifths separates in a periodic cube, then large domains eat small ones.

Energy and interfaces shrink while the wavelength of the domains grows; the amount of each component stays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def study(count: int = 8, size: float = 17.6, until: float = 40.0, seed: int = 1) -> vv.Study:
    """A cube of `size` with `count` linear cells along each edge."""

    def start(X: Array) -> Array:
        return np.asarray(0.46 + 0.02 * np.random.default_rng(seed).standard_normal(len(X)))

    alloy = vv.CahnHilliard(
        mesh=vv.BoxMesh(size=(size, size, size), counts=(count, count, count)),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=start,
        periodic=(("x0", "x1"), ("y0", "y1"), ("z0", "z1")),
        name="alloy",
    )
    return vv.Study(
        vv.System([alloy]),
        until,
        0.5,
        probes={
            "energy": vv.PhaseEnergy(body=alloy),
            "interfaces": vv.InterfaceArea(body=alloy),
            "rich": vv.PhaseVolume(body=alloy, above=0.5),
            "wavelength": vv.DomainSize(body=alloy),
        },
        fields=("concentration",),
        adaptive=vv.Adaptive(tolerance=2e-3, max_step=5.0),
        title="Coarsening of an alloy",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy falls, the mass stays, two phases are there."""
    assert result.conservation()["energy"] < 1e-9
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    (alloy,) = (c for c in result.system.components if isinstance(c, vv.CahnHilliard))
    c = alloy.values(result.system.x)
    assert c.min() < 0.35, f"least concentration {c.min():g}"
    assert c.max() > 0.6, f"largest concentration {c.max():g}"
