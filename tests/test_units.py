"""Models do the same in whatever consistent units they are given: nothing in the code is one metre or second."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import visviva as vv


@dataclass(frozen=True)
class Units:
    """How many units there are in a metre, a second and a kilogram."""

    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0

    def __getattr__(self, name: str) -> float:
        L, T, M = self.length, self.time, self.mass
        return {
            "speed": L / T,
            "acceleration": L / T**2,
            "density": M / L**3,
            "force": M * L / T**2,
            "torque": M * L**2 / T**2,
            "inertia": M * L**2,
            "stress": M / (L * T**2),
            "layer": M / (L * T) ** 2,  # stress per length
            "stiffness": M / T**2,
            "damping": M / T,
            "viscosity": M / (L * T),
        }[name]


SI = Units()
OTHERS = {
    "um, s, kg": Units(length=1e6),
    "m, us, kg": Units(time=1e6),
    "km, s, t": Units(length=1e-3, mass=1e-3),
    "mm, ms, g": Units(1e3, 1e3, 1e3),
    "m, h, kg": Units(time=1 / 3600),
    "dm, ns, t": Units(10.0, 1e9, 1e-3),
}
Figures = dict[str, Any]


def ran(
    u: Units, parts: list[Any], until: float, step: float, *, counts: bool = True, **options: Any
) -> Figures:
    """What a run leaves behind, without units."""
    system = vv.System(parts)
    result = vv.simulate(system, until=until * u.time, step=step * u.time, project=True, **options)
    ledger = result.ledger
    energies = ["kinetic", "total", *(f"work_{w}" for w in ledger.works)]
    motion = [
        np.asarray(system.value(c.point().position)) / u.length for c in parts if isinstance(c, vv.RigidBody)
    ]
    for c in parts:
        if isinstance(c, vv.Solid):
            motion.append(c.positions(system.x).ravel() / u.length)
    figures: Figures = {name: ledger[name] / u.torque for name in energies}
    figures["motion"] = np.concatenate(motion) if motion else np.zeros(0)
    if counts:
        figures["steps"] = np.array([result.statistics.steps, result.statistics.rejected], dtype=float)
    return figures


def hinged(u: Units) -> tuple[list[Any], Any]:
    ground = vv.Ground()
    inertia = (u.inertia, 2 * u.inertia, 3 * u.inertia)
    body = vv.RigidBody(mass=1.0 * u.mass, inertia=inertia, position=(u.length, 0, 0))
    joint = vv.Revolute(a=ground, b=body, at=(0, 0, 0), axis=(0, 0, 1))
    return [ground, body, joint], joint


def motor(u: Units, **options: Any) -> Figures:
    parts, joint = hinged(u)
    w = 2 * math.pi / u.time
    drive = vv.Motor(joint=joint, motion=lambda t: 0.3 * math.sin(w * t) + 0.1 * w * t)
    return ran(u, [*parts, drive], 0.5, 0.025, **options)


def drum(u: Units) -> Figures:
    """A driven ball on which a bead slides: its multipliers have to converge by themselves."""
    ground = vv.Ground()
    middle, top = (u.length, 0, 0), (u.length, 0, 0.2 * u.length)
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.2 * u.length), mass=20 * u.mass, position=middle)
    axle = vv.Revolute(a=ground, b=ball, at=middle, axis=(0, 1, 0), angle=True)
    bead = vv.PointMass(mass=u.mass, position=top)
    line = vv.PointOnLine(a=ground, b=bead, at=top, axis=(0, 0, 1))
    contact = vv.Contact(first=bead, second=ball, stiffness=1e4 * u.stiffness, friction=0.35)
    drive = vv.Motor(joint=axle, motion=lambda t: 1 - math.cos(20 * t / u.time))
    push = vv.Force(on=bead, force=(0, 0, -9.81 * u.force))
    return ran(u, [ground, ball, axle, bead, line, contact, drive, push], 0.2, 0.005)


def motor_alpha(u: Units) -> Figures:
    return motor(u, scheme=vv.GeneralizedAlpha())


def motor_variational(u: Units) -> Figures:
    return motor(u, scheme=vv.VariationalMidpoint())


def pendulum(u: Units) -> Figures:
    parts, joint = hinged(u)
    gravity = vv.Gravity(acceleration=(0, -9.81 * u.acceleration, 0))
    damper = vv.JointDamper(joint=joint, damping=0.3 * u.torque * u.time)
    spring = vv.JointSpring(joint=joint, stiffness=2.0 * u.torque)
    return ran(u, [*parts, gravity, damper, spring], 0.5, 0.02)


def oscillator(u: Units) -> Figures:
    ground, body = (
        vv.Ground(),
        vv.RigidBody(mass=u.mass, inertia=(u.inertia,) * 3, position=(1.3 * u.length, 0, 0)),
    )
    spring = vv.Spring(
        a=ground.point(),
        b=body.point((0, 0.1 * u.length, 0)),
        stiffness=40.0 * u.stiffness,
        free_length=u.length,
        damping=0.5 * u.damping,
    )
    return ran(u, [ground, body, spring], 1.0, 0.02, scheme=vv.BDF2())


def bouncing(u: Units, size: float = 1.0) -> Figures:
    """A ball that falls with half a restitution, however small."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=size * u.length),
        density=2330.0 * u.density,
        position=(0, 0, 3 * size * u.length),
        velocity=(0, 0, -100 * size * u.speed),
    )
    floor = vv.Plane()
    contact = vv.Contact(first=ball, second=floor, stiffness=1e3 * u.stiffness, restitution=0.5)
    return ran(u, [ball, floor, contact], 0.04, 0.00095)


