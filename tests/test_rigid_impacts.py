"""Rigid bodies and points that collide by multipliers: restitution, friction, redundant pressures, schemes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Delaunay

import visviva as vv
from visviva.study.run import run

G = 9.81

FALLING: dict[str, Any] = {
    "ball": lambda z: vv.RigidBody(
        shape=vv.Sphere(radius=0.1), density=1e3, position=(0, 0, 0.1 + z), velocity=(0, 0, -1)
    ),
    "point": lambda z: vv.PointMass(mass=2.0, position=(0, 0, z), velocity=(0, 0, -1)),
    "box": lambda z: vv.RigidBody(
        shape=vv.Box(size=(0.3, 0.2, 0.2)), density=1e3, position=(0, 0, 0.1 + z), velocity=(0, 0, -1)
    ),
}


def drop(kind: str, height: float, h: float = 0.01, scheme: Any = None, **options: Any) -> tuple[float, Any]:
    """Velocity after the impact on a plane, and the result."""
    body, plane = FALLING[kind](height), vv.Plane()
    system = vv.System([body, plane, vv.Contact(first=body, second=plane, stiffness=1e5, **options)])
    result = vv.simulate(system, until=0.2, step=h, scheme=scheme)
    return float(system.v[2]), result


@pytest.mark.parametrize("kind", FALLING)
@pytest.mark.parametrize(
    ("options", "share"),
    [({}, 0.0), ({"impact": "conserving"}, 1.0), ({"restitution": 0.6}, 0.6)],
    ids=["dissipative", "conserving", "0.6"],
)
def test_restitution_does_not_depend_on_where_in_the_step_the_impact_falls(
    kind: str, options: dict[str, Any], share: float
) -> None:
    for height in (0.1, 0.101, 0.103, 0.105, 0.109):
        left, result = drop(kind, height, **options)
        assert left == pytest.approx(share, abs=1e-12)
        kinetic, work = result.ledger["kinetic"], result.ledger["work_contact"][-1]
        assert work == pytest.approx((share**2 - 1) * kinetic[0], abs=1e-12 * kinetic[0])
        assert np.diff(result.ledger["total"]).max() < 1e-13 * kinetic[0]
        result.assert_conserved("energy", tolerance=1e-12)


@pytest.mark.parametrize("scheme", [vv.Midpoint(), vv.VariationalMidpoint(), vv.BackwardEuler()])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_restitution_with_other_schemes(scheme: vv.Scheme, share: float) -> None:
    assert drop("ball", 0.1037, scheme=scheme, restitution=share)[0] == pytest.approx(share, abs=1e-12)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.VariationalMidpoint(), vv.BackwardEuler()]
)
@pytest.mark.parametrize("kind", FALLING)
def test_every_scheme_books_an_impact_as_the_loss_of_contact(
    kind: str, scheme: vv.Scheme, share: float, friction: float
) -> None:
    """(1 - e^2) of the kinetic energy; backward Euler once booked a gain, and lost three times as much itself."""
    _, result = drop(kind, 0.1037, scheme=scheme, restitution=share, friction=friction)
    ledger, start = result.ledger, result.ledger.first("kinetic")
    assert ledger.last("work_contact") == pytest.approx((share**2 - 1) * start, abs=1e-12 * start)
    assert ledger.size("imbalance") < 1e-12 * start


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_what_backward_euler_loses_beside_impacts_is_never_a_gain(share: float, friction: float) -> None:
    """Of a spinning ball that falls and bounces. What smooth balls lose by impacts is that of the conserving scheme to
    first order; those that rub leave with another spin there."""

    def bounced(scheme: vv.Scheme, h: float) -> Any:
        ball = vv.RigidBody(
            shape=vv.Sphere(radius=0.1),
            density=1e3,
            position=(0, 0, 0.2037),
            velocity=(1, 0.5, -1),
            angular_velocity=(3, 4, 5),
        )
        plane = vv.Plane()
        contact = vv.Contact(first=ball, second=plane, stiffness=1e5, restitution=share, friction=friction)
        system = vv.System([ball, plane, contact, vv.Gravity()])
        return vv.simulate(system, until=0.25, step=h, scheme=scheme)

    exact = bounced(vv.EnergyMomentum(), 1e-4).ledger
    start = exact.first("kinetic")
    for h in (4e-3, 1e-3):
        result = bounced(vv.BackwardEuler(), h)
        ledger = result.ledger
        assert np.diff(ledger["imbalance"]).max() < 1e-11 * start
        assert "dissipated by the scheme" in result.audit()
        if friction:
            assert np.diff(ledger["work_friction"]).max() < 1e-12 * start
        else:
            assert abs(ledger.last("work_contact") - exact.last("work_contact")) < 20 * h * start


def test_impact_through_a_joint_is_booked_whole() -> None:
    """One of two balls on a rod hits: e v is the point's new velocity, and 3/4 of J^2 / m_eff / 2 is lost."""
    for scheme in (vv.EnergyMomentum(), vv.BackwardEuler()):
        low, high = (
            vv.PointMass(mass=1.0, position=(0, 0, z), velocity=(0, 0, -1)) for z in (0.1037, 0.6037)
        )
        rod, plane = vv.Distance(a=low.point(), b=high.point()), vv.Plane()
        other = vv.PointMass(mass=3.0, position=(5, 0, 0), velocity=(0, 1, 0))
        contact = vv.Contact(first=low, second=plane, stiffness=1e5, restitution=0.5)
        system = vv.System([low, high, rod, plane, other, contact])
        ledger = vv.simulate(system, until=0.2, step=0.01, scheme=scheme).ledger
        assert ledger.last("work_contact") == pytest.approx(-0.75, abs=1e-12)
        assert ledger.size("imbalance") < 1e-12


