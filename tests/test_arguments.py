"""Constructors refuse wrong arguments with an error that names the class, the argument and the value."""

from __future__ import annotations

import ast
import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv


class Lift(vv.Force):
    """A component of a user's own, whose class does nothing about validation."""


@pytest.mark.parametrize(
    ("kind", "arguments", "message"),
    [
        (vv.PointMass, {"mass": "heavy"}, "PointMass: mass: input should be a valid number.*, not 'heavy'"),
        (
            vv.PointMass,
            {"mass": 1, "name": "load", "position": (1, 2)},
            r"PointMass 'load': position: .*3 numbers",
        ),
        (vv.PointMass, {"mass": float("nan")}, "PointMass: mass: .*finite number, not nan"),
        (vv.PointMass, {}, "PointMass: mass: this argument is needed"),
        (vv.PointMass, {"mas": 1.0}, "PointMass: mas: there is no such argument; did you mean 'mass'"),
        (
            vv.Spring,
            {"stifness": 1.0},
            "Spring: stifness: there is no such argument; did you mean 'stiffness'",
        ),
        (vv.RigidBody, {"densty": 1.0}, "RigidBody: densty: .*did you mean 'density'"),
        (vv.RigidBody, {"mass": 1, "name": 3}, "RigidBody: name: .*string, not 3"),
        (vv.Gravity, {"acceleration": (0, "down", 0)}, "Gravity: acceleration: expected numbers, not"),
        (vv.ReactionForce, {"joint": 3}, "ReactionForce: joint: .*Joint"),
        (vv.JointCoordinate, {"joint": None}, "JointCoordinate: joint: .*Joint"),
        (vv.Motor, {"joint": None, "motion": "2*t"}, "Motor"),
        (Lift, {"on": vv.PointMass(mass=1), "force": "up"}, "Lift: force: expected numbers, not 'up'"),
    ],
)
def test_what_is_wrong_is_named(kind: type, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        kind(**arguments)


def test_checks_of_the_constructor_itself_speak_for_themselves() -> None:
    with pytest.raises(vv.InputError) as caught:
        vv.PointMass(mass=-1.0, name="load")
    assert str(caught.value) == "PointMass 'load': mass -1 is not positive"


def test_input_errors_are_value_errors() -> None:
    with pytest.raises(ValueError, match="valid number"):
        vv.PointMass(mass="heavy")


def test_arguments_cannot_be_changed_in_place() -> None:
    given = np.array([1.0, 0.0, 0.0])
    ball = vv.PointMass(mass=1.0, velocity=given)
    given[0] = 7.0
    assert ball.velocity[0] == 1.0
    for one in (ball, copy.deepcopy(ball)):
        with pytest.raises(ValueError, match="read-only"):
            one.velocity[0] = 5.0
    grid = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    steel = vv.LinearElastic(young=1.0, poisson=0.3)
    system = vv.System([vv.Solid(mesh=grid, material=steel, density=1.0)])
    with pytest.raises(vv.InputError, match=r"LinearElastic: young .*replace"):
        steel.young = 2.0
    system.reset()
    with pytest.raises(vv.InputError, match=r"LinearElastic: young .*replace"):
        copy.deepcopy(steel).young = 2.0


def test_dictionaries_and_tables_cannot_be_changed_in_place() -> None:
    grid = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    with pytest.raises(vv.InputError, match="stays as it is"):
        grid.face_sets["x0"] = grid.faces("x1")
    assert pickle.loads(pickle.dumps(grid)).nodes("x0").tolist() == grid.nodes("x0").tolist()
    ramp = vv.TimeFunction([[0, 0], [1, 1]])
    with pytest.raises(TypeError):
        ramp.source[0][1] = 5.0  # type: ignore[index, union-attr, call-overload]


def test_components_of_a_refused_system_are_as_before() -> None:
    a, b = vv.PointMass(mass=1.0), vv.PointMass(mass=1.0)
    push = vv.Force(on=a, force=(1, 0, 0))
    with pytest.raises(vv.InputError, match="length 0"):
        vv.System([a, push, b, vv.Distance(a=a.point(), b=b.point())])
    with pytest.raises(vv.InputError, match="mass -5"):
        a.mass = -5.0
    a.mass = 2.0
    system = vv.System([a, push])
    vv.simulate(system, until=1.0, step=0.1)
    assert system.x[0] == pytest.approx(0.25)


def test_copies_of_components_are_in_no_system() -> None:
    a = vv.PointMass(mass=1.0)
    system = vv.System([a])
    copy.copy(a).mass = 7.0
    assert a.mass == 1.0
    vv.simulate(system, until=1.0, step=0.5)
    assert copy.deepcopy(system).time == system.time


def test_components_of_a_system_are_those_it_was_made_of() -> None:
    a = vv.PointMass(mass=1.0)
    system = vv.System([a])
    with pytest.raises(AttributeError):
        system.components.append(vv.Gravity())  # type: ignore[attr-defined]
    with pytest.raises(AttributeError):
        system.components = [a, vv.Gravity()]  # type: ignore[misc, assignment]
    with pytest.raises(vv.InputError, match="listed twice"):
        vv.System([vv.PointMass(mass=1.0)] * 2)


def test_type_checkers_see_the_constructors() -> None:
    """pyright took the metaclasses' `__call__` for the constructors: any arguments, and Any as what is made."""
    package = Path(vv.__file__).parent
    seen = [
        (file.name, made.name)
        for file in sorted(package.rglob("*.py"))
        for made in ast.walk(ast.parse(file.read_text()))
        if isinstance(made, ast.ClassDef)
        for part in made.body
        if isinstance(part, ast.FunctionDef) and part.name == "__call__" and part.args.args[0].arg == "cls"
    ]
    assert seen == []
