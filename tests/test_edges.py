"""Edges of rigid bodies that cross touch each other: impacts, rest and friction in closed form, exact balances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from test_tangents import differences

import visviva as vv
from visviva.study.run import run

Array = NDArray[np.float64]
ALL = ("energy", *(f"{what}_{axis}" for what in ("momentum", "angular") for axis in "xyz"))
STIFFNESS = 1e6
G = 9.81


def turned(axis: Any, angle: float) -> Array:
    """Rotation about an axis of space."""
    n = np.array(axis, dtype=float) / np.linalg.norm(axis)
    K = np.cross(np.eye(3), n)
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)


def roof(
    size: float, along: float, peak: float, shift: tuple[float, float] = (0, 0), up: float = 1, **more: Any
) -> vv.RigidBody:
    """A cube on one of its edges, which is at the height `peak`: the highest, or the lowest with `up` = -1.

    `along` is the angle of that edge to the first axis.
    """
    R = turned((0, 0, 1), along) @ turned((1, 0, 0), np.pi / 4)
    place = (*shift, peak - up * size * np.sqrt(0.5))
    given: dict[str, Any] = {"density": 1e3} | more
    return vv.RigidBody(shape=vv.Box(size=(size,) * 3), position=place, rotation=R, **given)


def crossed(angle: float, shift: tuple[float, float], **options: Any) -> tuple[vv.System, Any, Any, Any]:
    """A cube that falls with an edge on that of another one, at this angle; where they cross is the origin."""
    lower = roof(0.3, 0.0, 0.0)
    upper = roof(0.2, angle, 0.0015, shift, -1, velocity=(0, 0, -2))
    contact = vv.Contact(first=upper, second=lower, stiffness=STIFFNESS, **options)
    return vv.System([lower, upper, contact]), upper, lower, contact


@pytest.mark.parametrize("angle", [90, 40, 20])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_an_impact_edge_on_edge_is_that_of_two_bodies(angle: float, share: float) -> None:
    """Newton's restitution at one point, with the normal across both edges: masses 27 and 8, inertia of cubes.

    The upper one has its centre 2 cm beside the crossing.
    """
    a = np.radians(angle)
    system, upper, _, _ = crossed(a, (0.0, 0.02), restitution=share)
    # the edges are y = 0 and that through (0, 0.02) at the angle
    arm = np.array([-0.02 / np.tan(a), -0.02, 0])
    give = 1 / 27 + 1 / 8 + (arm @ arm) / (8 * 0.04 / 6)
    give += (arm[0] ** 2) / (27 * 0.09 / 6)
    impulse = (1 + share) * 2 / give
    result = vv.simulate(system, until=0.0008, step=1e-5)
    assert vv.Velocity(of=upper)(system) == pytest.approx([0, 0, -2 + impulse / 8], abs=1e-3)
    spin = impulse / (8 * 0.04 / 6) * np.array([arm[1], -arm[0], 0])
    assert vv.AngularVelocity(of=upper)(system) == pytest.approx(spin, abs=1e-3 * np.linalg.norm(spin))
    result.assert_conserved(*ALL, tolerance=1e-10)


@pytest.mark.parametrize("angle", [90, 35, 10])
@pytest.mark.parametrize("options", [{"impact": "conserving"}, {"enforcement": "penalty"}])
def test_conserving_impacts_of_edges_keep_energy_and_momenta(angle: float, options: Any) -> None:
    """Kinetic energy, which nothing else takes: 16 J of the upper cube."""
    system, upper, _, _ = crossed(np.radians(angle), (0.005, 0.01), **options)
    result = vv.simulate(system, until=0.05, step=5e-4)
    result.assert_conserved(*ALL, tolerance=1e-11)
    assert result.ledger["kinetic"][-1] == pytest.approx(16, rel=1e-11)
    assert vv.Velocity(of=upper)(system)[2] > -1
    assert np.linalg.norm(vv.AngularVelocity(of=upper)(system)) > 1


def bars(height: float, **options: Any) -> tuple[list[Any], Any, Any]:
    """A bar across another one that is held, and their contact."""
    ground = vv.Ground()
    lower, upper = (
        vv.RigidBody(shape=vv.Box(size=size), density=1000.0, position=(0, 0, z))
        for size, z in (((1, 0.1, 0.1), 0.0), ((0.1, 1, 0.1), height))
    )
    contact = vv.Contact(first=upper, second=lower, stiffness=STIFFNESS, **options)
    return [ground, lower, upper, vv.Rigid(a=ground, b=lower, at=(0, 0, 0)), contact], upper, contact


@pytest.mark.parametrize("step", [0.002, 0.005])
def test_a_bar_that_falls_across_another_comes_to_rest(step: float) -> None:
    """The force is its weight, and it lies as deep as the last step before the impact came."""
    parts, upper, contact = bars(0.12)
    system = vv.System([*parts, vv.Gravity()])
    result = vv.simulate(system, until=0.5, step=step)
    assert vv.ContactForce(contact=contact)(system) == pytest.approx([0, 0, 10 * G], rel=1e-9, abs=1e-9)
    fall = np.sqrt(2 * G * 0.02) + G * step
    place = vv.Position(of=upper)(system)
    assert place == pytest.approx([0, 0, 0.1], abs=1.5 * fall * step)
    assert place[:2] == pytest.approx([0, 0], abs=1e-12)
    assert np.abs(system.v).max() < 1e-9
    result.assert_conserved("energy", tolerance=1e-10)


def test_a_bar_rests_on_another_on_springs_of_penalty() -> None:
    """In statics four edges cross, each a spring: 98.1 N sink by 98.1 / 4 k."""
    parts, upper, contact = bars(0.1, enforcement="penalty")
    guide = vv.Prismatic(a=parts[0], b=upper, at=(0, 0, 0.1), axis=(0, 0, 1))
    system = vv.System([*parts, guide, vv.Gravity()])
    vv.quasi_static(system, until=1.0, step=0.25)
    assert vv.ContactForce(contact=contact)(system)[2] == pytest.approx(10 * G, rel=1e-8)
    assert vv.Position(of=upper)(system)[2] == pytest.approx(0.1 - 10 * G / (4 * STIFFNESS), rel=1e-9)


def test_a_bar_rests_on_another_in_statics() -> None:
    """By multipliers nothing sinks."""
    parts, upper, contact = bars(0.1)
    guide = vv.Prismatic(a=parts[0], b=upper, at=(0, 0, 0.1), axis=(0, 0, 1))
    system = vv.System([*parts, guide, vv.Gravity()])
    vv.quasi_static(system, until=1.0, step=0.25)
    assert vv.ContactForce(contact=contact)(system) == pytest.approx([0, 0, 10 * G], rel=1e-9, abs=1e-7)
    assert vv.Position(of=upper)(system) == pytest.approx([0, 0, 0.1], abs=1e-10)


def test_edges_that_overlap_at_the_start_are_refused() -> None:
    parts, _, _ = bars(0.098)
    with pytest.raises(vv.InputError, match=r"edges or corners of .* overlap by 0.002"):
        vv.simulate(vv.System(parts), until=0.1, step=0.002)


PENALTY = {"enforcement": "penalty"}
STUCK = {"friction": 0.9, "tangential": "penalty", "tangential_stiffness": 5.0}
WAYS = {
    "penalty": PENALTY,
    "multipliers": {},
    "penalty, sticking": PENALTY | STUCK,
    "penalty, slipping": PENALTY | STUCK | {"friction": 0.05},
    "multipliers, friction": {"friction": 0.3},
}


@pytest.mark.parametrize("name", WAYS)
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler(), vv.VariationalMidpoint()])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_tangents_at_random_states_of_pressed_edges(name: str, scheme: vv.Scheme, seed: int) -> None:
    rng = np.random.default_rng(seed)
    lower = roof(0.3, rng.uniform(0, 1), 0.0, density=1.0)
    shift = tuple(rng.uniform(-0.02, 0.02, 2))
    upper = roof(0.2, rng.uniform(1.4, 2.5), -0.005, shift, -1, density=1.0)
    options = WAYS[name]
    contact = vv.Contact(first=upper, second=lower, stiffness=50.0, initial="press", **options)
    system = vv.System([lower, upper, contact])
    n, core = len(system.order), system.core
    core.dx[:n] = 1e-3 * rng.standard_normal(n) * (system.order == 2) + 0.1 * (system.order == 0)
    place = upper.point().position[0].weights[0][0]
    core.dx[place : place + 2] += 0.005  # so that slips are large beside the differences
    core.v[:n] = 0.1 * rng.standard_normal(n) * (system.order == 2)
    system.invalidate()
    step = scheme.step(0.0, 0.01)
    _, K = system.tangent(step)
    assert contact.forces[:, 2].sum() != 0 or contact._edges.term.pressures.max() > 0
    error = K.toarray() - differences(system, step, system.free_unknowns)
    assert np.abs(error).max() < 1e-7 * np.abs(K).max()


@pytest.mark.parametrize("friction", [0.1, 0.3])
@pytest.mark.parametrize("options", [{}, PENALTY, PENALTY | STUCK])
def test_a_bar_across_a_tilted_one_slides_or_sticks(friction: float, options: Any) -> None:
    """Along the lower bar, which falls off by 0.2: with g (sin a - mu cos a), or not at all."""
    tilt, until = 0.2, 0.4
    R = turned((0, 1, 0), tilt)
    ground = vv.Ground()
    lower, upper = (
        vv.RigidBody(shape=vv.Box(size=size), density=1000.0, position=R @ place, rotation=R)
        for size, place in (
            ((1, 0.1, 0.1), np.zeros(3)),
            ((0.1, 1, 0.1), np.array([-0.3, 0, 0.1])),
        )
    )
    given: dict[str, Any] = options | {"friction": friction}
    if "tangential_stiffness" in options:
        given["tangential_stiffness"] = 1e7
    contact = vv.Contact(first=upper, second=lower, stiffness=1e7, **given)
    held = vv.Rigid(a=ground, b=lower, at=(0, 0, 0))
    system = vv.System([ground, lower, upper, held, contact, vv.Gravity()])
    vv.simulate(system, until=until, step=0.002)
    gone = R.T @ vv.Position(of=upper)(system) - [-0.3, 0, 0.1]
    way = max(0.5 * G * (np.sin(tilt) - friction * np.cos(tilt)) * until**2, 0.0)
    assert gone[0] == pytest.approx(way, rel=2e-3, abs=3e-4)
    assert np.abs(gone[1:]).max() < 1e-4
    if "enforcement" in options:  # on whose springs it rocks
        return
    force = vv.ContactForce(contact=contact)(system)
    share = min(friction, np.tan(tilt))
    assert R.T @ force == pytest.approx(np.cos(tilt) * 10 * G * np.array([-share, 0, 1]), rel=0.02, abs=0.2)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_corner_of_the_second_body_in_a_face_of_the_first(share: float) -> None:
    """Newton's impact of a cube of 64 kg that stands on its corner, and a plate on that: both ways from the centre."""
    R = turned((1, 0, 0), np.arctan(np.sqrt(0.5))) @ turned((0, 1, 0), np.pi / 4)
    cube = vv.RigidBody(
        shape=vv.Box(size=(0.4,) * 3), density=1e3, position=(0, 0, -0.2 * np.sqrt(3)), rotation=R
    )
    plate = vv.RigidBody(
        shape=vv.Box(size=(0.3, 0.3, 0.1)), density=1e3, position=(0.05, 0, 0.0515), velocity=(0, 0, -2)
    )
    contact = vv.Contact(first=plate, second=cube, stiffness=STIFFNESS, restitution=share)
    system = vv.System([plate, cube, contact])
    result = vv.simulate(system, until=0.001, step=1e-5)
    impulse = (1 + share) * 2 / (1 / 9 + 1 / 64 + 0.05**2 / (9 * (0.3**2 + 0.1**2) / 12))
    assert vv.Velocity(of=plate)(system)[2] == pytest.approx(-2 + impulse / 9, abs=1e-3)
    assert vv.Velocity(of=cube)(system)[2] == pytest.approx(-impulse / 64, abs=1e-3)
    spin = 0.05 * impulse / (9 * (0.3**2 + 0.1**2) / 12)
    assert vv.AngularVelocity(of=plate)(system) == pytest.approx([0, spin, 0], abs=1e-3 * spin)
    result.assert_conserved(*ALL, tolerance=1e-10)