@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler()])
@pytest.mark.parametrize("impact", ["dissipative", "conserving"])
@pytest.mark.parametrize(("depth", "speed"), [(0.001, 0.0), (0.001, 1.0), (0.0, 1.0), (-0.02, 1.0)])
def test_bodies_that_are_pressed_out_do_not_keep_their_closing_speed(
    depth: float, speed: float, impact: Any, scheme: vv.Scheme
) -> None:
    """The overlap is pushed out with what that takes; what is left of the closing speed is for `impact` to say."""
    h, plane = 0.01, vv.Plane()
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.1), density=1e3, position=(0, 0, 0.1 - depth), velocity=(0, 0, -speed)
    )
    contact = vv.Contact(first=ball, second=plane, stiffness=1e5, initial="press", impact=impact)
    system = vv.System([ball, plane, contact])
    vv.simulate(system, until=0.08, step=h, scheme=scheme)
    pushed = max(depth, 0.0) / h * (1 if scheme == vv.BackwardEuler() else 2)
    assert system.v[2] == pytest.approx(pushed + (speed if impact == "conserving" else 0.0), abs=1e-12)


def test_bouncing_point_loses_its_height_as_the_formula_says() -> None:
    """From height 1 with restitution 0.8: sqrt(2 / g), then flights of 2 0.8^k times that; in the end it rests."""
    point, plane = vv.PointMass(mass=1.0, position=(0, 0, 1)), vv.Plane()
    contact = vv.Contact(first=point, second=plane, stiffness=1e5, restitution=0.8)
    system = vv.System([point, plane, contact, vv.Gravity()])
    bounces, falls = [], [False]

    def observe(s: vv.System) -> None:
        if s.v[2] > 0 and falls[0]:
            bounces.append(s.time)
        falls[0] = bool(s.v[2] < 0)

    result = vv.simulate(system, until=4.5, step=0.001, observe=observe)
    flights = np.cumsum([1, *(2 * 0.8**k for k in range(1, 6))]) * np.sqrt(2 / G)
    assert bounces[:6] == pytest.approx(flights, abs=6 * 0.002)
    assert abs(system.v[2]) < 1e-4
    assert abs(system.x[2]) < 1e-3
    result.assert_conserved("energy", tolerance=1e-12)
    assert np.diff(result.ledger["total"]).max() < 1e-13


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_oblique_impact_rubs_by_its_impulse(share: float) -> None:
    """While it slides, friction takes mu (1 + e) times the velocity of approach from that along the plane."""
    ball = vv.RigidBody(
        shape=vv.Sphere(radius=0.05), density=1e3, position=(0, 0, 0.1533), velocity=(1, 0, -1)
    )
    plane = vv.Plane()
    contact = vv.Contact(first=ball, second=plane, stiffness=1e5, friction=0.1, restitution=share)
    system = vv.System([ball, plane, contact])
    result = vv.simulate(system, until=0.3, step=0.0025)
    assert system.v[:3] == pytest.approx([1 - 0.1 * (1 + share), 0, share], abs=1e-6)
    result.assert_conserved("energy", tolerance=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_balls_off_centre(share: float) -> None:
    """Of equal balls the one at rest gets (1 + e) / 2 of the velocity along their line at the impact, and all
    momenta stay. The line turns while they close within a step: first order."""
    errors = []
    for h in (1e-3, 2.5e-4):
        one, two = (
            vv.RigidBody(shape=vv.Sphere(radius=0.05), density=2e3, position=place, velocity=(v, 0, 0))
            for place, v in (((-0.2013, 0.06, 0), 2.0), ((0, 0, 0), 0.0))
        )
        contact = vv.Contact(
            first=one, second=two, formulation="node-to-segment", stiffness=1e6, restitution=share
        )
        system = vv.System([one, two, contact])
        result = vv.simulate(system, until=0.2, step=h)
        result.assert_conserved("energy", "momentum_x", "momentum_y", "angular_z", tolerance=1e-11)
        start = system.field(two, "configuration").start
        expected = (1 + share) / 2 * 1.6 * np.array([0.8, -0.6, 0])
        errors.append(np.abs(system.v[start : start + 3] - expected).max())
    assert errors[0] < 0.05
    assert errors[1] < 0.4 * errors[0]


def test_tilted_rod_slaps_down_and_rests() -> None:
    """First one end hits, then the other lands, while the first may lift; energy never grows."""
    turn = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
    rod = vv.RigidBody(
        shape=vv.Box(size=(1, 0.1, 0.1)),
        density=1e3,
        position=(0, 0, 0.5),
        velocity=(0, 0, -1),
        rotation=turn,
    )
    plane = vv.Plane()
    contact = vv.Contact(first=rod, second=plane, stiffness=1e5)
    system = vv.System([rod, plane, contact, vv.Gravity()])
    result = vv.simulate(system, until=2.0, step=0.001)
    total = result.ledger["total"]
    assert np.diff(total).max() < 1e-12 * total[0]
    assert system.x[2] == pytest.approx(0.05, abs=5 * 0.001)
    assert abs(system.v[2]) < 2e-3
    result.assert_conserved("energy", tolerance=1e-11)


@pytest.mark.parametrize("start", [0.5, 0.55, 0.475, 0.525, 0.50001])
@pytest.mark.parametrize("cells", [2, 4])
def test_point_does_not_pass_a_plate_in_steps_of_twice_its_thickness(start: float, cells: int) -> None:
    """Nor if a step ends on a face of the plate, from 0 to -0.05, or in its middle."""
    mesh = vv.BoxMesh(size=(0.05, 1, 1), counts=(1, cells, cells), origin=(-0.05, -0.5, -0.5))
    plate = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.3), density=1e3)
    point = vv.PointMass(mass=1e-3, position=(start, 0.013, 0.021), velocity=(-5, 0, 0))
    contact = vv.Contact(
        first=point, second=plate, formulation="node-to-segment", impact="conserving", stiffness=1e5
    )
    system = vv.System([plate, point, contact])
    result = vv.simulate(system, until=0.3, step=0.02)
    assert system.value(point.point().position)[0] > 0
    result.assert_conserved("energy", "momentum_x", tolerance=1e-10)


