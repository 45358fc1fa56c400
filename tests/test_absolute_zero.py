"""Steps do not end at or below absolute zero where temperatures count from there, and nothing is given so."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import visviva as vv

BOX = vv.BoxMesh(size=(1, 1, 1), counts=(2, 1, 1))
HEAT = vv.Heat(conductivity=1.0, capacity=5.0, expansion=1e-4, reference=300.0)
SOFT = vv.NeoHooke(young=1e3, poisson=0.3)


def solid(mesh: vv.BoxMesh = BOX) -> vv.ThermoelasticSolid:
    return vv.ThermoelasticSolid(mesh=mesh, material=SOFT, density=1e-3, heat=HEAT)


def shell() -> vv.ThermalShell:
    section = vv.SolidSection(material=SOFT, thickness=0.1, density=1e-3)
    return vv.ThermalShell(mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)), section=section, heat=HEAT)


def beam() -> vv.ThermalBeam:
    section = vv.RectangleSection(width=0.1, height=0.1, young=1e3, density=1.0)
    line = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=3)
    return vv.ThermalBeam(mesh=line, section=section, heat=HEAT)


def plain(temperature: float = 300.0, mesh: vv.BoxMesh = BOX) -> vv.ThermalBody:
    return vv.ThermalBody(mesh=mesh, conductivity=1.0, capacity=5.0, temperature=temperature)


@pytest.mark.parametrize(
    "scheme", [vv.EnergyMomentum(), vv.BackwardEuler(), vv.BDF2(), vv.GeneralizedAlpha()]
)
def test_a_solid_cools_as_one_that_balances_heat(scheme: Any) -> None:
    """By a cold bath that took it to -1000 K in the first step; steps are retried until they stay above zero."""
    ends, bar = [], vv.BoxMesh(size=(1, 1, 1), counts=(8, 1, 1))
    for body in (solid(bar), plain(mesh=bar)):
        bath = vv.Convection(body=body, faces="x0", coefficient=50.0, ambient=77.0)
        system, coldest = vv.System([body, bath]), []

        def look(now: Any, body: Any = body, coldest: list[float] = coldest) -> None:
            coldest.append(float(body.temperatures(now.x).min()))

        vv.simulate(
            system, until=2.0, step=0.2 if body.balances_entropy else 0.02, scheme=scheme, observe=look
        )
        assert min(coldest) > 0
        ends.append(body.temperatures(system.x))
    assert ends[0] == pytest.approx(ends[1], abs=9)


@pytest.mark.parametrize("body", [solid, beam])
def test_sources_that_take_out_more_than_there_is_end_the_run(body: Callable[[], Any]) -> None:
    """All states until then are above absolute zero, and the failure says where it would have been reached."""
    cooled = body()
    bath = vv.HeatExchange(a=cooled, nodes_a="all", conductance=1e4, ambient=1e-3)
    system, coldest = vv.System([cooled, bath]), [1.0]

    def look(now: Any) -> None:
        coldest.append(float(cooled.temperatures(now.x).min()))

    with pytest.raises(
        vv.RunError, match=r"node \d of .* K in the step, which is not above absolute zero: .*smaller"
    ):
        vv.simulate(system, until=1.0, step=0.1, scheme=vv.BackwardEuler(), observe=look)
    assert min(coldest) > 0


@pytest.mark.parametrize("body", [solid, shell, beam])
def test_temperatures_that_are_led_below_zero_are_refused_there(body: Callable[[], Any]) -> None:
    held = body()
    system = vv.System([held, vv.PrescribedTemperature(body=held, nodes="all", value="300 - 400*t")])
    with pytest.raises(
        vv.RunError, match=r"PrescribedTemperature.*value at t = 0.76 of -4 is not above absolute zero"
    ):
        vv.simulate(system, until=1.0, step=0.02)
    assert system.time == pytest.approx(0.74)


FALLING = [(0.0, 300.0), (0.5, 300.0), (1.0, -100.0)]


def convection(body: Any, ambient: Any) -> Any:
    faces = "upper" if isinstance(body, vv.ThermalShell) else "x0"
    return vv.Convection(body=body, faces=faces, coefficient=0.01, ambient=ambient)


def exchange(body: Any, ambient: Any) -> Any:
    where = {} if isinstance(body, vv.HeatStore) else {"nodes_a": "all"}
    return vv.HeatExchange(a=body, conductance=0.01, ambient=ambient, **where)


AROUND: list[tuple[Any, Any]] = [
    (solid, convection),
    (shell, convection),
    (beam, exchange),
    (lambda: vv.HeatStore(capacity=10.0, temperature=300.0), exchange),
]


@pytest.mark.parametrize(("body", "law"), AROUND)
def test_surroundings_below_zero_are_refused_where_entropy_is_balanced(body: Any, law: Any) -> None:
    with pytest.raises(
        vv.InputError, match=r"its ambient.* at t = 0 of -20 is not above absolute zero.*give kelvin"
    ):
        law(body(), -20.0)
    cooled = body()
    system = vv.System([cooled, law(cooled, FALLING)])
    with pytest.raises(vv.RunError, match=r"its ambient.* is not above absolute zero.*give kelvin"):
        vv.simulate(system, until=1.0, step=0.1)
    assert 0.7 < system.time < 0.95


def test_heat_alone_may_be_in_degrees_celsius() -> None:
    """The same, lower by 300 throughout."""
    ends = []
    for zero in (0.0, 300.0):
        body = plain(300.0 - zero)
        bath = vv.Convection(body=body, faces="x0", coefficient=5.0, ambient=280.0 - zero)
        system = vv.System([body, bath])
        vv.simulate(system, until=1.0, step=0.1)
        ends.append(body.temperatures(system.x) + zero)
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


@pytest.mark.parametrize(("scheme", "step"), [(vv.EnergyMomentum(), 500.0), (vv.GeneralizedAlpha(), 500.0)])
def test_radiating_bodies_do_not_swing_below_zero(scheme: Any, step: float) -> None:
    """From 1000 K to their surroundings of 300 K by long steps, of which those that went below zero are retried."""
    box = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))
    body = vv.ThermalBody(mesh=box, conductivity=50.0, capacity=1e3, temperature=1000.0)
    system = vv.System([body, vv.Radiation(body=body, faces="all", emissivity=0.8, ambient=300.0)])
    coldest = []
    result = vv.simulate(
        system,
        until=1e4,
        step=step,
        scheme=scheme,
        observe=lambda now: coldest.append(body.temperatures(now.x).min()),
    )
    assert min(coldest) > 0
    assert len(result.times) > 1e4 / step + 1
    assert body.temperatures(system.x) == pytest.approx(300.0, rel=0.02)
