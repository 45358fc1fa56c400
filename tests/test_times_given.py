"""Whatever a component takes as a function of time may be a table, and steps know where that has kinks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import fields
from functools import cache
from typing import Any, get_type_hints

import numpy as np
import pytest
from catalogue import CATALOGUE

import visviva as vv
from visviva.component.component import Component

TIMES = 1.0, 2.0, 3.0
PULSE = [(0.0, 0.0), (5.0, 0.0), (5.1, 100.0), (5.5, 100.0), (5.6, 0.0), (10.0, 0.0)]
"""Its integral is 50, and it is nothing where a run begins."""


def of_time() -> Iterator[tuple[type, str]]:
    """All that is public with the names of its arguments that take functions of time, told by their schema."""
    for name in dir(vv):
        kind = getattr(vv, name)
        if isinstance(kind, type) and hasattr(kind, "__pydantic_config__"):
            hints = get_type_hints(kind, include_extras=True)
            yield from ((kind, f.name) for f in fields(kind) if "rows [t, value]" in str(hints.get(f.name)))


def alloy(energy: vv.FreeEnergy, mobility: Any = 1.0) -> list[Component]:
    plate = vv.RectangleMesh(size=(1, 1), counts=(2, 1))
    given: dict[str, Any] = {"free_energy": energy, "mobility": mobility}
    return [vv.CahnHilliard(mesh=plate, gradient_energy=1.0, concentration=0.5, **given)]


def steered(table: Any) -> list[Component]:
    ground, arm = vv.Ground(), vv.RigidBody(mass=2.0, inertia=(1, 1, 1), position=(1, 0, 0))
    axle = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 0, 1))
    height = vv.Position(of=arm, direction=(0, 1, 0))
    return [ground, arm, axle, vv.Servo(output=[height], follows=[table], actuators=[axle])]


BUILT: dict[type, Callable[[Any], list[Component]]] = {
    vv.RegularSolution: lambda table: alloy(vv.RegularSolution(temperature=table)),
    vv.ArrheniusMobility: lambda table: alloy(
        vv.DoubleWell(barrier=1.0), vv.ArrheniusMobility(temperature=table, base=1.0, activation=1e4)
    ),
    vv.Servo: steered,
}
"""What the catalogue does not have, or not as an argument of a component."""


def raised(now: Any) -> Any:
    """A table that begins as an argument does, where that is a function of time or one for each direction."""
    if isinstance(now, tuple):
        return tuple("free" if f is None else raised(f) for f in now)
    first = now(0.0) if isinstance(now, vv.TimeFunction) else 1.0
    return [(0.0, first), *zip(TIMES, (first, 1.01 * first + 0.01, first), strict=True)]


@cache
def found() -> dict[type, list[Any]]:
    """By their types, which lines of the catalogue have a component, and which of theirs it is."""
    places: dict[type, list[Any]] = {}
    for entry in CATALOGUE:
        for k, c in enumerate(entry.build()):
            places.setdefault(type(c), []).append((entry.build, k))
    return places


def with_table(kind: type, name: str) -> list[Component]:
    """Components of which one of some type has a table."""
    if kind in BUILT:
        return BUILT[kind](raised(vv.TimeFunction(900.0)))
    for build, k in found()[kind]:
        components = build()
        now = getattr(components[k], name)
        if now is None or isinstance(now, vv.TimeFunction | tuple):
            with suppress(vv.InputError):  # where another argument stands for it
                setattr(components[k], name, raised(now))
                return components
    raise AssertionError(f"no line of the catalogue has a {kind.__name__} of which {name} could be a table")


@pytest.mark.parametrize(("kind", "name"), list(of_time()))
def test_steps_know_the_kinks_of_all_tables(kind: type, name: str) -> None:
    """None of the component's own doing, so that new ones cannot forget it."""
    assert set(TIMES) <= set(vv.System(with_table(kind, name)).kinks)


