"""The list of what can be composed: one line each, and every property test runs over all of them.

To add something, add a line: a name, what builds its components afresh, and what a run of it conserves:
'energy' if no load, motor or damper does work, and columns of the ledger such as 'momentum_x', 'angular_z'.
The balance of energy is checked for every entry, whatever it contains.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from contact_parts import PYRAMID, bricks, plates, rigid_on_brick
from flow_parts import enclosed, stream, torus
from immersed_parts import large
from instances.heat import Bar
from instances.immersed import ImmersedSolid
from instances.solid import Brick
from instances.stokes import StokesCell
from numpy.typing import NDArray
from point_contacts import SHAPES, blocks, on_shape
from rubbing import thrown
from solid_parts import FRAMED, REST, TIED, block, coupled, loaded, pinned, tied, wavy

import visviva as vv
from visviva.component import Component

Array = NDArray[np.float64]
Components = list[Component]

ORIGIN, X, Z = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Entry:
    """A line of the catalogue.

    Attributes
    ----------
    h : float
        A coarse step for it.
    steps : int
        How many of them the conservation test takes.
    analytic : bool
        Whether its tangents are free of differences.
    """

    name: str
    build: Callable[[], Components]
    conserves: frozenset[str]
    h: float = 0.02
    steps: int = 300
    analytic: bool = True

    def system(self, **options: Any) -> vv.System:
        """A fresh system in its initial state, which a run first projects onto the constraints."""
        return vv.System(self.build(), vv.Newton(**options))


# --- parts --------------------------------------------------------------------------------------------------
def turned(seed: int) -> Array:
    """A random rotation (3, 3)."""
    Q, R = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    Q = Q * np.sign(np.diag(R))
    return Q * np.linalg.det(Q)


def body(seed: int = 1, position: Sequence[float] = (0.3, -0.2, 0.4)) -> vv.RigidBody:
    """A body with off-centre mass, full inertia tensor, generic orientation and velocities."""
    rng, R = np.random.default_rng(seed), turned(seed + 100)
    return vv.RigidBody(
        mass=rng.uniform(1, 2),
        inertia=R @ np.diag([0.5, 0.7, 0.9]) @ R.T,
        centre=0.3 * rng.standard_normal(3),
        position=position,
        rotation=turned(seed),
        velocity=rng.standard_normal(3),
        angular_velocity=1.5 * rng.standard_normal(3),
    )


def ball(position: Sequence[float] = (1.0, 0.3, -0.2)) -> vv.PointMass:
    return vv.PointMass(mass=0.8, position=position, velocity=(0.3, -0.7, 0.5))


def pair(joint: Callable[..., Component], *more: Callable[[Any], Component], **options: Any) -> Components:
    """Two free bodies, a joint between them, and what acts on the joint."""
    a, b = body(1), body(2, (-0.4, 0.5, 0.1))
    return linked(joint, a, b, *more, at=(0.2, 0.3, -0.1), axis=(0.3, -0.5, 0.8), **options)


def hung(joint: Callable[..., Component], *more: Callable[[Any], Component], **options: Any) -> Components:
    """A body on the ground by a joint at the origin along the third axis, and what acts on the joint."""
    return linked(joint, vv.Ground(), body(3), *more, at=ORIGIN, axis=Z, **options)


def with_ball(joint: Callable[..., Component], **options: Any) -> Components:
    """A free body and a point mass."""
    return linked(joint, body(1), ball(), at=(1.0, 0.3, -0.2), **options)


def linked(
    joint: Callable[..., Component],
    a: Component,
    b: Component,
    *more: Callable[[Any], Component],
    **options: Any,
) -> Components:
    link = joint(a=a, b=b, **options)
    return [a, b, link, *(make(link) for make in more)]


def ends(joint: Callable[..., Component], a: Any, b: Any, **options: Any) -> Components:
    """Something between two points of two components."""
    return linked(lambda a, b, **o: joint(a=a.point(), b=b.point(), **o), a, b, **options)


def housing(second: type[vv.Revolute] | type[vv.Prismatic]) -> tuple[Components, Any, Any]:
    """Three free bodies: a housing with one that turns and one that turns or slides."""
    a, b, c = body(1), body(2, (0.9, 0.1, 0.2)), body(3, (-0.5, 0.4, 0.3))
    one = vv.Revolute(a=a, b=b, at=(0.5, 0.1, 0.1), axis=(0.2, 0.1, 1.0), angle=True)
    two = second(a=a, b=c, at=(-0.3, 0.2, 0.3), axis=(1.0, 0.2, -0.3))
    return [a, b, c, one, two], one, two


def gears() -> Components:
    parts, one, two = housing(vv.Revolute)
    return [*parts, vv.Gear(a=one, b=two, ratio=1.7)]


def rack() -> Components:
    parts, one, two = housing(vv.Prismatic)
    return [*parts, vv.RackAndPinion(a=one, b=two, radius=0.4)]


def winch() -> Components:
    """A drum in a free frame with a load on its rope."""
    frame, drum, load = body(1), body(2, (0.1, 0.1, 0.2)), ball((0.1, 0.1, -0.9))
    axle = vv.Revolute(a=frame, b=drum, at=(0.1, 0.1, 0.2), axis=(0.0, 1.0, 0.1))
    rope = vv.RopeOverWinch(a=drum.point(), b=load.point(), winch=axle, radius=0.3, length=1.1)
    return [frame, drum, load, axle, rope]


def chain(n: int) -> Components:
    """Bodies on ball joints and hinges in turn, hanging from the ground."""
    parts: list[Any] = [vv.Ground()]
    for k in range(n):
        joint = vv.Spherical if k % 2 else vv.Revolute
        link = body(k + 1, (k + 0.5, 0.1 * k, 0.0))
        parts += [
            link,
            joint(a=parts[0] if k == 0 else parts[-2], b=link, at=(k, 0.1 * k, 0.0), axis=(0.1, 1.0, 0.2)),
        ]
    return [*parts, vv.Gravity()]


def between(make: Callable[[vv.SquaredDistance], Component]) -> Components:
    """A body and a point mass with something on the squared distance of 1 between them."""
    b, p = body(1, ORIGIN), ball((0.6, 0.0, -0.8))
    return [b, p, make(vv.SquaredDistance(a=b, b=p))]


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
}
HOOKE = vv.LinearElastic(young=100.0, poisson=0.3)


def drag(t: float, x: Array, v: Array) -> Array:
    return -0.3 * v * np.linalg.norm(v) + np.sin(t) * x


def swing(t: float) -> float:
    return 0.4 * float(np.sin(3 * t))


def pull(t: float) -> float:
    return 2.0 + float(np.cos(5 * t))


INCOMPRESSIBLE: Any = {"formulation": "mixed", "material": vv.NeoHooke(shear=10.0, poisson=0.5)}

# --- what is conserved --------------------------------------------------------------------------------------
NOTHING: frozenset[str] = frozenset()
ENERGY = frozenset({"energy"})
LINEAR = frozenset({"momentum_x", "momentum_y", "momentum_z"})
ANGULAR = frozenset({"angular_x", "angular_y", "angular_z"})
MOMENTA = LINEAR | ANGULAR
ALL = ENERGY | MOMENTA
AXIAL = frozenset({"angular_z"})
FALLING = ENERGY | {"momentum_x", "momentum_y", "angular_z"}
PLANE_MOMENTA = frozenset({"momentum_x", "momentum_y", "angular_z"})
IN_PLANE = ENERGY | PLANE_MOMENTA
PLANE = ("spherical", "revolute", "revolute, angle", "rigid", "point on line", "distance")
SLIDING = ("planar", "prismatic", "prismatic, stroke", "cylindrical", "screw", "point on line")

CONTACTS: dict[str, Any] = {
    "dissipative": ({}, MOMENTA),
    "conserving": ({"impact": "conserving"}, ALL),
    "penalty": ({"enforcement": "penalty"}, ALL),
}
"""Ways to enforce contact, and what they conserve."""

CATALOGUE = [
    Entry("free body", lambda: [body()], ALL),
    Entry("falling body", lambda: [body(), vv.Gravity()], FALLING),
    Entry("point mass", lambda: [ball(), vv.Gravity()], FALLING),
    # joints between two free bodies
    Entry("spherical", lambda: pair(vv.Spherical), ALL),
    Entry("revolute", lambda: pair(vv.Revolute), ALL),
    Entry("prismatic", lambda: pair(vv.Prismatic), ALL),
    Entry("cylindrical", lambda: pair(vv.Cylindrical), ALL),
    Entry("planar", lambda: pair(vv.Planar), ALL),
    Entry("screw", lambda: pair(vv.Screw, pitch=0.7), ALL),
    Entry("universal", lambda: pair(vv.Universal), ALL),
    Entry("rigid", lambda: pair(vv.Rigid), ALL),
    Entry("point on line", lambda: pair(vv.PointOnLine), ALL),
    Entry("point on plane", lambda: pair(vv.PointOnPlane), ALL),
    Entry("distance", lambda: ends(vv.Distance, body(1), body(2, (1.0, 0.5, 0.1))), ALL),
    Entry("gear", gears, ALL),
    Entry("rack and pinion", rack, ALL),
    Entry("rope over winch", winch, ALL),
    # joints with coordinates
    Entry("revolute, angle", lambda: pair(vv.Revolute, angle=True), ALL),
    Entry("prismatic, stroke", lambda: pair(vv.Prismatic, stroke=True), ALL),
    Entry("cylindrical, both", lambda: pair(vv.Cylindrical, angle=True, stroke=True), ALL),
    Entry("planar, angle", lambda: pair(vv.Planar, angle=True), ALL),
    Entry("point on line, stroke", lambda: pair(vv.PointOnLine, stroke=True), ALL),
    # joints to the ground
    Entry("ground, spherical", lambda: hung(vv.Spherical), ENERGY | ANGULAR),
    Entry("ground, revolute", lambda: hung(vv.Revolute, angle=True), ENERGY | AXIAL),
    Entry("ground, prismatic", lambda: hung(vv.Prismatic, stroke=True), ENERGY | {"momentum_z"}),
    Entry("ground, cylindrical", lambda: hung(vv.Cylindrical), ENERGY | {"momentum_z", "angular_z"}),
    Entry("ground, planar", lambda: hung(vv.Planar), FALLING),
    Entry("ground, screw", lambda: hung(vv.Screw, pitch=0.5), ENERGY),
    Entry("ground, universal", lambda: hung(vv.Universal), ENERGY),
    Entry("ground, point on line", lambda: hung(vv.PointOnLine), ENERGY | {"momentum_z", "angular_z"}),
    Entry("ground, point on plane", lambda: hung(vv.PointOnPlane), FALLING),
    Entry("ground, distance", lambda: ends(vv.Distance, vv.Ground(), body(3)), ENERGY | ANGULAR),
    # joints between a body and a point mass
    Entry("body and point mass, spherical", lambda: with_ball(vv.Spherical), ALL),
    Entry("body and point mass, line", lambda: with_ball(vv.PointOnLine, stroke=True), ALL),
    Entry("body and point mass, plane", lambda: with_ball(vv.PointOnPlane), ALL),
    Entry("body and point mass, distance", lambda: ends(vv.Distance, body(1), ball()), ALL),
    Entry("two point masses, distance", lambda: ends(vv.Distance, ball(), ball((0.1, 0.9, 0.4))), ALL),
    # mechanisms
    Entry("heavy top", lambda: [*hung(vv.Spherical), vv.Gravity()], ENERGY | AXIAL),
    Entry("chain", lambda: chain(4), ENERGY),
    # what acts on coordinates
    Entry("motor on angle", lambda: pair(vv.Revolute, lambda j: vv.Motor(joint=j, motion=swing)), MOMENTA),
    Entry("motor on stroke", lambda: pair(vv.Prismatic, lambda j: vv.Motor(joint=j, motion=swing)), MOMENTA),
    Entry("ground, motor", lambda: hung(vv.Revolute, lambda j: vv.Motor(joint=j, motion=swing)), NOTHING),
    Entry("torque", lambda: pair(vv.Revolute, lambda j: vv.JointForce(joint=j, force=2.0)), MOMENTA),
    Entry("torque of time", lambda: pair(vv.Revolute, lambda j: vv.JointForce(joint=j, force=pull)), MOMENTA),
    Entry("stroke force", lambda: pair(vv.Prismatic, lambda j: vv.JointForce(joint=j, force=2.0)), MOMENTA),
    Entry("torsion spring", lambda: pair(vv.Revolute, lambda j: vv.JointSpring(joint=j, stiffness=9.0)), ALL),
    Entry("stroke spring", lambda: pair(vv.Prismatic, lambda j: vv.JointSpring(joint=j, stiffness=9.0)), ALL),
    Entry(
        "torsion damper", lambda: pair(vv.Revolute, lambda j: vv.JointDamper(joint=j, damping=0.5)), MOMENTA
    ),
    # forces
    Entry("spring", lambda: ends(vv.Spring, body(1), body(2, (1.0, 0.5, 0.1)), stiffness=30.0), ALL),
    Entry(
        "spring to point mass", lambda: ends(vv.Spring, body(1), ball(), stiffness=30.0, free_length=0.5), ALL
    ),
    Entry(
        "spring with damper",
        lambda: ends(vv.Spring, body(1), body(2, (1.0, 0.5, 0.1)), stiffness=30.0, damping=0.6),
        MOMENTA,
    ),
    Entry("damper to ground", lambda: ends(vv.Spring, vv.Ground(), body(3), damping=0.8), ANGULAR),
    Entry("dead force", lambda: [b := body(), vv.Force(on=b, force=(1.0, 0, 0))], LINEAR - {"momentum_x"}),
    Entry(
        "force of time",
        lambda: [b := body(), vv.Force(on=b.point((0.1, 0.2, 0.3)), force=(1, 2, 3), times=pull)],
        NOTHING,
    ),
    Entry("force of state", lambda: [b := body(), vv.Force(on=b, force=drag)], NOTHING, analytic=False),
    Entry(
        "follower force",
        lambda: [b := body(), vv.FollowerForce(on=b, at=(0, 0, 1), force=(1, 2, 3))],
        NOTHING,
    ),
    Entry("torque in space", lambda: [b := body(), vv.Torque(on=b, torque=(0, 0, 2))], LINEAR),
    Entry("follower torque", lambda: [b := body(), vv.FollowerTorque(on=b, torque=(1, 2, 3))], LINEAR),
    Entry(
        "torque pair",
        lambda: [a := body(1), b := body(2), vv.TorquePair(a=a, b=b, torque=(1, 2, 3))],
        MOMENTA,
    ),
    Entry("bushing", lambda: pair(vv.Bushing, stiffness=(9, 8, 7), rotational_stiffness=(3, 4, 5)), ALL),
    Entry(
        "bushing with damping",
        lambda: pair(
            vv.Bushing, stiffness=(9, 8, 7), damping=(0.2, 0.3, 0.4), rotational_damping=(0.1, 0.2, 0.3)
        ),
        MOMENTA,
    ),
    Entry("damper", lambda: ends(vv.Damper, body(1), ball(), damping=0.4), MOMENTA),
    # what users write
    Entry(
        "user potential",
        lambda: between(lambda e: vv.Potential(of=[e], energy=lambda e: -2.0 / e[0] ** 0.5)),
        ALL,
        analytic=False,
    ),
    Entry(
        "user constraint",
        lambda: between(lambda e: vv.Constraint(of=[e], function=lambda e: e[0] ** 1.5 - 1.0)),
        ALL,
        analytic=False,
    ),
    Entry(
        "user force",
        lambda: [
            b := body(),
            vv.GeneralizedForce(
                of=[vv.Position(of=b, direction=(0, 0, 1))], force=lambda t, e, v: -3 * e - v**3
            ),
        ],
        LINEAR - {"momentum_z"},
        analytic=False,
    ),
    # solids
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
    Entry("solid, Hooke", lambda: flying("hex8", (1, 1, 1), material=HOOKE), ENERGY | LINEAR, steps=50),
    Entry("solid, lumped", lambda: flying("hex8", (1, 1, 1), lumped=True), ALL, steps=50),
    # mechanisms of solid and rigid parts
    Entry("soft pendulum", soft_pendulum, ENERGY, steps=50),
    Entry("soft slider-crank", soft_slider_crank, ENERGY, steps=50),
    # contact
    Entry("blocks, vertices and facets", lambda: blocks(enforcement="penalty"), ALL, steps=40),
    Entry("blocks in the plane, vertices and facets", lambda: blocks(flat=True), ALL, steps=40),
    *(
        Entry(f"contact, {name}, {kind}", partial(make, **options), what, h=0.01, steps=30)
        for name, make in {"bricks": bricks, "plates": plates}.items()
        for kind, (options, what) in CONTACTS.items()
    ),
    Entry("contact, tet4", partial(bricks, "tet4", impact="conserving"), ALL, h=0.01, steps=10),
    Entry("contact, quad8", partial(plates, "quad8", enforcement="penalty"), ALL, h=0.01, steps=10),
    Entry(
        "contact, rigid box",
        partial(rigid_on_brick, vv.Box(size=(0.8, 0.7, 0.4)), 0.22, enforcement="penalty"),
        ALL,
        h=0.01,
        steps=15,
    ),
    Entry(
        "contact, rigid triangles",
        partial(rigid_on_brick, vv.SurfaceMesh(**PYRAMID), 0.02, impact="conserving"),
        ALL,
        h=0.01,
        steps=15,
    ),
    *(
        Entry(f"contact, exact {name}, {kind}", partial(on_shape, name, **options), what, h=0.01, steps=30)
        for name in SHAPES
        for kind, (options, what) in CONTACTS.items()
        if kind != "dissipative" or name == "sphere"
    ),
    # friction
    Entry("friction", thrown, MOMENTA, steps=20),
    Entry("friction, elastic", lambda: thrown(tangential="penalty", stiffness=60.0), MOMENTA, steps=20),
    Entry("friction, penalty", lambda: thrown(enforcement="penalty", stiffness=60.0), MOMENTA, steps=20),
    Entry("friction in the plane", lambda: thrown(2), PLANE_MOMENTA, steps=30),
    Entry("friction in the plane, elastic", lambda: thrown(2, tangential="penalty"), PLANE_MOMENTA, 0.01, 40),
    # fluids
    *[
        Entry(f"stream, {cell}", partial(stream, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8", "tet4", "hex27", "tet10")
    ],
    *[
        Entry(f"enclosed flow, {cell}", partial(enclosed, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8")
    ],
    *[
        Entry(f"periodic flow, {cell}", partial(torus, cell), NOTHING, h=0.05, steps=20)
        for cell in ("quad4", "tri3", "quad9", "tri6")
    ],
    # immersed solids
    *[
        Entry(f"immersed, {cell}", partial(large, cell), NOTHING, h=0.02, steps=10)
        for cell in ("quad4", "tri3", "quad9", "tri6", "hex8")
    ],
    Entry("immersed, lighter", lambda: large("quad4", density=0.4), NOTHING, h=0.02, steps=10),
    Entry("immersed, enhanced", lambda: large("quad4", formulation="enhanced"), NOTHING, h=0.02, steps=10),
    # tiny instances of the other fields
    Entry("solid brick", lambda: [Brick()], ALL, steps=100, analytic=False),
    Entry("solid brick, held", lambda: [Brick(fixed=True)], ENERGY, steps=50, analytic=False),
    Entry("heat bar", lambda: [Bar()], NOTHING, analytic=False),
    Entry("stokes cell", lambda: [StokesCell()], NOTHING),
    Entry("immersed solid", lambda: [ImmersedSolid()], ENERGY, steps=50, analytic=False),
]
