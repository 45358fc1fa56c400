"""Plane and axisymmetric solids that conduct heat: both laws, equal elements in space or without heat, closed forms."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from catalogue.viscous import SHIFTED
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
SOFT = vv.NeoHooke(lame_lambda=20.0, shear=10.0)
STIFF = vv.NeoHooke(shear=10.0, bulk=5e3, isochoric=True)
HEAT = vv.Heat(conductivity=0.5, capacity=0.2, expansion=0.005, reference=20.0, moduli_slope=0.02)
GENTLE = vv.Heat(conductivity=0.5, capacity=0.2, expansion=1e-4, reference=20.0, moduli_slope=0.02)
KINDS = [
    *((cell, "displacement") for cell in ("tri3", "quad4", "tri6", "quad8", "quad9")),
    *(("quad4", formulation) for formulation in ("enhanced", "F-bar", "mixed")),
    *((cell, "mixed") for cell in ("tri6", "quad9")),
]


def distorted(cell: str, radius: float = 0.0) -> vv.Mesh:
    """A square whose inner and outer nodes are moved about."""
    mesh = vv.RectangleMesh(size=(1, 1), counts=(2, 2), cell=cell, origin=(radius, 0)).build()
    X = np.array(mesh.points)
    bent = X + 0.05 * np.sin(2.0 * X[:, [1, 0]] + X)
    return vv.Mesh(bent, mesh.cells, face_sets=mesh.face_sets)


def flying(cell: str, formulation: Any, plane: Any, **options: Any) -> vv.ThermoelasticSolid:
    soft = formulation in ("displacement", "enhanced")
    given: dict[str, Any] = {
        "material": SOFT if soft else STIFF,
        "heat": HEAT if soft else GENTLE,
        "mesh": distorted(cell, 0.5 if plane == "axisymmetric" else 0.0),
        "temperature": lambda X: 20 + 8 * X[:, 0] ** 2,
        "velocity": lambda X: 0.3 * X[:, [1, 0, 2]] * X[:, [0, 1, 2]],
        **options,
    }
    if plane != "axisymmetric":
        given |= {"thickness": 0.3, "angular_velocity": (0, 0, 2)}
    kind = vv.ThermoviscoelasticSolid if "branches" in options else vv.ThermoelasticSolid
    return kind(formulation=formulation, plane=plane, density=1.0, **given)


def kept(body: vv.ThermoelasticSolid, h: float) -> tuple[dict[str, float], Array]:
    """Changes of what is conserved in steps of an isolated body, and entropies at their ends."""
    entropy: list[float] = []
    system = vv.System([body], vv.Newton(tolerance=1e-13))
    result = vv.simulate(
        system, until=8 * h, step=h, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    return dict(result.conservation()), np.array(entropy)


@pytest.mark.parametrize(("cell", "formulation"), KINDS)
@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
@pytest.mark.parametrize("h", [0.01, 0.05])
def test_both_laws_hold_to_rounding(cell: str, formulation: Any, plane: Any, h: float) -> None:
    """Isolated, hot and cold, distorted: energy and momenta are kept and entropy never falls, at any step."""
    body = flying(cell, formulation, plane)
    changes, entropy = kept(body, h)
    assert changes["energy"] < 1e-11
    if plane != "axisymmetric":
        assert max(changes[name] for name in ("momentum_x", "momentum_y", "angular_z")) < 1e-12
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
@pytest.mark.parametrize("h", [0.02, 0.1])
def test_both_laws_hold_where_branches_heat(plane: Any, h: float) -> None:
    changes, entropy = kept(flying("quad4", "displacement", plane, branches=SHIFTED), h)
    assert changes["energy"] < 1e-12
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize(("cell", "solid"), [("quad4", "hex8"), ("quad9", "hex27"), ("tri3", "wedge6")])
@pytest.mark.parametrize("branches", [(), SHIFTED])
def test_plane_strain_is_that_of_a_layer_that_cannot_leave_its_plane(
    cell: str, solid: str, branches: Any
) -> None:
    """The same motion and temperatures, to what iterations leave, with heat from edges and within."""
    found = []
    for flat in (True, False):
        square = vv.RectangleMesh(size=(1, 0.8), counts=(2, 1), cell=cell).build()
        layer = vv.BoxMesh(size=(1, 0.8, 0.3), counts=(2, 1, 1), cell=solid).build()
        given: dict[str, Any] = {
            "mesh": square if flat else layer,
            "material": SOFT,
            "density": 1.0,
            "heat": HEAT,
            "temperature": lambda X: 20 + 3 * X[:, 0] ** 2,
            "velocity": lambda X: 0.5 * X[:, [1, 0, 2]] * (1, 1, 0),
        }
        given |= {"branches": branches} if branches else {}
        given |= {"thickness": 0.3} if flat else {}
        body = (vv.ThermoviscoelasticSolid if branches else vv.ThermoelasticSolid)(**given)
        parts: list[Any] = [
            vv.Fixed(solid=body, nodes="x0"),
            vv.Traction(solid=body, faces="x1", traction=(1.0, 2.0, 0), times="t"),
            vv.Convection(body=body, faces="x1", coefficient=0.3, ambient=30.0),
            vv.HeatFlux(body=body, faces="y1", flux="0.2*t"),
            vv.Radiation(body=body, faces="y0", emissivity=0.5, ambient=25.0, constant=1e-6),
            vv.HeatSource(body=body, power=lambda t, X: 0.1 * X[:, 0]),
            vv.PrescribedTemperature(body=body, nodes="x0", value="20 + sin(3*t)"),
        ]
        if not flat:
            parts.append(vv.Fixed(solid=body, nodes="all", directions=(False, False, True)))
        system = vv.System([body, *parts], vv.Newton(tolerance=1e-12))
        result = vv.simulate(system, until=0.5, step=0.05)
        places = [(0.5, 0.4), (1.0, 0.8), (1.0, 0.0), (0.5, 0.0)]
        nodes = [int(np.argmin(np.linalg.norm(body.points - [x, y, 0], axis=1))) for x, y in places]
        table = result.ledger
        found.append(
            [
                body.positions(system.x)[nodes],
                body.temperatures(system.x)[nodes],
                np.array([table[name][-1] for name in ("total", "entropy", "heat_convection", "heat_flux")]),
            ]
        )
    for plane, space in zip(*found, strict=True):
        np.testing.assert_allclose(plane, space, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize(("cell", "formulation"), KINDS)
@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_without_coupling_they_are_the_solids_of_that_formulation(
    cell: str, formulation: Any, plane: Any
) -> None:
    """Positions, strains, stresses and forces: of materials whose volumetric energy is split off."""
    if (cell, plane) == ("tri3", "axisymmetric"):
        cell = "quad4"  # without heat, rings of tri3 have their strain at one point
    found = []
    for heat in (None, vv.Heat(conductivity=0.5, capacity=0.2, reference=20.0)):
        common: dict[str, Any] = {
            "mesh": distorted(cell, 0.5),
            "material": STIFF,
            "formulation": formulation,
            "plane": plane,
            "thickness": 0.3 if plane == "strain" else 1.0,
        }
        body = vv.Solid(**common) if heat is None else vv.ThermoelasticSolid(**common, heat=heat)
        held = vv.Fixed(solid=body, nodes="x0")
        pull = vv.Prescribed(solid=body, nodes="x1", motion=("0.2 * t", "0.3 * t", None))
        system = vv.System([body, held, pull], vv.Newton(tolerance=1e-12))
        vv.simulate(system, until=1.0, step=0.5, scheme=vv.BackwardEuler())
        found.append([body.carriers.vectors(system.x), body.nodal_forces(system.x)])
        if formulation == "F-bar":  # mixed ones show the strain and stress of the volume that pressures see
            fields = body.fields(system.x)
            found[-1] += [fields.F, fields.second_piola]
    for without, heated in zip(*found, strict=True):
        np.testing.assert_allclose(heated, without, atol=1e-7 * np.abs(without).max())


SCHEMES = [vv.EnergyMomentum(), vv.Midpoint(), vv.GeneralizedAlpha(), vv.BDF2()]


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_schemes_are_of_second_order(scheme: vv.Scheme) -> None:
    """Against 512 steps, as far as these are exact."""

    def end(n: int) -> Array:
        body = flying("quad4", "displacement", "strain", temperature=lambda X: 20 + X[:, 0] ** 2)
        system = vv.System([body], vv.Newton(tolerance=1e-13))
        vv.simulate(system, until=0.2, step=0.2 / n, scheme=scheme)
        return np.concatenate([body.positions(system.x).ravel(), body.temperatures(system.x)])

    exact = end(512)
    errors = [np.abs(end(n) - exact).max() for n in (32, 64)]
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5)


YOUNG, POISSON, ALPHA, ROOM = 210e9, 0.3, 1.2e-5, 300.0
STEEL = vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=ALPHA, reference=ROOM)
HOOKE = vv.SaintVenantKirchhoff(young=YOUNG, poisson=POISSON)


def test_a_clamped_plate_that_is_heated_is_pressed_across() -> None:
    """Free in one direction of the plane, held in the other: -E alpha dT (1 + nu) / (1 - nu^2) along and across."""
    plate = vv.ThermoelasticSolid(
        mesh=vv.RectangleMesh(size=(2, 1), counts=(3, 2)), material=HOOKE, heat=STEEL, temperature=ROOM
    )
    held = [
        vv.SymmetryPlane(solid=plate, nodes=n, normal=d)
        for n, d in (("x0", (1, 0, 0)), ("x1", (1, 0, 0)), ("y0", (0, 1, 0)))
    ]
    rise = 0.1
    warm = vv.PrescribedTemperature(body=plate, nodes="all", value=f"{ROOM} + {rise} * min(t, 1)")
    system = vv.System([plate, *held, warm])
    vv.simulate(system, until=2.0, step=0.25, scheme=vv.BackwardEuler())
    pressed = -YOUNG * ALPHA * rise / (1 - POISSON)
    stress = plate.fields(system.x).cauchy
    np.testing.assert_allclose(stress[..., 0, 0], pressed, rtol=1e-5)
    np.testing.assert_allclose(stress[..., 2, 2], pressed, rtol=1e-5)
    assert np.abs(stress[..., 1, 1]).max() < 1e-5 * abs(pressed)
    grown = plate.displacements(system.x)[plate.nodes("y1"), 1]
    np.testing.assert_allclose(grown, (1 + POISSON) / (1 - POISSON) * ALPHA * rise, rtol=1e-5)


INNER, OUTER, HOT = 1.0, 2.0, 1.0


def lame(r: Array) -> tuple[Array, ...]:
    """Rise of the temperature, radial, hoop and axial stress of a tube, hot inside, in plane strain (Timoshenko)."""
    a, b = INNER, OUTER
    rise = HOT * np.log(b / r) / np.log(b / a)

    def moment(r: Any) -> Any:  # integral of the rise times r from a
        return (
            HOT
            / np.log(b / a)
            * (r * r / 2 * np.log(b / r) + r * r / 4 - a * a / 2 * np.log(b / a) - a * a / 4)
        )

    share = moment(b) / (b * b - a * a)
    scale = ALPHA * YOUNG / (1 - POISSON) / r**2
    radial = scale * ((r * r - a * a) * share - moment(r))
    hoop = scale * ((r * r + a * a) * share + moment(r) - rise * r * r)
    return rise, radial, hoop, POISSON * (radial + hoop) - ALPHA * YOUNG * rise


@pytest.mark.parametrize(
    ("cell", "plane"), [("quad8", "strain"), ("tri6", "strain"), ("quad8", "axisymmetric")]
)
def test_stresses_of_a_tube_that_is_hot_inside(cell: str, plane: Any) -> None:
    """Of the logarithmic temperature between its held surfaces: by the closed form, on a quarter or along a radius."""
    n = 8
    if plane == "strain":
        grid = vv.RectangleMesh(size=(OUTER - INNER, 1), counts=(n, n), cell=cell, origin=(INNER, 0)).build()
        r, angle = grid.points[:, 0], np.pi / 2 * grid.points[:, 1]
        X = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
        mesh, sides = vv.Mesh(X, grid.cells, face_sets=grid.face_sets), ("y0", "y1")
        normals: Any = ((0, 1, 0), (1, 0, 0))
    else:
        mesh = vv.RectangleMesh(
            size=(OUTER - INNER, 0.2), counts=(n, 1), cell=cell, origin=(INNER, 0)
        ).build()
        sides, normals = ("y0", "y1"), ((0, 1, 0), (0, 1, 0))
    tube = vv.ThermoelasticSolid(mesh=mesh, material=HOOKE, heat=STEEL, plane=plane)
    held = [vv.SymmetryPlane(solid=tube, nodes=s, normal=d) for s, d in zip(sides, normals, strict=True)]
    inside = vv.PrescribedTemperature(body=tube, nodes="x0", value=f"{ROOM} + {HOT} * min(t / 1e6, 1)")
    outside = vv.PrescribedTemperature(body=tube, nodes="x1", value=ROOM)
    system = vv.System([tube, *held, inside, outside])
    vv.simulate(system, until=4e6, step=5e5, scheme=vv.BackwardEuler())
    radius = np.linalg.norm(tube.points, axis=1) if plane == "strain" else tube.points[:, 0]
    np.testing.assert_allclose(tube.temperatures(system.x) - ROOM, lame(radius)[0], atol=2e-3 * HOT)
    places = np.concatenate([p.X.reshape(-1, 3) for p in tube.cell_points()])
    scale = ALPHA * YOUNG * HOT
    for at in places[:: len(places) // 12]:
        r = np.hypot(at[0], at[1]) if plane == "strain" else at[0]
        found = vv.FieldAt(solid=tube, field="cauchy", at=at)(system)
        sigma = np.array(found)[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
        _, radial, hoop, axial = lame(np.array(r))
        if plane == "strain":
            out, along = np.array([at[0], at[1], 0]) / r, np.array([-at[1], at[0], 0]) / r
            told = [out @ sigma @ out, along @ sigma @ along, sigma[2, 2]]
        else:
            told = [sigma[0, 0], sigma[2, 2], sigma[1, 1]]
        np.testing.assert_allclose(told, [radial, hoop, axial], atol=0.02 * scale)


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_heat_through_edges_is_booked(plane: Any) -> None:
    """Everything that lets heat in at once: the balance closes to rounding."""
    body = flying("quad8", "displacement", plane)
    parts = [
        vv.PrescribedTemperature(body=body, nodes="x0", value="22 + sin(3*t)"),
        vv.Convection(body=body, faces="x1", coefficient=0.3, ambient=30.0),
        vv.Radiation(body=body, faces="y0", emissivity=0.5, ambient=25.0, constant=1e-6),
        vv.HeatFlux(body=body, faces="y1", flux="0.2*t"),
        vv.HeatSource(body=body, power=lambda t, X: 0.1 * X[:, 0]),
    ]
    system = vv.System([body, *parts], vv.Newton(tolerance=1e-13))
    result = vv.simulate(system, until=0.5, step=0.05)
    assert result.ledger.imbalance() < 1e-12


@pytest.mark.parametrize("rigid", [False, True])
def test_heat_flows_through_a_wall_in_plane(rigid: bool) -> None:
    """Air on both sides and a tie within: resistances in series, of a tied half that does not move as well."""
    ends, air = (8.0, 25.0), (310.0, 285.0)
    conductivity, width = 0.8, 0.2
    halves: list[Any] = []
    for k in range(2):
        mesh = vv.RectangleMesh(size=(width / 2, 1), counts=(3, 2 + k), origin=(k * width / 2, 0))
        if rigid and k:
            halves.append(vv.ThermalBody(mesh=mesh, conductivity=conductivity, temperature=300.0))
        else:
            heat = vv.Heat(conductivity=conductivity, capacity=1.6e6, reference=300.0)
            halves.append(vv.ThermoelasticSolid(mesh=mesh, material=HOOKE, heat=heat, temperature=300.0))
    parts: list[Any] = [
        vv.HeatTie(first=halves[0], first_faces="x1", second=halves[1], second_faces="x0"),
        vv.Convection(body=halves[0], faces="x0", coefficient=ends[0], ambient=air[0]),
        vv.Convection(body=halves[1], faces="x1", coefficient=ends[1], ambient=air[1]),
        *[vv.Fixed(solid=half, nodes="all") for half in halves if isinstance(half, vv.Solid)],
    ]
    system = vv.System([*halves, *parts])
    vv.quasi_static(system, until=1.0, step=1.0)
    flow = (air[0] - air[1]) / (1 / ends[0] + width / conductivity + 1 / ends[1])
    for half in halves:
        exact = air[0] - flow * (1 / ends[0] + half.points[:, 0] / conductivity)
        np.testing.assert_allclose(half.temperatures(system.x), exact, rtol=1e-6)


def sheet(material: Any, heat: vv.Heat, **options: Any) -> vv.ThermoelasticSolid:
    mesh = options.pop("mesh", vv.RectangleMesh(size=(1, 1), counts=(2, 2)))
    return vv.ThermoelasticSolid(mesh=mesh, material=material, heat=heat, plane="stress", **options)


@pytest.mark.parametrize(
    ("cell", "formulation"),
    [("tri3", "displacement"), ("quad4", "displacement"), ("quad4", "enhanced"), ("tri6", "displacement")],
)
@pytest.mark.parametrize("h", [0.01, 0.05])
def test_both_laws_hold_in_plane_stress(cell: str, formulation: Any, h: float) -> None:
    body = flying(cell, formulation, "stress")
    changes, entropy = kept(body, h)
    assert changes["energy"] < 1e-11
    assert max(changes[name] for name in ("momentum_x", "momentum_y", "angular_z")) < 1e-12
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize("formulation", ["displacement", "enhanced"])
def test_in_plane_stress_without_coupling_it_is_the_solid(formulation: Any) -> None:
    found = []
    for heat in (None, vv.Heat(conductivity=0.5, capacity=0.2, reference=20.0)):
        common: dict[str, Any] = {
            "mesh": distorted("quad4"),
            "material": SOFT,
            "formulation": formulation,
            "plane": "stress",
            "thickness": 0.3,
        }
        body = vv.Solid(**common) if heat is None else vv.ThermoelasticSolid(**common, heat=heat)
        held = vv.Fixed(solid=body, nodes="x0")
        pull = vv.Prescribed(solid=body, nodes="x1", motion=("0.2 * t", "0.3 * t", None))
        system = vv.System([body, held, pull], vv.Newton(tolerance=1e-12))
        vv.simulate(system, until=1.0, step=0.5, scheme=vv.BackwardEuler())
        fields = body.fields(system.x)
        found.append(
            [body.carriers.vectors(system.x), body.nodal_forces(system.x), fields.F, fields.second_piola]
        )
    for without, heated in zip(*found, strict=True):
        np.testing.assert_allclose(heated, without, atol=1e-7 * np.abs(without).max())


def test_a_sheet_that_starts_warm_has_its_temperature_and_expands_freely() -> None:
    """Without stress at rest where its edges are free: l^2 (l^2 - 1) = 2 alpha dT of Saint Venant's energy."""
    hot = vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1e-4, reference=ROOM)
    plate = sheet(HOOKE, hot, temperature=ROOM + 50)
    held = [
        vv.SymmetryPlane(solid=plate, nodes=n, normal=d) for n, d in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)))
    ]
    warm = vv.PrescribedTemperature(body=plate, nodes="all", value=ROOM + 50)
    system = vv.System([plate, *held, warm])
    np.testing.assert_allclose(plate.temperatures(system.x), ROOM + 50, rtol=1e-12)
    vv.simulate(system, until=3.0, step=1.0, scheme=vv.BackwardEuler())
    fields = plate.fields(system.x)
    assert np.abs(fields.cauchy).max() < 1e-6 * YOUNG * 1e-4 * 50
    np.testing.assert_allclose(
        fields.F, np.broadcast_to(np.eye(3), fields.F.shape) * fields.F[0, 0, 0, 0], atol=1e-9
    )
    exact = np.sqrt((1 + np.sqrt(1 + 8 * 1e-4 * 50)) / 2)
    np.testing.assert_allclose(fields.F[0, 0, 0, 0], exact, atol=1e-8)


