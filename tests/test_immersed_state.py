"""What is immersed goes on from its state alone: nothing that is looked at between steps changes those to come."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from immersed_parts import Array, Components, body, carried, flap, thin

import visviva as vv
from visviva.analysis.march import advance, begin, prepare
from visviva.study.restart import load, records_of, write

STEP, STEPS = 0.05, 6
BODIES: dict[str, Callable[[], Components]] = {
    "soft": carried,
    "leaving": partial(carried, leaves=True),
    "sealed": partial(carried, sealing=10.0),
    "quad9": partial(carried, "quad9", 4),
    "thin": thin,
    "rigid": body,
    "flap": flap,
}
SCHEMES = [
    vv.EnergyMomentum(),
    vv.Midpoint(),
    vv.VariationalMidpoint(),
    vv.BackwardEuler(),
    vv.BDF2(),
    vv.GeneralizedAlpha(0.5),
]
EVERYWHERE = pytest.mark.parametrize("scheme", SCHEMES, ids=str)


def system_of(name: str) -> vv.System:
    return vv.System(BODIES[name](), vv.Newton(tolerance=1e-11))


def state(system: vv.System) -> Array:
    core = system.core
    return np.concatenate([core.x, core.v, core.a, core.w])


def marched(name: str, scheme: vv.Scheme, between: Callable[[vv.System], object]) -> Array:
    """States (n_steps, n) of a run, with something done after every step."""
    system, states = system_of(name), []
    for _ in vv.march(system, until=STEPS * STEP, step=STEP, scheme=scheme):
        states.append(state(system))
        between(system)
    return np.array(states)


def split(name: str, scheme: vv.Scheme) -> Array:
    """The same by a run of its own for every step, each with its own books."""
    system, states = system_of(name), []
    for k in range(STEPS):
        vv.simulate(
            system,
            until=(k + 1) * STEP,
            step=STEP,
            scheme=scheme,
            observe=lambda system: states.append(state(system)),
        )
    return np.array(states)


def resumed(name: str, scheme: vv.Scheme, path: Path) -> Array:
    """The same, from a file and in a new system for every step."""
    states: list[Array] = []
    for k in range(STEPS):
        result, books = begin(system_of(name), scheme)
        if k > 0:
            load(path, result, books)
        for _ in advance(result, books, until=(k + 1) * STEP, step=STEP):
            states.append(state(result.system))
        write(path, records_of(result, books), {})
    return np.array(states)


@EVERYWHERE
@pytest.mark.parametrize("name", BODIES)
def test_nothing_between_steps_changes_a_bit(name: str, scheme: vv.Scheme, tmp_path: Path) -> None:
    """Runs that are split, checked, touched, or restarted through a file after every step, and undisturbed ones."""
    whole = marched(name, scheme, lambda system: None)
    assert len(whole) >= STEPS  # or more, where one is halved
    assert np.array_equal(split(name, scheme), whole)
    assert np.array_equal(marched(name, scheme, vv.System.check), whole)
    assert np.array_equal(marched(name, scheme, vv.System.invalidate), whole)
    assert np.array_equal(resumed(name, scheme, tmp_path / "state.h5"), whole)


@pytest.mark.parametrize("scheme", [s for s in SCHEMES if not s.keeps_swinging], ids=str)
@pytest.mark.parametrize("name", BODIES)
def test_steps_follow_from_the_state_alone(name: str, scheme: vv.Scheme) -> None:
    """A step of a system with a past, and of one that was given its state and begins Newton's method elsewhere.

    Where velocities swing from step to step, points go on with the mean ones of the step before as well.
    """
    old, new = system_of(name), system_of(name)
    for _ in vv.march(old, until=3 * STEP, step=STEP, scheme=scheme):
        pass
    prepare(new, scheme)
    for vector in ("x", "v", "a", "w"):
        getattr(new.core, vector)[:] = getattr(old.core, vector)
    new.invalidate()
    for system in (old, new):
        system.step(STEP, scheme)
    apart = np.abs(new.x - old.x)[old.order > 0]
    assert apart.max() < 1e-9
