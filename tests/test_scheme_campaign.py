"""The short form of the campaign of schemes: two mechanisms of the examples under all of them."""

from __future__ import annotations

import numpy as np
import pytest
from campaign.schemes import COUNTS, Row, rows

import visviva as vv


@pytest.mark.parametrize("name", ["pendulum", "four_bar"])
def test_schemes_are_accurate_to_their_order(name: str) -> None:
    for row in rows([name]):
        assert row.verdict == "accurate", f"{row.scheme}: {row.verdict}"


def test_verdicts_tell_wrong_from_honest() -> None:
    def verdict(errors: list[float]) -> str:
        return Row(
            "x", vv.Midpoint(), tuple(errors), tuple("" if e < 1 else "failed" for e in errors)
        ).verdict

    law = [1e-3 * (COUNTS[0] / n) ** 2 for n in COUNTS]
    assert verdict(law) == "accurate"
    assert verdict([np.inf, *law[1:]]) == "honest"
    assert verdict([0.9, *law[1:]]).startswith("WRONG")
    assert verdict([1e-3 * COUNTS[0] / n for n in COUNTS]).startswith("WRONG")
    assert verdict([*law[:-1], np.inf]).startswith("WRONG")