@pytest.mark.parametrize("expansion", [1e-5, 1e-3, 9e-3])
def test_sheets_start_with_the_temperatures_given(expansion: float) -> None:
    """Strongly coupled ones, too: by 1.8e-3 K off at a coupling of 111, which is told of by its number."""
    heat = vv.Heat(conductivity=1.0, capacity=1.0, expansion=expansion, reference=300.0)
    for T in (285.0, 300.0, 315.0):
        plate = sheet(vv.NeoHooke(young=1e3, poisson=0.3), heat, temperature=T)
        system = vv.System([plate, vv.Fixed(solid=plate, nodes="all")])
        assert plate.temperatures(system.x) == pytest.approx(T, rel=1e-12)
        assert np.abs(plate.fields(system.x).second_piola[..., 2, 2]).max() < 1e-9 * 1e3


def test_sheets_without_a_thickness_are_refused_by_name() -> None:
    """Expansion of a thousand beside absolute temperatures: no neo-Hookean is as thin as that."""
    heat = vv.Heat(conductivity=1.0, capacity=1.0, expansion=5.0, reference=300.0)
    with pytest.raises(vv.InputError, match=r"ThermoelasticSolid .* no thickness is found"):
        vv.System([sheet(vv.NeoHooke(young=1e3, poisson=0.3), heat, temperature=100.0)])


