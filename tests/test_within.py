"""What arguments are made of is found through lists, tables by name and dataclasses, and not in other components."""

from __future__ import annotations

import pytest

import visviva as vv
from visviva.component.component import Component
from visviva.component.within import within

RAMP, FLAT = vv.TimeFunction([(0, 300), (1, 400)]), vv.TimeFunction(1.0)


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (RAMP, [RAMP]),
        ((None, RAMP, FLAT), [RAMP, FLAT]),
        ({"x": [RAMP], "y": 3.0}, [RAMP]),
        (vv.RegularSolution(temperature=RAMP), [RAMP]),
        ([0.0] * 3, []),
        (vv.Force(on=vv.PointMass(mass=1.0), force=(1, 0, 0), times=RAMP), []),
    ],
)
def test_functions_of_time_are_found(given: object, found: list[vv.TimeFunction]) -> None:
    assert list(within(given, vv.TimeFunction, (Component,))) == found
