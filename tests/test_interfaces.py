"""Phases and interfaces that free energies tell, wherever a run starts and in whichever unit its composition is."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.interpolate import PchipInterpolator, interp1d
from scipy.optimize import brentq, minimize_scalar
from scipy.special import entr

import visviva as vv
from visviva.phase.interface import interface

WELLS = (0.25, 0.0, -0.5, 0.0, 0.25)
"""Of ``(1 - a^2)^2 / 4``, whose interface has the tension ``2 sqrt(2 kappa) / 3`` and the width ``2 sqrt(2 kappa)``."""
STARTS = {
    "front": lambda X: np.tanh((X[:, 0] - 12) / np.sqrt(2)),
    "less": lambda X: 0.3 * np.tanh((X[:, 0] - 12) / np.sqrt(2)),
    "even": 0.0,
}


def order(start: Any, **options: Any) -> vv.AllenCahn:
    """A conserved order parameter with phases of -1 and 1."""
    given: dict[str, Any] = {
        "mesh": vv.RectangleMesh(size=(24, 4), counts=(48, 8)),
        "free_energy": vv.PolynomialEnergy(coefficients=WELLS),
        "gradient_energy": 1.0,
        "order": start,
    }
    return vv.AllenCahn(**{**given, **options})


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("own", [False, True])
def test_phases_are_told_by_the_energy(start: str, own: bool) -> None:
    user = {"free_energy": vv.UserFreeEnergy(function=lambda a: 0.25 * (1 - a**2) ** 2)} if own else {}
    body = order(STARTS[start], **user)
    found = body.interface()
    assert found is not None
    expected = (-1.0, 1.0, 2 * np.sqrt(2) / 3, 2 * np.sqrt(2))
    assert (found.low, found.high, found.tension, found.width) == pytest.approx(expected, rel=1e-6)
    wall = vv.Wetting(body=body, faces="y0", angle=60.0).wall_energy
    assert wall.values(np.array(-1.0)) - wall.values(np.array(1.0)) == pytest.approx(0.5 * found.tension)


def wells_in(unit: float, own: bool) -> vv.FreeEnergy:
    """Wells of 0.3 and 0.7 of a unit, of the core or as a function of the user."""
    if own:
        return vv.UserFreeEnergy(function=lambda c: 5 * (c / unit - 0.3) ** 2 * (0.7 - c / unit) ** 2)
    return vv.DoubleWell(barrier=5 / unit**4, low=0.3 * unit, high=0.7 * unit)


def separating(unit: float, own: bool) -> vv.CahnHilliard:
    return vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(24, 24), counts=(12, 12)),
        free_energy=wells_in(unit, own),
        gradient_energy=2.0 / unit**2,
        mobility=5.0 * unit**2,
        concentration=lambda X: unit * (0.5 + 0.05 * np.cos(0.5 * X[:, 0]) * np.cos(0.4 * X[:, 1])),
    )


def separated(body: vv.CahnHilliard) -> Any:
    system = vv.System([body])
    vv.simulate(system, until=20.0, step=1.0, scheme=vv.BDF2())
    return body.values(system.x)


@pytest.fixture(scope="module")
def plain() -> Any:
    """Concentrations of the double well in unit 1."""
    return separated(separating(1.0, own=False))


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e-14, 1e5])
@pytest.mark.parametrize("own", [False, True])
def test_units_of_the_composition_change_nothing(unit: float, own: bool, plain: Any) -> None:
    body = separating(unit, own)
    found = body.interface()
    assert found is not None
    tension = np.sqrt(2 * 2 * 5) * 0.4**3 / 6
    assert (found.low / unit, found.high / unit, found.tension) == pytest.approx(
        (0.3, 0.7, tension), rel=1e-6
    )
    c = np.array([0.35, 0.62]) * unit
    assert wells_in(unit, True).curvatures(c) == pytest.approx(wells_in(unit, False).curvatures(c), rel=1e-5)
    assert separated(body) / unit == pytest.approx(plain, abs=1e-10)


def roots(*found: float) -> vv.PolynomialEnergy:
    """A polynomial with wells, each a double root."""
    return vv.PolynomialEnergy(
        coefficients=tuple(np.polynomial.Polynomial.fromroots(np.repeat(found, 2)).coef)
    )


@pytest.mark.parametrize(("start", "pair"), [((0, 1), (0, 1)), ((1.2, 2.8), (1, 3)), ((0.4, 0.5), (0, 1))])
def test_of_several_phases_those_of_the_start_are_taken(start: Any, pair: Any) -> None:
    known = roots(0, 1, 3)
    for energy in (known, vv.UserFreeEnergy(function=lambda c: c**2 * (c - 1) ** 2 * (c - 3) ** 2)):
        found = interface(energy, 1.0, start)
        assert found is not None
        assert (found.low, found.high) == pytest.approx(pair, abs=1e-9)


@pytest.mark.parametrize("lift", [0.0, 0.05, -0.2])
def test_what_several_wells_mean_is_asked_for(lift: float) -> None:
    """A run may leave those that it started between, and a middle one that is no phase may stay for long."""
    energy = vv.PolynomialEnergy(
        coefficients=(lift, *(roots(-1, 0, 1).polynomial - lift * roots(-1, 1).polynomial).coef[1:])
    )
    body = order(lambda X: 0.05 * np.sin(X[:, 0]), free_energy=energy, gradient_energy=10.0)
    with pytest.raises(vv.InputError, match=r"more wells than two; .* does not tell: give an energy"):
        vv.Wetting(body=body, faces="y0", angle=60.0)
    system = vv.System([body])
    with pytest.raises(vv.InputError, match=r"more wells than two; .* give phases=\(low, high\)"):
        vv.InterfaceArea(body=body)(system)
    assert vv.InterfaceArea(body=body, phases=(0, 1))(system) > 0


def test_phases_of_what_is_driven_are_asked_for() -> None:
    """Without anything conserved common tangents of wells that are not level tell nothing."""
    tilted = vv.PolynomialEnergy(coefficients=(0.25, 0.1, -0.5, 0.0, 0.25))
    driven, kept = (order(STARTS["front"], free_energy=tilted, conserved=c) for c in (False, True))
    with pytest.raises(vv.InputError, match=r"one phase grows; .* give an energy"):
        vv.Wetting(body=driven, faces="y0", angle=60.0)
    with pytest.raises(vv.InputError, match=r"one phase grows; .* give phases"):
        vv.InterfaceArea(body=driven)(vv.System([driven]))
    assert vv.InterfaceArea(body=kept)(vv.System([kept])) == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize("start", [(-0.1, 0.1), (-0.74, 0.74), (0.86, 0.86), (0.2, 0.95)])
def test_functions_are_looked_at_up_to_their_ends(start: tuple[float, float]) -> None:
    """Ising's mean field ends at -1 and 1; its magnetisation is tanh of 1.5 times itself."""

    def ising(m: Any) -> Any:
        return -0.75 * m**2 + 0.5 * ((1 + m) * np.log(1 + m) + (1 - m) * np.log(1 - m))

    found = interface(vv.UserFreeEnergy(function=ising), 1.0, start)
    assert found is not None
    assert (-found.low, np.tanh(1.5 * found.high)) == pytest.approx((found.high, found.high), rel=1e-9)
    assert interface(vv.UserFreeEnergy(function=lambda c: c * np.log(c)), 1.0, (0.2, 0.4)) is None


