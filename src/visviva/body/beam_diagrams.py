"""Diagrams of the forces and moments in sections of beams, as vectors that stand on the line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DIAGRAMS = {
    "diagram_shear_1": (0, 0, 1.0),
    "diagram_shear_2": (1, 1, 1.0),
    "diagram_normal": (2, 1, 1.0),
    "diagram_bending_1": (3, 1, 1.0),
    "diagram_bending_2": (4, 0, -1.0),
    "diagram_torsion": (5, 1, 1.0),
}
"""Number of the resultant, of the director along which it is drawn, and its sign there: tension, of bending moments."""

ROUNDING = 1e-13
"""Strains, and curvatures times the lengths of cells, that rounding leaves: a hundred times what beams at rest show."""


def rounded_off(resultants: Array, stiffness: Array, lengths: Array) -> Array:
    """Resultants (m, q, 6) with zeros for those that rounding alone makes, as diagrams fill their pictures.

    Parameters
    ----------
    resultants : array (m, q, 6)
    stiffness : array (m, 6)
        Of the sections, by strain: the scale of their forces; zero where multipliers hold the strain.
    lengths : array (m,)
        Of the cells.

    Examples
    --------
    >>> rounded_off(np.array([[[0.0, 0.0, 1e-6, 3e-7, 2.0, 0.0]]]), np.full((1, 6), 1e8), np.ones(1)).tolist()
    [[[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]]]
    """
    least = ROUNDING * stiffness
    least[:, 3:] /= lengths[:, None]
    return np.where(np.abs(resultants) > least[:, None], resultants, 0.0)


def upright(name: str, resultants: Array, directors: Array) -> Array:
    """Vectors (m, q, 3) of a diagram at the points of cells, of resultants (m, q, 6) and directors (m, q, 3, 3) there.

    With ``M_1 = int y_2 sigma dA`` and ``M_2 = -int y_1 sigma dA`` (the part beyond acts on the part before) fibres
    at positive ``y_2`` are in tension under ``M_1 > 0``, those at negative ``y_1`` under ``M_2 > 0``.

    Examples
    --------
    >>> import numpy as np
    >>> upright("diagram_bending_2", np.array([[[0, 0, 0, 0, 5, 0]]]), np.eye(3, dtype=int)[None, None]).tolist()
    [[[-5.0, -0.0, -0.0]]]
    """
    number, along, sign = DIAGRAMS[name]
    return sign * resultants[:, :, number, None] * directors[:, :, along]


def at_ends(values: Array, nodes: Array) -> Array:
    """Polynomials (m, k, 3) at the nodes (k,) of cells in -1..1 through values (m, q, 3) at their q points of Gauss.

    Examples
    --------
    >>> import numpy as np
    >>> at_ends(np.array([[[2 - 3**-0.5], [2 + 3**-0.5]]]), np.array([-1, 1, 0])).round(9).tolist()
    [[[1.0], [3.0], [2.0]]]
    """
    places = np.polynomial.legendre.leggauss(values.shape[1])[0]
    powers = np.arange(len(places))
    to_nodes = nodes[:, None] ** powers @ np.linalg.inv(places[:, None] ** powers)
    return np.asarray(np.einsum("kq,mqc->mkc", to_nodes, values))
