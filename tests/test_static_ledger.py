"""The books of statics: work along load steps by the trapezoidal rule, exact where forces are linear."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import visviva as vv

RUBBER = vv.NeoHooke(shear=1.0, poisson=0.5)
SOFT = vv.SaintVenantKirchhoff(young=50.0, poisson=0.3)


def bar(material: vv.Material = SOFT, cell: str = "quad8", **options: Any) -> list[Any]:
    """A plane bar 4 x 1, clamped at its left end."""
    mesh = vv.RectangleMesh(size=(4, 1), counts=(4, 1), cell=cell)
    solid = vv.Solid(mesh=mesh, material=material, density=1.0, **options)
    return [solid, vv.Fixed(solid=solid, nodes="x0")]


def pulled(**options: Any) -> list[Any]:
    parts = bar(**options)
    return [*parts, vv.Traction(solid=parts[0], faces="x1", traction=(0.2, 0.5, 0.0), times="t")]


def blown() -> list[Any]:
    parts = bar()
    return [*parts, vv.Pressure(solid=parts[0], faces="y0", pressure="0.3*t")]


def moved() -> list[Any]:
    parts = bar(RUBBER, "quad9", formulation="mixed")
    return [*parts, vv.Prescribed(solid=parts[0], nodes="x1", motion=("0.3*t", "0.8*t", None))]


def turned() -> list[Any]:
    """A frame on the end, turned by a motor against the ground."""
    solid, fixed = bar()
    frame = vv.RigidCoupling(solid=solid, faces="x1")
    body = vv.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(4.0, 0.5, 0.0))
    hinge = vv.Revolute(a=vv.Ground(), b=body, at=(4.0, 0.5, 0.0), axis=(0, 0, 1), angle=True)
    weld = vv.Rigid(a=body, b=frame, at=(4.0, 0.5, 0.0))
    return [solid, fixed, frame, hinge.a, body, hinge, weld, vv.Motor(joint=hinge, motion="0.7*t")]


def bent_by_a_user() -> list[Any]:
    solid, fixed = bar()
    end = vv.Position(of=solid.point((4.0, 0.5, 0.0)), direction=(0, 1, 0))
    push = vv.GeneralizedForce(of=[end], force=lambda t, e, v: 0.05 * t * (1 + e**2))
    return [solid, fixed, push]


LINEAR: dict[str, Callable[[], list[Any]]] = {
    "traction": lambda: pulled(material=vv.LinearElastic(young=50.0, poisson=0.3)),
    "enhanced": lambda: pulled(
        material=vv.LinearElastic(young=50.0, poisson=0.3), cell="quad4", formulation="enhanced"
    ),
    "pressures": lambda: pulled(
        material=vv.LinearElastic(young=50.0, poisson=0.5), cell="quad9", formulation="mixed"
    ),
}
OTHERS: dict[str, Callable[[], list[Any]]] = {
    "traction": pulled,
    "follower pressure": blown,
    "prescribed motion": moved,
    "motor": turned,
    "force of a user": bent_by_a_user,
}


def imbalance(parts: list[Any], step: float, run: Any = vv.quasi_static) -> float:
    """Closing error relative to the work."""
    result = run(vv.System(parts), until=1.0, step=step)
    assert abs(result.ledger["total"][-1] - result.ledger["total"][0]) > 0.01
    return result.ledger.imbalance()


@pytest.mark.parametrize("make", LINEAR.values(), ids=LINEAR.keys())
def test_linear_systems_close(make: Callable[[], list[Any]]) -> None:
    """However few the steps are, and though the work of the last forces is twice what is stored."""
    assert imbalance(make(), 1.0) < 1e-12
    assert imbalance(make(), 0.4) < 1e-12


@pytest.mark.parametrize("make", OTHERS.values(), ids=OTHERS.keys())
def test_others_close_to_second_order(make: Callable[[], list[Any]]) -> None:
    coarse, fine = imbalance(make(), 0.25), imbalance(make(), 0.125)
    assert fine < 0.01
    assert 3.0 < coarse / fine < 5.5


def test_arcs_close_to_second_order() -> None:
    """Through the limit point of a shallow arch of two bars."""

    def arch(step: float) -> float:
        ground, tip = vv.Ground(), vv.PointMass(mass=1.0, position=(0.0, 0.0, 0.3))
        rods = [
            vv.Spring(
                a=ground.point((x, 0, 0)), b=tip.point(), stiffness=20.0, free_length=np.hypot(1.0, 0.3)
            )
            for x in (-1.0, 1.0)
        ]
        slide = vv.PointOnLine(a=ground, b=tip.point(), at=(0, 0, 0.3), axis=(0, 0, 1))
        push = vv.Force(on=tip, force=(0.0, 0.0, -1.0), times="t")
        system = vv.System([ground, tip, *rods, slide, push])
        result = vv.arc_length(system, step=step, until=1.0, steps=400)
        assert min(np.diff(result.times)) < 0  # past the limit point
        return result.ledger.imbalance()

    coarse, fine = arch(0.02), arch(0.01)
    assert fine < 0.01
    assert 3.0 < coarse / fine < 5.5


def pressed(step: float, **options: Any) -> vv.Result:
    """Two bricks of length 1 that overlap by 0.02 between fixed ends."""
    brick = {"material": vv.LinearElastic(young=100.0, poisson=0.0), "density": 1.0}
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build()
    low = vv.Solid(mesh=mesh, **brick)
    high = vv.Solid(mesh=mesh.moved((0, 0, 0.98)), **brick)
    contact = vv.Contact(
        first=high, first_faces="z0", second=low, second_faces="z1", initial="press", **options
    )
    ends = [vv.Fixed(solid=low, nodes="z0"), vv.Fixed(solid=high, nodes="z1")]
    return vv.quasi_static(vv.System([low, high, contact, *ends]), until=1.0, step=step)


@pytest.mark.parametrize(
    "options",
    [{}, {"stiffness": 1000.0}, {"formulation": "node-to-segment"}, {"friction": 0.3}],
    ids=["mortar", "stiff", "node-to-segment", "friction"],
)
@pytest.mark.parametrize("step", [1.0, 0.25])
def test_press_fit_does_the_work_of_its_strains(step: float, options: dict[str, Any]) -> None:
    """Each brick gives way by 0.01: 100 / 2 * 0.01^2 in each, however stiff the augmentation is."""
    ledger = pressed(step, **options).ledger
    assert ledger["potential_strain"][-1] == pytest.approx(0.01)
    assert ledger["work_contact"][-1] == pytest.approx(0.01)
    assert ledger.imbalance() < 1e-10


@pytest.mark.parametrize("options", [{}, {"tangential": "penalty"}, {"formulation": "node-to-segment"}])
def test_friction_takes_its_work(options: dict[str, Any]) -> None:
    """A brick that is pressed down by 0.02 and pushed along by 0.4: what friction takes is its limit times the way."""
    brick = {"material": vv.LinearElastic(young=100.0, poisson=0.0), "density": 1.0}
    low = vv.Solid(mesh=vv.BoxMesh(size=(3, 1, 1), counts=(1, 1, 1)), **brick)
    high = vv.Solid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), origin=(0.5, 0, 1)), **brick)
    contact = vv.Contact(first=high, first_faces="z0", second=low, second_faces="z1", friction=0.1, **options)
    motion = (lambda t: 0.4 * max(t - 1, 0), lambda t: 0.0 * t, lambda t: -0.02 * min(t, 1))
    push = vv.Prescribed(solid=high, nodes="z1", motion=motion)
    system = vv.System([low, high, contact, push, vv.Fixed(solid=low, nodes="all")])
    result = vv.quasi_static(system, until=2.0, step=0.1)
    way = (result.states[-1] - result.states[10])[high.node_unknowns(high.nodes("z0"))].mean()
    assert 0.35 < way < 0.4
    assert result.ledger["work_friction"][-1] == pytest.approx(-0.1 * 100 * 0.02 * way, rel=0.05)
    assert result.ledger.imbalance() < 1e-9


def test_loads_that_are_there_from_the_first_are_let_go() -> None:
    """Weight g on a brick held below: what held it up in the beginning takes half of what gravity does."""
    brick = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.LinearElastic(young=100.0, poisson=0.0),
        density=1.0,
    )
    system = vv.System([brick, vv.Fixed(solid=brick, nodes="z0"), vv.Gravity(acceleration=(0, 0, -10.0))])
    result = vv.quasi_static(system, until=1.0, step=0.5)
    ledger = result.ledger
    assert ledger["work_release"][-1] == pytest.approx(-ledger["potential_strain"][-1])
    assert ledger.imbalance() < 1e-12
