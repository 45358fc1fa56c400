"""Static equilibrium, eigenmodes and adaptive steps against closed forms."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from reference import bricard as bricard_reference
from reference import statics
from test_check import bricard

import visviva as vv
from visviva.mesh.generate import PlaneCell

GRAVITY = 9.81


def hinged_bar(x: float = 0.5, angle: bool = False) -> vv.System:
    """A bar of mass 2 and length 1 hinged at the origin about z, its centre at (x, 0, 0), weight along -y."""
    ground = vv.Ground()
    bar = vv.RigidBody(shape=vv.Box(size=(1, 0.1, 0.1)), mass=2.0, position=(x, 0, 0), name="bar")
    hinge = vv.Revolute(a=ground, b=bar, at=(0, 0, 0), angle=angle, name="hinge")
    return vv.System([ground, bar, hinge, vv.Gravity(acceleration=(0, -GRAVITY, 0))])


def spring_chain(n: int) -> vv.System:
    """Unit masses between `n` + 1 springs of stiffness 100, stretched from 0.5 to 1, along x."""
    ground = vv.Ground()
    masses = [vv.PointMass(mass=1.0, position=(k + 1, 0, 0)) for k in range(n)]
    ends = [ground.point(), *(m.point() for m in masses), ground.point((n + 1, 0, 0))]
    springs = [vv.Spring(a=ends[k], b=ends[k + 1], stiffness=100.0, free_length=0.5) for k in range(n + 1)]
    return vv.System([ground, *masses, *springs])


def squares_of_chain(n: int) -> np.ndarray:
    """Exact: longitudinal with k = 100, twice transverse with the tension 50 over the length 1."""
    s = np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2
    return np.sort(np.concatenate([400 * s, 200 * s, 200 * s]))


# --- equilibrium --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [False, True])
def test_bar_falls_to_the_hanging_position(angle: bool) -> None:
    system = hinged_bar(angle=angle)
    result = vv.equilibrium(system)
    assert system.x[:3] == pytest.approx([0, -0.5, 0], abs=1e-12)
    assert result.ledger["potential_gravity"][-1] == pytest.approx(-GRAVITY, abs=1e-12)


def test_pendulum_hangs_on_springs() -> None:
    """Two springs of stiffness k from (-1, 0) and (1, 0) carry m g: 2 k (l - l0) h / l = m g."""
    ground, ball = vv.Ground(), vv.PointMass(mass=3.0, position=(0.3, -0.2, 0.1))
    springs = [
        vv.Spring(a=ground.point((x, 0, 0)), b=ball.point(), stiffness=50.0, free_length=1.0) for x in (-1, 1)
    ]
    system = vv.System([ground, ball, *springs, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
    vv.equilibrium(system)
    x, depth, z = system.x[0], -system.x[1], system.x[2]
    length = np.hypot(1, depth)
    assert (x, z) == pytest.approx((0, 0), abs=1e-11)
    assert 2 * 50 * (length - 1) * depth / length == pytest.approx(3 * GRAVITY, rel=1e-12)


def test_reactions_of_the_three_hinged_arch() -> None:
    mass, length, angle = 2.0, 1.5, 0.7
    ground, half = vv.Ground(), 0.5 * length * np.array([np.cos(angle), np.sin(angle), 0])
    bars = []
    for sign, foot in ((1, 0.0), (-1, 4 * half[0])):
        along = np.array([sign * half[0], half[1], 0]) / (0.5 * length)
        turn = np.array([along, [-along[1], along[0], 0], [0, 0, 1]]).T
        centre = np.array([foot, 0, 0]) + 0.5 * length * along
        box = vv.Box(size=(length, 0.1, 0.1))
        bars.append(vv.RigidBody(shape=box, mass=mass, position=centre, rotation=turn))
    left = vv.Revolute(a=ground, b=bars[0], at=(0, 0, 0), name="left")
    right = vv.Revolute(a=ground, b=bars[1], at=(4 * half[0], 0, 0), name="right")
    top = vv.Revolute(a=bars[0], b=bars[1], at=2 * half, name="top")
    system = vv.System([ground, *bars, left, right, top, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
    vv.equilibrium(system)
    exact = statics.three_hinged_arch(mass, length, angle)
    for joint in (left, right, top):
        start = system.field(joint, "reaction").start
        found = np.abs(system.x[start : start + 2])  # the first constraints keep the points together
        assert found == pytest.approx(np.abs(exact[joint.name]), abs=1e-9)


def test_load_steps_follow_a_growing_force() -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=10.0)
    system = vv.System([ground, ball, spring, vv.Force(on=ball.point(), force=(1, 0, 0), times="4*t")])
    result = vv.equilibrium(system, until=1.0, steps=4)
    assert system.time == 1.0
    assert [x[0] for x in result.states] == pytest.approx([1.0, 1.1, 1.2, 1.3, 1.4], abs=1e-12)


def test_torsion_spring_holds_a_four_bar() -> None:
    """One freedom: the spring's moment balances the weights, checked by virtual work in the crank's angle."""
    ground, box = vv.Ground(), vv.Box(size=(0.1, 1, 0.1))
    a = vv.RigidBody(shape=box, mass=1.0, position=(0, 0.5, 0))
    b = vv.RigidBody(shape=vv.Box(size=(2, 0.1, 0.1)), mass=2.0, position=(1, 1, 0))
    c = vv.RigidBody(shape=box, mass=1.0, position=(2, 0.5, 0))
    foot = vv.Revolute(a=ground, b=a, at=(0, 0, 0))
    others = [
        vv.Revolute(a=a, b=b, at=(0, 1, 0)),
        vv.Revolute(a=b, b=c, at=(2, 1, 0)),
        vv.Revolute(a=c, b=ground, at=(2, 0, 0)),
    ]
    spring = vv.JointSpring(joint=foot, stiffness=60.0, free=0.3)
    system = vv.System([ground, a, b, c, foot, *others, spring, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
    vv.equilibrium(system)
    angle = float(system.x[system.field(foot, "angle").start])
    assert 60 * (0.3 - angle) + 3 * GRAVITY * np.sin(angle) == pytest.approx(0, abs=1e-9)
    assert angle == pytest.approx(np.arctan2(-system.x[0], system.x[1]), abs=1e-12)


def test_free_fall_has_no_equilibrium() -> None:
    with pytest.raises(vv.RunError, match=r"position\[2\] of PointMass 'stone' still moves"):
        vv.equilibrium(vv.System([vv.PointMass(mass=1.0, name="stone"), vv.Gravity()]))


def test_what_nothing_holds_is_named() -> None:
    block = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=10.0, poisson=0.3),
        density=1.0,
        name="block",
    )
    with pytest.raises(vv.RunError, match=r"nothing holds Solid 'block' \(translation along x, y, z"):
        vv.equilibrium(vv.System([block, vv.Gravity()]))


@pytest.mark.parametrize(("until", "steps"), [(0.0, 1), (1.0, 0)])
def test_bad_load_steps_are_refused(until: float, steps: int) -> None:
    with pytest.raises(vv.InputError):
        vv.equilibrium(hinged_bar(), until=until, steps=steps)


# --- modes --------------------------------------------------------------------------------------------------


def test_simple_and_double_pendulum() -> None:
    ground = vv.Ground()
    a, b = vv.PointMass(mass=1.0, position=(0, -1, 0)), vv.PointMass(mass=1.0, position=(0, -2, 0))
    rods = [vv.Distance(a=ground.point(), b=a.point()), vv.Distance(a=a.point(), b=b.point())]
    system = vv.System([ground, a, b, *rods, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
    low, high = GRAVITY * (2 - np.sqrt(2)), GRAVITY * (2 + np.sqrt(2))
    modes = vv.modes(system)
    assert modes.squared == pytest.approx([low, low, high, high], rel=1e-12)
    assert modes.frequencies[0] == pytest.approx(np.sqrt(low) / (2 * np.pi), rel=1e-12)
    top, bottom = modes.shape(a, "position")[0], modes.shape(b, "position")[0]
    assert bottom == pytest.approx(np.sqrt(2) * top + top, abs=1e-10)


@pytest.mark.parametrize("angle", [False, True])
def test_compound_pendulum(angle: bool) -> None:
    system = hinged_bar(angle=angle)
    vv.equilibrium(system)
    inertia = 2 * 1.01 / 12 + 0.5
    assert vv.modes(system).squared == pytest.approx([GRAVITY / inertia], rel=1e-10)


def test_unstable_equilibrium_is_reported_as_such() -> None:
    ground = vv.Ground()
    bar = vv.RigidBody(shape=vv.Box(size=(1, 0.1, 0.1)), mass=2.0, position=(0.5, 0, 0))
    hinge = vv.Revolute(a=ground, b=bar, at=(0, 0, 0))
    system = vv.System([ground, bar, hinge, vv.Gravity(acceleration=(-GRAVITY, 0, 0))])
    vv.equilibrium(system, unstable=True)
    modes = vv.modes(system)
    inertia = 2 * 1.01 / 12 + 0.5
    assert not modes.stable
    assert modes.squared == pytest.approx([-GRAVITY / inertia], rel=1e-10)
    assert modes.frequencies[0].real == 0
    assert "unstable" in str(modes)


def test_stable_means_of_the_modes_found() -> None:
    """A mass on soft springs beside a column under more than Beck's load, whose flutter is not among the lowest."""
    ground, soft = vv.Ground(), vv.PointMass(mass=1.0, position=(5, 0, 0))
    springs = [
        vv.Spring(a=ground.point((x, 0, 0)), b=soft.point(), stiffness=0.5, free_length=0.0) for x in (3, 7)
    ]
    section = vv.GivenSection(stiffness=(1e6, 1e6, 1e6, 1, 1, 1), mass=1.0, moments=(1e-7, 1e-7, 0))
    mesh = vv.LineMesh(points=[(0, 0, 0), (0, 0, 1)], count=6, cell="line3")
    mast = vv.Beam(mesh=mesh, section=section)
    push = vv.FollowerForce(on=mast.frame(1.0), force=(0, 0, -25), times="t")
    system = vv.System([ground, soft, *springs, mast, vv.Clamped(solid=mast, nodes="start"), push])
    vv.quasi_static(system, until=1.0, step=0.5, scheme=vv.Static(unstable=True))
    few, more = vv.modes(system, 3), vv.modes(system, 8)
    assert few.stable
    assert not few.flutters
    assert "none of the 3 modes found grow" in str(few)
    assert not more.stable
    assert more.flutters
    assert "of the 8 modes found grow" in str(more)


