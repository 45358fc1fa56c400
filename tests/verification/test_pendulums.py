"""Pendulums: simple with tension (IFToMM A01), double, spring pendulum, three rods on ball joints."""

from __future__ import annotations

import numpy as np
import pytest
from reference import chain, pendulums

import visviva as vv
from verification.measure import conserved, errors, extrapolated, follow, orders, reaction_at
from visviva.examples import double_pendulum, pendulum, spring_pendulum, triple_pendulum


def test_simple_pendulum() -> None:
    times = np.linspace(0.0, 10.0, 21)
    reference = pendulums.simple(times)
    exact = np.column_stack([reference["x"], reference["y"], np.zeros(21)])
    runs = [follow(pendulum.study(step=h), ["bob"], times) for h in (0.01, 0.005, 0.0025)]
    e = errors([v for v, _ in runs], exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.02)
    assert e[-1] < 4e-4
    assert np.abs(extrapolated([v for v, _ in runs]) - exact).max() < 1e-8
    conserved(runs[0][1], tolerance=1e-11)


def test_tension_of_the_simple_pendulum() -> None:
    worst = []
    for h in (0.01, 0.005):
        study = pendulum.study(step=h, until=2.5)
        result = vv.simulate(study.system, until=2.5, step=h)
        (bar,) = (c for c in study.system.components if c.name == "bar")
        steps = np.arange(1, len(result.times) - 1, round(0.1 / h))
        exact = pendulums.simple(h * steps)
        pull = -np.column_stack([exact["x"], exact["y"], 0 * exact["x"]]) * exact["tension"][:, None]
        force = np.array([reaction_at(result, bar, k)[0] for k in steps])
        worst.append(np.abs(force - pull).max())
    assert worst[0] < 0.03  # of at most 29.43 N
    assert worst[0] / worst[1] == pytest.approx(4.0, abs=0.5)


def test_double_pendulum() -> None:
    times = np.linspace(0.0, 5.0, 21)
    reference = pendulums.double(times)
    columns = [0, 1, 3, 4]
    exact = np.column_stack([reference[k] for k in ("x1", "y1", "x2", "y2")])
    steps = (0.0025, 0.00125, 0.000625)
    runs = [follow(double_pendulum.study(step=h), ["inner", "outer"], times) for h in steps]
    values = [v[:, columns] for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.1)
    assert e[-1] < 5e-5
    assert np.abs(extrapolated(values) - exact).max() < 1e-8
    conserved(runs[0][1], tolerance=1e-10)


@pytest.mark.parametrize(
    ("scheme", "name"), [(vv.EnergyMomentum(), "energy-momentum"), (vv.Midpoint(), "midpoint")]
)
def test_spring_pendulum_table(scheme: vv.Scheme, name: str) -> None:
    """Position errors at t = 10 digit by digit; they belong to the scheme, so any other scheme fails."""
    for h, expected in zip(pendulums.SPRING_STEPS, pendulums.SPRING_ERRORS[name], strict=True):
        study = spring_pendulum.study(step=h)
        result = vv.simulate(study.system, until=10.0, step=h, scheme=scheme)
        error = np.linalg.norm(result.states[-1][:2] - pendulums.SPRING_END[:2])
        assert float(f"{error:.4e}") == pytest.approx(expected, rel=1e-12)
        drift = np.abs(result.ledger["total"] - 2.5).max()
        assert drift < 1e-9 if name == "energy-momentum" else 1e-5 < drift < 3e-3
        assert np.abs(result.ledger["angular_z"] - 2.2).max() < 1e-9


def test_three_rods_on_ball_joints() -> None:
    """Chaotic: order two is seen up to 1 s."""
    cached = chain.cached()
    exact = np.column_stack([cached[f"{c}{k}"] for k in "123" for c in "xyz"])[:11]
    steps = (0.0025, 0.00125, 0.000625)
    names = ["end1", "end2", "end3"]
    runs = [follow(triple_pendulum.study(step=h), names, cached["t"][:11]) for h in steps]
    values = [v for v, _ in runs]
    e = errors(values, exact)
    assert orders(e) == pytest.approx([2.0, 2.0], abs=0.05)
    assert e[-1] < 1e-5
    assert np.abs(extrapolated(values) - exact).max() < 1e-8


@pytest.mark.parametrize("step", [0.02, 0.01, 0.002])
def test_energy_of_three_rods_over_twenty_seconds(step: float) -> None:
    study = triple_pendulum.study(step=step)
    result = vv.simulate(study.system, until=20.0, step=step, every=10**9)
    energy = result.ledger["total"]
    assert energy[0] == pytest.approx(chain.ENERGY, abs=5e-5)
    assert np.abs(energy - energy[0]).max() < 1e-9 * result.ledger.energy_scale
    result.assert_conserved("energy", "angular_z", "constraints")
