"""Solids that repeat in space: patch of a distorted cell, momenta, refusals."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import visviva as vv

Made = Callable[[Any], Any]

ALL_SIDES = (("x0", "x1"), ("y0", "y1"), ("z0", "z1"))
GRADIENT = np.array([(0.1, 0.2, 0.0), (0.0, -0.05, 0.1), (0.05, 0.0, 0.02)])


def cell(kind: str = "hex8", **options: Any) -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 0.9, 1.1), counts=(2, 2, 2), cell=kind).build()  # type: ignore[arg-type]
    rng, points = np.random.default_rng(3), mesh.points.copy()
    inside = np.all((points > 0.01) & (points < np.array([0.99, 0.89, 1.09])), axis=1)
    points[inside] += 0.05 * rng.uniform(-1, 1, points[inside].shape)
    given = {"material": vv.NeoHooke(young=10.0, poisson=0.3), **options}
    return vv.Solid(mesh=replace(mesh, points=points), **given)


def beside() -> vv.Solid:
    mesh = vv.BoxMesh(size=(1, 0.9, 1.1), counts=(1, 1, 1)).build().moved((1, 0, 0))
    return vv.Solid(mesh=mesh, material=vv.NeoHooke(young=10.0, poisson=0.3))


@pytest.mark.parametrize("kind", ["hex8", "tet4"])
def test_a_uniform_cell_deforms_alike(kind: str) -> None:
    body = cell(kind)
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES, strain=GRADIENT, times="t")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=np.array([0]))])
    vv.quasi_static(system, until=1.0, step=0.5)
    np.testing.assert_allclose(body.displacements(system.x), body.points @ GRADIENT.T, atol=1e-9)


MIXED = [("tri6", (6, 6)), ("tri3", (6, 6)), ("tet10", (4, 4, 1)), ("wedge6", (4, 4, 1))]


def with_a_hole(kind: str, counts: tuple[int, ...], at: float) -> vv.Mesh:
    """A cell of which the cells around a place of the period are left out."""
    make: Any = vv.RectangleMesh if len(counts) == 2 else vv.BoxMesh
    size = (1, 1) if len(counts) == 2 else (1, 1, 0.25)
    mesh = make(size=size, counts=counts, cell=kind).build()
    away = np.abs((mesh.centres[:, :2] - at + 0.5) % 1 - 0.5).max(axis=1)
    mesh = vv.Mesh(points=mesh.points, cells={kind: mesh.cells[kind][away > 1 / counts[0]]}).without_orphans()
    for k, axis in enumerate("xyz"[: len(counts)]):
        for end, place in enumerate((0.0, size[k])):
            mesh = mesh.with_faces(f"{axis}{end}", lambda X, k=k, p=place: np.abs(X[:, k] - p) < 1e-9)
    return mesh


@pytest.mark.parametrize(("kind", "counts"), MIXED, ids=[kind for kind, _ in MIXED])
@pytest.mark.parametrize("poisson", [0.3, 0.4999])
def test_pressures_go_on_beyond_the_sides(kind: str, counts: tuple[int, ...], poisson: float) -> None:
    """It does not matter where a cell with a hole is cut; pressures of their own on both sides made it stiffer."""
    energies, pressures = [], []
    for at in (0.5, 0.0) if len(counts) == 3 else (0.5, 1 / 3, 0.0):
        body = vv.Solid(
            mesh=with_a_hole(kind, counts, at),
            material=vv.NeoHooke(young=10.0, poisson=poisson),
            formulation="mixed",
        )
        sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[: len(counts)], strain=GRADIENT, times="0.5*t")
        node = np.argmin(np.abs(body.points[:, :2] - (at + 0.5) % 1).sum(axis=1))
        system = vv.System([body, sides, vv.Fixed(solid=body, nodes=[node])])
        result = vv.quasi_static(system, until=1.0, step=1.0)
        energies.append(result.ledger["potential_strain"][-1])
        pressures.append(np.sort(np.unique(system.field(body, "pressure").values.round(9))))
    np.testing.assert_allclose(energies, energies[0], rtol=1e-9)
    for others in pressures[1:]:
        np.testing.assert_allclose(others, pressures[0], atol=1e-8)


@pytest.mark.parametrize("kind", ["tet4", "wedge6", "hex8"])
def test_a_uniform_cell_of_pressures_deforms_alike(kind: str) -> None:
    body = cell(kind, formulation="mixed")
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES, strain=GRADIENT, times="t")
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=np.array([0]))])
    vv.quasi_static(system, until=1.0, step=0.5)
    np.testing.assert_allclose(body.displacements(system.x), body.points @ GRADIENT.T, atol=1e-9)


def test_statics_tells_nothing_of_velocities(capsys: pytest.CaptureFixture[str]) -> None:
    """Means that follow time have rates, but load steps have none."""
    cell = vv.Solid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.0),
    )
    pairs = [("x0", "x1"), ("y0", "y1"), ("z0", "z1")]
    sides = vv.PeriodicFaces(solid=cell, pairs=pairs, strain=(0.1, 0.0, 0.0), times="t")
    system = vv.System([cell, sides, vv.Fixed(solid=cell, nodes=np.array([0]))])
    result = vv.quasi_static(system, until=1.0, step=0.5)
    assert result.ledger.moves == []
    assert "moved" not in capsys.readouterr().err
    assert not system.v.any()


def test_a_cell_that_swings_keeps_energy_and_momentum() -> None:
    body = cell(density=1.0, velocity=lambda X: np.sin(2 * np.pi * X / [1, 0.9, 1.1]) * 0.2)
    system = vv.System([body, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES)])
    figures = vv.simulate(system, until=1.0, step=0.02).conservation()
    assert figures["energy"] < 1e-10
    assert max(figures[f"momentum_{c}"] for c in "xyz") < 1e-11


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ((("x0", "y1"),), "do not meet those of 'y1'"),
        ((), "pairs is empty"),
        ((("x0", "x0"),), "is no pair of two sets"),
    ],
)
def test_refusals(pairs: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        vv.PeriodicFaces(solid=cell(), pairs=pairs)


SQUARE = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
PHASES: dict[str, Any] = {
    "free_energy": vv.PolynomialEnergy(coefficients=(0.0, 0.0, 1.0, -2.0, 1.0)),
    "gradient_energy": 1.0,
    "concentration": 0.5,
}
RUBBER: dict[str, Any] = {"material": vv.NeoHooke(young=10.0, poisson=0.3)}


@pytest.mark.parametrize(
    "make",
    [
        lambda pairs: vv.Fluid(mesh=SQUARE, density=1.0, viscosity=1.0, periodic=pairs),
        lambda pairs: vv.CahnHilliard(mesh=SQUARE, periodic=pairs, **PHASES),
        lambda pairs: vv.MixtureSolid(mesh=SQUARE, periodic=pairs, **PHASES, **RUBBER),
        lambda pairs: vv.SplineSolid(mesh=vv.SplineBox(size=(1, 1), counts=(3, 3)), periodic=pairs, **RUBBER),
        lambda pairs: vv.PeriodicFaces(solid=vv.Solid(mesh=SQUARE, **RUBBER), pairs=pairs),
    ],
)
def test_all_name_their_pairs_alike(make: Any) -> None:
    """Lists or tuples of two names, which differ: a fluid took one name twice, without a word."""
    assert make([["x0", "x1"]])
    with pytest.raises(
        vv.InputError, match=r"(periodic|pairs): \('x0', 'x0'\) is no pair of two sets of faces"
    ):
        make([["x0", "x0"]])
    with pytest.raises(vv.InputError, match=r"(periodic|pairs)"):
        make([["x0"]])


def test_supports_may_hold_both_nodes_of_a_pair_at_their_distance() -> None:
    """Simple shear between plates, of which edges lie on both sides: ``F = 1 + g e1 e2``."""
    body, g = cell(material=vv.SaintVenantKirchhoff(young=10.0, poisson=0.25)), 0.3
    plates = [
        vv.Fixed(solid=body, nodes="y0"),
        vv.Prescribed(solid=body, nodes="y1", motion=(f"{0.9 * g}*t", "0", "0")),
    ]
    sides = vv.PeriodicFaces(solid=body, pairs=(("x0", "x1"), ("z0", "z1")))
    result = vv.quasi_static(vv.System([body, *plates, sides]), until=1.0, step=0.5)
    E = 0.5 * np.array([[0, g, 0], [g, g**2, 0], [0, 0, 0]])
    density = 4.0 * (np.trace(E) ** 2 / 2 + np.tensordot(E, E))  # both constants of Lame are 4
    assert result.ledger["potential_strain"][-1] == pytest.approx(0.99 * density, rel=1e-9)


def test_a_motion_that_is_the_same_on_both_sides_moves_both() -> None:
    """As the same motion without a function of the place, and as one of the middle alone by its images."""
    u = 0.05 * np.sin(1.0)
    plates = (lambda t, X: np.stack([0.05 * np.sin(t) + 0 * X[:, 0]] * 3, axis=1), ("0.05*sin(t)",) * 3)
    found = []
    for motion in plates:
        body = cell()
        held = vv.Prescribed(solid=body, nodes="y1", motion=motion)
        sides = vv.PeriodicFaces(solid=body, pairs=(("x0", "x1"), ("z0", "z1")))
        system = vv.System([body, vv.Fixed(solid=body, nodes="y0"), held, sides])
        vv.quasi_static(system, until=1.0, step=0.5)
        found.append(body.displacements(system.x))
    assert found[0][body.nodes("y1")] == pytest.approx(u)
    np.testing.assert_allclose(*found, atol=1e-12)


def test_a_wave_along_the_period_moves_both_sides() -> None:
    body, wave = cell(), 2 * np.pi / 0.9
    moved = vv.Prescribed(
        solid=body,
        nodes="z1",
        motion=lambda t, X: 0.02 * t * np.cos(wave * X[:, [1, 1, 1]]),
        directions=(0, 0, 1),
    )
    sides = vv.PeriodicFaces(solid=body, pairs=(("x0", "x1"), ("y0", "y1")))
    system = vv.System([body, vv.Fixed(solid=body, nodes="z0"), moved, sides])
    vv.quasi_static(system, until=1.0, step=1.0)
    u = body.displacements(system.x)
    assert np.ptp(u[:, 2]) > 0.03
    for first, second in sides.pairs:
        np.testing.assert_allclose(u[body.nodes(first)], u[body.nodes(second)], atol=1e-12)


@pytest.mark.parametrize("motion", [lambda t, X: 0.1 + 0.1 * X, lambda t, X: 0.1 * t * X])
def test_motions_that_take_both_sides_apart_are_refused(motion: Any) -> None:
    body = cell()
    parts = [body, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1])]
    with pytest.raises(vv.InputError, match=r"its motion differs by .* give both the same"):
        vv.System([*parts, vv.Prescribed(solid=body, nodes="y0", motion=motion)])


APART: dict[str, Made] = {
    "fixed": lambda b: vv.Fixed(solid=b, nodes="y0"),
    "moved": lambda b: vv.Prescribed(solid=b, nodes="y0", motion=lambda t, X: 0.1 * t * X[:, [1, 1, 1]]),
    "mixed": lambda b: vv.Prescribed(solid=b, nodes="x0", motion=("t", None, None)),
}


@pytest.mark.parametrize("kind", APART)
def test_supports_that_hold_both_nodes_of_a_pair_may_not_keep_them_from_moving_apart(kind: str) -> None:
    body = cell()
    parts = [body, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1], strain=(0.1, 0, 0), times="t**2")]
    more = [vv.Fixed(solid=body, nodes="x1")] if kind == "mixed" else []
    with pytest.raises(
        vv.InputError, match=r"supports hold both the node at .* and its image at .* one side alone"
    ):
        vv.System([*parts, APART[kind](body), *more])


@pytest.mark.parametrize(
    "load",
    [
        lambda b: vv.Traction(solid=b, faces="x1", traction=(1, 0, 0)),
        lambda b: vv.Pressure(solid=b, faces="all", pressure=1.0),
        lambda b: vv.ElasticFoundation(solid=b, faces="x0", normal=1.0),
        lambda b: vv.Contact(
            first=b, first_faces="x1", second=vv.Obstacle(shape=vv.Box(size=(1, 3, 3)), at=(1.5, 0.5, 0.5))
        ),
        lambda b: vv.Tie(first=b, first_faces="x1", second=beside(), second_faces="x0"),
    ],
)
def test_loads_on_paired_faces_are_refused(load: Made) -> None:
    body = cell()
    acting = load(body)
    parts = [body, acting, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1])]
    parts += [acting.second] if getattr(acting, "second", None) is not None else []
    with pytest.raises(
        vv.InputError, match=r"the face at .* periodic faces 'x.' of Solid .*Leave such faces out"
    ):
        vv.System(parts)


def test_directors_are_not_paired() -> None:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    section = vv.HomogeneousSection(young=1.0, poisson=0.0, thickness=0.1)
    shell = vv.Shell(mesh=mesh, section=section)
    with pytest.raises(vv.InputError, match="directors of Shell would turn freely"):
        vv.PeriodicFaces(solid=shell, pairs=[("x0", "x1")])


# --- fluids and fields that are periodic themselves ----------------------------------------------------------
def stream(**options: Any) -> vv.Fluid:
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell="quad9")
    return vv.Fluid(mesh=mesh, density=1.0, viscosity=1.0, periodic=(("x0", "x1"),), **options)


def channel(*more: Made, heated: bool = False) -> vv.System:
    water = stream()
    heat = [vv.FluidHeat(fluid=water, conductivity=1.0, capacity=1.0)] if heated else []
    walls = [vv.NoSlip(fluid=water, faces="y0")] + [vv.NoSlip(fluid=water, faces="y1")] * heated
    return vv.System([water, *walls, *heat, *[m(heat[0] if heated else water) for m in more]])


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        (
            lambda w: vv.NoSlip(fluid=w, faces="x0"),
            "the face at [0.0, 0.25] is one of the periodic faces 'x0'",
        ),
        (lambda w: vv.Outlet(fluid=w, faces="x1"), "is one of the periodic faces 'x1' of Fluid"),
        (lambda w: vv.FreeSlip(fluid=w, faces="all"), "is one of the periodic faces"),
        (
            lambda w: vv.VelocityBoundary(fluid=w, faces="y1", velocity=lambda t, X: X * [1, 0, 0]),
            "at t = 0 its velocity differs by 1 between nodes of periodic faces",
        ),
    ],
)
def test_conditions_of_flows_on_periodic_faces_are_refused(condition: Made, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        channel(condition)


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        (lambda q: vv.HeatFlux(body=q, faces="x0", flux=1.0), "periodic faces 'x0' of FluidHeat"),
        (lambda q: vv.Convection(body=q, faces="all", coefficient=1.0, ambient=1.0), "periodic faces"),
        (lambda q: vv.HeatExchange(a=q, faces_a="x1", conductance=1.0, ambient=1.0), "periodic faces 'x1'"),
        (
            lambda q: vv.PrescribedTemperature(body=q, nodes="y0", value=lambda t, X: X[:, 0]),
            "at t = 0 its temperature differs by 1 between nodes of periodic faces",
        ),
    ],
)
def test_conditions_of_heat_on_periodic_faces_are_refused(condition: Made, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        channel(condition, heated=True)


def test_a_temperature_that_comes_to_differ_between_images_ends_the_run_by_name() -> None:
    late = lambda q: vv.PrescribedTemperature(body=q, nodes="y0", value=lambda t, X: t * X[:, 0])  # noqa: E731
    system = channel(late, heated=True)
    with pytest.raises(vv.RunError, match=r"PrescribedTemperature .* at t = .* its temperature differs"):
        vv.simulate(system, until=1.0, step=0.5)


def alloy(kind: str) -> Any:
    mesh: Any = vv.RectangleMesh(size=(8, 8), counts=(8, 8))
    if kind == "spline":
        mesh = vv.SplineBox(size=(8, 8), counts=(8, 8), degree=2)
    energy = vv.DoubleWell(barrier=1.0)
    return vv.CahnHilliard(
        mesh=mesh, free_energy=energy, gradient_energy=1.0, concentration=0.5, periodic=(("x0", "x1"),)
    )


@pytest.mark.parametrize("kind", ["mesh", "spline"])
def test_conditions_of_mixtures_on_periodic_faces_are_refused(kind: str) -> None:
    body = alloy(kind)
    with pytest.raises(vv.InputError, match="periodic faces 'x0' of CahnHilliard"):
        vv.Wetting(body=body, faces="x0", angle=60.0)
    vv.Wetting(body=body, faces="y0", angle=60.0)
    with pytest.raises(vv.InputError, match=r"concentration differs by 0\.8 between nodes of periodic faces"):
        vv.PrescribedConcentration(body=body, nodes="y0", value=lambda t, X: 0.1 * X[:, 0])


def cracked(seed: float) -> tuple[vv.FracturingSolid, vv.System]:
    """A cell with a crack at a place, to be stretched across it."""

    def damage(X: Any) -> Any:
        along = np.abs(X[:, 0] - seed)
        return np.maximum(1 - np.hypot(np.minimum(along, 1 - along), 2 * (X[:, 1] - 0.5)) / 0.3, 0) ** 2

    body = vv.FracturingSolid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(8, 8)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        toughness=1e-6,
        length=0.25,
        damage=damage,
    )
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:2], strain=(0, 1.0, 0), times="1e-3*t")
    return body, vv.System([body, sides, vv.Fixed(solid=body, nodes=[0])])


def test_cracks_go_on_beyond_the_sides() -> None:
    """A cell from one crack to the next is as good as one with the crack in its middle; damage is kept where it was."""
    damages, energies = [], []
    for seed in (0.5, 0.125):
        body, system = cracked(seed)
        opened = vv.quasi_static(system, until=1.5, step=0.5, scheme=vv.AlternateMinimization(unstable=True))
        energies.append(opened.ledger["total"])
        damages.append(np.array([body.damages(x)[np.lexsort(body.points.T)] for x in opened.states]))
    np.testing.assert_allclose(energies[1], energies[0], rtol=1e-9)
    middle, moved = (d.reshape(-1, 9, 9) for d in damages)
    np.testing.assert_allclose(moved[..., 0], moved[..., -1], rtol=0, atol=0)
    np.testing.assert_allclose(moved[..., :-1], np.roll(middle[..., :-1], -3, axis=2), atol=1e-6)
    assert middle[-1].sum() > 1.2 * middle[0].sum() > 0
    assert np.all(np.diff(middle, axis=0) >= -1e-12)


@pytest.mark.parametrize("made", [vv.ThermoelasticSolid, vv.ThermalFracturingSolid])
def test_heat_goes_on_beyond_the_sides(made: Any) -> None:
    """A wave with its zeros at the sides fades as ``exp(-k (2 pi / L)^2 t / c)``: through them the most heat flows."""
    n, more = 32, {"toughness": 1e6, "length": 0.1} if made is vv.ThermalFracturingSolid else {}
    body = made(
        mesh=vv.BoxMesh(size=(1, 1 / n, 1 / n), counts=(n, 1, 1)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        heat=vv.Heat(conductivity=0.05, capacity=1.0, expansion=0.0, reference=300.0),
        temperature=lambda X: 300 + 30 * np.sin(2 * np.pi * X[:, 0]),
        **more,
    )
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES)
    system = vv.System([body, sides, vv.Fixed(solid=body, nodes=[0])])
    result = vv.simulate(system, until=0.5, step=0.05)
    wave = np.exp(-0.05 * (2 * np.pi) ** 2 * 0.5) * np.sin(2 * np.pi * body.points[:, 0])
    np.testing.assert_allclose(body.temperatures(system.x), 300 + 30 * wave, rtol=0, atol=0.1)
    energies = result.ledger["total"]
    assert np.ptp(energies) < 1e-10 * np.abs(energies).max()


@pytest.mark.parametrize("held", ["x0", "both", "all"])
def test_temperatures_of_images_are_held_together(held: str) -> None:
    """Both sides of a cell are one place; between it and itself the heat of a source flows as a parabola."""
    n = 16
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1 / n, 1 / n), counts=(n, 1, 1)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.0),
        heat=vv.Heat(conductivity=2.0, capacity=1.0, expansion=0.0, reference=300.0),
    )
    sides = vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1])
    nodes = np.concatenate([body.nodes("x0"), body.nodes("x1")]) if held == "both" else held
    value: Any = 300.0 if held != "all" else lambda t, X: 300 + X[:, 0]
    others = [sides, vv.Fixed(solid=body, nodes="x0"), vv.HeatSource(body=body, power=160.0)]
    parts = [body, *others, vv.PrescribedTemperature(body=body, nodes=nodes, value=value)]
    if held == "all":
        with pytest.raises(
            vv.InputError, match="its temperature differs by 1 between nodes of periodic faces that are one"
        ):
            vv.System(parts)
        return
    system = vv.System(parts)
    vv.quasi_static(system, until=1.0, step=1.0)
    x = body.points[:, 0]
    np.testing.assert_allclose(body.temperatures(system.x), 300 + 40 * x * (1 - x), rtol=2e-4)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"damage": lambda X: X[:, 0]},
            "FracturingSolid 'cell': at t = 0 its damage differs by 1 between nodes",
        ),
        (
            {"temperature": lambda X: 300 + X[:, 0]},
            "'cell': at t = 0 its temperature differs by 1 between nodes",
        ),
        (
            {"concentration": 0.5},
            r"joins the positions of \('x0', 'x1'\), beyond which its concentrations do not go on",
        ),
    ],
)
def test_what_images_share_is_the_same_at_the_start(given: Any, words: str) -> None:
    common: Any = {"material": vv.SaintVenantKirchhoff(young=1.0, poisson=0.2), "name": "cell", **given}
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
    if "damage" in given:
        body: Any = vv.FracturingSolid(mesh=mesh, toughness=1.0, length=1.0, **common)
    elif "temperature" in given:
        body = vv.ThermoelasticSolid(mesh=mesh, heat=vv.Heat(conductivity=1.0, capacity=1.0), **common)
    else:
        energy = vv.PolynomialEnergy(coefficients=[0.0, 0.0, 1.0])
        body = vv.MixtureSolid(mesh=mesh, free_energy=energy, gradient_energy=1.0, **common)
    with pytest.raises(vv.InputError, match=words):
        vv.System([body, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1])])


def test_heat_through_paired_faces_is_refused() -> None:
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2)),
        material=vv.SaintVenantKirchhoff(young=1.0, poisson=0.2),
        heat=vv.Heat(conductivity=1.0, capacity=1.0),
    )
    flux = vv.HeatFlux(body=body, faces="x1", flux=1.0)
    with pytest.raises(vv.InputError, match=r"HeatFlux.*is one of the periodic faces 'x1'"):
        vv.System([body, flux, vv.PeriodicFaces(solid=body, pairs=ALL_SIDES[:1])])
