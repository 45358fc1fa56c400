"""Joints one by one: freedoms, reactions against statics, coordinates, motors against inverse dynamics."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from reference import statics
from reference.integrate import axis_rotation
from reference.statics import HELD, Held

import visviva as vv
from verification.measure import Array, conserved, reaction_at
from visviva.examples import slider_crank

FRAME = axis_rotation([0.3, -0.5, 0.8], 1.1)  # joint axes as columns
PLACE, OFFSET = np.array([0.4, -0.7, 1.2]), np.array([0.3, 0.2, -0.1])

JOINTS: dict[str, Any] = {
    "rigid": vv.Rigid,
    "revolute": vv.Revolute,
    "prismatic": vv.Prismatic,
    "cylindrical": vv.Cylindrical,
    "screw": partial(vv.Screw, pitch=0.3),
    "spherical": vv.Spherical,
    "universal": vv.Universal,
    "planar": vv.Planar,
    "point on line": vv.PointOnLine,
    "point on plane": vv.PointOnPlane,
}
FREEDOMS = {"rigid": 0, "revolute": 1, "prismatic": 1, "cylindrical": 2, "screw": 1, "spherical": 3}
FREEDOMS |= {"universal": 2, "planar": 3, "point on line": 4, "point on plane": 5, "distance": 5}


def body(position: Array, seed: int = 0) -> vv.RigidBody:
    """A body without any symmetry."""
    rng = np.random.default_rng(seed)
    R = axis_rotation(rng.normal(size=3), 1.0 + seed)
    return vv.RigidBody(
        mass=1.5, inertia=(0.4, 0.5, 0.7), centre=(0.1, -0.05, 0.07), position=position, rotation=R
    )


def joined(name: str, a: Any, b: Any) -> Any:
    """The joint at PLACE with the axes FRAME; the distance joint has its other end 0.8 along x."""
    if name == "distance":
        return vv.Distance(a=a.point_at(PLACE - 0.8 * FRAME[:, 0]), b=b.point_at(PLACE))
    axes = {"axis": FRAME[:, 2], "first": FRAME[:, 0]}
    return JOINTS[name](a=a.frame_at(PLACE, **axes), b=b.frame_at(PLACE, **axes))


def freedoms(system: vv.System) -> int:
    """Coordinates minus rank of the constraints' gradient."""
    _, K = system.tangent(vv.Static().step(0.0, 1.0))
    unknown = np.asarray(system.core.csr[2])
    moves = system.order[unknown] > 0
    return int(moves.sum() - np.linalg.matrix_rank(K.toarray()[~moves][:, moves], tol=1e-9))


@pytest.mark.parametrize("name", FREEDOMS)
def test_freedoms_between_two_bodies(name: str) -> None:
    one, two = body(PLACE + OFFSET, 1), body(PLACE - [0.1, 0.4, 0.3], 2)
    system = vv.System([one, two, joined(name, one, two)])
    assert freedoms(system) == 6 + FREEDOMS[name]
    assert system.n_coordinates - system.n_constraints == 6 + FREEDOMS[name]


@pytest.mark.parametrize("name", ["revolute", "prismatic", "cylindrical", "planar", "point on line"])
def test_coordinates_change_no_freedom(name: str) -> None:
    one, two = body(PLACE + OFFSET, 1), body(PLACE - [0.1, 0.4, 0.3], 2)
    joint = joined(name, one, two)
    wanted = [c for c in ("angle", "stroke") if getattr(joint, f"has_{c}")]
    for c in wanted:
        setattr(joint, c, True)
    system = vv.System([one, two, joint])
    assert wanted
    assert system.n_coordinates == 24 + len(wanted)
    assert freedoms(system) == 6 + FREEDOMS[name]