def test_a_box_shifted_on_another_rests_flat() -> None:
    """Corners of what both faces have in common: one of the upper box, one of the lower, and two crossings of edges."""
    lower = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 0.2)), density=1e3, position=(0, 0, 0.1))
    upper = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 0.2)), density=1e3, position=(0.12, 0.08, 0.3))
    floor = vv.Plane()
    contacts = [
        vv.Contact(first=a, second=b, stiffness=STIFFNESS) for a, b in ((lower, floor), (upper, lower))
    ]
    system = vv.System([floor, lower, upper, *contacts, vv.Gravity()])
    vv.simulate(system, until=0.5, step=0.005)
    assert vv.Position(of=upper)(system) == pytest.approx([0.12, 0.08, 0.3], abs=1e-9)
    assert vv.ContactForce(contact=contacts[1])(system) == pytest.approx([0, 0, 32 * G], abs=1e-6)
    assert contacts[1].pressures.max() < 31 * G


def tumbling(seed: int, **options: Any) -> vv.System:
    """Three boxes thrown together, turned and spinning at random."""
    rng = np.random.default_rng(seed)
    bodies: list[Any] = []
    for k in range(3):
        Q = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        way = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0.2 * rng.standard_normal()])
        bodies.append(
            vv.RigidBody(
                shape=vv.Box(size=(0.2, 0.25, 0.3)),
                density=1e3,
                position=0.4 * way,
                rotation=Q * np.linalg.det(Q),
                velocity=-1.5 * way,
                angular_velocity=3 * rng.standard_normal(3),
            )
        )
    pairs = ((0, 1), (1, 2), (0, 2))
    contacts = [
        vv.Contact(first=bodies[i], second=bodies[j], stiffness=STIFFNESS, **options) for i, j in pairs
    ]
    return vv.System([*bodies, *contacts])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "options", [{"impact": "conserving"}, {}, {"restitution": 0.5, "friction": 0.3}, PENALTY]
)
def test_boxes_thrown_together_tumble_and_never_gain_energy(seed: int, options: Any) -> None:
    system = tumbling(seed, **options)
    result = vv.simulate(system, until=0.4, step=1e-3)
    energy = result.ledger["total"]
    assert np.diff(energy).max() < 1e-11 * energy[0]
    result.assert_conserved(*ALL, tolerance=1e-9)
    lost = 1 - energy[-1] / energy[0]
    assert abs(lost) < 1e-11 if "impact" in options or "enforcement" in options else lost > 0.3


