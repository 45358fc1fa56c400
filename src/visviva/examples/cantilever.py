"""Cantilever of 20-node bricks under a dead load on its end face: vibrating, or in equilibrium.

Dynamics: the load is there from the start, and the beam swings about its equilibrium. Statics: the load grows in steps,
and the deflection is compared with that of a beam with bending and shear (which does not know that the clamp keeps the
section from contracting, too).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

import visviva as vv

LENGTH, HEIGHT, YOUNG, POISSON, DENSITY = 10.0, 1.0, 1e4, 0.3, 1.0


def study(
    motion: Literal["dynamic", "static"] = "dynamic",
    force: float = 2.0,
    counts: tuple[int, int, int] = (20, 2, 2),
    cell: Literal["hex8", "hex20", "hex27"] = "hex20",
    until: float | None = None,
    step: float | None = None,
) -> vv.Study:
    """A square bar of steel-like stiffness along x, held at x = 0, pushed down by `force` at its end."""
    static = motion == "static"
    mesh = vv.BoxMesh(
        size=(LENGTH, HEIGHT, HEIGHT), counts=counts, cell=cell, origin=(0, -HEIGHT / 2, -HEIGHT / 2)
    )
    material = vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON)
    beam = vv.Solid(mesh=mesh, material=material, density=DENSITY, name="beam")
    clamp = vv.Fixed(solid=beam, nodes="x0", name="clamp")
    down = (0.0, 0.0, -force / HEIGHT**2)
    load = vv.Traction(solid=beam, faces="x1", traction=down, times="t" if static else None, name="load")
    system = vv.System([beam, clamp, load])
    probes = {
        "tip": vv.Position(of=beam, at=(LENGTH, 0, 0)),
        "stress": vv.Extreme(solid=beam, field="von_mises"),
        "clamp_force": vv.SupportForce(solid=beam, nodes="x0"),
    }
    scheme = vv.Static() if static else vv.EnergyMomentum()
    title = "Cantilever in equilibrium" if static else "Swinging cantilever"
    times = (1.0, 0.25) if static else (9.3, 0.05)
    return vv.Study(
        system,
        until or times[0],
        step or times[1],
        scheme,
        probes,
        trails=("tip",),
        title=title,
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """Statics: the deflection of a beam, for small loads to 2 percent. Dynamics: energy."""
    if not isinstance(result.scheme, vv.Static):
        result.assert_conserved("energy")
        return
    (beam,) = (c for c in result.system.components if isinstance(c, vv.Solid))
    (load,) = (c for c in result.system.components if isinstance(c, vv.Traction))
    force = -load.traction[2] * HEIGHT**2 * result.times[-1]
    bending = force * LENGTH**3 / (3 * YOUNG * HEIGHT**4 / 12)
    shear = (
        force * LENGTH / (10 * (1 + POISSON) / (12 + 11 * POISSON) * YOUNG / (2 * (1 + POISSON)) * HEIGHT**2)
    )
    found = -result.history(beam.point_at((LENGTH, 0, 0)).position)[-1, 2]
    if bending < 0.1 * LENGTH:
        assert np.isclose(found, bending + shear, rtol=0.02), (
            f"deflection {found}, a beam's {bending + shear}"
        )
