"""Thermal strains: what is free to grow has no stress, what is held has that of Hooke's law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue.rigid import turned
from catalogue.solids import MATERIALS, rubber
from numpy.typing import NDArray
from verification.solids import distorted, static

import visviva as vv

Array = NDArray[np.float64]

STEEL, RUBBER = vv.LinearElastic(young=210.0, poisson=0.3), vv.NeoHooke(young=210.0, poisson=0.3)
USERS = vv.UserMaterial(function=rubber)
FINITE = {**MATERIALS, "user's": USERS}


def cube(cell: str = "hex8", **options: Any) -> vv.Solid:
    linear = {"hex27": "hex8", "tet10": "tet4"}.get(cell, cell)
    mesh = distorted(vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell=linear).build(), 0.05)
    return vv.Solid(mesh=mesh if cell == linear else mesh.quadratic(cell), **options)


@pytest.mark.parametrize("name", FINITE)
def test_a_body_that_has_grown_freely_and_turned_has_neither_stress_nor_energy(name: str) -> None:
    e = 0.07
    solid = cube(material=FINITE[name], thermal_strain=e)
    vv.System([solid])
    fields = solid.fields(((1 + e) * solid.points @ turned(4).T).ravel())
    assert np.abs(fields.cauchy).max() < 1e-12 * 100
    assert np.abs(fields.energy).max() < 1e-12 * 100


def warm(X: Array) -> Array:
    return np.asarray(0.01 * (1 + X @ (0.3, -0.2, 0.5)))


@pytest.mark.parametrize(
    ("cell", "material", "strain", "options"),
    [
        ("hex8", STEEL, 0.01, {}),
        ("hex8", STEEL, 0.01, {"formulation": "enhanced"}),
        ("hex8", RUBBER, 0.01, {}),
        ("hex8", RUBBER, 0.01, {"formulation": "enhanced"}),
        ("hex8", STEEL, 0.01, {"formulation": "F-bar"}),
        ("hex8", RUBBER, 0.01, {"formulation": "F-bar"}),
        ("hex8", USERS, 0.01, {"formulation": "F-bar"}),
        ("hex27", STEEL, warm, {}),
        ("tet10", STEEL, warm, {}),
    ],
)
def test_linear_fields_of_temperature_leave_no_stress(
    cell: str, material: Any, strain: Any, options: Any
) -> None:
    """Small strains can follow them, in cells of second order; finite ones can follow constants."""
    solid = cube(cell, material=material, thermal_strain=strain, **options)
    corner = [int(np.argmin(np.linalg.norm(solid.points - p, axis=1))) for p in np.eye(4, 3, -1)]
    held = [(True, True, True), (False, True, True), (False, False, True)]
    system = static(
        [solid, *(vv.Fixed(solid=solid, nodes=[n], directions=d) for n, d in zip(corner, held, strict=False))]
    )
    assert np.abs(solid.fields(system.x).cauchy).max() < 1e-9
    assert np.abs(solid.displacements(system.x)).max() > 0.01


def test_a_bar_that_is_held_at_both_ends() -> None:
    """-E e along it, nothing across; in plane strain -E e / (1 - nu) along and across."""
    bar = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)), material=STEEL, thermal_strain=2e-3)
    planes = [vv.SymmetryPlane(solid=bar, nodes=n, normal=d) for n, d in
              (("x0", (1, 0, 0)), ("x1", (1, 0, 0)), ("y0", (0, 1, 0)), ("z0", (0, 0, 1)))]  # fmt: skip
    system = static([bar, *planes])
    expected = np.zeros((3, 3))
    expected[0, 0] = -210.0 * 2e-3
    assert np.abs(bar.fields(system.x).cauchy - expected).max() < 1e-12
    sheet = vv.Solid(mesh=vv.RectangleMesh(size=(4, 1), counts=(4, 1)), material=STEEL, thermal_strain=2e-3)
    planes = [vv.SymmetryPlane(solid=sheet, nodes=n, normal=d) for n, d in
              (("x0", (1, 0, 0)), ("x1", (1, 0, 0)), ("y0", (0, 1, 0)))]  # fmt: skip
    system = static([sheet, *planes])
    expected = np.diag([1.0, 0.0, 1.0]) * -210.0 * 2e-3 / 0.7
    assert np.abs(sheet.fields(system.x).cauchy - expected).max() < 1e-12


@pytest.mark.parametrize("formulation", ["displacement", "F-bar"])
@pytest.mark.parametrize("material", [RUBBER, USERS], ids=["core's", "user's"])
def test_heat_that_is_held_everywhere_presses_by_the_energy_s_derivative(
    material: Any, formulation: Any
) -> None:
    """Nothing moves: S = stretch 2 W'(I / stretch^2) and W = stretch^3 W(I / stretch^2) of any formulation."""
    e = 0.04
    solid = cube(material=material, thermal_strain=e, formulation=formulation)
    held = static([solid, vv.Fixed(solid=solid, nodes="x0"), vv.Fixed(solid=solid, nodes="x1"),
                   *(vv.Fixed(solid=solid, nodes=n) for n in ("y0", "y1", "z0", "z1"))])  # fmt: skip
    energy, S, _ = material.respond(np.array([[1, 1, 1, 0, 0, 0]]) / (1 + e) ** 2)
    fields = solid.fields(held.x)
    assert fields.second_piola[..., range(3), range(3)] == pytest.approx((1 + e) * S[0, 0], rel=1e-10)
    assert fields.energy == pytest.approx((1 + e) ** 3 * energy[0], rel=1e-10)


