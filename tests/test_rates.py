"""Python functions of time have the rates of the same expressions, whatever the time and the unit it is counted in."""

import math

import numpy as np
import pytest

import visviva as vv
from visviva.base.differences import central_rate, forward_curvature, forward_rate

PERIODS = [1e-6, 1e-3, 0.2, 1.0, 1e5]


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("periods", [0.0, 0.31, 1500.2])
def test_differences_over_parts_of_a_step_see_what_the_step_resolves(period, periods):
    w, t, step = 2 * math.pi / period, periods * period, period / 20
    phase = w * t
    f = lambda t: np.array([math.sin(w * t), math.cos(w * t)])  # noqa: E731
    rate = w * np.array([math.cos(phase), -math.sin(phase)])
    assert central_rate(f, t, step) == pytest.approx(rate, abs=1e-9 * w)
    assert forward_rate(f, t, step) == pytest.approx(rate, abs=2e-9 * w)
    curvature = w**2 * np.array([-math.sin(phase), -math.cos(phase)])
    assert forward_curvature(f, t, step) == pytest.approx(curvature, abs=1e-6 * w**2)


@pytest.mark.parametrize("period", [1e-6, 1e-3, 0.2, 1.0, 1e2])
@pytest.mark.parametrize("t", [0.0, 0.3, 1.7])
def test_without_a_step_a_distance_is_found(period, t):
    w = 2 * math.pi / period
    rate = vv.TimeFunction(lambda t: math.sin(w * t)).rate(t)
    rounding = 1e-15 * w * t  # of the phase, which no difference can mend
    assert rate == pytest.approx(w * math.cos(w * t), abs=(1e-8 + 1e3 * rounding) * w)


@pytest.mark.parametrize("offset", [283.0, -1e3])
@pytest.mark.parametrize("t", [0.0, 1e6])
def test_slow_functions_on_an_offset_are_not_taken_to_rest(offset, t):
    """Of seasons in seconds; short distances of time agree on nothing, as they change no digit."""
    w = 2 * math.pi / 3.156e7
    f = lambda t: offset + 10 * math.sin(w * t)  # noqa: E731
    assert forward_rate(f, t) == pytest.approx(10 * w * math.cos(w * t), rel=5e-3)
    assert central_rate(f, t) == pytest.approx(10 * w * math.cos(w * t), rel=5e-3)
    assert forward_rate(lambda t: offset, t) == 0


def shaken(motion, *, start, period, scheme):
    """A body on a slide with a motor, over a quarter of a period from a `start`."""
    ground, body = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 1, 1))
    slide = vv.Prismatic(a=ground, b=body, at=(0, 0, 0), axis=(1, 0, 0))
    system = vv.System([ground, body, slide, vv.Motor(joint=slide, motion=motion)])
    system.time = start
    return vv.simulate(system, until=start + period / 4, step=period / 100, scheme=scheme, project=True)


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.GeneralizedAlpha(), vv.VariationalMidpoint()], ids=str
)
@pytest.mark.parametrize(("period", "start"), [(0.2, 300.0), (1e-3, 0.0), (1e-5, 0.0)])
def test_motors_by_functions_move_like_those_by_expressions(scheme, period, start):
    w = 2 * math.pi / period
    options = {"start": start, "period": period, "scheme": scheme}
    by_text = shaken(f"{period!r}*sin({w!r}*t)", **options)
    by_function = shaken(lambda t: period * math.sin(w * t), **options)
    assert by_function.rates[0][0] == pytest.approx(2 * math.pi, rel=1e-8)
    assert by_function.ledger["kinetic"] == pytest.approx(by_text.ledger["kinetic"], abs=1e-7)


def rod(motion, period):
    mesh = vv.BoxMesh(size=(1, 0.2, 0.2), counts=(4, 1, 1))
    rubber = vv.NeoHooke(young=1e3 / period**2, poisson=0.3)
    solid = vv.Solid(mesh=mesh, material=rubber, density=1.0)
    system = vv.System([solid, vv.Prescribed(solid=solid, nodes="x0", motion=motion)])
    return vv.simulate(system, until=period / 4, step=period / 100, scheme=vv.GeneralizedAlpha())