@pytest.mark.parametrize("end", [0.06, 0.075, 0.09])
@pytest.mark.parametrize("options", [{"restitution": 0.3, "friction": 0.2}, PENALTY | STUCK])
def test_runs_of_edges_are_resumed_to_the_bit(end: float, options: Any, tmp_path: Path) -> None:
    """Before, in and after the impact of a bar that falls askew across another one."""

    def study(until: float) -> vv.Study:
        parts, upper, _ = bars(0.12, **options)
        upper.angular_velocity = (0.4, 0.3, 0.2)
        return vv.Study(vv.System([*parts, vv.Gravity()]), until, 0.0015)

    whole = run(study(0.12), tmp_path / "whole", pictures=False)
    run(study(end), tmp_path / "parts", pictures=False)
    parts = run(study(0.12), tmp_path / "parts", resume=True, pictures=False)
    for name in ("x", "v"):
        np.testing.assert_array_equal(getattr(parts.system, name), getattr(whole.system, name))


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.02, 0.0), (0.02, 0.03)])
@pytest.mark.parametrize("drop", [0.0, 1e-4, 1e-3])
def test_equal_boxes_stand_on_each_other_flush_or_not(shift: tuple[float, float], drop: float) -> None:
    """Corners of the lower one lie at the border of the upper one's face where sides are flush: it tipped over."""
    cube, ground = vv.Box(size=(0.1, 0.1, 0.1)), vv.Ground()
    lower = vv.RigidBody(shape=cube, density=1e3, position=(0, 0, 0.05))
    upper = vv.RigidBody(shape=cube, density=1e3, position=(*shift, 0.15 + drop))
    contact = vv.Contact(first=upper, second=lower, stiffness=1e9)
    system = vv.System(
        [ground, lower, upper, vv.Rigid(a=ground, b=lower, at=(0, 0, 0)), contact, vv.Gravity()]
    )
    vv.simulate(system, until=0.2, step=2e-3)
    sunk = np.sqrt(2 * 9.81 * drop) * 2e-3 + 1e-9  # by what comes near in a step
    assert vv.Position(of=upper)(system) == pytest.approx([*shift, 0.15], abs=2 * sunk)
    assert vv.AngularVelocity(of=upper)(system) == pytest.approx([0, 0, 0], abs=1e-9)
    assert vv.ContactForce(contact=contact)(system)[2] == pytest.approx(9.81, rel=1e-9)


