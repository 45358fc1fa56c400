"""Nothing depends on where the observer stands: turned and shifted systems move turned and shifted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from catalogue.entry import Components
from catalogue.rigid import body, pair, turned
from catalogue.solids import MATERIALS, flying
from instances.solid import Brick
from numpy.typing import NDArray
from point_contacts import SHAPES, on_shape

import visviva as vv

Array = NDArray[np.float64]

R = turned(7)
SHIFT = np.array([0.4, -1.1, 0.7])


def pendulum(rotation: Array, shift: Array) -> Components:
    """Two bodies on a hinge with angle, spring and damper, on a ball joint to the ground, with gravity."""

    def placed(seed: int, position: Array) -> vv.RigidBody:
        b = body(seed)
        return vv.RigidBody(
            mass=b.mass,
            inertia=b.inertia,
            centre=b.centre,
            position=rotation @ position + shift,
            rotation=rotation @ b.rotation,
            velocity=rotation @ np.cross(b.angular_velocity, position),
            angular_velocity=rotation @ b.angular_velocity,
        )

    ground, one, two = vv.Ground(), placed(1, np.array([0.5, 0, 0])), placed(1, np.array([1.5, 0, 0]))
    hang = vv.Spherical(a=ground, b=one, at=shift)
    place, axis, first = rotation @ [1.0, 0, 0] + shift, rotation @ [0.1, 1.0, 0], rotation @ [1.0, 0, 0]
    hinge = vv.Revolute(a=one, b=two, at=place, axis=axis, first=first)
    on = [vv.JointSpring(joint=hinge, stiffness=3.0), vv.JointDamper(joint=hinge, damping=0.2)]
    spring = vv.Spring(a=ground.point(rotation @ [2.0, 1.0, 1.0] + shift), b=two.point(), stiffness=5.0)
    gravity = vv.Gravity(acceleration=rotation @ [0, 0, -9.81])
    return [ground, one, two, hang, hinge, *on, spring, gravity]


def positions(components: Components, steps: int, scheme: vv.Scheme) -> Array:
    """Origins of the bodies and the hinge's angle after some steps."""
    system = vv.System(components, vv.Newton(tolerance=1e-14))
    vv.simulate(system, until=steps * 0.02, step=0.02, scheme=scheme)
    bodies = [c for c in components if isinstance(c, vv.RigidBody)]
    return np.array([system.value(b.point().position) for b in bodies])


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.GeneralizedAlpha(0.8)], ids=str)
def test_motion_is_objective(scheme: vv.Scheme) -> None:
    here = positions(pendulum(np.eye(3), np.zeros(3)), 50, scheme)
    there = positions(pendulum(R, SHIFT), 50, scheme)
    assert np.abs(here @ R.T + SHIFT - there).max() < 1e-11


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.GeneralizedAlpha(0.8)], ids=str)
@pytest.mark.parametrize("name", MATERIALS)
def test_solids_move_alike_for_all_observers(name: str, scheme: vv.Scheme) -> None:
    """A tumbling brick, and the same seen by a turned and shifted observer; fibres are turned with it."""

    def places(rotation: Array, shift: Array) -> Array:
        X = vv.BoxMesh(size=(4, 3, 2.4), counts=(1, 1, 1)).build()
        mesh = vv.Mesh(X.points @ rotation.T + shift, X.cells)

        def velocity(x: Array) -> Array:
            back = (x - shift) @ rotation
            return (np.sin(back[:, ::-1]) + np.cross((0.3, 0.6, 1.0), back)) @ rotation.T

        material: Any = MATERIALS[name]
        if name == "Holzapfel-Gasser-Ogden":
            material = replace(material, fibres=tuple(rotation @ a for a in material.fibres))
        solid = vv.Solid(mesh=mesh, material=material, density=1.0, velocity=velocity)
        system = vv.System([solid], vv.Newton(tolerance=1e-14))
        vv.simulate(system, until=1.0, step=0.02, scheme=scheme)
        return solid.positions(system.x)

    here, there = places(np.eye(3), np.zeros(3)), places(R, SHIFT)
    assert np.abs(here @ R.T + SHIFT - there).max() < 1e-11


@pytest.mark.parametrize(
    ("formulation", "cell"),
    [
        ("displacement", "tet10"),
        ("displacement", "hex20"),
        ("displacement", "wedge6"),
        ("F-bar", "hex8"),
        ("enhanced", "hex8"),
        ("mixed", "hex8"),
        ("mixed", "hex20"),
        ("mixed", "tet10"),
        ("mixed", "tet4"),
    ],
)
def test_formulations_move_alike_for_all_observers(formulation: Any, cell: str) -> None:
    """A block of distorted cells that swings and is damped, and the same for a turned and shifted observer."""

    def places(rotation: Array, shift: Array) -> Array:
        mesh = vv.BoxMesh(size=(4, 3, 2.4), counts=(1, 1, 1), cell=cell).build()
        X = mesh.points + 0.1 * np.sin(mesh.points[:, ::-1])
        solid = vv.Solid(
            mesh=vv.Mesh(X @ rotation.T + shift, mesh.cells),
            material=vv.MooneyRivlin(c10=10.0, c01=5.0, bulk=200.0, isochoric=True),
            density=1.0,
            formulation=formulation,
            stiffness_damping=0.01,
            velocity=lambda x: np.sin((x - shift) @ rotation[:, ::-1]) @ rotation.T,
            angular_velocity=rotation @ (0.3, 0.6, 1.0),
        )
        system = vv.System([solid], vv.Newton(tolerance=1e-14))
        vv.simulate(system, until=0.6, step=0.02)
        return solid.positions(system.x)

    here, there = places(np.eye(3), np.zeros(3)), places(R, SHIFT)
    assert np.abs(here @ R.T + SHIFT - there).max() < 1e-11


