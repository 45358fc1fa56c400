"""Quadrature on the reference cells: Gauss rules, symmetric rules on simplices, their products.

All weights are positive and all points lie inside, but for those of `corner_rule`, which are the corners.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations
from typing import NamedTuple

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import HEXAHEDRON, LINE, QUADRILATERAL, TETRAHEDRON, TRIANGLE, WEDGE, Array, cell_type


class Rule(NamedTuple):
    """Points (q, dimension) in reference coordinates and weights (q,)."""

    points: Array
    weights: Array


# Orbits of symmetric rules: weight, and barycentric coordinates of which all permutations are points.
# Triangle: Strang & Fix 1973 (3), Dunavant 1985 (6, 7, 12). Tetrahedron: Keast 1986 (4, 24), Walkington 2000
# (14), and eight points of equal weights. Digits recomputed from the moment equations.
_ORBITS: dict[int, list[tuple[int, list[tuple[float, tuple[float, ...]]]]]] = {
    2: [
        (1, [(1 / 2, (1 / 3, 1 / 3))]),
        (2, [(1 / 6, (1 / 6, 1 / 6))]),
        (
            4,
            [
                (0.1116907948390057328, (0.4459484909159648863, 0.4459484909159648863)),
                (0.05497587182766093382, (0.09157621350977074346, 0.09157621350977074346)),
            ],
        ),
        (
            5,
            [
                (0.1125, (1 / 3, 1 / 3)),
                (0.06619707639425309037, (0.4701420641051150898, 0.4701420641051150898)),
                (0.0629695902724135763, (0.1012865073234563388, 0.1012865073234563388)),
            ],
        ),
        (
            6,
            [
                (0.05839313786318968301, (0.2492867451709104213, 0.2492867451709104213)),
                (0.02542245318510340846, (0.06308901449150222834, 0.06308901449150222834)),
                (0.0414255378091867876, (0.05314504984481694735, 0.3103524510337844054)),
            ],
        ),
    ],
    3: [
        (1, [(1 / 6, (1 / 4, 1 / 4, 1 / 4))]),
        (2, [(1 / 24, (0.1381966011250105152,) * 3)]),
        (3, [(1 / 48, (0.1129567945125110287,) * 3), (1 / 48, (0.3288616499302029104,) * 3)]),
        (
            5,
            [
                (0.01224884051939365826, (0.0927352503108912264,) * 3),
                (0.0187813209530026418, (0.3108859192633006098,) * 3),
                (
                    0.007091003462846911073,
                    (0.04550370412564964949, 0.04550370412564964949, 0.45449629587435035051),
                ),
            ],
        ),
        (
            6,
            [
                (0.006653791709694582017, (0.2146028712591520293,) * 3),
                (0.001679535175886773825, (0.04067395853461135312,) * 3),
                (0.009226196923942453683, (0.3223378901422755103,) * 3),
                (
                    0.008035714285714285714,
                    (0.0636610018750175253, 0.0636610018750175253, 0.269672331458315808),
                ),
            ],
        ),
    ],
}


def _orbit(coordinates: tuple[float, ...]) -> Array:
    """All different permutations of barycentric coordinates, the last of which is left out."""
    full = (*coordinates, 1 - sum(coordinates))
    alike = [min(k for k in range(len(full)) if abs(full[k] - c) < 1e-12) for c in full]
    order = sorted(set(permutations(alike)))
    return np.array([[full[k] for k in row[:-1]] for row in order])


def gauss(n: int, dimension: int = 1) -> Rule:
    """Gauss's rule with `n` points along each coordinate from -1 to 1; the first runs fastest.

    Exact for every coordinate's degree up to ``2n - 1``.

    Examples
    --------
    >>> gauss(2).points.round(4).tolist(), gauss(3, 2).weights.shape
    ([[-0.5774], [0.5774]], (9,))
    """
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.stack(np.meshgrid(*[x] * dimension, indexing="ij")[::-1], axis=-1).reshape(-1, dimension)
    weights = np.prod(np.stack(np.meshgrid(*[w] * dimension)), axis=0).ravel()
    return Rule(points, weights)


def simplex_rule(degree: int, dimension: int) -> Rule:
    """Rule on the unit triangle or tetrahedron, exact for polynomials of a total degree.

    Triangles have 1, 3, 6, 7 or 12 points for the degrees 1, 2, 4, 5, 6, tetrahedra 1, 4, 8, 14 or 24 for
    1, 2, 3, 5, 6; beyond, the rules are products of Gauss-Jacobi rules.

    Examples
    --------
    >>> [len(simplex_rule(degree, 3).weights) for degree in (1, 2, 3, 5, 6)]
    [1, 4, 8, 14, 24]
    """
    for exact, orbits in _ORBITS[dimension]:
        if degree <= exact:
            rows = [_orbit(coordinates) for _, coordinates in orbits]
            weights = [np.full(len(r), weight) for r, (weight, _) in zip(rows, orbits, strict=True)]
            return Rule(np.concatenate(rows), np.concatenate(weights))
    return _collapsed(degree // 2 + 1, dimension)


def _collapsed(n: int, dimension: int) -> Rule:
    """A cube of ``n**dimension`` points collapsed to the unit simplex, exact to the degree ``2n - 1``."""
    from scipy.special import roots_jacobi

    points, weights = np.zeros((1, 0)), np.ones(1)
    for k in range(dimension):  # every further coordinate shrinks the simplex of those before
        t, w = roots_jacobi(n, k, 0)
        t, w = (t + 1) / 2, w / 2 ** (k + 1)
        shrunk = points[None, :, :] * (1 - t[:, None, None])
        last = np.broadcast_to(t[:, None, None], (*shrunk.shape[:2], 1))
        points = np.concatenate([shrunk, last], axis=2).reshape(-1, k + 1)
        weights = (w[:, None] * weights).ravel()
    return Rule(points, weights)


@cache
def rule(cell: str, degree: int) -> Rule:
    """The smallest rule for a cell type that is exact for a polynomial degree.

    Parameters
    ----------
    cell : str
        Name of the type.
    degree : int
        Total degree on triangles and tetrahedra, degree in every coordinate else.

    Examples
    --------
    >>> len(rule("hex8", 3).weights), len(rule("tet10", 2).weights), len(rule("wedge6", 2).weights)
    (8, 4, 6)
    """
    if degree < 0:
        raise InputError(f"degree is {degree}: give a degree of 0 or above")
    family = cell_type(cell).family
    if family in (LINE, QUADRILATERAL, HEXAHEDRON):
        return gauss(degree // 2 + 1, len(family.corners[0]))
    if family in (TRIANGLE, TETRAHEDRON):
        return simplex_rule(degree, len(family.corners[0]))
    assert family is WEDGE
    flat, along = simplex_rule(degree, 2), gauss(degree // 2 + 1)
    points = [np.append(p, z) for z in along.points for p in flat.points]
    return Rule(np.array(points), np.outer(along.weights, flat.weights).ravel())


# Degrees of the default rules: of stiffness, and of mass, which is exact for volumes.
_DEGREES = {
    **dict.fromkeys(["line2", "quad4", "hex8"], (3, 3)),
    **dict.fromkeys(["line3", "quad8", "quad9", "hex20", "hex27"], (5, 5)),
    "line4": (7, 7),
    **dict.fromkeys(["tri3", "tet4"], (1, 2)),
    **dict.fromkeys(["tri6", "tet10"], (2, 4)),
    "wedge6": (2, 2),
}


_CURVED = {"tri6": 4, "tet10": 5}
"""Degrees of the rules of stiffness where edges are curved."""


def stiffness_rule(cell: str, curved: bool = False) -> Rule:
    """The usual full rule for internal forces of a cell type.

    Forces of a constant stress are integrated exactly, so that patches pass. On a tri6 or tet10 with `curved` edges
    stiffness is a rational function, for which rules are richer: eigenfrequencies would miss the exact integral's by
    1e-4 otherwise. The other types' usual rules do for curved cells, too.

    Examples
    --------
    >>> [len(stiffness_rule(name).weights) for name in ("tet4", "tet10", "hex8", "hex20", "quad4", "tri6")]
    [1, 4, 8, 27, 4, 3]
    """
    name = cell_type(cell).name
    return rule(cell, _CURVED.get(name, _DEGREES[name][0]) if curved else _DEGREES[name][0])


def mass_rule(cell: str) -> Rule:
    """The rule for mass, body forces and volume; of a face type, for tractions and pressure.

    Examples
    --------
    >>> [len(mass_rule(name).weights) for name in ("tet4", "tet10", "hex8", "hex20", "quad4", "tri6")]
    [4, 14, 8, 27, 4, 6]
    """
    return rule(cell, _DEGREES[cell_type(cell).name][1])


def corner_rule(cell: str) -> Rule:
    """The corners of a cell without other nodes: exact for linear functions, and what is stored there is lumped.

    Raises
    ------
    InputError
        If the cell has nodes between its corners.

    Examples
    --------
    >>> corner_rule("tri3").weights.round(3).tolist()
    [0.167, 0.167, 0.167]
    """
    kind = cell_type(cell)
    if kind.middles:
        raise InputError(f"{cell} has nodes between its corners; corners alone are no rule for it")
    xi, w = mass_rule(cell)
    return Rule(np.array(kind.family.corners, dtype=float), w @ kind.N(xi))