# --- redundant pressures ------------------------------------------------------------------------------------
@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_four_corners_of_a_box_carry_its_weight(enforcement: str, friction: float) -> None:
    """Three corners would do: pressures of the fourth are redundant, and so are most tractions of friction."""
    box, plane = vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=2.0, position=(0, 0, 0.5)), vv.Plane()
    ground = vv.Ground()
    hold = vv.Bushing(a=ground, b=box, at=(0, 0, 0.5), stiffness=(5, 7, 0), rotational_stiffness=(0, 0, 1))
    more: dict[str, Any] = {"tangential_stiffness": 1e3} if friction else {}
    contact = vv.Contact(
        first=box, second=plane, stiffness=1e3, enforcement=enforcement, friction=friction, **more
    )
    system = vv.System([box, plane, ground, hold, contact, vv.Gravity()])
    vv.quasi_static(system, until=1.0, step=1.0)
    assert vv.ContactForce(contact=contact)(system) == pytest.approx([0, 0, 2 * G], abs=1e-6)
    if enforcement == "multipliers":
        assert contact.pressures[contact.pressures > 0] == pytest.approx(np.full(4, G / 2), rel=1e-6)


def test_box_slides_on_four_corners() -> None:
    """It loses mu g of its speed, and keeps its height to rounding."""
    box = vv.RigidBody(shape=vv.Box(size=(1, 1, 0.2)), density=1.0, position=(0, 0, 0.1), velocity=(3, 0, 0))
    plane = vv.Plane()
    contact = vv.Contact(first=box, second=plane, stiffness=1e3, friction=0.2)
    system = vv.System([box, plane, contact, vv.Gravity()])
    result = vv.simulate(system, until=0.5, step=0.01)
    assert system.v[0] == pytest.approx(3 - 0.2 * G * 0.5, rel=1e-9)
    assert system.x[2] == pytest.approx(0.1, abs=1e-12)
    result.assert_conserved("energy", tolerance=1e-11)


