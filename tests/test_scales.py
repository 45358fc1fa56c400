"""Nothing depends on the size of things or on their units: models in five systems of units, small parts beside heavy
ones, steel of metres and silicon of micrometres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.system.consistency import accelerations
from visviva.system.instant import Instant

Parts = list[Any]


@dataclass(frozen=True)
class Units:
    """How many units of length, mass and time a metre, a kilogram and a second are."""

    L: float = 1.0
    M: float = 1.0
    T: float = 1.0

    @property
    def force(self) -> float:
        return self.M * self.L / self.T**2

    @property
    def pressure(self) -> float:
        return self.M / self.L / self.T**2

    @property
    def density(self) -> float:
        return self.M / self.L**3

    def at(self, *place: float) -> tuple[float, ...]:
        return tuple(self.L * x for x in place)


OTHERS = {
    "mm-t-s": Units(1e3, 1e-3, 1.0),
    "cm-g-s": Units(1e2, 1e3, 1.0),
    "um-ug-us": Units(1e6, 1e9, 1e6),
    "km-Mt-ks": Units(1e-3, 1e-9, 1e-3),
}


def motor(u: Units) -> list[float]:
    """An arm, a second one on a ball joint, and a motor whose rate does not match the start."""
    ground = vv.Ground()
    arm, end = (
        vv.RigidBody(mass=m * u.M, inertia=(0.1 * u.M * u.L**2,) * 3, position=u.at(x, 0, 0))
        for m, x in ((2.0, 1.0), (1.0, 3.0))
    )
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    ball = vv.Spherical(a=arm, b=end, at=u.at(2, 0, 0))
    drive = vv.Motor(joint=hinge, motion=f"sin(3*t/{u.T!r})")
    gravity = vv.Gravity(acceleration=(0, 0, -9.81 * u.L / u.T**2))
    system = vv.System([ground, arm, end, hinge, ball, drive, gravity])
    vv.simulate(system, until=0.3 * u.T, step=0.01 * u.T)
    return [*(np.array(system.value(end.point().position)) / u.L), drive.effort(system) / (u.force * u.L)]


def slide(u: Units) -> list[float]:
    """A slide driven against gravity: force and place."""
    ground = vv.Ground()
    inertia = tuple(u.M * u.L**2 * x for x in (0.1, 0.2, 0.3))
    body = vv.RigidBody(mass=2 * u.M, inertia=inertia, position=u.at(1, 0, 0))
    joint = vv.Prismatic(a=ground, b=body, at=u.at(1, 0, 0), axis=(0, 0, 1), stroke=True)
    drive = vv.Motor(joint=joint, motion=f"{u.L!r}*0.5*sin(3*t/{u.T!r})")
    gravity = vv.Gravity(acceleration=(0, 0, -9.81 * u.L / u.T**2))
    system = vv.System([ground, body, joint, drive, gravity])
    vv.simulate(system, until=0.3 * u.T, step=0.01 * u.T)
    return [system.value(joint.coordinate()) / u.L, drive.effort(system) / u.force / 20]


def beam(u: Units, young: float = 1e3, coupling: Any = vv.RigidCoupling) -> tuple[Parts, vv.RigidBody]:
    """A cantilever with a body at its tip, on a hinge with a spring on a massless frame."""
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=u.at(4, 1, 1), counts=(2, 1, 1), cell="hex20"),
        material=vv.NeoHooke(young=young * u.pressure, poisson=0.3),
        density=u.density,
    )
    frame, tip = coupling(solid=solid, faces="x1"), u.at(4.2, 0.5, 0.5)
    inertia = tuple(u.M * u.L**2 * x for x in (0.3, 0.2, 0.3))
    body = vv.RigidBody(mass=2 * u.M, inertia=inertia, position=tip)
    hinge = vv.Revolute(a=frame, b=body, at=tip, axis=(0, 1, 0))
    spring = vv.JointSpring(joint=hinge, stiffness=2e-3 * young * u.force * u.L)
    return [solid, vv.Fixed(solid=solid, nodes="x0"), frame, body, hinge, spring], body


def vibrating(u: Units) -> list[float]:
    frequencies: list[float] = (vv.modes(vv.System(beam(u)[0]), 5).angular * u.T).tolist()
    return frequencies


def loaded(u: Units, **options: Any) -> list[float]:
    parts, body = beam(u, **options)
    force = 1e-3 * options.get("young", 1e3) * u.force
    push = vv.Force(on=body, at=u.at(4.2, 0.5, 0.5), force=(0, force, 0), times="t")
    system = vv.System([*parts, push])
    vv.quasi_static(system, until=1.0, step=0.5)
    return [x / u.L for x in system.value(body.point().position)]


def channel(u: Units) -> list[float]:
    """A flow that starts from rest."""
    viscosity = 0.1 * u.pressure * u.T
    fluid = vv.Fluid(
        mesh=vv.RectangleMesh(size=u.at(2, 1)[:2], counts=(6, 4), cell="quad9"),
        density=u.density,
        viscosity=viscosity,
    )

    def inflow(t: float, X: Any) -> Any:
        y, still = X[:, 1] / u.L, 0 * X[:, 1]
        return np.stack([4 * y * (1 - y) * u.L / u.T * (1 - np.exp(-t / u.T)), still, still], axis=1)

    walls = [vv.NoSlip(fluid=fluid, faces=side) for side in ("y0", "y1")]
    source = vv.VelocityBoundary(fluid=fluid, faces="x0", velocity=inflow)
    system = vv.System([fluid, *walls, source, vv.Outlet(fluid=fluid, faces="x1")])
    vv.simulate(system, until=0.1 * u.T, step=0.02 * u.T)
    velocity = fluid.at(np.array(u.at(1.1, 0.4, 0))).velocities(system.x)
    return [float(x) * u.T / u.L for x in np.ravel(velocity)]


@pytest.mark.parametrize("units", OTHERS)
@pytest.mark.parametrize("model", [motor, slide, vibrating, loaded, channel])
def test_units_do_not_count(model: Callable[[Units], list[float]], units: str) -> None:
    reference = np.array(model(Units()))
    np.testing.assert_allclose(model(OTHERS[units]), reference, rtol=0, atol=1e-8 * np.abs(reference).max())


@pytest.mark.parametrize(
    ("mass", "length", "rate"), [(2e3, 10.0, 3.0), (2e3, 10.0, 0.3), (1e6, 1.0, 3.0), (1e-3, 1e3, 3.0)]
)
def test_motors_start_arms_of_any_size(mass: float, length: float, rate: float) -> None:
    ground = vv.Ground()
    arm = vv.RigidBody(
        shape=vv.Box(size=(length, 0.1, 0.1)), density=mass / length / 0.01, position=(length / 2, 0, 0)
    )
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    system = vv.System([ground, arm, hinge, vv.Motor(joint=hinge, motion=f"{rate}*t")])
    vv.simulate(system, until=0.1, step=0.01)
    place = np.array([np.cos(0.1 * rate), np.sin(0.1 * rate), 0]) * length / 2
    np.testing.assert_allclose(system.value(arm.point().position), place, rtol=0, atol=1e-9 * length)


@pytest.mark.parametrize(("mass", "size"), [(1e3, 1.0), (1e3, 10.0), (1e6, 1e2), (1e9, 1e2)])
def test_small_parts_accelerate_beside_heavy_ones(mass: float, size: float) -> None:
    """A spring turns an arm by a massless angle; the moment over its inertia about the hinge is what it gets."""
    ground, parts = vv.Ground(), []
    for z in (0.0, size, 2 * size):
        body = vv.RigidBody(mass=mass, inertia=(mass * size**2,) * 3, position=(0, 0, z))
        parts += [body, vv.Revolute(a=ground, b=body, at=(0, 0, z), axis=(0, 0, 1))]
    arm = vv.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(1, 0, 0))
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1), angle=True)
    spring = vv.JointSpring(joint=hinge, stiffness=10.0, free=0.2)
    system = vv.System([ground, *parts, arm, hinge, spring])
    at = Instant(system)
    at.factor()
    acceleration = np.zeros(len(system.x))
    acceleration[at.coordinates] = accelerations(system, at)[0]
    start = system.field(arm, "configuration").start
    np.testing.assert_allclose(acceleration[start : start + 3], (0, 2 / 1.1, 0), rtol=0, atol=1e-9)


@pytest.mark.parametrize("coupling", [vv.RigidCoupling, vv.DistributedCoupling])
@pytest.mark.parametrize("size", [1e-6, 1e-5, 1e-3, 1.0, 100.0])
def test_steel_beams_of_any_size_are_stable(size: float, coupling: Any) -> None:
    reference = loaded(Units(), coupling=coupling)
    other = Units(L=size, M=7800 * size**3, T=(7800 * size**2 / 2e8) ** 0.5)  # Young's modulus 2e11
    np.testing.assert_allclose(loaded(other, coupling=coupling), reference, rtol=0, atol=4e-8)


@pytest.mark.parametrize("size", [1e-4, 1e-5, 1e-6])
def test_modes_of_small_things(size: float) -> None:
    small = Units(L=size, M=size**3, T=1.0)
    np.testing.assert_allclose(vibrating(small), vibrating(Units()), rtol=1e-8)


@pytest.mark.parametrize(("size", "told"), [(1e-3, "0.003"), (1.0, "3"), (1e3, "3e+03")])
def test_moves_are_told_in_units_of_length(
    size: float, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three radians per second move the centre of an arm, one unit from its hinge, by so much."""
    motor(Units(L=size))
    assert f"velocity of RigidBody 'rigidbody-1' by {told}" in capsys.readouterr().err


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_differences_confirm_tangents_of_any_size(size: float) -> None:
    error = vv.System(beam(Units(L=size, M=size**3))[0]).check().tangent
    assert error is not None
    assert "agree" in str(error)


