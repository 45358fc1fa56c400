"""Loads that come at once, or stop to grow, and stay: what they crack is what they crack when they come slowly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import visviva as vv

YOUNG, POISSON, TOUGHNESS, LENGTH = 100.0, 0.3, 0.02, 0.5
STRENGTH = np.sqrt(3 * YOUNG / (1 - POISSON**2) * TOUGHNESS / 8 / LENGTH)
"""Of AT1 in plane strain, free to contract."""


def bar(
    times: str, share: float = 0.55, irreversibility: Any = "active set", *more: Any
) -> tuple[vv.FracturingSolid, vv.System]:
    """Drawn by a share of its strength, by which nothing cracks."""
    solid = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(4, 1), counts=(8, 2)),
        material=vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON),
        toughness=TOUGHNESS,
        length=LENGTH,
        model="AT1",
        irreversibility=irreversibility,
    )
    held = [
        vv.Prescribed(solid=solid, nodes="x0", motion=(0, None, None)),
        vv.Prescribed(solid=solid, nodes="y0", motion=(None, 0, None)),
    ]
    pull = vv.Traction(solid=solid, faces="x1", traction=(share * STRENGTH, 0, 0), times=times)
    return solid, vv.System([solid, *held, pull, *(part(solid) for part in more)])


def drawn(share: float) -> float:
    """Stretch s of the bar, whose traction is s E / (1 - nu^2) (s^2 - 1) / 2 by a strain of Green."""
    modulus = YOUNG / (1 - POISSON**2)
    return float(brentq(lambda s: s * modulus * (s**2 - 1) / 2 - share * STRENGTH, 1.0, 1.1, xtol=1e-15))


def assert_whole(solid: vv.FracturingSolid, system: vv.System, stretch: float) -> None:
    """It is drawn evenly, contracts as it does without cracks, and has none."""
    across = np.sqrt(1 - POISSON / (1 - POISSON) * (stretch**2 - 1))
    assert solid.positions(system.x) == pytest.approx(solid.points * [stretch, across, 1], abs=1e-9)
    assert solid.damages(system.x).max() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha(0.8)], ids=str)
@pytest.mark.parametrize("step", [0.1, 0.001])
@pytest.mark.parametrize("at", [0.5, 2.5])
def test_what_is_below_the_strength_cracks_nothing(scheme: vv.Scheme, step: float, at: float) -> None:
    """The step after the jump went on as the jump did, to the branch of damage .335 that balances, too."""
    solid, system = bar(f"step(t-{at * step!r})")
    vv.simulate(system, until=6 * step, step=step, scheme=scheme)
    assert_whole(solid, system, drawn(0.55))


@pytest.mark.parametrize(("share", "steps"), [(0.7, 2), (0.8, 3), (0.9, 5), (0.97, 10)])
@pytest.mark.parametrize("irreversibility", ["active set", "history"])
def test_loads_that_stop_to_grow_crack_nothing(share: float, steps: int, irreversibility: str) -> None:
    """Motion went on as it had: .0277 to .2185 of damage in the first step after that."""
    solid, system = bar(f"min(t/{0.1 * steps!r}, 1)", share, irreversibility)
    vv.simulate(system, until=0.1 * steps + 0.3, step=0.1, scheme=vv.BackwardEuler())
    assert_whole(solid, system, drawn(share))


def test_what_flies_by_cracks_nothing() -> None:
    """The largest motion of all decided how all was extrapolated."""
    solid, system = bar(
        "step(t-0.25)", 0.55, "active set", lambda s: vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    )
    vv.simulate(system, until=0.6, step=0.1, scheme=vv.BackwardEuler())
    assert_whole(solid, system, drawn(0.55))


@pytest.mark.parametrize("step", [0.1, 0.02])
@pytest.mark.parametrize("scheme", [vv.BackwardEuler(), vv.GeneralizedAlpha(0.0)], ids=str)
def test_ends_that_are_moved_at_once_crack_nothing(scheme: vv.Scheme, step: float) -> None:
    """Nodes that moved while all others waited tore at their cells, .964 at half of the critical strain."""
    end = 4 * 0.5 * STRENGTH * (1 - POISSON**2) / YOUNG

    def moved(solid: vv.FracturingSolid) -> vv.Prescribed:
        return vv.Prescribed(solid=solid, nodes="x1", motion=(f"{end}*min(t/0.1, 1)", None, None))

    solid, system = bar("0.0", 0.0, "active set", moved)
    vv.simulate(system, until=0.3, step=step, scheme=scheme)
    assert_whole(solid, system, 1 + end / 4)


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
    slowly = slit("min(t/0.8, 1)")
    assert slowly[0] > 0.1
    for times in ("step(t-0.05)", "min(t/0.5, 1)"):
        assert slit(times) == pytest.approx(slowly, rel=1e-6)
