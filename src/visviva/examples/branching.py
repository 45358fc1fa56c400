"""Branching: a notched plate of glass is pulled at once; the crack runs to the right, and becomes two.

Borden, Verhoosel, Scott, Hughes & Landis (2012), section 4.2: 100 mm x 40 mm, a notch to the middle, 1 MPa on both long
sides from t = 0 on, E = 32 GPa, nu = 0.2, 2450 kg/m3, Gc = 3 J/m2, plane strain, spectral split, AT2. Their crack
branches at 34 to 46 us, and its tip is slower than 0.6 of Rayleigh's waves (2125 m/s). The upper half is computed; m,
s. Their length of 0.25 mm is half of `length` here, whose default is four times as large.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples.notch import lines

Array = NDArray[np.float64]
RAYLEIGH = 2125.0
WINDOW = 8e-6
"""Speeds are means over so long: the tip goes from node to node."""


def study(length: float = 2e-3, cells: float = 2.0, step: float = 1e-6, until: float = 60e-6) -> vv.Study:
    """`cells` per length ahead of the notch."""
    h = length / cells
    x = 0.1 * lines(0.45, 1.0, 10 * h, coarse=0.02)
    widths = tuple(np.diff(x))
    mesh = vv.RectangleMesh(size=(0.1, 0.02), counts=(len(x) - 1, round(0.02 / h)), grading=(widths, 1.0))
    ahead = mesh.build().with_nodes("ahead", lambda X: (X[:, 1] < 1e-9) & (X[:, 0] > 0.05 - 1e-9))
    plate = vv.FracturingSolid(
        mesh=ahead,
        material=vv.SaintVenantKirchhoff(young=32e9, poisson=0.2),
        density=2450.0,
        toughness=3.0,
        length=length,
        split="spectral",
        name="plate",
    )
    middle = vv.SymmetryPlane(solid=plate, nodes="ahead", normal=(0, 1, 0), name="middle")
    pull = vv.Traction(solid=plate, faces="y1", traction=(0, 1e6, 0), name="pull")
    return vv.Study(
        vv.System([plate, middle, pull]),
        until,
        step,
        probes={"tip": vv.CrackTip(solid=plate, along=(1, 0, 0)), "crack": vv.CrackEnergy(solid=plate)},
        fields=("damage", "von_mises"),
        title="Branching crack",
        notes=__doc__,
    )


def fronts(plate: vv.FracturingSolid, x: Array) -> tuple[float, float]:
    """How far the crack (d > 0.9) goes ahead, and above the middle."""
    cracked = plate.points[plate.damages(x) > 0.9]
    return cracked[:, 0].max(initial=0.05), cracked[:, 1].max(initial=0.0)


def branched(plate: vv.FracturingSolid, times: Array, states: list[Array]) -> tuple[float, float]:
    """When the crack has left the middle by more than the length, never if not, and the tip's largest speed."""
    tips, above = np.array([fronts(plate, x) for x in states]).T
    apart = above > 1.1 * plate.length
    begin = np.arange(0.0, times[-1] - WINDOW, 0.25 * WINDOW)
    way = np.interp(begin + WINDOW, times, tips) - np.interp(begin, times, tips)
    return float(times[np.argmax(apart)]) if apart.any() else np.inf, float(way.max(initial=0.0) / WINDOW)


def check(result: vv.Result) -> None:
    """Energy is in balance; the branch comes when it does with Borden et al., and the tip is slower than they say."""
    (plate,) = (c for c in result.system.components if isinstance(c, vv.FracturingSolid))
    assert result.conservation()["energy"] < 1e-10
    time, speed = branched(plate, np.asarray(result.times), list(result.states))
    assert speed < 0.6 * RAYLEIGH, f"{speed:g} m/s"
    if result.times[-1] >= 50e-6:
        assert 34e-6 < time < 46e-6, f"branches at {time:g} s"
        assert speed > 0.3 * RAYLEIGH
