"""Starts with temperatures that even out faster than a step lasts: in a body, between bodies, beside what is held."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

TO_ENDS = [vv.BDF2(), vv.GeneralizedAlpha(), vv.GeneralizedAlpha(rho=0.5), vv.BackwardEuler()]
SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), *TO_ENDS]
MEAN, APART, THICKNESS, CAPACITY = 312.5, 75.0, 0.1, 2.0


def plate(conductivity: float, mean: float = MEAN, apart: float = APART) -> vv.ThermalShell:
    """Insulated, with a difference between its sides."""
    return vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        section=vv.SolidSection(
            material=vv.NeoHooke(young=1e4, poisson=0.0), thickness=THICKNESS, density=1.0
        ),
        heat=vv.Heat(conductivity=conductivity, capacity=CAPACITY, reference=300.0),
        temperature=mean,
        difference=apart,
    )


def held(shell: vv.ThermalShell) -> vv.System:
    return vv.System([shell, vv.Fixed(solid=shell, nodes="all")])


@pytest.mark.parametrize("scheme", SCHEMES, ids=repr)
@pytest.mark.parametrize("conductivity", [0.1, 1.0, 10.0, 1e3, 1e4])
def test_a_plate_with_a_warm_side_ends_at_its_mean(conductivity: float, scheme: vv.Scheme) -> None:
    """It ended at 384 or 1121 K, or its sides turned over in every step.

    Within two thousandths of the difference, as ``exp(-12 k t / c d^2)`` is 1e-5 at most, or that of backward Euler.
    """
    shell = plate(conductivity)
    system = held(shell)
    result = vv.simulate(system, until=0.2, step=0.01, scheme=scheme)
    sides = shell.face_temperatures(system.x)
    assert sides.mean(axis=1) == pytest.approx(MEAN, abs=2e-3 * APART)
    assert np.abs(np.diff(sides, axis=1)).max() < 2e-3 * APART
    assert result.times[-1] == pytest.approx(0.2, rel=1e-14)
    if scheme.conserves_energy:
        assert np.abs(result.ledger["imbalance"]).max() < 1e-12 * CAPACITY * THICKNESS * MEAN


@pytest.mark.parametrize("scheme", SCHEMES[:4], ids=repr)
def test_small_differences_fall_by_the_closed_form(scheme: vv.Scheme) -> None:
    """``exp(-12 k t / c d^2)``, within a step as well as in several."""
    for step in (0.04, 0.005):
        shell = plate(0.1, mean=300.0, apart=1.0)
        system = held(shell)
        vv.simulate(system, until=0.04, step=step, scheme=scheme)
        lower, upper = shell.face_temperatures(system.x)[0]
        assert upper - lower == pytest.approx(np.exp(-12 * 0.1 * 0.04 / (CAPACITY * THICKNESS**2)), abs=0.01)


def test_steps_are_divided_once_and_told(capsys: pytest.CaptureFixture[str]) -> None:
    """On the grid of the whole ones, and the same to the bit where a run goes on."""
    ends = []
    for times in ((0.2,), (0.1, 0.2), (0.01, 0.02, 0.2)):
        shell = plate(10.0)
        system = held(shell)
        for until in times:
            result = vv.simulate(system, until=until, step=0.01)
        ends.append(system.x.copy())
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])
    assert capsys.readouterr().err.count("the first step is divided") == 3
    whole = np.arange(15, 20) * 0.01
    assert np.abs(result.times[:, None] - whole).min(axis=0).max() < 1e-12


def test_steps_that_are_chosen_grow_from_a_divided_one() -> None:
    """To a hundredfold of the step given, not of its part."""
    shell = plate(1e3)
    result = vv.simulate(held(shell), until=0.2, step=0.01, adaptive=vv.Adaptive(min_step=1e-3))
    assert shell.face_temperatures(result.system.x) == pytest.approx(MEAN, abs=2e-3 * APART)
    assert np.diff(result.times).max() > 0.01
    assert result.statistics.steps < 200


def test_gentle_starts_are_left_alone() -> None:
    """Slow conduction, or temperatures that hardly differ."""
    for shell in (plate(1e-3), plate(10.0, mean=300.0, apart=0.01)):
        result = vv.simulate(held(shell), until=0.1, step=0.01)
        assert result.statistics.steps == 10


def test_what_no_steps_follow_is_refused() -> None:
    """With midpoint rules; others need none."""
    with pytest.raises(vv.InputError, match=r"ThermalShell .* even out within .* as fast as a step of 0\.01"):
        vv.simulate(held(plate(1e9)), until=0.1, step=0.01)
    for scheme in TO_ENDS:
        shell = plate(1e9)
        result = vv.simulate(held(shell), until=0.1, step=0.01, scheme=scheme)
        assert result.statistics.steps < 12
        assert shell.face_temperatures(result.system.x) == pytest.approx(MEAN, abs=2e-3 * APART)


@pytest.mark.parametrize("scheme", TO_ENDS, ids=repr)
@pytest.mark.parametrize("conductivity", [1e3, 1e4, 1e5])
def test_small_differences_make_no_heat(conductivity: float, scheme: vv.Scheme) -> None:
    """Of 0.29 K between the sides came up to 145."""
    shell = plate(conductivity, mean=300.0, apart=0.29)
    vv.simulate(system := held(shell), until=0.2, step=0.01, scheme=scheme)
    assert shell.face_temperatures(system.x) == pytest.approx(300.0, abs=2e-3 * 0.29)


@pytest.mark.parametrize("scheme", TO_ENDS, ids=repr)
@pytest.mark.parametrize("by_hand", [False, True])
def test_capacities_that_are_not_met_do_not_count(by_hand: bool, scheme: vv.Scheme) -> None:
    """It ended at 363 where the capacity was two hundred below 280 K, and two from there on."""
    shell = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        section=vv.SolidSection(
            material=vv.NeoHooke(young=1e4, poisson=0.0), thickness=THICKNESS, density=1.0
        ),
        heat=vv.Heat(
            conductivity=10.0,
            capacity=[(200.0, 200.0), (280.0, 200.0), (281.0, CAPACITY), (400.0, CAPACITY)],
            reference=300.0,
        ),
        temperature=330.0,
        difference=30.0,
    )
    system = held(shell)
    for _ in range(20 if by_hand else 0):
        system.step(0.05, scheme)
    if not by_hand:
        vv.simulate(system, until=1.0, step=0.05, scheme=scheme)
    assert shell.face_temperatures(system.x) == pytest.approx(330.0, abs=2e-3 * 30)


def cube(kind: str, second: bool, temperature: float) -> Any:
    """A tenth of a metre wide, even; what deforms is to be held."""
    mesh = vv.BoxMesh(size=(0.1, 1, 1), counts=(1, 1, 1), origin=(0.1 * second, 0, 0))
    rubber, given = vv.NeoHooke(young=1e4, poisson=0.3), {"mesh": mesh, "temperature": temperature}
    heat = vv.Heat(conductivity=1e4, capacity=CAPACITY, reference=300.0)
    if kind == "body":
        return vv.ThermalBody(conductivity=1e4, capacity=CAPACITY, **given)
    if kind == "branches":
        branches = [vv.MaxwellBranch(time=0.1, share=0.5)]
        return vv.ThermoviscoelasticSolid(material=rubber, density=1.0, heat=heat, branches=branches, **given)
    if kind == "user":
        own = vv.UserHeat(function=free_energy, conductivity=1e4, reference=300.0)
        return vv.ThermoelasticSolid(density=1.0, heat=own, **given)
    return vv.ThermoelasticSolid(material=rubber, density=1.0, heat=heat, formulation=kind, **given)


def free_energy(C: Any, T: Any) -> Any:
    """Neo-Hooke without expansion, and heat of a constant capacity."""
    J2 = (
        C[0] * (C[1] * C[2] - C[4] ** 2)
        - C[3] * (C[3] * C[2] - C[4] * C[5])
        + C[5] * (C[3] * C[4] - C[1] * C[5])
    )
    W = 2e3 * (C[0] + C[1] + C[2] - 3 - np.log(J2)) + 1e3 * np.log(J2) ** 2
    return W + CAPACITY * (T - 300 - T * np.log(T / 300))


@pytest.mark.parametrize("scheme", TO_ENDS, ids=repr)
@pytest.mark.parametrize("conductance", [1.0, 100.0, 1e4])
@pytest.mark.parametrize("kind", ["displacement", "F-bar", "mixed", "body", "branches", "user"])
def test_even_bodies_at_two_temperatures_end_between(
    kind: str, conductance: float, scheme: vv.Scheme
) -> None:
    """They ended at 336 and 349 K, without a word; with their entropy alone kept they would at 324.04."""
    first, second = cube(kind, False, 300.0), cube(kind, True, 350.0)
    tie = vv.HeatTie(first=first, first_faces="x1", second=second, second_faces="x0", conductance=conductance)
    held = [vv.Fixed(solid=b, nodes="all") for b in (first, second) if b.balances_entropy]
    system = vv.System([first, second, tie, *held])
    result = vv.simulate(system, until=1.0, step=0.01, scheme=scheme)
    heat = result.ledger["total"]
    apart = 50 * np.exp(-2 * conductance / (CAPACITY * 0.1)) if conductance == 1 else 0.0
    for body, sign in ((first, -1), (second, 1)):
        assert body.temperatures(system.x) == pytest.approx(325.0 + sign * apart / 2, abs=6e-3 * 50)
    assert abs(heat[1] - heat[0]) < 1e-10 * CAPACITY * 325
    assert np.ptp(heat) < (1e-10 if kind == "body" else 6e-3 * 50) * 2 * 0.1 * CAPACITY


def test_shells_whose_entropies_are_not_found_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("visviva.thermal.thermal_shell.ROUNDS", 0)
    with pytest.raises(vv.InputError, match=r"ThermalShell .* no entropies are found .* from 2.* to 3"):
        held(plate(1.0))


def test_temperatures_that_contradict_each_other_later_are_refused() -> None:
    """They were looked at where a run begins alone."""
    shell = plate(1.0, mean=300.0, apart=0.0)
    first, second = (
        vv.PrescribedTemperature(body=shell, nodes=nodes, value=value, name=name)
        for nodes, value, name in (("x0", "300 + t", "warm"), ("y0", 300.0, "even"))
    )
    system = vv.System([shell, first, second, vv.Fixed(solid=shell, nodes="all")])
    with pytest.raises(vv.RunError, match=r"'(warm|even)' and .*'(warm|even)' hold node .* at t = 0\.1"):
        vv.simulate(system, until=0.1, step=0.1)


@pytest.mark.parametrize("kind", ["store", "body", "mixture"])
def test_undamped_schemes_are_refused_for_contents(kind: str) -> None:
    """Stores of 300 and 350 K were at 371 after 200 steps, as what they exchanged went to and fro for ever."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    content: Any = {
        "store": lambda: vv.HeatStore(capacity=2.0, temperature=300.0, name="vessel"),
        "body": lambda: vv.ThermalBody(mesh=mesh, conductivity=1.0, temperature=300.0, name="vessel"),
        "mixture": lambda: vv.CahnHilliard(
            mesh=mesh,
            free_energy=vv.DoubleWell(barrier=1.0),
            gradient_energy=1.0,
            concentration=0.5,
            name="vessel",
        ),
    }[kind]()
    with pytest.raises(vv.InputError, match=r"rho=1\) damps nothing, and what .*'vessel'.* rho up to 0\.8"):
        vv.simulate(vv.System([content]), until=1.0, step=0.1, scheme=vv.GeneralizedAlpha(rho=1.0))