def test_a_clamped_sheet_that_is_heated() -> None:
    """-E alpha dT along, nothing across, where it grows by (1 + nu) alpha dT in the plane and out of it."""
    plate, rise = sheet(HOOKE, STEEL, temperature=ROOM, thickness=0.01), 0.1
    held = [
        vv.SymmetryPlane(solid=plate, nodes=n, normal=d)
        for n, d in (("x0", (1, 0, 0)), ("x1", (1, 0, 0)), ("y0", (0, 1, 0)))
    ]
    warm = vv.PrescribedTemperature(body=plate, nodes="all", value=f"{ROOM} + {rise} * min(t, 1)")
    system = vv.System([plate, *held, warm])
    vv.simulate(system, until=2.0, step=0.25, scheme=vv.BackwardEuler())
    fields, pressed = plate.fields(system.x), YOUNG * ALPHA * rise
    np.testing.assert_allclose(fields.cauchy[..., 0, 0], -pressed, rtol=1e-5)
    assert np.abs(fields.cauchy[..., 2, 2]).max() < 1e-5 * pressed
    grown = (1 + POISSON) * ALPHA * rise
    np.testing.assert_allclose(fields.F[..., 1, 1] - 1, grown, rtol=1e-4)
    np.testing.assert_allclose(fields.F[..., 2, 2] - 1, grown, rtol=1e-4)


