"""Energies and constraints of the user: discrete gradients to round-off for steps of every size."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

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


@pytest.mark.parametrize("unit", [1e-3, 1e6])
def test_no_unit_of_a_strain_decides_how_the_rest_is_shared(unit: float) -> None:
    """A distance beside an angle: in another unit its stress is another, and that of the angle the same."""

    def energy(e: Array) -> Array:
        return np.cosh(e[0] * (1 + e[1] ** 2)) + e[1] ** 4

    def other(e: Array) -> Array:
        return energy(np.stack([e[0] / unit, e[1]]))

    e0, e1 = np.array([[0.3], [0.5]]), np.array([[0.9], [-0.2]])
    scale = np.array([[unit], [1.0]])
    S, T = Function(energy, 2, 1, "energy").discrete_gradient(e0, e1, want_tangent=True)
    W = Function(other, 2, 1, "energy", np.array([unit, 1.0]))
    found, slope = W.discrete_gradient(scale * e0, scale * e1, want_tangent=True)
    assert found[0] * scale == pytest.approx(S[0], rel=1e-10)
    assert T is not None
    assert slope is not None
    assert slope[0, :, :, 0] * scale * scale.T == pytest.approx(T[0, :, :, 0], rel=1e-5)
    d = 1e-6 * scale * np.eye(2)
    ahead, behind = (
        W.discrete_gradient(np.hstack([scale * e0] * 2), scale * e1 + s * d, want_tangent=False)[0][0]
        for s in (1, -1)
    )
    assert (ahead - behind) / (2e-6 * scale.T) == pytest.approx(slope[0, :, :, 0], rel=1e-6)


def test_complex_step_is_chosen_where_it_works() -> None:
    e, _ = states(0.1)
    assert Function(neo_hooke, 6, 1, "energy").takes_complex(e).all()
    assert not Function(real_only, 6, 1, "energy").takes_complex(e).any()


def filled(e: Array) -> Array:
    out, below = np.zeros(e.shape[1]), e[0].real < 1
    out[below] = (e[0].real[below] - 1) ** 2
    return out


@pytest.mark.parametrize(
    "energy",
    [
        lambda e: np.where(e[0] < 1, np.abs(e[0] - 1) ** 2, 0.0),
        lambda e: np.where(e[0] < 1, np.linalg.norm(e[:1] - 1, axis=0) ** 2, 0.0 * e[0]),
        lambda e: np.clip(1 - e[0].real, 0, None) ** 2,
        filled,
    ],
)
def test_what_acts_beyond_a_threshold_alone_has_its_derivatives_there(energy: Callable[[Array], Any]) -> None:
    """Where such an energy vanishes the complex step holds, and beyond it does not: neither decides for the other."""
    W = Function(energy, 2, 1, "bumper")
    e = np.array([[1.5, 0.9, 1.2, 0.3], [0.2, 0.3, 0.4, -0.5]])
    push = np.where(e[0] < 1, 2 * (e[0] - 1), 0.0)
    for _ in range(2):
        assert W.gradient(e[:, :1]) == pytest.approx(np.zeros((1, 2, 1)), abs=1e-12)
        assert W.gradient(e)[0] == pytest.approx(np.array([push, 0 * push]), rel=1e-8, abs=1e-9)
    assert W.hessian(e)[0, 0, 0] == pytest.approx(np.where(e[0] < 1, 2.0, 0.0), rel=1e-5, abs=1e-6)
    S, _ = W.discrete_gradient(e[:, :1], e[:, 1:2], want_tangent=False)
    assert (S[0] * (e[:, 1:2] - e[:, :1])).sum() == pytest.approx(0.01, rel=1e-9)


def test_a_part_that_hides_from_the_complex_step_is_found_beside_what_does_not() -> None:
    def energy(C: Array) -> Any:
        return neo_hooke(C) + np.where(C[0] > 1.44, 50 * np.abs(C[0] - 1.44) ** 2, 0)

    W = Function(energy, 6, 1, "fibres")
    C = np.array([[1.0, 1.4, 1.5, 1.45], [1.0, 0.8, 0.7, 0.7], [1.0] * 4, [0.1] * 4, [0.0] * 4, [-0.2] * 4])
    expected = Function(neo_hooke, 6, 1, "matrix").gradient(C)
    expected[0, 0] += 100 * np.maximum(C[0] - 1.44, 0)
    assert W.gradient(C) == pytest.approx(expected, rel=1e-7, abs=1e-8)
    assert W.takes_complex(C).tolist() == [True, True, False, False]


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_energies_with_kinks_and_edges_keep_the_complex_step(size: float) -> None:
    """Near a kink, and where values nearby are not defined, derivatives stay exact."""
    kinked = Function(lambda e: np.minimum(e[0] - size, 0) ** 2, 1, 1, "kinked")
    edge = Function(lambda e: np.sqrt(e[0] - size), 1, 1, "edge")
    e = size * (1 + np.array([[-1e-2, -1e-4, -1e-9, 0.0, 1e-9, 1e-4]]))
    assert kinked.takes_complex(e).all()
    above = size * (1 + np.array([[1e-12, 1e-9, 1e-6, 1e-3, 1.0]]))
    assert edge.gradient(above)[0] == pytest.approx(0.5 / np.sqrt(above - size), rel=1e-14)


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


def spring_by_hand(kind: str, k: float, free: float, ends: list[Any]) -> vv.Component:
    """A spring of the user whose function refuses complex numbers."""

    def energy(e: Any) -> Any:
        return np.array([0.5 * k * (math.sqrt(v) - free) ** 2 for v in e[0].tolist()])

    if kind == "potential":
        return vv.Potential(of=[vv.SquaredDistance(a=ends[0], b=ends[1])], energy=energy)
    if kind == "spring":
        law = {"energy": lambda l: np.array([0.5 * k * (math.fabs(v) - free) ** 2 for v in l.tolist()])}
        return vv.Spring(a=ends[0], b=ends[1], **law)

    def force(t: float, e: Any, rate: Any) -> Any:
        return [-0.5 * k * (1 - free / math.sqrt(e[0].item()))]

    return vv.GeneralizedForce(of=[vv.SquaredDistance(a=ends[0], b=ends[1])], force=force)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e-6, 1e3])
@pytest.mark.parametrize("kind", ["potential", "spring", "force"])
def test_functions_that_refuse_complex_numbers_serve_any_unit_of_length(kind: str, unit: float) -> None:
    """Against the spring of the core: differences were of an absolute length, and beyond micrometres."""
    ends = []
    for theirs in (False, True):
        balls = [
            vv.PointMass(mass=1.0),
            vv.PointMass(mass=1.0, position=(1.2 * unit, 0, 0), velocity=(0, 0.3 * unit, 0)),
        ]
        own = vv.Spring(a=balls[0], b=balls[1], stiffness=4.0, free_length=unit)
        spring = spring_by_hand(kind, 4.0, unit, balls) if theirs else own
        system = vv.System([*balls, spring])
        scheme = vv.Midpoint() if kind == "force" else vv.EnergyMomentum()
        result = vv.simulate(system, until=1.0, step=0.05, scheme=scheme)
        ends.append((system.x / unit, result.statistics.iterations))
    assert ends[0][0] == pytest.approx(ends[1][0], abs=1e-8)
    assert ends[1][1] <= ends[0][1] + 5
