"""A drop on a wall: half a disc that the wall's energy lets spread until it meets the wall under its angle.

In the plane a drop of area A becomes a piece of a disc of radius R with A = R^2 (angle - sin angle cos angle), and a
height of R (1 - cos angle).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


def study(angle: float = 60.0, radius: float = 12.0, count: int = 8, until: float = 1500.0) -> vv.Study:
    """Half of it, beside a plane of symmetry; `count` quadratic cells over the height."""

    def start(X: Array) -> Array:
        return np.asarray(0.5 + 0.2 * np.tanh(0.4472136 * (radius - np.hypot(X[:, 0], X[:, 1]))))

    drop = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(36, 18), counts=(2 * count, count), cell="quad9"),
        free_energy=vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
        gradient_energy=2.0,
        mobility=20.0,
        concentration=start,
        name="drop",
    )
    wall = vv.Wetting(body=drop, faces="y0", angle=angle, name="wall")
    return vv.Study(
        vv.System([drop, wall]),
        until,
        0.5,
        probes={"energy": vv.PhaseEnergy(body=drop), "area": vv.PhaseVolume(body=drop, above=0.5)},
        fields=("concentration",),
        adaptive=vv.Adaptive(tolerance=2e-3, max_step=until / 20),
        title="A drop on a wall",
        notes=__doc__,
    )


def height(drop: vv.CahnHilliard, x: Array) -> float:
    """Places of mean concentration on the plane of symmetry."""
    on = np.flatnonzero(drop.points[:, 0] < 1e-9)
    on = on[np.argsort(drop.points[on, 1])]
    return float(np.interp(-0.5, -drop.values(x)[on], drop.points[on, 1]))


def check(result: vv.Result) -> None:
    """The energy falls; the height at rest is that of the piece of a disc."""
    assert result.conservation()["energy"] < 1e-9
    drop, wall = result.system.components
    assert isinstance(drop, vv.CahnHilliard)
    assert isinstance(wall, vv.Wetting)
    if result.times[-1] < 1500 or wall.angle is None:
        return
    angle = np.radians(wall.angle)
    area = 2 * vv.PhaseVolume(body=drop, above=0.5)(result.system)
    R = np.sqrt(area / (angle - np.sin(angle) * np.cos(angle)))
    found = height(drop, result.system.x)
    assert abs(found / (R * (1 - np.cos(angle))) - 1) < 0.03, (
        f"height {found:g} of {R * (1 - np.cos(angle)):g}"
    )
