"""Every tangent of the catalogue, under every scheme, against differences of its residual."""

from __future__ import annotations

import numpy as np
import pytest
from catalogue import Entry
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]


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
    system.touch()


def differences(system: vv.System, step: object, free: Array) -> Array:
    """Derivatives of the residual by differences of fourth order."""
    core, signals = system.core, system.signals(step)
    trial = np.array(core.dx)

    def residual(j: int, d: float) -> Array:
        core.dx[:] = trial
        core.dx[j] += d
        r = np.zeros(len(trial))
        core.assemble(step, signals, r, None)
        return r[free]

    def column(j: int, d: float) -> Array:
        near, far = residual(j, d) - residual(j, -d), residual(j, 2 * d) - residual(j, -2 * d)
        return (8 * near - far) / (12 * d)

    K = np.stack([column(j, 5e-5) for j in free], axis=1)
    core.dx[:] = trial
    return K


@pytest.mark.parametrize("h", [0.4])
def test_tangent_is_the_derivative_of_the_residual(entry: Entry, scheme: vv.Scheme, h: float) -> None:
    system = vv.System(entry.build())
    shake(system, np.random.default_rng(5))
    step = scheme.step(0.3, h)
    _, K = system.tangent(step)
    K = K.toarray()
    error = np.abs(K - differences(system, step, system.free_unknowns)) / max(1.0, np.abs(K).max())
    worst = [
        system.describe(system.free_unknowns[k]) for k in np.unravel_index(np.argmax(error), error.shape)
    ]
    assert error.max() < (1e-9 if entry.analytic else 1e-7), f"{error.max():.1e} at row, column {worst}"
