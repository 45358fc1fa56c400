"""Temperatures that look as if they were in degrees Celsius where kelvin are asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import visviva as vv

STEEL = vv.NeoHooke(young=1.0, poisson=0.3)
HEAT = vv.Heat(conductivity=1.0, capacity=1.0)


def cube() -> vv.BoxMesh:
    return vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1))


def solid(temperature: float) -> list[Any]:
    body = vv.ThermoelasticSolid(mesh=cube(), material=STEEL, heat=HEAT, temperature=temperature)
    return [body, vv.Fixed(solid=body, nodes="x0")]


def shell(temperature: float) -> list[Any]:
    body = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        section=vv.SolidSection(material=STEEL, thickness=0.1),
        heat=HEAT,
        temperature=temperature,
    )
    return [body, vv.Clamped(solid=body, nodes="x0")]


def beam(temperature: float) -> list[Any]:
    body = vv.ThermalBeam(
        mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2),
        section=vv.RectangleSection(width=0.1, height=0.1, young=1.0),
        heat=HEAT,
        temperature=temperature,
    )
    return [body, vv.Clamped(solid=body, nodes="start")]


def store(temperature: float) -> list[Any]:
    return [vv.HeatStore(capacity=1.0, temperature=temperature)]


def spring(temperature: float) -> list[Any]:
    ball = vv.PointMass(mass=1.0, position=(1, 0, 0))
    link = vv.ThermalSpring(a=vv.Ground(), b=ball, stiffness=1.0, capacity=1.0, temperature=temperature)
    return [ball, link]


def held(temperature: float) -> list[Any]:
    body, *fixed = solid(293.15)
    return [body, *fixed, vv.PrescribedTemperature(body=body, nodes="x1", value=temperature)]


def cooled(temperature: float) -> list[Any]:
    body, *fixed = solid(293.15)
    return [body, *fixed, vv.Convection(body=body, faces="x1", coefficient=1.0, ambient=temperature)]


def around(temperature: float) -> list[Any]:
    body = vv.HeatStore(capacity=1.0)
    return [body, vv.HeatExchange(a=body, conductance=1.0, ambient=temperature)]


def exchanging(temperature: float) -> list[Any]:
    """A body whose temperatures may be in degrees Celsius, and a store whose may not."""
    body = vv.ThermalBody(mesh=cube(), conductivity=1.0, temperature=temperature)
    other = vv.HeatStore(capacity=1.0)
    return [body, other, vv.HeatExchange(a=body, nodes_a="all", b=other, conductance=1.0)]


def radiating(temperature: float) -> list[Any]:
    body = vv.ThermalBody(mesh=cube(), conductivity=1.0, temperature=temperature)
    return [body, vv.Radiation(body=body, faces="x1", emissivity=0.5, ambient=temperature)]


ALL = [solid, shell, beam, store, spring, held, cooled, around, exchanging, radiating]


def said(parts: list[Any]) -> list[str]:
    remarks = vv.System(parts).check().remarks
    return [line for line in remarks if "absolute zero" in line or "degrees Celsius" in line]


@pytest.mark.parametrize("make", ALL)
def test_degrees_celsius_are_told_once(make: Callable[[float], list[Any]]) -> None:
    assert len(said(make(20.0))) == 1


@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("temperature", [4.2, 77.36, 90.2, 293.15])
def test_liquid_helium_nitrogen_and_oxygen_are_not_taken_for_it(
    make: Callable[[float], list[Any]], temperature: float
) -> None:
    assert said(make(temperature)) == []


def test_a_body_that_is_all_in_degrees_celsius_says_so_once() -> None:
    body, *fixed = solid(20.0)
    wind = vv.Convection(body=body, faces="x1", coefficient=1.0, ambient=15.0)
    assert len(said([body, *fixed, wind])) == 1


def test_freezing_is_told_beside_kelvin() -> None:
    assert len(said(exchanging(0.0))) == 1
