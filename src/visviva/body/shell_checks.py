"""Checks of the middle surface of a shell: edges that do not meet, thickness above the radius of curvature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.body.shell_surface import ShellSurface
from visviva.mesh.faces import boundary

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
APART = 1e-3
"""Of an edge's length: nodes that are nearer to it than this seem to lie on it."""


def refuse_thick(parts: Sequence[ShellSurface], heights: Sequence[Array]) -> None:
    """Refuse sections (m, 2) of parts that are thicker than the radius of curvature of the middle.

    Raises
    ------
    InputError
    """
    first = 0
    for part, (low, high) in zip(parts, ((h[:, 0], h[:, 1]) for h in heights), strict=True):
        k = (part.section_strains @ part.reference[:, None, :, None])[..., 3:6, 0]
        middle, apart = 0.5 * (k[..., 0] + k[..., 1]), 0.5 * np.hypot(k[..., 0] - k[..., 1], k[..., 2])
        curvature = (np.abs(middle) + apart).max(axis=1)
        if not np.all(curvature * (high - low) < 1):
            cell = int(np.argmax(curvature * (high - low)))
            raise InputError(
                f"{part.label}: its thickness exceeds the radius of curvature in cell {first + cell}, "
                f"{high[cell] - low[cell]:g} against {1 / curvature[cell]:g}; make it thinner, or mesh a "
                "smoother surface"
            )
        first += len(part.cells)


def refuse_slits(label: str, points: Array, cells: dict[str, Ints]) -> None:
    """Refuse border nodes that lie on other border edges without being part of them.

    Raises
    ------
    InputError
    """
    from scipy.spatial import cKDTree

    edges = np.concatenate(
        [nodes[:, :2] for nodes in boundary(cells).cells.values()] or [np.zeros((0, 2), int)]
    )
    if not len(edges):
        return
    nodes = np.unique(edges)
    a, along = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    near = cKDTree(points[nodes]).query_ball_point(a + 0.5 * along, (0.5 + APART) * length)
    edge = np.repeat(np.arange(len(edges)), [len(k) for k in near])
    node = nodes[np.concatenate([np.asarray(k, dtype=np.int64) for k in near])]
    foreign = np.all(edges[edge] != node[:, None], axis=1)
    edge, node = edge[foreign], node[foreign]
    arm = points[node] - a[edge]
    s = np.clip((arm * along[edge]).sum(axis=1) / length[edge] ** 2, 0, 1)
    apart = np.linalg.norm(arm - s[:, None] * along[edge], axis=1) < APART * length[edge]
    if np.any(apart):
        k = int(np.argmax(apart))
        raise InputError(
            f"{label}: edges of its mesh do not meet: node {node[k]} lies on the edge of nodes "
            f"{edges[edge[k]].tolist()} and is none of them, as {len(np.unique(node[apart]))} nodes do; there the "
            "shell would be slit: merge nodes that are one, mesh both sides alike, or give slits='open' where it is"
        )
