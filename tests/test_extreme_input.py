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
            "thickness is for what is not axisymmetric; leave it out",
        ),
        (lambda: disc(thickness=3.0), "thickness is for what is not axisymmetric; leave it out"),
        (lambda: vv.HeatFlux(body=warm(), faces="x0", flux=True), "flux: true is no number"),
    ],
)
def test_arguments_of_another_kind(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()


def stream(**more: Any) -> list[Any]:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="tri6")
    fluid = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1, name="water", **more)
    return [fluid, vv.NoSlip(fluid=fluid, faces="all")]


def twisted(moment: Any) -> list[Any]:
    one, two = (vv.RigidBody(shape=vv.Box(size=(1, 1, 1)), density=1.0, name=name) for name in "ab")
    return [one, two, vv.TorquePair(a=one, b=two, torque=(0, 0, 30), times=moment)]


def glowing(temperature: float) -> list[Any]:
    mesh, rubber = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.NeoHooke(young=1.0, poisson=0.3)
    heat = vv.Heat(conductivity=1.0, capacity=1.0)
    return [
        vv.ThermoelasticSolid(mesh=mesh, material=rubber, heat=heat, temperature=temperature, name="cube")
    ]


def started(parts: list[Any], scheme: Any = None) -> None:
    for _ in vv.march(vv.System(parts), until=0.1, step=0.1, scheme=scheme):
        pass


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: twisted(10**400), "TorquePair: times: a function of time is a number.*, not 1000"),
        (
            lambda: started(twisted(1e308)),
            "RigidBody 'a': masses, forces or scales .* not finite at the start",
        ),
        (lambda: started(glowing(1e308), vv.Static()), "'cube': .* scales of its temperature.* not finite"),
        (lambda: started(stream(speed=5e-324)), "Fluid 'water': .* scales of its velocity.* not finite"),
    ],
)
def test_numbers_out_of_all_proportion(make: Callable[[], Any], message: str) -> None:
    """The first was an OverflowError of Python, of the others scipy and numpy said that their factors failed."""
    with pytest.raises(vv.InputError, match=message):
        make()


@pytest.mark.parametrize("values", [1.0, "a", [[1], [2, 3]], None])
def test_functions_of_places_give_arrays(values: Any) -> None:
    """Where they give anything else, the component and its argument are named, not numpy's index."""
    section = vv.HomogeneousSection(thickness=0.1, young=1.0, poisson=0.3, density=1.0)
    mesh, sheet = (vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)), vv.RectangleMesh(size=(1, 1), counts=(1, 1)))
    rubber = vv.NeoHooke(young=1.0, poisson=0.3)
    line = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2)
    rod = vv.TubeSection(radius=0.01, young=1e9, poisson=0.3, density=1.0)
    heat = vv.Heat(conductivity=1.0, capacity=1.0)
    for make, what in (
        (lambda f: vv.Beam(mesh=line, section=rod, first=f), "Beam.*: the function first"),
        (lambda f: vv.Shell(mesh=sheet, section=section, first=f), "Shell.*: the function first"),
        (
            lambda f: vv.Solid(mesh=mesh, material=rubber, density=1.0, velocity=f),
            "Solid.*: the function of velocities",
        ),
        (
            lambda f: vv.Solid(mesh=mesh, material=rubber, thermal_strain=f),
            "Solid.*: the function thermal_strain",
        ),
        (
            lambda f: vv.ThermalBeam(mesh=line, section=rod, heat=heat, slopes=f),
            "ThermalBeam.*: the function slopes",
        ),
    ):
        with pytest.raises(vv.InputError, match=f"{what} gave shape"):
            vv.System([make(lambda X: values)])
