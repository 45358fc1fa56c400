"""The examples of heat, with their checks: both laws, and how much is warmed."""

from __future__ import annotations

from typing import Any

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
