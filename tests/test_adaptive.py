"""Errors that adaptive steps allow are parts of what transported quantities become, in whichever unit these are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv

K = np.pi**2
END = (K * np.cos(20) + 20 * np.sin(20) - K * np.exp(-K)) / (K * K + 400)
"""Amplitude at t = 1 of cos(pi x) in ``c' = c'' + cos(pi x) cos(20 t)``, which starts empty."""
STRIP = {"size": (1.0, 0.0625), "counts": (32, 2)}


def swinging(u: float) -> Callable[[float, Any], Any]:
    return lambda t, X: u * np.cos(np.pi * X[:, 0]) * np.cos(20 * t)


def mixture(u: float) -> list[Any]:
    """Without phases, of unit mobility and diffusion in any unit of concentration."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(**STRIP),
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, 0.5 / u**2)),
        gradient_energy=1e-8 / u**2,
        mobility=u**2,
        concentration=0.0,
    )
    return [body, vv.ConcentrationSource(body=body, rate=swinging(u))]


def warmth(u: float) -> list[Any]:
    """Temperatures that count from that of the start."""
    body = vv.ThermalBody(
        mesh=vv.RectangleMesh(**STRIP),
        conductivity=1.0,
        capacity=1.0,
        density=1.0,
        temperature=0.0,
        reference=0.0,
    )
    return [body, vv.HeatSource(body=body, power=swinging(u))]


def amplitude(parts: list[Any], u: float, scheme: Any) -> tuple[float, int]:
    system = vv.System(parts)
    result = vv.simulate(system, until=1.0, step=0.01, scheme=scheme, adaptive=vv.Adaptive(tolerance=1e-3))
    values, x = system.x[: len(parts[0].points)], parts[0].points[:, 0]
    ends = values[x < 1e-9][0] - values[x > 1 - 1e-9][0]
    return float(ends) / (2 * u), len(result.times) - 1


@pytest.mark.parametrize("of", [mixture, warmth])
def test_what_starts_empty_is_measured_by_what_it_becomes(of: Callable[[float], list[Any]]) -> None:
    """By 1 instead, a unit of a thousandth left -.072 for .0448."""
    whole, steps = amplitude(of(1.0), 1.0, vv.EnergyMomentum())
    assert whole == pytest.approx(END, abs=2e-4)
    for u in (1e-2, 1e-3):
        found, taken = amplitude(of(u), u, vv.EnergyMomentum())
        assert (found, taken) == (pytest.approx(whole, abs=2e-5), pytest.approx(steps, abs=2))
    assert amplitude(of(1e-6), 1e-6, vv.EnergyMomentum())[0] == pytest.approx(END, abs=2e-4)


def test_so_it_is_by_schemes_of_first_order() -> None:
    assert amplitude(mixture(1e-3), 1e-3, vv.BackwardEuler())[0] == pytest.approx(END, abs=2e-3)


@pytest.mark.parametrize(("start", "size"), [(0.0, 1e-3), (20.0, 1.0), (293.15, 1.0)])
def test_of_uniform_temperatures_the_zero_matters_little(start: float, size: float) -> None:
    """Mean of a strip whose end swings, over the size of that, against steps far shorter."""

    def mean(start: float, **choice: Any) -> float:
        body = vv.ThermalBody(
            mesh=vv.RectangleMesh(**STRIP),
            conductivity=1.0,
            capacity=1.0,
            density=1.0,
            temperature=start,
            reference=start,
        )
        wall = vv.PrescribedTemperature(body=body, nodes="x0", value=f"{start}+{size}*sin(60*t)")
        system = vv.System([body, wall])
        vv.simulate(system, until=0.2, **choice)
        return float(np.mean(system.x) - start) / size

    fine = mean(0.0, step=0.0005)
    assert mean(start, step=0.01, adaptive=vv.Adaptive(tolerance=1e-3)) == pytest.approx(fine, abs=3e-4)


def test_flows_that_are_set_going_are_measured_by_their_speed() -> None:
    """Under a lid that swings, slowly enough for the flow to be that of Stokes, in two units of speed, with
    a weight that pressures balance.
    """

    def moved(u: float, *loads: Any) -> tuple[Any, int]:
        fluid = vv.Fluid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9"), density=1.0, viscosity=0.1
        )
        lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=(f"{u}*sin(30*t)", 0, 0))
        walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("x0", "x1", "y0")]
        system = vv.System([fluid, lid, *walls, *loads])
        result = vv.simulate(system, until=0.2, step=0.01, adaptive=vv.Adaptive(tolerance=1e-3))
        return system.x[fluid.flow.unknowns] / u, len(result.times)

    (large, steps), (small, taken) = moved(1e-2), moved(1e-4)
    heavy, as_many = moved(1e-4, vv.Gravity(acceleration=(0, -9.81, 0)))
    assert as_many >= steps
    assert heavy == pytest.approx(large, abs=1e-3)
    assert taken == pytest.approx(steps, abs=2)
    assert small == pytest.approx(large, abs=1e-3)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BDF2()], ids=str)
def test_pulses_between_the_ends_of_steps_are_seen(scheme: vv.Scheme) -> None:
    """Of heat by an expression, on for a fifth of each period, a half and more was passed over, the balance exact."""
    body = vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 1, 1)),
        conductivity=50.0,
        capacity=100.0,
        temperature=300.0,
    )
    system = vv.System([body, vv.HeatSource(body=body, power="50 * max(sin(2 * pi * t / 100) - 0.8, 0)")])
    result = vv.simulate(system, until=1000.0, step=1.0, scheme=scheme, adaptive=vv.Adaptive(tolerance=1e-4))
    half = np.arccos(0.8)
    pulse = 50 * 100 / (2 * np.pi) * (2 * np.sin(half) - 1.6 * half)
    assert result.ledger["heat_source"][-1] == pytest.approx(10 * pulse, rel=0.005)
    assert np.diff(result.times).max() > 10  # where there is none


def test_short_forces_are_seen() -> None:
    """It was not there at the ends and middles of long steps: v stayed 0."""
    ball = vv.PointMass(mass=1.0)
    pulse = "smoothstep((t - 100) / 0.5) * (1 - smoothstep((t - 101) / 0.5))"
    system = vv.System([ball, vv.Force(on=ball, force=(1, 0, 0), times=pulse)])
    result = vv.simulate(system, until=200.0, step=0.5, adaptive=vv.Adaptive(tolerance=1e-4))
    assert system.v[0] == pytest.approx(1.0, abs=0.02)
    assert result.statistics.steps < 100


@pytest.mark.parametrize(
    "given", ["0.7", lambda t: 0.7, "0.7 * (sin(t)**2 + cos(t)**2)"], ids=["0.7", "function", "squares"]
)
def test_functions_that_change_by_rounding_shorten_no_step(given: Any) -> None:
    """What is constant was off a parabola by its last bit, and a thousand steps were taken for eighteen."""
    counts = []
    for times in (given, 0.7):
        ball = vv.PointMass(mass=1.0)
        system = vv.System([ball, vv.Force(on=ball, force=(1, 0, 0), times=times)])
        result = vv.simulate(system, until=100.0, step=0.1, adaptive=vv.Adaptive(tolerance=1e-4))
        counts.append(result.statistics.steps)
    assert counts[0] == counts[1] < 50


def test_functions_shorten_no_step_below_the_shortest() -> None:
    ball = vv.PointMass(mass=1.0)
    system = vv.System([ball, vv.Force(on=ball, force=(1, 0, 0), times="sin(50 * t)")])
    rule = vv.Adaptive(tolerance=1.0, min_step=0.1)
    result = vv.simulate(system, until=2.0, step=0.01, adaptive=rule)
    assert np.diff(result.times)[:-1].min() > 0.0999