def test_spring_chain() -> None:
    assert vv.modes(spring_chain(20), n=60).squared == pytest.approx(squares_of_chain(20), rel=1e-11)


def test_large_systems_give_the_same_modes() -> None:
    system = spring_chain(250)
    assert vv.modes(system, n=9).squared == pytest.approx(squares_of_chain(250)[:9], rel=1e-8)


def test_factors_of_modes_that_do_not_fit_are_refused() -> None:
    chain = spring_chain(250)
    chain.newton = vv.Newton(linear=vv.Direct(library="eigen", memory_limit=1e3))
    with pytest.raises(vv.InputError, match=r"\d+ equations needs about .* GB"):
        vv.modes(chain, n=3)


def test_both_ways_agree_with_constraints(monkeypatch: pytest.MonkeyPatch) -> None:
    n, ground = 12, vv.Ground()
    masses = [vv.PointMass(mass=1.0, position=(0, -k - 1.0, 0)) for k in range(n)]
    ends = [ground.point(), *(m.point() for m in masses)]
    rods = [vv.Distance(a=ends[k], b=ends[k + 1]) for k in range(n)]
    system = vv.System([ground, *masses, *rods, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
    dense = vv.modes(system, n=6).squared
    monkeypatch.setattr(sys.modules["visviva.analysis.vibration"], "DENSE", 0)
    assert vv.modes(system, n=6).squared == pytest.approx(dense, rel=1e-9)


def test_free_body_has_six_zero_frequencies() -> None:
    modes = vv.modes(vv.System([vv.RigidBody(shape=vv.Box(size=(1, 0.2, 0.3)), mass=2.0)]))
    assert modes.squared.tolist() == [0.0] * 6


def test_redundant_mechanism() -> None:
    """Bricard: omega^2 = V'' / I in its one coordinate."""
    system, _ = bricard()
    vv.equilibrium(system)
    grid = [bricard_reference.energies(complex(q))[1].real for q in np.linspace(0.1, 1.4, 14)]
    q = float(np.linspace(0.1, 1.4, 14)[int(np.argmin(grid))])
    for _ in range(30):
        slope = [bricard_reference.energies(q + d + 1e-30j)[1].imag / 1e-30 for d in (0, 1e-5, -1e-5)]
        bend = (slope[1] - slope[2]) / 2e-5
        q -= slope[0] / bend
    inertia = bricard_reference.energies(complex(q))[0].real
    assert vv.modes(system).squared == pytest.approx([bend / inertia], rel=1e-7)


def test_what_is_no_equilibrium_is_refused() -> None:
    with pytest.raises(vv.InputError, match=r"no equilibrium: a force .* RigidBody 'bar'"):
        vv.modes(hinged_bar())


# --- adaptive steps -----------------------------------------------------------------------------------------


def test_tolerance_controls_the_error() -> None:
    reference = bricard_reference.cached()
    exact = np.array([reference[f"P3{c}"][4] for c in "xyz"])
    errors, steps = [], []
    for tolerance in (1e-5, 1e-6, 1e-7):
        system, bars = bricard()
        rule = vv.Adaptive(tolerance=tolerance)
        result = vv.simulate(system, until=1.0, step=0.01, adaptive=rule)
        assert system.time == 1.0
        assert result.ledger.imbalance() < 1e-10
        errors.append(np.linalg.norm(bars[2].point_at((1, -1, 1)).position.value(system.x) - exact))
        steps.append(result.statistics.steps)
    assert errors[0] / errors[2] == pytest.approx((steps[2] / steps[0]) ** 2, rel=0.3)
    assert steps[2] / steps[0] == pytest.approx(100 ** (1 / 3), rel=0.3)


def swinging_rod() -> vv.System:
    """A spring pendulum whose fast and slow phases want different steps."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1.1, 0, 0), velocity=(0, 0.2, 0.1))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0, free_length=0.2)
    return vv.System([ground, ball, spring, vv.Gravity()])


def test_energy_is_conserved_with_varying_steps() -> None:
    system = swinging_rod()
    system.newton = vv.Newton(keep_factor=0.0)  # to round-off also where kept tangents stop a little earlier
    result = vv.simulate(system, until=5.0, step=0.001, adaptive=vv.Adaptive(tolerance=1e-5))
    steps = np.diff(result.times)
    assert steps.max() > 2 * steps.min()
    assert result.ledger.imbalance() < 1e-12


def test_steps_keep_their_bounds() -> None:
    rule = vv.Adaptive(tolerance=1e-9, min_step=0.002, max_step=0.004)
    result = vv.simulate(swinging_rod(), until=0.5, step=0.01, adaptive=rule)
    steps = np.diff(result.times)
    assert steps[:-2].min() >= 0.002 * (1 - 1e-9)
    assert steps.max() <= 0.004 * (1 + 1e-9)


@pytest.mark.parametrize("bad", [{"tolerance": 0.0}, {"min_step": -1.0}, {"max_step": np.nan}])
def test_bad_rules_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(vv.InputError, match="not a positive number"):
        vv.Adaptive(**bad)


@pytest.mark.parametrize("missed", [0, 3, 5])
def test_modes_that_stand_several_times_are_all_found(missed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three equal cubes fixed at their feet: each frequency of one, three times. Krylov spaces of one vector hold one
    of each, and which others rounding brings is chance: here it is to leave one out."""
    import scipy.sparse.linalg as spl

    brick = vv.BoxMesh(size=(1, 1, 1), counts=(6, 6, 6)).build()
    material = vv.LinearElastic(young=1.0, poisson=0.3)

    def angular(copies: int, n: int) -> np.ndarray:
        solids = [
            vv.Solid(mesh=brick.moved((2.0 * k, 0, 0)), material=material, density=1.0) for k in range(copies)
        ]
        held = [vv.Fixed(solid=solid, nodes="z0") for solid in solids]
        return np.asarray(vv.modes(vv.System([*solids, *held]), n=n).angular)

    expected = np.repeat(angular(1, 3), 3)
    eigsh = spl.eigsh

    def forgetful(*args: object, k: int, **options: object) -> tuple[np.ndarray, np.ndarray]:
        if k < 9:
            return eigsh(*args, k=k, **options)
        values, z = eigsh(*args, k=k + 1, **options)
        left = np.delete(np.argsort(values), missed)
        return values[left], z[:, left]

    monkeypatch.setattr(spl, "eigsh", forgetful)
    assert angular(3, 9) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("stiff", [1e10, 1e13, 1e15])
@pytest.mark.parametrize("extra", [0, 1, 4])
@pytest.mark.parametrize("n", [1, 3, 6])
def test_low_modes_of_a_few_coordinates_stand_beside_very_stiff_ones(
    stiff: float, extra: int, n: int
) -> None:
    """Balls that know nothing of each other: their squares, in order, and what grows."""

    def held(ball: vv.PointMass, *stiffness: float) -> vv.Potential:
        place = np.array(ball.position)[:, None]
        k = np.array(stiffness)[:, None]
        return vv.Potential(of=[ball], energy=lambda e: 0.5 * (k * (e - place) ** 2).sum(axis=0))

    balls = [vv.PointMass(mass=1.0, position=(k, 0, 0)) for k in range(2 + extra)]
    springs = [held(balls[0], stiff, stiff, stiff), *(held(b, 0.3, 0.5, -0.01) for b in balls[1:])]
    modes = vv.modes(vv.System([*balls, *springs]), n)
    exact = sorted([stiff] * 3 + [0.3, 0.5, -0.01] * (1 + extra))[:n]
    assert modes.squared == pytest.approx(exact, rel=1e-6)
    assert not modes.stable


@pytest.mark.parametrize("stiff", [1e2, 1e13])
def test_a_single_ball_grows_beside_a_very_stiff_spring(stiff: float) -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=stiff, free_length=1.0)
    hill = vv.Potential(of=[ball], energy=lambda e: 0.25 * e[1] ** 2 - 0.005 * e[2] ** 2)
    modes = vv.modes(vv.System([ground, ball, spring, hill]), 3)
    assert modes.squared == pytest.approx([-0.01, 0.5, stiff], rel=1e-6)
    assert not modes.stable


@pytest.mark.parametrize("length", [0.3, 0.7, 1.1, 1 / 3, 1e-6 / 3])
def test_a_spring_at_rest_holds_nothing_across(length: float) -> None:
    """Rounding of its length is neither growth nor frequency."""
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(length, 0, 0))
    parts = [vv.Spring(a=ground.point(), b=ball.point(), stiffness=s, free_length=length * (1 + d)) for s, d in
             ((1e4, 0.0), (3e3, 2e-16))]  # fmt: skip
    modes = vv.modes(vv.System([ground, ball, *parts]), 3)
    assert modes.squared[:2].tolist() == [0.0, 0.0]
    assert modes.stable


