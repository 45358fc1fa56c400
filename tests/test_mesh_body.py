"""Loads, supports, contact, couplings, probes and pictures serve bodies on meshes that are no solids."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from instances.net import Net

import visviva as vv
from visviva.results.drawing import Drawing

BOX = vv.BoxMesh(size=(1, 1, 2), counts=(1, 1, 2))
MASS = 2.0


def net(**options: Any) -> Net:
    return Net(mesh=BOX, **options)


def test_it_hangs_from_its_support() -> None:
    """Which carries its weight, and the loads on its faces and its volume; the weight stretches it."""
    body = net()
    pull = vv.Traction(solid=body, faces="z0", traction=(0, 0, -3))
    force = vv.BodyForce(solid=body, force=(0.5, 0, 0))
    parts = [vv.Fixed(solid=body, nodes="z1"), pull, force, vv.Gravity()]
    system = vv.System([body, *parts])
    vv.quasi_static(system, until=1.0, step=1.0)
    held = vv.SupportForce(solid=body)(system)
    assert held == pytest.approx((-0.5 * 2, 0, 9.81 * MASS + 3), rel=1e-9)
    assert vv.Volume(solid=body)(system) > 2.01
    greatest = vv.Extreme(solid=body, field="mean_stretch")(system)
    assert 1.001 < vv.FieldAt(solid=body, field="mean_stretch", at=(0.5, 0.5, 1.0))(system) < greatest
    top = vv.FieldAt(solid=body, field="mean_stretch", at=(0.5, 0.5, 2.0))(system)
    assert top == pytest.approx(greatest, abs=1e-12)  # which carries more than the cell below
    assert body.mean("mean_stretch", system.x).max() == greatest
    with pytest.raises(vv.InputError, match="there is no field 'mean'; did you mean 'mean_stretch'"):
        vv.Extreme(solid=body, field="mean")


def test_it_turns_in_a_hinge() -> None:
    """On a frame that holds one of its faces, and keeps energy and its momentum along the axis."""
    body, ground = net(angular_velocity=(0, 1, 0)), vv.Ground()
    frame = vv.RigidCoupling(solid=body, faces="z1")
    hinge = vv.Revolute(a=ground, b=frame, at=(0.5, 0.5, 2), axis=(0, 1, 0))
    system = vv.System([body, ground, frame, hinge])
    system.check()
    result = vv.simulate(system, until=0.5, step=0.01)
    result.assert_conserved("energy", tolerance=1e-9)
    assert np.abs(body.displacements(system.x)).max() > 0.1


@pytest.mark.parametrize("options", [{"enforcement": "penalty"}, {"impact": "conserving"}], ids=str)
def test_it_bounces(options: dict[str, Any]) -> None:
    """Off a plane, with a stiffness that follows from its own."""
    body, floor = net(velocity=(0, 0, -1)), vv.Plane(at=(0, 0, -0.05))
    contact = vv.Contact(first=body, second=floor, **options)
    system = vv.System([body, floor, contact])
    result = vv.simulate(system, until=0.3, step=0.01)
    result.assert_conserved("energy", tolerance=1e-9)
    assert (body.nodal_mass @ body.velocities(system.x, system.v))[2] > -0.9 * MASS


def test_it_gives_way_where_it_overlaps() -> None:
    """Two of a mass share the way, and springs are free of stress in their new places."""
    upper = Net(mesh=vv.BoxMesh(size=(1, 1, 2), counts=(1, 1, 2), origin=(0, 0, 1.98)))
    lower = net()
    contact = vv.Contact(
        first=upper,
        second=lower,
        first_faces="z0",
        second_faces="z1",
        initial="resolve",
        enforcement="penalty",
    )
    system = vv.System([contact, upper, lower])
    assert contact.moved == pytest.approx(0.01, abs=1e-10)
    assert lower.points[lower.nodes("z1"), 2] == pytest.approx(1.99, abs=1e-10)
    assert lower.at_points("mean_stretch", system.x) == pytest.approx(1.0, abs=1e-15)


def test_its_picture_moves() -> None:
    body = net(velocity=(1, 0, 0))
    system = vv.System([body])
    vv.simulate(system, until=0.1, step=0.05)
    drawing = Drawing(system, fields=("mean_stretch",))
    assert drawing.points(system.x)[0] == pytest.approx(body.points + np.array([0.1, 0, 0]), abs=1e-12)
    shown = drawing.values(system.x, system.v)
    assert shown["mean_stretch"] == pytest.approx(1.0, abs=1e-12)
    assert shown["velocity"] == pytest.approx(np.tile((1.0, 0, 0), (12, 1)), abs=1e-12)


def straight_beam() -> vv.Beam:
    section = vv.GivenSection(stiffness=(200, 180, 300, 5, 4, 3), mass=1.0, moments=(0.03, 0.02, 0.0))
    return vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2), section=section)


def flat_shell() -> vv.Shell:
    section = vv.HomogeneousSection(thickness=0.1, young=1e4, density=2.0)
    return vv.Shell(mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)), section=section)


@pytest.mark.parametrize("make", [straight_beam, flat_shell])
def test_nodes_of_bodies_with_directors_are_not_moved_to_fit(make: Any) -> None:
    body = make()
    system = vv.System([body])
    with pytest.raises(vv.InputError, match=rf"{body.label}: its nodes cannot be moved .* let its mesh fit"):
        body.move_reference(system.model, np.array([0]), np.ones((1, 3)))


@pytest.mark.parametrize("make", [straight_beam, flat_shell])
def test_what_is_thin_says_so(make: Any) -> None:
    body, block = make(), vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0)
    assert body.is_thin
    assert not block.is_thin
    with pytest.raises(vv.InputError, match=rf"{body.label} has no surface about its thickness"):
        vv.BodyForce(solid=body, force=(0, 0, 1))
