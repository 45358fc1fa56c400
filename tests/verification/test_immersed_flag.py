"""FSI1 of Turek & Hron (2006) with an immersed flag, by the case of the benchmark that refines it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from flag_case import PUBLISHED, Flag, Rows, channel


@pytest.mark.filterwarnings("ignore:.*leaks between the nodes")
def test_flag_comes_to_rest_near_the_published_place() -> None:
    """On the coarsest mesh: 8.209e-4 up (FeatFlow's level 7, body-fitted), drag 14.294."""
    case = Flag(channel(Rows(fine=12, across=2)), (14, 1))
    assert case.unseen()[1] == 0
    states = case.march(11.0, 0.2)
    _, up, drag, _ = states[-1, 1:]
    assert np.ptp(states[-10:, 2]) < 2e-3 * up
    assert up == pytest.approx(PUBLISHED["u_y"], rel=0.07)
    assert drag == pytest.approx(PUBLISHED["drag"], rel=0.004)
