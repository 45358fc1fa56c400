"""Input at the ends of what numbers hold, or of another kind: refused by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import visviva as vv


@pytest.mark.parametrize("step", [1e-300, 1e-160, 1e200, 1e308])
def test_lengths_of_steps_whose_squares_are_no_numbers(step: float) -> None:
    system = vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0))])
    with pytest.raises(vv.InputError, match=r"step = .* is (not a length from|too small)"):
        vv.simulate(system, until=2 * step if step < 1 else 1.7e308, step=step)


def beam() -> Any:
    section = vv.TubeSection(radius=0.01, young=1e9, poisson=0.3, density=1.0)
    return vv.Beam(mesh=vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2), section=section)


def warm(**more: Any) -> Any:
    return vv.ThermalBody(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), conductivity=1.0, **more)


def ring(**more: Any) -> Any:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1), origin=(1, 0))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), density=1.0, **more)


def disc(**more: Any) -> Any:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(1, 1))
    return vv.ThermalBody(mesh=mesh, conductivity=1.0, axisymmetric=True, **more)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: beam().frame("x"), "arc length = 'x' is not a number"),
        (lambda: beam().frame(True), "arc length = True is not a number"),
        (lambda: warm(thickness=3.0), "thickness is for plane meshes"),
        (
            lambda: ring(plane="axisymmetric", thickness=3.0),
            "thickness is for plane strain and stress; leave it out",
        ),
        (lambda: disc(thickness=3.0), "thickness is for what is not axisymmetric; leave it out"),
        (lambda: vv.HeatFlux(body=warm(), faces="x0", flux=True), "flux: true is no number"),
    ],
)
def test_arguments_of_another_kind(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()
