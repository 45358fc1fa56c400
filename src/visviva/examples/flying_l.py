"""The flying L with hot and cold faces: pushed, it flies off spinning and bending while heat levels out within.

An L with legs of 6 and 10, 3 thick, is pushed at both its ends for one unit of time and then left alone. From there
on energy and momenta are kept to round-off, and entropy grows in every step, as it does while it is pushed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import visviva as vv

MU, BULK = 997.5, 5209.0
FORCE = np.array([256.0, 512.0, 768.0])


def mesh(cells: int) -> vv.Mesh:
    """Legs 0..6 along x and 0..10 along y, 3 thick, `cells` of them across."""
    parts = [((3, 3, 3), (0, 0, 0)), ((3, 3, 3), (3, 0, 0)), ((3, 7, 3), (0, 3, 0))]
    whole: vv.Mesh | None = None
    for size, at in parts:
        counts = (cells, cells * (2 if size[1] == 7 else 1), cells)
        box = vv.BoxMesh(size=size, counts=counts, origin=at).build()
        bare = vv.Mesh(box.points, box.cells)
        whole = bare if whole is None else whole.merged(bare, weld=1e-6)
    assert whole is not None
    named = whole.with_faces("top", lambda X: X[:, 1] > 10 - 1e-9)
    return named.with_faces("right", lambda X: X[:, 0] > 6 - 1e-9)


def study(
    cells: int = 2,
    hot: float = 313.15,
    cold: float = 273.15,
    conductivity: float = 10.0,
    viscous: bool = False,
    until: float = 15.0,
    step: float = 0.05,
) -> vv.Study:
    """Its faces start `hot` and `cold`; with `viscous` its stress relaxes, too, and warms it."""
    room = 293.15

    def start(X: np.ndarray) -> np.ndarray:
        warm = (hot - room) * np.exp(X[:, 1] - 10) + (cold - room) * np.exp(X[:, 0] - 6)
        return np.asarray(room + warm)

    heat = vv.Heat(conductivity=conductivity, capacity=100.0, expansion=2.233e-4, reference=room)
    material = vv.MooneyRivlin(c10=5 / 12 * MU, c01=MU / 12, bulk=BULK)
    given: dict[str, Any] = {
        "mesh": mesh(cells),
        "material": material,
        "density": 10.0,
        "heat": heat,
        "temperature": start,
    }
    branches = (vv.MaxwellBranch(time=4.0, spring=vv.NeoHooke(shear=227.2 / 3, bulk=1.0)),)
    body = (
        vv.ThermoviscoelasticSolid(**given, branches=branches, name="L")
        if viscous
        else vv.ThermoelasticSolid(**given, name="L")
    )
    hat = "max(0, min(t, 1 - t))"
    loads = [
        vv.Traction(solid=body, faces=faces, traction=sign * FORCE / 9, times=hat, name=f"push {faces}")
        for faces, sign in (("top", 1.0), ("right", -1.0))
    ]
    probes = {
        "coldest": lambda s: float(body.temperatures(s.x).min()),
        "hottest": lambda s: float(body.temperatures(s.x).max()),
        "entropy": lambda s: body.total_entropy(s.x),
    }
    return vv.Study(
        vv.System([body, *loads]),
        until,
        step,
        probes=probes,
        fields=("temperature",),
        title="Flying L, hot and cold",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Entropy never falls; once it flies alone, energy and momenta stay; what pushed it has worked as booked."""
    (body,) = (c for c in result.system.components if isinstance(c, vv.ThermoelasticSolid))
    assert result.ledger.imbalance() < 1e-10, "the balance of energy is open"
    entropy = np.array([body.total_entropy(x) for x in result.states])
    assert np.min(np.diff(entropy)) > 0, "entropy fell"
    free = result.ledger["time"] > 1 + 1e-9
    if not free.any():
        return
    for name in ("total", *(f"{kind}_{axis}" for kind in ("momentum", "angular") for axis in "xyz")):
        values = result.ledger[name]
        size = max(np.abs(values).max(), 1.0)
        assert np.ptp(values[free]) < 1e-9 * size, f"{name} did not stay"
