"""Conduction of heat in bodies that stand still, against closed forms and NAFEMS' tests."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import visviva as vv


def bar(n: int = 20, **options: Any) -> vv.ThermalBody:
    mesh = vv.RectangleMesh(size=(1.0, 0.1), counts=(n, 1), cell=options.pop("cell", "quad4"))
    return vv.ThermalBody(mesh=mesh, **{"conductivity": 1.0, **options})


def held(body: vv.ThermalBody, nodes: Any, value: Any) -> vv.PrescribedTemperature:
    return vv.PrescribedTemperature(body=body, nodes=nodes, value=value)


def steady(system: vv.System) -> None:
    vv.quasi_static(system, until=1.0, step=1.0)


def at(system: vv.System, body: vv.ThermalBody, *place: float) -> float:
    return float(vv.TemperatureAt(body=body, at=(*place, 0, 0, 0)[:3])(system))


def test_slab_cools_as_fourier_says() -> None:
    """Ends at 0, 1 at the start: the middle at four times by the series."""
    k = 2 * np.arange(60) + 1.0
    for t in (0.05, 0.1, 0.3):
        exact = float(np.sum(4 / (np.pi * k) * np.sin(k * np.pi / 2) * np.exp(-((k * np.pi) ** 2) * t)))
        body = bar(80, temperature=1.0)
        system = vv.System([body, held(body, "x0", 0.0), held(body, "x1", 0.0)])
        vv.simulate(system, until=t, step=t / 300, scheme=vv.BDF2())
        assert at(system, body, 0.5) == pytest.approx(exact, rel=6e-4)


SCHEMES = [(vv.EnergyMomentum(), 2), (vv.BDF2(), 2), (vv.BackwardEuler(), 1), (vv.GeneralizedAlpha(), 2)]


@pytest.mark.parametrize(("scheme", "order"), SCHEMES)
def test_order_in_time(scheme: vv.Scheme, order: int) -> None:
    """A cosine decays; the mesh decays it a little faster, by its own rate."""
    errors = []
    for n in (8, 16, 32):
        body = bar(16, temperature=lambda X: np.cos(np.pi * X[:, 0]))
        system = vv.System([body])
        c = np.cos(np.pi / 16)
        rate = 6 * 16**2 * (1 - c) / (2 + c)
        vv.simulate(system, until=0.2, step=0.2 / n, scheme=scheme)
        errors.append(abs(at(system, body, 0.0) - np.exp(-rate * 0.2)))
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    assert found[-1] == pytest.approx(order, abs=0.2)


def cooled(capacity: Any, scheme: vv.Scheme, steps: int, until: float = 6.0) -> tuple[vv.System, vv.Result]:
    """A unit cube at 20 in surroundings at -30 that take 1 per temperature; as well as one temperature."""
    body = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        conductivity=1e4,
        capacity=capacity,
        temperature=20.0,
    )
    system = vv.System([body, vv.Convection(body=body, faces="all", coefficient=1 / 6, ambient=-30.0)])
    return system, vv.simulate(system, until=until, step=until / steps, scheme=scheme)


def content_of_a_lump(capacity: list[tuple[float, float]], until: float = 6.0) -> float:
    """What it loses, from u' = -(T(u) + 30) by a Runge-Kutta method of order 8."""
    T = np.linspace(-30, 20, 2_000_001)
    c = np.interp(T, *np.transpose(capacity))
    u = np.concatenate([[0], np.cumsum(0.5 * (c[1:] + c[:-1]) * np.diff(T))])
    found = solve_ivp(
        lambda t, u_: -(np.interp(u_, u, T) + 30), (0, until), u[-1:], "DOP853", rtol=1e-10, max_step=0.01
    )
    return float(u[-1] - found.y[0, -1])


LATENT = [(-100.0, 1.0), (-0.2, 1.0), (-0.1, 2001.0), (0.0, 1.0), (100.0, 1.0)]
"""200 within 0.2 degrees."""


@pytest.mark.parametrize(("scheme", "order"), SCHEMES)
def test_latent_heat_is_kept_by_every_scheme(scheme: vv.Scheme, order: int) -> None:
    """Steps jump over the hump of the capacity, and see it all the same: what is lost is what a lump loses."""
    exact, off = content_of_a_lump(LATENT), []
    for n in (30, 120):
        _, result = cooled(LATENT, scheme, n)
        lost, taken = -np.ptp(result.ledger["total"]), result.ledger["heat_convection"][-1]
        assert result.ledger["total"][-1] - result.ledger["total"][0] == pytest.approx(lost)
        off.append(max(abs(lost + exact), abs(taken + exact)) / exact)
        assert lost == pytest.approx(taken, rel=1e-11 if order == 1 or n == 0 else 0.02)
    assert off[0] < 0.06
    assert off[1] < 0.02


