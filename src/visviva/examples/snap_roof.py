"""Hinged roof: a shallow cylindrical shell is pressed down at its middle, snaps through, and carries again upside down.

A quarter of it is a shell of four-node elements. The load rises to a limit, falls to another one while the middle goes
on down, and rises again: arc length follows the path through both. The roof is that of Sze, Liu & Lo (2004), section
3.8, 12.7 thick, of isotropic material or of three plies.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

import visviva as vv

RADIUS, HALF_LENGTH, HALF_ANGLE, THICKNESS, LARGEST = 2540.0, 254.0, 0.1, 12.7, 3000.0
LIMITS = {"isotropic": (0.7421, 0.1729), "0/90/0": (0.3618, -0.0504), "90/0/90": (0.597, 0.2789)}
"""Largest load on the way and smallest behind it, of the points of the tables; shares of the largest force."""
Plies = Literal["isotropic", "0/90/0", "90/0/90"]


def section(plies: Plies) -> vv.HomogeneousSection | vv.Laminate:
    """Of the roof; direction 1 is along its generatrices, which plies of 0 degrees follow."""
    if plies == "isotropic":
        return vv.HomogeneousSection(thickness=THICKNESS, young=3102.75, poisson=0.3)
    elastic = {"young": 3300.0, "across": 1100.0, "poisson": 0.25, "shear": 660.0, "thickness": THICKNESS / 3}
    return vv.Laminate(plies=tuple(vv.Ply(angle=float(a), **elastic) for a in plies.split("/")))


def study(count: int = 16, plies: Plies = "isotropic", step: float = 0.05, until: float = 1.0) -> vv.Study:
    """`count` elements along each side of the quarter."""
    flat = vv.RectangleMesh(size=(HALF_ANGLE, HALF_LENGTH), counts=(count, count)).build()
    a, y = flat.points.T
    points = np.stack([RADIUS * np.sin(a), y, RADIUS * (np.cos(a) - np.cos(HALF_ANGLE))], axis=1)
    mesh = vv.Mesh(points, flat.cells, face_sets=flat.face_sets)
    roof = vv.Shell(mesh=mesh, section=section(plies), first=(0, 1, 0), name="roof")
    hinge = vv.Fixed(solid=roof, nodes="x1", name="hinge")
    planes = [
        vv.SymmetryPlane(solid=roof, nodes=nodes, normal=normal, name=name)
        for name, nodes, normal in (("ridge", "x0", (1, 0, 0)), ("middle", "y0", (0, 1, 0)))
    ]
    top = (0.0, 0.0, RADIUS * (1 - np.cos(HALF_ANGLE)))
    load = vv.Force(on=roof, at=top, force=(0, 0, -LARGEST / 4), times="t", name="load")
    probes = {"top": vv.Displacement(of=roof, at=top)}
    scheme = vv.ArcLength(longest=2.0)
    system = vv.System([roof, hinge, *planes, load])
    return vv.Study(
        system,
        until,
        step,
        scheme,
        probes,
        units="N-mm-t",
        pictures=vv.Pictures(field="bending_moment"),
        title="Roof that snaps through",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Both limit loads are those of the table, as far as the path goes and the steps tell."""
    (roof,) = (c for c in result.system.components if isinstance(c, vv.Shell))
    load = np.asarray(result.times)
    if load[-1] < 1.0 or roof.n_cells < 64:
        return
    plies = "isotropic"
    if isinstance(roof.section, vv.Laminate):
        plies = "0/90/0" if roof.section.plies[0].angle == 0 else "90/0/90"
    peak = int(np.argmax(np.diff(load) < 0))
    found = load[peak], load[peak:].min()
    np.testing.assert_allclose(found, LIMITS[plies], atol=0.03)
