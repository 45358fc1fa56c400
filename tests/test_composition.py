"""Forms know who numbered their unknowns: elsewhere they are refused, and never read others by the same numbers."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy

import numpy as np
import pytest

import visviva as vv
from visviva.base.errors import InputError


def pendulum(before: int = 0, length: float = 1.0) -> vv.System:
    """An arm on a hinge, behind so many balls that take the first numbers."""
    balls = [vv.PointMass(mass=1.0, position=(k, 5, 0)) for k in range(before)]
    ground = vv.Ground(name="ground")
    arm = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(length, 0, 0), name="arm")
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1), angle=True, name="hinge")
    return vv.System([*balls, ground, arm, hinge, vv.Gravity(acceleration=(0, -9.81, 0), name="weight")])


FORMS: dict[str, Callable[[vv.System], object]] = {
    "coordinate": lambda s: s["hinge"].coordinate(),
    "twice": lambda s: 2.0 * s["hinge"].coordinate() + 1.0,
    "position": lambda s: s["arm"].point((1, 0, 0)).position,
    "height": lambda s: s["arm"].point((1, 0, 0)).position[1],
    "director": lambda s: s["arm"].frame().directors[0],
    "place": lambda s: s["arm"].place(np.array([1.0, 0, 0])),
    "field": lambda s: s.field(s["hinge"], "angle").form(),
    "vector": lambda s: s.field(s["arm"], "configuration").vector(),
    "strain": lambda s: s["hinge"].constraints(*s["hinge"].sides)[-1],
    "copied": lambda s: deepcopy(s["hinge"].coordinate()),
}


@pytest.mark.parametrize("kind", FORMS)
def test_forms_of_another_system_are_refused_where_they_are_read(kind: str) -> None:
    own, foreign = pendulum(4), FORMS[kind](pendulum())
    told = "this form sees .* of .*(hinge|arm).* in another system"
    result = vv.simulate(own, until=0.02, step=0.01)
    assert np.isfinite(result.history(FORMS[kind](own))).all()
    for read in (
        lambda: result.history(foreign),
        lambda: own.value(foreign),
        lambda: vv.simulate(own, until=0.03, step=0.01, record=[foreign]),
        lambda: vv.Study(own, until=1.0, step=0.1, probes={"foreign": foreign}),
    ):
        with pytest.raises(InputError, match=told):
            read()
    assert own.time == 0.02


def test_forms_of_a_copy_belong_to_the_copy() -> None:
    system = pendulum()
    twin = system.copy()
    assert twin.value(twin["hinge"].coordinate()) == system.value(system["hinge"].coordinate())
    with pytest.raises(InputError, match="another system"):
        twin.value(system["hinge"].coordinate())


def test_sums_of_forms_of_two_systems_are_refused() -> None:
    a, b = pendulum(), pendulum(4)
    with pytest.raises(InputError, match="forms of two systems"):
        a["hinge"].coordinate() + b["hinge"].coordinate()
    with pytest.raises(InputError, match="forms of two systems"):
        a["arm"].point().position - b["arm"].point().position


def test_a_reset_that_moves_numbers_makes_forms_stale() -> None:
    """The first body gets a mesh of more nodes, so that the arm behind it gets other numbers."""
    steel = vv.LinearElastic(young=1.0, poisson=0.0)
    block = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), material=steel, density=1.0)
    arm = vv.PointMass(mass=1.0, position=(3, 0, 0), velocity=(1, 0, 0), name="arm")
    system = vv.System([block, arm])
    before = arm.point().position
    block.mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1))
    result = vv.simulate(system, until=0.1, step=0.05, start="beginning")
    for read in (lambda: result.history(before), lambda: system.value(before)):
        with pytest.raises(InputError, match=r"sees position.* of PointMass 'arm'.*before a reset"):
            read()
    assert result.history(arm.point().position)[-1] == pytest.approx([3.1, 0, 0])


def test_a_reset_that_changes_places_makes_forms_stale() -> None:
    """Weights are those of the places where points were: numbers alone do not make them right."""
    steel = vv.LinearElastic(young=1.0, poisson=0.0)
    bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(2, 1, 1)), material=steel, density=1.0)
    system = vv.System([bar])
    before = bar.point((3, 0.5, 0.5)).position
    bar.mesh = vv.BoxMesh(size=(8, 1, 1), counts=(2, 1, 1))
    system.reset()
    with pytest.raises(InputError, match="before a reset"):
        system.value(before)
    assert system.value(bar.point((3, 0.5, 0.5)).position) == pytest.approx([3, 0.5, 0.5])


def test_a_reset_that_leaves_numbers_and_places_leaves_forms() -> None:
    system = pendulum(1)
    angle = system["hinge"].coordinate()
    ends = []
    for g in (9.81, 1.0, 9.81):
        system["weight"].acceleration = (0, -g, 0)
        result = vv.simulate(system, until=0.1, step=0.01, start="beginning", record={"angle": angle})
        ends.append(result.history("angle")[-1])
        assert ends[-1] == result.history(vv.JointCoordinate(joint=system["hinge"]))[-1]
    assert ends[0] == ends[2] != ends[1]


def test_functions_of_measures_may_not_return_forms_of_another_system() -> None:
    foreign = pendulum(4)["hinge"].coordinate()
    ball = vv.PointMass(mass=1.0)
    spring = vv.Potential(of=[lambda: foreign], energy=lambda e: 0.5 * e[0] ** 2, name="spring")
    with pytest.raises(InputError, match=r"Potential 'spring': this form sees angle.* of Revolute 'hinge'"):
        vv.System([ball, spring])


def test_terms_of_a_component_may_not_hold_forms_of_another_system() -> None:
    foreign = pendulum()["arm"].point().position[0]

    class Pull(vv.Gravity):
        def contribute(self, model: object) -> None:
            model.load(self, "pull", foreign, 1.0, None)  # type: ignore[attr-defined]

    with pytest.raises(InputError, match=r"Pull 'pull': this form sees configuration.* of RigidBody 'arm'"):
        vv.System([vv.PointMass(mass=1.0), Pull(name="pull")])


def test_inputs_of_a_servo_belong_to_its_system() -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0)
    along = vv.Position(of=ball, direction=(1, 0, 0))
    servo = vv.Servo(output=[along], follows=["t**2"], actuators=[along])
    vv.System([ground, ball, servo])
    with pytest.raises(InputError, match="not in this system"):
        servo.inputs(pendulum())