@pytest.mark.parametrize(("scheme", "order"), SCHEMES)
@pytest.mark.parametrize("capacity", [[(-100.0, 201.0), (100.0, 1.0)]])
def test_order_in_time_with_a_capacity_that_changes(scheme: vv.Scheme, order: int, capacity: Any) -> None:
    exact = content_of_a_lump(capacity, 40.0)
    off = [abs(-np.ptp(cooled(capacity, scheme, n, 40.0)[1].ledger["total"]) + exact) for n in (10, 20, 40)]
    assert np.log2(off[1] / off[2]) == pytest.approx(order, abs=0.25)


@pytest.mark.parametrize(
    ("cell", "order"), [("quad4", 2), ("tri3", 2), ("quad9", 3), ("tri6", 3), ("quad8", 3)]
)
def test_order_in_space(cell: str, order: int) -> None:
    """A source whose temperature is a product of sines: the mean error falls with the degree and one more."""
    errors = []
    for n in (6, 12):
        mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell)
        body = vv.ThermalBody(mesh=mesh, conductivity=1.0)
        exact = np.sin(np.pi * body.points[:, 0]) * np.sin(np.pi * body.points[:, 1])
        source = vv.HeatSource(
            body=body, power=lambda t, X: 2 * np.pi**2 * np.sin(np.pi * X[:, 0]) * np.sin(np.pi * X[:, 1])
        )
        system = vv.System([body, source, held(body, border(body), 0.0)])
        steady(system)
        errors.append(float(np.sqrt(np.mean((body.temperatures(system.x) - exact) ** 2))))
    assert np.log2(errors[0] / errors[1]) > order - 0.25


def border(body: vv.ThermalBody) -> Any:
    return body.faces("all").nodes


def test_nafems_t3() -> None:
    """One-dimensional transient: 36.60 degrees at x = 0.08 m after 32 s."""
    mesh = vv.RectangleMesh(size=(0.1, 0.01), counts=(20, 1), cell="quad9")
    body = vv.ThermalBody(mesh=mesh, conductivity=35.0, capacity=440.5, density=7200.0)
    ends = held(body, "x0", 0.0), held(body, "x1", lambda t, X: 100 * np.sin(np.pi * t / 40) + 0 * X[:, 0])
    system = vv.System([body, *ends])
    vv.simulate(system, until=32.0, step=0.25)
    assert at(system, body, 0.08) == pytest.approx(36.603, abs=0.01)


def test_nafems_t4() -> None:
    """Two-dimensional with convection: 18.3 degrees at E."""
    mesh = vv.RectangleMesh(size=(0.6, 1.0), counts=(24, 40), cell="quad9")
    body = vv.ThermalBody(mesh=mesh, conductivity=52.0)
    sides = [vv.Convection(body=body, faces=f, coefficient=750.0, ambient=0.0) for f in ("x1", "y1")]
    system = vv.System([body, held(body, "y0", 100.0), *sides])
    steady(system)
    assert at(system, body, 0.6, 0.2) == pytest.approx(18.25, abs=0.06)


def test_radiation_of_a_bar() -> None:
    """NAFEMS T2: one end at 1000 K, the other radiates to 300 K with emissivity 0.98: 927.0 K there."""
    mesh = vv.RectangleMesh(size=(0.1, 0.01), counts=(10, 1))
    body = vv.ThermalBody(mesh=mesh, conductivity=55.6, temperature=1000.0)
    out = vv.Radiation(body=body, faces="x1", emissivity=0.98, ambient=300.0)
    system = vv.System([body, held(body, "x0", 1000.0), out])
    steady(system)
    assert at(system, body, 0.1) == pytest.approx(927.0, abs=0.05)


def test_pipe_wall() -> None:
    """Axisymmetric: ln(r) between two radii, and the whole flux of the revolution."""
    mesh = vv.RectangleMesh(size=(1.0, 0.3), counts=(20, 1), origin=(1.0, 0.0), cell="quad9")
    body = vv.ThermalBody(mesh=mesh, conductivity=2.0, axisymmetric=True)
    system = vv.System([body, held(body, "x0", 10.0), held(body, "x1", 0.0)])
    steady(system)
    r = body.points[:, 0]
    np.testing.assert_allclose(
        body.temperatures(system.x), 10 * (1 - np.log(r) / np.log(2)), rtol=0, atol=2e-5
    )
    middle = np.isclose(r, 1.5)
    flux = body.heat_flux(system.x)[middle, 0]
    np.testing.assert_allclose(flux, 2.0 * 10 / np.log(2) / 1.5, rtol=2e-3)