def warm(**start: float) -> vv.ThermalBody:
    return vv.ThermalBody(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)), conductivity=1.0, capacity=10.0, **start
    )


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()]
)
@pytest.mark.parametrize(
    "heats",
    [
        lambda body: vv.HeatFlux(body=body, faces="x0", flux=PULSE),
        lambda body: vv.HeatSource(body=body, power=PULSE),
        lambda body: vv.Convection(
            body=body, faces="x0", coefficient=1e-6, ambient=[(t, 1e6 * q) for t, q in PULSE]
        ),
    ],
    ids=["flux", "source", "convection"],
)
def test_adaptive_steps_see_pulses_of_heat(heats: Any, scheme: Any) -> None:
    """They heat a body of capacity 10 by 5, and steps that see them not would not at all."""
    body = warm(temperature=0.0)
    system = vv.System([body, heats(body)])
    vv.simulate(system, until=10.0, step=0.1, scheme=scheme, adaptive=vv.Adaptive(1e-4))
    assert body.temperatures(system.x).mean() == pytest.approx(5.0, rel=1e-2)


def swept(until: float, rate: float) -> float:
    """The solution of ``y' = rate (pulse - y)`` from nothing: a sum of those of ramps."""

    def of_ramp(start: float) -> float:
        left = until - start
        return left - (1 - np.exp(-rate * left)) / rate

    return float(1000 * (of_ramp(5.0) - of_ramp(5.1) - of_ramp(5.5) + of_ramp(5.6)))


def test_adaptive_steps_see_pulses_of_surroundings() -> None:
    """A store of capacity 10 in changing surroundings."""
    store = vv.HeatStore(capacity=10.0, temperature=300.0)
    room = vv.HeatExchange(a=store, conductance=1.0, ambient=[(t, 300 + q) for t, q in PULSE])
    system = vv.System([store, room])
    vv.simulate(system, until=10.0, step=0.1, adaptive=vv.Adaptive(1e-6))
    assert store.temperature_at(system.x) == pytest.approx(300 + swept(10.0, 0.1), abs=0.01)


def test_adaptive_steps_see_pulses_of_held_temperatures() -> None:
    """One end of a rigid bar, by the other end of which heat has gone on as in a body without strains."""
    box = vv.BoxMesh(size=(1, 0.2, 0.2), counts=(5, 1, 1))
    heat = vv.Heat(conductivity=0.2, capacity=1.0, reference=1e4)
    solid = vv.ThermoelasticSolid(
        mesh=box, material=vv.NeoHooke(young=1e9, poisson=0.3), density=1e-3, heat=heat
    )
    plain = vv.ThermalBody(mesh=box, conductivity=0.2, capacity=1.0, temperature=1e4)
    ends = []
    for body in (plain, solid):
        held = vv.PrescribedTemperature(body=body, nodes="x0", value=[(t, 1e4 + q) for t, q in PULSE])
        system = vv.System([body, held])
        vv.simulate(system, until=7.0, step=0.1, adaptive=vv.Adaptive(1e-5), scheme=vv.BDF2())
        ends.append(body.temperatures(system.x)[body.nodes("x1")] - 1e4)
    assert ends[0].min() > 1
    assert ends[1] == pytest.approx(ends[0], rel=0.02)


@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha()], ids=str)
@pytest.mark.parametrize(
    ("given", "reached"),
    [
        ("300 + 20 * sqrt(t)", 300 + 20 * np.sqrt(10)),
        ("300 + 100 * min(t, 1)", 400.0),
        ("300 + 20 * log(1 + t)", 300 + 20 * np.log(11)),
    ],
)
def test_functions_may_have_no_values_before_the_start(given: str, reached: float, scheme: vv.Scheme) -> None:
    """They were asked for those of two steps before, and refused: not real, or below absolute zero."""
    heat = vv.Heat(conductivity=2.0, capacity=50.0, expansion=1e-4, reference=300.0)
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 0.3, 0.3), counts=(4, 1, 1)),
        material=vv.NeoHooke(young=1e5, poisson=0.0),
        heat=heat,
        density=1.0,
    )
    parts = [vv.PrescribedTemperature(body=body, nodes="x0", value=given), vv.Fixed(solid=body, nodes="x1")]
    system = vv.System([body, *parts])
    vv.simulate(system, until=10.0, step=5.0, scheme=scheme)
    assert body.temperatures(system.x)[body.nodes("x0")] == pytest.approx(reached)
