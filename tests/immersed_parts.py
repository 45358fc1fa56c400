"""Soft and rigid bodies in fluids, for the tests of what is immersed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from visviva.component.component import Component

Array = NDArray[np.float64]
Components = list[Component]


def part(components: Components, kind: type[Any]) -> Any:
    """The only component of a kind."""
    (found,) = (c for c in components if isinstance(c, kind))
    return found


def vortex(X: Array) -> Array:
    """A swirl in the unit square or cube that sticks to its walls, without divergence."""
    x, y = np.pi * X[:, 0], np.pi * X[:, 1]
    v = np.stack([np.sin(x) ** 2 * np.sin(2 * y), -np.sin(2 * x) * np.sin(y) ** 2, 0 * x], axis=1)
    return np.asarray(v * (np.sin(np.pi * X[:, 2:]) ** 2 if np.ptp(X[:, 2]) > 0 else 1.0))


def box(cell: str = "quad4", n: int = 6, scale: float = 1.0, **options: Any) -> vv.Fluid:
    """A fluid in the unit square or cube, or a larger one."""
    flat = cell.startswith(("tri", "quad"))
    shape: Any = vv.RectangleMesh if flat else vv.BoxMesh
    d = 2 if flat else 3
    mesh = shape(size=(scale,) * d, counts=(n,) * d, cell=cell)
    given = {"density": 1.0, "viscosity": 0.01, "velocity": lambda X: vortex(X / scale), **options}
    return vv.Fluid(mesh=mesh, **given)


def patch(
    dimension: int = 2,
    counts: tuple[int, ...] = (4, 3, 2),
    scale: float = 1.0,
    kind: str | None = None,
    **options: Any,
) -> vv.Solid:
    """A soft block away from the middle, of cells of a `kind`."""
    size, origin = (scale * np.array(a)[:dimension] for a in ((0.3, 0.2, 0.25), (0.5, 0.43, 0.4)))
    shape: Any = vv.RectangleMesh if dimension == 2 else vv.BoxMesh
    kind = kind or ("quad4" if dimension == 2 else "hex8")
    mesh = shape(size=tuple(size), counts=counts[:dimension], origin=tuple(origin), cell=kind)
    return vv.Solid(
        mesh=mesh, **{"material": vv.NeoHooke(young=20.0, poisson=0.3), "density": 1.5, **options}
    )


def carried(
    cell: str = "quad4",
    n: int = 6,
    scale: float = 1.0,
    damping: float = 0.0,
    sealing: float = 1.0,
    leaves: bool = False,
    **options: Any,
) -> Components:
    """A block that swirls in a closed box."""
    fluid = box(cell, n, scale)
    solid = patch(fluid.dimension, scale=scale, **options)
    return [
        fluid,
        vv.NoSlip(fluid=fluid, faces="all"),
        solid,
        vv.Immersed(solid=solid, fluid=fluid, damping=damping, sealing=sealing, leaves=leaves),
    ]


def thin(cell: str = "quad4", n: int = 6) -> Components:
    """A flap a tenth of a cell thick and askew, which swirls in a closed box."""
    fluid, rubber = box(cell, n), vv.NeoHooke(young=500.0, poisson=0.3)
    strip = vv.RectangleMesh(size=(0.4, 0.02), counts=(8, 1), origin=(0.4, 0.5)).build().rotated(0.4)
    solid = vv.Solid(mesh=strip, material=rubber, density=1.5)
    return [fluid, vv.NoSlip(fluid=fluid, faces="all"), solid, vv.Immersed(solid=solid, fluid=fluid)]


def large(cell: str, **options: Any) -> Components:
    """So large that random displacements turn no element inside out."""
    return carried(cell, 3, 10.0, **{"counts": (2, 1, 1), **options})


def body(
    cell: str = "quad4",
    n: int = 6,
    scale: float = 1.0,
    damping: float = 0.0,
    sealing: float = 1.0,
    leaves: bool = False,
    **options: Any,
) -> Components:
    """A rigid block that swirls in a closed box."""
    fluid = box(cell, n, scale)
    size, place = scale * np.array((0.3, 0.2, 0.25)), scale * np.array((0.62, 0.5, 0.52))
    if fluid.dimension == 2:
        size[2], place[2] = 1.0, 0.0
    given = {"density": 1.5, "shape": vv.Box(size=tuple(size)), "position": place, **options}
    block = vv.RigidBody(**given)
    wet = vv.ImmersedBody(body=block, fluid=fluid, damping=damping, sealing=sealing, leaves=leaves)
    return [fluid, vv.NoSlip(fluid=fluid, faces="all"), block, wet]


def flap(cell: str = "quad4", n: int = 6, scale: float = 1.0, **options: Any) -> Components:
    """The same, hinged to the ground at its left side, with a spring and a damper that turn it back."""
    parts, ground = body(cell, n, scale, **options), vv.Ground()
    block: Any = parts[2]
    at = block.position - scale * np.array((0.15, 0.0, 0.0))
    hinge = vv.Revolute(a=ground, b=block, at=at)
    spring, damper = vv.JointSpring(joint=hinge, stiffness=0.02), vv.JointDamper(joint=hinge, damping=0.001)
    return [*parts, ground, hinge, spring, damper]


def immersed(body: vv.Solid | vv.RigidBody, fluid: vv.Fluid) -> vv.Immersed | vv.ImmersedBody:
    """What carries either kind of body along."""
    solid = isinstance(body, vv.Solid)
    return vv.Immersed(solid=body, fluid=fluid) if solid else vv.ImmersedBody(body=body, fluid=fluid)


SHAFT, RADIUS, FALLEN = 1.0, 0.2, (1.0, 2.3, 0.0)
"""Half width of the shaft in which a disc falls, the radius of that, and from where."""


def falling(body: vv.Solid | vv.RigidBody, n: int, cell: str) -> tuple[vv.System, float]:
    """A disc of twice the density after it has fallen for a while between walls, and Faxén's exact speed."""
    lighter = 10.0
    mesh = vv.RectangleMesh(size=(2 * SHAFT, 4 * SHAFT), counts=(n, 2 * n), cell=cell)
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0)
    walls, gravity = vv.NoSlip(fluid=fluid, faces="all"), vv.Gravity(acceleration=(0, -lighter, 0))
    system = vv.System([fluid, walls, body, immersed(body, fluid), gravity], vv.Newton(tolerance=1e-9))
    for _ in vv.march(system, until=0.5, step=0.05, scheme=vv.BackwardEuler()):
        pass
    k = RADIUS / SHAFT
    return system, lighter * RADIUS**2 / 4 * (np.log(1 / k) - 0.9157 + 1.7244 * k**2 - 1.7302 * k**4)


