"""Beams and shells that conduct heat: both laws, expansion and bending by heat, conduction along and across."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv

HEAT = vv.Heat(conductivity=0.5, capacity=2.0, expansion=0.005, reference=20.0)
SECTION = vv.RectangleSection(width=0.1, height=0.2, young=200.0, poisson=0.3, density=1.0)
SOFT = vv.NeoHooke(young=200.0, poisson=0.3)


def line(count: int = 4, cell: str = "line2", length: float = 1.0) -> vv.LineMesh:
    return vv.LineMesh(points=[(0, 0, 0), (length, 0, 0)], count=count, cell=cell)


def flying_beam(cell: str) -> vv.ThermalBeam:
    return vv.ThermalBeam(
        mesh=line(cell=cell),
        section=SECTION,
        heat=HEAT,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        slopes=(5.0, -8.0),
        angular_velocity=(1, 2, 3),
    )


def flying_shell(profile: Any = "linear", points: int = 2) -> vv.ThermalShell:
    return vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
        section=vv.SolidSection(material=SOFT, thickness=0.1, density=1.0, points=points),
        profile=profile,
        heat=HEAT,
        temperature=lambda X: 20 + 3 * X[:, 0] ** 2,
        difference=lambda X: 2 + X[:, 1],
        angular_velocity=(1, 2, 3),
    )


@pytest.mark.parametrize("h", [0.01, 0.05])
@pytest.mark.parametrize("body", ["line2", "line3", "shell", "quadratic shell"])
def test_both_laws_hold_to_rounding(body: str, h: float) -> None:
    shells = {"shell": (), "quadratic shell": ("quadratic", 3)}
    thing: Any = flying_shell(*shells[body]) if body in shells else flying_beam(body)
    system, entropy = vv.System([thing], vv.Newton(tolerance=1e-13)), []
    result = vv.simulate(
        system, until=10 * h, step=h, observe=lambda s: entropy.append(thing.total_entropy(s.x))
    )
    kept = result.conservation()
    assert kept["energy"] < 2e-12
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-13
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize("length", [1e-3, 1e3])
def test_no_unit_of_length_decides_where_a_step_ends(length: float) -> None:
    """Extension is not weighed against curvature, nor a mean temperature against slopes."""

    def after(u: float) -> np.ndarray:
        section = vv.RectangleSection(
            width=0.1 * u, height=0.2 * u, young=200.0 / u, poisson=0.3, density=1 / u**3
        )
        beam = vv.ThermalBeam(
            mesh=line(length=u),
            section=section,
            heat=vv.Heat(conductivity=0.5 * u, capacity=2.0 / u, expansion=0.05, reference=20.0),
            temperature=lambda X: 20 + 3 * (X[:, 0] / u) ** 2,
            slopes=(5.0 / u, -8.0 / u),
            angular_velocity=(1, 2, 3),
        )
        system = vv.System([beam], vv.Newton(tolerance=1e-13))
        result = vv.simulate(system, until=0.5, step=0.1)
        assert result.conservation()["energy"] < 1e-11
        return np.asarray(beam.temperatures(system.x))

    expected = after(1.0)
    assert after(length) == pytest.approx(expected, rel=1e-9)


STEEL = vv.Heat(conductivity=1e-12, capacity=3.6e6, expansion=1.2e-5, reference=293.15)


def settled(parts: list[Any], until: float = 1.0) -> vv.System:
    """Without inertia: where its energy is least while heat stays."""
    system = vv.System(parts)
    vv.simulate(system, until=until, step=until / 2, scheme=vv.BackwardEuler())
    return system


def strip(slopes: Any, rise: float = 0.0) -> vv.ThermalBeam:
    section = vv.RectangleSection(width=0.02, height=0.05, young=210e9, poisson=0.3)
    return vv.ThermalBeam(
        mesh=line(8, length=2.0), section=section, heat=STEEL, temperature=293.15 + rise, slopes=slopes
    )


def test_a_beam_that_is_free_grows_and_curves() -> None:
    """alpha rise L along, alpha dT/h L^2 / 2 across, and nothing is felt in the sections."""
    per_height = 1.0 / 0.05
    beam = strip((0.0, per_height), 30.0)
    system = settled([beam, vv.Clamped(solid=beam, nodes="start")])
    end = beam.displacements(system.x)[beam.nodes("end")[0]]
    assert end[0] == pytest.approx(1.2e-5 * 30 * 2.0, rel=3e-3)
    across = np.linalg.norm(end[1:])
    assert across == pytest.approx(1.2e-5 * per_height * 2.0**2 / 2, rel=3e-3)  # it cools as it grows
    moment = 210e9 * 0.02 * 0.05**3 / 12 * 1.2e-5 * per_height
    assert np.abs(beam.resultants(system.x)[..., 3:5]).max() < 2e-3 * moment


@pytest.mark.parametrize("direction", [0, 1])
def test_a_strip_that_is_held_feels_its_difference_across(direction: int) -> None:
    """M = E I alpha dT / h, and N = -E A alpha rise."""
    h, I = ((0.02, 0.05 * 0.02**3 / 12), (0.05, 0.02 * 0.05**3 / 12))[direction]
    slopes = np.zeros(2)
    slopes[direction] = 40.0 / h
    beam = strip(tuple(slopes), 10.0)
    held = [vv.Clamped(solid=beam, nodes=n) for n in ("start", "end")]
    system = settled([beam, *held])
    found = beam.resultants(system.x)
    moments = np.abs(found[..., 3:5])
    assert moments.max(axis=2) == pytest.approx(210e9 * I * 1.2e-5 * 40.0 / h, rel=1e-6)
    assert found[..., 2] == pytest.approx(-210e9 * 1e-3 * 1.2e-5 * 10.0, rel=1e-6)


def test_a_solid_strip_feels_the_same() -> None:
    """M = E I alpha dT / h of bricks of second order, held at both ends, free at their sides."""
    height, width, young = 0.05, 0.02, 210e9
    mesh = vv.BoxMesh(size=(0.3, width, height), counts=(8, 2, 2), cell="hex20", origin=(0, 0, -height / 2))
    solid = vv.ThermoelasticSolid(
        mesh=mesh,
        material=vv.SaintVenantKirchhoff(young=young, poisson=0.0),
        heat=STEEL,
        temperature=lambda X: 293.15 + 40.0 * X[:, 2] / height,
    )
    held = [vv.Fixed(solid=solid, nodes=n) for n in ("x0", "x1")]
    system = settled([solid, *held])
    stress = solid.fields(system.x)
    middle = np.abs(solid.grid.points[solid.grid.cells["hex20"]].mean(axis=1)[:, 0] - 0.15) < 0.05
    from visviva.body.element import geometry

    nodes = solid.grid.cells["hex20"]
    g = geometry(solid.points, nodes, "hex20")
    z = np.einsum("qk,mk->mq", vv_shape(), solid.points[nodes][:, :, 2])
    length = g.volume[middle].sum() / (width * height)
    moment = (g.volume * stress.first_piola[..., 0, 0] * z)[middle].sum() / length
    T, inner = solid.temperatures(system.x), np.abs(solid.points[:, 0] - 0.15) < 0.05
    above, below = (
        T[inner & np.isclose(solid.points[:, 2], side)].mean() for side in (height / 2, -height / 2)
    )
    assert above - below == pytest.approx(40.0, rel=6e-3)  # what is free to grow sideways cools a little
    inertia = width * height**3 / 12
    assert abs(moment) == pytest.approx(young * inertia * 1.2e-5 * (above - below) / height, rel=1e-3)


def vv_shape() -> Any:
    """Shape functions of hex20 at the points of its stiffness."""
    from visviva.mesh.cells import CELLS
    from visviva.mesh.quadrature import stiffness_rule

    return CELLS["hex20"].N(stiffness_rule("hex20").points)


def test_heat_flows_along_a_beam_as_along_a_bar() -> None:
    """exp(-kappa (pi / L)^2 t) of a cosine, and exp(-12 kappa / h^2 t) of a difference across."""
    heat = vv.Heat(conductivity=2.0, capacity=4.0, reference=300.0)
    section = vv.RectangleSection(width=0.4, height=0.5, young=1e6, density=1e3)
    beam = vv.ThermalBeam(
        mesh=line(24),
        section=section,
        heat=heat,
        temperature=lambda X: 300 + 1e-2 * np.cos(np.pi * X[:, 0]),
        slopes=(0.0, 1e-2),
    )
    system = vv.System([beam])
    vv.simulate(system, until=0.04, step=0.0005)
    found = beam.section_temperatures(system.x)
    assert found[0, 0] - 300 == pytest.approx(1e-2 * np.exp(-0.5 * np.pi**2 * 0.04), rel=3e-3)
    assert found[5, 2] == pytest.approx(1e-2 * np.exp(-12 * 0.5 / 0.5**2 * 0.04), rel=3e-3)


def test_power_and_held_ends_of_a_beam() -> None:
    """Parabola of a bar that is heated evenly: q L^2 / 8 k A in its middle; everything is booked."""
    heat = vv.Heat(conductivity=2.0, capacity=0.1, reference=300.0)
    section = vv.RectangleSection(width=0.4, height=0.5, young=1e6)
    beam = vv.ThermalBeam(mesh=line(8), section=section, heat=heat)
    parts: list[Any] = [vv.Clamped(solid=beam, nodes="start"), vv.HeatSource(body=beam, power=1.0)]
    parts += [vv.PrescribedTemperature(body=beam, nodes=n, value=300.0) for n in ("start", "end")]
    system = vv.System([beam, *parts])
    result = vv.simulate(system, until=0.5, step=0.01)
    middle = beam.nodes("all")[np.abs(beam.points[:, 0] - 0.5) < 1e-9]
    assert beam.temperatures(system.x)[middle] - 300 == pytest.approx(1 / (8 * 2.0 * 0.2), rel=5e-3)
    assert result.ledger.imbalance() < 1e-10


@pytest.mark.parametrize("mean", [150.0, 300.0, 900.0])
def test_slopes_even_out_alike_at_any_temperature(mean: float) -> None:
    """exp(-k A t / c I_i) of slopes small beside the mean, along both axes, however far that is from the reference."""
    k, c, width, height = 2.0, 5.0, 0.2, 0.3
    beam = vv.ThermalBeam(
        mesh=line(2),
        section=vv.RectangleSection(width=width, height=height, young=10.0, density=1.0),
        heat=vv.Heat(conductivity=k, capacity=c, reference=300.0),
        temperature=mean,
        slopes=(2.0, 5.0),
    )
    system = vv.System([beam])
    vv.simulate(system, until=0.005, step=2e-4)
    left = np.exp(-12 * k / (c * np.array([width, height]) ** 2) * 0.005)
    assert beam.section_temperatures(system.x)[:, 1:] == pytest.approx(
        np.tile(left * (2.0, 5.0), (3, 1)), rel=2e-3
    )


@pytest.mark.parametrize(("axis", "height"), [(0, 0.1), (1, 0.2)])
def test_steep_slopes_are_those_of_a_plate(axis: int, height: float) -> None:
    """A section with two points across is a strip of `ThermalShell` with two: from 100 to 500 K they even out alike."""
    heat, apart = vv.Heat(conductivity=2.0, capacity=5.0, reference=250.0), 400.0
    slopes = np.zeros(2)
    slopes[axis] = apart / height
    beam = vv.ThermalBeam(
        mesh=line(2), section=SECTION, heat=heat, temperature=300.0, slopes=tuple(slopes.tolist())
    )
    shell = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        section=vv.SolidSection(material=SOFT, thickness=height, density=1.0),
        heat=heat,
        temperature=300.0,
        difference=apart,
    )
    found, begun = [], []
    for body in (beam, shell):
        system = vv.System([body], vv.Newton(tolerance=1e-13))
        begun.append(body.temperatures(system.x)[0])
        time = height**2 * 5.0 / (12 * 2.0)
        result = vv.simulate(system, until=time, step=time / 20)
        assert np.ptp(result.ledger["total"]) < 1e-12 * result.ledger["total"][0]
        faces = (
            body.face_temperatures(system.x)[0]
            if isinstance(body, vv.ThermalShell)
            else body.section_temperatures(system.x)[0, 0]
            + height / 2 * body.section_temperatures(system.x)[0, 1 + axis] * np.array([-1.0, 1.0])
        )
        found.append(faces)
    assert begun == pytest.approx([300.0, 300.0], abs=1e-8)
    assert found[0] == pytest.approx(found[1], abs=1e-6)
    assert np.ptp(found[0]) < 0.5 * apart


@pytest.mark.parametrize("cell", ["line2", "line3", "line4"])
def test_a_free_beam_feels_nothing_however_warm_its_ends(cell: str) -> None:
    """Temperatures linear along it and across it leave no force and no moment."""
    beam = vv.ThermalBeam(
        mesh=line(4, cell, length=2.0),
        section=vv.RectangleSection(width=0.1, height=0.2, young=1e6, poisson=0.3),
        heat=vv.Heat(conductivity=1e-9, capacity=1e4, expansion=1e-5, reference=300.0),
        temperature=lambda X: 300 + 100 * X[:, 0],
        slopes=(50.0, 20.0),
    )
    system = settled([beam, vv.Clamped(solid=beam, nodes="start")])
    assert np.abs(beam.resultants(system.x)[..., 2]).max() < 1e-6 * (1e6 * 0.02 * 1e-5 * 200)


@pytest.mark.parametrize(("cell", "node"), [("line3", 1), ("line4", 1), ("line4", 2), ("line4", 3)])
def test_heat_passes_at_nodes_within_cells(cell: str, node: int) -> None:
    """A store of 10 J/K at 400 K and the beam of as much at 300 K end at 350 K, whichever node they meet at; what a
    node within a cell takes goes to the ends of that by where it is."""
    section = vv.RectangleSection(width=0.1, height=0.1, young=1e3, density=1.0)
    heat = vv.Heat(conductivity=500.0, capacity=1e3, reference=300.0)
    beam = vv.ThermalBeam(mesh=line(2, cell), section=section, heat=heat)
    store = vv.HeatStore(capacity=10.0, temperature=400.0)
    link = vv.HeatExchange(a=beam, nodes_a=[node], b=store, conductance=1.0)
    system = vv.System([beam, store, link], vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=100.0, step=0.5)
    assert store.temperature_at(system.x) == pytest.approx(350.0, abs=1e-3)
    assert beam.temperatures(system.x) == pytest.approx(350.0, abs=1e-3)
    assert np.ptp(result.ledger["total"]) < 1e-12 * 10.0 * 100.0
    warm = vv.ThermalBeam(
        mesh=line(2, cell), section=section, heat=heat, temperature=lambda X: 300 + 10 * X[:, 0]
    )
    shown = warm.temperatures(vv.System([warm]).x)
    assert shown == pytest.approx(300 + 10 * warm.points[:, 0], abs=0.02)  # entropies are linear
    port = beam.heat_port(np.array([node]), np.ones(1))
    where = beam.points[np.unique(beam.line.cells[:, :2]), 0]
    at = (port.temperatures - beam.algorithmic.start) // 3
    assert where[at] @ port.weights == pytest.approx(beam.points[node, 0], rel=1e-12)


def test_temperatures_of_nodes_within_cells_are_not_held_without_their_ends() -> None:
    beam = vv.ThermalBeam(mesh=line(2, "line3"), section=SECTION, heat=HEAT)
    middle = next(n for n in range(5) if n not in beam.line.cells[:, :2])
    a, b = beam.line.cells[beam.line.cells[:, 2] == middle][0, :2]
    held = vv.PrescribedTemperature(body=beam, nodes=[middle], value=25.0, name="held")
    with pytest.raises(vv.InputError, match=f"'held': node {middle} of .* nodes {a} and {b}, make it"):
        vv.System([beam, held])
    vv.System([beam, vv.PrescribedTemperature(body=beam, nodes=[middle, a, b], value=25.0)])


@pytest.mark.parametrize("kind", ["line2", "line3", "quad4", "tri3"])
@pytest.mark.parametrize("scheme", [vv.EnergyMomentum(), vv.BackwardEuler()])
def test_held_temperatures_conduct_however_strains_couple(kind: str, scheme: Any) -> None:
    """A clamped bar of ``T0 (E alpha)^2 / (E c) = 5`` whose ends go to 310 and 290: linear between, steady."""
    young = 1e5
    heat = vv.Heat(conductivity=1.0, capacity=1.0, expansion=np.sqrt(5 / (300 * young)), reference=300.0)
    body: Any
    if not kind.startswith("line"):
        section = vv.SolidSection(material=vv.SaintVenantKirchhoff(young=young, poisson=0.0), thickness=0.1)
        mesh = vv.RectangleMesh(size=(1, 0.1), counts=(8, 1), cell=kind)
        body, ends = vv.ThermalShell(mesh=mesh, section=section, heat=heat), ("x0", "x1")
    else:
        section = vv.RectangleSection(width=0.1, height=0.1, young=young, poisson=0.0)
        body, ends = vv.ThermalBeam(mesh=line(8, kind), section=section, heat=heat), ("start", "end")
    parts: list[Any] = [vv.Clamped(solid=body, nodes=end) for end in ends]
    parts += [
        vv.PrescribedTemperature(body=body, nodes=end, value=f"300 + {rise} * min(t / 1.2, 1)")
        for end, rise in zip(ends, (10, -10), strict=True)
    ]
    system = vv.System([body, *parts])
    vv.simulate(system, until=6.0, step=0.06, scheme=scheme)
    conducts = [system.x[body.temperature_unknowns(body.nodes(end))[0]] for end in ends]
    assert conducts == pytest.approx([310.0, 290.0], abs=1e-3)
    np.testing.assert_allclose(body.temperatures(system.x), 310 - 20 * body.points[:, 0], atol=2e-2)


def plate(cell: Any = "quad4", **options: Any) -> vv.ThermalShell:
    section = vv.SolidSection(
        material=vv.SaintVenantKirchhoff(young=210e9, poisson=0.3), thickness=0.02, density=0.0
    )
    given = {"heat": STEEL, **options}
    return vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4), cell=cell), section=section, **given
    )


def test_a_plate_between_planes_feels_its_difference_across() -> None:
    """M = E h^2 alpha dT / 12 (1 - nu), N = -E h alpha rise / (1 - nu)."""
    body = plate(temperature=303.15, difference=30.0)
    held = [
        vv.SymmetryPlane(solid=body, nodes=f"{'xy'[k]}{n}", normal=np.eye(3)[k])
        for k in (0, 1)
        for n in (0, 1)
    ]
    middle = vv.Fixed(solid=body, nodes=[12], directions=(False, False, True))
    system = settled([body, *held, middle])
    found, faces = body.resultants(system.x), body.face_temperatures(system.x)
    apart, rise = np.ptp(faces, axis=1).mean(), faces.mean() - 293.15
    assert apart == pytest.approx(30, rel=0.015)  # what is free to grow across cools a little
    assert np.abs(found[..., 3:5]) == pytest.approx(210e9 * 0.02**2 * 1.2e-5 * apart / 12 / 0.7, rel=1e-3)
    assert found[..., :2] == pytest.approx(-210e9 * 0.02 * 1.2e-5 * rise / 0.7, rel=1e-3)


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_heat_flows_through_a_plate(cell: str) -> None:
    """A difference of q h / k once it is steady, from what comes in above and leaves below; nothing is lost."""
    heat = vv.Heat(conductivity=50.0, capacity=3.6e6, reference=293.15)
    body = plate(cell, heat=heat)
    parts: list[Any] = [
        vv.Clamped(solid=body, nodes="x0"),
        vv.HeatFlux(body=body, faces="upper", flux=5e3),
        vv.HeatFlux(body=body, faces="lower", flux=-5e3),
    ]
    system = vv.System([body, *parts])
    result = vv.simulate(system, until=200.0, step=5.0)
    faces = body.face_temperatures(system.x)
    assert faces[:, 1] - faces[:, 0] == pytest.approx(5e3 * 0.02 / 50.0, rel=1e-4)
    assert faces.mean() == pytest.approx(293.15, abs=1e-3)
    assert result.ledger.swing("total") < 1e-3 * 5e3 * 200


def faced(z: float, difference: float, profile: Any = "linear") -> vv.ThermalShell:
    """A plate of unit area in space that holds still, of thickness .02 and conductivity 50."""
    grid = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
    points = np.column_stack([grid.points[:, :2], np.full(len(grid.points), z)])
    return vv.ThermalShell(
        mesh=vv.Mesh(points, grid.cells, face_sets=grid.face_sets),
        section=vv.SolidSection(
            material=vv.SaintVenantKirchhoff(young=210e9, poisson=0.0), thickness=0.02, points=3
        ),
        profile=profile,
        heat=vv.Heat(conductivity=50.0, capacity=3.6e6, reference=300.0),
        difference=difference,
    )


@pytest.mark.parametrize("profile", ["linear", "quadratic"])
@pytest.mark.parametrize("link", ["exchange", "tie with a resistance", "tie"])
def test_a_wall_of_two_shells_between_two_fluids(link: str, profile: str) -> None:
    """``q = (T1 - T2) / (1 / h1 + d / k + 1 / c + d / k + 1 / h2)``, steady, with Biot numbers of one and two.

    Heat passes at the temperatures of the sides that it passes, not at the means of the walls.
    """
    lower, upper = faced(0.0, -1.0, profile), faced(0.02, 1.0, profile)
    joined: dict[str, Any] = {
        "first": lower,
        "first_faces": "upper",
        "second": upper,
        "second_faces": "lower",
    }
    links = {
        "exchange": (
            vv.HeatExchange(a=lower, faces_a="upper", b=upper, faces_b="lower", conductance=4e3),
            4e3,
        ),
        "tie with a resistance": (vv.HeatTie(**joined, conductance=4e3, reach=0.1), 4e3),
        "tie": (vv.HeatTie(**joined, reach=0.1), np.inf),
    }
    between, c = links[link]
    around = [
        vv.HeatExchange(a=lower, faces_a="lower", ambient=340.0, conductance=2500.0),
        vv.HeatExchange(a=upper, faces_a="upper", ambient=300.0, conductance=5000.0),
    ]
    held = [vv.Fixed(solid=body, nodes="all") for body in (lower, upper)]
    system = settled([lower, upper, between, *around, *held], until=1e7)
    q = 40.0 / (1 / 2500.0 + 2 * 0.02 / 50.0 + 1 / c + 1 / 5000.0)
    below, above = lower.face_temperatures(system.x), upper.face_temperatures(system.x)
    assert below == pytest.approx(340.0 - q * (1 / 2500.0 + np.array([[0, 0.02 / 50]] * 9)), abs=1e-6)
    assert above == pytest.approx(300.0 + q * (1 / 5000.0 + np.array([[0.02 / 50, 0]] * 9)), abs=1e-6)


def pipe(radius: float, thickness: float, n: int) -> vv.ThermalShell:
    """Of length 1, outside up."""
    first = np.arange(n)
    angle, then = 2 * np.pi * first / n, np.roll(first, -1)
    ring = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    return vv.ThermalShell(
        mesh=vv.Mesh(
            points=np.vstack([ring, ring + np.eye(3)[2]]),
            cells={"quad4": np.stack([first, then, then + n, first + n], 1)},
        ),
        section=vv.SolidSection(material=SOFT, thickness=thickness, density=1.0),
        heat=vv.Heat(conductivity=1e4, capacity=10.0, reference=600.0),
    )


@pytest.mark.parametrize("thickness", [0.4, 0.01])
def test_a_source_in_a_shell_is_per_volume(thickness: float) -> None:
    """2 pi R t a length, of a pipe; what arises in proportion to the height goes to the outer half more than it takes
    from the inner one: with q (r - R) it is q t^3 / 12 2 pi, where the middle alone would have nothing."""
    R, n = 1.0, 24
    for power, expected in (
        (7.0, 7.0 * R * thickness),
        (lambda t, X: 7.0 * (np.hypot(X[:, 0], X[:, 1]) / radius(X, n) - R), 7.0 * thickness**3 / 12),
    ):
        body = pipe(R, thickness, n)
        result = vv.simulate(vv.System([body, vv.HeatSource(body=body, power=power)]), until=0.01, step=0.01)
        heat = 2 * np.pi * np.sinc(1 / n) * expected * 0.01
        assert result.ledger["heat_source"][-1] == pytest.approx(heat, rel=1e-6)


def radius(X: np.ndarray, n: int) -> np.ndarray:
    """Of the polygon of n chords in the unit circle, in the direction of X."""
    apart = np.mod(np.arctan2(X[:, 1], X[:, 0]), 2 * np.pi / n) - np.pi / n
    return np.asarray(np.cos(np.pi / n) / np.cos(apart))


@pytest.mark.parametrize("profile", ["linear", "quadratic"])
@pytest.mark.parametrize("difference", [100.0, -300.0])
def test_a_shell_starts_as_warm_as_it_was_said_to(profile: Any, difference: float) -> None:
    """Faces and middle are as given, and the heat that it holds is that of the mean."""
    body = vv.ThermalShell(
        mesh=vv.RectangleMesh(size=(2, 3), counts=(2, 2)),
        section=vv.SolidSection(material=SOFT, thickness=0.4, density=1e-3, points=3),
        profile=profile,
        heat=vv.Heat(conductivity=1.0, capacity=5.0, reference=280.0),
        temperature=300.0,
        difference=difference,
    )
    system = vv.System([body])
    faces = 300.0 + difference * np.array([[-0.5, 0.5]] * 9)
    assert body.face_temperatures(system.x) == pytest.approx(faces, abs=1e-8)
    assert body.temperatures(system.x) == pytest.approx(300.0, abs=1e-8)
    heat = vv.simulate(system, until=1e-9, step=1e-9).ledger["total"][0]
    assert heat == pytest.approx(5.0 * 2.4 * 20.0, rel=1e-9)


@pytest.mark.parametrize("kind", ["beam", "shell", "solid"])
def test_temperatures_that_contradict_each_other_are_refused(kind: str) -> None:
    heat = vv.Heat(conductivity=1.0, capacity=1.0, reference=300.0)
    body: Any
    if kind == "beam":
        body = vv.ThermalBeam(mesh=line(), section=SECTION, heat=heat)
    elif kind == "shell":
        body = plate(heat=heat)
    else:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
        body = vv.ThermoelasticSolid(mesh=mesh, material=SOFT, density=1.0, heat=heat)
    held = [
        vv.PrescribedTemperature(body=body, nodes=nodes, value=value, name=name)
        for nodes, value, name in (([0, 1], 310.0, "warm"), ([1, 2], 290.0, "cold"))
    ]
    with pytest.raises(vv.InputError, match=r"'warm' and .*'cold' hold node 1 of .* at 310 and at 290"):
        vv.System([body, *held])


@pytest.mark.parametrize(("side", "sign"), [("upper", 1.0), ("lower", -1.0)])
def test_heat_through_a_side_is_per_area_of_that_side(side: str, sign: float) -> None:
    """2 pi (R +- t/2) a length, of a pipe whose wall is .4 of its radius; chords shorten both alike."""
    R, t, n = 1.0, 0.4, 24
    area = 2 * np.pi * (R + sign * t / 2) * np.sinc(1 / n)
    for load in (
        lambda body: vv.HeatFlux(body=body, faces=side, flux=3.0),
        lambda body: vv.Convection(body=body, faces=side, coefficient=1e-6, ambient=3e6 + 600.0),
    ):
        body = pipe(R, t, n)
        result = vv.simulate(vv.System([body, load(body)]), until=0.01, step=0.01)
        came = sum(result.ledger[name][-1] for name in result.ledger.names if name.startswith("heat"))
        assert came == pytest.approx(3.0 * area * 0.01, rel=1e-6)


def test_a_plate_heated_on_one_side_has_a_quadratic_profile() -> None:
    """Once all of it warms alike, T'' = q / k h: the middle lags the mean of the faces by q h / 8 k."""
    found = []
    for profile, points in (("linear", 2), ("quadratic", 3)):
        section = vv.SolidSection(
            material=vv.SaintVenantKirchhoff(young=210e9, poisson=0.3), thickness=0.02, points=points
        )
        body = vv.ThermalShell(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(2, 2)),
            section=section,
            profile=profile,
            heat=vv.Heat(conductivity=50.0, capacity=3.6e6, reference=293.15),
        )
        flux = vv.HeatFlux(body=body, faces="upper", flux=5e3)
        system = vv.System([body, vv.Clamped(solid=body, nodes="x0"), flux])
        vv.simulate(system, until=200.0, step=5.0)
        faces, middle = body.face_temperatures(system.x), body.temperatures(system.x)
        assert np.ptp(faces, axis=1) == pytest.approx(5e3 * 0.02 / (2 * 50.0), rel=2e-3)
        found.append((faces.mean(axis=1) - middle) / (5e3 * 0.02 / (8 * 50.0)))
    assert np.abs(found[0]).max() < 1e-9
    assert found[1] == pytest.approx(1.0, rel=2e-3)


def linked_by_both_sides(body: vv.ThermalShell) -> vv.HeatExchange:
    upper, lower = body.faces("upper"), body.faces("lower")
    both = vv.Faces(
        {kind: np.vstack([upper.cells[kind], lower.cells[kind]]) for kind in upper.cells},
        {kind: np.concatenate([upper.owners[kind], lower.owners[kind]]) for kind in upper.cells},
    )
    return vv.HeatExchange(a=body, faces_a=both, ambient=300.0, conductance=1.0)


BAD = [
    (lambda: flying_shell("quadratic"), "give it points=3"),
    (lambda: linked_by_both_sides(plate()), "take 'upper', 'lower' and edges each for itself"),
    (lambda: strip((0.0, 0.0), -300.0), "not above absolute zero"),
    (lambda: strip((0.0, 300.0 / 0.025)), "not above absolute zero"),
    (
        lambda: vv.ThermalBeam(
            mesh=line(), section=SECTION, heat=vv.Heat(conductivity=1.0, capacity=1.0, moduli_slope=0.1)
        ),
        "constant and isotropic",
    ),
    (
        lambda: vv.ThermalBeam(
            mesh=line(),
            section=vv.PolygonSection(outline=[(0, 0), (1, 0), (1, 1), (0, 1)], young=1.0),
            heat=HEAT,
        ),
        "homogeneous profile",
    ),
    (lambda: vv.ThermalBeam(mesh=line(), section=SECTION, heat=HEAT, rigid=("shear",)), "no rigid strains"),
    (lambda: plate(difference=700.0), "not above absolute zero"),
    (lambda: plate(formulation="mixed"), "does not conduct heat"),
    (lambda: plate(kinks="rigid"), "faces of parts that meet there"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_input(make: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        make()
