"""Probes of motion and flow against closed forms, graded meshes, and forces by expressions of place and time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.scene import read_scene
from visviva.scene.writing import write_scene


def spun_up(step: float) -> tuple[vv.Result, vv.Revolute, vv.JointForce]:
    """A wheel on a hinge that a torque speeds up."""
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1.0, 1.0, 2.0))
    hinge = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    drive = vv.JointForce(joint=hinge, force=6.0, name="drive")
    system = vv.System([ground, wheel, hinge, drive], units="SI")
    spin, rate, power = vv.AngularVelocity(of=wheel), vv.JointRate(joint=hinge), vv.Power(of=drive)
    record = {"spin": spin, "rate": rate, "power": power}
    return vv.simulate(system, until=1.0, step=step, record=record), hinge, drive


def test_angular_velocity_and_rates() -> None:
    """omega = M t / I to the second order of the step; the power is M omega, and its sum the work in the ledger."""
    errors = []
    for step in (0.02, 0.01):
        result, hinge, drive = spun_up(step)
        t = result.recorded_times
        spin, power = result.history("spin")[:, 2], 6 * 3 * (t[1:] + t[:-1]) / 2
        errors.append([np.abs(result.history("rate") - 3 * t).max(), np.abs(spin - 3 * t).max()])
        np.testing.assert_allclose(result.history("power")[1:], power, rtol=step**2)
    np.testing.assert_allclose(np.divide(*errors), 4.0, rtol=0.05)
    assert np.max(errors) < 0.01
    assert result.history("power")[1:].sum() * step == pytest.approx(result.ledger.last("work_joint force"))
    assert result.column_units()["rate"] == "rad/s"
    assert result.column_units()["power"] == "W"
    np.testing.assert_allclose(result.history(vv.JointRate(joint=hinge)), result.history("rate"), atol=1e-12)
    with pytest.raises(vv.InputError, match="Power belongs to a step"):
        result.history(vv.Power(of=drive))


def test_probes_leave_joints_as_they_are() -> None:
    """Probes made of a joint gave it a coordinate, if they were made before the system; strokes and rates need none."""
    ground = vv.Ground()
    drill = vv.RigidBody(mass=1.0, inertia=(1, 1, 2), velocity=(0, 0, 0.5), angular_velocity=(0, 0, 3))
    joint = vv.Cylindrical(a=ground, b=drill, at=(0, 0, 0), axis=(0, 0, 1))
    told = repr(joint)
    stroke, angle = (vv.JointCoordinate(joint=joint, coordinate=name) for name in ("stroke", "angle"))
    rates = [vv.JointRate(joint=joint, coordinate=name) for name in ("stroke", "angle")]
    assert repr(joint) == told
    system = vv.System([ground, drill, joint])
    assert system.n_coordinates == 12
    result = vv.simulate(system, until=0.4, step=0.1)
    np.testing.assert_allclose(result.history(stroke), 0.5 * result.times, atol=1e-12)
    for probe, rate in zip(rates, (0.5, 3.0), strict=True):
        np.testing.assert_allclose(result.history(probe), rate, rtol=1e-10)
    with pytest.raises(vv.InputError, match=r"no coordinate 'angle'.*construct the joint with angle=True"):
        result.history(angle)


def test_what_acts_on_a_joint_makes_its_coordinate() -> None:
    """A spring of 8 in the angle of an inertia of 2 swings by cos 2t."""
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 2), angular_velocity=(0, 0, 2))
    hinge = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1))
    angle = vv.JointCoordinate(joint=hinge)
    spring = vv.Potential(of=[angle], energy=lambda e: 4 * e[0] ** 2)
    result = vv.simulate(vv.System([ground, wheel, hinge, spring]), until=0.5, step=0.002)
    np.testing.assert_allclose(result.history(angle), np.sin(2 * result.times), atol=1e-5)
    assert not hinge.angle


def poiseuille(cell: str) -> tuple[vv.System, vv.Fluid]:
    """A channel of height 1 in a parabolic profile v = 4 y (1 - y)."""
    mesh = vv.RectangleMesh(size=(2, 1), counts=(4, 4), cell=cell)

    def profile(X: Any) -> Any:
        return np.stack([4 * X[:, 1] * (1 - X[:, 1]), 0 * X[:, 1], 0 * X[:, 1]], axis=1)

    oil = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.5, velocity=profile, name="oil")
    return vv.System([oil, vv.FluidTraction(fluid=oil, faces="all", traction=(0, 0, 0))]), oil


def test_flow_fields_of_a_parabolic_profile() -> None:
    system, oil = poiseuille("quad9")
    at = (1.0, 0.25, 0.0)
    gradient = vv.FlowField(fluid=oil, field="velocity_gradient", at=at)(system).reshape(3, 3)
    np.testing.assert_allclose(gradient, [[0, 4 - 8 * 0.25, 0], [0, 0, 0], [0, 0, 0]], atol=1e-12)
    stress = vv.FlowField(fluid=oil, field="stress", at=at)(system)
    np.testing.assert_allclose(stress, [0, 0, 0, 0.5 * 2.0, 0, 0], atol=1e-12)
    psi = vv.FlowField(fluid=oil, field="stream_function", at=(1.0, 1.0, 0.0))(system)
    bottom = vv.FlowField(fluid=oil, field="stream_function", at=(1.0, 0.0, 0.0))(system)
    assert abs(psi - bottom) == pytest.approx(2 / 3, rel=0.05)  # the flow through, between points of the mesh
    for side, sign in (("y0", 1), ("y1", 1)):
        np.testing.assert_allclose(
            vv.WallShear(fluid=oil, faces=side)(system), [sign * 0.5 * 4, 0, 0], atol=1e-12
        )
    assert vv.FlowField(fluid=oil, field="stress").parts == ("xx", "yy", "zz", "xy", "yz", "zx")


def test_only_plane_flows_have_a_stream_function() -> None:
    box = vv.Fluid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="hex27"), density=1.0, viscosity=1.0
    )
    system = vv.System([box, vv.FluidTraction(fluid=box, faces="all", traction=(0, 0, 0))])
    with pytest.raises(vv.InputError, match="only plane flows"):
        vv.FlowField(fluid=box, field="stream_function")(system)


def test_graded_meshes() -> None:
    mesh = vv.RectangleMesh(size=(4, 2), counts=(3, 2), grading=(4.0, (1.0, 3.0))).build()
    np.testing.assert_allclose(np.unique(mesh.points[:, 0].round(12)), [0, 4 / 7, 12 / 7, 4])
    np.testing.assert_allclose(np.unique(mesh.points[:, 1].round(12)), [0, 0.5, 2])
    box = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell="hex20", grading=(1.0, 3.0, 1.0)).build()
    np.testing.assert_allclose(np.unique(box.points[:, 1].round(12)), [0, 0.125, 0.25, 0.625, 1])
    assert box.volume == pytest.approx(1.0)
    with pytest.raises(vv.InputError, match="3 lengths for 2 blocks along axis 2"):
        vv.RectangleMesh(size=(1, 1), counts=(2, 2), grading=(1.0, (1, 1, 1))).build()
    with pytest.raises(vv.InputError, match="RectangleMesh: grading"):
        vv.RectangleMesh(size=(1, 1), counts=(2, 2), grading=(-1.0, 1.0))


def test_body_forces_by_expressions(tmp_path: Path) -> None:
    """The same as by a function, in files, too."""
    steel = vv.LinearElastic(young=10.0, poisson=0.3)

    def block(force: Any) -> vv.System:
        solid = vv.Solid(
            mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)), material=steel, density=1.0, name="block"
        )
        return vv.System([solid, vv.BodyForce(solid=solid, force=force, name="push")])

    def push(t: float, X: Any) -> Any:
        return np.stack([t * X[:, 0], 0 * X[:, 0], np.sin(X[:, 1]) + 2], axis=1)

    told, called = block(("t*x", 0, "sin(y) + 2")), block(push)
    a, b = (vv.simulate(system, until=0.2, step=0.05).states[-1] for system in (told, called))
    np.testing.assert_allclose(a, b, atol=1e-14)
    write_scene(vv.Study(told, 0.2, 0.05), tmp_path / "s.yaml")
    read = read_scene(tmp_path / "s.yaml")
    np.testing.assert_allclose(vv.simulate(read.system, until=0.2, step=0.05).states[-1], b, atol=1e-14)
    with pytest.raises(vv.InputError, match=r"'w' in .* is unknown; there are t, x, y, z"):
        block(("w", 0, 0))
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, body_force=("y", "t", 0))
    np.testing.assert_allclose(water.force_at(2.0, np.array([[0.0, 3.0, 0.0]])), [[3, 2, 0]])