def test_capsule_rolls_down_without_slip() -> None:
    """Both of its ends stick, with one traction along the axis too many: g sin / (1 + k^2 / R^2)."""
    angle, R = np.radians(20), 0.2
    capsule = vv.RigidBody(
        shape=vv.Capsule(radius=R, length=0.3),
        density=1e3,
        position=(0, 0, R),
        rotation=((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    )
    plane = vv.Plane()
    contact = vv.Contact(first=capsule, second=plane, stiffness=1e6, friction=0.5)
    gravity = vv.Gravity(acceleration=(G * np.sin(angle), 0, -G * np.cos(angle)))
    system = vv.System([capsule, plane, contact, gravity])
    vv.simulate(system, until=1.0, step=0.002)
    mass = capsule.mass_properties()
    k = mass.inertia[2, 2] / mass.mass / R**2
    assert system.x[0] == pytest.approx(0.5 * G * np.sin(angle) / (1 + k), rel=2e-3)


def belt(n: int, tangential: str) -> float:
    """Force at the pulled end of a belt over a quarter of a drum by that at the held end."""
    unit = vv.RectangleMesh(size=(1, 1), counts=(n, 1), cell="quad8").build()
    angle, radius = unit.points[:, 0] * np.pi / 2, 1.0 + 0.02 * unit.points[:, 1]
    points = np.column_stack([radius * np.sin(angle), radius * np.cos(angle)])
    strip = vv.Solid(
        mesh=vv.Mesh(points, unit.cells, unit.node_sets, unit.face_sets),
        material=vv.SaintVenantKirchhoff(young=1e4, poisson=0.0),
        plane="stress",
    )
    drum = vv.Obstacle(shape=vv.Cylinder(radius=1.0, length=1.0))
    more: dict[str, Any] = {"tangential_stiffness": 1e6} if tangential == "penalty" else {}
    contact = vv.Contact(
        first=strip, first_faces="y0", second=drum, friction=0.3, tangential=tangential, **more
    )
    pull = vv.Traction(solid=strip, faces="x1", traction=(0, -50.0, 0), times="t")
    hold = vv.Fixed(solid=strip, nodes="x0", directions=(1, 0, 0))
    system = vv.System([strip, drum, contact, pull, hold])
    vv.quasi_static(system, until=1.0, step=0.1)
    held = -vv.SupportForce(solid=strip, nodes="x0")(system)[0]
    return float(1.0 / held)


def test_belt_on_a_drum_whose_held_end_sticks() -> None:
    """Euler's exp(mu pi / 2): a node that the support holds along the drum sticks as well, from no load on."""
    ratios = [belt(n, "multipliers") for n in (10, 20, 40)]
    errors = np.abs(np.array(ratios) / np.exp(0.3 * np.pi / 2) - 1)
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.012
    assert ratios[1] == pytest.approx(belt(20, "penalty"), rel=1e-6)


def evenly_meshed(R: float, length: float, rings: int) -> vv.SurfaceMesh:
    """A cylinder whose flat faces have vertices of equal shares of their area, 6 k on the k-th ring."""
    angles = [2 * np.pi * np.arange(6 * k) / (6 * k) for k in range(1, rings + 1)]
    flat = np.vstack(
        [(0, 0), *(k / rings * R * np.column_stack([np.cos(a), np.sin(a)]) for k, a in enumerate(angles, 1))]
    )
    n, rim = len(flat), 6 * rings
    points = np.vstack([np.column_stack([flat, np.full(n, z)]) for z in (-length / 2, length / 2)])
    top = Delaunay(flat).simplices
    a, b = np.arange(n - rim, n), np.roll(np.arange(n - rim, n), -1)
    side = np.vstack([np.column_stack([a, b, b + n]), np.column_stack([a, b + n, a + n])])
    return vv.SurfaceMesh(points=points, triangles=np.vstack([top[:, ::-1], top + n, side]))


@pytest.mark.parametrize(
    ("shape", "torque", "tolerance"),
    [
        (vv.Cylinder(radius=0.2, length=0.1), 32 / 33, 0.01),
        (evenly_meshed(0.2, 0.1, 16), 2 / 3, 0.05),
    ],
    ids=["cylinder", "evenly meshed"],
)
def test_spinning_disc_rubs_at_its_vertices(shape: Any, torque: float, tolerance: float) -> None:
    """Of a uniform pressure friction has the torque 2/3 mu M g R; a cylinder has vertices on its rims, and one in the
    middle of each face."""
    R, mu, k = 0.2, 0.2, 1e4
    disc = vv.RigidBody(shape=shape, density=1e3, angular_velocity=(0, 0, 10))
    mass, spin = disc.mass_properties().mass, disc.mass_properties().inertia[2, 2]
    n = int(np.sum(np.isclose(shape.surface()[0][:, 2], -0.05)))
    disc = vv.RigidBody(
        shape=shape, density=1e3, position=(0, 0, 0.05 - mass * G / n / k), angular_velocity=(0, 0, 10)
    )
    plane = vv.Plane()
    contact = vv.Contact(
        first=disc,
        second=plane,
        enforcement="penalty",
        stiffness=k,
        friction=mu,
        tangential="penalty",
        tangential_stiffness=1e5,
        initial="press",
    )
    system = vv.System([disc, plane, contact, vv.Gravity()])
    result = vv.simulate(system, until=0.1, step=0.002)
    lost = 10 - result.ledger["angular_z"][-1] / spin
    assert lost == pytest.approx(torque * mu * mass * G * R / spin * 0.1, rel=tolerance)


# --- what is refused ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("scheme", [vv.GeneralizedAlpha(0.8), vv.BDF2()])
def test_schemes_that_remember_accelerations_are_refused(scheme: vv.Scheme) -> None:
    """An impact by multipliers gave energy to bodies, more with shorter steps."""
    with pytest.raises(
        vv.InputError, match=r"remembers accelerations.*EnergyMomentum.*enforcement='penalty'"
    ):
        drop("ball", 0.1, scheme=scheme)
    drop("ball", 0.1, h=0.001, scheme=scheme, enforcement="penalty")


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"restitution": 1.2}, "restitution = 1.2 is not a share"),
        ({"restitution": -0.1}, "restitution = -0.1 is not a share"),
        ({"restitution": 0.5, "enforcement": "penalty"}, r"needs enforcement='multipliers'.*damping"),
        ({"restitution": 0.5, "initial": "press"}, "pushes out what an impact leaves"),
        ({"restitution": 0.5, "impact": "conserving"}, "leave one of them out"),
    ],
)
def test_restitution_that_says_nothing_is_refused(options: dict[str, Any], match: str) -> None:
    with pytest.raises(vv.InputError, match=match):
        vv.Contact(first=FALLING["ball"](0.1), second=vv.Plane(), stiffness=1e5, **options)


