"""Mesh of a half disc by four blocks of quadrilaterals, for verification."""

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
