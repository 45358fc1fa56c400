"""Two leaflets in a duct in space: the valve of `valve_3d` with shells as flaps, as thin as leaflets are.

The leaflets stand in the middle of the duct and leave room at their sides. Their thickness is a fortieth of the height;
the fluid in their place is that of `displaced` times their area.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

import visviva as vv
from visviva.examples.valve import FLAP, HEIGHT, check_carried
from visviva.examples.valve_3d import COUNTS, LEFT, LENGTH, SPAN, WIDTH, inflow

THICKNESS = 0.04
GALLERY = {"until": 0.2}


def leaflet(side: Literal["lower", "upper"], young: float, density: float) -> vv.Shell:
    """A leaflet that stands on the lower wall, or hangs from the upper one; its free edge is 'y1'."""
    flat = vv.RectangleMesh(size=(SPAN, FLAP), counts=(5, 6)).build()
    across, up = flat.points.T
    y = up if side == "lower" else HEIGHT - up
    points = np.column_stack([np.full(len(y), LEFT), y, (WIDTH - SPAN) / 2 + across])
    section = vv.HomogeneousSection(thickness=THICKNESS, young=young, poisson=0.4, density=density)
    mesh = vv.Mesh(points, flat.cells, face_sets=flat.face_sets)
    return vv.Shell(mesh=mesh, section=section, name=f"{side} leaflet")


def study(
    mesh: Literal["coarse", "fine"] = "coarse",
    young: float = 2e6,
    density: float = 10.0,
    until: float = 1.0,
    step: float = 0.02,
    damping: float = 0.05,
) -> vv.Study:
    """Leaflets with the modulus `young`, in a fluid of the same `density`."""
    grid = vv.BoxMesh(size=(LENGTH, HEIGHT, WIDTH), counts=COUNTS[mesh], cell="hex8")
    blood = vv.Fluid(mesh=grid, density=density, viscosity=1.0, name="blood")
    walls = [vv.NoSlip(fluid=blood, faces=side, name=f"wall {side}") for side in ("y0", "y1", "z0", "z1")]
    inlet = vv.VelocityBoundary(fluid=blood, faces="x0", velocity=inflow, name="inflow")
    parts: list[Any] = [blood, inlet, *walls, vv.Outlet(fluid=blood, faces="x1", name="end")]
    probes: dict[str, Any] = {}
    for side in ("lower", "upper"):
        shell = leaflet(side, young, density)
        wet = vv.ImmersedThin(
            body=shell, fluid=blood, displaced=THICKNESS, damping=damping, name=f"{side} leaflet in blood"
        )
        parts += [shell, vv.Clamped(solid=shell, nodes="y0", name=f"{side} clamp"), wet]
        start = shell.points[shell.nodes("y1")].mean(axis=0)
        probes[f"{side}_edge"] = lambda s, b=shell, X=start: b.positions(s.x)[b.nodes("y1")].mean(axis=0) - X
    return vv.Study(
        vv.System(parts, vv.Newton(tolerance=1e-9)),
        until,
        step,
        probes=probes,
        fields=("velocity", "pressure"),
        moments=(0.5,),
        title="Two leaflets in a duct",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy balance closes; the leaflets follow the fluid, alike but for nodes that pass from cell to cell."""
    check_carried(result, "leaflets")
    shells: list[Any] = [c for c in result.system.components if isinstance(c, vv.Shell)]
    lower, upper = (b.displacements(result.system.x)[b.nodes("y1")].mean(axis=0) for b in shells)
    apart = np.abs(lower - upper * (1, -1, 1)).max()
    assert apart < 0.02 * np.abs(lower).max(), f"the leaflets do not move alike: by {apart:.2g}"
