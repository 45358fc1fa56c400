"""Mixtures and order parameters against closed forms, manufactured solutions and what must never happen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import spinodal

Array = NDArray[np.float64]
PFHUB = vv.DoubleWell(barrier=5.0, low=0.3, high=0.7)


def strip(length: float, n: int, cell: str = "quad9", start: float = 0.0) -> vv.RectangleMesh:
    """One row of cells along x."""
    return vv.RectangleMesh(size=(length, length / n), counts=(n, 1), cell=cell, origin=(start, 0))


@pytest.mark.parametrize("conserved", [False, True])
def test_planar_interface(conserved: bool) -> None:
    """Of ``u^3 - u - eps^2 laplace u``: ``tanh(x / sqrt(2) eps)`` with the energy ``2 sqrt(2) / 3 eps`` per length."""
    eps, n = 0.1, 120
    body = vv.AllenCahn(
        mesh=strip(2.0, n, start=-1.0),
        free_energy=vv.DoubleWell(barrier=0.25, low=-1.0),
        gradient_energy=eps**2,
        order=lambda X: np.tanh(5 * X[:, 0]),
        conserved=conserved,
    )
    system = vv.System([body])
    vv.simulate(system, until=60.0, step=0.5)
    height = 2.0 / n
    assert sum(body.energies(system.x)) / height == pytest.approx(2 * np.sqrt(2) / 3 * eps, rel=1e-5)
    exact = np.tanh(body.points[:, 0] / np.sqrt(2) / eps)
    assert np.abs(body.values(system.x) - exact).max() < 1e-3
    assert body.interface() is not None
    assert body.interface().tension == pytest.approx(2 * np.sqrt(2) / 3 * eps, rel=1e-5)  # type: ignore[union-attr]


def test_shrinking_circle() -> None:
    """``R^2 = R0^2 - 2 t`` of ``u' = laplace u - (u^3 - u) / eps^2``, on a quarter."""
    eps, R0, n = 0.03, 0.25, 36
    body = vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(0.4, 0.4), counts=(n, n), cell="quad4"),
        free_energy=vv.DoubleWell(barrier=0.25 / eps**2, low=-1.0),
        gradient_energy=1.0,
        order=lambda X: np.tanh((R0 - np.hypot(X[:, 0], X[:, 1])) / np.sqrt(2) / eps),
    )
    system = vv.System([body])

    def square() -> float:
        """By the area where u is one: a quarter of a disc."""
        return 4 / np.pi * 0.5 * (body.integral(system.x) + 0.16)

    start = square()
    vv.simulate(system, until=0.015, step=0.001)
    assert start - square() == pytest.approx(0.03, rel=0.02)


def test_growth_of_small_waves() -> None:
    """``R = -M k^2 (f'' + kappa k^2)``: the fastest one of PFHub's benchmark 1 grows by 0.4."""
    k = np.sqrt(0.2)
    body = vv.CahnHilliard(
        mesh=strip(np.pi / k, 20),
        free_energy=PFHUB,
        gradient_energy=2.0,
        mobility=5.0,
        concentration=lambda X: 0.5 + 1e-6 * np.cos(k * X[:, 0]),
    )
    system = vv.System([body])
    vv.simulate(system, until=1.0, step=0.02)
    grown = (body.values(system.x)[0] - 0.5) / 1e-6
    assert np.log(grown) == pytest.approx(0.4, rel=1e-3)


def test_arrhenius() -> None:
    """What takes 1 s at one temperature takes ``exp(Q / R (1 / T2 - 1 / T1))`` s at another."""
    Q, R, hot, cold = 40e3, 8.31446261815324, 500.0, 400.0
    slower, ends = np.exp(Q / R * (1 / cold - 1 / hot)), []
    for T, time in ((hot, 1.0), (cold, slower)):
        body = vv.CahnHilliard(
            mesh=strip(8.0, 12),
            free_energy=PFHUB,
            gradient_energy=2.0,
            mobility=vv.ArrheniusMobility(
                base=vv.DegenerateMobility(scale=5.0 * np.exp(Q / R / hot)), activation=Q, temperature=T
            ),
            concentration=lambda X: 0.5 + 0.05 * np.cos(np.pi / 8 * X[:, 0]),
        )
        system = vv.System([body])
        vv.simulate(system, until=time, step=time / 4)
        ends.append(body.values(system.x))
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-9)
    assert np.ptp(ends[0]) != pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("step", [0.1, 3.0, 100.0])
