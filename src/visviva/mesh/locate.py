"""Finding the cell that a material point lies in."""

from __future__ import annotations

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Array, Cell, Ints
from visviva.mesh.mesh import Mesh

TOLERANCE = 1e-8
"""Distance outside a cell, in its reference coordinates, up to which a point counts as inside."""
BESIDE = 0.1
"""Distance from a surface or line, of the size of its cell, up to which a point counts as on it: cells of curved ones
are flatter."""


def inverse(cell: Cell, corners: Array, x: Array) -> Array | None:
    """Reference coordinates (dim,) of the place `x` (d,) in a cell with nodes (k, d); None if Newton fails.

    Of surfaces and lines, those of the place on them that is nearest to `x`.
    """
    xi = cell.centre.copy()
    for _ in range(30):
        gap = x - cell.N(xi[None])[0] @ corners
        J = corners.T @ cell.dN(xi[None])[0]
        try:
            step = np.linalg.solve(J, gap) if len(xi) == len(x) else np.linalg.lstsq(J, gap)[0]
        except np.linalg.LinAlgError:
            return None
        xi = xi + step
        if np.abs(step).max() < 1e-13:
            return xi
        if np.abs(xi).max() > 10:
            return None
    return xi if np.abs(step).max() < 1e-9 else None


def limits(cell: Cell) -> tuple[Array, Array, int]:
    """Least and largest reference coordinates (dim,), and how many of them add up to one at most."""
    corners = np.array(cell.family.corners, dtype=float)
    flat = {3: 2, 6: 2, 4: 3}.get(len(corners), 0) if cell.name[0] in "tw" else 0
    return corners.min(axis=0), corners.max(axis=0), flat


def outside(cell: Cell, xi: Array) -> float:
    """Distance of reference coordinates from the cell; negative inside."""
    low, high, flat = limits(cell)
    excess = float(np.maximum(low - xi, xi - high).max())
    return max(excess, float(xi[:flat].sum()) - 1) if flat else excess


def within(cell: Cell, xi: Array) -> Array:
    """Reference coordinates of a place in the cell near to those given."""
    low, high, flat = limits(cell)
    inner: Array = np.clip(xi, low, high)
    inner[:flat] /= max(float(inner[:flat].sum()), 1.0)
    return inner


def locate(mesh: Mesh, X: Array, label: str = "mesh") -> tuple[Ints, Array]:
    """Nodes (k,) and weights (k,) that interpolate at the reference position `X` (d,).

    Raises
    ------
    InputError
        If the point lies in no cell, with the nearest node.

    Examples
    --------
    >>> from visviva import BoxMesh
    >>> nodes, N = locate(BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build(), np.array([0.5, 0.5, 0.0]))
    >>> sorted(N.round(12).tolist())
    [0.0, 0.0, 0.0, 0.0, 0.25, 0.25, 0.25, 0.25]
    """
    distance = np.linalg.norm(mesh.points - X, axis=1)
    nearest, size = int(np.argmin(distance)), float(np.ptp(mesh.points, axis=0).max())
    if distance[nearest] <= 1e-12 * size:
        return np.array([nearest]), np.ones(1)
    found, least = None, np.inf
    for name, rows in mesh.cells.items():
        cell, corners = CELLS[name], mesh.points[rows]
        low, high = corners.min(axis=1), corners.max(axis=1)
        margin = 0.1 * (high - low).max(axis=1, keepdims=True)
        for row in np.flatnonzero(np.all((low - margin <= X) & (high + margin >= X), axis=1)):
            xi = inverse(cell, corners[row], X)
            if xi is None:
                continue
            N, across = cell.N(xi[None])[0], float(np.ptp(corners[row], axis=0).max())
            away = 0.0 if len(xi) == len(X) else float(np.linalg.norm(N @ corners[row] - X))
            # Of what is beside an edge that juts out the nearest place on either plane is beyond it.
            if outside(cell, xi) <= TOLERANCE + 0.5 * away / across and away < min(BESIDE * across, least):
                near = within(cell, xi) if away else xi
                found, least = (rows[row], cell.N(near[None])[0]), away
    if found is not None:
        return found
    raise InputError(
        f"{label}: the point {X.tolist()} lies in none of its elements; the nearest node is number {nearest} at "
        f"{mesh.points[nearest].tolist()}"
    )