@pytest.mark.parametrize("size", [1e-7, 1.0, 1e7])
def test_what_gravity_holds_at_rest_stays_so_in_all_units(size: float) -> None:
    """Velocities were judged against 1, which rounding of the pressures came near to in small units of length."""
    mesh = vv.RectangleMesh(size=(size, size), counts=(8, 8), cell="quad9")
    water = vv.Fluid(mesh=mesh, density=1 / size**2, viscosity=0.1)
    gravity = vv.Gravity(acceleration=(0, -size, 0))
    system = vv.System([water, vv.NoSlip(fluid=water, faces="all"), gravity])
    result = vv.simulate(system, until=0.1, step=0.05)
    assert result.statistics.rejected == 0
    assert np.abs(system.x[water.flow.unknowns]).max() < 1e-12 * size
    assert np.ptp(water.pressures(system.x)) == pytest.approx(1.0, rel=1e-9)  # force by length


@pytest.mark.parametrize("speed", [1e-5, 1e5])
def test_flows_start_at_any_speed(speed: float) -> None:
    reference = np.array(channel(Units()))
    flow = channel(Units(T=1 / speed))
    np.testing.assert_allclose(flow, reference, rtol=0, atol=1e-8 * np.abs(reference).max())


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3, 1e3])
@pytest.mark.parametrize("kind", ["placed", "thrown", "swinging"])
def test_a_point_alone_is_measured_by_where_it_is_or_goes(kind: str, size: float) -> None:
    """The same numbers of iterations as in metres: its length was one, and nanometres were off by 1e-4."""

    def ran(s: float) -> tuple[Any, int]:
        def pull(t: float, x: Any, v: Any) -> Any:
            return -100 * x * (1 + x**2 / s**2)

        if kind == "thrown":
            ball = vv.PointMass(mass=1.0, velocity=(s, 0, 0))
        else:
            ball = vv.PointMass(mass=1.0, position=(s, 0, 0))
        parts: Parts = [ball, vv.GeneralizedForce(of=[ball], force=pull)]
        if kind == "swinging":
            ground = vv.Ground()
            rod = vv.Distance(a=ground.point(), b=ball.point())
            parts = [ground, ball, rod, vv.Gravity(acceleration=(0, 0, -9.81 * s))]
        system = vv.System(parts)
        result = vv.simulate(system, until=1.0, step=0.02, scheme=vv.Midpoint())
        return system.x[:3] / s, result.statistics.iterations

    (small, ours), (metres, theirs) = ran(size), ran(1.0)
    assert small == pytest.approx(metres, abs=1e-9)
    assert abs(ours - theirs) <= 2
