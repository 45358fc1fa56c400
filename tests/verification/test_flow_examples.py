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


# --- lid-driven cavity --------------------------------------------------------------------------------------
GHIA = {
    100: (
        -0.03717,
        -0.06434,
        -0.10150,
        -0.15662,
        -0.21090,
        -0.20581,
        -0.13641,
        0.00332,
        0.23151,
        0.68717,
        0.84123,
    ),
    400: (
        -0.08186,
        -0.14612,
        -0.24299,
        -0.32726,
        -0.17119,
        -0.11477,
        0.02135,
        0.16256,
        0.29093,
        0.55892,
        0.75837,
    ),
    1000: (
        -0.18109,
        -0.29730,
        -0.38289,
        -0.27805,
        -0.10648,
        -0.06080,
        0.05702,
        0.18719,
        0.33304,
        0.46604,
        0.65928,
    ),
}
"""Ghia, Ghia & Shin 1982 at the heights of the example; off the others by 5e-3, 2.6e-3 and 6.3e-3."""


@pytest.mark.parametrize(
    ("reynolds", "count", "elements", "most"),
    [
        (100, 12, "Q2Q1", (3e-3, 2e-3)),
        (400, 20, "P2P1", (2e-3, 1.5e-3)),
        (1000, 24, "Q2Q1", (1e-3, 2.5e-3)),
        (100, 32, "Q1Q1", (1e-2, 4e-3)),
    ],
)
def test_cavity(reynolds: int, count: int, elements: str, most: tuple[float, float]) -> None:
    """Velocities across both centre lines; at the Reynolds number 1000 those of Botella & Peyret 1998."""
    result = ended(cavity.study(reynolds, count, elements))
    off = cavity.deviations(result)
    assert np.all(np.abs(off).max(axis=1) < most), f"off by {np.abs(off).max(axis=1)}"
    assert np.abs(off[0] + cavity.SPEEDS[reynolds] - GHIA[reynolds]).max() < 1e-2
    assert result.ledger.imbalance() < 1e-12
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    sides = [vv.FlowRate(fluid=water, faces=s)(result.system) for s in ("x0", "x1", "y0", "y1")]
    assert np.abs(sides).max() < 1e-15


ERTURK = np.array([
    (0.02, -0.1517), (0.06, -0.3372), (0.10, -0.4250), (0.14, -0.3965), (0.20, -0.3228), (0.50, -0.0403),
    (0.90, 0.4141), (0.94, 0.4470), (0.97, 0.4971), (0.99, 0.7704),
])  # fmt: skip
"""Heights and velocities at the Reynolds number 2500: Erturk, Corke & Goekcoel 2005."""


def test_cavity_by_continuation() -> None:
    """One step to the Reynolds number 2500 fails, and is halved until Newton's method finds the way."""
    study = cavity.study(2500, 24, step=1.0)
    result = ended(study)
    assert result.statistics.rejected > 0
    assert result.times == pytest.approx([0.0, 0.25, 0.5, 1.0])
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    line = water.at([(0.5, y) for y in ERTURK[:, 0]]).velocities(result.system.x)[:, 0]
    assert np.abs(line - ERTURK[:, 1]).max() < 6e-3


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


def test_steady_cylinder_in_space() -> None:
    """Benchmark 3D-1Z on 7800 unknowns: drag to 0.5 percent; the pressures differ by 5 percent more than 0.175, the
    upper of the published bounds, and what is left of the lift is half of itself too large."""
    result = ended(study := cylinder.study("3D-1Z"))
    cylinder.check(result)
    drag, lift, difference = cylinder.coefficients(study.system)
    assert drag == pytest.approx(cylinder.DRAG_IN_SPACE, rel=5e-3)
    assert lift == pytest.approx(cylinder.LIFT_IN_SPACE, abs=1e-3 * cylinder.DRAG_IN_SPACE)
    assert 0.165 < difference < 1.05 * 0.175
    water = cylinder.fluid_of(study.system)
    into, out = (vv.FlowRate(fluid=water, faces=s)(study.system) for s in ("x0", "x1"))
    assert out == pytest.approx(-into, rel=1e-12)


