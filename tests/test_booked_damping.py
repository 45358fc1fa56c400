"""Work of loads on solids and of damping under schemes whose rates remember earlier steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

SCHEMES = [vv.GeneralizedAlpha(rho=0.9), vv.GeneralizedAlpha(rho=0.5), vv.BDF2()]
START = 0.02


def bar(young: float, **options: Any) -> tuple[vv.Solid, vv.Fixed]:
    mesh = vv.BoxMesh(size=(1, 0.2, 0.2), counts=(4, 1, 1))
    given = {"material": vv.LinearElastic(young=young, poisson=0.0), "density": 1.0, **options}
    solid = vv.Solid(mesh=mesh, **given)
    return solid, vv.Fixed(solid=solid, nodes="x0")


def stretching(X: Any) -> Any:
    return START * X**2 * (1, 0, 0)


def imbalance(parts: Any, steps: int, scheme: vv.Scheme, until: float) -> float:
    result = vv.simulate(vv.System(list(parts)), until=until, step=until / steps, scheme=scheme)
    return float(np.abs(result.ledger["imbalance"]).max() / result.ledger.energy_scale)


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_work_of_a_traction_is_of_second_order(scheme: vv.Scheme) -> None:
    defects = []
    for steps in (100, 200):
        solid, held = bar(1.0)
        pull = vv.Traction(solid=solid, faces="x1", traction=(0.01, 0, 0), times="sin(t)")
        defects.append(imbalance([solid, held, pull], steps, scheme, 2 * np.pi))
    assert defects[1] < 1e-3
    assert defects[0] / defects[1] > 3.5


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
@pytest.mark.parametrize("small", [True, False])
def test_work_of_damping_is_of_second_order(small: bool, scheme: vv.Scheme) -> None:
    """By stiffness and by mass, where the motion is resolved."""
    material = vv.LinearElastic(young=1.0, poisson=0.0) if small else vv.NeoHooke(young=1.0, poisson=0.3)
    damped = {"material": material, "stiffness_damping": 0.01, "mass_damping": 0.1}
    defects = [imbalance(bar(1.0, velocity=stretching, **damped), steps, scheme, 1.0) for steps in (100, 200)]
    assert defects[1] < 1e-3
    assert defects[0] / defects[1] > 3.5


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
@pytest.mark.parametrize("young", [1.0, 1e3, 1e5])
def test_damping_of_a_solid_never_books_a_gain(young: float, scheme: vv.Scheme) -> None:
    """Not where its rates die out within a step either: half of what it had was booked as gained."""
    solid, held = bar(young, velocity=stretching, stiffness_damping=0.01, mass_damping=0.1)
    result = vv.simulate(vv.System([solid, held]), until=1.0, step=0.01, scheme=scheme)
    assert np.diff(result.ledger["work_damping"]).max() <= 0


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_a_damper_never_books_a_gain(scheme: vv.Scheme) -> None:
    """Of a mass that it stops within a step, along a line and along the line between two points."""
    ball, ground = vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(1, 0.5, 0)), vv.Ground()
    damper = vv.Spring(a=ground, b=ball, stiffness=1.0, damping=1e3)
    result = vv.simulate(vv.System([ball, ground, damper]), until=1.0, step=0.02, scheme=scheme)
    (account,) = [name for name in result.ledger.names if name.startswith("work_")]
    assert np.diff(result.ledger[account]).max() <= 0
