"""Energies and constraints of the user: discrete gradients to round-off for steps of every size."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from instances.shapes import neo_hooke
from numpy.typing import NDArray

import visviva as vv
from visviva.model.callback import Function

Array = NDArray[np.float64]


def real_only(C: Array) -> Array:
    """The same energy in a form that the complex step cannot see through."""
    return neo_hooke(C if np.isrealobj(C) else np.abs(C))


def states(size: float, n: int = 5) -> tuple[Array, Array]:
    """Strains (6, n) near the undeformed ones, and others a little further, both moved by about `size`."""
    rng = np.random.default_rng(1)
    e0 = np.array([1.0, 1, 1, 0, 0, 0])[:, None] + size * rng.standard_normal((6, n))
    return e0, e0 + size * rng.standard_normal((6, n))


@pytest.mark.parametrize("size", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 0.0])
@pytest.mark.parametrize(("energy", "noise"), [(neo_hooke, 1e-12), (real_only, 1e-9)])
def test_discrete_gradient(energy: Callable[[Array], Array], noise: float, size: float) -> None:
    """Near equilibrium too, where energies cancel: exact work, and a stress near the mean one."""
    W = Function(energy, 6, 1, "energy")
    e0, e1 = states(size)
    S, _ = W.discrete_gradient(e0, e1, want_tangent=False)
    mean = 0.5 * (W.gradient(e0) + W.gradient(e1))
    assert np.abs((S[0] * (e1 - e0)).sum(axis=0) - (W.value(e1) - W.value(e0))[0]).max() < 1e-15
    assert np.abs(S - mean).max() <= 5 * size**2 + noise


def test_complex_step_is_chosen_where_it_works() -> None:
    e, _ = states(0.1)
    assert Function(neo_hooke, 6, 1, "energy").takes_complex(e)
    assert not Function(real_only, 6, 1, "energy").takes_complex(e)


def test_derivatives_against_closed_forms() -> None:
    f = Function(lambda e: np.stack([e[0] ** 3 * e[1], np.sin(e[1])]), 2, 2, "function")
    x, y = e = np.array([[0.3, -1.2], [2.0, 0.7]])
    first = np.array([[3 * x**2 * y, x**3], [0 * x, np.cos(y)]])
    second = np.array([[[6 * x * y, 3 * x**2], [3 * x**2, 0 * x]], [[0 * x, 0 * x], [0 * x, -np.sin(y)]]])
    assert f.gradient(e) == pytest.approx(first, rel=1e-15, abs=1e-15)
    assert f.hessian(e) == pytest.approx(second, rel=1e-9, abs=1e-9)


def test_wrong_shapes_and_values_are_refused() -> None:
    e = np.ones((2, 3))
    with pytest.raises(vv.RunError, match=r"spring: it returned shape \(2, 3\)"):
        Function(lambda e: e, 2, 1, "spring").value(e)
    with pytest.raises(vv.RunError, match="spring: it returned"):
        Function(lambda e: np.full(3, np.nan), 2, 1, "spring").value(e)
