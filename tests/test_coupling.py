"""Attachment of joints and loads to solids: points, frames on faces, reactions, against other formulations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from solid_parts import FRAMED, coupled

import visviva as vv

Array = NDArray[np.float64]

SIZE = (2.0, 0.5, 0.4)
COUPLINGS = [vv.RigidCoupling, vv.DistributedCoupling]
EXACT = vv.Newton(tolerance=1e-15)


def beam(cell: str = "hex8", **options: Any) -> vv.Solid:
    given = {"material": vv.SaintVenantKirchhoff(young=200.0, poisson=0.3), "density": 1.0} | options
    return vv.Solid(mesh=vv.BoxMesh(size=SIZE, counts=(4, 1, 1), cell=cell), **given)


# --- points ---------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cell", ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6"])
def test_a_point_goes_with_a_homogeneous_deformation(cell: str) -> None:
    solid, X = beam(cell), np.array([0.73, 0.21, 0.17])
    system = vv.System([solid])
    F, shift = np.eye(3) + 0.2 * np.random.default_rng(2).standard_normal((3, 3)), np.array([1.0, 2.0, -0.5])
    system.x[:] = (solid.points @ F.T + shift).ravel()
    assert system.value(solid.point(X).position) == pytest.approx(F @ X + shift, rel=1e-13)


def test_a_point_on_a_node_is_that_node() -> None:
    solid = beam("tet10")
    vv.System([solid])
    for k in (0, 7, 11):
        forms = list(solid.point(solid.points[k]).position)
        first = int(solid.node_unknowns(k))
        assert [form.weights for form in forms] == [((first + c, 1.0),) for c in range(3)]


def test_a_point_outside_is_refused_with_the_nearest_node() -> None:
    solid = beam()
    with pytest.raises(
        vv.InputError, match=r"Solid.*\[2.5, 0.2, 0.2\] lies in none of its elements; the nearest node"
    ):
        vv.System([solid, vv.Force(on=solid, at=(2.5, 0.2, 0.2), force=(1, 0, 0))])


# --- frames on faces ------------------------------------------------------------------------------------------
def test_a_rigid_coupling_keeps_its_face_rigid_and_its_frame_on_it() -> None:
    solid = beam(angular_velocity=(0.3, 0.5, 1.0))
    end = vv.RigidCoupling(solid=solid, faces="x1")
    system = vv.System([solid, end, vv.Force(on=end, force=(0, 3, 5))], EXACT)
    vv.simulate(system, until=0.4, step=0.02)
    nodes = solid.nodes("x1")
    X, x = solid.points[nodes], solid.positions(system.x)[nodes]
    distance = [np.linalg.norm(p[:, None] - p[None], axis=2) for p in (X, x)]
    assert np.abs(distance[0] - distance[1]).max() < 1e-12
    assert np.abs(solid.displacements(system.x)).max() > 0.1
    for k in range(len(nodes)):
        assert system.value(end.point_at(X[k]).position) == pytest.approx(x[k], abs=1e-12)


def test_a_distributed_coupling_follows_the_polar_rotation_and_the_mean() -> None:
    """Against numpy's singular values of the mean deformation of the face's nodes."""
    solid = beam(angular_velocity=(0.3, 0.5, 1.0))
    end = vv.DistributedCoupling(solid=solid, faces="x1")
    system = vv.System([solid, end, vv.Force(on=end, at=(2, 0.5, 0.4), force=(0, 3, 5))], EXACT)
    vv.simulate(system, until=0.4, step=0.02)
    nodes = solid.nodes("x1")
    X, x = solid.points[nodes], solid.positions(system.x)[nodes]  # a rectangle's corners have equal shares
    M = (x - x.mean(axis=0)).T @ (X - X.mean(axis=0))
    u, s, vt = np.linalg.svd(M)
    assert s[2] < 1e-9  # the face is flat: its normal is the cross product of two
    R = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    frame = end.frame()
    directors = np.array([system.value(d) for d in frame.directors])
    assert directors == pytest.approx(R.T, abs=1e-10)
    assert system.value(end.point().position) == pytest.approx(x.mean(axis=0), abs=1e-12)
    assert np.abs(R - np.eye(3)).max() > 0.1


def test_force_on_a_distributed_coupling_is_a_uniform_traction() -> None:
    moved = []
    for cell in ("hex8", "tet10"):
        for distributed in (True, False):
            solid = beam(cell)
            parts: list[Any] = [solid, vv.Fixed(solid=solid, nodes="x0")]
            if distributed:
                end = vv.DistributedCoupling(solid=solid, faces="x1")
                parts += [end, vv.Force(on=end, force=(2.0, 0.1, 0), times="t")]
            else:
                t = np.array([2.0, 0.1, 0]) / (SIZE[1] * SIZE[2])
                parts += [vv.Traction(solid=solid, faces="x1", traction=t, times="t")]
            system = vv.System(parts)
            vv.quasi_static(system, until=1.0, step=0.5)
            moved.append(solid.displacements(system.x))
        assert np.abs(moved[-1]).max() > 0.05
        assert np.abs(moved[-1] - moved[-2]).max() < 1e-9


@pytest.mark.parametrize("kind", COUPLINGS)
def test_torque_on_a_frame_reaches_the_support(kind: Any) -> None:
    solid = beam()
    end = kind(solid=solid, faces="x1")
    torque = np.array([0.3, 0.1, -0.2])
    held = vv.Fixed(solid=solid, nodes="x0")
    system = vv.System([solid, held, end, vv.Torque(on=end, torque=torque, times="t")])
    vv.quasi_static(system, until=1.0, step=0.5)
    assert vv.SupportTorque(solid=solid, nodes="x0")(system) == pytest.approx(-torque, rel=1e-8)
    assert np.abs(vv.SupportForce(solid=solid, nodes="x0")(system)).max() < 1e-9


@pytest.mark.parametrize("kind", COUPLINGS)
def test_frames_start_with_the_rates_of_their_nodes(kind: Any) -> None:
    solid = beam(velocity=(1.0, 2.0, 3.0), angular_velocity=(0.5, -1.0, 2.0))
    end = kind(solid=solid, faces="x1")
    system = vv.System([solid, end])
    report = system.check()
    assert report.velocities.before < 1e-12
    X = np.array([2.0, 0.25, 0.2])
    expected = np.array([1, 2, 3]) + np.cross((0.5, -1.0, 2.0), X - np.array(SIZE) / 2)
    assert end.point().position.rate(system.v) == pytest.approx(expected, rel=1e-12)


# --- reactions ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", COUPLINGS)
def test_reaction_of_a_weld_is_what_the_loads_ask_for(kind: Any) -> None:
    """A console welded to the ground: force and moment of its weight and tip load, with arms as deformed."""
    solid = beam()
    end, ground = kind(solid=solid, faces="x0"), vv.Ground()
    weld = vv.Rigid(a=ground, b=end, at=(0, 0.25, 0.2))
    tip = vv.Force(on=solid, at=(2, 0.25, 0.2), force=(0, 0.2, -0.3), times="t")
    system = vv.System([solid, end, ground, weld, tip])
    vv.quasi_static(system, until=1.0, step=0.5)
    force, torque = vv.reaction(system, weld)
    arm = system.value(solid.point((2, 0.25, 0.2)).position) - (0, 0.25, 0.2)
    assert force == pytest.approx([0, -0.2, 0.3], abs=1e-9)
    assert torque == pytest.approx(-np.cross(arm, (0, 0.2, -0.3)), abs=1e-9)
    assert vv.ReactionForce(joint=weld)(system) == pytest.approx(force)
    assert vv.ReactionTorque(joint=weld)(system) == pytest.approx(torque)


def test_reaction_of_a_point_inside_an_element() -> None:
    solid, ground = beam(), vv.Ground()
    hold = [vv.Spherical(a=ground.point(X), b=solid.point(X)) for X in ((0.3, 0.2, 0.2), (1.7, 0.2, 0.2))]
    line = vv.PointOnPlane(
        a=ground.frame((1.0, 0.1, 0.2), ((1, 0, 0), (0, 0, -1), (0, 1, 0))), b=solid.point((1.0, 0.1, 0.3))
    )
    load = vv.Force(on=solid, at=(1.1, 0.2, 0.2), force=(0, 0.3, -0.6), times="t")
    system = vv.System([solid, ground, *hold, line, load])
    vv.quasi_static(system, until=1.0, step=0.5)
    forces = [vv.reaction(system, joint)[0] for joint in (*hold, line)]
    assert np.sum(forces, axis=0) == pytest.approx([0, -0.3, 0.6], abs=1e-9)
    places = [system.value(j.sides[1].p) for j in (*hold, line)]
    moments = sum(np.cross(x, f) for x, f in zip(places, forces, strict=True))
    at = system.value(solid.point((1.1, 0.2, 0.2)).position)
    assert moments == pytest.approx(-np.cross(at, (0, 0.3, -0.6)), abs=1e-9)


@pytest.mark.parametrize("other", ["body", "solid"])
@pytest.mark.parametrize("name", FRAMED)
def test_reaction_changes_the_momentum_of_the_partner(name: str, other: str) -> None:
    """Over a step of the energy-momentum rule: ``h f`` is the change of linear momentum of what hangs on b."""
    parts = coupled(FRAMED[name], other)
    partner, joint, h = parts[2], parts[-1], 0.01
    system = vv.System(parts, EXACT)
    mass = {c: system.model.index(c) for c in (parts[0], partner)}
    vv.simulate(system, until=5 * h, step=h, project=True)
    before, x0 = system.core.momentum.reshape(-1, 6).copy(), system.x.copy()
    system.step(h)
    change = system.core.momentum.reshape(-1, 6) - before
    middle = np.where(system.order > 0, (x0 + system.x) / 2, system.x)  # where the step's forces act
    force, _ = joint.partners[1].wrench(system, joint.generalised_reaction(middle), np.zeros(3))
    assert np.abs(force).max() > 1e-3
    assert h * force == pytest.approx(change[mass[partner], :3], abs=1e-11)
    assert -h * force == pytest.approx(change[mass[parts[0]], :3], abs=1e-11)
    assert vv.reaction(system, joint)[0] == pytest.approx(force, rel=0.1, abs=0.01)


# --- planes ---------------------------------------------------------------------------------------------------
def test_joints_of_plates_have_no_constraints_across_the_plane() -> None:
    """Each of these leaves one freedom or none to two coupled plates; without 0 = 0, none is redundant."""
    for name, n in (("spherical", 2), ("revolute", 2), ("rigid", 3)):
        system = vv.System(coupled(FRAMED[name], "solid", "quad4"))
        joint = system.components[-1]
        assert system.field(joint, "reaction").size == n
        assert system.check().redundant == []


def test_joints_that_hold_nothing_in_the_plane_are_refused() -> None:
    with pytest.raises(vv.InputError, match=r"Planar.*holds nothing.*stay in their planes"):
        vv.System(coupled(vv.Planar, "solid", "quad4"))


def test_plates_of_different_planes_are_not_joined() -> None:
    plates = [
        vv.Solid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
            material=vv.NeoHooke(young=1, poisson=0.3),
            density=1,
        )
        for _ in range(2)
    ]
    ends = [vv.RigidCoupling(solid=p, faces="x1") for p in plates]
    pin = vv.Spherical(a=ends[0].point((0, 0, 0.5)), b=ends[1].point())
    with pytest.raises(vv.InputError, match=r"Spherical.*cannot join.*same z"):
        vv.System([*plates, *ends, pin])


def test_a_motor_turns_a_plate_by_its_edge() -> None:
    """Quasi-static: the plate turns as a whole, its hinge by the motor's angle, free of stress."""
    mesh = vv.RectangleMesh(size=(1.0, 0.5), counts=(2, 1))
    plate = vv.Solid(mesh=mesh, material=vv.SaintVenantKirchhoff(young=100.0, poisson=0.3), density=1.0)
    end, ground = vv.RigidCoupling(solid=plate, faces="x0"), vv.Ground()
    hinge = vv.Revolute(a=ground, b=end, at=(0, 0.25, 0), axis=(0, 0, 1), angle=True)
    system = vv.System([plate, end, ground, hinge, vv.Motor(joint=hinge, motion="0.5*t")])
    vv.quasi_static(system, until=1.0, step=0.25)
    c, s = np.cos(0.5), np.sin(0.5)
    turned = (plate.points - (0, 0.25, 0)) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + (0, 0.25, 0)
    assert plate.positions(system.x) == pytest.approx(turned, abs=1e-9)


# --- bad input ------------------------------------------------------------------------------------------------
def test_frames_need_faces_with_an_extent() -> None:
    solid = beam()
    with pytest.raises(vv.InputError, match=r"RigidCoupling.*'x9'.*'x0'|RigidCoupling.*did you mean"):
        vv.RigidCoupling(solid=solid, faces="x9")
    ring = vv.Solid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        material=vv.NeoHooke(young=1, poisson=0.3),
        plane="axisymmetric",
    )
    with pytest.raises(vv.InputError, match=r"axisymmetric.*attach a point"):
        vv.RigidCoupling(solid=ring, faces="x1")


def test_joints_need_frames_not_solids() -> None:
    solid = beam()
    with pytest.raises(vv.InputError, match=r"Solid.*RigidCoupling"):
        vv.System([solid, ground := vv.Ground(), vv.Revolute(a=ground, b=solid, at=(0, 0, 0))])
