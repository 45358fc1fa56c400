"""Rotation over many turns under every scheme, of a rotor, a top and a slider-crank; angles of joints in long steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from rotating import MECHANISMS, RATE, run

import visviva as vv
from visviva.component.component import Component
from visviva.linear.choice import missing_pardiso
from visviva.system.instant import Instant


def speed(system: vv.System) -> float:
    """Angular speed about z of the only body."""
    d, rates = system.x[3:12].reshape(3, 3), system.v[3:12].reshape(3, 3)
    return float(0.5 * np.cross(d, rates).sum(axis=0)[2])


def spun(rho: float, angle: float, turns: float) -> float:
    """Part of the angular speed of a free rotor that is lost in so many turns, in steps of an angle."""
    system = MECHANISMS["free rotor"]()
    h, steps = angle / RATE, round(turns * 2 * np.pi / angle)
    for _ in vv.march(system, until=steps * h, step=h, scheme=vv.GeneralizedAlpha(rho=rho)):
        pass
    return 1 - speed(system) / RATE


def linear_loss(rho: float, angle: float) -> float:
    """Part of its amplitude that a linear oscillator loses in a turn, by the spectral radius of its amplification."""
    am, af, gamma, beta = vv.GeneralizedAlpha(rho=rho).parameters()
    h = angle  # for a frequency of 1; the state is (q, v, a, w) with w = -q
    c = h * h * beta * (1 - af) / (1 - am)
    q = np.array([1, h, h * h * (0.5 - beta - beta * am / (1 - am)), h * h * beta * af / (1 - am)]) / (1 + c)
    a = ((1 - af) * -q + np.array([0, 0, -am, af])) / (1 - am)
    v = np.array([0, 1, h * (1 - gamma), 0]) + h * gamma * a
    values = np.linalg.eigvals(np.array([q, v, a, -q]))
    mode = values[np.argmin(np.abs(values - np.exp(1j * angle)))]
    return float(1 - abs(mode) ** (2 * np.pi / abs(np.angle(mode))))


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.6, 0.9])
def test_loss_per_turn_is_that_of_linear_theory(rho: float) -> None:
    """A rotor at h omega = 0.01 lost all of its energy in ten turns."""
    for angle in (0.2, 0.1):
        assert linear_loss(rho, angle) < spun(rho, angle, 1) < 2 * linear_loss(rho, angle)
    assert spun(rho, 0.2, 1) > 6 * spun(rho, 0.1, 1)  # h^3
    if rho == 0.9:
        assert spun(rho, 0.1, 1) < 1e-3


def test_damping_over_a_thousand_turns_follows_linear_theory() -> None:
    """d omega / omega per turn is one and a half times the loss of a linear oscillator at the present h omega."""
    rho, angle, lost = 0.8, 0.2, spun(0.8, 0.2, 1000)
    assert 0.02 < lost < 0.5
    once, twice = 1.0, 1.0
    for _ in range(1000):
        once -= once * linear_loss(rho, angle * once)
        twice -= 2 * twice * linear_loss(rho, angle * twice)
    assert 1 - once < lost < 1 - twice


def test_hardly_damped_rotation_stays() -> None:
    assert abs(spun(0.99, 0.1, 50)) < 1e-6


def test_radius_one_is_refused_where_motion_is_constrained() -> None:
    """What rounding leaves of rates across the constraints would alternate for ever, and grow."""
    with pytest.raises(vv.InputError, match="rho below 1"):
        spun(1.0, 0.1, 1)
    ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0))
    vv.simulate(vv.System([ball, vv.Gravity()]), until=0.1, step=0.01, scheme=vv.GeneralizedAlpha(rho=1.0))


def test_both_formulations_rotate_alike() -> None:
    """About an axis that is none of its inertia, with the null space of rigid bodies and without."""
    ends = []
    for null_space in (True, False):
        body = vv.RigidBody(mass=1.0, inertia=(1, 2, 2.5), angular_velocity=(3, 4, 5))
        system = vv.System([body], vv.Newton(null_space=null_space))
        result = vv.simulate(system, until=1.0, step=0.02, scheme=vv.GeneralizedAlpha())
        assert result.conservation()["constraint rates"] < 1e-10
        ends.append(np.concatenate([system.x[3:12], system.v[3:12], system.core.a[3:12]]))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def block(**options: Any) -> vv.Solid:
    given = {"material": vv.NeoHooke(young=1e4, poisson=0.3), "cell": "hex8", **options}
    mesh = vv.BoxMesh(size=(3, 1, 1), counts=(3, 1, 1), cell=given.pop("cell"))
    return vv.Solid(mesh=mesh, density=10.0, **given)


def on_a_block(**options: Any) -> vv.System:
    """A heavy deformable arm with a body at its tip, on a pivot."""
    arm, ground = block(**options), vv.Ground()
    body = vv.RigidBody(mass=1.0, inertia=(1, 2, 2.5), position=(3.5, 0.5, 0.5))
    tip, root = vv.RigidCoupling(solid=arm, faces="x1"), vv.RigidCoupling(solid=arm, faces="x0")
    held = vv.Spherical(a=ground, b=root, at=(0, 0.5, 0.5))
    joint = vv.Revolute(a=tip, b=body, at=(3, 0.5, 0.5), axis=(0, 0, 1))
    return vv.System([ground, arm, body, tip, root, held, joint, vv.Gravity(acceleration=(0, -9.81, 0))])


def pendulum_on_a_floor(second: vv.Component, **options: Any) -> vv.System:
    """A double pendulum that swings into a plane or block."""
    ground = vv.Ground()
    upper = vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0.5, 0, 0))
    ball = vv.RigidBody(shape=vv.Sphere(radius=0.3), density=10.0, position=(1.5, 0, 0))
    pivot = vv.Revolute(a=ground, b=upper, at=(0, 0, 0), axis=(0, 0, 1))
    elbow = vv.Revolute(a=upper, b=ball, at=(1, 0, 0), axis=(0, 0, 1))
    contact = vv.Contact(first=ball, second=second, **options)
    gravity = vv.Gravity(acceleration=(0, -9.81, 0))
    return vv.System([ground, upper, ball, pivot, elbow, second, contact, gravity])


@dataclass(eq=False, kw_only=True)
class Drawn(Component):
    """A rope of user code, which is drawn in as the clock says."""

    ball: vv.PointMass
    unit: float = 1.0

    def declare(self, model: Any) -> None:
        self.pull = model.multipliers(self, "pull", 1)

    def contribute(self, model: Any) -> None:
        unknowns = [u for f in model.fields if f.component is self.ball for u in f.unknowns]
        model.term(self, Rope([*unknowns, *self.pull.unknowns], self.unit))


class Rope(vv.Term):
    def __init__(self, unknowns: Any, unit: float) -> None:
        super().__init__()
        self.unknowns, self.order = np.array([unknowns], dtype=np.int32), np.array([2, 2, 2, 0])
        self.unit = unit

    def residual(self, s: Any) -> Any:
        x = s.x0 + s.step.theta_g * (s.x1 - s.x0)
        length = 1.0 - 0.1 * np.sin(2 * s.step.t1 / self.unit)
        stretch = (s.x1[:, :3] ** 2).sum(axis=1, keepdims=True) - length**2
        return np.hstack([2 * x[:, :3] * s.x1[:, 3:], stretch])


def drawn_pendulum() -> vv.System:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(-0.2, 0, 0.5))
    return vv.System([ball, Drawn(ball=ball), vv.Gravity(acceleration=(0, -9.81, 0))])


def floor() -> vv.Plane:
    return vv.Plane(at=(0, -0.7, 0), normal=(0, 1, 0))


def below() -> vv.Solid:
    mesh = vv.BoxMesh(size=(4, 1, 2), counts=(4, 1, 2), origin=(-2, -1.7, -1))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e4, poisson=0.3), density=10.0)


PARDISO = pytest.mark.skipif(bool(missing_pardiso()), reason="PARDISO is not installed")
PROJECTED: list[Any] = [
    pytest.param(MECHANISMS["heavy top"], id="heavy top"),
    pytest.param(MECHANISMS["slider-crank"], id="slider-crank"),
    pytest.param(on_a_block, id="solid"),
    pytest.param(lambda: on_a_block(cell="hex27"), id="wide rows", marks=PARDISO),
    pytest.param(
        lambda: on_a_block(material=vv.NeoHooke(young=1e4, poisson=0.5), formulation="mixed", cell="hex27"),
        id="pressures",
    ),
    pytest.param(lambda: pendulum_on_a_floor(floor(), stiffness=1e4, enforcement="penalty"), id="penalty"),
    pytest.param(drawn_pendulum, id="user term"),
]
PRESSED: list[Any] = [
    pytest.param(lambda: pendulum_on_a_floor(floor(), stiffness=1e4), id="multipliers"),
    pytest.param(lambda: pendulum_on_a_floor(below()), id="on a solid"),
]
PROJECTING = vv.GeneralizedAlpha(rho=0.8), vv.VariationalMidpoint()
PAIRS: list[Any] = [
    *(
        pytest.param(scheme, *p.values, id=f"{scheme}-{p.id}", marks=p.marks)
        for scheme in PROJECTING
        for p in PROJECTED
    ),
    *(pytest.param(PROJECTING[1], *p.values, id=f"{PROJECTING[1]}-{p.id}") for p in PRESSED),
]
"""The other one is refused where contact presses by multipliers."""


@pytest.mark.parametrize(("scheme", "make"), PAIRS)
def test_projections_in_core_and_in_python_agree(
    scheme: vv.Scheme, make: Callable[[], vv.System], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Systems that the core's projection is not made for take another one."""
    ends = []
    for in_core in (True, False):
        system = make()
        assert system.core.projects_rates == in_core
        vv.simulate(system, until=0.3, step=0.01, scheme=scheme)
        ends.append(np.concatenate([system.x[system.order == 2], system.v, system.core.a]))
        monkeypatch.setattr("visviva.system.problem.project_in_core", lambda *_: None)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-8)


