"""The examples of flow against published values: driven cavity, cylinder in a channel; profiles that oscillate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import cavity, cylinder

Array = NDArray[np.float64]


def ended(study: vv.Study) -> vv.Result:
    return vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme)


@pytest.mark.parametrize(
    ("reynolds", "count", "elements", "most"),
    [(100, 12, "Q2Q1", 3e-3), (400, 20, "P2P1", 2e-3), (1000, 24, "Q2Q1", 1e-3), (100, 32, "Q1Q1", 1e-2)],
)
def test_cavity(reynolds: float, count: int, elements: str, most: float) -> None:
    """Velocities on the centre line; at the Reynolds number 1000 those of Botella & Peyret 1998."""
    result = ended(cavity.study(reynolds, count, elements))
    assert np.abs(cavity.deviations(result)).max() < most
    assert result.ledger.imbalance() < 1e-12
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    sides = [vv.FlowRate(fluid=water, faces=s)(result.system) for s in ("x0", "x1", "y0", "y1")]
    assert np.abs(sides).max() < 1e-15


def test_cavity_holds_its_lid_and_walls_in_balance() -> None:
    """Steady: the forces on lid and walls add up to nothing."""
    result = ended(cavity.study(100, 8))
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    whole = vv.FlowForce(fluid=water, faces="all")(result.system)
    lid = vv.FlowForce(fluid=water, faces="y1")(result.system)
    assert lid[0] < -0.1
    assert np.abs(whole).max() < 1e-2 * abs(lid[0])  # as well as the divergence vanishes within elements


def test_steady_cylinder() -> None:
    """Benchmark 2D-1 of Schaefer & Turek: 5000 unknowns meet the drag to 1e-4."""
    result = ended(study := cylinder.study("2D-1", fine=5))
    cylinder.check(result)
    drag, lift = study.probes["drag_and_lift"](study.system)
    assert drag == pytest.approx(cylinder.DRAG, rel=1e-4)
    assert lift == pytest.approx(cylinder.LIFT, rel=5e-3)
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    into, out = (vv.FlowRate(fluid=water, faces=s)(result.system) for s in ("x0", "x1"))
    assert out == pytest.approx(-into, rel=1e-12)


# --- Womersley 1955, plane ----------------------------------------------------------------------------------
HALF, NU, G0, G1 = 0.5, 0.01, 0.08, 0.4


def womersley(t: float, y: Array) -> Array:
    """Velocities between plates at y = -0.5 and 0.5 under the force G0 + G1 cos(2 pi t) per volume, density 1."""
    i_omega = 2j * np.pi
    root = np.sqrt(i_omega / NU)
    swing = G1 / i_omega * (1 - np.cosh(root * y) / np.cosh(root * HALF)) * np.exp(i_omega * t)
    return np.asarray(G0 * (HALF**2 - y**2) / (2 * NU) + swing.real)


def pulsating(scheme: vv.Scheme, steps: int, rows: int = 32) -> tuple[Array, Array]:
    """Velocities after one period across a periodic channel, and the exact ones."""
    mesh = vv.RectangleMesh(size=(0.1, 1.0), counts=(1, rows), cell="quad9", origin=(0, -0.5)).build()
    y = mesh.points[:, 1]
    mesh = vv.Mesh(np.column_stack([mesh.points[:, 0], y + 0.12 * np.sin(2 * np.pi * y)]), mesh.cells,
                   face_sets=mesh.face_sets)  # fmt: skip

    def push(t: float, X: Array) -> Array:
        return np.tile([G0 + G1 * np.cos(2 * np.pi * t), 0, 0], (len(X), 1))

    def start(X: Array) -> Array:
        return np.stack([womersley(0.0, X[:, 1]), 0 * X[:, 1], 0 * X[:, 1]], axis=1)

    options: Any = {"body_force": push, "velocity": start, "periodic": (("x0", "x1"),)}
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=NU, **options)
    system = vv.System([fluid, *[vv.NoSlip(fluid=fluid, faces=s) for s in ("y0", "y1")]])
    result = vv.simulate(system, until=1.0, step=1.0 / steps, scheme=scheme, every=steps)
    if scheme.theta == 0.5:
        assert result.ledger.imbalance() < 1e-12
    return fluid.velocities(system.x)[:, 0], womersley(1.0, fluid.points[:, 1])


def test_womersley_profile_and_order_in_time() -> None:
    assert womersley(0.0, np.array([0.0, 0.4])) == pytest.approx([1.00000961735, 0.37059795699], abs=1e-11)
    assert womersley(0.25, np.array([0.45])) == pytest.approx([0.237068136575], abs=1e-11)
    errors = []
    for steps in (16, 32):
        found, exact = pulsating(vv.Midpoint(), steps)
        errors.append(np.abs(found - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    assert errors[1] < 1e-3
