"""Marching: steps are counted; those that fail are halved, and meet the grid of whole steps again."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.analysis.load_steps import Equilibrium, NoEquilibrium


def test_halved_steps_return_to_the_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """The third step and its first half fail: a half of quarters, a half, and whole steps at their old times."""
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    take, refused = vv.System.step, {(2, 0.1), (2, 0.05)}

    def step(self: vv.System, h: float, scheme: vv.scheme.schemes.Scheme) -> object:
        key = (int(self.time / 0.1 + 1e-9), round(h, 9))
        if key in refused and self.time < 0.2 + 1e-9:
            report = SimpleNamespace(worst_unknown=0, increments=[], reason="refused")
            raise vv.StepFailure(self, self.time, h, report)
        return take(self, h, scheme)

    monkeypatch.setattr(vv.System, "step", step)
    times = [0.0]
    for _ in vv.march(system, until=0.6, step=0.1):
        times.append(system.time)
    expected = [0, 0.1, 0.2, 0.225, 0.25, 0.3, 0.4, 0.5, 0.6]
    np.testing.assert_allclose(times, expected, atol=1e-14)
    assert (system.clock.halvings, system.stepper.rejected) == (0, 2)


def falling() -> vv.System:
    return vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0)), vv.Gravity()])


def hung() -> vv.System:
    """A ball on a spring and a guide, pulled down more and more."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(0, 0, -1))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0)
    guide = vv.PointOnLine(a=ground.frame(axes=((1, 0, 0), (0, 1, 0), (0, 0, 1))), b=ball.point())
    pull = vv.Force(on=ball.point(), force=(0, 0, -20), times="t")
    return vv.System([ground, ball, spring, guide, pull])


def times_to(until: float, step: float, system: vv.System | None = None) -> list[float]:
    system = falling() if system is None else system
    return [system.time, *(system.time for _ in vv.march(system, until=until, step=step))]


@pytest.mark.parametrize(
    ("until", "step"), [(2.0, 1e-4), (1.5, 1e-4), (0.6, 3e-5), (7.0, 1e-3), (0.35, 0.01)]
)
def test_steps_are_counted(until: float, step: float) -> None:
    """Summed up, two seconds of 1e-4 miss the end by 2e-13, and a step of that length followed."""
    system = falling()
    times = times_to(until, step, system)
    n = len(times) - 1
    assert n == int(until / step + 1e-6)
    assert times[-1] == pytest.approx(until, abs=1e-9 * step)
    np.testing.assert_array_equal(times[:n], step * np.arange(n))
    assert np.abs(np.diff(times) / step - 1).max() <= 0.01
    np.testing.assert_allclose(system.v[:3], [1, 0, -9.81 * until], rtol=1e-9)