def bouncing_small(u: Units) -> Figures:
    return bouncing(u, 1e-5)


def blocks(u: Units, **options: Any) -> Figures:
    """A soft block slides on another one."""
    rubber = vv.NeoHooke(young=1e4 * u.stress, poisson=0.3)
    L = u.length
    lower = vv.Solid(
        mesh=vv.BoxMesh(size=(2 * L, 2 * L, L), counts=(2, 2, 1)), material=rubber, density=10.0 * u.density
    )
    mesh = vv.BoxMesh(size=(L, L, L), counts=(2, 2, 1)).build().moved((0.31 * L, 0.52 * L, 1.013 * L))
    velocity = (0.5 * u.speed, 0, -1.0 * u.speed)
    upper = vv.Solid(mesh=mesh, material=rubber, density=10.0 * u.density, velocity=velocity)
    held = vv.Fixed(solid=lower, nodes="z0")
    faces = {"first_faces": "z0", "second_faces": "z1"}
    contact = vv.Contact(first=upper, second=lower, **faces, **options)
    return ran(u, [lower, upper, held, contact], 0.06, 0.004)


def mortar(u: Units) -> Figures:
    return blocks(u, friction=0.3)


def node_to_segment(u: Units) -> Figures:
    return blocks(u, formulation="node-to-segment", enforcement="penalty")


def thrown(u: Units) -> Figures:
    """A rigid box onto an obstacle, corners first: edges on edges are not seen."""
    L = u.length
    box = vv.RigidBody(
        shape=vv.Box(size=(L, L, L)),
        density=10 * u.density,
        position=(0.3 * L, 0.1 * L, 1.3 * L),
        velocity=(0, 0, -3 * u.speed),
        angular_velocity=(0.5 / u.time, 1.0 / u.time, 0),
    )
    table = vv.Obstacle(shape=vv.Box(size=(2 * L, 2 * L, 0.5 * L)))
    contact = vv.Contact(
        first=box,
        second=table,
        enforcement="penalty",
        stiffness=1e4 * u.stiffness,
        formulation="node-to-segment",
    )
    return ran(u, [box, table, contact], 0.3, 0.005)


def cantilever(u: Units) -> Figures:
    steel = vv.NeoHooke(young=1e5 * u.stress, poisson=0.3)
    L = u.length
    beam = vv.Solid(
        mesh=vv.BoxMesh(size=(L, 0.2 * L, 0.2 * L), counts=(4, 1, 1)), material=steel, density=10 * u.density
    )
    gravity = vv.Gravity(acceleration=(0, 0, -9.81 * u.acceleration))
    return ran(u, [beam, vv.Fixed(solid=beam, nodes="x0"), gravity], 0.1, 0.01)


def shaken(u: Units) -> Figures:
    rubber = vv.NeoHooke(young=1e3 * u.stress, poisson=0.3)
    L, w = u.length, 2 * math.pi / u.time
    mesh = vv.BoxMesh(size=(L, 0.2 * L, 0.2 * L), counts=(4, 1, 1))
    rod = vv.Solid(mesh=mesh, material=rubber, density=1.0 * u.density)
    way = vv.Prescribed(
        solid=rod,
        nodes="x0",
        motion=lambda t, X: np.outer(np.ones(len(X)), [0.05 * L * math.sin(w * t), 0, 0]),
    )
    return ran(u, [rod, way], 0.25, 0.01, scheme=vv.GeneralizedAlpha())


def cavity(u: Units) -> Figures:
    L, w = u.length, 2 * math.pi / u.time
    mesh = vv.RectangleMesh(size=(L, L), counts=(3, 3), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1.0 * u.density, viscosity=0.1 * u.viscosity)

    def velocity(t: float, X: Any) -> Any:
        return np.outer(np.ones(len(X)), [u.speed * math.sin(w * t), 0, 0])

    lid = vv.VelocityBoundary(fluid=water, faces="y1", velocity=velocity)
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    found = ran(u, [water, lid, *walls], 0.25, 0.0125, scheme=vv.BDF2())
    return {k: v * u.length if v.ndim == 1 and k not in ("motion", "steps") else v for k, v in found.items()}


