"""Marching: steps that fail are halved, and meet the grid of whole steps again."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import visviva as vv


def test_halved_steps_return_to_the_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """The third step and its first half fail: a half of quarters, a half, and whole steps at their old times."""
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    take, refused = vv.System.step, {(2, 0.1), (2, 0.05)}

    def step(self: vv.System, h: float, scheme: vv.scheme.Scheme) -> object:
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
    assert (system.halvings, system.part, system.rejected) == (0, 0, 2)