def test_restitution_of_solids_is_refused() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=100.0, poisson=0.3),
        density=1.0,
    )
    with pytest.raises(vv.InputError, match="is a solid, whose waves take"):
        vv.Contact(first=block, second=vv.Plane(), restitution=0.5)


@pytest.mark.parametrize("end", [0.1, 0.3, 0.52])
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("kind", FALLING)
def test_runs_are_resumed_to_the_bit(kind: str, friction: float, end: float, tmp_path: Path) -> None:
    """Before, in and after impacts."""

    def study(until: float) -> vv.Study:
        body, plane = FALLING[kind](0.2), vv.Plane()
        contact = vv.Contact(first=body, second=plane, stiffness=1e4, restitution=0.5, friction=friction)
        return vv.Study(vv.System([body, plane, contact, vv.Gravity()]), until, 0.01)

    whole = run(study(0.6), tmp_path / "whole", pictures=False)
    run(study(end), tmp_path / "parts", pictures=False)
    parts = run(study(0.6), tmp_path / "parts", resume=True, pictures=False)
    for name in ("x", "v"):
        np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("kind", FALLING)
def test_adaptive_steps_bound_what_impacts_overlap(kind: str, tolerance: float) -> None:
    """Bodies from a tenth of a metre over the floor went as deep into it as the longest step in flight took them."""
    body, plane = FALLING[kind](0.1), vv.Plane()
    contact = vv.Contact(first=body, second=plane, stiffness=1e4, restitution=0.5)
    system = vv.System([body, plane, contact, vv.Gravity()])
    ground = system.x[2] - 0.1
    length = system.model.length
    result = vv.simulate(system, until=0.2, step=0.001, adaptive=vv.Adaptive(tolerance=tolerance))
    assert min(x[2] for x in result.states) > ground - tolerance * length
    fast = np.sqrt(1 + 2 * G * 0.1)
    left = 0.2 - (fast - 1) / G
    there = ground + 0.5 * fast * left - 0.5 * G * left**2
    assert system.x[2] == pytest.approx(there, abs=30 * tolerance * length)
    assert result.statistics.steps < 60


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_stiffness_of_multipliers_between_rigid_bodies_changes_nothing(friction: float) -> None:
    """The way of Newton's method followed it: for 1e10 a pile of boxes that rub found no solution."""

    def fallen(stiffness: float) -> Any:
        floor = vv.RigidBody(shape=vv.Box(size=(2, 2, 0.4)), density=1e3, position=(0, 0, -0.2))
        boxes = [
            vv.RigidBody(
                shape=vv.Box(size=(width, width, 0.2)),
                density=1e3,
                position=(0.03 * i, 0.02 * i, 0.12 + 0.25 * i),
            )
            for i, width in enumerate((0.2, 0.12))  # with all vertices above what it lands on
        ]
        ground = vv.Ground()
        contacts = [
            vv.Contact(
                first=a, second=b, stiffness=stiffness, friction=friction, formulation="node-to-segment"
            )
            for a, b in ((boxes[0], floor), (boxes[1], boxes[0]))
        ]
        weld = vv.Rigid(a=ground, b=floor, at=(0, 0, 0))
        system = vv.System([ground, floor, weld, *boxes, *contacts, vv.Gravity()])
        vv.simulate(system, until=0.4, step=0.01)
        return system.x.copy()

    np.testing.assert_array_equal(fallen(1e10), fallen(1.0))
