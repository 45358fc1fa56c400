"""Branching: a notched plate of glass is pulled at once; the crack runs to the right, and becomes two.

Borden, Verhoosel, Scott, Hughes & Landis (2012), section 4.2: 100 mm x 40 mm, a notch to the middle, 1 MPa on both long
sides from t = 0 on, E = 32 GPa, nu = 0.2, 2450 kg/m3, Gc = 3 J/m2, plane strain, spectral split, AT2. Their crack
branches at 34 to 46 us, and its tip is slower than 0.6 of Rayleigh's waves (2125 m/s). Here is the upper half, which
has half of the energy. Their length is 0.25 mm; that of the default is four times as large, on cells of half of it.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

RAYLEIGH = 2125.0  # m/s


def study(length: float = 1e-3, cells: float = 2.0, until: float = 80e-6, step: float = 0.0) -> vv.Study:
    """`cells` per length ahead of the notch; the step by default lets waves pass half a cell."""
    h = length / cells
    ahead = np.arange(0.046, 0.1 + 0.5 * h, h)
    behind = [ahead[0]]
    while behind[-1] > 0:
        behind.append(behind[-1] - min(1.2 ** len(behind) * h, 2e-3))
    x = np.concatenate([np.linspace(0, 1, len(behind))[:0], np.array(behind[::-1])[1:], ahead[1:]])
    x = np.concatenate([[0.0], x[x > 0.3 * h]])
    counts = len(x) - 1, round(0.02 / h)
    unit = vv.RectangleMesh(size=(1, 0.02), counts=counts).build()
    place = np.stack([np.interp(unit.points[:, 0], np.linspace(0, 1, len(x)), x), unit.points[:, 1]], axis=1)
    mesh = vv.Mesh(place, unit.cells, face_sets=unit.face_sets)
    mesh = mesh.with_nodes("ahead", lambda X: (X[:, 1] < 1e-9) & (X[:, 0] > 0.05 - 1e-9))
    plate = vv.FracturingSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=32e9, poisson=0.2),
        density=2450.0,
        toughness=3.0,
        length=length,
        split="spectral",
        name="plate",
    )
    middle = vv.SymmetryPlane(solid=plate, nodes="ahead", normal=(0, 1, 0), name="middle")
    pull = vv.Traction(solid=plate, faces="y1", traction=(0, 1e6, 0), name="pull")
    probes = {
        "tip": vv.CrackTip(solid=plate, along=(1, 0, 0)),
        "highest": vv.CrackTip(solid=plate, along=(0, 1, 0)),
        "crack": vv.CrackEnergy(solid=plate),
    }
    system = vv.System([plate, middle, pull])
    h_step = step or 0.5 * h / 3800.0
    fields = ("damage", "von_mises")
    return vv.Study(
        system,
        until,
        h_step,
        probes=probes,
        fields=fields,
        moments=(40e-6,),
        title="Branching",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Kinetic, elastic and crack energy change by the work of the load alone; the tip is slower than it may be."""
    (plate,) = (c for c in result.system.components if isinstance(c, vv.FracturingSolid))
    assert result.conservation()["energy"] < 1e-9
    found = []
    for t, x in zip(result.times, result.states, strict=True):
        cracked = plate.points[plate.damages(x) > 0.9]
        found.append((t, cracked[:, 0].max(initial=0.0)))
    t, tip = np.array(found).T
    running = (tip > 0.055) & (tip < 0.095)
    if running.sum() > 2:
        speed = np.polyfit(t[running], tip[running], 1)[0]
        assert 0.1 * RAYLEIGH < speed < 0.6 * RAYLEIGH