@pytest.mark.parametrize(("part", "last"), [(0.5, 0.5), (0.0101, 0.0101), (0.0099, 1.0099), (1e-12, 1.0)])
def test_the_last_step_is_shortened_or_stretched(part: float, last: float) -> None:
    times = times_to((3 + part) * 0.1, 0.1)
    assert times[-1] == pytest.approx((3 + part) * 0.1, abs=1e-12)
    assert np.diff(times)[-1] / 0.1 == pytest.approx(last, rel=1e-9)
    assert np.diff(times)[:-1] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("part", "tried"),
    [
        (1.0, [1.0, *0.5 ** np.arange(1, 7)]),
        (0.5, 0.5 * 0.5 ** np.arange(7)),
        (0.3, 0.3 * 0.5 ** np.arange(7)),
        (0.012, 0.012 * 0.5 ** np.arange(7)),
        (1.005, [1.005, *0.5 ** np.arange(1, 7)]),
    ],
)
@pytest.mark.parametrize("static", [False, True])
def test_no_length_is_tried_twice(
    part: float, tried: list[float], static: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last step, cut short by the end, failed again and again until halves of the whole one were shorter, and these
    had used up the halvings: it has as many of its own."""
    system, lengths = hung() if static else falling(), []
    take, iterate = vv.System.step, Equilibrium.iterate

    def step(self: vv.System, h: float, scheme: vv.scheme.schemes.Scheme) -> object:
        if self.time < 0.2 - 1e-9:
            return take(self, h, scheme)
        lengths.append(h)
        raise vv.StepFailure(self, self.time, h, SimpleNamespace(worst_unknown=0, increments=[], reason="no"))

    def refusing(self: Equilibrium, time: float) -> object:
        if time < 0.2 + 1e-9:
            return iterate(self, time)
        lengths.append(time - self.system.time)
        raise NoEquilibrium("refused")

    monkeypatch.setattr(vv.System, "step", step)
    monkeypatch.setattr(Equilibrium, "iterate", refusing)
    scheme = vv.Static(halvings=6) if static else vv.EnergyMomentum()
    with pytest.raises(NoEquilibrium if static else vv.StepFailure):
        for _ in vv.march(system, until=(2 + part) * 0.1, step=0.1, scheme=scheme):
            pass
    np.testing.assert_allclose(np.array(lengths) / 0.1, tried, rtol=1e-9)


def test_an_end_time_a_sliver_ahead_is_refused() -> None:
    system = falling()
    times_to(0.1, 0.01, system)
    with pytest.raises(vv.InputError, match=r"step = 0\.01 is longer than the way of 1e-05"):
        times_to(0.1 + 1e-5, 0.01, system)
    with pytest.raises(vv.InputError, match=r"step = 0\.01 is longer than the way of 1e-05"):
        list(vv.march(system, until=0.1 + 1e-5, step=0.01, adaptive=vv.Adaptive()))
    assert times_to(0.1 + 1e-16, 0.01, system) == [0.1]


@pytest.mark.parametrize("options", [{}, {"adaptive": vv.Adaptive()}, {"scheme": vv.Static()}], ids=str)
def test_a_first_step_beyond_the_end_is_refused(options: dict[str, Any]) -> None:
    """A run would be one step of another length than was asked for."""
    ground, ball = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    springs = {"stiffness": (1, 1, 1), "rotational_stiffness": (1, 1, 1)}
    hold = vv.Bushing(a=ground, b=ball, at=(0, 0, 0), **springs)
    system = vv.System([ground, ball, hold, vv.Force(on=ball, force=(1, 0, 0), times="t")])
    with pytest.raises(vv.InputError, match=r"step = 0\.5 is longer than the way of 0\.1 .* at most 0\.1"):
        vv.simulate(system, until=0.1, step=0.5, **options)
    assert system.time == 0.0
    vv.simulate(system, until=0.1, step=0.1, **options)
    vv.simulate(system, until=0.25, step=0.1, **options)  # the last one is shorter
    assert system.time == pytest.approx(0.25, rel=1e-12)


def test_marching_on_keeps_the_count() -> None:
    """A run in pieces has the times of the whole one to the bit."""
    system, pieces = falling(), [0.0]
    for until in (0.21, 0.35, 0.7):
        pieces += times_to(until, 0.01, system)[1:]
    assert pieces == times_to(0.7, 0.01)


def test_steps_by_hand_are_counted() -> None:
    system = falling()
    for _ in range(1000):
        system.step(0.001)
    assert system.time == 1.0


def test_load_steps_are_counted_and_halved_on_their_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """The third load step fails once: its halves lead back to the times of the whole ones."""
    iterate, calls = Equilibrium.iterate, []

    def third_fails(self: Equilibrium, time: float) -> object:
        calls.append(time)
        if len(calls) == 3:
            raise NoEquilibrium("refused")
        return iterate(self, time)

    monkeypatch.setattr(Equilibrium, "iterate", third_fails)
    result = vv.quasi_static(hung(), until=0.7, step=0.1)
    assert isinstance(result.times, np.ndarray)
    np.testing.assert_allclose(result.times, [0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7], rtol=1e-15)


def test_failed_load_steps_leave_whole_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who goes on after a failure begins with the steps that are asked for, not with the last halves."""
    system, iterate = hung(), Equilibrium.iterate

    def fails(self: Equilibrium, time: float) -> object:
        if time > 0.2 + 1e-9:
            raise NoEquilibrium("refused")
        return iterate(self, time)

    with monkeypatch.context() as patch:
        patch.setattr(Equilibrium, "iterate", fails)
        with pytest.raises(NoEquilibrium, match="refused"):
            vv.quasi_static(system, until=0.7, step=0.1)
    assert (system.clock.halvings, system.time) == (0, pytest.approx(0.2))
    result = vv.quasi_static(system, until=0.5, step=0.1)
    np.testing.assert_allclose(result.times, [0.2, 0.3, 0.4, 0.5], rtol=1e-15)


@pytest.mark.parametrize("every", [0, -1, 1.5])
def test_load_steps_kept_are_counted(every: float) -> None:
    with pytest.raises(vv.InputError, match="quasi_static: every"):
        vv.quasi_static(falling(), until=0.1, step=0.1, every=every)  # type: ignore[arg-type]
