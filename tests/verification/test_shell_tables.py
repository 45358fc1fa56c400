"""Tables of Sze, Liu & Lo (2004) up to their full loads; finer meshes and other cells are in ``campaign.shells``."""

from __future__ import annotations

import pytest

import visviva as vv
from verification.shell_cases import pinched_hemisphere
from verification.shell_tables import HEMISPHERE, OPEN_CYLINDER, open_cylinder


@pytest.mark.parametrize(
    ("cell", "n", "tolerance"), [("quad9", 16, 0.025), ("quad9", 32, 0.01), ("quad4", 24, 0.025)]
)
def test_hemisphere_with_a_hole(cell: str, n: int, tolerance: float) -> None:
    """3.4, within one per cent with 32 nodes along the rim."""
    shell, others, (pulled, pushed) = pinched_hemisphere(n, cell, 200.0)
    system = vv.System([shell, *others])
    for share, expected in HEMISPHERE.items():
        vv.quasi_static(system, until=share, step=min(0.125, share))
        u = shell.displacements(system.x)
        assert (u[pulled, 0], -u[pushed, 1]) == pytest.approx(expected, rel=tolerance)


@pytest.mark.parametrize("cell", ["quad9", "quad4"])
def test_open_cylinder_pulled_apart(cell: str) -> None:
    """3.5: it snaps at half the load, which its path's length follows; 16 x 24 nodes, as the table's cells."""
    system, found = open_cylinder((16, 24), cell)
    for share, expected in OPEN_CYLINDER.items():
        if system.time < 0.5 < share:
            vv.arc_length(system, step=0.01, until=0.53)
        vv.quasi_static(system, until=share, step=0.05)
        assert found(system.x) == pytest.approx(expected, abs=0.035)