@pytest.mark.parametrize("grounded", ["a", "b"])
@pytest.mark.parametrize("case", HELD, ids=lambda c: c.joint.replace(" ", "-"))
def test_reaction_of_a_held_body(case: Held, grounded: str) -> None:
    """The load does no work in the free motions, so the body stays and the joint passes the load on."""
    ground, held = vv.Ground(), body(PLACE + OFFSET, 3)
    sides = (ground, held) if grounded == "a" else (held, ground)
    if case.joint == "distance" and grounded == "b":
        joint = vv.Distance(a=held.point_at(PLACE), b=ground.point_at(PLACE - 0.8 * FRAME[:, 0]))
    else:
        joint = joined(case.joint, *sides)
    lever = np.array([0.25, -0.3, 0.15])
    force, torque = case.load_at(FRAME, lever)
    loads = [vv.Force(on=held, at=PLACE + lever, force=force), vv.Torque(on=held, torque=torque)]
    system = vv.System([ground, held, joint, *loads])
    x = system.x.copy()
    system.step(0.1)
    moved = np.abs(system.x - x)[system.order == 2]
    assert moved.max() < 1e-12
    on_ground, about = case.reaction(FRAME)
    sign = -1.0 if grounded == "a" else 1.0  # the reaction is what acts on b
    found = vv.reaction(system, joint)
    if case.joint == "distance" and grounded == "b":  # about the ground's point, on the line of the force
        about = about + np.cross(0.8 * FRAME[:, 0], on_ground)
    assert found[0] == pytest.approx(sign * on_ground, abs=1e-10)
    assert found[1] == pytest.approx(sign * about, abs=1e-10)


def test_cantilever_under_its_weight_and_a_tip_force() -> None:
    ground, load = vv.Ground(), np.array([3.0, -2.0, 5.0])
    bar = vv.RigidBody(shape=vv.Box(size=(2, 0.1, 0.1)), mass=4.0, position=(1, 0, 0))
    clamp = vv.Rigid(a=ground, b=bar, at=(0, 0, 0))
    system = vv.System([ground, bar, clamp, vv.Gravity(), vv.Force(on=bar, at=(2, 0, 0), force=load)])
    system.step(1.0)
    force, torque = statics.cantilever(4.0, 2.0, load)
    found = vv.reaction(system, clamp)
    assert found[0] == pytest.approx(-force, abs=1e-10)
    assert found[1] == pytest.approx(-torque, abs=1e-10)


def test_three_hinged_arch() -> None:
    """Two bars lean on each other; the one statically determinate loop here."""
    angle, length = 0.9, 2.0
    foot = length * np.cos(angle)
    top = np.array([0.0, length * np.sin(angle), 0.0])
    ground = vv.Ground()
    bars = []
    for side in (-1.0, 1.0):
        R = axis_rotation([0, 0, 1], angle if side < 0 else np.pi - angle)
        middle = 0.5 * (np.array([side * foot, 0, 0]) + top)
        box = vv.Box(size=(length, 0.1, 0.1))
        bars.append(vv.RigidBody(shape=box, mass=3.0, position=middle, rotation=R))
    left = vv.Revolute(a=ground, b=bars[0], at=(-foot, 0, 0))
    right = vv.Revolute(a=ground, b=bars[1], at=(foot, 0, 0))
    hinge = vv.Spherical(a=bars[0], b=bars[1], at=top)
    gravity = vv.Gravity(acceleration=(0, -9.81, 0))
    system = vv.System([ground, *bars, left, right, hinge, gravity])
    system.step(0.01)
    exact = statics.three_hinged_arch(3.0, length, angle)
    for joint, force in ((left, -exact["left"]), (right, -exact["right"]), (hinge, exact["top"])):
        assert vv.reaction(system, joint)[0] == pytest.approx([*force, 0.0], abs=1e-9)


def wheel(x: float) -> vv.RigidBody:
    return vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.2), position=(x, 0, 0))


def test_gear_balances_torques() -> None:
    ground, one, two = vv.Ground(), wheel(0.0), wheel(0.5)
    shafts = [vv.Revolute(a=ground, b=w, at=(x, 0, 0)) for w, x in ((one, 0.0), (two, 0.5))]
    second, _ = statics.gear_torques(2.0, 0.2, 0.3)
    gear = vv.Gear(a=shafts[0], b=shafts[1], ratio=0.3 / 0.2)
    loads = [vv.JointForce(joint=shafts[0], force=2.0), vv.JointForce(joint=shafts[1], force=second)]
    system = vv.System([ground, one, two, *shafts, gear, *loads])
    for _ in range(3):
        system.step(0.1)
    assert [system.value(s.coordinate()) for s in shafts] == pytest.approx([0.0, 0.0], abs=1e-13)


