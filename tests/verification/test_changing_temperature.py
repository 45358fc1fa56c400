"""Mixtures whose temperature changes in time: heated and cooled alloys."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import visviva as vv

K = 2 * np.pi / 8.0
R = 2.0


def temperature(t: float) -> float:
    return 1.0 + 0.3 * np.sin(1.3 * t)


def alloy(**options) -> vv.CahnHilliard:
    settings = {
        "mesh": vv.RectangleMesh(size=(8, 1), counts=(32, 2), cell="quad9"),
        "free_energy": vv.RegularSolution(
            temperature=temperature, excess=[lambda T: 5.0 - 0.4 * T], gas_constant=R
        ),
        "gradient_energy": 0.5,
        "mobility": vv.ArrheniusMobility(base=2.0, activation=3.0, temperature=temperature, gas_constant=R),
        "concentration": lambda X: 0.5 + 1e-5 * np.cos(K * X[:, 0]),
    }
    return vv.CahnHilliard(**(settings | options))


def amplitude(body: vv.CahnHilliard, x: np.ndarray) -> float:
    return float(body.values(x)[np.argmin(np.abs(body.points).sum(axis=1))]) - 0.5


def rate(t: float) -> float:
    """Of a small wave: ``-M k^2 (f'' + kappa k^2)``, with ``f'' = 4 R T - 2 L`` in the middle."""
    T = temperature(t)
    curvature = 4 * R * T - 2 * (5.0 - 0.4 * T)
    return -2.0 * np.exp(-3.0 / (R * T)) * K**2 * (curvature + 0.5 * K**2)


def test_small_waves_grow_and_decay_as_the_temperature_says() -> None:
    body = alloy()
    system = vv.System([body])
    result = vv.simulate(system, until=4.0, step=0.01)
    start = amplitude(body, result.states[0])
    found = np.log(amplitude(body, system.x) / start)
    expected = quad(rate, 0.0, 4.0)[0]
    assert min(rate(t) for t in np.linspace(0, 4)) < 0 < max(rate(t) for t in np.linspace(0, 4))
    assert found == pytest.approx(expected, abs=2e-3 * quad(lambda t: abs(rate(t)), 0.0, 4.0)[0])


def test_order_is_two() -> None:
    ends = []
    for step in (0.2, 0.1, 0.05, 0.0125):
        body = alloy(concentration=lambda X: 0.5 + 0.2 * np.cos(K * X[:, 0]))
        system = vv.System([body])
        vv.simulate(system, until=2.0, step=step)
        ends.append(body.values(system.x))
    errors = [np.abs(e - ends[-1]).max() for e in ends[:-1]]
    assert np.log2(errors[0] / errors[1]) > 1.8
    assert np.log2(errors[1] / errors[2]) > 1.8


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()], ids=lambda s: type(s).__name__)
def test_heat_does_work_on_what_stands_still(scheme: object) -> None:
    """Without mobility all that changes is f at fixed c, which is the work of the temperature."""
    body = alloy(concentration=0.3, mobility=1e-12)
    system = vv.System([body])
    result = vv.simulate(system, until=1.0, step=0.1, scheme=scheme)
    end = temperature(1.0)

    def f(T: float) -> float:
        c = 0.3
        return R * T * (c * np.log(c) + (1 - c) * np.log(1 - c)) + c * (1 - c) * (5.0 - 0.4 * T)

    assert result.ledger["work_temperature"][-1] == pytest.approx(8.0 * (f(end) - f(1.0)), rel=1e-12)
    assert result.ledger["potential_stored"][-1] == pytest.approx(8.0 * f(end), rel=1e-12)
    assert sum(body.energies(system.x, system.time)) == pytest.approx(8.0 * f(end), rel=1e-12)


def test_energy_and_mass_close_to_rounding_while_phases_part() -> None:
    body = alloy(concentration=lambda X: 0.5 + 0.3 * np.cos(K * X[:, 0]))
    system = vv.System([body])
    mass = body.integral(system.x)
    result = vv.simulate(system, until=3.0, step=0.1)
    assert result.conservation()["energy"] < 1e-11
    assert np.ptp(result.ledger["work_temperature"]) > 0.1
    assert body.integral(system.x) == pytest.approx(mass, rel=1e-12)


def test_solids_too() -> None:
    solid = vv.MixtureSolid(
        mesh=vv.RectangleMesh(size=(4, 4), counts=(8, 8)),
        material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
        density=1.0,
        free_energy=vv.RegularSolution(
            temperature=[[0, 1.0], [0.2, 1.4], [0.5, 0.8]], excess=[5.0], gas_constant=R
        ),
        gradient_energy=1.0,
        mobility=vv.ArrheniusMobility(base=2.0, activation=3.0, temperature="1 + t", gas_constant=R),
        concentration=lambda X: 0.5 + 0.2 * np.cos(0.8 * X[:, 0]),
        eigenstrain=0.05,
        reference=0.5,
    )
    result = vv.simulate(vv.System([solid]), until=0.5, step=0.05)
    assert result.conservation()["energy"] < 1e-11
    assert np.ptp(result.ledger["work_temperature"]) > 0.1


def test_a_temperature_that_vanishes_in_time_is_refused_with_the_time() -> None:
    system = vv.System(
        [
            alloy(
                free_energy=vv.RegularSolution(temperature="1 - t", excess=[5.0], gas_constant=R),
                gradient_energy=5.0,
            )
        ]
    )
    with pytest.raises(vv.InputError, match=r"RegularSolution: temperature = .* at t = .* is not positive"):
        vv.simulate(system, until=2.0, step=0.1)
    with pytest.raises(vv.InputError, match="temperature = 0 is not positive"):
        vv.ArrheniusMobility(base=1.0, activation=1.0, temperature=0.0)
    with pytest.raises(vv.InputError, match="give an energy"):
        vv.Wetting(body=alloy(), faces="x0", angle=60.0)