@pytest.mark.parametrize("exchanged", [False, True])
def test_a_flush_box_slides_by_coulomb(exchanged: bool) -> None:
    """It stops after v^2 / (2 mu g)."""
    cube, ground, speed, mu = vv.Box(size=(0.1, 0.1, 0.1)), vv.Ground(), 0.3, 0.3
    lower = vv.RigidBody(shape=cube, density=1e3, position=(0, 0, 0.05))
    upper = vv.RigidBody(shape=cube, density=1e3, position=(0.02, 0, 0.15), velocity=(0, speed, 0))
    pair = {"first": lower, "second": upper} if exchanged else {"first": upper, "second": lower}
    contact = vv.Contact(**pair, stiffness=1e9, friction=mu)
    clamp = vv.Rigid(a=ground, b=lower, at=(0, 0, 0))
    system = vv.System([ground, lower, upper, clamp, contact, vv.Gravity()])
    vv.simulate(system, until=0.2, step=5e-4)
    way = speed**2 / (2 * mu * 9.81)
    assert vv.Position(of=upper)(system)[1] == pytest.approx(way, rel=5e-3)


def comb(teeth: int) -> vv.SurfaceMesh:
    """Roofs with ridges at z = 0 along y, side by side on a plate."""
    x = np.linspace(-0.05 * teeth, 0.05 * teeth, 2 * teeth + 1)
    profile = [(c, -0.05 if k % 2 == 0 else 0.0) for k, c in enumerate(x)]
    base = [(c, -0.1) for c in x]
    points = [(c, y, z) for y in (-0.5, 0.5) for c, z in (*profile, *base)]
    n, half = len(x), 2 * len(x)
    cap = [t for k in range(n - 1) for t in ((k, n + k, n + k + 1), (k, n + k + 1, k + 1))]
    around = [*range(n), *range(half - 1, n - 1, -1)]
    sides = [(a, b) for a, b in zip(around, (*around[1:], around[0]), strict=True)]
    triangles = [*((a, b, c) for a, b, c in cap), *((c + half, b + half, a + half) for a, b, c in cap)]
    triangles += [t for a, b in sides for t in ((a, b, b + half), (a, b + half, a + half))]
    mesh = vv.SurfaceMesh(points=points, triangles=triangles)
    return mesh if mesh.volume > 0 else vv.SurfaceMesh(points=points, triangles=[t[::-1] for t in triangles])


