"""The elastic half cylinder in a very viscous channel flow of Liu et al. (2014), immersed, beside a body-fitted one."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import half_cylinder


@pytest.mark.filterwarnings("ignore:.*leaks between the nodes")
def test_half_cylinder_comes_to_rest_near_the_body_fitted_place() -> None:
    """On two coarse meshes, quadratic cells: the distance falls with the cells, and the area stays."""
    fitted, places = half_cylinder.FITTED["neo-Hooke"], []
    for per_unit in (8, 16):
        (along, _), area = half_cylinder.bend(per_unit, half_cylinder.MATERIALS["neo-Hooke"]())
        assert area == pytest.approx(1.0, abs=0.005)
        places.append(along)
    assert places[0] == pytest.approx(fitted, rel=0.1)
    assert abs(places[1] - fitted) < 0.7 * abs(places[0] - fitted)
    assert 2 * places[1] - places[0] == pytest.approx(fitted, rel=0.03)