def immersed(u: Units) -> Figures:
    L = u.length
    mesh = vv.RectangleMesh(size=(L, L), counts=(6, 6), cell="quad9")

    def swirl(X: Any) -> Any:
        x, y = np.pi * X[:, 0] / L, np.pi * X[:, 1] / L
        v = np.stack([np.sin(x) ** 2 * np.sin(2 * y), -np.sin(2 * x) * np.sin(y) ** 2, 0 * x], axis=1)
        return v * u.speed

    water = vv.Fluid(mesh=mesh, density=u.density, viscosity=0.01 * u.viscosity, velocity=swirl)
    patch = vv.RectangleMesh(size=(0.3 * L, 0.2 * L), counts=(3, 2), origin=(0.5 * L, 0.43 * L))
    soft = vv.Solid(
        mesh=patch, material=vv.NeoHooke(young=20.0 * u.stress, poisson=0.3), density=1.5 * u.density
    )
    parts = [water, vv.NoSlip(fluid=water, faces="all"), soft, vv.Immersed(solid=soft, fluid=water)]
    found = ran(u, parts, 0.05, 0.01)
    return {k: v * u.length if k not in ("motion", "steps") else v for k, v in found.items()}


def bent(u: Units) -> Figures:
    """Statics in load steps, with gravity and a block that contact alone holds from below."""
    rubber = vv.NeoHooke(young=1e4 * u.stress, poisson=0.3)
    L = u.length
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(L, L, L), counts=(2, 2, 2)), material=rubber, density=10.0 * u.density
    )
    floor = vv.Plane()
    sides = [
        vv.SymmetryPlane(solid=block, nodes="x0", normal=(1, 0, 0)),
        vv.SymmetryPlane(solid=block, nodes="y0", normal=(0, 1, 0)),
    ]
    push = vv.Prescribed(solid=block, nodes="z1", motion=(None, None, f"-{0.1 * L!r}*t"))
    contact = vv.Contact(first=block, first_faces="z0", second=floor)
    system = vv.System([block, floor, *sides, push, contact])
    result = vv.quasi_static(system, until=1.0, step=0.25)
    return {
        "motion": block.positions(system.x).ravel() / L,
        "pressures": contact.pressures / (1e4 * u.stress),
        "work": result.ledger["work_prescribed motion"] / u.torque,
    }


def vibrating(u: Units) -> Figures:
    steel = vv.NeoHooke(young=1e5 * u.stress, poisson=0.3)
    L = u.length
    beam = vv.Solid(
        mesh=vv.BoxMesh(size=(L, 0.2 * L, 0.1 * L), counts=(4, 1, 1)), material=steel, density=10 * u.density
    )
    system = vv.System([beam, vv.Fixed(solid=beam, nodes="x0")])
    return {"frequencies": vv.modes(system, 6).frequencies * u.time}


def swinging(u: Units) -> Figures:
    parts, _ = hinged(u)
    L = u.length
    spring = vv.Spring(
        a=parts[0].point((L, -L, 0)), b=parts[1].point(), stiffness=10 * u.stiffness, free_length=0.9 * L
    )
    system = vv.System([*parts, spring])
    return {"frequencies": vv.modes(system, 1, tolerance=1.0).frequencies * u.time}


MODELS: list[Callable[[Units], Figures]] = [
    motor,
    motor_alpha,
    motor_variational,
    drum,
    pendulum,
    oscillator,
    bouncing,
    bouncing_small,
    mortar,
    node_to_segment,
    thrown,
    cantilever,
    shaken,
    cavity,
    immersed,
    bent,
    vibrating,
    swinging,
]
"""Roughly one of each kind."""
ALIKE = 3e-9


def misfit(ours: Any, theirs: Any) -> float:
    size = float(np.abs(theirs).max(initial=0.0)) or 1.0
    return float(np.abs(np.asarray(ours) - theirs).max(initial=0.0)) / size


@pytest.fixture(scope="module")
def in_metres() -> dict[str, Figures]:
    return {}


@pytest.mark.parametrize("units", OTHERS)
@pytest.mark.parametrize("model", MODELS)
def test_models_do_the_same_in_all_units(
    model: Callable[[Units], Figures],
    units: str,
    in_metres: dict[str, Figures],
) -> None:
    name = model.__name__
    if name not in in_metres:
        in_metres[name] = model(SI)
    found = model(OTHERS[units])
    for what, theirs in in_metres[name].items():
        assert misfit(found[what], theirs) < ALIKE, what


@pytest.mark.parametrize("units", OTHERS)
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e4])
def test_tangents_of_healthy_bodies_agree_with_differences_at_any_size(units: str, size: float) -> None:
    u = OTHERS[units]
    L = size * u.length
    rubber = vv.NeoHooke(young=1e6 * u.stress, poisson=0.3)
    mesh = vv.BoxMesh(size=(L, L, L), counts=(2, 1, 1))
    solid = vv.Solid(mesh=mesh, material=rubber, density=1e3 * u.density)
    parts, joint = hinged(u)
    spring = vv.JointSpring(joint=joint, stiffness=2.0 * u.torque)
    for system in (vv.System([solid, vv.Fixed(solid=solid, nodes="z0")]), vv.System([*parts, spring])):
        report = system.check()
        assert report.tangent is not None
        assert report.tangent.error < 1e-6