def combs(teeth: int, height: float, **options: Any) -> tuple[list[Any], vv.RigidBody]:
    """One that lies across another, so high above it."""
    ground, shape = vv.Ground(), comb(teeth)
    lower = vv.RigidBody(shape=shape, density=1e3)
    over = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
    upper = vv.RigidBody(shape=shape, density=1e3, rotation=over, position=(0, 0, height))
    contact = vv.Contact(first=upper, second=lower, stiffness=1e6, **options)
    clamp = vv.Rigid(a=ground, b=lower, at=(0, 0, 0))
    return [ground, lower, upper, contact, clamp, vv.Gravity()], upper


@pytest.mark.parametrize("teeth", [1, 2, 4])
def test_ridges_that_cross_at_many_places_are_as_many_springs(teeth: int) -> None:
    """Of more than eight all but eight were left out, and 16 made energy."""
    parts, upper = combs(teeth, 0.0, enforcement="penalty")
    guide = vv.Prismatic(a=parts[0], b=upper, at=(0, 0, 0), axis=(0, 0, 1))
    system = vv.System([*parts, guide])
    before = vv.Position(of=upper)(system)[2]
    vv.quasi_static(system, until=1.0, step=0.25)
    sunk = before - vv.Position(of=upper)(system)[2]
    assert sunk == pytest.approx(9.81 * 1e3 * upper.shape.volume / (1e6 * teeth**2), rel=1e-6)


def test_ridges_that_cross_at_many_places_keep_their_energy() -> None:
    parts, _ = combs(4, 1e-4, enforcement="penalty")
    result = vv.simulate(vv.System(parts), until=0.1, step=1e-3)
    result.assert_conserved("energy", tolerance=1e-10)


def test_more_ridges_than_multipliers_hold_are_refused() -> None:
    parts, _ = combs(5, 1e-5)
    with pytest.raises(vv.StepFailure, match="meet at 25 places at once, of which 24 can be held"):
        vv.simulate(vv.System(parts), until=0.1, step=1e-3)


