"""Solids: cells, formulations, materials, what acts on them, and joints."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from solid_parts import FRAMED, REST, TIED, block, coupled, loaded, pinned, tied, wavy

import visviva as vv
from catalogue.entry import ALL, ENERGY, FALLING, IN_PLANE, LINEAR, MOMENTA, NOTHING, Components, Entry
from catalogue.rigid import pull, swing

Array = NDArray[np.float64]

X = (1.0, 0.0, 0.0)
PLANE = ("spherical", "revolute", "revolute, angle", "rigid", "point on line", "distance")
SLIDING = ("planar", "prismatic", "prismatic, stroke", "cylindrical", "screw", "point on line")


def flying(cell: str, counts: Sequence[int] = (2, 2, 2), **options: Any) -> Components:
    """A solid of distorted cells that tumbles freely and swings."""
    flat = cell[0] in "tq" and cell[1:4] in ("ri3", "ri6", "uad")
    shape: Any = vv.RectangleMesh if flat else vv.BoxMesh
    d = 2 if flat else 3
    mesh = shape(size=(4.0, 3.2, 2.4)[:d], counts=tuple(counts[:d]), cell=cell).build()
    X = mesh.points + 0.16 * np.sin(1.2 * mesh.points[:, ::-1] + 1.0)
    more: Any = {"material": vv.NeoHooke(young=100.0, poisson=0.3), "density": 1.0} | options
    turning = (0.0, 0.0, 1.0) if flat else (0.3, 0.6, 1.0)

    def velocity(x: Array) -> Array:
        swing = np.sin(0.8 * x) * ([1, 1, 0] if flat else 1)
        return np.asarray(swing + ([0.3, -0.2, 0.0] if flat else [0.3, -0.2, 0.1]))

    return [vv.Solid(mesh=vv.Mesh(X, mesh.cells), velocity=velocity, angular_velocity=turning, **more)]


def flying_splines(dimension: int, degree: int = 2, **options: Any) -> Components:
    """A solid on splines that tumbles freely and swings."""
    counts = (2, 2, 1) if degree == 2 else (2, 1, 1)
    box = vv.SplineBox(size=(4.0, 3.2, 2.4)[:dimension], counts=counts[:dimension], degree=degree)
    turning = (0.0, 0.0, 3.0) if dimension == 2 else (0.9, 1.8, 3.0)
    more: Any = {"angular_velocity": turning, "velocity": (0.3, -0.2, 0.0)} | options
    return [vv.SplineSolid(mesh=box, material=vv.NeoHooke(young=100.0, poisson=0.3), density=1.0, **more)]


def rod(start: float = 0.0, length: float = 4.0, **options: Any) -> vv.Solid:
    """A soft bar along x that turns about y, thick enough for the shaking of the test of tangents."""
    mesh = vv.BoxMesh(size=(length, 1.6, 1.6), counts=(2, 1, 1), origin=(start, -0.8, -0.8))
    more: Any = {"material": vv.NeoHooke(young=200.0, poisson=0.3), "density": 0.3} | options
    return vv.Solid(mesh=mesh, velocity=lambda X: np.cross((0.3, -1.0, 0.2), X), **more)


def soft_pendulum() -> Components:
    """Two soft bars on hinges, hanging from the ground."""
    one, two, ground = rod(), rod(4.0), vv.Ground()
    ends = [vv.RigidCoupling(solid=one, faces="x0"), vv.RigidCoupling(solid=one, faces="x1")]
    last = vv.DistributedCoupling(solid=two, faces="x0")
    hinges = [
        vv.Revolute(a=ground, b=ends[0], at=(0, 0, 0), axis=(0, 1, 0)),
        vv.Revolute(a=ends[1], b=last, at=(4, 0, 0), axis=(0, 1, 0)),
    ]
    return [ground, one, two, *ends, last, *hinges, vv.Gravity()]


def soft_slider_crank() -> Components:
    """A rigid crank of length 1.5, a soft connecting rod, a rigid slider on the ground; the crank turns."""
    ground = vv.Ground()
    crank = vv.RigidBody(
        mass=0.5,
        inertia=(0.1, 0.2, 0.2),
        position=(0.75, 0, 0),
        velocity=(0, 0, -1.5),
        angular_velocity=(0, 2, 0),
    )
    link = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1.6, 1.6), counts=(2, 1, 1), origin=(1.5, -0.8, -0.8)),
        material=vv.NeoHooke(young=200.0, poisson=0.3),
        density=0.3,
        velocity=lambda X: np.outer((5.5 - X[:, 0]) / 4, (0, 0, -3.0)),
    )
    slider = vv.RigidBody(mass=0.4, inertia=(0.1, 0.1, 0.1), position=(5.5, 0, 0))
    near, far = (vv.RigidCoupling(solid=link, faces=side) for side in ("x0", "x1"))
    joints = [
        vv.Revolute(a=ground, b=crank, at=(0, 0, 0), axis=(0, 1, 0)),
        vv.Revolute(a=crank, b=near, at=(1.5, 0, 0), axis=(0, 1, 0)),
        vv.Spherical(a=far, b=slider, at=(5.5, 0, 0)),
        vv.Prismatic(a=ground, b=slider, at=(5.5, 0, 0), axis=(1, 0, 0)),
    ]
    return [ground, crank, link, near, far, slider, *joints]


def rubber(C: Array) -> Array:
    """A user's neo-Hooke energy."""
    det = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
    log_j = 0.5 * np.log(det + C[5] * (C[3] * C[4] - C[1] * C[5]))
    return np.asarray(19.0 * (C[0] + C[1] + C[2] - 3 - 2 * log_j) + 30 * log_j * log_j)