def test_energy_falls_and_mass_stays(step: float) -> None:
    """In steps of any length."""
    rng = np.random.default_rng(3)
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(24, 24), counts=(16, 16)),
        free_energy=PFHUB,
        gradient_energy=2.0,
        mobility=vv.DegenerateMobility(scale=5.0, low=0.3, high=0.7),
        concentration=lambda X: 0.5 + 0.02 * rng.standard_normal(len(X)),
        periodic=[("x0", "x1"), ("y0", "y1")],
    )
    system = vv.System([body])
    mass = body.integral(system.x)
    result = vv.simulate(system, until=8 * step, step=step)
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-13)
    assert result.conservation()["energy"] < 1e-10


def manufactured(cell: str, n: int, step: float) -> float:
    """Error at the end of ``c = 1/2 + cos(pi x) cos(pi y) exp(-t) / 4`` of a mixture with a source."""
    kappa, M, b, pi = 0.3, 0.5, 1.0, np.pi

    def exact(t: float, X: Array) -> Array:
        return 0.5 + 0.25 * np.cos(pi * X[:, 0]) * np.cos(pi * X[:, 1]) * np.exp(-t)

    def source(t: float, X: Array) -> Array:
        """``c' - M laplace(f' - kappa laplace c)`` with ``f' = 2 b (2 u^3 - u / 2)``, u = c - 1/2."""
        u = exact(t, X) - 0.5
        x, y = pi * X[:, 0], pi * X[:, 1]
        slope = (0.25 * np.exp(-t) * pi) ** 2 * ((np.sin(x) * np.cos(y)) ** 2 + (np.cos(x) * np.sin(y)) ** 2)
        bend = -2 * pi**2 * u
        laplace = 2 * b * ((6 * u**2 - 0.5) * bend + 12 * u * slope)
        return -u - M * (laplace - kappa * 4 * pi**4 * u)

    box = cell in ("hex8", "tet10")
    mesh: Any = (
        vv.BoxMesh(size=(1, 1, 1 / n), counts=(n, n, 1), cell=cell)
        if box
        else vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell)
    )
    body = vv.CahnHilliard(
        mesh=mesh,
        free_energy=vv.DoubleWell(barrier=b),
        gradient_energy=kappa,
        mobility=M,
        concentration=lambda X: exact(0.0, X),
    )
    system = vv.System([body, vv.ConcentrationSource(body=body, rate=source)])
    vv.simulate(system, until=0.2, step=step)
    c = body.coefficients(body.phase, system.x)
    square = 0.0
    for t in body.space.cells():
        off = t.at(c) - exact(0.2, t.X.reshape(-1, 3)).reshape(t.size.shape)
        square += float((t.size * off**2).sum())
    return float(np.sqrt(square * (n if box else 1)))


@pytest.mark.parametrize(
    ("cell", "n", "order"),
    [
        ("quad4", 8, 2),
        ("tri3", 8, 2),
        ("quad9", 4, 3),
        ("tri6", 4, 3),
        ("quad8", 4, 3),
        ("hex8", 8, 2),
        ("tet10", 3, 3),
    ],
)
def test_order_in_space(cell: str, n: int, order: int) -> None:
    coarse, fine = manufactured(cell, n, 0.02), manufactured(cell, 2 * n, 0.02)
    assert np.log2(coarse / fine) > order - 0.15


def test_order_in_time() -> None:
    first, second = manufactured("quad9", 24, 0.04), manufactured("quad9", 24, 0.02)
    assert np.log2(first / second) == pytest.approx(2, abs=0.15)


