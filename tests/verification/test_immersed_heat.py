"""Heat between an immersed solid and the fluid around it: balance, Newton's cooling, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

RUBBER = vv.NeoHooke(young=10.0, poisson=0.3)


def bathed(conductivity: float = 0.1, conductance: float = 2.0, n: int = 4) -> tuple[Any, ...]:
    """A warm cube in a box that swirls."""

    def swirl(X: Any) -> Any:
        x, y = np.pi * X[:, 0], np.pi * X[:, 1]
        v = [np.sin(x) ** 2 * np.sin(2 * y), -np.sin(2 * x) * np.sin(y) ** 2, 0 * x]
        return np.stack(v, axis=1) * np.sin(np.pi * X[:, 2:]) ** 2

    water = vv.Fluid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(n, n, n)),
        density=1.0,
        viscosity=0.1,
        velocity=swirl,
        name="water",
    )
    heat = vv.FluidHeat(
        fluid=water, conductivity=conductivity, capacity=3.0, temperature=300.0, reference=300.0, name="bath"
    )
    mesh = vv.BoxMesh(size=(0.3, 0.25, 0.3), counts=(2, 2, 2), origin=(0.4, 0.45, 0.35))
    warm = vv.Heat(conductivity=50.0, capacity=2.0, reference=300.0)
    cube = vv.ThermoelasticSolid(mesh=mesh, material=RUBBER, density=1.2, heat=warm, temperature=350.0)
    immersed = vv.Immersed(solid=cube, fluid=water)
    cooling = vv.ImmersedHeat(immersed=immersed, heat=heat, conductance=conductance)
    return water, heat, cube, immersed, cooling, vv.NoSlip(fluid=water, faces="all")


def test_what_the_fluid_gives_the_solid_takes() -> None:
    """While it moves through cells: energies of motion, strain and heat of both add up as the ledger says."""
    parts = bathed()
    system = vv.System(list(parts), vv.Newton(tolerance=1e-12))
    start = parts[2].positions(system.x).mean(axis=0)
    result = vv.simulate(system, until=0.5, step=0.05)
    assert np.linalg.norm(parts[2].positions(system.x).mean(axis=0) - start) > 0.02
    assert parts[2].temperatures(system.x).mean() < 340
    assert parts[1].temperatures(system.x).mean() > 300.05
    assert result.conservation()["energy"] < 1e-9


def test_a_body_that_conducts_well_cools_as_newton_says() -> None:
    """In a bath that conducts well and holds much: exp(-h A t / c V) of the difference is left."""
    water, heat, cube, immersed, cooling, wall = bathed(conductivity=1e3, conductance=0.5)
    bath = vv.PrescribedTemperature(body=heat, nodes="all", value=300.0)
    system = vv.System([water, heat, cube, immersed, cooling, wall, bath])
    vv.simulate(system, until=0.2, step=0.02)
    size = np.array([0.3, 0.25, 0.3])
    area = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
    left = np.exp(-0.5 * area * 0.2 / (2.0 * size.prod()))
    assert (cube.temperatures(system.x).mean() - 300) / 50 == pytest.approx(left, rel=2e-3)


def log(dimension: int, conductance: float = 2.0, conductivity: float = 0.1) -> tuple[Any, ...]:
    """A warm rigid body that sinks in a box."""
    if dimension == 2:
        mesh: Any = vv.RectangleMesh(size=(1, 1), counts=(8, 8), cell="quad9")
        shape: Any = vv.Cylinder(radius=0.2, length=1.0)
    else:
        mesh, shape = vv.BoxMesh(size=(1, 1, 1), counts=(5, 5, 5)), vv.Box(size=(0.4, 0.3, 0.35))
    place = np.array([0.5, 0.6, 0.0 if dimension == 2 else 0.5])
    water = vv.Fluid(mesh=mesh, density=1.0, viscosity=0.1)
    heat = vv.FluidHeat(
        fluid=water, conductivity=conductivity, capacity=3.0, temperature=300.0, reference=300.0
    )
    body = vv.RigidBody(shape=shape, density=1.5, position=place)
    wet, store = (
        vv.ImmersedBody(body=body, fluid=water),
        vv.HeatStore(capacity=0.5, temperature=350.0, body=body),
    )
    cooling = vv.ImmersedHeat(immersed=wet, heat=heat, conductance=conductance, store=store)
    weight = vv.Gravity(acceleration=(0, -1, 0))
    return store, heat, water, vv.NoSlip(fluid=water, faces="all"), body, wet, cooling, weight


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_the_fluid_gives_a_rigid_body_takes(dimension: int) -> None:
    """While it sinks; in the end both are as warm as their capacities say."""
    parts = log(dimension, conductivity=1.0)
    system = vv.System(list(parts), vv.Newton(tolerance=1e-14))
    result = vv.simulate(system, until=3.0, step=0.1)
    assert result.ledger.imbalance() < 1e-9
    common = 300 + 50 * 0.5 / (0.5 + 3.0)  # the fluid that the body displaces stores heat as well
    assert parts[0].temperature_at(system.x) == pytest.approx(common, abs=0.01)


@pytest.mark.parametrize(("dimension", "area"), [(2, 0.4 * np.pi), (3, 2 * (0.12 + 0.14 + 0.105))])
def test_a_rigid_body_cools_as_newton_says(dimension: int, area: float) -> None:
    store, heat, *others = log(dimension, conductance=0.5)
    bath = vv.PrescribedTemperature(body=heat, nodes="all", value=300.0)
    system = vv.System([store, heat, *others, bath])
    vv.simulate(system, until=0.2, step=0.02)
    left = np.exp(-0.5 * area * 0.2 / 0.5)
    assert (store.temperature_at(system.x) - 300) / 50 == pytest.approx(left, rel=2e-3)


def test_refusals_of_rigid_bodies() -> None:
    store, heat, _, _, _, wet, _, _ = log(2)
    solid = bathed()
    given: dict[str, Any] = {"immersed": wet, "heat": heat, "conductance": 1.0, "store": store}
    for options, words in (
        ({"store": None}, "give store, a vv.HeatStore"),
        ({"faces": "north"}, "leave out faces"),
        ({"immersed": solid[3], "heat": solid[1]}, "store is for rigid bodies"),
    ):
        with pytest.raises(vv.InputError, match=words):
            vv.ImmersedHeat(**{**given, **options})


def thin(kind: str, conductance: float) -> tuple[Any, ...]:
    """A warm shell or beam, for its length or area of unit size times 0.1, in a box of resting fluid."""
    warm = vv.Heat(conductivity=50.0, capacity=2.0, reference=300.0)
    body: Any
    if kind == "shell":
        grid = vv.RectangleMesh(size=(0.4, 0.4), counts=(3, 3), origin=(0.3, 0.3)).build()
        X = np.column_stack([grid.points[:, :2], np.full(len(grid.points), 0.45)])
        section: Any = vv.SolidSection(material=RUBBER, thickness=0.1, density=1.0)
        mesh: Any = vv.Mesh(X, grid.cells, face_sets=grid.face_sets)
        body, size = vv.ThermalShell(mesh=mesh, section=section, heat=warm, temperature=350.0), 0.1
    else:
        section = vv.RectangleSection(width=0.2, height=0.5, young=10.0, density=1.0)
        mesh = vv.LineMesh(points=[(0.3, 0.45, 0.5), (0.7, 0.5, 0.5)], count=3, cell=kind)
        body, size = vv.ThermalBeam(mesh=mesh, section=section, heat=warm, temperature=350.0), 0.1
    water = vv.Fluid(mesh=vv.BoxMesh(size=(1, 1, 1), counts=(4, 4, 4)), density=1.0, viscosity=0.1)
    heat = vv.FluidHeat(fluid=water, conductivity=1.0, capacity=3.0, temperature=300.0, reference=300.0)
    wet = vv.ImmersedThin(body=body, fluid=water, displaced=size)
    cooling = vv.ImmersedHeat(immersed=wet, heat=heat, conductance=conductance)
    return body, heat, water, vv.NoSlip(fluid=water, faces="all"), wet, cooling


KINDS = ["shell", "line2", "line3"]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_thin_cools_as_newton_says(kind: str) -> None:
    """``exp(-h t / c d)`` of a shell, and ``exp(-h t / c A)`` of a beam, is left in a bath that holds much."""
    body, heat, *others = thin(kind, 0.5)
    bath = vv.PrescribedTemperature(body=heat, nodes="all", value=300.0)
    system = vv.System([body, heat, *others, bath])
    vv.simulate(system, until=0.2, step=0.02)
    left = np.exp(-0.5 * 0.2 / (2.0 * 0.1))
    assert (body.temperatures(system.x) - 300) / 50 == pytest.approx(left, rel=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_what_the_fluid_gives_takes_what_is_thin(kind: str) -> None:
    """While it sinks: motion, strain and heat of both add up, and both become as warm as their capacities say."""
    parts = thin(kind, 2.0)
    system = vv.System([*parts, vv.Gravity(acceleration=(0, -0.5, 0))], vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=4.0, step=0.1)
    stored = 2.0 * 0.1 * (0.16 if kind == "shell" else float(np.hypot(0.4, 0.05)))
    common = 300 + 50 * stored / (stored + 3.0)
    assert parts[0].temperatures(system.x) == pytest.approx(common, abs=0.02)
    assert np.abs(result.ledger["imbalance"]).max() < 1e-11


def test_refusals() -> None:
    water, heat, cube, immersed, _, _ = bathed()
    plain = vv.Immersed(solid=vv.Solid(mesh=cube.grid, material=RUBBER, density=1.0), fluid=water)
    other = vv.Fluid(mesh=water.grid, density=1.0, viscosity=1.0, name="oil")
    oil = vv.FluidHeat(fluid=other, conductivity=1.0, capacity=1.0, name="oil's")
    _, bath, _, _, sheet, _ = thin("shell", 1.0)
    given: dict[str, Any] = {"immersed": immersed, "heat": heat, "conductance": 1.0}
    for options, words in (
        ({"conductance": 0.0}, "conductance = 0 is not positive"),
        ({"immersed": plain}, "carries no heat; make it a vv.ThermoelasticSolid"),
        ({"heat": oil}, "is that of Fluid 'oil'"),
        ({"faces": "north"}, "north"),
        ({"immersed": sheet, "heat": bath, "faces": "upper"}, "heat passes all sides of ThermalShell"),
    ):
        with pytest.raises(vv.InputError, match=words):
            vv.ImmersedHeat(**{**given, **options})