def test_conductivity_that_depends_on_temperature() -> None:
    """Kirchhoff's transform: T + slope T^2 / 2 is linear between the ends."""
    body = bar(40, conductivity_slope=0.05, cell="quad9")
    system = vv.System([body, held(body, "x0", 0.0), held(body, "x1", 10.0)])
    steady(system)
    T = body.temperatures(system.x)
    np.testing.assert_allclose(T + 0.025 * T**2, 12.5 * body.points[:, 0], rtol=0, atol=1e-5)


def test_orthotropic_conduction_along_a_rotated_axis() -> None:
    """The patch test: a linear field is exact, with k grad T flowing through the faces."""
    k = np.array([(3.0, 1.0, 0.2), (1.0, 2.0, 0.3), (0.2, 0.3, 1.0)])
    slope = np.array([1.0, -2.0, 0.5])
    body = vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 2, 1), counts=(2, 3, 2)), conductivity=k)
    system = vv.System([body, held(body, border(body), lambda t, X: X @ slope)])
    steady(system)
    np.testing.assert_allclose(body.temperatures(system.x), body.points @ slope, atol=1e-12)
    np.testing.assert_allclose(
        body.heat_flux(system.x), np.broadcast_to(-k @ slope, body.points.shape), atol=1e-11
    )


@pytest.mark.parametrize("step", [0.002, 0.02, 0.2])
def test_heat_content_is_exact_with_any_capacity(step: float) -> None:
    """Energy-momentum: the change of the content is what flowed in, to round-off, at any step."""
    body = bar(8, capacity_slope=0.3, conductivity_slope=0.2, temperature=lambda X: 1 + X[:, 0] ** 2)
    parts = [
        held(body, "x0", "1 + 0.3*sin(5*t)"),
        vv.Convection(body=body, faces="x1", coefficient=2.0, ambient="3 + t"),
        vv.Radiation(body=body, faces="y1", emissivity=0.5, ambient=4.0, constant=0.01),
        vv.HeatSource(body=body, power=lambda t, X: t + X[:, 0]),
        vv.HeatFlux(body=body, faces="y0", flux="0.5*t"),
    ]
    result = vv.simulate(vv.System([body, *parts]), until=1.0, step=step)
    assert result.ledger.imbalance() < 1e-12


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha(0.8)], ids=str)
@pytest.mark.parametrize(("value", "end"), [("3 - 5*t", 2.0), ("3 + 5*t", 4.0)])
def test_what_held_temperatures_supply_is_the_change_of_content(
    scheme: vv.Scheme, value: str, end: float
) -> None:
    """A body as warm as its end, by the integral of the capacity 1 + 0.3 T: a fifth was missing, at any step."""
    body = bar(4, capacity_slope=0.3, conductivity=1e8, temperature=3.0)
    system = vv.System([body, held(body, "x0", value)])
    exact, errors = 0.1 * (end - 3.0 + 0.15 * (end**2 - 9.0)), []
    for step in (0.02, 0.01):
        system.reset()
        supplied = vv.simulate(system, until=0.2, step=step, scheme=scheme).ledger["heat_supply"][-1]
        errors.append(abs(supplied / exact - 1))
    assert errors[0] < 1e-3
    assert errors[1] < 0.4 * errors[0] + 1e-7