def test_ridges_that_lie_apart_are_as_many_as_they_like() -> None:
    """Places where nothing touches were counted: what crossed at more than 24 could not even fall."""
    parts, upper = combs(5, 0.03)
    system = vv.System(parts)
    vv.simulate(system, until=0.05, step=1e-3)
    assert vv.Velocity(of=upper)(system) == pytest.approx([0, 0, -G * 0.05], abs=1e-9)


def hull(points: Any) -> vv.SurfaceMesh:
    """The convex body of these points."""
    from scipy.spatial import ConvexHull

    places = np.array(points, dtype=float)
    found = ConvexHull(places)
    rows = [
        row if np.cross(*(places[row[1:]] - places[row[0]])) @ plane[:3] > 0 else row[::-1]
        for row, plane in zip(found.simplices, found.equations, strict=True)
    ]
    return vv.SurfaceMesh(points=points, triangles=[tuple(int(v) for v in row) for row in rows])


def test_edges_that_are_found_inside_store_no_energy() -> None:
    """An edge that slides past where it lay comes upon another one deep inside: a fifth of all energy came so."""
    wedge = hull([(x, y, 0) for x in (-0.3, 0.3) for y in (-0.2, 0.2)] + [(-0.3, 0, 0.2), (0.3, 0, 0.2)])
    pyramid = hull([(0.2, 0.2, 0), (-0.2, 0.2, 0), (-0.2, -0.2, 0), (0.2, -0.2, 0), (0, 0, 0.4)])
    axis = np.array([1e-3, 2e-3, -1e-3])
    first = vv.RigidBody(shape=pyramid, density=1.0)
    second = vv.RigidBody(
        shape=wedge,
        density=1.0,
        position=(0, -0.45, 0),
        rotation=turned(axis, float(np.linalg.norm(axis))),
        velocity=(0, 1, 0),
    )
    contact = vv.Contact(first=first, second=second, stiffness=50.0, enforcement="penalty")
    result = vv.simulate(vv.System([first, second, contact]), until=0.07, step=2e-3)
    result.assert_conserved("energy", tolerance=1e-10)


def test_multipliers_that_rub_by_a_penalty_leave_edges_alone() -> None:
    """Rounding chooses which of several gaps at one place presses, and what sticks by springs of these would creep."""
    parts, *_ = bars(0.12, friction=0.3, tangential="penalty", tangential_stiffness=1e7)
    with pytest.raises(vv.StepFailure, match=r"sink into each other.* leave out tangential='penalty'"):
        vv.simulate(vv.System([*parts, vv.Gravity()]), until=0.3, step=2e-3)


def test_what_sticks_on_two_plates_stays() -> None:
    """Pushed by 10 N below Coulomb's limit of 69 N it moves by what four springs of 1e5 N/m give."""
    ground = vv.Ground()
    plates = [
        vv.RigidBody(shape=vv.Box(size=(2, 0.4, 0.1)), density=1e3, position=(0, y, -0.05))
        for y in (-0.5, 0.5)
    ]
    bar = vv.RigidBody(shape=vv.Box(size=(0.1, 1, 0.1)), density=1e3, position=(0, 0, 0.05))
    rubs: dict[str, Any] = {"friction": 0.7, "tangential": "penalty", "tangential_stiffness": 1e5}
    contacts = [vv.Contact(first=bar, second=plate, stiffness=1e6, **rubs) for plate in plates]
    clamps = [vv.Rigid(a=ground, b=plate, at=(0, 0, 0)) for plate in plates]
    push = vv.Force(on=bar, at=(0, 0, 0), force=(10.0, 0, 0), times="min(t/0.2, 1)")
    system = vv.System([ground, *plates, bar, *clamps, *contacts, vv.Gravity(), push])
    vv.simulate(system, until=0.6, step=2e-3, scheme=vv.BackwardEuler())
    assert vv.Position(of=bar)(system)[0] == pytest.approx(10 / 4e5, rel=1e-6)