def test_teeth_drive_the_second_wheel() -> None:
    """Wheels of radii 0.2 and 0.3 and moments 0.4 and 0.9, spun up by 5: ``a1 = 5 / (0.4 + 0.9 (2 / 3)^2)``."""
    ground = vv.Ground()
    wheels = [
        vv.RigidBody(mass=1.0, inertia=(1, 1, J), position=(x, 0, 0)) for x, J in ((0.0, 0.4), (0.5, 0.9))
    ]
    shafts = [vv.Revolute(a=ground, b=w, at=w.position, axis=(0, 0, 1)) for w in wheels]
    gear = vv.Gear(a=shafts[0], b=shafts[1], ratio=1.5)
    system = vv.System([ground, *wheels, *shafts, gear, vv.JointForce(joint=shafts[0], force=5.0)])
    probes = {"torque": vv.ReactionTorque(joint=gear), "force": vv.ReactionForce(joint=gear)}
    result = vv.simulate(system, until=0.1, step=0.01, record=probes)
    load = 0.9 * (2 / 3) * 5.0 / (0.4 + 0.9 * (2 / 3) ** 2)
    np.testing.assert_allclose(
        result.history("torque"), np.tile([0, 0, -load], (11, 1)), rtol=1e-7, atol=1e-9
    )
    np.testing.assert_allclose(result.history("force"), 0.0, atol=1e-9)


def test_teeth_hold_a_ring_that_is_the_ground() -> None:
    """A planetary gear of radii 1, 0.5, 2, its ring held: what turns the sun, less what all gain, holds the ring."""
    ground, (sun, carrier, planet) = (
        vv.Ground(),
        (vv.RigidBody(mass=0.4, inertia=(1, 1, J)) for J in (0.3, 0.7, 0.06)),
    )
    planet.position = (1.5, 0, 0)
    held = vv.Revolute(a=ground, b=carrier, at=(0, 0, 0))
    of_sun, of_ring = (vv.Revolute(a=carrier, b=b, at=(0, 0, 0)) for b in (sun, ground))
    of_planet = vv.Revolute(a=carrier, b=planet, at=(1.5, 0, 0))
    inner = vv.Gear(a=of_sun, b=of_planet, ratio=0.5)
    outer = vv.Gear(a=of_planet, b=of_ring, ratio=-4.0)
    turn = vv.Torque(on=sun, torque=(0, 0, 2.0))
    bodies = [ground, sun, carrier, planet, held, of_sun, of_ring, of_planet]
    system = vv.System([*bodies, inner, outer, turn])
    vv.simulate(system, until=0.2, step=0.01)
    to_sun, to_planet = 1 + 2 / 1, 1 - 2 / 0.5  # per turn of the carrier
    moments = 0.3 * to_sun**2 + 0.7 + 0.4 * 1.5**2 + 0.06 * to_planet**2
    gained = (0.3 * to_sun + 0.7 + 0.4 * 1.5**2 + 0.06 * to_planet) * 2.0 * to_sun / moments
    assert vv.ReactionTorque(joint=outer)(system)[2] == pytest.approx(2.0 - gained, rel=1e-7)


def test_teeth_push_the_rack() -> None:
    """A rack of mass 2 on a pinion of radius 0.2 and moment 0.4, turned by 3."""
    ground, pinion = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 0.4))
    rack = vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(0.5, 0, 0))
    shaft = vv.Revolute(a=ground, b=pinion, at=(0, 0, 0), axis=(0, 0, 1))
    guide = vv.Prismatic(a=ground, b=rack, at=(0.5, 0, 0), axis=(0, 1, 0))
    teeth = vv.RackAndPinion(a=shaft, b=guide, radius=0.2)
    drive = vv.JointForce(joint=shaft, force=3.0)
    result = vv.simulate(
        vv.System([ground, pinion, rack, shaft, guide, teeth, drive]),
        until=0.1,
        step=0.01,
        record={"force": vv.ReactionForce(joint=teeth)},
    )
    push = 2.0 * 0.2 * 3.0 / (0.4 + 2.0 * 0.2**2)
    np.testing.assert_allclose(result.history("force"), np.tile([0, push, 0], (11, 1)), rtol=1e-7, atol=1e-9)


