"""Stress against stretch of every material, by forces on a cube, against closed forms in principal stretches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from reference import hyperelastic as h

import visviva as vv
from verification.solids import homogeneous, patch, static

LAM, MU, BULK = 4.0, 3.0, 15.0
ANGLE = 0.6


def rubber(C: Any) -> Any:
    """A user's neo-Hooke energy, for C11, C22, C33, C12, C23, C31."""
    det = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    log_j = 0.5 * np.log(det + C[5] * (C[3] * C[4] - C[1] * C[5]))
    return MU / 2 * (C[0] + C[1] + C[2] - 3) - MU * log_j + LAM / 2 * log_j**2


FIBRES = ((np.cos(ANGLE), np.sin(ANGLE), 0), (np.cos(ANGLE), -np.sin(ANGLE), 0))
CASES: dict[str, tuple[vv.Material, h.Energy]] = {
    "saint_venant": (vv.SaintVenantKirchhoff(lame_lambda=LAM, shear=MU), h.saint_venant(LAM, MU)),
    "neo_hooke": (vv.NeoHooke(lame_lambda=LAM, shear=MU), h.neo_hooke(LAM, MU)),
    "neo_hooke_split": (
        vv.NeoHooke(bulk=BULK, shear=MU, isochoric=True, volumetric="simo"),
        h.mooney(MU / 2, 0.0, BULK),
    ),
    "mooney": (vv.MooneyRivlin(c10=1.0, c01=0.4, bulk=BULK), h.mooney_coupled(1.0, 0.4, BULK)),
    "mooney_split": (
        vv.MooneyRivlin(c10=1.0, c01=0.4, bulk=BULK, isochoric=True, volumetric="simo"),
        h.mooney(1.0, 0.4, BULK),
    ),
    "yeoh": (vv.Yeoh(c1=1.0, c2=-0.05, c3=0.02, bulk=BULK), h.yeoh((1.0, -0.05, 0.02), BULK)),
    "gent": (vv.Gent(shear=MU, limit=20.0, bulk=BULK), h.gent(MU, 20.0, BULK)),
    "ogden": (
        vv.Ogden(mu=(1.5, -0.5, 0.2), alpha=(1.8, -2.0, 5.0), bulk=BULK),
        h.ogden((1.5, -0.5, 0.2), (1.8, -2.0, 5.0), BULK),
    ),
    "blatz_ko": (vv.BlatzKo(shear=MU, poisson=0.3), h.blatz_ko(MU, 0.3)),
    "holzapfel": (
        vv.HolzapfelGasserOgden(shear=MU, k1=1.0, k2=0.3, bulk=BULK, fibres=FIBRES, dispersion=0.1),
        h.fibred(MU, 1.0, 0.3, 0.1, BULK, ANGLE),
    ),
    "user": (vv.UserMaterial(function=rubber), h.neo_hooke(LAM, MU)),
}
MODES = {
    "uniaxial": lambda l: {0: l},
    "equibiaxial": lambda l: {0: l, 1: l},
    "planar": lambda l: {0: l, 1: 1.0},
}
STRETCHES = (0.75, 1.3, 1.7)


def cube(material: vv.Material, given: dict[int, float], pressure: float = 0.0) -> tuple[vv.Solid, vv.System]:
    """The first octant of a cube: three faces slide, some are moved, a pressure on the others follows them."""
    solid = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=material)
    parts: list[Any] = [solid]
    for k, name in enumerate("xyz"):
        parts.append(vv.SymmetryPlane(solid=solid, nodes=f"{name}0", normal=np.eye(3)[k]))
        if k in given:
            motion: list[str | None] = [None, None, None]
            motion[k] = f"{given[k] - 1!r} * t"
            parts.append(vv.Prescribed(solid=solid, nodes=f"{name}1", motion=tuple(motion)))
        elif pressure:
            parts.append(vv.Pressure(solid=solid, faces=f"{name}1", pressure=f"{pressure} * t"))
    return solid, static(parts, step=0.25)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", CASES)
def test_forces_on_a_cube(name: str, mode: str) -> None:
    material, W = CASES[name]
    for stretch in STRETCHES:
        if name == "saint_venant" and stretch > 1.5:
            continue  # no lateral stretch balances it
        given = MODES[mode](stretch)
        l, P = h.state(W, given)
        solid, system = cube(material, given)
        corner = solid.positions(system.x).max(axis=0)
        np.testing.assert_allclose(corner, l, atol=1e-9)
        for k, side in enumerate("xyz"):
            force = vv.SupportForce(solid=solid, nodes=f"{side}1")(system)[k] if k in given else 0.0
            area_force = P[k] if k in given else 0.0
            assert force == pytest.approx(area_force, abs=1e-8), (stretch, side)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("pressure", [1.0, -0.8])
def test_pressure_all_round(name: str, pressure: float) -> None:
    """Follower pressure on three faces; the others push back as much."""
    material, W = CASES[name]
    l, _ = h.state(W, {}, pressure)
    solid, system = cube(material, {}, pressure)
    np.testing.assert_allclose(solid.positions(system.x).max(axis=0), l, atol=1e-9)
    np.testing.assert_allclose(solid.nodal("pressure", system.x), pressure, atol=1e-9)


@pytest.mark.parametrize("shear", [0.3, 1.2])
def test_simple_shear(shear: float) -> None:
    """Neo-Hooke: s12 = mu g, s11 - s22 = mu g^2 at any volumetric law, as J = 1."""
    for name in ("neo_hooke", "neo_hooke_split", "blatz_ko", "user"):
        solid = vv.Solid(mesh=patch("hex8"), material=CASES[name][0])
        system = static([solid, homogeneous(solid, [[1, shear, 0], [0, 1, 0], [0, 0, 1]])], step=0.5)
        s = solid.nodal("cauchy", system.x)
        np.testing.assert_allclose(s[:, 3], MU * shear, atol=1e-11)
        np.testing.assert_allclose(s[:, 0] - s[:, 1], MU * shear**2, atol=1e-11)


def test_reference_against_the_table() -> None:
    """E = 1, nu = 0.3: lateral stretch and nominal stress at stretch 2, uniaxial and equibiaxial."""
    W = h.neo_hooke(0.3 / (1.3 * 0.4), 1 / 2.6)
    (_, lateral, _), (P, _, _) = h.state(W, {0: 2.0})
    assert (lateral, P) == pytest.approx((0.7980775445, 0.6467446602), abs=1e-10)
    (_, _, lateral), (P, _, _) = h.state(W, {0: 2.0, 1: 2.0})
    assert (lateral, P) == pytest.approx((0.4303711698, 0.7336116647), abs=1e-10)