def test_contact_is_no_mass() -> None:
    """The augmentation of closed gaps was added to the mass by which rates are projected and accelerations found."""
    system, free = (
        pendulum_on_a_floor(vv.Plane(at=(0, y, 0), normal=(0, 1, 0)), stiffness=1e4) for y in (-0.7, -9)
    )
    pressed = next(c for c in system.components if isinstance(c, vv.Contact))
    for _ in vv.march(system, until=1.0, step=0.01):
        if pressed.pressures.max() > 0:
            break
    assert pressed.pressures.max() > 0
    free.x[:], free.v[:] = system.x, system.v
    free.invalidate()
    assert abs(Instant(system).M - Instant(free).M).max() == 0.0


CONSERVING = (vv.EnergyMomentum(), vv.Midpoint())
BOUNDED = (vv.VariationalMidpoint(), vv.GeneralizedAlpha(rho=0.95), vv.GeneralizedAlpha(rho=0.9))
DISSIPATING = (vv.GeneralizedAlpha(rho=0.0), vv.BDF2(), vv.BackwardEuler())


@pytest.mark.parametrize("name", MECHANISMS)
@pytest.mark.parametrize("scheme", [*CONSERVING, *BOUNDED, *DISSIPATING], ids=str)
def test_energy_of_mechanisms_over_many_turns(scheme: vv.Scheme, name: str) -> None:
    """None of them loses or gains energy: conserved, bounded, or damped in steps of h omega = 0.1."""
    lost, rates = run(MECHANISMS[name](), scheme, turns=20)
    if scheme in CONSERVING:
        assert abs(lost) < 1e-9
    elif scheme in BOUNDED:
        assert abs(lost) < 1e-2
    else:
        assert 0 < lost < 1
    if scheme.projects_velocity:
        assert rates < 1e-12