@pytest.mark.parametrize(("cell", "n"), [("tri6", 8), ("quad9", 6)])
def test_laminates_that_are_symmetric(cell: PlaneCell, n: int) -> None:
    """What cancels in them (4e-80 beside 1) is no stiffness by which equations are scaled; Kirchhoff's plate."""
    E1, E2, nu, G, density, h = 40e9, 10e9, 0.25, 5e9, 1600.0, 0.005
    ply = {"thickness": h / 4, "young": E1, "across": E2, "poisson": nu, "shear": G, "density": density}
    layers = vv.Laminate(plies=tuple(vv.Ply(angle=angle, **ply) for angle in (0, 90, 90, 0)))
    mesh = vv.RectangleMesh(size=(1, 1), counts=(n, n), cell=cell)
    plate = vv.Shell(mesh=mesh, section=layers, first=(1, 0, 0))
    sides = {"x0": (0, 1, 0), "x1": (0, 1, 0), "y0": (1, 0, 0), "y1": (1, 0, 0)}
    turns = [vv.SymmetryPlane(solid=plate, nodes=side, normal=axis) for side, axis in sides.items()]
    holds = [vv.Fixed(solid=plate, nodes=side, directions=(False, False, True)) for side in sides]
    found = vv.modes(vv.System([plate, *turns, *holds]), 2)
    share = 1 - nu**2 * E2 / E1
    outer, inner = (7 / 8) * h**3 / 12, (1 / 8) * h**3 / 12
    D1, D2 = (E1 * outer + E2 * inner) / share, (E2 * outer + E1 * inner) / share
    D3 = (nu * E2 / share + 2 * G) * h**3 / 12
    exact = [np.pi**2 * np.sqrt((D1 + 2 * k**2 * D3 + D2 * k**4) / (density * h)) for k in (1, 2)]
    assert 2 * np.pi * found.frequencies == pytest.approx(exact, rel=0.01)
