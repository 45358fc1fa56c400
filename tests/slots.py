"""A block with a slot in it, which touches itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

import visviva as vv


def slotted_block(n: int, lower: ArrayLike, upper: ArrayLike) -> vv.Mesh:
    """A block of 2 by 1, n cells long, with a slot at half its height by x from 0.5 to 1.5, the set of faces "slot".

    Lower and upper nodes inside the slot, from left to right, are moved by what is given of each, (n / 2 - 1, 2).
    """
    block = vv.RectangleMesh(size=(2, 1), counts=(n, n // 2)).build()
    points, cells = block.points, block.cells["quad4"]
    x, y = points.T
    inside = np.flatnonzero((np.abs(y - 0.5) < 1e-9) & (x > 0.5 + 1e-9) & (x < 1.5 - 1e-9))
    above = np.arange(len(points))
    above[inside] = len(points) + np.arange(len(inside))
    is_upper = points[cells].mean(axis=1)[:, 1] > 0.5
    below, roof = points.copy(), points[inside] + upper
    below[inside] += lower
    mesh = vv.Mesh(np.vstack([below, roof]), {"quad4": np.where(is_upper[:, None], above[cells], cells)})
    faces = mesh.boundary()
    off, along = np.abs(faces.centres(mesh.points) - (1.0, 0.5)).T
    return mesh.with_faces("slot", faces.where((along < 0.1) & (off < 0.6)))


def along_slot(n: int) -> np.ndarray:
    """Distances (n / 2 - 1,) of the nodes inside the slot from its left end."""
    return np.arange(1, n // 2) * 2 / n