FIBRES = ((1, 0.5, 0.2), (1, -0.5, 0))
MATERIALS = {
    "Saint Venant-Kirchhoff": vv.SaintVenantKirchhoff(young=100.0, poisson=0.3),
    "split neo-Hooke": vv.NeoHooke(young=100.0, poisson=0.3, isochoric=True, volumetric="simo"),
    "Mooney-Rivlin": vv.MooneyRivlin(c10=10.0, c01=5.0, bulk=50.0),
    "split Mooney-Rivlin": vv.MooneyRivlin(c10=10.0, c01=5.0, bulk=50.0, isochoric=True),
    "Yeoh": vv.Yeoh(c1=10.0, c2=2.0, c3=1.0, bulk=100.0),
    "Gent": vv.Gent(shear=20.0, limit=30.0, bulk=80.0),
    "Ogden": vv.Ogden(mu=(10.0, -4.0), alpha=(2.0, -1.5), bulk=60.0),
    "Holzapfel-Gasser-Ogden": vv.HolzapfelGasserOgden(
        shear=10.0, k1=5.0, k2=1.2, bulk=80.0, fibres=FIBRES, dispersion=0.1
    ),
    "Blatz-Ko": vv.BlatzKo(young=100.0, poisson=0.3),
    "Hencky": vv.Hencky(young=100.0, poisson=0.3),
}
HOOKE = vv.LinearElastic(young=100.0, poisson=0.3)

HEATED: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("bricks", "hex8", {}),
    ("plane stress", "quad4", {"plane": "stress"}),
    ("enhanced", "hex8", {"formulation": "enhanced"}),
    ("fibres", "tet10", {"material": MATERIALS["Holzapfel-Gasser-Ogden"]}),
    ("F-bar", "quad4", {"formulation": "F-bar"}),
)

USERS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("plane stress", "quad4", {"plane": "stress"}),
    ("F-bar", "quad4", {"formulation": "F-bar"}),
    ("mixed", "tri6", {"formulation": "mixed"}),
)


def heat(X: Array) -> Array:
    """A thermal strain of place."""
    return np.asarray(0.1 + 0.05 * np.sin(X[:, 0] + X[:, 1]))


INCOMPRESSIBLE: Any = {"formulation": "mixed", "material": vv.NeoHooke(shear=10.0, poisson=0.5)}

