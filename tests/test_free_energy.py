"""Free energies: derivatives against differences, known phase diagrams, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import visviva as vv

ENERGIES = {
    "double well": vv.DoubleWell(barrier=5.0, low=0.3, high=0.7),
    "Flory-Huggins": vv.FloryHuggins(chi=2.5, lengths=(1.0, 3.0), scale=2.0),
    "regular solution": vv.RegularSolution(
        temperature=500.0, excess=(12e3, -3e3, 800.0), standard=(1e3, -2e3), volume=7e3
    ),
    "polynomial": vv.PolynomialEnergy(coefficients=(0.25, 0.1, -0.5, 0.0, 0.25), centre=0.4),
    "user": vv.UserFreeEnergy(function=lambda c: np.cos(6 * c) + c**4),
}


@pytest.mark.parametrize("name", ENERGIES)
def test_derivatives(name: str) -> None:
    f, c, h = ENERGIES[name], np.linspace(0.05, 0.95, 7), 1e-5
    np.testing.assert_allclose((f.values(c + h) - f.values(c - h)) / (2 * h), f.slopes(c), atol=1e-7)
    np.testing.assert_allclose((f.slopes(c + h) - f.slopes(c - h)) / (2 * h), f.curvatures(c), atol=1e-5)


@pytest.mark.parametrize("name", list(ENERGIES)[:-1])
def test_what_the_core_gets(name: str) -> None:
    """Logarithms and a polynomial about a centre."""
    f, c = ENERGIES[name], 0.37
    a, b, centre, *p = f.constants()
    logs = a * c * np.log(c) + b * (1 - c) * np.log(1 - c)
    assert np.polyval(p[::-1], c - centre) + logs == pytest.approx(float(f.values(c)), rel=1e-13)


def test_regular_solution_at_its_binodal() -> None:
    """Without odd terms the binodal is where ``R T ln(c / (1 - c)) = L (2 c - 1)`` (Porter)."""
    R, T, L = 8.31446261815324, 400.0, 9e3
    c = brentq(lambda x: R * T * np.log(x / (1 - x)) - L * (2 * x - 1), 1e-3, 0.4)
    f = vv.RegularSolution(temperature=T, excess=(L,))
    assert abs(f.slopes(np.array([c, 1 - c]))).max() < 1e-8
    assert f.values(c) == pytest.approx(float(f.values(1 - c)), rel=1e-12)


def test_redlich_kister_series() -> None:
    """``x_A x_B sum L_k (x_A - x_B)^k``, written out."""
    c, (L0, L1, L2) = 0.3, (1.0, 2.0, 3.0)
    excess = c * (1 - c) * (L0 + L1 * (1 - 2 * c) + L2 * (1 - 2 * c) ** 2)
    ideal = 8.31446261815324 * 300 * (c * np.log(c) + (1 - c) * np.log(1 - c))
    f = vv.RegularSolution(temperature=300.0, excess=(L0, L1, L2), standard=(5.0, 7.0))
    assert float(f.values(c)) == pytest.approx(excess + ideal + 0.7 * 5 + 0.3 * 7, rel=1e-13)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: vv.DoubleWell(barrier=-1.0), "DoubleWell: barrier = -1 is not positive"),
        (lambda: vv.DoubleWell(barrier=1.0, low=1.0), "high = 1 is not above low = 1"),
        (lambda: vv.FloryHuggins(chi=1.0, lengths=(1.0, 0.0)), "are not both positive"),
        (lambda: vv.RegularSolution(temperature=-5.0), "temperature = -5 is not positive"),
        (
            lambda: vv.RegularSolution(temperature=5.0, excess=[1.0] * 7),
            "excess has 7 coefficients, 6 are known",
        ),
        (lambda: vv.PolynomialEnergy(coefficients=[1.0] * 9), "needs 1 to 8 coefficients, got 9"),
        (lambda: vv.UserFreeEnergy(function="c^2"), "expected a Python function"),
    ],
)
def test_refusals(make: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words.replace("^", r"\^")):
        make()