def test_rack_balances_the_pinion() -> None:
    ground, pinion, rack = vv.Ground(), wheel(0.0), wheel(0.5)
    shaft = vv.Revolute(a=ground, b=pinion, at=(0, 0, 0))
    guide = vv.Prismatic(a=ground, b=rack, at=(0.5, 0, 0), axis=(0, 1, 0))
    teeth = vv.RackAndPinion(a=shaft, b=guide, radius=0.2)
    loads = [
        vv.JointForce(joint=guide, force=7.0),
        vv.JointForce(joint=shaft, force=statics.rack_torque(7.0, 0.2)),
    ]
    system = vv.System([ground, pinion, rack, shaft, guide, teeth, *loads])
    for _ in range(3):
        system.step(0.1)
    assert [system.value(j.coordinate()) for j in (shaft, guide)] == pytest.approx([0.0, 0.0], abs=1e-13)


def test_winch_holds_a_hanging_load() -> None:
    ground, drum = vv.Ground(), wheel(0.0)
    load = vv.PointMass(mass=5.0, position=(0, 0, -2.0))
    axle = vv.Revolute(a=ground, b=drum, at=(0, 0, 0), axis=(0, 1, 0))
    rope = vv.RopeOverWinch(a=drum.point(), b=load.point(), winch=axle, radius=0.1, length=2.0)
    brake = vv.Motor(joint=axle, motion=0.0)
    parts = [ground, drum, load, axle, rope, brake, vv.Gravity()]
    system = vv.System(parts, vv.Newton(tolerance=1e-16))
    system.step(0.1)
    assert brake.effort(system) == pytest.approx(statics.winch_torque(5.0, 0.1), rel=1e-10)
    assert vv.reaction(system, rope)[0] == pytest.approx([0, 0, 5.0 * 9.81], abs=1e-9)


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint()], ids=str)
def test_a_rope_does_not_push(scheme: vv.Scheme) -> None:
    """A drum turned by ``10 t`` lets the load fall freely from ``t = g J / (10 r)`` on."""
    ground, drum = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    load = vv.PointMass(mass=5.0, position=(0, 0, -2.0))
    axle = vv.Revolute(a=ground, b=drum, at=(0, 0, 0), axis=(0, 1, 0))
    rope = vv.RopeOverWinch(a=drum.point(), b=load.point(), winch=axle, radius=1.0, length=2.0, name="rope")
    turn = vv.JointForce(joint=axle, force="10*t")
    system = vv.System([ground, drum, load, axle, rope, turn, vv.Gravity()])
    with pytest.raises(vv.StepFailure, match=r"RopeOverWinch 'rope' pushes by .* vv.Beam") as caught:
        vv.simulate(system, until=2.0, step=0.001, scheme=scheme)
    assert caught.value.time == pytest.approx(0.981, abs=0.005)


def test_a_rope_that_carries_nothing_is_no_pushing_one() -> None:
    ground, drum, load = vv.Ground(), wheel(0.0), vv.PointMass(mass=5.0, position=(0, 0.3, -2.0))
    axle = vv.Revolute(a=ground, b=drum, at=(0, 0, 0), axis=(0, 1, 0))
    length = float(np.hypot(0.3, 2.0))
    rope = vv.RopeOverWinch(a=drum.point(), b=load.point(), winch=axle, radius=0.1, length=length)
    system = vv.System([ground, drum, load, axle, rope, vv.Motor(joint=axle, motion=0.0)])
    assert vv.simulate(system, until=1.0, step=0.01).statistics.rejected == 0


def test_angle_counts_turns_both_ways() -> None:
    """Constant torque: seven turns in closed form, then back through zero to more than one the other way."""
    ground, rotor = vv.Ground(), body(np.zeros(3), 4)
    shaft = vv.Revolute(a=ground, b=rotor, at=(0, 0, 0), axis=(0.2, -1.0, 0.4), angle=True)
    drive = vv.JointForce(joint=shaft, force=lambda t: 1.0 if t < 5.0 else -1.0)
    system = vv.System([ground, rotor, shaft, drive])
    axis = np.array([0.2, -1.0, 0.4]) / np.sqrt(1.2)
    J, c = np.diag([0.4, 0.5, 0.7]), rotor.rotation @ [0.1, -0.05, 0.07]
    arm = c - (c @ axis) * axis
    inertia = axis @ rotor.rotation @ J @ rotor.rotation.T @ axis + 1.5 * arm @ arm
    found, exact = [], []
    for _ in range(2500):
        system.step(0.008)
        t = system.time
        early = min(t, 5.0)
        late = t - early
        exact.append((0.5 * early**2 + early * late - 0.5 * late**2) / inertia)
        found.append(system.value(shaft.coordinate()))
    assert max(exact) > 7 * 2 * np.pi
    assert min(exact) < -2 * np.pi
    assert np.abs(np.array(found) - exact).max() < 0.1
    d = np.array([v.value(system.x) for v in rotor.directors])
    turned = axis_rotation(axis, found[-1]) @ rotor.rotation
    assert np.abs(d - turned.T).max() < 1e-12


