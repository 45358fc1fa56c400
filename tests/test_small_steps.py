"""Linear systems of constrained motion as the step goes to zero, against exact solutions in long arithmetic.

Multipliers are forces and increments shrink like h^2, so that the condition number of the plain matrix grows like
1/h^4; solvers scale it away (Bottasso, Bauchau & Cardona 2007).
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from visviva.examples import crane

Array = NDArray[np.float64]

STEPS = (1e-1, 1e-3, 1e-5, 1e-7)


def build(null_space: bool) -> vv.System:
    """The crane."""
    return vv.System(crane.study().system.components, newton=vv.Newton(null_space=null_space))


def linear_system(h: float) -> tuple[Array, Array, Array, Array]:
    """The first iteration of a step: which unknowns move, residual, matrix and increment, by equation."""
    system = build(null_space=False)
    step = vv.EnergyMomentum().step(0.0, h)
    system.core.dx[:] = np.where(system.order == 2, h * system.v, 0.0)
    residual, K = system.tangent(step)
    increment = np.zeros(len(system.x))
    assert system.core.linearise(step, system.signals(step), residual)
    assert system.core.linear_solve(step, residual, increment)
    unknown = system.pattern[2]
    return system.order[unknown] > 0, residual[unknown], K.toarray(), increment[unknown]


def exact(K: Array, r: Array) -> Array:
    """The solution of K s = -r, rounded once at the end."""
    with mpmath.workdps(60):
        return np.array(
            [float(s) for s in mpmath.lu_solve(mpmath.matrix(K.tolist()), -mpmath.matrix(r.tolist()))]
        )


@pytest.mark.parametrize("h", STEPS)
def test_solutions_stay_exact(h: float) -> None:
    """Positions and multipliers, each to its own largest."""
    moves, residual, K, found = linear_system(h)
    wanted = exact(K, residual)
    for part in (moves, ~moves):
        assert np.abs(found - wanted)[part].max() < 1e-10 * np.abs(wanted[part]).max()


def test_plain_condition_number_grows() -> None:
    """What the solvers have to cope with."""
    condition = [np.linalg.cond(linear_system(h)[2]) for h in (1e-1, 1e-2, 1e-3)]
    assert condition[1] > 1e3 * condition[0]
    assert condition[2] > 1e3 * condition[1]


@pytest.mark.parametrize("h", [1e-2, 1e-3, 1e-4, 1e-5])
def test_both_formulations_give_the_same_step(h: float) -> None:
    """Accelerations and reactions agree until the rounding of positions, divided by h^2, is larger."""
    steps = []
    for null_space in (True, False):
        system = build(null_space)
        v = system.v.copy()
        for _ in vv.march(system, until=h, step=h):
            pass
        moves = system.order == 2
        steps.append((((system.v - v) / h)[moves], system.x[~moves]))
    rounding = 100 * np.finfo(float).eps / h**2
    for one, other in zip(*steps, strict=True):
        assert np.abs(other).max() > 10
        assert np.abs(one - other).max() < 1e-10 * np.abs(other).max() + rounding


def test_the_elimination_is_chosen_when_a_system_is_made() -> None:
    system = build(null_space=True)
    with pytest.raises(vv.InputError, match="when a system is made"):
        system.newton = vv.Newton(null_space=False)