@pytest.mark.parametrize("angle", [60.0, 120.0])
def test_contact_angle(angle: float) -> None:
    """Between walls with angles that add up to 180 degrees the flat interface, with its profile, stands inclined."""
    body = vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(3, 1), counts=(24, 8), cell="quad9", origin=(-1.5, -0.5)),
        free_energy=vv.DoubleWell(barrier=100.0),
        gradient_energy=0.5,
        order=lambda X: 0.5 + 0.5 * np.tanh(20 * X[:, 0]),
        conserved=True,
    )
    walls = [vv.Wetting(body=body, faces=f, angle=a) for f, a in (("y0", angle), ("y1", 180 - angle))]
    system = vv.System([body, *walls])
    vv.simulate(system, until=3.0, step=0.05)
    theta, X = np.radians(angle), body.points
    off = (X[:, 0] - X[:, 1] / np.tan(theta)) * np.sin(theta)
    exact = 0.5 + 0.5 * np.tanh(0.5 * np.sqrt(2 * 100.0 / 0.5) * off)
    assert np.abs(body.values(system.x) - exact).max() < 0.02


@pytest.mark.parametrize("degenerate", [False, True])
def test_deep_quench(degenerate: bool) -> None:
    """Phases of 0.001 and 0.999 (common tangent of ``chi = 7``): nodes stay inside, energy falls, no stall."""
    rng = np.random.default_rng(1)
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(10, 10), counts=(20, 20)),
        free_energy=vv.FloryHuggins(chi=7.0),
        gradient_energy=6.0,
        mobility=vv.DegenerateMobility(scale=1.0) if degenerate else 1.0,
        concentration=lambda X: 0.5 + 0.02 * rng.standard_normal(len(X)),
        periodic=[("x0", "x1"), ("y0", "y1")],
    )
    system = vv.System([body])
    mass = body.integral(system.x)
    rule = vv.Adaptive(tolerance=3e-3, max_step=20.0)
    result = vv.simulate(system, until=50.0, step=0.05, adaptive=rule)
    c = body.values(system.x)
    assert 0 < c.min() < 2e-3
    assert 0 < 1 - c.max() < 2e-3
    assert np.all(np.diff(result.ledger["potential_stored"]) < 1e-10)
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-12)
    assert result.statistics.steps < 300
    assert result.statistics.rejected < 40


def test_pfhub_1b() -> None:
    """Benchmark 1b until t = 10 at a spacing of one: the energy within 0.5 % of the spectral one, the mass exact.

    ``benchmarks/spinodal.py`` goes on to t = 10,000.
    """
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(200, 200), counts=(200, 200)),
        free_energy=PFHUB,
        gradient_energy=2.0,
        mobility=5.0,
        concentration=spinodal.start,
    )
    system = vv.System([body], vv.Newton(tolerance=1e-6))
    mass = body.integral(system.x)
    assert mass / 200**2 == pytest.approx(0.502522769025, rel=1e-5)
    rule = vv.Adaptive(tolerance=3e-2, max_step=10.0)
    for t, spectral in ((1.0, 318.8378527), (5.0, 317.0182160), (10.0, 304.1157217)):
        result = vv.simulate(system, until=t, step=0.5, adaptive=rule)
        assert sum(body.energies(system.x)) == pytest.approx(spectral, rel=5e-3)
        assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-13)


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha(0.9), vv.BackwardEuler()], ids=str)
def test_a_steep_start_dissipates_no_more_than_is_lost(scheme: vv.Scheme) -> None:
    """What diffuses in the first step is that of its end: half of that at the start was 26 times the loss."""
    mixture = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(4, 0.25), counts=(16, 1)),
        free_energy=vv.DoubleWell(barrier=1.0),
        gradient_energy=0.1,
        mobility=1.0,
        concentration=lambda X: np.where(X[:, 0] < 2, 0.1, 0.9),
    )
    ledger = vv.simulate(vv.System([mixture]), until=0.2, step=0.02, scheme=scheme).ledger
    lost, dissipated = ledger.first("total") - ledger.last("total"), -ledger.last("work_dissipated")
    assert 0.2 * lost < dissipated < 1.05 * lost
