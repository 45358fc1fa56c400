"""Small systems, for `alike.py`, that start strained, with jumps or out of balance, and cells that repeat."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from slots import along_slot, slotted_block

import visviva as vv

RUBBER, SOFT = vv.NeoHooke(young=100.0, poisson=0.3), vv.NeoHooke(shear=40.0, poisson=0.45)
HEAT = vv.Heat(conductivity=2.0, capacity=3.0, expansion=1e-3, reference=300.0)
STRAINED = "strained"
"""Systems whose names begin so start with their solids bent, see `strain`."""
SIDES = (("x0", "x1"), ("y0", "y1"))


def block(formulation: str, cell: str = "hex8", kind: Any = vv.Solid, **options: Any) -> list[Any]:
    """A block that is held at one end and pulled at the other."""
    mesh = vv.BoxMesh(size=(1.0, 0.8, 0.7), counts=options.pop("counts", (3, 2, 2)), cell=cell)
    given = {"material": RUBBER, "density": 1.0, "formulation": formulation, "name": "block", **options}
    solid = kind(mesh=mesh, **given)
    pull = vv.Traction(solid=solid, faces="x1", traction=(1.0, 2.0, 0.0))
    return [solid, vv.Fixed(solid=solid, nodes="x0"), pull]


def strain(system: vv.System) -> None:
    """Start with the nodes of solids beside their places."""
    for body in system.components:
        if isinstance(body, vv.Solid):
            X, components = body.points, np.arange(body.dimension)
            first = np.asarray(body.node_unknowns(np.arange(len(X))))
            bent = X + X[:, :1] ** 2 * (0.02 + 0.02 * np.sin(np.pi * np.roll(X, 1, axis=1)))
            system.x[first[:, None] + components] = bent[:, components]
    system.invalidate()


def heated(x: float, temperature: Any, **options: Any) -> vv.ThermoelasticSolid:
    mesh = vv.BoxMesh(size=(0.5, 0.4, 0.3), counts=(2, 2, 1), origin=(x, 0, 0))
    return vv.ThermoelasticSolid(
        mesh=mesh, material=RUBBER, density=1.0, heat=HEAT, temperature=temperature, **options
    )


def tied_heat() -> list[Any]:
    """Hot on cold."""
    cold, hot = heated(0.0, 300.0, name="cold"), heated(0.5, 330.0, name="hot", formulation="mixed")
    faces: Any = {"first": cold, "first_faces": "x1", "second": hot, "second_faces": "x0"}
    return [cold, hot, vv.Tie(**faces), vv.HeatTie(**faces), vv.Fixed(solid=cold, nodes="x0")]


def cell(**options: Any) -> list[Any]:
    """A cell with a hole at its corner, in the plane, that is sheared."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell="tri6").build()
    away = np.abs((mesh.centres + 0.5) % 1 - 0.5).max(axis=1)
    mesh = vv.Mesh(points=mesh.points, cells={"tri6": mesh.cells["tri6"][away > 0.25]}).without_orphans()
    for k, axis in enumerate("xy"):
        for end in (0.0, 1.0):
            mesh = mesh.with_faces(f"{axis}{end:.0f}", lambda X, k=k, p=end: np.abs(X[:, k] - p) < 1e-9)
    body = vv.Solid(mesh=mesh, material=SOFT, density=1.0, formulation="mixed", name="cell")
    middle = [int(np.argmin(np.abs(body.points[:, :2] - 0.5).sum(axis=1)))]
    strain = ((0.1, 0.2, 0.0), (0.0, -0.05, 0.0), (0.0, 0.0, 0.0))
    sides = vv.PeriodicFaces(solid=body, pairs=SIDES, strain=strain, times="t")
    return [body, sides, vv.Fixed(solid=body, nodes=middle), vv.Gravity(acceleration=(0, -1, 0))]


