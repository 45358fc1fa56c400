"""Bodies that slide into a wall or ramp of the body below: an impact, however far the step goes beyond its foot."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.study.run import run


def prism(profile: list[tuple[float, float]], front: list[tuple[int, int, int]]) -> vv.RigidBody:
    """A profile (x, z), whose area is these triangles, from y = -1 to 1."""
    n = len(profile)
    points = [(x, y, z) for y in (-1, 1) for x, z in profile]
    sides = [f for i in range(n) for j in [(i + 1) % n] for f in ((i, n + i, j), (j, n + i, n + j))]
    triangles = [*front, *((n + a, n + c, n + b) for a, b, c in front), *sides]
    return vv.RigidBody(shape=vv.SurfaceMesh(points=points, triangles=triangles), density=1e3)


def corner() -> vv.RigidBody:
    """A floor z = 0 that ends in a wall x = 0, of one closed surface."""
    profile = [(-2, -0.5), (0.5, -0.5), (0.5, 1), (0, 1), (0, 0), (-2, 0)]
    return prism(profile, [(0, 4, 5), (0, 1, 4), (1, 2, 4), (2, 3, 4)])


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("start", [-0.5037, -0.506, -0.5])
@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_a_wall_throws_back_by_its_restitution(radius: float, start: float, restitution: float) -> None:
    """The share of the approach that came back depended on where in the step the wall is; points went through it."""
    place, moves = (start - radius, 0.01, radius), {"mass": 1.0, "velocity": (1.0, 0, 0)}
    slider: vv.PointMass | vv.RigidBody = vv.PointMass(position=place, **moves)
    if radius:
        slider = vv.RigidBody(shape=vv.Sphere(radius=radius), position=place, **moves)
    ground, body = vv.Ground(), corner()
    weld = vv.Rigid(a=ground, b=body, at=(0, 0, 0))
    contact = vv.Contact(first=slider, second=body, stiffness=1e4, restitution=restitution)
    system = vv.System([ground, body, weld, slider, contact, vv.Gravity()])
    result = vv.simulate(system, until=0.9, step=0.01)
    x = result.history(vv.Position(of=slider))[:, 0]
    assert (x[-1] - x[-11]) / 0.1 == pytest.approx(-restitution, abs=1e-6)
    assert x.max() + radius <= 1.5 * 0.01
    assert result.conservation()["energy"] < 1e-9


SCHEMES = {"energy": None, "midpoint": vv.VariationalMidpoint(), "euler": vv.BackwardEuler()}
FRACTIONS = [0.0, 0.1, 0.37, 0.6, 0.9]


def ramp(degrees: float) -> vv.RigidBody:
    """A floor z = 0 that rises from x = 0 on."""
    top = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    profile = [(-2, -0.5), (top[0] + 0.5, -0.5), (top[0] + 0.5, top[1]), top, (0, 0), (-2, 0)]
    return prism(profile, [(0, 4, 5), (0, 1, 4), (1, 2, 4), (2, 3, 4)])


def slide(
    rider: Any, body: vv.RigidBody, until: float, step: float, scheme: str, **options: Any
) -> vv.Result:
    """On what is held, without gravity unless it is given."""
    ground, gravity = vv.Ground(), options.pop("gravity", False)
    contact = vv.Contact(first=rider, second=body, stiffness=1e4, **options)
    parts = [ground, body, vv.Rigid(a=ground, b=body, at=(0, 0, 0)), rider, contact]
    system = vv.System([*parts, vv.Gravity()] if gravity else parts)
    return vv.simulate(system, until=until, step=step, scheme=SCHEMES[scheme])


def final_velocity(result: vv.Result, rider: Any) -> Any:
    x = result.history(vv.Position(of=rider))
    return (x[-1] - x[-2]) / (result.times[-1] - result.times[-2])


@pytest.mark.parametrize("degrees", [5, 15, 30, 45, 60, 75, 88])
@pytest.mark.parametrize(
    ("scheme", "restitution"),
    [*itertools.product(("energy", "midpoint"), (0.0, 0.5, 1.0)), ("euler", 0.0)],
)
@pytest.mark.parametrize("radius", [0.0, 0.003])
def test_a_ramp_takes_what_goes_into_it(radius: float, scheme: str, restitution: float, degrees: int) -> None:
    """(cos a)^2 + (e sin a)^2 of the energy is left, wherever in the step the ramp begins; .95 was, or 3."""
    a = np.radians(degrees)
    share = np.cos(a) ** 2 + (restitution * np.sin(a)) ** 2
    for (aside, step), fraction in itertools.product(((0.0, 0.02), (0.3, 0.01)), FRACTIONS):
        place = (-0.04 - fraction * step - radius * np.tan(a / 2), 0.01, radius)
        moves = {"mass": 1.0, "position": place, "velocity": (1.0, aside, 0.0)}
        rider: Any = (
            vv.RigidBody(shape=vv.Sphere(radius=radius), **moves) if radius else vv.PointMass(**moves)
        )
        result = slide(rider, ramp(degrees), 0.12, step, scheme, restitution=restitution)
        total = result.ledger["total"]
        assert total[-1] / total[0] == pytest.approx((share + aside**2) / (1 + aside**2), abs=1e-9)
        assert np.diff(total).max() < 1e-12


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("degrees", [15, 45, 75])
def test_what_a_ramp_takes_under_gravity_converges(degrees: int, scheme: str) -> None:
    """To first order in the step: in it the vertex goes on along the floor."""
    errors = []
    for step in (0.01, 0.005, 0.0025):
        rider = vv.PointMass(mass=1.0, position=(-0.2 - 0.6 * step, 0.01, 0), velocity=(1.0, 0.3, 0))
        total = slide(rider, ramp(degrees), 0.22, step, scheme, gravity=True).ledger["total"]
        assert np.diff(total).max() < 1e-12 * np.abs(total).max()
        errors.append(abs((total[0] - total[-1]) / 0.5 - np.sin(np.radians(degrees)) ** 2))
    assert errors[0] < 6 * 0.01
    assert all(fine < 0.8 * coarse for coarse, fine in itertools.pairwise(errors))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("n", [6, 36])
def test_every_facet_of_a_bowl_takes_its_own(n: int, scheme: str) -> None:
    """A quarter of a circle of facets: each leaves (cos pi / n)^2, those of less than 26 degrees between them too."""
    angle, length = np.pi / n, 2 * np.sin(np.pi / n / 2)
    points = [(-2.0, 0.0), (0.0, 0.0)]
    for k in range(1, n // 2 + 1):
        x, z = points[-1]
        points.append((x + length * np.cos(k * angle), z + length * np.sin(k * angle)))
    right = points[-1][0] + 0.5
    profile = [(-2.0, -0.5), (right, -0.5), (right, points[-1][1]), *points[::-1]]
    top = range(3, len(profile))
    fan = [(1, i, i + 1) for i in top[:-1]]
    body = prism(profile, [(0, 1, len(profile) - 1), (1, 2, 3), *fan])
    until = 0.21 + sum(length / np.cos(angle) ** (k + 1) for k in range(n // 2))
    for step, fraction in ((0.01, 0.37), (0.01, 0.9), (0.0025, 0.9)):
        rider = vv.PointMass(mass=1.0, position=(-0.2 - fraction * step, 0.01, 0), velocity=(1.0, 0, 0))
        total = slide(rider, body, until, step, scheme).ledger["total"]
        assert total[-1] / total[0] == pytest.approx(np.cos(angle) ** n, abs=1e-9)
        assert np.diff(total).max() < 1e-12


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("degrees", [20, 45, 70])
def test_a_corner_of_three_facets(degrees: int, scheme: str) -> None:
    """Into the edge between two ramps what goes along that is left, into one and then the other what each leaves."""
    t, low = np.tan(np.radians(degrees)), -0.5
    xs = (-2.0, 0.0, 1.0)
    points = [(x, y, z) for z in (None, low) for y in xs for x in xs]
    points = [(x, y, max(0, t * x, t * y) if z is None else z) for x, y, z in points]
    cells = [3 * j + i for j in range(2) for i in range(2)]
    upper = [f for k in cells for f in ((k, k + 1, k + 4), (k, k + 4, k + 3))]
    around = [0, 1, 2, 5, 8, 7, 6, 3]
    sides = [
        f
        for a, b in zip(around, around[1:] + around[:1], strict=True)
        for f in ((a + 9, b + 9, a), (a, b + 9, b))
    ]
    triangles = [*upper, *((a + 9, c + 9, b + 9) for a, b, c in upper), *sides]
    normals = np.array([(-t, 0, 1), (0, -t, 1)]) / np.hypot(t, 1)
    for start, fraction in itertools.product((-0.2, -0.22), FRACTIONS):
        left = np.array([1.0, 1.0, 0.0])
        if start == -0.2:
            along = np.cross(*normals) / np.linalg.norm(np.cross(*normals))
            left = along * (along @ left)
        else:
            for n in normals:
                left = left - min(n @ left, 0) * n
        body = vv.RigidBody(shape=vv.SurfaceMesh(points=points, triangles=triangles), density=1e3)
        place = np.array([-0.2, start, 0]) - fraction * 0.01 * np.array([1, 1, 0])
        rider = vv.PointMass(mass=1.0, position=tuple(place), velocity=(1.0, 1.0, 0))
        result = slide(rider, body, 0.5, 0.01, scheme)
        np.testing.assert_allclose(final_velocity(result, rider), left, atol=1e-9)
        assert np.diff(result.ledger["total"]).max() < 1e-12


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("degrees", [10, 60])
def test_a_ridge_takes_nothing(degrees: int, scheme: str) -> None:
    """What slides over it flies off."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    profile = [(-2, -1.5), (1, -1.5), (c, -s), (0, 0), (-2, 0)]
    for fraction in FRACTIONS:
        body = prism(profile, [(0, 3, 4), (0, 1, 3), (1, 2, 3)])
        rider = vv.PointMass(mass=1.0, position=(-0.1 - 0.01 * fraction, 0.01, 0), velocity=(1.0, 0.1, 0))
        result = slide(rider, body, 0.3, 0.01, scheme)
        np.testing.assert_allclose(final_velocity(result, rider), (1, 0.1, 0), atol=1e-9)


