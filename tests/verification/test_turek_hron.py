"""The elastic flag of Turek & Hron (2006) alone: CSM1 and CSM2 at rest under gravity, CSM3 swinging.

Saint Venant-Kirchhoff, plane strain, nu = 0.4, rho = 1000; the flag is 0.02 high, ends at (0.6, 0.2) and is clamped on
the cylinder of radius 0.05 about (0.2, 0.2). References: high accuracy runs of nutils for CSM1 and CSM2; for CSM3
undamped runs (nutils: -14.63 +- 14.64 and -64.50 +- 65.18 mm at 1.094 Hz; finite volumes on 40320 cells: -14.578 +-
14.578 and -64.700 +- 64.732 mm, 1.0954 Hz).
"""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from verification.measure import extrapolated
from verification.solids import Array, displacement, static

END = (0.6, 0.2)


def flag(shear: float, n: int, m: int = 1) -> vv.Solid:
    """The flag with n x m cells of second order, its left side on the cylinder's arc."""
    flat = vv.RectangleMesh(size=(1, 1), counts=(n, m), cell="quad9").build()
    y = 0.19 + 0.02 * flat.points[:, 1]
    left = 0.2 + np.sqrt(0.05**2 - (y - 0.2) ** 2)
    mesh = vv.Mesh(
        np.column_stack([left + flat.points[:, 0] * (0.6 - left), y]), flat.cells, face_sets=flat.face_sets
    )
    material = vv.SaintVenantKirchhoff(shear=shear, poisson=0.4)
    return vv.Solid(mesh=mesh, material=material, density=1000.0)


def held(solid: vv.Solid) -> list[vv.component.component.Component]:
    return [solid, vv.Fixed(solid=solid, nodes="x0"), vv.Gravity(acceleration=(0, -2.0, 0))]


@pytest.mark.parametrize(
    ("shear", "u"),
    [(0.5e6, (-7.187190e-3, -66.099802e-3)), (2e6, (-0.468967e-3, -16.973193e-3))],
    ids=["CSM1", "CSM2"],
)
def test_at_rest(shear: float, u: tuple[float, float]) -> None:
    """Errors fall with the square of the cells' size; what is left after extrapolation is below 1e-4."""
    found = []
    for n in (40, 80):
        solid = flag(shear, n, n // 10)
        found.append(displacement(static(held(solid)), solid, END)[:2])
    assert np.all(np.abs(found[1] / u - 1) < 1.5e-3)
    np.testing.assert_allclose(extrapolated(found), u, rtol=1e-4)


def minima(values: Array, step: float) -> Array:
    """Times of the minima, by parabolas through three values; the first value is that of one step."""
    k = np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:])) + 1
    before, at, after = values[k - 1], values[k], values[k + 1]
    return np.asarray(step * (k + 1 + 0.5 * (before - after) / (before - 2 * at + after)))


def test_swinging() -> None:
    """CSM3 from rest; the energy-momentum scheme damps nothing."""
    solid, step = flag(0.5e6, 40, 4), 0.01
    seen: list[Array] = []
    result = vv.simulate(
        vv.System(held(solid)),
        until=2.5,
        step=step,
        every=10**9,
        observe=lambda s: seen.append(displacement(s, solid, END)[:2]),
    )
    u = 1e3 * np.array(seen)
    mean, amplitude = (u.max(axis=0) + u.min(axis=0)) / 2, (u.max(axis=0) - u.min(axis=0)) / 2
    assert mean == pytest.approx([-14.63, -64.50], rel=5e-3)
    assert amplitude == pytest.approx([14.64, 65.18], rel=5e-3)
    low = minima(u[:, 1], step)
    assert low[0] == pytest.approx(0.455, abs=0.006)
    assert (len(low) - 1) / (low[-1] - low[0]) == pytest.approx(1.094, rel=3e-3)
    assert result.conservation()["energy"] < 1e-11