def test_a_plate_in_plane_stress_grows_in_thickness_too() -> None:
    for material in (STEEL, RUBBER):
        plate = vv.Solid(
            mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
            material=material,
            plane="stress",
            thermal_strain=0.05,
        )
        vv.System([plate])
        fields = plate.fields((1.05 * plate.points[:, :2]).ravel())
        assert np.abs(fields.cauchy).max() < 1e-12
        assert fields.F[..., 2, 2] == pytest.approx(1.05, abs=1e-12)


@pytest.mark.parametrize("cell", ["hex8", "quad4"])
def test_tangents_with_the_stress_of_the_start_know_heat(cell: str) -> None:
    """Before a step's first iteration its stress is that of the start: both tangents are the same there."""
    found = []
    for tangent in ("exact", "start"):
        mesh: Any = vv.BoxMesh if cell == "hex8" else vv.RectangleMesh
        solid = vv.Solid(
            mesh=mesh(
                size=(1, 1, 1)[: 2 + (cell == "hex8")], counts=(2, 1, 1)[: 2 + (cell == "hex8")], cell=cell
            ),
            material=vv.NeoHooke(young=10.0, poisson=0.3),
            density=1.0,
            plane="strain" if cell == "hex8" else "stress",
            thermal_strain=lambda X: 0.1 + 0.05 * X[:, 0],
            tangent=tangent,
        )
        system = vv.System([solid])
        system.core.x[:] += 0.05 * np.random.default_rng(2).standard_normal(len(system.x))
        system.invalidate()
        found.append(system.tangent(vv.EnergyMomentum().step(0.0, 1.0))[1])
        result = vv.simulate(system, until=0.2, step=0.05)
        assert result.conservation()["energy"] < 1e-11
        found.append(np.array(system.x))
    assert abs(found[2] - found[0]).max() < 1e-12 * abs(found[0]).max()
    assert found[3] == pytest.approx(found[1], abs=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"thermal_strain": -1.5}, r"thermal_strain = -1.5 leaves no volume"),
        ({"thermal_strain": "hot"}, r"thermal_strain: 'hot' in 'hot' is unknown; there are x, y, z"),
        (
            {"thermal_strain": 0.1, "formulation": "mixed"},
            r"'mixed' does not know thermal_strain; take .*'F-bar' or 'enhanced'",
        ),
    ],
)
def test_bad_thermal_strains(options: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=words):
        cube(material=STEEL, **options)


def test_a_function_of_the_wrong_shape_is_refused() -> None:
    solid = cube(material=STEEL, thermal_strain=lambda X: X)
    with pytest.raises(
        vv.InputError, match=r"the function thermal_strain gave shape \(64, 3\).*shape \(64,\)"
    ):
        vv.System([solid])
