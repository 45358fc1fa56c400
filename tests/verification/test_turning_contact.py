"""What is pressed on bodies that turn stays on their surface, however long they turn, and impacts stay impacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.study.run import run

R = 0.2
ALONG_Y = ((1, 0, 0), (0, 0, -1), (0, 1, 0))
BODIES: dict[str, Any] = {
    "ball": lambda: vv.RigidBody(shape=vv.Sphere(radius=R), mass=20.0),
    "cylinder": lambda: vv.RigidBody(shape=vv.Cylinder(radius=R, length=0.3), mass=20.0, rotation=ALONG_Y),
    "capsule": lambda: vv.RigidBody(shape=vv.Capsule(radius=R, length=0.3), mass=20.0, rotation=ALONG_Y),
}
TO_AND_FRO = "1-cos(20*t)"


def pressed(
    body: str = "ball",
    motion: str = TO_AND_FRO,
    eccentric: float = 0.0,
    rider: str = "point",
    gravity: float = 9.81,
    **options: Any,
) -> tuple[vv.System, vv.Probe]:
    """A point or a ball on a line above the axis that a body turns about, and its height."""
    ground, turning = vv.Ground(), BODIES[body]()
    radius = 0.1 if rider == "ball" else 0.0
    place = (0, 0, R + radius)
    rides: Any = (
        vv.RigidBody(shape=vv.Sphere(radius=radius), mass=1.0, position=place)
        if rider == "ball"
        else vv.PointMass(mass=1.0, position=place)
    )
    axis = vv.Revolute(a=ground, b=turning, at=(0, 0, -eccentric), axis=(0, 1, 0), angle=True)
    line = vv.PointOnLine(a=ground, b=rides, at=place, axis=(0, 0, 1))
    contact = vv.Contact(first=rides, second=turning, stiffness=1e4, **options)
    parts = [ground, turning, axis, rides, line, contact, vv.Motor(joint=axis, motion=motion)]
    return vv.System([*parts, vv.Gravity(acceleration=(0, 0, -gravity))]), vv.Position(of=rides)


def heights(until: float, step: float, scheme: Any = None, **options: Any) -> tuple[Any, Any]:
    """Times and heights over the axis at the start."""
    system, position = pressed(**options)
    result = vv.simulate(system, until=until, step=step, scheme=scheme)
    result.assert_conserved("energy", tolerance=1e-7)
    return result.times, result.history(position)[:, 2]


@pytest.mark.parametrize("rider", ["point", "ball"])
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("options", [{}, {"restitution": 0.5}, {"friction": 0.3}], ids=str)
def test_what_is_pressed_does_not_sink(body: str, rider: str, options: dict[str, Any]) -> None:
    """Every other step took it deeper by the third order of the step: 8 mm in 5 s with steps of 0.005."""
    top = R + (0.1 if rider == "ball" else 0)
    depths = []
    for step in (0.01, 0.005):
        times, z = heights(4.0, step, body=body, rider=rider, **options)
        late, early = top - z[times > 2.0], top - z[times <= 2.0]
        assert late.max() == pytest.approx(early.max(), rel=0.05)
        depths.append(late.max())
    assert depths[1] < 3e-5
    assert depths[0] / depths[1] > 6


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.VariationalMidpoint(), vv.BackwardEuler()], ids=str)
def test_nor_does_it_with_other_schemes(scheme: Any) -> None:
    system, position = pressed()
    result = vv.simulate(system, until=2.0, step=0.005, scheme=scheme)
    assert np.abs(result.history(position)[:, 2] - R).max() < 2e-5


@pytest.mark.parametrize("eccentric", [0.0, 0.03])
@pytest.mark.parametrize("scheme", [vv.VariationalMidpoint(), vv.BackwardEuler()], ids=str)
def test_contact_that_stays_does_no_work(scheme: Any, eccentric: float) -> None:
    """Along the chords of what turns backward Euler booked S R (h w)^2 / 2 in each step: 9.8 J in 10 s with 1 g."""
    system, _ = pressed(eccentric=eccentric, gravity=30.0)
    result = vv.simulate(system, until=2.0, step=0.005, scheme=scheme)
    assert np.abs(result.ledger["work_contact"]).max() < 1e-4


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("omega", [5.0, 10.0])
def test_follower_of_an_eccentric_cam(omega: float, step: float) -> None:
    """z = e (cos w t - 1) + sqrt(R^2 - (e sin w t)^2), turn by turn."""
    e = 0.05
    times, z = heights(10.0, step, motion=f"{omega}*t", eccentric=e, gravity=30.0)
    exact = e * (np.cos(omega * times) - 1) + np.sqrt(R**2 - (e * np.sin(omega * times)) ** 2)
    assert np.abs(z - exact).max() < 0.3 * e * (omega * step) ** 3


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_no_irregular_motion_drives_it_in(seed: int) -> None:
    """By up to 70 mm in 20 s it did."""
    of = np.random.default_rng(seed)
    waves = zip(of.uniform(-1, 1, 6), of.uniform(2, 25, 6), strict=True)
    motion = "+".join(f"({a:.4f})*sin({w:.4f}*t)" for a, w in waves)
    _, z = heights(10.0, 0.005, motion=motion, gravity=30.0)
    assert R - z.min() < 2e-4


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_spinning_balls_pressed_by_a_spring_stay_apart(friction: float) -> None:
    """Free ones of other sizes, whose energy never grows, with their momenta."""
    one = vv.RigidBody(shape=vv.Sphere(radius=0.2), mass=2.0, angular_velocity=(3, 15, 1))
    two = vv.RigidBody(
        shape=vv.Sphere(radius=0.1), mass=1.0, position=(0, 0, 0.3), angular_velocity=(1, -9, 2)
    )
    spring = vv.Spring(a=one.point(), b=two.point(), stiffness=200.0, free_length=0.1)
    contact = vv.Contact(first=two, second=one, stiffness=1e4, friction=friction)
    result = vv.simulate(vv.System([one, two, spring, contact]), until=5.0, step=0.005)
    apart = result.history(vv.Position(of=two)) - result.history(vv.Position(of=one))
    assert np.abs(np.linalg.norm(apart, axis=1) - 0.3).max() < 2e-5
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * total[0]
    result.assert_conserved("energy", "momentum_z", "angular_x", "angular_y", "angular_z", tolerance=1e-10)


def test_a_resting_body_takes_the_impact_of_another_one() -> None:
    """It has landed deep, by 1 m/s in a step; what hits it later with 2 m/s comes to rest on it."""
    h, plane = 0.01, vv.Plane()
    low, high = (
        vv.RigidBody(shape=vv.Sphere(radius=0.1), mass=1.0, position=(0, 0, z), velocity=(0, 0, -v))
        for z, v in ((0.1037, 1.0), (0.7, 2.0))
    )
    contacts = [
        vv.Contact(first=low, second=plane, stiffness=1e4),
        vv.Contact(first=high, second=low, stiffness=1e4),
    ]
    system = vv.System([low, high, plane, *contacts])
    result = vv.simulate(system, until=0.4, step=h)
    assert result.ledger.last("kinetic") < 1e-20
    assert np.diff(result.ledger["total"]).max() < 1e-13
    assert result.ledger.last("work_contact") == pytest.approx(-2.5, rel=1e-12)


@pytest.mark.parametrize("end", [0.05, 0.31, 0.6])
@pytest.mark.parametrize("tangential", ["multipliers", "penalty"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_resumed_run_is_the_same(friction: float, tangential: str, end: float, tmp_path: Path) -> None:
    """With what it has to know of where contact began."""
    options: dict[str, Any] = {"friction": friction}
    if friction:
        options |= {"tangential": tangential, "tangential_stiffness": 1e4}

    def study(until: float) -> vv.Study:
        return vv.Study(pressed(eccentric=0.03, rider="ball", gravity=30.0, **options)[0], until, 0.01)

    whole = run(study(1.0), tmp_path / "whole", pictures=False)
    run(study(end), tmp_path / "parts", pictures=False)
    parts = run(study(1.0), tmp_path / "parts", resume=True, pictures=False)
    for name in ("x", "v"):
        np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


def turned(body: vv.RigidBody, obstacle: Any = None, other: Any = None, **options: Any) -> tuple[Any, Any]:
    """A heavy body that turns about z by 0.3 rad in each step, and what it meets."""
    contact = vv.Contact(
        first=other or body,
        second=body if other else obstacle,
        formulation="node-to-segment",
        stiffness=1e4,
        **options,
    )
    axis = vv.Revolute(a=vv.Ground(), b=body, at=(0, 0, 0), axis=(0, 0, 1))
    parts = [axis.a, body, axis, contact, *(part for part in (obstacle, other) if part)]
    return vv.System(parts), contact


SPIN: Any = {"mass": 1e6, "inertia": np.eye(3) * 1e6, "angular_velocity": (0, 0, 15.0)}
CLEAR = 1e-4 * R


def tube(radius: float, corners: int) -> Any:
    """Points and triangles of two rings, one inside of the other."""
    angle = 2 * np.pi * np.arange(corners) / corners
    rings = [
        np.stack([r * np.cos(angle), r * np.sin(angle), np.full(corners, z)], axis=1)
        for r, z in ((radius, 0.1), (radius, -0.1), (2 * radius, -0.1), (2 * radius, 0.1))
    ]
    i, j = np.arange(corners), (np.arange(corners) + 1) % corners
    triangles = []
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        a, b = a * corners, b * corners
        triangles += [np.stack([a + i, b + i, b + j], axis=1), np.stack([a + i, b + j, a + j], axis=1)]
    return vv.SurfaceMesh(points=np.concatenate(rings), triangles=np.concatenate(triangles)[:, ::-1])


@pytest.mark.parametrize("name", ["shaft", "shaft of facets", "ring"])
def test_bodies_that_spin_beside_others_are_not_cut(name: str) -> None:
    """What is clear of them stays clear, however far they turn in a step: chords led 2 mm through the shaft."""
    if name == "ring":
        ring = vv.RigidBody(shape=tube(R + CLEAR, 24), **SPIN)
        system, contact = turned(ring, vv.Obstacle(shape=vv.Cylinder(radius=R, length=0.4)))
    else:
        shaft: Any = vv.Cylinder(radius=R, length=0.4)
        if name != "shaft":
            points, triangles = shaft.surface(128)
            shaft = vv.SurfaceMesh(points=points, triangles=triangles)
        ball = vv.RigidBody(shape=vv.Sphere(radius=0.05), mass=1.0, position=(R + 0.05 + CLEAR, 0, 0.03))
        system, contact = turned(vv.RigidBody(shape=shaft, **SPIN), other=ball)
    result = vv.simulate(system, until=0.4, step=0.02)
    assert result.statistics.rejected == 0
    assert not contact.pressures.any()
    sagitta = R * (1 - np.cos(np.pi / 128))  # of the facets
    assert CLEAR * (1 - 1e-6) < contact.gaps.min() < CLEAR + sagitta


def test_the_corner_of_a_box_that_spins_hits_within_a_step() -> None:
    """It sweeps over a point in 0.284 of the 0.298 rad of the third step, and goes 2 cm beyond: none ends in it."""
    meets = np.arccos(R / 0.25)  # how far the box has turned as its face meets the point
    point = vv.PointMass(mass=1.0, position=(0.25, 0, 0))
    start = meets - 2 * 2 * np.arctan(0.15) - 0.007  # two steps, as the scheme turns
    rotation = ((np.cos(start), -np.sin(start), 0), (np.sin(start), np.cos(start), 0), (0, 0, 1))
    box = vv.RigidBody(shape=vv.Box(size=(2 * R,) * 3), rotation=rotation, **SPIN)
    system, _ = turned(box, other=point, restitution=1.0)
    assert vv.simulate(system, until=0.06, step=0.02).statistics.rejected > 0
    normal = np.array([np.cos(meets), np.sin(meets), 0.0])
    thrown = 2 * 15.0 * 0.25 * np.sin(meets)  # twice as fast as the face comes; if passed it were at rest
    assert point.point().position.rate(system.v) @ normal > 0.9 * thrown
