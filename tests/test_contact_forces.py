"""Forces of contact as probes tell them: what changes the momentum of the bodies, friction included."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.component.component import Component

G, MU, RADIUS = 9.81, 0.2, 0.1
LYING = ((0, 0, 1), (0, 1, 0), (-1, 0, 0))
SHAPES = {
    "ball": vv.Sphere(radius=RADIUS),
    "capsule": vv.Capsule(radius=RADIUS, length=0.3),
}
FLOORS: dict[str, Any] = {
    "plane": lambda: vv.Plane(),
    "exact box": lambda: vv.RigidBody(shape=vv.Box(size=(4, 4, 1)), mass=3.0, position=(0, 0, -0.5)),
    "face of a box": lambda: vv.RigidBody(shape=vv.Box(size=(4, 4, 1)), mass=3.0, position=(0, 0, -0.5)),
    "solid": lambda: vv.Solid(
        mesh=vv.BoxMesh(size=(4, 4, 1), counts=(2, 2, 1), origin=(-1.9, -1.8, -1)),
        material=vv.NeoHooke(young=1e6, poisson=0.3),
        density=1.0,
    ),
}


def sliding(shape: str, floor: str, **options: Any) -> tuple[vv.System, vv.RigidBody, vv.Contact]:
    """A body that slides and spins on a floor that is free as well, with gravity on the body alone."""
    body = vv.RigidBody(
        shape=SHAPES[shape],
        mass=1.0,
        position=(0, 0, RADIUS),
        rotation=LYING if shape == "capsule" else np.eye(3),
        velocity=(3, 0.5, 0),
        angular_velocity=(0, 0, 2.0),
    )
    ground = FLOORS[floor]()
    faces = {"second_faces": "z1"} if floor == "face of a box" else {}
    contact = vv.Contact(
        first=body,
        second=ground,
        friction=MU,
        stiffness=1e5,
        formulation="node-to-segment",
        **faces,
        **options,
    )
    weight = vv.Force(on=body, force=(0, 0, -G))
    parts: list[Component] = [body, ground, weight, contact]
    return vv.System(parts), body, contact


@pytest.mark.parametrize("options", [{}, {"enforcement": "penalty"}, {"tangential": "penalty"}], ids=str)
@pytest.mark.parametrize("floor", FLOORS)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_force_of_contact_changes_the_momentum(shape: str, floor: str, options: Any) -> None:
    """Of the body, beside gravity, in every step."""
    system, body, contact = sliding(shape, floor, **options)
    probe, rate = vv.ContactForce(contact=contact), body.point().position
    rubbed = 0.0
    for _ in range(20):
        before, h = rate.rate(system.v), 1e-3
        system.step(h, vv.EnergyMomentum())
        force = probe(system)
        change = (rate.rate(system.v) - before) / h + [0, 0, G]
        assert force == pytest.approx(change, abs=1e-6 * max(1.0, np.abs(change).max()))
        rubbed += np.linalg.norm(force[:2])
    assert rubbed > MU * G


def test_a_sliding_ball_is_held_back_by_mu_m_g() -> None:
    ball = vv.RigidBody(shape=SHAPES["ball"], mass=1.0, position=(0, 0, RADIUS), velocity=(3, 0, 0))
    floor = vv.Plane()
    contact = vv.Contact(first=ball, second=floor, friction=MU, stiffness=1e6)
    system = vv.System([ball, floor, contact, vv.Gravity()])
    vv.simulate(system, until=0.01, step=1e-3)
    assert vv.ContactForce(contact=contact)(system) == pytest.approx([-MU * G, 0, G], abs=1e-5)
    assert contact.tractions.sum(axis=0) == pytest.approx([-MU * G, 0, 0], abs=1e-5)
