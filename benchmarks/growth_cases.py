"""Cases that can be made as large as one likes, for `growth.py`: each from a number of cells along an edge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from cases import Kind, chain
from numpy.typing import NDArray
from ours import system_of as bodies_of

import visviva as vv
from visviva.mesh.generate import PlaneCell, SolidCell

Array = NDArray[np.float64]
RUBBER = vv.NeoHooke(young=1000.0, poisson=0.3)
VISCOSITY = 0.01


@dataclass(frozen=True)
class Motion:
    """A system, and how it is to be marched: steps of length `step`, the first of which is not timed."""

    system: vv.System
    scheme: vv.Scheme
    step: float
    steps: int = 3


@dataclass(frozen=True)
class Growing:
    """A case by its size.

    `modest` sizes reach up to some 10^5 unknowns, `full` ones as far as this machine goes. Times of iterations that
    grow faster than unknowns to the power `allowed` are a fault; `memory` is the most in kB per unknown.
    """

    title: str
    build: Callable[[int], Motion]
    modest: Sequence[int]
    full: Sequence[int]
    allowed: float = 1.15
    memory: float = np.inf


def static(parts: list[Any]) -> Motion:
    """Two load steps."""
    return Motion(vv.System(parts), vv.Static(tolerance=1e-8), 0.1, 2)


def block(n: int, cell: SolidCell) -> Motion:
    """A cube clamped at one face and pulled aside at the opposite one."""
    cube = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n), cell=cell), material=RUBBER)
    pull = vv.Traction(solid=cube, faces="x1", traction=(0, 0, -20.0), times="t")
    return static([cube, vv.Fixed(solid=cube, nodes="x0"), pull])


def swinging(n: int) -> Motion:
    """The same cube in motion, by steps in which waves pass two cells."""
    cube = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)),
        material=RUBBER,
        density=1.0,
        velocity=lambda X: X[:, :1] * [0.0, 1.0, -3.0],
    )
    speed = np.sqrt(1000.0 * 1.35)  # of waves of pressure
    return Motion(vv.System([cube, vv.Fixed(solid=cube, nodes="x0")]), vv.EnergyMomentum(), 2 / n / speed, 5)


def blocks(n: int) -> Motion:
    """Two blocks, one pushed onto the other and aside; meshes do not match."""
    m = max(1, round(13 * n / 15))
    lower = vv.BoxMesh(size=(1.3, 1.3, 0.5), origin=(-0.16, -0.14, 0.0), counts=(n, n, max(1, n // 2)))
    upper = vv.BoxMesh(size=(1.0, 1.0, 0.5), origin=(0.0, 0.0, 0.5), counts=(m, m, max(1, m // 2)))
    below, above = (vv.Solid(mesh=mesh, material=RUBBER) for mesh in (lower, upper))
    push = vv.Prescribed(solid=above, nodes="z1", motion=("0.06*t", "0*t", "-0.1*t"))
    touch = vv.Contact(first=above, first_faces="z0", second=below, second_faces="z1")
    return static([below, above, vv.Fixed(solid=below, nodes="z0"), push, touch])


def bodies(n: int) -> Motion:
    """The chain of rods on ball joints of the comparison of mechanisms."""
    return Motion(bodies_of(chain("chain-ball", Kind.SPHERICAL, n))[0], vv.EnergyMomentum(), 1e-3, 10)


def cavity(n: int, cell: PlaneCell | SolidCell) -> list[Any]:
    """A unit box whose lid moves, in the plane or in space; Reynolds' number is 100."""
    flat = cell.startswith("quad")
    d = 2 if flat else 3
    shape: Any = vv.RectangleMesh if flat else vv.BoxMesh
    fluid = vv.Fluid(
        mesh=shape(size=(1,) * d, counts=(n,) * d, cell=cell), density=1.0, viscosity=VISCOSITY, speed=1.0
    )

    def slide(t: float, X: Array) -> Array:
        across = 16 * X[:, :1] ** 2 * (1 - X[:, :1]) ** 2
        return np.asarray(min(t, 1.0) * across * [1.0, 0.0, 0.0])

    sides = [s for s in fluid.grid.face_sets if s != "y1"]
    lid = vv.VelocityBoundary(fluid=fluid, faces="y1", velocity=slide)
    return [fluid, lid, *(vv.NoSlip(fluid=fluid, faces=s) for s in sides)]


def flow(n: int, cell: PlaneCell | SolidCell) -> Motion:
    """The cavity, by steps in which the lid passes a cell."""
    return Motion(vv.System(cavity(n, cell)), vv.EnergyMomentum(), 1 / n)


def immersed(n: int) -> Motion:
    """A soft block near the lid of the cavity; its cells are about as large as the fluid's."""
    parts = cavity(n, "hex8")
    counts = tuple(max(1, round(side * n)) for side in (0.4, 0.2, 0.4))
    mesh = vv.BoxMesh(size=(0.4, 0.2, 0.4), counts=counts, origin=(0.3, 0.65, 0.3))
    soft = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=20.0, poisson=0.3), density=1.5)
    return Motion(
        vv.System([*parts, soft, vv.Immersed(solid=soft, fluid=parts[0])]), vv.EnergyMomentum(), 1 / n
    )


CASES = {
    "statics": Growing(
        "solid, statics, hex8", lambda n: block(n, "hex8"), (7, 15, 32), (7, 15, 32, 69, 87), memory=2.5
    ),
    "tetrahedra": Growing(
        "solid, statics, tet4", lambda n: block(n, "tet4"), (7, 15, 32), (7, 15, 32, 69, 87), memory=2.5
    ),
    "dynamics": Growing("solid, dynamics, hex8", swinging, (7, 15, 32), (7, 15, 32, 69, 87), memory=2.5),
    "contact": Growing("contact, statics", blocks, (7, 14, 30), (7, 14, 30, 60)),
    "chain": Growing("chain of bodies", bodies, (10, 100, 1000), (10, 100, 1000, 10_000, 100_000)),
    "plane-q2q1": Growing(
        "flow in the plane, Q2Q1", lambda n: flow(n, "quad9"), (10, 32, 100), (10, 32, 100, 320), 1.5
    ),
    "plane-q1q1": Growing(
        "flow in the plane, Q1Q1", lambda n: flow(n, "quad4"), (18, 58, 180), (18, 58, 180, 570), 1.5
    ),
    "q2q1": Growing(
        "flow in space, Q2Q1", lambda n: flow(n, "hex27"), (3, 7, 14), (3, 7, 14, 20, 33), memory=6.0
    ),
    "q1q1": Growing(
        "flow in space, Q1Q1", lambda n: flow(n, "hex8"), (6, 12, 27), (6, 12, 27, 40, 63), memory=3.0
    ),
    "immersed": Growing("soft block in flow in space", immersed, (6, 12, 24), (6, 12, 24, 40)),
}