def cube(n: int, size: float) -> vv.SurfaceMesh:
    """Of n x n squares on each face."""
    points: dict[tuple[float, ...], int] = {}
    triangles = []
    for axis, side, i, j in itertools.product(range(3), (-1, 1), range(n), range(n)):
        square = []
        for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
            point = np.roll(np.array([side, 2 * a / n - 1, 2 * b / n - 1]) * size / 2, axis)
            square.append(points.setdefault(tuple(np.round(point, 12)), len(points)))
        p, q, r, s = square[::side]
        triangles += [(p, q, r), (p, r, s)]
    return vv.SurfaceMesh(points=list(points), triangles=triangles)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("degrees", [20, 45, 75])
@pytest.mark.parametrize("n", [1, 2, 4])
def test_a_box_that_slides_into_a_ramp(n: int, degrees: int, scheme: str) -> None:
    """By its lower edge, which goes on along the ramp; where the cube would turn into the floor the edge stops."""
    a = np.radians(degrees)
    left = 1 - np.sin(a) ** 2 / (1 + 1.5 * (np.cos(a) - np.sin(a)) ** 2) if degrees < 59 else 3 / 8
    errors = []
    for step in (0.01, 0.005):
        totals = []
        for fraction in FRACTIONS[1::2]:
            place = (-0.3 - fraction * step, 0.01, 0.1)
            box = vv.RigidBody(shape=cube(n, 0.2), mass=1.0, position=place, velocity=(1.0, 0, 0))
            until = 0.2 + 2 * step
            result = slide(box, ramp(degrees), until, step, scheme, formulation="node-to-segment")
            totals.append(result.ledger["total"])
            assert np.diff(totals[-1]).max() < 1e-12
        ends = [total[-1] / total[0] for total in totals]
        assert np.ptp(ends) < 1e-9
        errors.append(abs(ends[0] - left))
    assert errors[1] < max(0.6 * errors[0], 1e-9)
    assert errors[1] < 0.02