@pytest.mark.parametrize("start", [0.02, 0.05, 0.08, 0.5, 0.95, 0.99])
def test_functions_in_other_units_are_looked_at_from_any_start(start: float) -> None:
    """In mol/m3, from one phase alone: a double well, and chains of equal length by logarithms of their own."""
    most = 3e4

    def chains(c: Any) -> Any:
        s = c / most
        return s * np.log(s) + (1 - s) * np.log(1 - s) + 3 * s * (1 - s)

    wells = vv.UserFreeEnergy(function=lambda c: (c / most - 0.05) ** 2 * (c / most - 0.95) ** 2)
    known = interface(vv.FloryHuggins(chi=3.0), 1.0, (0.5, 0.5))
    assert known is not None
    for energy, pair in (
        (wells, (0.05, 0.95)),
        (vv.UserFreeEnergy(function=chains), (known.low, known.high)),
    ):
        found = interface(energy, 1.0, (start * most, start * most))
        assert found is not None
        assert (found.low / most, found.high / most) == pytest.approx(pair, rel=1e-9)


@pytest.mark.parametrize("raised", [0.3, 0.6, 0.8])
def test_phases_that_last_without_a_well_are_others(raised: float) -> None:
    """The one in the middle is none over the outer tangent, and yet fronts to it stand still."""
    outer = roots(0, 3).polynomial
    energy = vv.PolynomialEnergy(coefficients=tuple((roots(0, 1, 3).polynomial + raised * outer).coef))
    found = interface(energy, 1.0, (0.1, 0.9))
    assert found is not None
    assert (found.low, found.high) == pytest.approx((0, 3), abs=1e-9)
    assert not found.alone


@pytest.mark.parametrize("soft", [0.1, 1e-3])
def test_phases_far_from_where_a_polynomial_bends_down(soft: float) -> None:
    """It bends down between 0.44 and 0.88; a phase of 0 was not found, and no interface was too thin."""
    one, mesh = Polynomial([0.0, 1.0]), vv.RectangleMesh(size=(8, 1), counts=(16, 2))
    energy = vv.PolynomialEnergy(coefficients=tuple((one**2 * (1 - one) ** 2 * (soft + 3 * one**2)).coef))
    c = np.linspace(0, 1, 10001)
    width = np.sqrt(1.0 / (2 * np.max(energy.values(c))))
    found = vv.AllenCahn(mesh=mesh, free_energy=energy, gradient_energy=1.0, order=0.6).interface()
    assert found is not None
    assert (found.low, found.high, found.width) == pytest.approx((0.0, 1.0, width), abs=1e-6)
    with pytest.raises(vv.InputError, match="less than two cells resolve it"):
        vv.AllenCahn(mesh=mesh, free_energy=energy, gradient_energy=0.99 * width**-2, order=0.6)


