"""Every tangent of the catalogue, under every scheme, against differences of its residual."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from catalogue import Entry
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


@cache
def fresh(entry: Entry) -> tuple[vv.System, Callable[[], None]]:
    """The system of an entry, and what takes it back to its start: to build it takes longer than its test."""
    system = vv.System(entry.build())
    core, vectors = system.core, ("x", "dx", "v", "a", "w")
    start = [np.array(getattr(core, name)) for name in vectors]

    def take_back() -> None:
        for name, values in zip(vectors, start, strict=True):
            getattr(core, name)[:] = values
        system.invalidate()

    return system, take_back


def shake(system: vv.System, rng: np.random.Generator) -> None:
    """A random state near the initial one, off the constraints, with a random trial increment and history."""
    core, n = system.core, len(system.order)
    sizes = [(0.03 if f.node > 1 else 1.0 if f.order == 0 else 0.1) for f in system.model.fields]
    size = np.repeat(sizes, [f.size for f in system.model.fields])  # no element of a mesh turns inside out
    core.x[:n] += size * rng.standard_normal(n)
    core.dx[:n] = size * rng.standard_normal(n)
    for history in (core.v, core.a, core.w):
        history[:n] = rng.standard_normal(n)
    for f in system.model.fields:
        core.dx[f.start : f.start + f.size][f.fixed] = 0.0
    system.invalidate()


def slope(system: vv.System, step: object, free: Array, direction: Array, d: float) -> Array:
    """Derivative of the residual along a direction (n,) of the free unknowns, by differences of fourth order."""
    core, signals = system.core, system.signals(step)
    trial = np.array(core.dx)

    def residual(d: float) -> Array:
        core.dx[:] = trial
        core.dx[free] += d * direction
        r = np.zeros(len(trial))
        core.assemble(step, signals, r, None)
        return r[free]

    near, far = residual(d) - residual(-d), residual(2 * d) - residual(-2 * d)
    core.dx[:] = trial
    return (8 * near - far) / (12 * d)


def differences(system: vv.System, step: object, free: Array) -> Array:
    """Derivatives of the residual by every free unknown."""
    return np.stack([slope(system, step, free, e, 5e-5) for e in np.eye(len(free))], axis=1)


def agrees_along_directions(system: vv.System, step: object, K: Array, tolerance: float) -> bool:
    """Whether a tangent does along three random directions: wrong entries do not cancel in all of them."""
    rng, free = np.random.default_rng(6), system.free_unknowns
    for direction in rng.standard_normal((3, len(free))):
        d = 5e-5 / max(1.0, np.sqrt(len(free)) / 3)  # small enough where many unknowns change at once
        if np.abs(K @ direction - slope(system, step, free, direction, d)).max() > tolerance:
            return False
    return True


@pytest.mark.parametrize("h", [0.4])
def test_tangent_is_the_derivative_of_the_residual(entry: Entry, scheme: vv.Scheme, h: float) -> None:
    """Column by column only where random directions, which cost far less, leave a doubt."""
    system, take_back = fresh(entry)
    take_back()
    shake(system, np.random.default_rng(5))
    step = scheme.step(0.3, h)
    _, K = system.tangent(step)
    K = K.toarray()
    size, tolerance = max(1.0, np.abs(K).max()), 1e-9 if entry.analytic else 1e-7
    if agrees_along_directions(system, step, K, tolerance * size):
        return
    error = np.abs(K - differences(system, step, system.free_unknowns)) / size
    worst = [
        system.describe(system.free_unknowns[k]) for k in np.unravel_index(np.argmax(error), error.shape)
    ]
    assert error.max() < tolerance, f"{error.max():.1e} at row, column {worst}"
