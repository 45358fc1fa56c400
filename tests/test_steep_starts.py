"""Starts with temperatures that even out faster than a step lasts: through a shell, or from node to node."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), vv.BDF2(), vv.GeneralizedAlpha(), vv.BackwardEuler()]
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

    Within two thousandths of the difference, as ``exp(-12 k t / c d^2)`` is 1e-5 at most.
    """
    shell = plate(conductivity)
    system = held(shell)
    result = vv.simulate(system, until=0.2, step=0.01, scheme=scheme)
    sides = shell.face_temperatures(system.x)
    off = 2e-3 * APART if scheme.order == 2 else 2e-3 * MEAN
    assert sides.mean(axis=1) == pytest.approx(MEAN, abs=off)
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
    for scheme in (vv.EnergyMomentum(), vv.BDF2()):
        with pytest.raises(
            vv.InputError, match=r"ThermalShell .* even out within .* as fast as a step of 0\.01"
        ):
            vv.simulate(held(plate(1e9)), until=0.1, step=0.01, scheme=scheme)


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
