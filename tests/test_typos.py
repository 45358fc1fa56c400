"""What newcomers write first, and what they are told: the cause and the cure."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import visviva as vv

BALL = vv.PointMass(mass=1.0)


@pytest.fixture(scope="module")
def bar() -> tuple[vv.Solid, vv.System, vv.Result]:
    steel = vv.LinearElastic(young=2.0, poisson=0.0)
    solid = vv.Solid(
        mesh=vv.BoxMesh(size=(4, 1, 1), counts=(1, 1, 1)), material=steel, density=1.0, name="bar"
    )
    system = vv.System([solid])
    return solid, system, vv.simulate(system, until=0.1, step=0.1)


WRITTEN: dict[str, tuple[Callable[[], Any], str]] = {
    "no system": (lambda: vv.simulate(BALL, until=1, step=0.1), "not a PointMass.*vv.System"),
    "a list": (lambda: vv.simulate([BALL], until=1, step=0.1), "simulate: .*not a list.*vv.System"),
    "a path": (lambda: vv.arc_length(BALL, until=1, step=0.1), "not a PointMass.*vv.System"),
    "marching": (lambda: list(vv.march(BALL, until=1, step=0.1)), "not a PointMass.*vv.System"),
    "modes": (lambda: vv.modes(BALL), "modes: .*not a PointMass.*vv.System"),
    "buckling": (lambda: vv.buckling(BALL), "buckling: .*not a PointMass.*vv.System"),
    "box": (lambda: vv.Box(1, 2, 3.5), r"write Box\(size=\(1, 2, 3.5\)\)"),
    "mesh of a box": (lambda: vv.BoxMesh(1, 1, 1), "BoxMesh: size: .*not 1"),
    "by place": (lambda: vv.RigidBody(1.0, (1, 1, 1)), "by name: name=, mass=, inertia="),
}  # fmt: skip


@pytest.mark.parametrize("what", WRITTEN)
def test_cause_and_cure(what: str) -> None:
    write, told = WRITTEN[what]
    with pytest.raises(vv.InputError, match=told) as caught:
        write()
    assert len(str(caught.value)) < 300


def test_names_in_results(bar: tuple[vv.Solid, vv.System, vv.Result]) -> None:
    solid, system, result = bar
    with pytest.raises(vv.InputError, match=r"bar.*nodal\('von_mises', system.x\)"):
        solid.nodal(system.x, "von_mises")
    with pytest.raises(vv.InputError, match="no field 'von_misses'; did you mean 'von_mises'"):
        solid.nodal("von_misses", system.x)
    with pytest.raises(vv.InputError, match="no column 'totl'; did you mean 'total'"):
        result.ledger["totl"]
    with pytest.raises(vv.InputError, match="no column 'totl'; did you mean 'total'"):
        result.ledger.last("totl")
    with pytest.raises(vv.InputError, match="'enrgy'; did you mean 'energy'"):
        result.assert_conserved("enrgy")


def test_names_of_the_package() -> None:
    with pytest.raises(AttributeError, match="no 'Revolut'; did you mean 'Revolute'"):
        _ = vv.Revolut
    with pytest.raises(AttributeError, match="no 'xyzzyxyzzyx'"):
        _ = vv.xyzzyxyzzyx
    assert not hasattr(vv, "__path_that_is_none__")
