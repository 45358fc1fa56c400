"""The check before the first step: freedoms, redundancy, contradiction, consistent states, tangents."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from reference import bricard as bricard_reference
from reference import pendulums
from scipy.integrate import solve_ivp

import visviva as vv
from visviva.system.check import check
from visviva.system.consistency import initial_acceleration, project_positions, project_velocities
from visviva.system.instant import Instant

Array = NDArray[np.float64]
GRAVITY = 9.81


def bricard() -> tuple[vv.System, list[vv.RigidBody]]:
    """IFToMM A04; see `reference.bricard`."""
    P, ground, bars = bricard_reference.STARTS, vv.Ground(), []
    for k in range(5):
        size = 0.1 + 0.9 * np.abs(P[k + 1] - P[k])
        centre = (P[k] + P[k + 1]) / 2
        bars.append(vv.RigidBody(shape=vv.Box(size=size), mass=1.0, position=centre, name=f"bar-{k + 1}"))
    chain = [ground, *bars, ground]
    axes = np.eye(3)[list(bricard_reference.AXES)]
    joints = [
        vv.Revolute(a=chain[k], b=chain[k + 1], at=P[k], axis=axes[k], name=f"hinge-{k}") for k in range(6)
    ]
    return vv.System([ground, *bars, *joints, vv.Gravity(acceleration=(0, -GRAVITY, 0))]), bars


def parallelogram(angle: float = 1.0, cranks: int = 2) -> tuple[vv.System, vv.RigidBody]:
    """A beam of mass 2 on parallel cranks of length and mass 1 about z, `angle` off the hanging position."""
    ground, down = vv.Ground(), np.array([np.sin(angle), -np.cos(angle), 0.0])
    turn = np.array([[-down[1], down[0], 0], [-down[0], -down[1], 0], [0, 0, 1]]).T
    centre = down + np.array([1, 0, 0])
    beam = vv.RigidBody(shape=vv.Box(size=(2, 0.1, 0.1)), mass=2.0, position=centre, name="beam")
    parts: list[vv.Component] = [ground, beam, vv.Gravity(acceleration=(0, -GRAVITY, 0))]
    for k, x in enumerate(np.linspace(0, 2, cranks)):
        foot = np.array([x, 0, 0])
        box = vv.Box(size=(0.1, 1, 0.1))
        crank = vv.RigidBody(shape=box, mass=1.0, position=foot + down / 2, rotation=turn, name=f"crank-{k}")
        low = vv.Revolute(a=ground, b=crank, at=foot, name=f"low-{k}")
        high = vv.Revolute(a=crank, b=beam, at=foot + down, name=f"high-{k}")
        parts += [crank, low, high]
    return vv.System(parts), beam


def four_bar(length: float = 2.0) -> vv.System:
    """Cranks on a coupler given by frames, slightly displaced, feet `length` apart."""
    ground, box = vv.Ground(), vv.Box(size=(0.1, 1, 0.1))
    a = vv.RigidBody(shape=box, mass=1.0, position=(0, 0.5, 0), velocity=(1, 0, 0), name="left")
    b = vv.RigidBody(shape=vv.Box(size=(2, 0.1, 0.1)), mass=2.0, position=(1, 1.02, 0), name="coupler")
    c = vv.RigidBody(shape=box, mass=1.0, position=(2, 0.5, 0.01), name="right")
    joints = [
        vv.Revolute(a=ground, b=a, at=(0, 0, 0), angle=True, name="foot"),
        vv.Revolute(a=a.frame((0, 0.5, 0)), b=b.frame((-1, 0, 0)), name="knee"),
        vv.Revolute(a=b.frame((1, 0, 0)), b=c.frame((0, 0.5, 0)), name="other knee"),
        vv.Revolute(a=c.frame((0, -0.5, 0)), b=ground.frame((length, 0, 0)), name="other foot"),
    ]
    return vv.System([ground, a, b, c, *joints, vv.Gravity(acceleration=(0, -GRAVITY, 0))])


def chain(n: int, joint: type[vv.Spherical] | type[vv.Revolute]) -> vv.System:
    """A straight chain of `n` bars from the ground."""
    ground = vv.Ground()
    bars = [
        vv.RigidBody(shape=vv.Box(size=(1, 0.1, 0.1)), mass=1.0, position=(k + 0.5, 0, 0)) for k in range(n)
    ]
    links = [ground, *bars]
    joints = [joint(a=links[k], b=links[k + 1], at=(k, 0, 0), axis=(0, 1, 0)) for k in range(n)]
    return vv.System([ground, *bars, *joints, vv.Gravity()])


def violations(system: vv.System) -> tuple[float, float]:
    """Largest violations of constraints and of their rates."""
    at = Instant(system)
    rates = at.G @ system.v[at.coordinates] + at.drift()
    return float(np.abs(at.violation()).max()), float(np.abs(rates).max())


# --- freedoms and redundancy --------------------------------------------------------------------------------


def test_bricard_is_found_redundant_by_name() -> None:
    report = bricard()[0].check()
    assert (report.n_coordinates, report.n_constraints) == (60, 60)
    assert (report.counted_freedoms, report.degrees_of_freedom) == (0, 1)
    (redundant,) = report.redundant
    assert redundant.component == "Revolute 'hinge-5'"
    assert set(redundant.loop) == {f"Revolute 'hinge-{k}'" for k in range(6)}
    assert "redundant constraints 1" in str(report)
    assert "hinge-5" in str(report)


@pytest.mark.parametrize(("cranks", "redundant"), [(2, 3), (3, 7)])
def test_parallelogram_has_one_freedom(cranks: int, redundant: int) -> None:
    report = parallelogram(cranks=cranks)[0].check()
    assert report.degrees_of_freedom == 1
    assert len(report.redundant) == redundant


def test_singular_position_is_an_instant_only() -> None:
    """All bars in line give the parallelogram one freedom more, but must not make it lose a constraint."""
    system, _ = parallelogram(angle=np.pi / 2)
    assert system.check().degrees_of_freedom == 2
    system.v[:] = 0.0
    result = vv.simulate(system, until=0.2, step=0.005)
    assert (
        result.ledger["defect_position"].max() < 1e-8
    )  # at the singular point itself reactions are not unique
    assert result.ledger["defect_position"][-1] < 1e-14


def stretched(
    pin: str, motion: str, null_space: bool | None = None, locked: bool = False
) -> tuple[vv.System, vv.RigidBody]:
    """A driven parallelogram that starts with all bars in one line; its beam of length 2 and one of its pins."""
    ground, box = vv.Ground(), vv.Box(size=(1, 0.1, 0.1))
    left = vv.RigidBody(shape=box, mass=1.0, position=(0.5, 0, 0), name="left")
    right = vv.RigidBody(shape=box, mass=1.0, position=(2.5, 0, 0), name="right")
    beam = vv.RigidBody(shape=vv.Box(size=(2, 0.1, 0.1)), mass=2.0, position=(2, 0, 0), name="beam")
    foot = vv.Revolute(a=ground, b=left, at=(0, 0, 0))
    axes = {} if locked else {"axis": (1, 0, 0), "first": (0, 0, 1)}  # one axis across the plane, or none
    pins = {
        "revolute": lambda: vv.Revolute(a=beam, b=right, at=(3, 0, 0)),
        "universal": lambda: vv.Universal(a=beam, b=right, at=(3, 0, 0), **axes, name="pin"),
    }
    joints = [foot, vv.Revolute(a=left, b=beam, at=(1, 0, 0)), pins[pin]()]
    joints.append(vv.Revolute(a=ground, b=right, at=(2, 0, 0)))
    parts = [ground, left, right, beam, *joints, vv.Motor(joint=foot, motion=motion)]
    return vv.System(
        [*parts, vv.Gravity(acceleration=(0, -GRAVITY, 0))], vv.Newton(null_space=null_space)
    ), beam


@pytest.mark.parametrize("null_space", [None, False])
@pytest.mark.parametrize("pin", ["revolute", "universal"])
@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.Midpoint(), vv.BackwardEuler(), vv.GeneralizedAlpha(rho=0.8)], ids=str
)
def test_motor_starts_in_a_singular_position(scheme: vv.Scheme, pin: str, null_space: bool | None) -> None:
    """Velocities that satisfy the constraints there are not unique: those of a motion are found."""
    system, beam = stretched(pin, "2*t", null_space)
    report = system.check()
    assert report.degrees_of_freedom == 1
    assert report.velocities.after < 1e-12
    result = vv.simulate(system, until=0.5, step=0.005, scheme=scheme)
    assert result.statistics.rejected == 0
    place = beam.point().position.value(system.x)
    assert place == pytest.approx([1 + np.cos(1.0), np.sin(1.0), 0], abs=1e-12)
    from_rest, beam = stretched(pin, "t**2", null_space)
    result = vv.simulate(from_rest, until=0.5, step=0.005, scheme=scheme)  # to either branch
    assert result.statistics.rejected <= 1
    end = beam.point((-1, 0, 0)).position.value(from_rest.x)
    assert end == pytest.approx([np.cos(0.25), np.sin(0.25), 0], abs=1e-12)


@pytest.mark.parametrize("turn", [0.1, 0.01, 0.001])
def test_pin_that_locks_a_mechanism_is_told(turn: float) -> None:
    """A pin neither of whose axes is across the plane lets the stretched bars move by nothing but an instant.

    In every position that the motor is turned to nothing fits, so no treatment of the singular one can help.
    """
    with pytest.raises(vv.InputError, match="no configuration satisfies all constraints"):
        stretched("universal", f"{turn} + 2*t", locked=True)[0].check()
    system, _ = stretched("universal", "2*t", locked=True)
    with pytest.raises(vv.StepFailure, match="nothing moves any more but constraints stay violated"):
        vv.simulate(system, until=1.0, step=0.01)


@pytest.mark.parametrize("joint", [vv.Spherical, vv.Revolute])
def test_long_chains_are_not_taken_for_redundant(joint: type[vv.Spherical] | type[vv.Revolute]) -> None:
    report = check(chain(300, joint), tangents=False)
    assert report.redundant == []
    assert report.degrees_of_freedom == report.counted_freedoms


def test_check_is_cheap_for_a_thousand_bodies() -> None:
    system = chain(1000, vv.Revolute)
    start = time.process_time()
    check(system, tangents=False)
    assert time.process_time() - start < 0.5


def test_bricard_converges_to_the_reference() -> None:
    reference = bricard_reference.cached()
    exact = np.array([reference[f"P3{c}"][20] for c in "xyz"])
    errors = []
    for h in (0.01, 0.005):
        system, bars = bricard()
        result = vv.simulate(system, until=5.0, step=h)
        assert result.ledger.imbalance() < 1e-9
        assert result.statistics.rejected == 0
        # no idle reactions: the weights are 49 in all
        assert max(np.abs(x[system.order == 0]).max() for x in result.states) < 50
        errors.append(np.linalg.norm(bars[2].point_at((1, -1, 1)).position.value(system.x) - exact))
    assert errors[1] < 2e-6
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("cranks", [2, 3])
def test_parallelogram_swings_like_a_pendulum(cranks: int) -> None:
    inertia = cranks * (1.01 / 12 + 0.25) + 2.0
    weight = GRAVITY * (0.5 * cranks + 2.0)
    swing = solve_ivp(
        lambda _, y: [y[1], -weight / inertia * np.sin(y[0])],
        (0, 2),
        [1.0, 0.0],
        "DOP853",
        rtol=1e-12,
        atol=1e-12,
    )
    angle = swing.y[0, -1]
    errors = []
    for h in (0.01, 0.005):
        system, beam = parallelogram(cranks=cranks)
        result = vv.simulate(system, until=2.0, step=h)
        assert result.ledger.imbalance() < 1e-9
        place = beam.point().position.value(system.x)
        errors.append(np.abs(place - (1 + np.sin(angle), -np.cos(angle), 0)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


# --- contradiction ------------------------------------------------------------------------------------------


def test_contradictory_joints_are_named() -> None:
    with pytest.raises(vv.InputError, match=r"no configuration satisfies.*'other foot' by"):
        four_bar(length=5.0).check()


def test_refused_system_keeps_its_state() -> None:
    system = four_bar(length=5.0)
    before = system.x.copy()
    with pytest.raises(vv.InputError):
        vv.simulate(system, until=1.0, step=0.1)
    assert np.array_equal(before, system.x)


def test_contradictory_rods_say_by_how_much() -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
    short = vv.Distance(a=ground.point((0, 0, 0)), b=ball.point(), length=1.0, name="short")
    other = vv.Distance(a=ground.point((5, 0, 0)), b=ball.point(), length=1.0, name="other")
    with pytest.raises(vv.InputError, match="Distance 'short' by") as caught:
        vv.System([ground, ball, short, other]).check()
    assert "Distance 'other'" in str(caught.value)


def test_motion_that_the_joints_forbid_is_refused() -> None:
    ground, ball = vv.Ground(), vv.RigidBody(shape=vv.Sphere(radius=0.1), mass=1.0)
    slide = vv.Prismatic(a=ground, b=ball, at=(0, 0, 0), axis=(0, 0, 1), name="slide")
    drive = vv.Motor(joint=slide, motion=lambda t: 0.5 * t, name="drive")
    hold = vv.PointOnPlane(a=ground, b=ball, at=(0, 0, 0), axis=(0, 0, 1), name="hold")
    with pytest.raises(vv.InputError, match="no velocities satisfy"):
        vv.System([ground, ball, slide, drive, hold]).check()


def test_coordinate_that_nothing_holds_is_refused() -> None:
    class Loose(vv.component.component.Component):
        def declare(self, model: vv.model.model.Model) -> None:
            self.angle = model.field(self, "angle", [0.0], stage=1)

        def contribute(self, model: vv.model.model.Model) -> None:
            model.load(self, "torque", self.angle.form(), 1.0, None)

    with pytest.raises(vv.InputError, match=r"angle\[0\] of Loose 'screw' has no inertia"):
        vv.System([vv.PointMass(mass=1.0), Loose(name="screw")]).check()


# --- consistent states --------------------------------------------------------------------------------------


def test_initial_state_is_projected_with_a_report() -> None:
    system = four_bar()
    report = system.check()
    position, rate = violations(system)
    assert position < 1e-14
    assert rate < 1e-14
    assert report.positions.before > 1e-3
    assert report.positions.moved["RigidBody 'coupler'"] == pytest.approx(0.02, rel=0.01)
    assert "Revolute 'foot'" in report.velocities.moved  # its angle turns with the crank
    assert "moved RigidBody 'coupler' by 0.02" in str(report)


def test_without_repair_nothing_moves() -> None:
    system = four_bar()
    x, v = system.x.copy(), system.v.copy()
    report = system.check(repair=False)
    assert np.array_equal(x, system.x)
    assert np.array_equal(v, system.v)
    assert report.positions.before > 1e-3
    assert report.positions.moved == {}


def test_consistent_state_is_left_alone() -> None:
    system, _ = parallelogram()
    project_positions(system)
    x = system.x.copy()
    assert project_positions(system).moved == {}
    assert np.array_equal(x, system.x)


def test_velocity_projection_is_orthogonal_in_mass() -> None:
    system = four_bar()
    project_positions(system)
    at = Instant(system)
    before = system.v[at.coordinates].copy()
    project_velocities(system)
    v = system.v[at.coordinates]
    assert abs(v @ (at.M @ (v - before))) < 1e-14


def driven_bar() -> tuple[vv.System, vv.Motor]:
    ground, bar = vv.Ground(), vv.RigidBody(shape=vv.Box(size=(1, 0.1, 0.1)), mass=2.0, position=(0.5, 0, 0))
    hinge = vv.Revolute(a=ground, b=bar, at=(0, 0, 0))
    motor = vv.Motor(joint=hinge, motion="0.3*sin(3*t + 0.2) - 0.3*sin(0.2)")
    return vv.System([ground, bar, hinge, motor, vv.Gravity(acceleration=(0, -GRAVITY, 0))]), motor


def test_prescribed_motion_gives_velocity_acceleration_and_torque() -> None:
    system, motor = driven_bar()
    system.check()
    initial_acceleration(system, vv.EnergyMomentum(), 0.01)
    rate, bend = 0.9 * np.cos(0.2), -2.7 * np.sin(0.2)
    assert system.v[:3] == pytest.approx([0, 0.5 * rate, 0], abs=1e-14)
    assert system.core.a[:3] == pytest.approx([-0.5 * rate**2, 0.5 * bend, 0], abs=1e-9)
    torque = (2 * 1.01 / 12 + 0.5) * bend + GRAVITY
    reaction = float(system.x[system.field(motor, "reaction").start])
    assert -reaction == pytest.approx(torque, abs=1e-8)


def test_variational_midpoint_projects_velocities() -> None:
    exact = pendulums.double([0.0, 1.0])
    errors = []
    for h in (0.01, 0.005):
        ground = vv.Ground()
        a, b = vv.PointMass(mass=1.0, position=(1, 0, 0)), vv.PointMass(mass=1.0, position=(2, 0, 0))
        rods = [vv.Distance(a=ground.point(), b=a.point()), vv.Distance(a=a.point(), b=b.point())]
        system = vv.System([ground, a, b, *rods, vv.Gravity(acceleration=(0, -GRAVITY, 0))])
        result = vv.simulate(system, until=1.0, step=h, scheme=vv.VariationalMidpoint())
        assert result.ledger["defect_velocity"].max() < 1e-13
        errors.append(abs(system.x[3] - exact["x2"][-1]) + abs(system.x[4] - exact["y2"][-1]))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


# --- tangents and bad input ---------------------------------------------------------------------------------


def test_tangents_agree_with_differences() -> None:
    assert driven_bar()[0].check().tangent.error < 1e-8


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("enforcement", ["multipliers", "penalty"])
@pytest.mark.parametrize("below", [False, True])
def test_tangents_of_a_cylinder_at_touch_are_not_called_wrong(
    below: bool, enforcement: str, friction: float
) -> None:
    """Gaps bend and have kinks within long differences."""
    drum = vv.RigidBody(
        shape=vv.Cylinder(radius=0.5, length=1.0), density=1000.0, position=(0, 0, 0.5 * (not below))
    )
    box = vv.RigidBody(shape=vv.Box(size=(0.4, 0.4, 0.4)), density=1000.0, position=(0, 0, 0.7))
    first, second = (box, drum) if below else (drum, vv.Plane())
    contact = vv.Contact(
        first=first, second=second, enforcement=enforcement, friction=friction, stiffness=1e5
    )
    report = vv.System([first, second, contact, vv.Gravity()]).check()
    assert report.tangent.error < 1e-5, report.tangent


def test_tangents_of_what_weighs_as_much_as_its_fluid() -> None:
    """It has no inertia but rounding, which must not say how long a step is."""
    rubber = vv.NeoHooke(young=1e3, poisson=0.3)
    patch = vv.RectangleMesh(size=(1, 1), counts=(4, 4), origin=(0.6, 0.07))
    solid = vv.Solid(mesh=patch, material=rubber, density=1.0)
    box = vv.RectangleMesh(size=(4, 4), counts=(8, 8), origin=(-1.5, -1.5))
    fluid = vv.Fluid(mesh=box, density=1.0, viscosity=0.1)
    system = vv.System(
        [fluid, vv.NoSlip(fluid=fluid, faces="all"), solid, vv.Immersed(solid=solid, fluid=fluid)]
    )
    assert "tangents agree" in str(system.check())


def test_wrong_tangent_is_named() -> None:
    class Wrong(vv.Term):
        def __init__(self, unknown: int) -> None:
            super().__init__()
            self.unknowns = np.array([[unknown]], dtype=np.int32)
            self.order = np.array([2], dtype=np.int32)

        def residual(self, s: object) -> Array:
            return 3.0 * s.x**2  # type: ignore[attr-defined]

        def tangent(self, s: object) -> Array:
            return 7.0 * s.x[:, :, None]  # type: ignore[attr-defined]

    class Pull(vv.component.component.Component):
        def contribute(self, model: vv.model.model.Model) -> None:
            model.term(self, Wrong(1))

    report = vv.System([vv.PointMass(mass=1.0, position=(0, 2, 0), name="ball"), Pull()]).check()
    assert report.tangent.error > 1e-3
    assert report.tangent.row == "position[1] of PointMass 'ball'"
    assert "WRONG" in str(report)


@pytest.mark.parametrize("value", [(np.nan, 0, 0), (0, np.inf, 0)])
def test_positions_that_are_no_numbers_are_refused(value: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="finite"):
        vv.PointMass(mass=1.0, position=value)


@pytest.mark.parametrize(("until", "step"), [(1.0, 0.0), (1.0, -0.1), (0.0, 0.1), (-1.0, 0.1), (1.0, np.nan)])
def test_times_that_are_not_positive_are_refused(until: float, step: float) -> None:
    with pytest.raises(vv.InputError, match=r"not a positive number|not after the present time"):
        vv.simulate(vv.System([vv.PointMass(mass=1.0)]), until=until, step=step)


@pytest.mark.parametrize("motion", ["t**3", "t**2", lambda t: t**3])
def test_motions_that_start_from_rest_violate_nothing(motion: Any) -> None:
    """Their rates at the start are round-off of nothing."""
    ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(0.1, 0.1, 0.1), position=(1, 0, 0))
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    report = vv.System([ground, arm, hinge, vv.Motor(joint=hinge, motion=motion)]).check()
    assert report.velocities.before < 1e-9
    assert "initial velocities consistent" in str(report) or callable(motion)
