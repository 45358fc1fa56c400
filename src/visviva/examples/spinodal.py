"""Spinodal decomposition: benchmark 1a of PFHub, a square of an alloy that separates, periodic.

The energy is compared with that of a pseudo-spectral solution (ETD-RK4, 256 x 256 waves, tolerance 1e-5). The initial
field jumps where the square meets itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
ENERGIES = {1.0: 318.8603859, 5.0: 316.4181572, 10.0: 297.9668415, 20.0: 212.9302774, 30.0: 196.7024732,
            50.0: 167.3638131, 100.0: 136.9816489, 1000.0: 84.8407404, 10000.0: 33.0785263}  # fmt: skip
"""Of the spectral solution, by time."""


def start(X: Array) -> Array:
    """The concentration at the start."""
    x, y = X[:, 0], X[:, 1]
    waves = np.cos(0.105 * x) * np.cos(0.11 * y) + (np.cos(0.13 * x) * np.cos(0.087 * y)) ** 2
    return np.asarray(0.5 + 0.01 * (waves + np.cos(0.025 * x - 0.15 * y) * np.cos(0.07 * x - 0.02 * y)))


def study(count: int = 50, cell: str = "quad9", until: float = 20.0, tolerance: float = 1e-3) -> vv.Study:
    """A square of 200 with `count` cells along each side; steps by their error from 0.5 on."""
    alloy = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(200, 200), counts=(count, count), cell=cell),  # type: ignore[arg-type]
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=5.0,
        concentration=start,
        periodic=(("x0", "x1"), ("y0", "y1")),
        name="alloy",
    )
    return vv.Study(
        vv.System([alloy]),
        until,
        0.5,
        probes={"energy": vv.PhaseEnergy(body=alloy), "interfaces": vv.InterfaceArea(body=alloy)},
        fields=("concentration",),
        adaptive=vv.Adaptive(tolerance=tolerance, max_step=max(until / 20, 0.5)),
        title="Spinodal decomposition",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy falls in every step by what is dissipated; at the end it is that of the spectral solution."""
    assert result.conservation()["energy"] < 1e-9
    energy = result.ledger["potential_stored"]
    assert np.all(np.diff(energy) < 0)
    reference = ENERGIES.get(round(float(result.times[-1]), 6))
    if reference is not None:
        assert abs(energy[-1] / reference - 1) < 0.02, f"energy {energy[-1]:g}, spectral {reference:g}"
