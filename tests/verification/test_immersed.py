"""Immersed solids against published paths and the body-fitted valve."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from discs import disc

import visviva as vv
from visviva.examples import valve, valve_3d


def test_soft_disc_in_a_driven_cavity() -> None:
    """Path of the centre up to the first passage under the lid: Sugiyama et al. 2011, Kolahduz et al. 2023.

    They give the smallest x as 0.2894 and 0.2869, the largest y as 0.8684 and 0.8756, the smallest y as 0.4936 and
    0.4892; read from figures, and apart by up to 0.008.
    """
    mesh = vv.RectangleMesh(size=(1, 1), counts=(32, 32), cell="quad4")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.01)
    rubber = vv.NeoHooke(young=0.29, poisson=0.45)  # shear modulus 0.1
    solid = vv.Solid(mesh=disc(0.2, (0.6, 0.5), 6), material=rubber, density=1.0)
    walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("x0", "x1", "y0")]
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=(1.0, 0.0, 0.0))
    system = vv.System(
        [fluid, lid, *walls, solid, vv.Immersed(solid=solid, fluid=fluid)], vv.Newton(tolerance=1e-9)
    )
    path, areas = [], []
    for _ in vv.march(system, until=5.2, step=0.04):
        path.append(solid.nodal_mass @ solid.positions(system.x)[:, :2] / solid.mass)
        areas.append(solid.volume(system.x) / solid.grid.volume)
    x, y = np.array(path).T
    assert x.min() == pytest.approx(0.288, abs=0.01)
    assert y[np.argmin(x)] == pytest.approx(0.735, abs=0.02)
    assert y.max() == pytest.approx(0.872, abs=0.01)
    assert y.min() == pytest.approx(0.4914, abs=0.005)
    assert np.abs(np.array(areas) - 1).max() < 0.02


@pytest.mark.parametrize("flaps", ["solid", "beam"])
def test_coarse_valve_opens_like_the_body_fitted_one(flaps: Any) -> None:
    """Tips at t = 0.3 (Kamensky et al. 2015, digitised twice: 0.579 +- 0.01, 0.403 +- 0.015) on half the paper's mesh;
    the flaps mirror each other, and what flows in passes between them to a hundredth."""
    study = valve.study(mesh="coarse", until=0.3, flaps=flaps)
    result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    valve.check(result)
    upper, lower = (np.array(study.probes[f"{side}_tip"](study.system))[:2] for side in ("upper", "lower"))  # type: ignore[operator]
    assert np.allclose(upper, lower * [1, -1], rtol=0, atol=1e-6)
    assert upper[0] == pytest.approx(0.579, abs=0.01)
    assert upper[1] == pytest.approx(0.403, abs=0.015)
    into = np.trapezoid(
        valve.inflow(0.3, np.linspace(0, valve.HEIGHT, 33)[:, None] * [0, 1, 0])[:, 0], dx=valve.HEIGHT / 32
    )
    assert study.probes["gap_flow"](study.system) == pytest.approx(into, rel=0.01)  # type: ignore[operator]


def test_valve_in_space_opens_symmetrically() -> None:
    """Flaps mirror each other in the plane between them, and themselves in the one across; volumes stay."""
    study = valve_3d.study(until=0.3)
    result = vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)
    valve_3d.check(result)
    x = study.system.x
    lower, upper = (s for s in study.system.components if isinstance(s, vv.Solid))
    mirror, side = (valve_3d.HEIGHT, 1), (valve_3d.WIDTH, 2)
    for a, b, (size, axis) in ((lower, upper, mirror), (lower, lower, side)):
        turned, X = b.positions(x).copy(), b.points.copy()
        turned[:, axis], X[:, axis] = size - turned[:, axis], size - X[:, axis]
        same = np.linalg.norm(X[:, None] - a.points, axis=2).argmin(axis=0)
        assert np.allclose(turned[same], a.positions(x), rtol=0, atol=1e-5)
    assert 0.1 < float(study.probes["lower_tip"](study.system)[0]) < 0.2  # type: ignore[operator]
    assert vv.Volume(solid=lower)(study.system) == pytest.approx(0.7 * 0.6 * 0.2, rel=0.01)
