"""One body on every kind of joint, against ADAMS (unit tests of Project Chrono) and against an own model."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from reference import adams, adams_models
from reference.adams import CASES, Case

import visviva as vv
from verification.measure import Array, conserved, reaction_at

JOINTS: dict[str, Any] = {
    "revolute": vv.Revolute,
    "torsion spring": vv.Revolute,
    "spherical": vv.Spherical,
    "prismatic": vv.Prismatic,
    "cylindrical": vv.Cylindrical,
    "universal": vv.Universal,
}
FINE_STEPS = {"Distance_Case02": 0.0003125, "Distance_Case03": 0.00125}  # sensitive; the others take 0.005
REACTIONS = slice(14, 20)


def build(case: Case) -> tuple[vv.System, vv.RigidBody, Any]:
    """System, body, and the joint (or the spring)."""
    ground = vv.Ground()
    body = vv.RigidBody(
        mass=case.mass, inertia=case.inertia, position=case.centre, rotation=case.attitude, name="body"
    )
    parts: list[Any] = [ground, body, vv.Gravity(acceleration=(0, 0, -adams.GRAVITY))]
    if case.joint in JOINTS:
        axes = {"axis": case.frame[:, 2], "first": case.frame[:, 0]}
        ends = {
            "a": ground.frame_at(case.ground_point, **axes),
            "b": body.frame_at(case.body_point, **axes),
        }
        link = JOINTS[case.joint](**ends)
    else:
        ends = {"a": ground.point(case.ground_point), "b": body.point_at(case.body_point)}
        link = vv.Distance(**ends, length=case.length)
        if case.joint == "spring":
            spring = {"stiffness": case.stiffness, "damping": case.damping, "free_length": case.length}
            link = vv.Spring(**ends, **spring)
    parts.append(link)
    if case.joint == "torsion spring":
        parts.append(vv.JointSpring(joint=link, stiffness=case.stiffness))
        parts.append(vv.JointDamper(joint=link, damping=case.damping))
    return vv.System(parts), body, link


def on_ground(case: Case, result: vv.Result, body: vv.RigidBody, link: Any, k: int) -> Array:
    """Force on the ground and torque about its joint point by joint and spring."""
    x, v = result.states[k], result.rates[k]
    if case.joint == "spring":
        place = body.point_at(case.body_point).position
        p, rate = place.value(x), place.rate(v)
        along = (p - case.ground_point) / np.linalg.norm(p - case.ground_point)
        size = np.linalg.norm(p - case.ground_point) - case.length
        force = (case.stiffness * size + case.damping * along @ rate) * along
        return np.concatenate([force, np.zeros(3)])
    force, torque = reaction_at(result, link, k)
    arm = link.sides[1].p.value(x) - case.ground_point
    torque = torque + np.cross(arm, force)
    if case.joint == "torsion spring":
        angle = link.coordinate()
        moment = case.stiffness * angle.value(x) + case.damping * angle.rate(v)
        torque = torque - moment * case.frame[:, 2]
    return -np.concatenate([force, torque])


@cache
def run(name: str, step: float) -> tuple[Array, vv.Result]:
    """Columns of `adams.COLUMNS` at t = 0.25, 0.5 ... 5; and the result."""
    case = CASES[name]
    system, body, link = build(case)
    result = vv.simulate(system, until=5.0 + step, step=step)
    rows = []
    for t in np.arange(0.25, 5.01, 0.25):
        k = round(t / step)
        x, v = result.states[k], result.rates[k]
        directors = np.array([d.value(x) for d in body.directors])
        spins = np.array([d.rate(v) for d in body.directors])
        omega = 0.5 * np.cross(directors, spins).sum(axis=0)
        place = body.point().position
        attitude = adams_models.quaternion(directors.T)
        wrench = on_ground(case, result, body, link, k)
        rows.append(np.concatenate([[t], place.value(x), place.rate(v), attitude, omega, wrench]))
    return np.array(rows), result


def pair(name: str) -> tuple[Array, Array]:
    """Coarse and fine solution."""
    fine = FINE_STEPS.get(name, 0.005)
    return run(name, 2 * fine)[0], run(name, fine)[0]


def aligned(rows: Array, table: dict[str, Array]) -> Array:
    """The table's rows after t = 0, quaternions with the signs of `rows`."""
    exact = np.column_stack([table[c] for c in adams.COLUMNS])[1:]
    signs = np.sign(np.einsum("ki,ki->k", exact[:, 7:11], rows[:, 7:11]))
    exact[:, 7:11] *= signs[:, None]
    return exact