def test_vortex_street() -> None:
    """Benchmark 2D-2 on a coarse mesh, with its distances from FeatFlow's level 6; finer ones come closer."""
    study = cylinder.study("2D-2", until=5.2, step=0.01)
    rows = []
    for _ in vv.march(study.system, until=study.until, step=study.step, scheme=study.scheme):
        rows.append((study.system.time, *cylinder.coefficients(study.system)))
    found = cylinder.street(np.array(rows))
    assert found.largest_drag == pytest.approx(cylinder.STREET.largest_drag, rel=0.01)
    assert found.smallest_drag == pytest.approx(cylinder.STREET.smallest_drag, rel=0.01)
    assert found.largest_lift == pytest.approx(cylinder.STREET.largest_lift, rel=0.03)
    assert found.smallest_lift == pytest.approx(cylinder.STREET.smallest_lift, rel=0.03)
    assert found.strouhal == pytest.approx(cylinder.STREET.strouhal, rel=0.03)
    assert 2.46 < found.difference < 2.50
    (water,) = (c for c in study.system.components if isinstance(c, vv.Fluid))
    into, out = (vv.FlowRate(fluid=water, faces=s)(study.system) for s in ("x0", "x1"))
    assert out == pytest.approx(-into, rel=1e-9)


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
    return fluid.velocities(system.x, system.v)[:, 0], womersley(1.0, fluid.points[:, 1])


def test_womersley_profile_and_order_in_time() -> None:
    assert womersley(0.0, np.array([0.0, 0.4])) == pytest.approx([1.00000961735, 0.37059795699], abs=1e-11)
    assert womersley(0.25, np.array([0.45])) == pytest.approx([0.237068136575], abs=1e-11)
    errors = []
    for steps in (16, 32):
        found, exact = pulsating(vv.Midpoint(), steps)
        errors.append(np.abs(found - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    assert errors[1] < 1e-3


# --- start-up of plane Poiseuille flow ----------------------------------------------------------------------
def starting(t: float, y: Array) -> Array:
    """Velocities between plates at y = -0.5 and 0.5, pushed from rest by the force G0 per volume, density 1."""
    k = np.pi * (2 * np.arange(200)[:, None] + 1)
    parts = (-1.0) ** np.arange(200)[:, None] * np.cos(k * y) * np.exp(-NU * k**2 * t) / k**3
    return np.asarray(G0 * (HALF**2 - y**2) / (2 * NU) - 4 * G0 / NU * parts.sum(axis=0))


@pytest.mark.parametrize(("scheme", "most"), [(vv.Midpoint(), 4e-5), (vv.BDF2(), 1.4e-4)], ids=str)
def test_startup_profiles(scheme: vv.Scheme, most: float) -> None:
    """The force sets in at once; profiles on the way against the series, velocities of one at the end."""
    assert starting(10.0, np.zeros(1))[0] == pytest.approx(0.61535251426261, abs=1e-12)
    assert starting(50.0, np.zeros(1))[0] == pytest.approx(0.99257762324192, abs=1e-12)
    mesh = vv.RectangleMesh(size=(0.1, 1.0), counts=(1, 16), cell="quad9", origin=(0, -0.5))
    push: dict[str, Any] = {"body_force": (G0, 0, 0), "periodic": (("x0", "x1"),)}
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=NU, **push)
    system = vv.System([fluid, *[vv.NoSlip(fluid=fluid, faces=s) for s in ("y0", "y1")]])
    off = {}

    def look(system: vv.System) -> None:
        if abs(system.time % 5) < 1e-6 or abs(system.time % 5 - 5) < 1e-6:
            found = fluid.velocities(system.x, system.v)[:, 0]
            off[round(system.time)] = np.abs(found - starting(system.time, fluid.points[:, 1])).max()

    vv.simulate(system, until=50.0, step=0.25, scheme=scheme, observe=look, every=200)
    assert list(off) == list(range(5, 55, 5))
    assert max(off.values()) < most, f"off by {off}"