@pytest.mark.parametrize(("stretch", "rise"), [(1.5, 0.0648219805), (2.0, 0.2223064712)])
def test_a_band_of_rubber_warms_when_it_is_pulled(stretch: float, rise: float) -> None:
    """Gough and Joule, as `test_gough_joule` has it in space: free at its edge and across."""
    rubber = vv.NeoHooke(shear=0.4e6, lame_lambda=0.4e10)
    band = sheet(
        rubber, vv.Heat(conductivity=1e-9, capacity=1.8e6, moduli_slope=1 / 293.15), temperature=293.15
    )
    held = [
        vv.SymmetryPlane(solid=band, nodes=n, normal=d) for n, d in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)))
    ]
    end = vv.Prescribed(solid=band, nodes="x1", motion=(f"{stretch - 1}*t", None, None))
    system = vv.System([band, *held, end])
    vv.simulate(system, until=1.0, step=0.05, scheme=vv.BackwardEuler())
    assert band.temperatures(system.x) - 293.15 == pytest.approx(rise, rel=2e-3)
    np.testing.assert_allclose(band.fields(system.x).F[..., 2, 2], stretch**-0.5, rtol=1e-3)


def test_a_sheet_that_is_stretched_conducts_by_its_thickness() -> None:
    """Of a band twice as long, of the same volume: a quarter of the heat flows between the same temperatures."""
    found = []
    for stretch in (1.0, 2.0):
        rubber = vv.NeoHooke(shear=0.4, bulk=4e3)
        band = sheet(rubber, vv.Heat(conductivity=2.0, capacity=1.0, reference=300.0), temperature=300.0)
        held = [
            vv.SymmetryPlane(solid=band, nodes=n, normal=d) for n, d in (("x0", (1, 0, 0)), ("y0", (0, 1, 0)))
        ]
        end = vv.Prescribed(solid=band, nodes="x1", motion=(f"{stretch - 1}*min(t, 1)", None, None))
        warm = vv.PrescribedTemperature(body=band, nodes="x0", value="300 + min(t, 1)")
        air = vv.Convection(body=band, faces="x1", coefficient=1e6, ambient=300.0)
        system = vv.System([band, *held, end, warm, air])
        result = vv.simulate(system, until=20.0, step=0.5, scheme=vv.BackwardEuler())
        found.append(np.diff(result.ledger["heat_convection"])[-1] / 0.5)
    assert found[0] == pytest.approx(-2.0, rel=1e-3)
    assert found[1] / found[0] == pytest.approx(0.25, rel=1e-3)


