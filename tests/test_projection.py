"""Projection of values at quadrature points onto shape functions."""

from __future__ import annotations

import numpy as np

from visviva.thermal.projection import Projected, Projection


def test_what_the_functions_hold_is_found_again_and_the_rest_is_orthogonal_to_them() -> None:
    """Two bars of linear functions on three points each: coefficients of a vector, and a parabola by hand."""
    xi, w = np.polynomial.legendre.leggauss(3)
    N = 0.5 * np.column_stack([1 - xi, 1 + xi])
    numbers, lengths = np.array([[0, 1], [1, 2]]), np.array([1.0, 3.0])
    sizes = 0.5 * lengths[:, None] * w
    project = Projection(3, [Projected(numbers[:1], N, sizes[:1]), Projected(numbers[1:], N, sizes[1:])])
    nodes = np.array([[1.0, -2.0], [4.0, 0.5], [-3.0, 7.0]])
    at_points = [N @ nodes[some] for some in numbers]
    np.testing.assert_allclose(project([values[None] for values in at_points]), nodes, rtol=1e-14)
    parabola = [xi[None] ** 2, 0 * xi[None]]
    # of xi^2 in the first cell alone: (1/3) at both functions, times half its length
    mass = np.array([[2, 1, 0], [1, 2 + 6, 3], [0, 3, 6]]) / 6
    expected = np.linalg.solve(mass, np.array([1, 1, 0]) / 6)
    np.testing.assert_allclose(project(parabola), expected, rtol=1e-13)
