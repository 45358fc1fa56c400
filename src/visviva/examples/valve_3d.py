"""Two flaps in a duct in space, driven by a pulsating inflow: the paper's valve, coarse and three-dimensional.

The channel of `valve` with a width of 1 and walls on all sides. The flaps stand in the middle and leave room at
their sides too; they are ten times as thick and a hundredth as stiff as those in the plane, so that cells of the
size of an eighth of the height hold them.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.examples.valve import FLAP, HEIGHT, check_carried

Array = NDArray[np.float64]

LENGTH, WIDTH, SPAN, THICKNESS, LEFT = 4.0, 1.0, 0.6, 0.2, 1.2
COUNTS = {"coarse": (20, 8, 6), "fine": (40, 16, 10)}
GALLERY = {"until": 0.2}


def inflow(t: float, X: Array) -> Array:
    """Velocity of the fluid that enters, without a jump at the start."""
    y, z = X[:, 1:2], X[:, 2:3]
    shape = y * (HEIGHT - y) * 4 * z * (WIDTH - z) / WIDTH**2
    return np.asarray(2.5 * (1 - np.cos(2 * np.pi * t)) * shape * np.array([1.0, 0.0, 0.0]))


def study(
    mesh: Literal["coarse", "fine"] = "coarse",
    young: float = 5.6e4,
    density: float = 10.0,
    until: float = 1.0,
    step: float = 0.02,
    damping: float = 0.05,
) -> vv.Study:
    """Flaps of neo-Hooke with the modulus `young`, in a fluid of the same `density`."""
    grid = vv.BoxMesh(size=(LENGTH, HEIGHT, WIDTH), counts=COUNTS[mesh], cell="hex8")
    blood = vv.Fluid(mesh=grid, density=density, viscosity=1.0, name="blood")
    walls = [vv.NoSlip(fluid=blood, faces=side, name=f"wall {side}") for side in ("y0", "y1", "z0", "z1")]
    inlet = vv.VelocityBoundary(fluid=blood, faces="x0", velocity=inflow, name="inflow")
    parts: list[Any] = [blood, inlet, *walls, vv.Outlet(fluid=blood, faces="x1", name="end")]
    probes: dict[str, Any] = {}
    for side, y, foot in (("lower", 0.0, "y0"), ("upper", HEIGHT - FLAP, "y1")):
        size, origin = (THICKNESS, FLAP, SPAN), (LEFT, y, (WIDTH - SPAN) / 2)
        box = vv.BoxMesh(size=size, counts=(2, 6, 5), origin=origin)
        rubber = vv.NeoHooke(young=young, poisson=0.4)
        solid = vv.Solid(
            mesh=box, material=rubber, density=density, formulation="enhanced", name=f"{side} flap"
        )
        tip = int(np.argmin(np.linalg.norm(solid.points - [LEFT, HEIGHT / 2, WIDTH / 2], axis=1)))
        start = solid.points[tip]
        parts += [
            solid,
            vv.Fixed(solid=solid, nodes=foot, name=f"{side} clamp"),
            vv.Immersed(solid=solid, fluid=blood, damping=damping, name=f"{side} flap in blood"),
        ]
        probes[f"{side}_tip"] = lambda s, b=solid, n=tip, X=start: b.positions(s.x)[n] - X
        probes[f"{side}_volume"] = vv.Volume(solid=solid)
    return vv.Study(
        vv.System(parts, vv.Newton(tolerance=1e-9)),
        until,
        step,
        probes=probes,
        fields=("velocity", "pressure", "von_mises"),
        moments=(0.5,),
        title="Two flaps in a duct",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy balance closes; the flaps follow the fluid."""
    check_carried(result, "flaps")
