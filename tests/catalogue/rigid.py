"""Rigid bodies: joints, forces, and what users write."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visviva as vv
from catalogue.entry import ALL, ANGULAR, AXIAL, ENERGY, FALLING, LINEAR, MOMENTA, NOTHING, Components, Entry
from visviva.component.component import Component

Array = NDArray[np.float64]

ORIGIN, Z = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)


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


def drag(t: float, x: Array, v: Array) -> Array:
    return -0.3 * v * np.linalg.norm(v) + np.sin(t) * x


def swing(t: float) -> float:
    return 0.4 * float(np.sin(3 * t))


def pull(t: float) -> float:
    return 2.0 + float(np.cos(5 * t))


RIGID = [
    Entry("free body", lambda: [body()], ALL),
    Entry("falling body", lambda: [body(), vv.Gravity()], FALLING),
    Entry(
        "body in a rotating frame",
        lambda: [body(), vv.RotatingFrame(angular_velocity=(0.3, -0.2, 0.5))],
        ENERGY,
    ),
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
]