def smooth() -> list[Any]:
    """A cell on splines that go on beyond its sides, sheared and pulled within."""
    mesh = vv.SplineBox(size=(1.0, 0.9), counts=(4, 4), degree=2)
    body = vv.SplineSolid(mesh=mesh, material=RUBBER, density=1.0, periodic=SIDES, name="smooth")
    sides = vv.PeriodicFaces(
        solid=body, pairs=SIDES, strain=((0.1, 0.2, 0), (0, -0.05, 0), (0, 0, 0)), times="t"
    )
    ground = vv.Ground()
    return [body, ground, vv.Spherical(a=ground, b=body, at=(0, 0, 0)), sides]


def slotted() -> list[Any]:
    """A block with a slot like a wedge that closes in part, by multipliers and with friction, and is sheared."""
    along = along_slot(8)
    mesh = slotted_block(8, 0.0, np.outer(along, [0, 0.03]))
    solid = vv.Solid(mesh=mesh, material=RUBBER, density=1.0, name="slotted")
    contact = vv.Contact(first=solid, first_faces="slot", friction=0.3)
    y = mesh.points[:, 1]
    top = vv.Prescribed(solid=solid, nodes=np.flatnonzero(y > 1 - 1e-9), motion=("0.2*t", "-0.1*t", None))
    return [solid, contact, top, vv.Fixed(solid=solid, nodes=np.flatnonzero(y < 1e-9))]


def sheet() -> list[Any]:
    """A sheet with heat, in plane stress."""
    body = vv.ThermoelasticSolid(
        mesh=vv.RectangleMesh(size=(1, 0.8), counts=(4, 3)),
        material=vv.NeoHooke(lame_lambda=20.0, shear=10.0),
        density=1.0,
        heat=HEAT,
        temperature=lambda X: 310 + 20 * X[:, 1],
        plane="stress",
        thickness=0.2,
        velocity=(0.5, 0.2, 0.0),
        angular_velocity=(0.0, 0.0, 2.0),
        name="sheet",
    )
    return [body, vv.PrescribedTemperature(body=body, nodes="x0", value="310 + 10*t")]


def squeezed() -> list[Any]:
    """Free strains that are hindered: damage jumps before the first step, more in the middle."""
    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        density=1e-3,
        toughness=0.1,
        length=1.0,
        free_strain=-0.1,
        name="squeezed",
    )
    held = vv.Fixed(solid=body, nodes="x0"), vv.Fixed(solid=body, nodes="x1")
    return [body, *held]


def sudden() -> list[Any]:
    """Water in a cavity whose lid moves at once, pressed by pairs of equal order."""
    mesh = vv.RectangleMesh(size=(1.0, 1.0), counts=(6, 6))
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.05, name="water")
    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=(1.0, 0.0, 0.0))
    return [water, lid, *(vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0"))]


DYNAMICS, STATICS = vv.EnergyMomentum(), vv.Static()
CASES: dict[str, tuple[Callable[[], list[Any]], vv.Scheme]] = {
    "strained, mixed and damped": (lambda: block("mixed", "tet10", stiffness_damping=0.01), vv.BDF2()),
    "strained, enhanced and damped": (lambda: block("enhanced", stiffness_damping=0.01), DYNAMICS),
    "strained, volume pairs": (
        lambda: block("mixed", material=SOFT),
        vv.GeneralizedAlpha(0.8),
    ),
    "heat that jumps at a tie": (tied_heat, DYNAMICS),
    "heat that jumps at a tie, generalised alpha": (tied_heat, vv.GeneralizedAlpha(0.8)),
    "periodic pressures": (cell, STATICS),
    "periodic splines": (smooth, STATICS),
    "a slot": (slotted, STATICS),
    "a sheet": (sheet, DYNAMICS),
    "damage that jumps": (squeezed, DYNAMICS),
    "a lid that moves at once": (sudden, vv.GeneralizedAlpha(0.5)),
}
