"""Two flaps in a channel, Hesch & Betsch (2012), section 4.3: a heart valve that does not close, in pulsating flow.

Channel 8 x 1.61 with 256 x 64 cells of equal order, flaps of 40 x 4 linear elements, 0.7 long and 0.0212 thick, clamped
to the walls up to x = 2 with a gap of 0.21; neo-Hooke with lambda = 8e6 and mu = 2e6 (E = 5.6e6, Poisson's ratio 0.4).
Inflow ``5 (sin 2 pi t + 1.1) y (1.61 - y)``, walls where the fluid sticks, an open end. The case is that of Gil et al.
(2010), with density, viscosity and stiffness divided by ten. The density printed in the paper, 1e5, must be a misprint
of 10: it would raise the Reynolds number from about 110 to a million; `--set density=1e5` takes it literally. The flaps
bend without locking by enhanced strains, which the paper does not tell; `--set flaps=linear` leaves these out. With
``flaps=beam`` they are strips of beam elements on the middle line, with the modulus of plane strain, E / (1 - nu^2).
The flow starts at once from rest.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
Cells = Literal["full", "coarse"] | tuple[int, int]
"""Of the fluid, by name or along and across."""

HEIGHT, LENGTH, FLAP, THICKNESS, RIGHT = 1.61, 8.0, 0.7, 0.0212, 2.0
POISSON = 0.4
COUNTS = {"full": (256, 64), "coarse": (128, 32)}
GALLERY = {"mesh": "coarse", "until": 0.4}


def flap(side: Literal["lower", "upper"], young: float, density: float, linear: bool = False) -> vv.Solid:
    """A flap that stands on the lower wall, or hangs from the upper one."""
    y = 0.0 if side == "lower" else HEIGHT - FLAP
    mesh = vv.RectangleMesh(size=(THICKNESS, FLAP), counts=(4, 40), origin=(RIGHT - THICKNESS, y))
    rubber = vv.NeoHooke(young=young, poisson=POISSON)
    formulation: Any = "displacement" if linear else "enhanced"
    return vv.Solid(mesh=mesh, material=rubber, density=density, formulation=formulation, name=f"{side} flap")


def strip(side: Literal["lower", "upper"], young: float, density: float) -> vv.PlaneBeam:
    """The same flap as a beam of width 1."""
    foot, tip = (0.0, FLAP) if side == "lower" else (HEIGHT, HEIGHT - FLAP)
    x = RIGHT - THICKNESS / 2
    line = vv.LineMesh(points=[(x, foot, 0), (x, tip, 0)], count=40)
    section = vv.RectangleSection(
        width=1.0, height=THICKNESS, young=young / (1 - POISSON**2), poisson=POISSON, density=density
    )
    return vv.PlaneBeam(mesh=line, section=section, name=f"{side} flap")


def inflow(t: float, X: Array) -> Array:
    """Velocity of the fluid that enters."""
    y = X[:, 1:2]
    return np.asarray(5.0 * (np.sin(2 * np.pi * t) + 1.1) * y * (HEIGHT - y) * np.array([1.0, 0.0, 0.0]))


def tip(solid: vv.Solid | vv.PlaneBeam) -> int:
    """Node in the middle of the free end."""
    y = FLAP if solid.name == "lower flap" else HEIGHT - FLAP
    return int(np.argmin(np.linalg.norm(solid.points[:, :2] - [RIGHT - THICKNESS / 2, y], axis=1)))


def through(
    fluid: vv.Fluid, lower: vv.Solid | vv.PlaneBeam, upper: vv.Solid | vv.PlaneBeam, x: Array
) -> float:
    """Flow rate through the gap, along the line between the tips."""
    a, b = (s.positions(x)[tip(s), :2] for s in (lower, upper))
    s = (np.arange(100) + 0.5) / 100
    v = fluid.at(a + s[:, None] * (b - a)).velocities(x).mean(axis=0)
    return float(v[0] * (b - a)[1] - v[1] * (b - a)[0])


def channel(
    mesh: Cells, density: float, cell: Literal["quad4", "quad9"] = "quad4"
) -> tuple[vv.Fluid, list[Any]]:
    """The fluid, and what holds at its boundary."""
    counts = COUNTS[mesh] if isinstance(mesh, str) else mesh
    grid = vv.RectangleMesh(size=(LENGTH, HEIGHT), counts=counts, cell=cell)
    blood = vv.Fluid(mesh=grid, density=density, viscosity=1.0, name="blood")
    return blood, [
        vv.VelocityBoundary(fluid=blood, faces="x0", velocity=inflow, name="inflow"),
        vv.NoSlip(fluid=blood, faces="y0", name="lower wall"),
        vv.NoSlip(fluid=blood, faces="y1", name="upper wall"),
        vv.Outlet(fluid=blood, faces="x1", name="end"),
    ]


def study(
    mesh: Cells = "full",
    density: float = 10.0,
    upper_young: float = 5.6e6,
    lower_young: float = 5.6e6,
    until: float = 2.1,
    step: float = 0.01,
    damping: float | None = None,
    sealing: float = 1.0,
    cell: Literal["quad4", "quad9"] = "quad4",
    flaps: Literal["solid", "linear", "beam"] = "solid",
) -> vv.Study:
    """Flaps of other stiffness, as Gil's third example (`lower_young` = 11.2e6), bend one more than the other."""
    blood, openings_and_walls = channel(mesh, density, cell)
    make: Any = strip if flaps == "beam" else partial(flap, linear=flaps == "linear")
    both = make("lower", lower_young, density), make("upper", upper_young, density)
    parts: list[Any] = [blood, *openings_and_walls]
    probes: dict[str, Any] = {}
    for solid, wall in zip(both, ("y0", "y1"), strict=True):
        side = str(solid.name).split()[0]
        wet: Any = {"fluid": blood, "damping": damping, "sealing": sealing, "name": f"{side} flap in blood"}
        if flaps == "beam":
            clamp: Any = vv.Clamped(solid=solid, nodes="start", name=f"{side} clamp")
            parts += [solid, clamp, vv.ImmersedThin(body=solid, displaced=THICKNESS, **wet)]
        else:
            clamp = vv.Fixed(solid=solid, nodes=wall, name=f"{side} clamp")
            parts += [solid, clamp, vv.Immersed(solid=solid, **wet)]
            probes[f"{side}_area"] = vv.Volume(solid=solid)
        node, start = tip(solid), solid.points[tip(solid)]
        probes[f"{side}_tip"] = lambda s, b=solid, n=node, X=start: b.positions(s.x)[n] - X
    probes["gap_flow"] = lambda s: through(blood, *both, s.x)
    newton = vv.Newton(tolerance=1e-9, keep_factor=0.5)
    system = vv.System(parts, newton)
    return vv.Study(
        system,
        until,
        step,
        probes=probes,
        fields=("velocity", "pressure") if flaps == "beam" else ("velocity", "pressure", "von_mises"),
        moments=(0.3, 0.8),
        movie=True,
        title="Two flaps in a channel",
        notes=__doc__,
    )


def check(result: vv.Result) -> None:
    """The energy balance closes; the flaps follow the fluid."""
    check_carried(result, "flaps")


def check_carried(result: vv.Result, bodies: str) -> None:
    """The energy balance closes; what is immersed follows the fluid."""
    ledger = result.ledger
    scale = ledger.size("work_viscosity")
    balances = result.scheme.discrete_gradient  # other schemes dissipate
    assert not balances or ledger.size("imbalance") < 1e-6 * scale, "the energy balance is open"
    assert ledger.greatest("defect_position") < 1e-9, f"the {bodies} do not follow the fluid"