@pytest.mark.parametrize("scheme", [*CONSERVING, vv.GeneralizedAlpha(), vv.BackwardEuler()], ids=str)
@pytest.mark.parametrize("angle", [1.0, 3.6, 5.0, 10.0, 40.0])
def test_angles_of_joints_keep_their_branch(angle: float, scheme: vv.Scheme) -> None:
    """From a step of 3.5 on the angle of a turning wheel was another one by half turns, or whole ones."""
    ground, wheel = vv.Ground(), vv.RigidBody(mass=1.0, inertia=(1, 2, 3), angular_velocity=(0, 0, 1))
    joint = vv.Revolute(a=ground, b=wheel, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    system = vv.System([ground, wheel, joint])
    told, seen = [0.0], [0.0]
    for _ in vv.march(system, until=10 * angle, step=angle, scheme=scheme):
        told.append(float(joint.coordinate("angle").value(system.x)))
        seen.append(float(np.arctan2(system.x[4], system.x[3])))
    np.testing.assert_allclose(told, np.unwrap(seen), atol=1e-10)


def test_clocks_of_any_unit_turn_the_same() -> None:
    """A rope that is drawn in within microseconds leaves the velocities of one in seconds."""

    def drawn(unit: float) -> vv.System:
        ball = vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=np.array([-0.2, 0, 0.5]) / unit)
        gravity = vv.Gravity(acceleration=np.array([0, -9.81, 0]) / unit**2)
        system = vv.System([ball, Drawn(ball=ball, unit=unit), gravity])
        vv.simulate(system, until=0.3 * unit, step=0.01 * unit, scheme=vv.VariationalMidpoint())
        return system

    seconds = drawn(1.0)
    for unit in (1e-6, 1e5):
        system = drawn(unit)
        np.testing.assert_allclose(system.x[:3], seconds.x[:3], atol=1e-9)
        np.testing.assert_allclose(system.v[:3] * unit, seconds.v[:3], atol=1e-8)


def test_a_wheel_beside_a_fluid_of_taylor_and_hood_keeps_turning() -> None:
    """Constraints of the fluid are no reason to leave out those of the wheel: it lost all of its energy in 20 turns."""

    def left(*beside: Any) -> float:
        wheel = vv.RigidBody(
            shape=vv.Cylinder(radius=0.2, length=0.1), mass=1.0, angular_velocity=(0, 0, 1.0)
        )
        result = vv.simulate(
            vv.System([wheel, *beside]), until=20.0, step=0.1, scheme=vv.GeneralizedAlpha(rho=0.9), every=1000
        )
        return float(result.ledger["total"][-1] / result.ledger["total"][0])

    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9", origin=(5, 5))
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    assert left(water, vv.NoSlip(fluid=water, faces="all")) == pytest.approx(left(), abs=1e-9)
