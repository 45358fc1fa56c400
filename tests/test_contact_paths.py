"""Forces of contact follow from both ends of a step, whatever Newton's method met on its way between them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_parts import RUBBER
from numpy.typing import NDArray
from test_tangents import differences

import visviva as vv

Array = NDArray[np.float64]

WAYS: dict[str, dict[str, Any]] = {
    "penalty": {"enforcement": "penalty"},
    "penalty and friction": {"enforcement": "penalty", "friction": 0.3, "tangential": "penalty"},
    "penalty and multipliers of friction": {"enforcement": "penalty", "friction": 0.3},
    "multipliers": {},
    "multipliers and friction": {"friction": 0.3},
}


def blocks(
    newton: vv.Newton | None = None, gap: float = 0.02, speed: float = 1.0, **options: Any
) -> vv.System:
    """Two blocks with all their faces, whose sides come and go in what the gaps may depend on."""
    lower = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)), material=RUBBER, density=1.0)
    above = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), origin=(0, 0, 1 + gap))
    upper = vv.Solid(mesh=above, material=RUBBER, density=1.0, velocity=(0.3, 0, -speed))
    contact = vv.Contact(first=upper, second=lower, **options)
    held = vv.Fixed(solid=lower, nodes="z0")
    return vv.System([lower, upper, contact, held, vv.Gravity()], newton=newton)


def positions(system: vv.System) -> Array:
    fields = [system.field(c, "position") for c in system.components[:2]]
    return np.concatenate([system.x[f.start : f.start + f.size] for f in fields])


@pytest.mark.parametrize("name", WAYS)
def test_accepted_steps_satisfy_their_equations_after_another_search(name: str) -> None:
    system, scheme = blocks(**WAYS[name]), vv.EnergyMomentum()
    free = system.free_unknowns
    for _ in range(24):
        step = scheme.step(system.time, 0.01)
        trial = system.attempt(step)
        assert np.abs(system.residual(step, trial.signals)[free]).max() < 1e-8  # forces reach 7
        system.accept(trial, scheme)


@pytest.mark.parametrize("name", WAYS)
def test_other_ways_lead_to_the_same_step(name: str) -> None:
    """With a tangent of its own in every iteration, and with kept ones."""
    ends = []
    for keep in (0.0, 0.2):
        system = blocks(vv.Newton(keep_factor=keep, tolerance=1e-11), **WAYS[name])
        vv.simulate(system, until=0.2, step=0.01)
        ends.append(positions(system))
    assert np.abs(ends[0] - ends[1]).max() < 1e-9


@pytest.mark.parametrize("name", ["penalty", "penalty and friction"])
def test_tangents_where_surfaces_begin_to_face_each_other(name: str) -> None:
    """From beyond the reach into contact in one step, deeper at one side."""
    system = blocks(gap=0.7, speed=7.6, **WAYS[name])
    step = vv.EnergyMomentum().step(0.0, 0.1)
    dx = system.core.dx
    upper = system.field(system.components[1], "position")
    at = np.arange(upper.start, upper.start + upper.size).reshape(-1, 3)
    rng = np.random.default_rng(3)
    dx[at.ravel()] = 0.01 * rng.standard_normal(at.size)
    dx[at] += [0.03, 0.0, -0.76]
    _, K = system.tangent(step)
    assert system.components[2].pressures.max() > 0
    error = K.toarray() - differences(system, step, system.free_unknowns)
    assert np.abs(error).max() < 1e-7 * np.abs(K).max()