def test_stresses_of_a_disc_that_is_hot_inside() -> None:
    """Those of the tube in plane strain, with E in place of E / (1 - nu), and none across (Timoshenko)."""
    n = 8
    grid = vv.RectangleMesh(size=(OUTER - INNER, 1), counts=(n, n), cell="quad8", origin=(INNER, 0)).build()
    r, angle = grid.points[:, 0], np.pi / 2 * grid.points[:, 1]
    X = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
    disc = sheet(HOOKE, STEEL, mesh=vv.Mesh(X, grid.cells, face_sets=grid.face_sets), temperature=ROOM)
    held = [
        vv.SymmetryPlane(solid=disc, nodes=s, normal=d) for s, d in (("y0", (0, 1, 0)), ("y1", (1, 0, 0)))
    ]
    inside = vv.PrescribedTemperature(body=disc, nodes="x0", value=f"{ROOM} + {HOT} * min(t / 1e6, 1)")
    outside = vv.PrescribedTemperature(body=disc, nodes="x1", value=ROOM)
    system = vv.System([disc, *held, inside, outside])
    vv.simulate(system, until=4e6, step=5e5, scheme=vv.BackwardEuler())
    for radius in (1.0, 1.25, 1.5, 2.0):
        sigma = np.array(vv.FieldAt(solid=disc, field="cauchy", at=(radius, 0, 0))(system))
        _, radial, hoop, _ = lame(np.array(radius))
        told = (1 - POISSON) * np.array([radial, hoop])
        np.testing.assert_allclose(sigma[:2], told, atol=0.02 * ALPHA * YOUNG * HOT)


