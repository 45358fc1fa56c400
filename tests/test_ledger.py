"""What the figures of the audit are relative to, and what is asked of unknowns before there are any."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import visviva as vv
from visviva.examples import tori, valve


def swinging(unit: float = 1.0, mass: float = 1.0) -> vv.Result:
    """Two bodies on a spring and a rod of given lengths, whose momentum vanishes; lengths in other units."""
    a = vv.PointMass(mass=2.0 * mass, position=(0, 0, 0))
    b = vv.PointMass(mass=1.0 * mass, position=(unit, 0, 0))
    c = vv.PointMass(mass=1.0 * mass, position=(2 * unit, 0, 0))
    spring = vv.Spring(a=a, b=b, stiffness=30.0 * mass, free_length=0.8 * unit)
    rod = vv.Distance(a=b.point(), b=c.point())
    return vv.simulate(vv.System([a, b, c, spring, rod]), until=1.0, step=0.01)


def test_momenta_that_vanish_are_compared_with_those_of_the_parts() -> None:
    figures = swinging().conservation()
    assert max(v for k, v in figures.items() if k.startswith(("momentum", "angular"))) < 1e-14


def test_figures_do_not_depend_on_units() -> None:
    """Millimetres, and masses in grams: the same errors up to rounding, squared lengths of constraints too."""
    one, other = swinging(), swinging(1000.0, 1e3)
    for name in ("defect_position", "defect_velocity"):
        assert one.ledger[name].max() == pytest.approx(other.ledger[name].max(), abs=1e-12)
    for name, value in one.conservation().items():
        assert value == pytest.approx(other.conservation()[name], abs=1e-13)


def test_violations_are_relative() -> None:
    """A rod of 1000 that is too long by 1 misses its squared length by 2000, and is said to by a thousandth."""
    a, b = vv.Ground(), vv.PointMass(mass=1.0, position=(1000.0, 0, 0))
    rod = vv.Distance(a=a.point(), b=b.point(), length=999.0)
    system = vv.System([a, b, rod])
    system.report = system.check(repair=False)
    books = vv.results.ledger.Bookkeeper(system)
    system.evaluate_ledger()
    defect = books.book(0.0, system.core)[-2]
    assert system.core.defect.max() == pytest.approx(0.5 * (1000**2 - 999**2), rel=1e-12)
    assert defect == pytest.approx(1e-3, rel=0.6)


def test_what_rests_has_small_figures() -> None:
    """A load on a support moves by rounding only; that is no error of its size."""
    ground, load = vv.Ground(), vv.PointMass(mass=3.0, position=(1, 2, 0))
    seat = vv.Spherical(a=ground, b=load, at=(1, 2, 0))
    result = vv.simulate(vv.System([ground, load, seat, vv.Gravity()]), until=1.0, step=0.01)
    assert max(result.conservation().values()) < 1e-5
    assert result.ledger.imbalance() < 1e-7


def test_it_goes_through_its_columns_by_name() -> None:
    result = vv.simulate(vv.System([vv.PointMass(mass=1.0, velocity=(2, 0, 0))]), until=0.2, step=0.1)
    found = {name: result.ledger[name] for name in result.ledger}
    assert found["kinetic"] == pytest.approx(2.0)
    assert list(found) == result.ledger.names
    assert "kinetic" in result.ledger
    assert "kinetics" not in result.ledger


@pytest.mark.parametrize(
    ("column", "value"),
    [("imbalance", 1e-3), ("defect_position", 1e-3), ("total", 2.0), ("momentum_z", 1e-3)],
)
def test_checks_of_examples_see_steps_that_the_table_leaves_out(column: str, value: float) -> None:
    """Of long runs it holds every so many steps; what is wrong between two of them is wrong."""
    ledger = vv.results.ledger.Ledger([], ["viscosity"])
    names = ledger.names
    for k in range(5):
        row = np.zeros(len(names))
        row[[names.index(n) for n in ("time", "total", "work_viscosity", "momentum_x")]] = k, 1.0, -1.0, 1.0
        if k == 3:
            row[names.index(column)] = value
        ledger.add(row)
    ledger.rows = ledger.rows[::2]
    result = vv.Result(vv.System([vv.PointMass(mass=1.0)]), vv.EnergyMomentum(), ledger)
    check = valve.check if column in ("imbalance", "defect_position") else tori.check
    with pytest.raises(AssertionError):
        check(result)


BODY = {"mass": 1.0, "inertia": (1, 1, 1)}
EARLY: dict[str, Callable[[], object]] = {
    "position": lambda: vv.RigidBody(**BODY, name="arm").point().position,
    "directors": lambda: vv.RigidBody(**BODY, name="arm").frame().directors,
    "point mass": lambda: vv.PointMass(mass=1.0, name="arm").point().position,
    "coordinate": lambda: vv.Revolute(
        a=vv.Ground(), b=vv.PointMass(mass=1.0), at=(0, 0, 0), name="arm"
    ).coordinate(),
    "measure": lambda: vv.Position(of=vv.RigidBody(**BODY, name="arm")).strains(),
}


@pytest.mark.parametrize("what", EARLY)
def test_unknowns_asked_for_before_there_is_a_system(what: str) -> None:
    with pytest.raises(vv.InputError, match=r"'arm' is not part of a system yet.*compose the system first"):
        EARLY[what]()


def test_ground_has_places_before_there_is_a_system() -> None:
    assert vv.Ground().point((1, 2, 3)).position.value(np.zeros(0)).tolist() == [1, 2, 3]


def test_coordinate_that_was_not_asked_for() -> None:
    ground, arm = vv.Ground(), vv.RigidBody(**BODY)
    hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), name="hinge")
    vv.System([ground, arm, hinge])
    with pytest.raises(vv.InputError, match=r"'hinge' has no coordinate 'angle'.*angle=True"):
        hinge.coordinate("angle")
