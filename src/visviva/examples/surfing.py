"""Surfing crack: a strip along which the field of a moving crack tip goes tells what cells add to the toughness.

All of the boundary follows the displacements of the mode I field of a tip that moves (Hossain, Hsueh, Bourdin &
Bhattacharya 2014). The crack, along a row of cells, follows at the same speed; its energy grows per length by
Gc (1 + h / 2l) with AT2 and Gc (1 + 3h / 8l) with AT1 (Bourdin, Francfort & Marigo 2008).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

YOUNG, POISSON, TOUGHNESS = 1.0, 0.2, 1e-8
WIDTH, HALF, NOTCH = 1.0, 0.3, 0.25
EXCESS = 1.2
"""Energy release rate of the field by the toughness."""


def field(X: Array, tip: float) -> Array:
    """Displacements (n, 3) in plane strain of the mode I field of a tip at (tip, 0)."""
    x, y = X[:, 0] - tip, X[:, 1]
    r, a = np.hypot(x, y), np.arctan2(y, x)
    mu, kappa = YOUNG / (2 * (1 + POISSON)), 3 - 4 * POISSON
    intensity = np.sqrt(EXCESS * TOUGHNESS * YOUNG / (1 - POISSON**2))
    size = intensity / (2 * mu) * np.sqrt(r / (2 * np.pi)) * (kappa - np.cos(a))
    return np.stack([size * np.cos(a / 2), size * np.sin(a / 2), 0 * a], axis=1)


def profile(distance: Array, model: str) -> Array:
    """The best damage at a distance, by the length, from what is broken."""
    return np.asarray(np.maximum(1 - distance / 2, 0) ** 2 if model == "AT1" else np.exp(-distance))


def strip_mesh(length: float, h: float) -> vv.Mesh:
    """A row of cells of size h along y = 0, as fine cells around it, and coarser ones beyond twice the length."""
    rows = [h / 2]
    while rows[-1] < HALF:
        rows.append(rows[-1] + (h if rows[-1] < 2 * length else min(1.3 * (rows[-1] - rows[-2]), 0.05)))
    y = np.concatenate([-np.array(rows)[::-1], rows])
    unit = vv.RectangleMesh(size=(WIDTH, 1), counts=(round(WIDTH / h), len(y) - 1)).build()
    j = np.rint(unit.points[:, 1] * (len(y) - 1)).astype(int)
    return vv.Mesh(np.stack([unit.points[:, 0], y[j]], axis=1), unit.cells, face_sets=unit.face_sets)


def study(
    model: Literal["AT1", "AT2"] = "AT2",
    length: float = 0.04,
    cells: float = 4.0,
    until: float = 0.45,
    step: float = 0.01,
) -> vv.Study:
    """`cells` per `length` where the crack runs."""
    h = length / cells

    def broken(X: Array) -> Array:
        beside, ahead = np.maximum(np.abs(X[:, 1]) - h / 2, 0), np.maximum(X[:, 0] - NOTCH, 0)
        return profile(beside / length, model) * profile(ahead / length, model)

    strip = vv.FracturingSolid(
        mesh=strip_mesh(length, h),
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=length,
        model=model,
        damage=broken,
        name="strip",
    )
    sides = np.unique(np.concatenate([strip.nodes(name) for name in ("x0", "x1", "y0", "y1")]))
    motion = lambda t, X: field(X, NOTCH - 0.1 + t) * min(t / 0.05, 1.0)  # noqa: E731
    around = vv.Prescribed(solid=strip, nodes=sides, motion=motion, name="around")
    probes = {"tip": vv.CrackTip(solid=strip, along=(1, 0, 0)), "crack": vv.CrackArea(solid=strip)}
    scheme = vv.AlternateMinimization(newton=2, unstable=True, energy_tolerance=1e-6)
    system = vv.System([strip, around])
    fields = ("damage", "von_mises")
    return vv.Study(system, until, step, scheme, probes, fields=fields, title="Surfing crack", notes=__doc__)


def toughness(result: vv.Result) -> tuple[float, float, float]:
    """Energy of the crack and work of the boundary less elastic energy per length, and Gc with what cells add."""
    (strip,) = (c for c in result.system.components if isinstance(c, vv.FracturingSolid))
    probe, found = vv.CrackTip(solid=strip, along=(1, 0, 0)), []
    now = result.system.x.copy()
    for x in result.states:
        result.system.x[:] = x
        found.append((probe(result.system)[0], strip.crack_energy(x)))
    result.system.x[:] = now
    tip, energy = np.array(found).T
    steady = (tip > NOTCH + 3 * strip.length) & (tip < WIDTH - 6 * strip.length)
    ends = np.flatnonzero(steady)[[0, -1]]
    elastic = result.ledger["potential_stored"] - energy
    released = result.ledger["work_prescribed motion"] - elastic
    by_energy, by_work = (float(np.diff(a[ends])[0] / np.diff(tip[ends])[0]) for a in (energy, released))
    h = 2 * float(np.abs(strip.grid.points[:, 1]).min())
    share = (0.5 if strip.model == "AT2" else 0.375) * h / strip.length
    return by_energy, by_work, TOUGHNESS * (1 + share)


def check(result: vv.Result) -> None:
    """Both are those of Bourdin, Francfort & Marigo within 2 %."""
    if result.times[-1] < 0.4:
        return
    by_energy, by_work, expected = toughness(result)
    np.testing.assert_allclose((by_energy, by_work), expected, rtol=0.02)
