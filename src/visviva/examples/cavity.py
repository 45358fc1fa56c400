"""Lid-driven cavity: the steady flow in a square box whose lid slides along, by continuation in the Reynolds number.

The corners of the lid belong to the walls. Velocities on both centre lines are compared with Botella & Peyret (1998)
for the Reynolds number 1000, and with a spectral solution for 100 and 400.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

HEIGHTS = (0.0547, 0.1016, 0.1719, 0.2813, 0.4531, 0.5, 0.6172, 0.7344, 0.8516, 0.9531, 0.9766)
SPEEDS = {
    100: (-0.037228, -0.064431, -0.101742, -0.157673, -0.213977, -0.209149, -0.138798, 0.004187, 0.236552, 0.691027,
          0.843732),
    400: (-0.081822, -0.146191, -0.243780, -0.328717, -0.171483, -0.115054, 0.021034, 0.162567, 0.292033, 0.561565,
          0.760671),
    1000: (-0.1812881, -0.3004561, -0.3885691, -0.2803696, -0.1081999, -0.0620561, 0.0570178, 0.1886747, 0.3372212,
           0.4723329, 0.6644227),
}  # fmt: skip
"""Horizontal velocities at these heights on the vertical centre line, by the Reynolds number."""

PLACES = (0.0625, 0.0781, 0.0938, 0.1563, 0.2266, 0.5, 0.8047, 0.8594, 0.9063, 0.9453, 0.9688)
RISES = {
    100: (0.094808, 0.111752, 0.126428, 0.164824, 0.179357, 0.057537, -0.253543, -0.233692, -0.177080, -0.108533,
          -0.062193),
    400: (0.185132, 0.210965, 0.231721, 0.283543, 0.303825, 0.052058, -0.385656, -0.453836, -0.389686, -0.234722,
          -0.125147),
    1000: (0.2807056, 0.3099097, 0.3330442, 0.3769189, 0.3339924, 0.0257995, -0.3202137, -0.4264545, -0.5264392,
           -0.4103754, -0.2279225),
}  # fmt: skip
"""Vertical velocities at these places on the horizontal centre line."""


def study(reynolds: float = 400.0, count: int = 24, elements: str = "Q2Q1", step: float = 0.25) -> vv.Study:
    """A unit square of `count` cells along each side, finer at the walls; the lid's speed grows from 0 to 1."""
    mesh = vv.RectangleMesh(
        size=(1, 1), counts=(count, count), cell="tri3" if elements[0] == "P" else "quad4"
    )
    grid = mesh.build()
    s = grid.points
    graded = vv.Mesh(s - 0.12 * np.sin(2 * np.pi * s), grid.cells, face_sets=grid.face_sets)
    water = vv.Fluid(mesh=graded, density=1.0, viscosity=1 / reynolds, elements=elements, name="water")
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=("t", 0, 0), name="lid")
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    system = vv.System([water, lid, *walls])
    probes = {
        "centre": vv.FlowField(fluid=water, at=(0.5, 0.5, 0)),
        "lid_force": vv.FlowForce(fluid=water, faces="y1"),
    }
    return vv.Study(
        system,
        1.0,
        step,
        vv.Static(),
        probes,
        fields=("speed", "pressure", "vorticity"),
        title=f"Lid-driven cavity at the Reynolds number {reynolds:g}",
        notes=__doc__,
    )


def deviations(result: vv.Result) -> Array:
    """Differences (2, n) from the reference velocities across the vertical and the horizontal centre line."""
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    reynolds = round(1 / water.viscosity)
    upright = water.at([(0.5, y) for y in HEIGHTS]).velocities(result.system.x)[:, 0]
    level = water.at([(x, 0.5) for x in PLACES]).velocities(result.system.x)[:, 1]
    return np.asarray([upright - SPEEDS[reynolds], level - RISES[reynolds]])


def check(result: vv.Result) -> None:
    """The centre lines to 0.3 percent of the lid's speed, where there is a reference; the balance of power."""
    result.assert_conserved("energy")
    (water,) = (c for c in result.system.components if isinstance(c, vv.Fluid))
    if result.times[-1] == 1.0 and round(1 / water.viscosity) in SPEEDS:
        assert np.abs(deviations(result)).max() < 3e-3, f"off by {deviations(result)}"