def strip() -> Components:
    """A heavy beam that stands in a fluid at rest and falls over."""
    box = vv.RectangleMesh(size=(1, 1), counts=(6, 6))
    fluid = vv.Fluid(mesh=box, density=1.0, viscosity=0.05)
    section = vv.RectangleSection(width=0.05, height=1.0, young=200.0, density=2.0)
    beam = vv.Beam(
        mesh=vv.LineMesh(points=[(0.5, 0, 0), (0.5, 0.5, 0)], count=3), section=section, first=(1, 0, 0)
    )
    wet = vv.ImmersedThin(body=beam, fluid=fluid, displaced=0.05)
    fall = vv.Gravity(acceleration=(3, -1, 0))
    return [
        fluid,
        vv.NoSlip(fluid=fluid, faces="all"),
        beam,
        vv.Clamped(solid=beam, nodes="start"),
        wet,
        fall,
    ]


def leaflet() -> Components:
    """A shell that floats in a flow."""
    stirred: Any = lambda X: np.prod(np.sin(np.pi * X), axis=1)[:, None] * [0.3, 0.0, 0.5]  # noqa: E731
    box = vv.BoxMesh(size=(1, 1, 1), counts=(3, 3, 3), cell="hex8")
    fluid = vv.Fluid(mesh=box, density=1.0, viscosity=0.05, velocity=stirred)
    flat = vv.RectangleMesh(size=(0.5, 0.5), counts=(2, 2), origin=(0.25, 0.25)).build()
    points = np.column_stack([flat.points, 0.4 + 0.2 * flat.points[:, 0]])
    section = vv.HomogeneousSection(thickness=0.05, young=50.0, poisson=0.3, density=2.0)
    shell = vv.Shell(mesh=vv.Mesh(points, flat.cells), section=section)
    wet = vv.ImmersedThin(body=shell, fluid=fluid, displaced=0.05)
    return [fluid, vv.NoSlip(fluid=fluid, faces="all"), shell, wet]