def test_lumped_body_follows_newton() -> None:
    """A small Biot number: the whole body cools exponentially."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    body = vv.ThermalBody(mesh=mesh, conductivity=1e5, capacity=2.0, density=3.0, temperature=50.0)
    out = vv.Convection(body=body, faces="all", coefficient=0.5, ambient=20.0)
    system = vv.System([body, out])
    vv.simulate(system, until=2.0, step=0.02)
    assert at(system, body, 0.5, 0.5, 0.5) == pytest.approx(20 + 30 * np.exp(-1.0), abs=2e-3)


BAD = [
    (lambda: bar(conductivity=-1.0), "not positive in all directions"),
    (lambda: bar(conductivity=[(1, 2, 0), (0, 1, 0), (0, 0, 1)]), "not symmetric"),
    (lambda: bar(capacity=0.0), "capacity = 0 is not positive"),
    (lambda: bar(capacity_slope=-0.5, temperature=3.0), "capacity is not positive"),
    (lambda: vv.Radiation(body=bar(), faces="x0", emissivity=0.5, ambient=300.0), "absolute zero"),
    (
        lambda: vv.Radiation(body=bar(temperature=1.0), faces="x0", emissivity=1.5, ambient=300.0),
        "emissivity",
    ),
    (lambda: vv.Convection(body=bar(), faces="x0", coefficient=-1.0, ambient=0.0), "negative"),
    (lambda: vv.Convection(body=bar(), faces="nowhere", coefficient=1.0, ambient=0.0), "nowhere"),
    (lambda: vv.HeatFlux(body=bar(), faces="x0", flux=lambda t, X: X), "must give n finite numbers"),
    (lambda: twice(bar()), "holds already"),
]


def twice(body: vv.ThermalBody) -> vv.System:
    return vv.System([body, held(body, "x0", 1.0), held(body, "all", 2.0)])


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_input(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def test_conductivity_that_would_vanish_ends_the_run() -> None:
    body = bar(conductivity_slope=0.02)
    system = vv.System([body, held(body, "x0", "-100*t")])
    with pytest.raises(vv.RunError, match="conductivity is not positive"):
        vv.simulate(system, until=1.0, step=0.05)


def test_what_exchanges_no_heat_has_no_steady_state() -> None:
    for settle in (vv.equilibrium, steady):
        with pytest.raises(vv.InputError, match="nothing holds the temperature of ThermalBody"):
            settle(vv.System([bar(temperature=lambda X: X[:, 0])]))


def test_large_bodies_are_solved_by_multigrid_and_find_what_factors_find() -> None:
    """In time steps and steady, at once as the equations are linear; properties that depend on heat take factors."""
    found = []
    for linear in (None, vv.Direct()):
        body = vv.ThermalBody(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(24, 24, 24)),
            conductivity=1.0,
            temperature=lambda X: X[:, 1],
        )
        exchange = vv.Convection(body=body, faces="x1", coefficient=2.0, ambient=3.0)
        system = vv.System([body, held(body, "x0", "1 + t"), exchange], vv.Newton(linear=linear))
        if linear is None:
            assert "conjugate gradients to 1e-08, preconditioner multigrid" in system.linear_explanation
        vv.simulate(system, until=0.02, step=0.01)
        found.append(body.temperatures(system.x))
    assert np.abs(found[0] - found[1]).max() < 1e-8
    uneven = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4)), conductivity=1.0, conductivity_slope=0.1
    )
    assert "positive definite" not in vv.System([uneven]).linear_explanation


def test_radiation_that_overflows_fails_the_step() -> None:
    """From nothing to a great heat the first iterate is beyond all numbers: steps are cut, and the state is kept."""
    body = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), conductivity=1.0, capacity=1e-12, temperature=1e-10
    )
    hot = vv.Radiation(body=body, faces="x1", emissivity=1.0, ambient=1e5)
    system = vv.System([body, hot])
    with pytest.raises(vv.StepFailure, match="Radiation 'radiation-1': its residual is not finite"):
        vv.simulate(system, until=1e6, step=1e6)
    assert system.time == 0
    assert body.temperatures(system.x).max() == 1e-10


@pytest.mark.parametrize("noise", [1e-13, 1e-9, 1e-5])
def test_what_starts_even_but_for_an_earlier_run_takes_steps(noise: float) -> None:
    """Increments were measured by these differences, far below what numbers of such temperatures resolve."""
    ends = []
    for off in (0.0, noise):
        body = vv.ThermalBody(
            mesh=vv.BoxMesh(size=(0.1, 0.01, 0.01), counts=(20, 1, 1)),
            conductivity=50.0,
            capacity=3.6e6,
            temperature=lambda X, off=off: 300 + off * np.sin(1e5 * X[:, 0]),
        )
        system = vv.System([body, vv.HeatFlux(body=body, faces="x1", flux=1e4)])
        vv.simulate(system, until=100.0, step=10.0)
        ends.append(body.temperatures(system.x))
    np.testing.assert_allclose(ends[1], ends[0], atol=2 * noise + 1e-10)
    assert ends[0].max() > 305


@pytest.mark.parametrize("cell", ["quad8", "quad9", "tri6"])
def test_heat_flux_at_walls(cell: Any) -> None:
    """Of a slab with a uniform source; means of the cells gave 3 to 5 % less where it is largest."""
    mesh = vv.RectangleMesh(size=(1, 0.2), counts=(8, 2), cell=cell)
    body = vv.ThermalBody(mesh=mesh, conductivity=2.0, capacity=1.0, temperature=300.0)
    held = vv.PrescribedTemperature(body=body, nodes="x1", value=300.0)
    system = vv.System([body, vv.HeatSource(body=body, power=1.0), held])
    vv.quasi_static(system, until=1.0, step=1.0)
    flux = body.heat_flux(system.x)
    np.testing.assert_allclose(flux[:, 0], body.points[:, 0], atol=1e-8)
    np.testing.assert_allclose(flux[:, 1:], 0.0, atol=1e-8)