@pytest.mark.parametrize("temperature", [900.0, 999.0, 999.9])
def test_phases_near_the_critical_point(temperature: float) -> None:
    """Of a regular solution: ``ln(c / (1 - c)) = 2 T_c / T (2 c - 1)``."""
    R = 8.31446261815324
    energy = vv.RegularSolution(temperature=temperature, excess=[2 * R * 1000], volume=R * 1000)
    found = interface(energy, 1.0, (0.5, 0.5))
    assert found is not None
    c = found.high
    assert np.log(c / (1 - c)) == pytest.approx(2000 / temperature * (2 * c - 1), rel=1e-9)
    assert found.low == pytest.approx(1 - c)


@pytest.mark.parametrize("wells", [1e4, 1e-9])
def test_wells_of_functions_are_found_from_zero(wells: float) -> None:
    energy = vv.UserFreeEnergy(function=lambda c: (1 - (c / wells) ** 2) ** 2)
    for start in ((0.0, 0.0), (-0.01 * wells, 0.01 * wells)):
        found = interface(energy, 1.0, start)
        assert found is not None
        assert (found.low / wells, found.high / wells) == pytest.approx((-1, 1))


def test_steps_of_wells_far_from_zero_follow_their_distance() -> None:
    steps = []
    for off in (0.0, 1e4):
        body = order(
            lambda X, off=off: off + 0.5 + 0.1 * np.cos(np.pi * X[:, 0] / 12),
            free_energy=vv.DoubleWell(barrier=1.0, low=off, high=off + 1),
        )
        system = vv.System([body])
        result = vv.simulate(
            system, until=20.0, step=0.05, adaptive=vv.Adaptive(tolerance=1e-3), scheme=vv.BDF2()
        )
        steps.append(len(result.times))
    assert steps[0] == steps[1]


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e-9])
def test_steps_of_what_does_not_separate_follow_its_size(unit: float) -> None:
    """Adaptive steps of plain diffusion from a wave: the same in every unit."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(16, 2)),
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, 0.5)),
        gradient_energy=1e-6,
        concentration=lambda X: unit * (1 + np.cos(np.pi * X[:, 0] / 4)),
    )
    system = vv.System([body])
    result = vv.simulate(system, until=2.0, step=0.01, adaptive=vv.Adaptive(tolerance=1e-3), scheme=vv.BDF2())
    assert np.ptp(body.values(system.x)) / unit == pytest.approx(2 * np.exp(-(np.pi**2) / 16 * 2), rel=0.02)
    assert len(result.times) > 15


def test_energies_without_a_barrier_have_no_phases() -> None:
    for energy in (
        vv.PolynomialEnergy(coefficients=(0.0, 1.0, 0.5)),
        vv.PolynomialEnergy(coefficients=(0.0, 0.0, 0.0, 0.0, 1.0)),
        vv.PolynomialEnergy(coefficients=(0.0, 0.0, -1.0)),
        vv.UserFreeEnergy(function=lambda c: c**2),
        vv.UserFreeEnergy(function=lambda c: 3 * c),
    ):
        assert interface(energy, 1.0, (0.2, 0.4)) is None


def test_a_tilt_leaves_a_polynomial_its_phases() -> None:
    """A linear term moves no common tangent, though wells vanish by it."""
    found = interface(vv.PolynomialEnergy(coefficients=(0.25, 3.0, -0.5, 0.0, 0.25)), 1.0, (0.0, 0.0))
    assert found is not None
    assert (found.low, found.high) == pytest.approx((-1.0, 1.0), abs=1e-9)


def test_of_many_wells_two_beside_each_other_are_phases() -> None:
    waves = vv.UserFreeEnergy(function=lambda c: 1 - np.cos(2 * np.pi * c))
    found = interface(waves, 1.0, (0.1, 2.4))
    assert found is not None
    assert found.high - found.low == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("start", [(0.5, 0.5), (0.48, 0.52), (0.35, 0.45)])
def test_energies_are_asked_for_few_values(start: tuple[float, float]) -> None:
    """Waves, whose wells go on for ever, and what falls for ever: some windows of samples, and some Newton steps."""
    asked: list[int] = []

    def counted(function: Any) -> Any:
        return vv.UserFreeEnergy(function=lambda c: (asked.append(np.size(c)), function(c))[1])

    found = interface(counted(lambda c: np.cos(2 * np.pi * c)), 1.0, start)
    assert found is not None
    assert (found.low, found.high) == pytest.approx((-0.5, 0.5))
    assert not found.alone
    assert len(asked) < 150
    assert sum(asked) < 60_000
    assert (
        interface(counted(lambda c: c**3 - 3 * c**2), 1.0, start) is None
    )  # followed twice: by doubling, by little
    assert len(asked) < 300
    assert sum(asked) < 400_000


@pytest.mark.parametrize("start", [(0.45, 0.55), (0.5, 0.5), (0.4, 0.4)])
def test_corners_and_rounding_of_functions_are_no_phases(start: tuple[float, float]) -> None:
    """A parabola as a table, in single precision, and with noise separates nowhere."""
    t, noise = np.linspace(0, 1, 41), np.random.default_rng(1)
    for parabola in (
        lambda c: np.interp(np.real(c), t, (t - 0.4) ** 2),
        lambda c: (1 + (np.real(c) - 0.4) ** 2).astype(np.float32).astype(float),
        lambda c: (np.real(c) - 0.4) ** 2 + 1e-6 * noise.random(np.size(c)),
    ):
        assert interface(vv.UserFreeEnergy(function=parabola), 1.0, start) is None


@pytest.mark.parametrize("start", [(0.45, 0.55), (0.5, 0.5), (0.05, 0.06)])
def test_wells_of_rough_functions_are_phases(start: tuple[float, float]) -> None:
    t = np.linspace(-1, 2, 1201)
    for wells in (
        lambda c: np.interp(np.real(c), t, (t * (1 - t)) ** 2),
        lambda c: (1 + (c * (1 - c)) ** 2).real.astype(np.float32).astype(float),
    ):
        found = interface(vv.UserFreeEnergy(function=wells), 1.0, start)
        assert found is not None
        assert (found.low, found.high) == pytest.approx((0.0, 1.0), abs=2e-3)
        assert found.tension == pytest.approx(np.sqrt(2) / 6, rel=1e-3)
        assert found.alone


@pytest.mark.parametrize("start", [(0.2, 0.8), (0.5, 0.5), (0.5, 0.9)])
def test_wells_in_a_plain_are_phases(start: tuple[float, float]) -> None:
    """Two Gaussian wells, each at its own place as the other is far away."""
    energy = vv.UserFreeEnergy(
        function=lambda c: -np.exp(-50 * (c - 0.2) ** 2) - np.exp(-50 * (c - 0.8) ** 2)
    )
    found = interface(energy, 1.0, start)
    assert found is not None
    assert (found.low, found.high) == pytest.approx((0.2, 0.8))
    assert found.alone


def test_functions_have_other_wells_where_polynomials_have_them() -> None:
    for wells, alone in (((0, 1), True), ((0, 1, 3), False), ((-4, 0, 1), False), ((0, 1, 9), False)):
        known = roots(*wells)
        for energy in (known, vv.UserFreeEnergy(function=known.polynomial)):
            found = interface(energy, 1.0, (0.1, 0.9))
            assert found is not None
            assert (found.low, found.high) == pytest.approx((0, 1), abs=1e-9)
            assert found.alone == alone


@pytest.mark.parametrize("start", ["front", "less"])
def test_a_front_has_its_area(start: str) -> None:
    body = order(STARTS[start])
    system = vv.System([body])
    vv.simulate(system, until=40.0, step=1.0, scheme=vv.BackwardEuler())
    assert vv.InterfaceArea(body=body)(system) == pytest.approx(4.0, rel=1e-4)


def test_the_area_follows_phases_of_the_time_being() -> None:
    """A cooled front is as large as one that has been cold all the time."""
    R, areas = 8.31446261815324, []
    for temperature in ([[0, 900.0], [1, 600.0], [100, 600.0]], 600.0):
        body = vv.CahnHilliard(
            mesh=vv.RectangleMesh(size=(24, 4), counts=(48, 8)),
            free_energy=vv.RegularSolution(temperature=temperature, excess=[2 * R * 1000], volume=R * 1000),
            gradient_energy=1.0,
            concentration=lambda X: 0.5 + 0.25 * np.tanh((X[:, 0] - 12) / 2),
        )
        system = vv.System([body])
        vv.simulate(system, until=60.0, step=2.0, scheme=vv.BackwardEuler())
        areas.append(vv.InterfaceArea(body=body)(system))
    assert areas[0] == pytest.approx(areas[1], rel=0.02)


def quenched(temperature: Any, gradient: float = 1.0) -> vv.CahnHilliard:
    """A regular solution with cells of 3; interfaces at 600 K are 1.95 wide for a gradient energy of 1."""
    R = 8.31446261815324
    return vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(60, 6), counts=(20, 2)),
        free_energy=vv.RegularSolution(temperature=temperature, excess=(2 * R * 1000,), volume=R * 1000),
        gradient_energy=gradient,
        concentration=lambda X: 0.5 + 0.1 * np.cos(2 * np.pi * X[:, 0] / 30),
    )


def test_interfaces_that_become_too_thin_are_refused() -> None:
    said = r"an interface is 1\.95 wide at t = 0\.5, the distance of its nodes 3: .* gradient_energy of 9\.47"
    for hot in (1100.0, 990.0):
        with pytest.raises(vv.InputError, match=said):
            quenched([[0, hot], [0.5, 600.0], [1000, 600.0]])
    with pytest.raises(vv.InputError, match=r"an interface is 1\.95 wide, the distance"):
        quenched([[0, 600.0], [0.5, 1100.0]])


@pytest.mark.parametrize("cooling", ["1100 - 10*t", lambda t: 1100 - 10 * t])
def test_runs_end_where_interfaces_become_too_thin(cooling: Any) -> None:
    """Where an expression or a function leads is known when a run gets there."""
    system = vv.System([quenched(cooling)])
    with pytest.raises(vv.InputError, match=r"CahnHilliard.*: an interface is 5\.67 wide at t = 16,"):
        vv.simulate(system, until=50.0, step=1.0, scheme=vv.BackwardEuler())

    def width(time: float) -> float:  # sqrt(kappa / 2 df), of equal phases about a half
        T = 1.1 - 0.01 * time
        c = brentq(lambda c: T * np.log(c / (1 - c)) - 4 * c + 2, 0.5001, 0.9999)
        rise = T * np.log(0.5) + 0.5 - T * (c * np.log(c) + (1 - c) * np.log(1 - c)) - 2 * c * (1 - c)
        return float((2 * c - 1) / np.sqrt(2 * rise))

    assert width(system.time) > 6 > width(system.time + 1)


def test_grains_have_the_phases_that_are_given() -> None:
    energy = vv.PolynomialEnergy(coefficients=(0.0, 0.0, -0.5, 0.0, 0.25))
    grains = [
        vv.AllenCahn(
            mesh=vv.RectangleMesh(size=(8, 1), counts=(32, 2)),
            free_energy=energy,
            gradient_energy=0.5,
            order=lambda X, sign=sign: 0.5 + 0.5 * sign * np.tanh(X[:, 0] - 4),
        )
        for sign in (-1, 1)
    ]
    apart = vv.Exclusion(bodies=grains, strength=1.5)
    system = vv.System([*grains, apart])
    assert vv.InterfaceArea(body=grains[0], phases=(0, 1))(system) == pytest.approx(1.0, rel=1e-3)
    with pytest.raises(vv.InputError, match="does not tell its phases; give phases"):
        vv.InterfaceArea(body=grains[0])(system)
    with pytest.raises(vv.InputError, match="do not ascend"):
        vv.InterfaceArea(body=grains[0], phases=(1, 0))
    bodies = copy.deepcopy(grains)
    wall = vv.Wetting(body=bodies[0], faces="y0", angle=60.0)
    with pytest.raises(vv.InputError, match="what an angle stands for; give an energy"):
        vv.System([*bodies, vv.Exclusion(bodies=bodies, strength=1.5), wall])


def test_angles_need_a_gradient_energy_alike_in_all_directions() -> None:
    with pytest.raises(vv.InputError, match="another one for every direction of the wall; give an energy"):
        vv.Wetting(body=order(0.0, gradient_energy=(4, 1, 1)), faces="y0", angle=60.0)
    across, plain = (
        vv.Wetting(body=order(0.0, gradient_energy=K), faces="y0", angle=60.0) for K in ((1, 1, 0.04), 1.0)
    )
    assert across.wall_energy.polynomial == plain.wall_energy.polynomial


def test_mobilities_within_mobilities_follow_their_temperature() -> None:
    T = [[0, 1000.0], [1, 2000.0], [10, 2000.0]]
    inner = vv.ArrheniusMobility(base=1.0, activation=2e4, temperature=T)
    nested = vv.ArrheniusMobility(base=inner, activation=1e4, temperature=500.0)
    expected = np.exp(-2e4 / (8.31446261815324 * 2000)) * np.exp(-1e4 / (8.31446261815324 * 500))
    assert nested.changes
    assert nested.at(5.0).values(np.array(0.5)) == pytest.approx(expected)


@pytest.mark.parametrize("start", [0.03, 0.45, 0.55, 0.97])
def test_gaps_at_the_ends_of_logarithms_count(start: float) -> None:
    """Of an alloy, or a battery, with two gaps in 0 ... 1 one was taken for all: areas of 1.5 and 3.4 for 2."""
    R = 8.31446261815324
    energies: list[Any] = [
        vv.RegularSolution(temperature=600.0, excess=[0.0, 0.0, 4.5 * 600.0 * R], volume=600.0 * R),
        vv.UserFreeEnergy(
            function=lambda c: c * np.log(c) + (1 - c) * np.log(1 - c) + np.sin(2 * np.pi * c) ** 2
        ),
    ]
    for energy in energies:
        found = interface(energy, 1e-3, (start, start))
        assert found is not None
        assert not found.alone
        assert (found.low < 0.5) == (start < 0.5)


@pytest.mark.parametrize("start", [(0.05, 0.05), (0.2, 0.2), (0.49, 0.51), (0.95, 0.95), (0.02, 0.98)])
def test_what_falls_beyond_what_it_is_meant_for_has_phases(start: tuple[float, float]) -> None:
    """As extrapolated tables do: thin interfaces passed, and a strip filled to .109 for .256."""

    def well(c: Any) -> Any:
        off = np.maximum(np.where(np.real(c) > 0.5, np.real(c) - 1.05, -0.05 - np.real(c)), 0.0)
        return 4 * (c - 0.05) ** 2 * (c - 0.95) ** 2 - 2e3 * off**4

    found = interface(vv.UserFreeEnergy(function=well), 0.01, start)
    assert found is not None
    assert (found.low, found.high) == pytest.approx((0.05, 0.95), abs=1e-6)


@pytest.mark.parametrize("start", [0.01, 0.02, 0.0245, 0.03, 0.1])
def test_a_pole_where_values_end_hides_no_phases(start: float) -> None:
    """Hard spheres that attract each other (Carnahan & Starling 1969), from vapour: values grow beyond bounds at 1."""
    spheres = vv.UserFreeEnergy(
        function=lambda e: e * (np.log(e) - 1) + e * (4 * e - 3 * e**2) / (1 - e) ** 2 - 13 * e**2
    )
    found = interface(spheres, 1e-3, (start, start))
    assert found is not None
    pair = np.array([found.low, found.high])
    slopes, values = spheres.slopes(pair), spheres.values(pair)
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-9)
    assert values[1] - values[0] == pytest.approx(slopes[0] * (pair[1] - pair[0]), rel=1e-9)
    assert pair == pytest.approx([0.0244, 0.2988], abs=1e-4)


def apart(x: Any, low: float = 0.1, high: float = 0.9) -> Any:
    """Two level wells."""
    return (x - low) ** 2 * (high - x) ** 2


def mixed(x: Any) -> Any:
    return x * np.log(x) + (1 - x) * np.log(1 - x) + 3 * x * (1 - x)


KNOTS = np.linspace(0, 1, 201)
BINODAL = brentq(lambda x: np.log(x / (1 - x)) + 3 * (1 - 2 * x), 0.01, 0.2)
TABLE = PchipInterpolator(KNOTS, -entr(KNOTS) - entr(1 - KNOTS) + 3 * KNOTS * (1 - KNOTS), extrapolate=False)
EXTRAPOLATED = interp1d(np.linspace(-0.3, 1.3, 1601), apart(np.linspace(-0.3, 1.3, 1601)))
SEPARATING: dict[str, tuple[Any, float, float]] = {
    "logarithms": (mixed, BINODAL, 1e-9),
    "odd": (lambda x: apart(x) * (1.5 - x), 0.1, 1e-9),
    "odd at once": (lambda x: apart(x) * (1.1 - x), 0.1, 1e-9),
    "falling on both sides": (lambda x: apart(x) * (1.02 - x) * (x + 0.02), 0.1, 1e-9),
    "falling steeply": (lambda x: apart(x) - np.exp(400 * (x - 1)) - np.exp(-400 * x), 0.1, 1e-4),
    "odd poles beyond": (lambda x: apart(x) + 1e-5 / (0.95 - x) + 1e-5 / (x - 0.05), 0.1, 0.02),
    "even poles beyond": (lambda x: apart(x) + 1e-7 / (0.95 - x) ** 2 + 1e-7 / (x - 0.05) ** 2, 0.1, 0.02),
    "penalties": (lambda x: apart(x) + np.where((x.real < 0) | (x.real > 1), 1e6, 0.0), 0.1, 1e-6),
    "rippled table": (lambda x: TABLE(x.real), BINODAL, 0.02),
    "table with ends": (lambda x: EXTRAPOLATED(x.real), 0.1, 2e-3),
    "single precision": (
        lambda x: (1 + 16 * apart(x.real)).astype(np.float32).astype(float),
        0.1,
        2e-3,
    ),
    "noise": (lambda x: apart(x) + 1e-9 * np.modf(1e3 * np.sin(1e7 * x.real))[0], 0.1, 5e-3),
    "lifted": (lambda x: 1e5 - 3e4 * x + 1e3 * apart(x), 0.1, 1e-6),
    "deeper far away": (lambda x: apart(x) - 5 * np.exp(-(((x - 3) / 0.3) ** 2)), 0.1, 1e-6),
}
"""Energies of what is between 0 and 1, the lower of phases that lie alike about a half, and how near these are told."""


@pytest.mark.parametrize("unit", [1e-14, 1.0, 3e4, 1e9])
@pytest.mark.parametrize("name", SEPARATING)
def test_phases_of_functions_are_found_in_any_unit_from_any_start(name: str, unit: float) -> None:
    function, low, near = SEPARATING[name]
    energy = vv.UserFreeEnergy(function=lambda c: function(c / unit))
    if name == "odd poles beyond" or name == "even poles beyond":
        low = minimize_scalar(
            lambda x: function(np.array(x)), bounds=(0.051, 0.3), options={"xatol": 1e-12}
        ).x
    x = np.linspace(low, 1 - low, 4001)
    rise = function(x) - np.interp(x, x[[0, -1]], function(x[[0, -1]]))
    width = (1 - 2 * low) / np.sqrt(2 * rise.max())
    for start in ((low, low), (0.93, 0.93), (0.5, 0.5), (0.3, 0.3 + 1e-6), (0.2, 0.4), (0.11, 0.89)):
        found = interface(energy, 1.0, (start[0] * unit, start[1] * unit))
        assert found is not None
        assert (found.low / unit, found.high / unit) == pytest.approx((low, 1 - low), abs=near)
        assert found.width / unit == pytest.approx(width, rel=0.01)


@pytest.mark.parametrize("start", [0.1, 0.9])
def test_thin_interfaces_of_an_electrode_are_refused_from_one_phase(start: float) -> None:
    """In mol/m3, by a polynomial that falls beyond: none were found, and .0834 came out for an energy of .1788."""
    most = 3e4
    with pytest.raises(
        vv.InputError, match=r"an interface is 0\.35 wide, .*: less than two cells resolve it"
    ):
        vv.CahnHilliard(
            mesh=vv.RectangleMesh(size=(24, 4), counts=(48, 8)),
            free_energy=vv.UserFreeEnergy(function=lambda c: apart(c / most) * (1.5 - c / most)),
            gradient_energy=0.01 / most**2,
            concentration=lambda X: most * (start + 1e-6 * np.cos(X[:, 0])),
        )


def narrow(most: float) -> vv.UserFreeEnergy:
    """Phases of .49835 and .50165 of `most`."""

    def function(c: Any) -> Any:
        off = c / most - 0.5
        return off**2 + 16 * 0.0007**2 * np.exp(-((off / 0.0014) ** 2) / 2)

    return vv.UserFreeEnergy(function=function)


def falling(most: float) -> vv.PolynomialEnergy:
    """Phases of .499 and .501 of `most`, and less energy than theirs far beyond."""
    terms = (0.0, 0.0, -2e-6, 0.0, 1.0, -0.2)
    return vv.PolynomialEnergy(coefficients=[a / most**k for k, a in enumerate(terms)], centre=0.5 * most)


@pytest.mark.parametrize("most", [1.0, 3e4])
@pytest.mark.parametrize(
    ("form", "energy"),
    [(vv.CahnHilliard, narrow), (vv.CahnHilliard, falling), (vv.MixtureSolid, falling)],
    ids=lambda part: str(part.__name__),
)
def test_thin_interfaces_far_from_the_start_are_refused_on_the_way(
    form: Any, energy: Any, most: float
) -> None:
    """Between phases that nothing tells of where it starts: where the field comes to bend down, they are looked for."""

    def driven(width: float) -> vv.System:
        given: dict[str, Any] = {
            "mesh": vv.RectangleMesh(size=(1, 0.1), counts=(40, 2), cell="quad4"),
            "free_energy": energy(most),
            "gradient_energy": (width / (2.1255 if energy is narrow else 1414.2) / most) ** 2,
            "mobility": most**2,
            "concentration": 0.1 * most,
        }
        if form is vv.MixtureSolid:
            soft = vv.SaintVenantKirchhoff(young=1e-6, poisson=0.3)
            given |= {"material": soft, "eigenstrain": 0.0, "reference": 0.0}
        body = form(**given)
        inflow = vv.PrescribedConcentration(body=body, nodes="x0", value=f"{most} * (0.1 + 0.5 * t)")
        held = [vv.Fixed(solid=body, nodes="all")] if form is vv.MixtureSolid else []
        assert body.interface() is None
        return vv.System([body, inflow, *held])

    system = driven(0.02)
    with pytest.raises(
        vv.InputError, match=r"an interface is 0\.02 wide, between .*less than two cells"
    ) as refused:
        vv.simulate(system, until=1.0, step=0.02, scheme=vv.BackwardEuler())
    assert 0.5 < system.time < 1.0  # where it has come to them
    assert str(refused.value).endswith(f"in the step from t = {system.time:g} to {system.time + 0.02:g}")
    system = driven(0.2)
    vv.simulate(system, until=1.0, step=0.02, scheme=vv.BackwardEuler())
    assert system.time == 1.0


THREE = 100 * np.polynomial.Polynomial.fromroots([0.0, 0.0, 0.2, 0.2, 1.0, 1.0])
"""Wells at 0, .2 and 1."""


@pytest.mark.parametrize(
    "energy",
    [vv.UserFreeEnergy(function=lambda c: THREE(c)), vv.PolynomialEnergy(coefficients=list(THREE.coef))],
    ids=["function", "polynomial"],
)
def test_thin_interfaces_between_other_wells_are_refused_on_the_way(energy: vv.FreeEnergy) -> None:
    """Those that a field has beside the nearest to its start, even without a node within: content was below zero."""
    body = vv.CahnHilliard(
        mesh=vv.RectangleMesh(size=(20, 0.9), counts=(22, 1)),
        free_energy=energy,
        gradient_energy=2.0,
        concentration=0.02,
    )
    near = body.interface()
    assert near is not None
    assert near.width > 2 * 20 / 22
    system = vv.System([body, vv.PrescribedConcentration(body=body, nodes="x0", value=1.02)])
    with pytest.raises(vv.InputError, match=r"wide, between 0\.\d* and 1, the distance of its nodes 0\.909"):
        vv.simulate(system, until=1.0, step=0.05, scheme=vv.BackwardEuler())


@pytest.mark.parametrize("chi", [8.0, 12.0, 16.0])
def test_steep_walls_hide_no_phases(chi: float) -> None:
    """Logarithms that parabolas continue: by their kink the energy was taken for rough, and nothing separated."""

    def entropy(c: Any) -> Any:
        near = 1e-9
        inside = np.where(np.real(c) > near, c, near)
        beyond = c * np.log(near) + (c - near) + (c - near) ** 2 / (2 * near)
        return np.where(np.real(c) > near, c * np.log(inside), beyond)

    energy = vv.UserFreeEnergy(function=lambda c: entropy(c) + entropy(1 - c) + chi * c * (1 - c))
    binodal = brentq(lambda c: np.log(c / (1 - c)) + chi * (1 - 2 * c), 1e-9, 0.2)
    for start in (0.3, 0.5, 0.01):
        found = interface(energy, 1.0, (start, start))
        assert found is not None
        assert (found.low, found.high) == pytest.approx((binodal, 1 - binodal), abs=1e-3)


def test_what_is_empty_has_phases_in_any_unit() -> None:
    energy = vv.UserFreeEnergy(function=lambda c: ((c / 1.4e28 - 0.05) * (c / 1.4e28 - 0.95)) ** 2)
    found = interface(energy, 1.0, (0.0, 0.0))
    assert found is not None
    assert (found.low, found.high) == pytest.approx((0.05 * 1.4e28, 0.95 * 1.4e28), rel=1e-3)


def test_wells_that_are_far_away_for_those_found_count() -> None:
    """Of .02, .07 and .95 the last was not seen: areas of 20 for 1."""
    wells = np.polynomial.Polynomial.fromroots([0.02, 0.02, 0.07, 0.07, 0.95, 0.95])
    found = interface(vv.UserFreeEnergy(function=lambda c: wells(c)), 1.0, (0.03, 0.03))
    assert found is not None
    assert not found.alone


def grain(stretch: float, along: float) -> vv.AllenCahn:
    """A round grain, in coordinates x that are stretched, with so much gradient energy along them."""
    width = 4.0 * vv.DoubleWell(barrier=1.0).values(np.array(0.5)).item()
    return vv.AllenCahn(
        mesh=vv.RectangleMesh(size=(20 * stretch, 20), counts=(20, 20)),
        free_energy=vv.DoubleWell(barrier=1.0),
        gradient_energy=tuple(2.2 * width * k for k in (along, 1.0, 1.0)),
        order=lambda X: 0.5 - 0.5 * np.tanh(np.hypot(X[:, 0] / stretch - 10, X[:, 1] - 10) - 5),
    )


def test_cells_may_be_as_long_as_interfaces_are_wide() -> None:
    """Cells that follow the gradient energy were refused, by the longest side and the thinnest interface."""
    ends = []
    for stretch in (1.0, 4.0):
        body = grain(stretch, stretch**2)
        system = vv.System([body])
        vv.simulate(system, until=2.0, step=0.1)
        ends.append(body.values(system.x))
    np.testing.assert_allclose(*ends, atol=1e-9)  # the same but for the coordinate
    for stretch, along in ((4.0, 8.0), (1.0, 0.5)):
        with pytest.raises(vv.InputError, match="less than two cells resolve it"):
            grain(stretch, along)


@pytest.mark.parametrize(
    ("cell", "size", "told"), [("quad4", 0.47, True), ("quad4", 0.3, False), ("quad9", 0.6, True)]
)
def test_few_cells_hold_flat_fronts_back(cell: Any, size: float, told: bool) -> None:
    """A front that the tension over 100 widths drives: where it stands still the check says so."""
    width, length = np.sqrt(32), 8 * np.sqrt(32)
    n, a = round(length / (size * width)), 0.5 - 1 / (np.sqrt(2) * 100 * width)
    mesh = vv.RectangleMesh(size=(length, 1), counts=(n, 1), cell=cell)
    body = vv.AllenCahn(
        mesh=mesh,
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, a / 2, -(1 + a) / 3, 0.25)),
        gradient_energy=1.0,
        order=lambda X: 0.5 - 0.5 * np.tanh((X[:, 0] - length / 2) / np.sqrt(8)),
    )
    system, time = vv.System([body]), 100 * width * width
    vv.simulate(system, until=time / 2, step=time / 40)
    begun = body.integral(system.x)
    vv.simulate(system, until=3 * time / 2, step=time / 40)
    speed = (body.integral(system.x) - begun) / time * 100 * width
    assert speed == pytest.approx(0.0 if told else 1.037, abs=0.01)
    assert any("slow down, or stand still" in remark for remark in body.remarks()) == told