def scales(exact: Array) -> Array:
    """Size of each kind of column: time, position, velocity, quaternion, angular velocity, force, torque."""
    sizes = np.ones(len(adams.COLUMNS))
    for a, b in ((1, 4), (4, 7), (11, 14), (14, 17), (17, 20)):
        sizes[a:b] = max(1.0, np.abs(exact[:, a:b]).max())
    return sizes


@pytest.mark.parametrize("name", CASES)
def test_against_adams(name: str) -> None:
    """Within the tolerances of the unit tests: 1e-3 for the motion (here of its size), 2e-2 for reactions."""
    coarse, fine = pair(name)
    best = fine + (fine - coarse) / 3.0
    exact = aligned(fine, adams.table(name))
    difference = np.abs(best - exact) / scales(exact)
    assert difference[:, :14].max() < 1e-3
    assert difference[:, REACTIONS].max() < 2e-2


@pytest.mark.parametrize("name", CASES)
def test_against_an_own_model_with_order_two(name: str) -> None:
    coarse, fine = pair(name)
    exact = aligned(fine, adams_models.cached(name))
    first, second = (np.abs(v - exact).max(axis=0) / scales(exact) for v in (coarse, fine))
    assert second.max() < 1e-2
    assert (np.abs(fine + (fine - coarse) / 3.0 - exact) / scales(exact)).max() < 1e-3
    converging = first > 1e-6  # the rest is exact, or nearly
    assert np.all(second[~converging] < 1e-6)
    assert first[converging] / second[converging] == pytest.approx(4.0, abs=0.4)


@pytest.mark.parametrize("name", CASES)
def test_balance(name: str) -> None:
    result = run(name, FINE_STEPS.get(name, 0.005))[1]
    weight = adams.GRAVITY * CASES[name].mass  # 1 m deep: also the scale of what stays at rest
    assert np.abs(result.ledger["imbalance"]).max() < 1e-9 * max(weight, result.ledger.energy_scale)
    result.assert_conserved("constraints", tolerance=1e-12)


def test_rack_and_pinion() -> None:
    """A falling rack turns a pinion; uniform acceleration in closed form."""
    ground = vv.Ground()
    rack = vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0.1, 0, 0), name="rack")
    pinion = vv.RigidBody(mass=1.0, inertia=(0.04, 0.04, 0.04), name="pinion")
    guide = vv.Prismatic(a=ground, b=rack, at=(0.1, 0, 0), axis=(0, 0, -1))
    shaft = vv.Revolute(a=ground, b=pinion, at=(0, 0, 0), axis=(0, 1, 0))
    teeth = vv.RackAndPinion(a=shaft, b=guide, radius=0.1)
    gravity = vv.Gravity(acceleration=(0, 0, -adams.GRAVITY))
    system = vv.System([ground, rack, pinion, guide, shaft, teeth, gravity])
    result = vv.simulate(system, until=1.0, step=0.005)
    exact = adams.rack_and_pinion(1.0)
    assert system.value(guide.coordinate()) == pytest.approx(-exact["z"], abs=1e-2)
    assert system.value(shaft.coordinate()) == pytest.approx(exact["angle"], abs=1e-1)
    ratio = system.value(guide.coordinate()) / system.value(shaft.coordinate())
    assert ratio == pytest.approx(0.1, rel=1e-13)
    conserved(result, tolerance=1e-10)