@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("name", SHAPES)
def test_exact_shapes_are_touched_alike_for_all_observers(name: str, enforcement: str) -> None:
    """A brick on a shape that a free body carries, and the same turned."""

    def places(rotation: Array) -> Array:
        parts = on_shape(name, rotation, enforcement=enforcement)
        system, touched = vv.System(parts, vv.Newton(tolerance=1e-14)), 0.0
        for _ in vv.march(system, until=0.07, step=0.01):
            touched = max(touched, parts[-1].pressures.max())
        assert touched > 0
        return np.vstack([parts[0].positions(system.x), system.value(parts[1].point().position)])

    assert np.abs(places(np.eye(3)) @ R.T - places(R)).max() < 1e-10


def energy(system: vv.System) -> float:
    system.evaluate_ledger()
    return float(system.core.energy.sum())


@pytest.mark.parametrize("turns_along", [True, False])
@pytest.mark.parametrize("on_rubber", [True, False])
def test_balls_rub_alike_for_all_observers(on_rubber: bool, turns_along: bool) -> None:
    """What the search finds near depends on boxes along the axes; where a ball's own axes lie says nothing either."""
    ends = []
    for rotation in (np.eye(3), R):
        corner = vv.BoxMesh(size=(0.4, 0.4, 0.2), counts=(2, 2, 1), origin=(0, 0, -0.2)).build()
        mesh = replace(corner, points=corner.points @ rotation.T)
        rubber = vv.NeoHooke(young=1e5, poisson=0.3)
        block = vv.Solid(mesh=mesh, material=rubber, density=1000.0)
        ball = vv.RigidBody(
            shape=vv.Sphere(radius=0.05),
            density=1000.0,
            position=rotation @ [0.17, 0.13, 0.06],
            velocity=rotation @ [0.3, 0, -1.0],
            angular_velocity=rotation @ [1.0, 3.0, 2.0],
            rotation=rotation if turns_along else np.eye(3),
        )
        plane = vv.Plane(at=(0, 0, 0), normal=rotation @ [0, 0, 1.0])
        second = {"second": block, "second_faces": "z1"} if on_rubber else {"second": plane}
        contact = vv.Contact(first=ball, friction=0.3, stiffness=1e4, **second)
        parts = [block, vv.Fixed(solid=block, nodes="z0")] if on_rubber else [plane]
        system = vv.System([ball, *parts, contact])
        vv.simulate(system, until=0.06, step=0.004)
        ends.append(ball.point().position.value(system.x) @ rotation)
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)


@pytest.mark.parametrize(
    "build",
    [
        lambda: [Brick(speed=0.0)],
        lambda: flying("hex8", (1, 1, 1)),
        lambda: flying("tet10", (1, 1, 1), material=MATERIALS["Ogden"]),
        lambda: pair(vv.Revolute, lambda j: vv.JointSpring(joint=j, stiffness=9.0)),
        lambda: [
            a := body(1),
            b := body(2),
            vv.Spring(a=a.point(), b=b.point((0.1, 0.9, 0)), stiffness=30.0),
        ],
    ],
    ids=["brick", "solid", "solid of Ogden's rubber", "torsion spring", "spring"],
)
def test_energy_is_frame_indifferent(build: Callable[[], Components]) -> None:
    """Rigid motions of a deformed state cost nothing."""
    system = vv.System(build())
    vectors = system.order == 2
    angles = [f for f in system.model.fields if f.name in ("angle", "stroke")]
    for f in angles:
        vectors[f.start : f.start + f.size] = False
    rng = np.random.default_rng(3)
    x, v = system.x, system.v
    x[vectors] += 0.1 * rng.standard_normal(int(vectors.sum()))
    for f in angles:
        x[f.start] += 0.3
    v[:] = 0.0
    system.invalidate()
    before = energy(system)
    x[vectors] = (x[vectors].reshape(-1, 3) @ R.T).ravel()
    system.invalidate()
    assert before > 0
    assert energy(system) == pytest.approx(before, rel=1e-13)


def test_constraints_are_frame_indifferent() -> None:
    """A rigid motion of two free bodies with a joint violates no constraint."""
    for joint in (vv.Spherical, vv.Revolute, vv.Prismatic, vv.Cylindrical, vv.Planar, vv.Universal, vv.Rigid):
        system = vv.System(pair(joint), vv.Newton(tolerance=1e-14))
        vv.simulate(system, until=0.2, step=0.02, project=True)
        vectors = system.order == 2
        x = system.x[vectors].reshape(-1, 3) @ R.T
        position = np.zeros(len(x), dtype=bool)
        position[[0, 4]] = True
        system.x[vectors] = (x + np.where(position[:, None], SHIFT, 0.0)).ravel()
        system.invalidate()
        system.evaluate_ledger()
        assert system.core.defect[::2].max() < 1e-14, joint.__name__
