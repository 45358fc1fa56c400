"""What the tiny instances owe beyond the properties of the whole catalogue."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from instances.heat import Bar
from instances.immersed import ImmersedSolid
from instances.shapes import gauss, hex8
from instances.solid import Brick
from instances.stokes import StokesCell

import visviva as vv
from visviva.model.model import Model
from visviva.study.run import run as run_study

run = partial(run_study, pictures=False, progress=False)


def test_insulated_bar_keeps_its_heat_and_becomes_even() -> None:
    system = vv.System([bar := Bar(exchange=0.0)])
    result = vv.simulate(system, until=3.0, step=0.02)
    assert result.ledger["potential_heat"] == pytest.approx(result.ledger["potential_heat"][0], rel=1e-13)
    spread = [np.ptp(x[bar.heat.unknowns]) for x in result.states]
    assert np.all(np.diff(spread[:100]) < 0)
    assert spread[-1] < 1e-9 * spread[0]


def test_bar_decays_at_its_lowest_eigenvalue() -> None:
    n = 41
    s = np.linspace(0, 1, n)
    system = vv.System([bar := Bar(temperatures=np.cos(np.pi * s), exchange=0.0)])
    vv.simulate(system, until=0.1, step=0.001)
    exact = np.exp(-(np.pi**2) * 0.1) * np.cos(np.pi * s)
    assert system.x[bar.heat.unknowns] == pytest.approx(exact, abs=2e-4)


def test_stokes_cell_loses_what_viscosity_takes() -> None:
    system = vv.System([cell := StokesCell()])
    result = vv.simulate(system, until=2.0, step=0.05)
    assert np.all(np.diff(result.ledger["total"]) < 0)
    divergence = [cell.B @ x[cell.velocity.unknowns] for x in result.states]
    assert np.abs(divergence).max() < 1e-14
    momentum = [(cell.M @ x[cell.velocity.unknowns]).reshape(-1, 2).sum(axis=0) for x in result.states]
    assert np.ptp(momentum, axis=0).max() < 1e-13


def test_immersed_solid_moves_with_the_background() -> None:
    system = vv.System([body := ImmersedSolid()])
    M = np.kron(sum(w * np.outer(N := hex8(xi)[0], N) for xi, w in zip(*gauss(2, 3), strict=True)), np.eye(3))
    result = vv.simulate(system, until=1.0, step=0.02)
    momentum = [(M @ x).reshape(-1, 3).sum(axis=0) for x in result.states]
    assert np.ptp(momentum, axis=0).max() < 1e-13
    assert np.ptp(result.ledger["potential_strain"]) > 1e-3
    assert np.abs(body.solid.history["position"]).max() < 1.0


def test_immersed_solid_resumes_to_the_last_bit(tmp_path: Path) -> None:
    def study(until: float) -> vv.Study:
        return vv.Study(vv.System([ImmersedSolid()]), until=until, step=0.02)

    whole, part, rest = study(0.4), study(0.2), study(0.4)
    run(whole, tmp_path / "whole")
    run(part, tmp_path / "split")
    run(rest, tmp_path / "split", resume=True)
    assert rest.system.x.tobytes() == whole.system.x.tobytes()
    histories = [s.system.components[0].solid.history["position"] for s in (whole, rest)]
    assert histories[0].tobytes() == histories[1].tobytes()


def test_static_brick_finds_back_to_its_shape() -> None:
    """The held brick, pushed out of shape, is stress-free in static equilibrium."""
    system = vv.System([brick := Brick(fixed=True, speed=0.0)])
    free = ~brick.motion.fixed
    rest = system.x[brick.motion.unknowns].copy()
    system.x[np.array(brick.motion.unknowns)[free]] += 0.05 * np.random.default_rng(2).standard_normal(12)
    system.invalidate()
    system.step(1.0, vv.Static())
    assert system.x[brick.motion.unknowns] == pytest.approx(rest, abs=1e-12)


# --- what held unknowns take in -----------------------------------------------------------------------------


class HeldBar(Bar):
    """A bar with its ends at given temperatures; the right one may change in time."""

    right: Any = None

    def declare(self, model: Model) -> None:
        super().declare(model)
        model.hold(self.heat, [0])
        if self.right is None:
            model.hold(self.heat, [self.heat.size - 1])

    def contribute(self, model: Model) -> None:
        super().contribute(model)
        if self.right is not None:
            f = self.right
            values, rates = (lambda t: np.array([f(t)])), (lambda t, step: np.array([f.rate(t, step)]))
            model.prescribe(self, self.heat, [self.heat.size - 1], values, rates)


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.EnergyMomentum(), vv.BackwardEuler()], ids=str)
def test_heat_through_held_temperatures_is_booked(scheme: vv.Scheme) -> None:
    """Heat balance to round-off; what one end takes in in the end the other gives: conductivity times slope."""
    bar = HeldBar(temperatures=(3.0, 0.0, 0.5, 0.0, 1.0), exchange=0.0)
    result = vv.simulate(vv.System([bar]), until=6.0, step=0.02, scheme=scheme)
    heat, supplied = result.ledger["potential_heat"], result.ledger["work_supply"]
    assert supplied[-1] == pytest.approx(heat[-1] - heat[0], rel=1e-12)
    assert heat[-1] == pytest.approx(2.0, rel=1e-9)  # linear from 3 to 1
    assert result.ledger.imbalance() < 1e-13
    assert supplied[-1] == pytest.approx(2.0 - heat[0], rel=1e-9)
    assert abs(supplied[-1] - supplied[-2]) < 1e-9


def test_heat_through_prescribed_temperatures_is_booked() -> None:
    bar = HeldBar(temperatures=(0.0,) * 5, exchange=0.4)
    bar.right = vv.TimeFunction("sin(2*t)")
    result = vv.simulate(vv.System([bar]), until=2.0, step=0.02, scheme=vv.Midpoint())
    assert np.ptp(result.ledger["work_supply"]) > 0.1
    assert result.ledger.imbalance() < 1e-13


def test_power_of_held_velocities_is_booked() -> None:
    class Lid(StokesCell):
        def declare(self, model: Model) -> None:
            super().declare(model)
            model.hold(self.velocity, range(12), 12 * [0.0])
            model.hold(self.velocity, [12], [0.7])

    result = vv.simulate(vv.System([Lid()]), until=1.0, step=0.02, scheme=vv.Midpoint())
    assert result.ledger["work_supply"][-1] > 0.1
    assert result.ledger.imbalance() < 1e-12
