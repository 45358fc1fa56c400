"""Loads that come at once and stay: what they crack is what they crack when they come slowly."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv

YOUNG, POISSON, TOUGHNESS, LENGTH = 100.0, 0.3, 0.02, 0.5
STRENGTH = np.sqrt(3 * YOUNG / (1 - POISSON**2) * TOUGHNESS / 8 / LENGTH)
"""Of AT1 in plane strain, free to contract."""


def bar(times: str) -> tuple[vv.FracturingSolid, vv.System]:
    """Drawn by .55 of its strength, by which nothing cracks."""
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(8, 2)),
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=LENGTH,
        model="AT1",
    )
    held = [
        vv.Prescribed(solid=solid, nodes="x0", motion=(0, None, None)),
        vv.Prescribed(solid=solid, nodes="y0", motion=(None, 0, None)),
    ]
    pull = vv.Traction(solid=solid, faces="x1", traction=(0.55 * STRENGTH, 0, 0), times=times)
    return solid, vv.System([solid, *held, pull])


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha(0.8)], ids=str)
@pytest.mark.parametrize("step", [0.1, 0.001])
@pytest.mark.parametrize("at", [0.5, 2.5])
def test_what_is_below_the_strength_cracks_nothing(scheme: vv.Scheme, step: float, at: float) -> None:
    """The step after the jump went on as the jump did, to the branch of damage .335 that balances, too."""
    solid, system = bar(f"step(t-{at * step!r})")
    vv.simulate(system, until=6 * step, step=step, scheme=scheme)
    assert solid.damages(system.x).max() == pytest.approx(0.0, abs=1e-12)


def slit(times: str) -> tuple[float, float]:
    """Damage at a tip under a dead load, and what is stored."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(12, 12)).build()
    solid = vv.FracturingSolid(
        mesh=mesh.opened(
            lambda X: (np.abs(X[:, 1] - 0.5) < 1e-9) & (X[:, 0] < 0.25), lambda X: X[:, 1] > 0.5
        ),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        toughness=1e-6,
        length=0.17,
    )
    corner = np.array([int(np.argmin(np.abs(solid.points).sum(axis=1)))])
    held = [
        vv.Prescribed(solid=solid, nodes="y0", motion=(None, 0, None)),
        vv.Prescribed(solid=solid, nodes=corner, motion=(0, None, None)),
    ]
    system = vv.System(
        [solid, *held, vv.Traction(solid=solid, faces="y1", traction=(0, 5e-4, 0), times=times)]
    )
    result = vv.simulate(system, until=0.8, step=0.1, scheme=vv.BackwardEuler())
    return float(solid.damages(system.x).max()), float(result.ledger["potential_stored"][-1])


def test_a_tip_is_damaged_as_much_by_a_load_that_comes_at_once() -> None:
    at_once, slowly = slit("step(t-0.05)"), slit("min(t/0.5, 1)")
    assert slowly[0] > 0.1
    assert at_once == pytest.approx(slowly, rel=1e-2)
