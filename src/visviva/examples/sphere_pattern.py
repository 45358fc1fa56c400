"""Spinodal decomposition on a sphere, in the manner of PFHub's benchmark 1d, which has a radius of 100.

The surface is closed: nothing has an end, and the amount of each component stays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def start(X: Array) -> Array:
    """The benchmark's concentration by polar and azimuthal angle, which jumps where the azimuth begins."""
    polar = np.arccos(np.clip(X[:, 2] / np.linalg.norm(X, axis=1), -1, 1))
    azimuth = np.arctan2(X[:, 1], X[:, 0]) % (2 * np.pi)
    waves = np.cos(8 * polar) * np.cos(15 * azimuth) + (np.cos(12 * polar) * np.cos(10 * azimuth)) ** 2
    return np.asarray(
        0.5 + 0.05 * (waves + np.cos(2.5 * polar - 1.5 * azimuth) * np.cos(7 * polar - 2 * azimuth))
    )


def study(radius: float = 20.0, count: int = 5, until: float = 20.0) -> vv.Study:
    """A sphere with eight times `count` quadratic cells along a great circle."""
    ball = vv.SphereMesh(radius=radius, counts=(count, 1), cell="hex27").build()
    alloy = vv.CahnHilliard(
        mesh=ball.surface("outer"),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=start,
        name="alloy",
    )
    return vv.Study(
        vv.System([alloy]),
        until,
        0.5,
        probes={"energy": vv.PhaseEnergy(body=alloy), "interfaces": vv.InterfaceArea(body=alloy)},
        fields=("concentration",),
        adaptive=vv.Adaptive(tolerance=2e-3, max_step=2.0),
        title="Phases on a sphere",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy falls in every step by what is dissipated; two phases are there."""
    assert result.conservation()["energy"] < 1e-9
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    (alloy,) = (c for c in result.system.components if isinstance(c, vv.CahnHilliard))
    c = alloy.values(result.system.x)
    assert c.max() - c.min() > 0.25, f"concentrations from {c.min():g} to {c.max():g}"
