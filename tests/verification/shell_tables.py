"""Cases of Sze, Liu & Lo (2004) with large rotations, and their tables."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from verification.shell_cases import bent, corner, sheet, symmetric

Array = NDArray[np.float64]

HEMISPHERE = {
    0.05: (0.855, 0.955), 0.1: (1.499, 1.840), 0.25: (2.596, 3.833), 0.5: (3.406, 5.902), 0.75: (3.816, 7.234),
    1.0: (4.067, 8.178),
}  # fmt: skip
"""3.4: by P / 400, how far the rim is pulled out and pushed in."""

OPEN_CYLINDER = {
    0.05: (1.260, 1.471, 1.493), 0.1: (1.707, 2.217, 2.293), 0.25: (2.180, 3.087, 3.310), 0.45: (2.425, 3.539, 3.688),
    0.6: (2.618, 4.274, 3.452), 0.8: (2.710, 4.455, 3.332), 1.0: (2.768, 4.551, 3.269),
}  # fmt: skip
"""3.5: by P / 40000, the way of the pulled point, and inwards of a quarter around, in the middle and at the end."""


def open_cylinder(counts: tuple[int, int], cell: str) -> tuple[vv.System, Callable[[Array], Array]]:
    """3.5: an eighth of it, `counts` along and around, at the full load at t = 1; what its table lists of unknowns."""
    radius, length = 4.953, 10.35
    mesh = bent(
        (length / 2, np.pi / 2),
        counts,
        lambda y, a: np.stack([radius * np.sin(a), y, radius * np.cos(a)], axis=1),
        cell,
    )
    shell = vv.Shell(mesh=mesh, section=sheet(0.094, 10.5e6, 0.3125))
    top, side, end = (corner(shell, *edges) for edges in (("x1", "y0"), ("x1", "y1"), ("x0", "y1")))
    load = vv.Force(on=shell.point(shell.points[top]), force=(0, 0, 1e4), times="t")

    def found(x: Array) -> Array:
        u = shell.displacements(x)
        return np.array([u[top, 2], -u[side, 0], -u[end, 0]])

    return vv.System([shell, *symmetric(shell, y="x1", x="y0", z="y1"), load]), found
