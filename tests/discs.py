"""Meshes of half and whole discs by blocks of quadrilaterals, for verification."""

from __future__ import annotations

import numpy as np

import visviva as vv


def half_disc(radius: float, centre: tuple[float, float], n: int) -> vv.Mesh:
    """Above its flat side, with the set of nodes "base"; n cells along half of that."""
    a, points, cells = 0.5 * radius, [], []
    s, t = np.linspace(-1.0, 1.0, 2 * n + 1), np.linspace(0.0, 1.0, n + 1)
    blocks = [[[(x * a, y * a) for x in s] for y in t]]
    inner = [(a, y * a) for y in t] + [(x * a, a) for x in s[::-1][1:]] + [(-a, y * a) for y in t[::-1][1:]]
    angles = np.linspace(0.0, np.pi, len(inner))
    outer = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    blocks.append([[tuple(p + r * (q - p)) for r in t] for p, q in zip(np.array(inner), outer, strict=True)])
    for block in blocks:
        X = np.array(block)
        number = len(points) + np.arange(X.shape[0] * X.shape[1]).reshape(X.shape[:2])
        points += [tuple(p) for p in X.reshape(-1, 2)]
        cells += (
            np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], -1)
            .reshape(-1, 4)
            .tolist()
        )
    _, first, same = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    X = np.array(points)[first]
    quads = same.reshape(-1)[np.array(cells)]
    (ax, ay), (bx, by) = (np.moveaxis(X[quads[:, k]] - X[quads[:, 0]], -1, 0) for k in (1, 2))
    clockwise = ax * by < ay * bx
    quads[clockwise] = quads[clockwise][:, ::-1]
    base = np.flatnonzero(np.abs(X[:, 1]) < 1e-9)
    return vv.Mesh(X + np.array(centre), {"quad4": quads}, node_sets={"base": base})


def disc(radius: float, centre: tuple[float, float], n: int) -> vv.Mesh:
    """Two halves."""
    half = half_disc(radius, (0.0, 0.0), n)
    points = np.vstack([half.points, -half.points])
    cells = np.vstack([half.cells["quad4"], half.cells["quad4"] + len(half.points)])
    _, first, same = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    return vv.Mesh(points[first] + centre, {"quad4": same.reshape(-1)[cells]})


def annulus(
    radii: tuple[float, float],
    counts: tuple[int, int],
    centre: tuple[float, float] = (0.0, 0.0),
    cell: str = "quad4",
    quarter: bool = False,
) -> vv.Mesh:
    """A ring of cells by counts along the radius and around, closed or in the first quadrant with the sets x0 (inside),
    x1 (outside), y0 and y1 (its ends); nodes begin with the inner ones."""
    whole = vv.RectangleMesh(size=(1, 1), counts=counts, cell=cell).build()
    r = radii[0] + (radii[1] - radii[0]) * whole.points[:, 0]
    angle = (0.5 if quarter else 2.0) * np.pi * whole.points[:, 1]
    points = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1) + centre
    if quarter:
        return vv.Mesh(points, whole.cells, face_sets=whole.face_sets)
    _, first, same = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    inward = np.lexsort((angle[first], r[first]))
    number = np.empty(len(first), dtype=int)
    number[inward] = np.arange(len(first))
    return vv.Mesh(points[first][inward], {cell: number[same.reshape(-1)][whole.cells[cell]]})
