"""Expressions of users are bounded: length, depth and size of numbers lead to nothing but a refusal in a line."""

from __future__ import annotations

import time

import pytest

import visviva as vv

BAD = {
    "many terms": "+".join(["t"] * 20_000),
    "sum": "t+" * 2000 + "t",
    "parentheses": "(" * 5000 + "t" + ")" * 5000,
    "signs": "-" * 9000 + "1",
    "calls": "sin(" * 500 + "t" + ")" * 500,
    "powers": "t**" * 400 + "t",
    "NUL": "t\0",
    "digits": "7" * 5000,
    "many digits": "1" * 400,
    "too large": "1e999",
    "many arguments": "max(" + ",".join(["t"] * 4000) + ")",
    "long name": "t" * 9000,
    "nothing": "",
    "attribute": "t.real",
    "Boolean": "True",
    "comparison": "t < 1",
    "comprehension": "[t for t in t]",
    "assignment": "t := 1",
}


@pytest.mark.parametrize("name", BAD)
def test_bad_expressions_are_refused_in_a_line(name: str) -> None:
    start = time.perf_counter()
    with pytest.raises(vv.InputError) as error:
        vv.TimeFunction(BAD[name])
    assert time.perf_counter() - start < 2.0
    assert len(str(error.value)) < 1100
    assert "\n" not in str(error.value)


def test_a_long_sum_is_evaluated() -> None:
    f = vv.TimeFunction("+".join(f"sin({k}*t)/{k}" for k in range(1, 250)))
    assert f.rate(0.0) == pytest.approx(249.0)


def test_functions_of_time_and_place_are_refused_for_one_component() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=vv.NeoHooke(young=1.0, poisson=0.0)
    )
    with pytest.raises(vv.InputError, match="called with t alone"):
        vv.Prescribed(solid=block, nodes="x1", motion=(lambda t, X: t * X[:, 0], None, None))
