"""Pinched cylinder: a thin tube between stiff diaphragms is pressed together at its middle, far beyond small bending.

The eighth of it that symmetry leaves is a shell of four-node elements in load steps. The tube is that of Sze, Liu & Lo
(2004), section 3.6, whose tables go to a deflection of 83 at a radius of 100; dents form and wander on the way.
"""

from __future__ import annotations

import numpy as np

import visviva as vv

RADIUS, LENGTH, THICKNESS, YOUNG, POISSON, LARGEST = 100.0, 200.0, 1.0, 30e3, 0.3, 12000.0
TABLE = {0.05: 9.561, 0.1: 23.164}
"""Shares of the largest force, and deflections under it."""


def study(count: int = 24, share: float = 0.1, step: float = 0.05, until: float = 1.0) -> vv.Study:
    """`count` elements along each side of the eighth, under a `share` of the largest force."""
    flat = vv.RectangleMesh(size=(LENGTH / 2, np.pi / 2), counts=(count, count)).build()
    y, a = flat.points.T
    points = np.stack([RADIUS * np.sin(a), y, RADIUS * np.cos(a)], axis=1)
    mesh = vv.Mesh(points, flat.cells, face_sets=flat.face_sets)
    section = vv.HomogeneousSection(thickness=THICKNESS, young=YOUNG, poisson=POISSON)
    tube = vv.Shell(mesh=mesh, section=section, name="tube")
    diaphragm = vv.Fixed(solid=tube, nodes="x0", directions=(True, False, True), name="diaphragm")
    planes = [
        vv.SymmetryPlane(solid=tube, nodes=nodes, normal=normal, name=name)
        for name, nodes, normal in (
            ("middle", "x1", (0, 1, 0)),
            ("crown", "y0", (1, 0, 0)),
            ("side", "y1", (0, 0, 1)),
        )
    ]
    top = (0.0, LENGTH / 2, RADIUS)
    pinch = vv.Force(on=tube, at=top, force=(0, 0, -share * LARGEST / 4), times="t", name="pinch")
    system = vv.System([tube, diaphragm, *planes, pinch])
    probes = {"crown": vv.Position(of=tube, at=top)}
    return vv.Study(
        system,
        until,
        step,
        vv.Static(),
        probes,
        pictures=vv.Pictures(field="bending_moment"),
        title="Pinched cylinder",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The deflection under the load is the table's, from below, as far as that tells."""
    (tube,) = (c for c in result.system.components if isinstance(c, vv.Shell))
    (pinch,) = (c for c in result.system.components if isinstance(c, vv.Force))
    share = -pinch.force[2] * result.times[-1] * 4 / LARGEST
    expected = next((w for known, w in TABLE.items() if abs(known - share) < 1e-9), None)
    found = RADIUS - result.history(tube.point_at((0.0, LENGTH / 2, RADIUS)).position)[-1, 2]
    if expected is not None and tube.n_cells >= 24**2:
        assert 0.9 * expected < found < 1.03 * expected, f"deflection {found}, the table's {expected}"