def cavity(velocity, period):
    mesh = vv.RectangleMesh(size=(1, 1), counts=(3, 3), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0 / period)
    walls = [vv.NoSlip(fluid=water, faces=side) for side in ("x0", "x1", "y0")]
    system = vv.System([water, vv.VelocityBoundary(fluid=water, faces="y1", velocity=velocity), *walls])
    return vv.simulate(system, until=period / 4, step=period / 100, scheme=vv.GeneralizedAlpha())


@pytest.mark.parametrize("period", [1.0, 1e-3, 1e-6])
@pytest.mark.parametrize("model", [rod, cavity])
def test_what_functions_prescribe_moves_like_what_expressions_do(model, period):
    w = 2 * math.pi / period
    size = 0.05 if model is rod else 1 / period
    by_text = model((f"{size!r}*sin({w!r}*t)", 0, 0), period)
    by_function = model(lambda t, X: np.outer(np.full(len(X), size * math.sin(w * t)), [1, 0, 0]), period)
    kinetic = by_text.ledger["kinetic"]
    assert by_function.ledger["kinetic"] == pytest.approx(kinetic, abs=1e-7 * kinetic.max())


@pytest.mark.parametrize("scheme", [vv.VariationalMidpoint(), vv.GeneralizedAlpha()])
def test_a_mass_swings_on_a_column_without(scheme: vv.Scheme) -> None:
    """Nodes that meet no constraint and weigh nothing have rates to keep; w^2 = E A / L m, of second order."""
    errors = []
    force, w, t = 1e-4, 10.0, 0.2
    for step in (0.01, 0.005):
        rubber = vv.NeoHooke(young=100.0, poisson=0.0)
        column = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 2)), material=rubber)
        end = vv.RigidCoupling(solid=column, faces="z1")
        mass = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(0.5, 0.5, 1))
        fixed = vv.Fixed(solid=column, nodes="z0")
        push = vv.Force(on=mass, force=lambda t, x, v: (0, 0, -force * np.sin(5 * t)))
        system = vv.System([column, end, mass, vv.Rigid(a=mass, b=end, at=(0.5, 0.5, 1)), fixed, push])
        vv.simulate(system, until=t, step=step, scheme=scheme)
        exact = force * (5 / w * np.sin(w * t) - np.sin(5 * t)) / (w**2 - 25)
        errors.append((vv.Position(of=mass)(system)[2] - 1) / exact - 1)
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_a_beam_without_mass_follows_its_load() -> None:
    """Under a scheme that projects rates, as under one that does not; nothing moves but what the load bends."""
    ends = []
    for scheme in (vv.GeneralizedAlpha(rho=0.8), vv.EnergyMomentum()):
        section = vv.RectangleSection(width=0.1, height=0.1, young=1e6, poisson=0.3)
        beam = vv.Beam(mesh=vv.LineMesh(points=((0, 0, 0), (1, 0, 0)), count=4), section=section)
        end = beam.point((1, 0, 0))
        push = vv.Force(on=end, force=lambda t, x, v: (0, 0, -10 * np.sin(5 * t)))
        system = vv.System([beam, vv.Clamped(solid=beam, nodes=[0]), push])
        vv.simulate(system, until=1.0, step=0.01, scheme=scheme)
        ends.append(vv.Position(of=end)(system))
    assert ends[0][2] > 0.3
    assert ends[1] == pytest.approx(ends[0], abs=2e-3)


@pytest.mark.parametrize("scheme", [vv.VariationalMidpoint(), vv.GeneralizedAlpha(rho=0.9)])
def test_a_director_without_mass_turns_with_the_others(scheme: vv.Scheme) -> None:
    """A plate (moments 1, 2, 3) tumbles like one with next to no thickness; once its third director was given mass."""
    ends = []
    for third in (3.0, 3.0 - 1e-9):
        plate = vv.RigidBody(mass=1.0, inertia=(1, 2, third), angular_velocity=(0.1, 1, 0.1))
        system = vv.System([plate])
        vv.simulate(system, until=0.4, step=0.05, scheme=scheme)
        ends.append(np.concatenate([system.x[3:12], system.v[3:12]]))
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)