@pytest.mark.parametrize("bent", [0.0, 0.1])
@pytest.mark.parametrize("scheme", [vv.BDF2(), vv.GeneralizedAlpha()], ids=repr)
def test_quadratic_triangles_take_a_first_step_with_a_history(scheme: vv.Scheme, bent: float) -> None:
    """Shape functions of their corners have an integral of zero, by which rates at the end of it were divided."""
    ends = []
    for cell in ("tri6", "quad8"):
        mesh = vv.RectangleMesh(size=(0.1, 0.1), counts=(4, 4), cell=cell).build()
        points = mesh.points.copy()
        points[:, 1] *= 1 + bent * np.sin(30 * points[:, 0])
        plate = vv.ThermoelasticSolid(
            mesh=dataclasses.replace(mesh, points=points),
            material=vv.NeoHooke(young=200e9, poisson=0.3),
            heat=vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1.2e-5),
            density=7850.0,
        )
        held = vv.Fixed(solid=plate, nodes="x0")
        air = vv.Convection(body=plate, faces="x1", coefficient=500.0, ambient=393.15)
        system = vv.System([plate, held, air])
        vv.simulate(system, until=60.0, step=6.0, scheme=scheme)
        ends.append(plate.temperatures(system.x).max() - 293.15)
    assert ends[0] == pytest.approx(ends[1], rel=1e-3)