@pytest.mark.parametrize("pieces", [2, 10])
def test_edges_in_pieces_are_whole(pieces: int) -> None:
    """A bar slides along the ridge of another one and at first lies on a vertex of it: it sank at each, or fell."""
    ring, last = [(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)], 4 * pieces
    points = [(x, y, z) for x in np.linspace(-0.5, 0.5, pieces + 1) for y, z in ring]
    triangles = [(0, 2, 1), (0, 3, 2), (last, last + 1, last + 2), (last, last + 2, last + 3)]
    for k in range(pieces):
        for a, b in ((i, (i + 1) % 4) for i in range(4)):
            at = 4 * k
            triangles += [(at + a, at + b, at + 4 + b), (at + a, at + 4 + b, at + 4 + a)]
    lower_shape = vv.SurfaceMesh(points=points, triangles=triangles)
    assert lower_shape.volume == pytest.approx(0.01)
    heights = []
    for shape in (lower_shape, vv.Box(size=(1, 0.1, 0.1))):
        ground, high = vv.Ground(), 0.05 * np.sqrt(2)
        lower = vv.RigidBody(
            shape=shape, density=1e3, rotation=turned((1, 0, 0), np.pi / 4), position=(0, 0, -high)
        )
        upper = vv.RigidBody(
            shape=vv.Box(size=(0.1, 1, 0.1)),
            density=1e3,
            rotation=turned((0, 1, 0), np.pi / 4),
            position=(0, 0, high + 0.002),
            velocity=(0.3, 0, 0),
        )
        contact = vv.Contact(first=upper, second=lower, stiffness=1e6)
        clamp = vv.Rigid(a=ground, b=lower, at=(0, 0, 0))
        system = vv.System([ground, lower, upper, clamp, contact, vv.Gravity()])
        vv.simulate(system, until=0.4, step=2e-3)
        heights.append(vv.Position(of=upper)(system))
        assert vv.ContactForce(contact=contact)(system)[2] == pytest.approx(98.1, rel=1e-6)
    assert heights[0] == pytest.approx(heights[1], abs=1e-9)


def pulled(
    size: float, place: tuple[float, float], angle: float, spin: float, **options: Any
) -> tuple[Any, ...]:
    """A box on an equal one that stands, turned about the vertical, and pulled aside by 0.3 of its weight."""
    ground, box = vv.Ground(), vv.Box(size=(size,) * 3)
    lower = vv.RigidBody(shape=box, density=1e3, position=(0, 0, -size / 2))
    upper = vv.RigidBody(
        shape=box,
        density=1e3,
        position=(*place, size / 2),
        rotation=turned((0, 0, 1), angle),
        angular_velocity=(0, 0, spin),
    )
    contact = vv.Contact(first=upper, second=lower, friction=0.5, stiffness=1e6, **options)
    clamp = vv.Rigid(a=ground, b=lower, at=(0, 0, -size))
    pull = vv.Gravity(acceleration=(0.3 * 9.81, 0, -9.81))
    return vv.System([ground, upper, lower, clamp, contact, pull]), upper, contact


@pytest.mark.parametrize(("slots", "place", "angle"), [(8, (0.05, 0.03), 0.3), (12, (0, 0), 0.4)])
def test_elastic_slips_go_with_the_edges_that_have_them(
    slots: int, place: tuple[float, float], angle: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever gap holds a pair of edges: where pairs changed gaps their springs began anew, or from others'."""
    places = []
    for n in (64, slots):
        monkeypatch.setattr("visviva.contact.edges.BY_PENALTY", n)
        options: Any = {"enforcement": "penalty", "tangential": "penalty", "damping": 1e3}
        system, upper, _ = pulled(0.2, place, angle, 2.0, tangential_stiffness=1e5, **options)
        vv.simulate(system, until=0.4, step=2e-3)
        places.append(vv.Position(of=upper)(system))
    assert places[1] == pytest.approx(places[0], abs=1e-12)


def test_pressures_of_vertices_and_edges_at_rest_are_linear_in_the_place() -> None:
    """Those of a least mean square with one sum and one torque; rounding shared them out anew in each step."""
    system, _, contact = pulled(0.2, (0, 0), 0.0, 0.0)
    vv.simulate(system, until=0.3, step=2e-3)
    pressed = np.concatenate([contact.pressures, contact._edges.term.pressures])
    pressed = pressed[pressed > 0]
    weight = 8 * 9.81
    assert len(pressed) >= 8
    assert pressed.sum() == pytest.approx(weight, rel=1e-9)
    # n / 2 at either side: their torque about the middle is that of the pull, 0.3 of the weight at half of the height
    half = np.array([0.5 * weight * (1 - 0.3), 0.5 * weight * (1 + 0.3)])
    for p, side in zip((pressed.min(), pressed.max()), half, strict=True):
        share = pressed[np.isclose(pressed, p, rtol=1e-6)]
        assert share.sum() == pytest.approx(side, rel=1e-6)