SOLIDS = [
    Entry("splines in the plane", lambda: flying_splines(2, plane="stress"), ALL, steps=50),
    Entry("splines in space", lambda: flying_splines(3, velocity=np.sin), ALL, steps=30),
    Entry("cubic splines in space", lambda: flying_splines(3, 3, velocity=np.sin), ALL, steps=20),
    Entry("quartic splines in space", lambda: flying_splines(3, 4, velocity=np.sin), ALL, steps=10),
    Entry("solid, plane stress", lambda: flying("quad4", plane="stress"), ALL, steps=100),
    Entry("solid, F-bar", lambda: flying("hex8", (2, 1, 1), formulation="F-bar"), ALL, steps=50),
    Entry("solid, F-bar in the plane", lambda: flying("quad4", formulation="F-bar"), ALL, steps=100),
    Entry("solid, enhanced", lambda: flying("hex8", (2, 1, 1), formulation="enhanced"), ALL, steps=50),
    Entry("solid, enhanced in the plane", lambda: flying("quad4", formulation="enhanced"), ALL, steps=100),
    Entry("solid, mean dilatation", lambda: flying("hex8", (2, 1, 1), formulation="mixed"), ALL, steps=50),
    Entry("solid, mixed", lambda: flying("hex27", (1, 1, 1), formulation="mixed"), ALL, steps=25),
    Entry("solid, incompressible", lambda: flying("quad9", (1, 1), **INCOMPRESSIBLE), ALL, steps=50),
    Entry("solid, Taylor and Hood", lambda: flying("tet10", (1, 1, 1), formulation="mixed"), ALL, steps=25),
    Entry("solid, equal order", lambda: flying("tri3", (3, 2), formulation="mixed"), ALL, steps=100),
    # solids and what acts on them
    *(
        Entry(f"solid, {c}", partial(loaded, cell=c), ALL, steps=60)
        for c in ("hex8", "tet10", "wedge6", "quad4")
    ),
    Entry("solid, gravity", lambda: [block(), vv.Gravity()], FALLING, steps=60),
    Entry("solid, mass damping", lambda: loaded(mass_damping=0.4), NOTHING, steps=60),
    Entry(
        "solid, enhanced and damped",
        lambda: flying("quad4", formulation="enhanced", stiffness_damping=0.02),
        MOMENTA,
        steps=100,
    ),
    Entry("solid, stiffness damping", lambda: loaded(stiffness_damping=0.02), MOMENTA, steps=60),
    Entry(
        "solid, body force",
        lambda: loaded(lambda b: vv.BodyForce(solid=b, force=(0, 0, 2))),
        LINEAR - {"momentum_z"},
        steps=60,
    ),
    Entry(
        "solid, body force of place",
        lambda: loaded(lambda b: vv.BodyForce(solid=b, force=wavy)),
        frozenset({"momentum_z"}),
        steps=60,
    ),
    Entry(
        "solid, traction",
        lambda: loaded(lambda b: vv.Traction(solid=b, faces="x1", traction=(2, 0, 0), times=pull)),
        LINEAR - {"momentum_x"},
        steps=60,
    ),
    Entry(
        "solid, traction of place",
        lambda: loaded(lambda b: vv.Traction(solid=b, faces="all", traction=wavy)),
        frozenset({"momentum_z"}),
        steps=60,
    ),
    Entry(
        "solid, dead pressure",
        lambda: loaded(lambda b: vv.Pressure(solid=b, faces="z1", pressure=1.5, follower=False)),
        LINEAR - {"momentum_z"},
        steps=60,
    ),
    Entry(
        "solid, pressure",
        lambda: loaded(lambda b: vv.Pressure(solid=b, faces="z1", pressure=pull)),
        NOTHING,
        steps=60,
    ),
    Entry(
        "solid, pressure all around",
        lambda: loaded(lambda b: vv.Pressure(solid=b, faces="all", pressure=pull)),
        MOMENTA,
        steps=60,
    ),
    Entry(
        "plate, pressure all around",
        lambda: loaded(lambda b: vv.Pressure(solid=b, faces="all", pressure=pull), cell="quad4"),
        MOMENTA,
        steps=60,
    ),
    Entry(
        "ring, pressure",
        lambda: loaded(
            lambda b: vv.Pressure(solid=b, faces="all", pressure=pull),
            cell="quad4",
            at=0.5,
            plane="axisymmetric",
            **REST,
        ),
        NOTHING,
        steps=60,
    ),
    Entry(
        "solid, foundation",
        lambda: loaded(lambda b: vv.ElasticFoundation(solid=b, faces="z0", normal=30.0, tangential=12.0)),
        ENERGY,
        steps=60,
    ),
    Entry(
        "solid, damped foundation",
        lambda: loaded(lambda b: vv.ElasticFoundation(solid=b, faces="z0", normal=30.0, damping=0.7)),
        NOTHING,
        steps=60,
    ),
    Entry(
        "solid, force on a node",
        lambda: loaded(lambda b: vv.Force(on=b, at=(1, 0.7, 0.5), force=(0, 1, 0))),
        LINEAR - {"momentum_y"},
        steps=60,
    ),
    Entry(
        "solid, force inside",
        lambda: loaded(lambda b: vv.Force(on=b, at=(0.3, 0.2, 0.1), force=(0, 1, 0), times=pull)),
        LINEAR - {"momentum_y"},
        steps=60,
    ),
    Entry("solid, fixed", lambda: loaded(lambda b: vv.Fixed(solid=b, nodes="x0")), ENERGY, steps=60),
    Entry(
        "solid, prescribed",
        lambda: loaded(lambda b: vv.Prescribed(solid=b, nodes="x0", motion=(swing, None, "0.1*t"))),
        frozenset({"momentum_y"}),
        steps=60,
    ),
    Entry(
        "solid, prescribed by place",
        lambda: loaded(lambda b: vv.Prescribed(solid=b, nodes="x0", motion=wavy)),
        NOTHING,
        steps=60,
    ),
    Entry(
        "solid, symmetry",
        lambda: loaded(
            lambda b: vv.SymmetryPlane(solid=b, nodes="x0", normal=(1, 0, 0)),
            velocity=(0, 0.2, 0.1),
            angular_velocity=(0.7, 0, 0),
        ),
        ENERGY | {"momentum_y", "momentum_z", "angular_x"},
        steps=60,
    ),
    Entry(
        "solid, oblique symmetry",
        lambda: loaded(lambda b: vv.SymmetryPlane(solid=b, nodes="x0", normal=(1, 1, 0))),
        ENERGY | {"momentum_z"},
        steps=60,
    ),
    # joints on solids
    *(Entry(f"solid and body, {n}", partial(coupled, j), ALL, steps=60) for n, j in FRAMED.items()),
    *(Entry(f"two solids, {n}", partial(coupled, j, "solid"), ALL, steps=60) for n, j in FRAMED.items()),
    *(Entry(f"two plates, {n}", partial(coupled, FRAMED[n], "solid", "quad4"), ALL, steps=60) for n in PLANE),
    *(
        Entry(f"plates, {n} along x", partial(coupled, FRAMED[n], "solid", "quad4", axis=X), ALL, steps=60)
        for n in SLIDING
    ),
    *(
        Entry(f"plate and body, {n}", partial(coupled, FRAMED[n], "body", "quad4"), IN_PLANE, steps=60)
        for n in ("spherical", "revolute")
    ),
    Entry("solid, spherical inside", lambda: pinned(vv.Spherical), ALL, steps=60),
    Entry("solid, distance inside", lambda: pinned(vv.Distance), ALL, steps=60),
    *(Entry(f"tied {c}, {m}", partial(tied, c, m), ALL, steps=60) for c, m in TIED),
    # solids alone: cells and materials
    *(
        Entry(f"solid, {c}", partial(flying, c, (1, 1, 1)), ALL, steps=50)
        for c in ("tet4", "hex20", "hex27", "tri3", "tri6", "quad8", "quad9")
    ),
    *(
        Entry(f"solid, {name}", partial(flying, "hex8", (1, 1, 1), material=m), ALL, steps=50)
        for name, m in MATERIALS.items()
    ),
    Entry(
        "solid, user's energy",
        lambda: flying("hex8", (1, 1, 1), material=vv.UserMaterial(function=rubber)),
        ALL,
        steps=50,
        analytic=False,
    ),
    *(
        Entry(
            f"solid, user's energy, {name}",
            partial(flying, cell, (1, 1, 1), material=vv.UserMaterial(function=rubber), **more),
            ALL,
            steps=25,
            analytic=False,
        )
        for name, cell, more in USERS
    ),
    Entry(
        "solid, Blatz-Ko with pressures",
        lambda: flying("hex8", (1, 1, 1), material=MATERIALS["Blatz-Ko"], formulation="mixed"),
        ALL,
        steps=50,
    ),
    *(
        Entry(
            f"solid, heated, {name}",
            partial(flying, cell, (1, 1, 1), thermal_strain=heat, **more),
            ALL,
            steps=50,
        )
        for name, cell, more in HEATED
    ),
    Entry("solid, Hooke", lambda: flying("hex8", (1, 1, 1), material=HOOKE), ENERGY | LINEAR, steps=50),
    Entry("solid, lumped", lambda: flying("hex8", (1, 1, 1), lumped=True), ALL, steps=50),
    # mechanisms of solid and rigid parts
    Entry("soft pendulum", soft_pendulum, ENERGY, steps=50),
    Entry("soft slider-crank", soft_slider_crank, ENERGY, steps=50),
]