def test_stroke_on_a_slope_is_exact() -> None:
    """Uniform acceleration is exact under the midpoint rule; the reaction too."""
    ground, sled = vv.Ground(), body(PLACE, 5)
    rail = vv.Prismatic(a=ground, b=sled, at=PLACE, axis=FRAME[:, 2], stroke=True)
    system = vv.System([ground, sled, rail, vv.Gravity()], vv.Newton(tolerance=1e-15))
    result = vv.simulate(system, until=1.0, step=0.05)
    slope = -9.81 * FRAME[2, 2]
    assert system.value(rail.coordinate()) == pytest.approx(0.5 * slope, abs=1e-12)
    weight = np.array([0, 0, -1.5 * 9.81])
    normal = -(weight - (weight @ FRAME[:, 2]) * FRAME[:, 2])
    assert reaction_at(result, rail, 10)[0] == pytest.approx(normal, abs=1e-9)


def motion(t: float) -> float:
    return float(0.3 + 2.0 * np.sin(1.5 * t) + 0.4 * t * t)


def test_torque_of_a_motor_is_inverse_dynamics() -> None:
    """theta(t) prescribed about a horizontal axis: M = J theta'' + m g l cos theta."""
    worst = []
    for h in (0.02, 0.01):
        c, s = np.cos(0.3), np.sin(0.3)
        rate = 3.0
        ground = vv.Ground()
        arm = vv.RigidBody(
            mass=2.0,
            inertia=(0.2, 0.2, 0.3),
            centre=(0.5, 0, 0),
            rotation=[[c, -s, 0], [s, c, 0], [0, 0, 1]],
            angular_velocity=(0, 0, rate),
        )
        shaft = vv.Revolute(a=ground.frame(), b=arm.frame())  # angle zero: along e1
        motor = vv.Motor(joint=shaft, motion=motion)
        system = vv.System([ground, arm, shaft, motor, vv.Gravity(acceleration=(0, -9.81, 0))])
        efforts = []
        result = vv.simulate(
            system, until=2.0 + h, step=h, observe=lambda s, e=efforts, m=motor: e.append(m.effort(s))
        )
        t = h * np.arange(1, len(efforts) + 1)
        angle = np.array([motion(s) for s in t])
        exact = 0.8 * (0.8 - 4.5 * np.sin(1.5 * t)) + 2.0 * 9.81 * 0.5 * np.cos(angle)
        worst.append(np.abs(np.array(efforts) - exact).max())
        assert system.value(shaft.coordinate()) == pytest.approx(motion(system.time), abs=1e-12)
        conserved(result, tolerance=1e-9)
    assert max(worst) < 1e-8  # positions and rates are those of the drive


def test_force_of_a_linear_motor() -> None:
    ground = vv.Ground()
    cart = vv.RigidBody(mass=3.0, inertia=(1, 1, 1))
    rail = vv.Prismatic(a=ground, b=cart, at=(0, 0, 0), axis=(1, 0, 0))
    motor = vv.Motor(joint=rail, motion=lambda t: 0.5 * 1.2 * t * t)
    system = vv.System([ground, cart, rail, motor])
    system.step(0.1)
    system.step(0.1)
    assert motor.effort(system) == pytest.approx(3.6, rel=1e-9)


def test_slider_crank_is_kinematics() -> None:
    """A rheonomic constraint holds at every step: the piston is where the crank puts it."""
    study = slider_crank.study(step=0.02)
    result = vv.simulate(study.system, until=3.0, step=0.02)
    crank, piston = (result.history(study.probes[k]) for k in ("crank_angle", "piston"))
    t = np.array(result.times)
    assert np.abs(crank - 4.0 * t).max() < 1e-12
    place = 0.3 * np.cos(4 * t) + np.sqrt(1.0 - 0.09 * np.sin(4 * t) ** 2)
    assert np.abs(piston - place).max() < 1e-12
    result.assert_conserved("energy", "constraints")
