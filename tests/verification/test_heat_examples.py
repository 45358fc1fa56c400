"""The examples of heat, with their checks: both laws, and how much is warmed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.examples import damped_block, flying_l, rubber_heat, thermal_pendulum


@pytest.mark.parametrize(
    ("example", "options"),
    [
        (thermal_pendulum, {"until": 1.0, "step": 0.02}),
        (flying_l, {"cells": 1, "until": 3.0, "step": 0.1}),
        (flying_l, {"cells": 1, "until": 3.0, "step": 0.1, "viscous": True}),
        (rubber_heat, {"counts": (8, 1, 1)}),
        (damped_block, {"counts": (2, 2, 2), "until": 0.8}),
    ],
    ids=lambda x: getattr(x, "__name__", "")[17:],
)
def test_examples(example: Any, options: dict[str, Any]) -> None:
    study = example.study(**options)
    example.check(vv.simulate(study.system, until=study.until, step=study.step, scheme=study.scheme))


@pytest.mark.parametrize("viscous", [False, True])
@pytest.mark.parametrize("step", [0.1, 0.2])
def test_flying_l_to_the_end(step: float, viscous: bool) -> None:
    """To t = 15: after the push energy and momenta stay to rounding, and entropy grows in every step."""
    study, entropy = flying_l.study(step=step, viscous=viscous), []
    (body,) = (c for c in study.system.components if isinstance(c, vv.ThermoelasticSolid))
    result = vv.simulate(
        study.system, until=15.0, step=step, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    assert np.diff(entropy).min() > 0.03 * step
    assert result.statistics.rejected == 0
    free = result.ledger["time"] > 1 - 1e-9
    assert np.ptp(result.ledger["total"][free]) < 1e-12 * np.abs(result.ledger["total"]).max()
    for axis in "xyz":
        turning = result.ledger[f"angular_{axis}"][free]
        assert np.ptp(turning) < 1e-12 * np.abs(result.ledger["angular_x"]).max()
        assert np.abs(result.ledger[f"momentum_{axis}"][free]).max() < 1e-12 * 233.3