def test_a_node_that_slides_into_a_ramp_gains_nothing_by_the_midpoint_rule() -> None:
    """It rose by 2.8 per cent: the force of the middle of the step pointed up and lifted it onto the ramp."""
    for fraction in (0.1, 0.6):
        mesh = vv.BoxMesh(size=(0.2,) * 3, counts=(2, 2, 2), origin=(-0.25 - fraction * 0.005, -0.1, 0))
        material = vv.NeoHooke(young=1e6, poisson=0.3)
        block = vv.Solid(mesh=mesh, material=material, density=1e3, velocity=(1.0, 0, 0))
        body = ramp(30)
        result = slide(block, body, 0.11, 0.005, "midpoint", formulation="node-to-segment")
        total = result.ledger["total"]
        assert total.max() < 1.0005 * total[0]


@pytest.mark.parametrize("height", [1e-7, 1e-6])
def test_what_hovers_by_rounding_is_held_by_nothing_far(height: float) -> None:
    """It counted as inside, and was held by the far side of the body, behind which all of its top lies."""
    rider = vv.PointMass(mass=1.0, position=(-0.5, 0.01, height))
    result = slide(rider, ramp(30), 0.1, 0.01, "energy", gravity=True)
    z = result.history(vv.Position(of=rider))[:, 2]
    assert np.abs(z).max() < 1.5 * 0.01**2 * 9.81


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("radius", [0.0, 0.1])
@pytest.mark.parametrize("scheme", ["energy", "midpoint"])
@pytest.mark.parametrize("degrees", [45, 80])
def test_a_resumed_slide_is_the_same(
    degrees: float, scheme: str, radius: float, friction: float, tmp_path: Path
) -> None:
    """What is held by two facets began with the gap of one: runs went other ways by up to 112 N, or failed."""
    place = (-0.1074 - radius * np.tan(np.radians(degrees) / 2), 0.01, radius)

    def study(until: float) -> vv.Study:
        moves: dict[str, Any] = {"mass": 1.0, "position": place, "velocity": (1.0, 0.3, 0.0)}
        rider: Any = (
            vv.RigidBody(shape=vv.Sphere(radius=radius), **moves) if radius else vv.PointMass(**moves)
        )
        ground, body = vv.Ground(), ramp(degrees)
        contact = vv.Contact(first=rider, second=body, stiffness=1e4, restitution=0.0, friction=friction)
        weld = vv.Rigid(a=ground, b=body, at=(0, 0, 0))
        system = vv.System([ground, body, weld, rider, contact, vv.Gravity()])
        return vv.Study(system, until, 0.02, scheme=SCHEMES[scheme] or vv.EnergyMomentum())

    whole = run(study(0.26), tmp_path / "whole", pictures=False)
    for end in (0.1, 0.14, 0.16, 0.2, 0.26):
        parts = run(study(end), tmp_path / "parts", resume=end > 0.1, pictures=False)
    np.testing.assert_array_equal(parts.states[-1], whole.states[-1])
