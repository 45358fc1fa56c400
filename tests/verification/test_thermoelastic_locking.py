"""Solids that conduct heat, with formulations against locking: both laws, equal elements without heat, fine meshes."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import visviva as vv

STIFF = vv.NeoHooke(shear=10.0, bulk=5e3, isochoric=True)
HEAT = vv.Heat(conductivity=0.5, capacity=0.2, expansion=1e-4, reference=20.0, moduli_slope=0.02)
KINDS = [("hex8", "F-bar"), ("hex8", "mixed"), ("hex20", "mixed"), ("hex27", "mixed"), ("tet10", "mixed")]


def distorted(cell: str) -> vv.Mesh:
    """A brick whose inner and outer nodes are moved about."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 1), cell=cell).build()
    X = np.array(mesh.points)
    bent = X + 0.05 * np.sin(2.0 * X[:, [1, 2, 0]] + X[:, [2, 0, 1]])
    return vv.Mesh(bent, mesh.cells, face_sets=mesh.face_sets)


@pytest.mark.parametrize(("cell", "formulation"), KINDS)
@pytest.mark.parametrize("h", [0.01, 0.05])
def test_both_laws_hold_to_rounding(cell: str, formulation: Any, h: float) -> None:
    """Isolated, hot and cold, distorted, nearly incompressible: at any step."""
    body = vv.ThermoelasticSolid(
        mesh=distorted(cell),
        material=STIFF,
        formulation=formulation,
        density=1.0,
        heat=HEAT,
        temperature=lambda X: 20 + 8 * X[:, 0] ** 2,
        angular_velocity=(1, 2, 3),
    )
    system, entropy = vv.System([body], vv.Newton(tolerance=1e-13)), []
    result = vv.simulate(
        system, until=6 * h, step=h, observe=lambda s: entropy.append(body.total_entropy(s.x))
    )
    kept = result.conservation()
    assert kept["energy"] < 1e-11
    assert max(kept[f"angular_{k}"] for k in "xyz") < 1e-12
    assert np.min(np.diff(entropy)) > 0


@pytest.mark.parametrize(("cell", "formulation"), KINDS)
def test_without_coupling_they_are_the_solids_of_that_formulation(cell: str, formulation: Any) -> None:
    """Positions, strains, stresses and reactions: of materials whose volumetric energy is split off."""
    found = []
    for heat in (None, vv.Heat(conductivity=0.5, capacity=0.2, reference=20.0)):
        common: dict[str, Any] = {"mesh": distorted(cell), "material": STIFF, "formulation": formulation}
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


@pytest.mark.parametrize("formulation", ["F-bar", "mixed", "displacement"])
def test_a_strip_between_warm_and_cold_bends_freely(formulation: Any) -> None:
    """``alpha dT L^2 / 2 d`` at its end without stress, however little it changes its volume; displacements do not."""
    length, depth, alpha, rise = 1.0, 0.1, 1e-5, 50.0
    strip = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(length, depth / 2, depth), counts=(48, 2, 4)),
        material=vv.NeoHooke(young=1e6, poisson=0.499),
        formulation=formulation,
        heat=vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=alpha, reference=300.0),
    )
    held = [
        vv.SymmetryPlane(solid=strip, nodes="x0", normal=(1, 0, 0)),
        vv.SymmetryPlane(solid=strip, nodes="y0", normal=(0, 1, 0)),
        vv.Fixed(solid=strip, nodes=[0], directions=(False, False, True)),
    ]
    warm = [
        vv.PrescribedTemperature(
            body=strip, nodes=f"z{k}", value=f"300 + {(k - 0.5) * rise} * min(t / 1e5, 1)"
        )
        for k in (0, 1)
    ]
    system = vv.System([strip, *held, *warm])
    vv.simulate(system, until=2e5, step=5e4, scheme=vv.BackwardEuler())
    moved = strip.carriers.vectors(system.x) - strip.points
    ratio = -moved[strip.nodes("x1"), 2].mean() / (alpha * rise * length**2 / (2 * depth))
    if formulation == "displacement":
        assert abs(ratio - 1) > 0.3
    else:
        assert ratio == pytest.approx(1.0, rel=0.02)


def cook(cell: str, n: int, formulation: Any) -> tuple[float, float]:
    """Rise of the upper corner and mean warming of Cook's panel of rubber, loaded faster than heat flows."""
    box = vv.BoxMesh(size=(1, 1, 1), counts=(n, n, 1), cell=cell).build()
    x, y, z = box.points.T
    X = np.stack([48 * x, 44 * x + y * (44 - 28 * x), 48 / n * z], axis=1)
    rubber, reference = vv.NeoHooke(shear=80.0, bulk=4e3), 293.15
    panel = vv.ThermoelasticSolid(
        mesh=vv.Mesh(X, box.cells, face_sets=box.face_sets),
        material=rubber,
        formulation=formulation,
        heat=vv.Heat(conductivity=0.2, capacity=2.0, moduli_slope=1 / reference, reference=reference),
    )
    parts = [
        vv.Fixed(solid=panel, nodes="x0"),
        vv.Fixed(solid=panel, nodes="all", directions=(False, False, True)),
        vv.Traction(solid=panel, faces="x1", traction=(0, 6.25, 0), times="t"),
    ]
    system = vv.System([panel, *parts])
    vv.simulate(system, until=1.0, step=0.25, scheme=vv.BackwardEuler())
    corner = int(np.argmin(np.linalg.norm(panel.points - [48, 60, 0], axis=1)))
    share = panel._content
    warmed = float(share @ (panel.temperatures(system.x) - reference) / share.sum())
    return float(panel.carriers.vectors(system.x)[corner, 1] - 60), warmed


@cache
def fine() -> tuple[float, float]:
    """With quadratic elements of displacements, which rise by 6.88; finer ones go on to 7.0."""
    return cook("hex27", 10, "displacement")


@pytest.mark.parametrize(
    ("cell", "n", "formulation"),
    [("hex8", 16, "F-bar"), ("hex8", 16, "mixed"), ("hex27", 6, "mixed"), ("tet10", 8, "mixed")],
)
def test_cooks_panel_of_rubber_warms_and_rises_as_with_fine_quadratic_elements(
    cell: str, n: int, formulation: Any
) -> None:
    rise, warmed = cook(cell, n, formulation)
    assert rise == pytest.approx(fine()[0], rel=0.02)
    assert warmed == pytest.approx(fine()[1], rel=0.03)
    assert cook("hex8", 8, "displacement")[0] < 0.8 * fine()[0]


@pytest.mark.parametrize(("cell", "formulation"), KINDS)
def test_a_rod_of_rubber_warms_when_it_is_pulled(cell: str, formulation: Any) -> None:
    """Gough and Joule: ``c ln(T / T0) = W / T0`` of an incompressible rod, ``W = mu (l^2 + 2 / l - 3) / 2``."""
    shear, c, reference, stretch = 0.4e6, 1.8e6, 293.15, 2.0
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2), cell=cell).build()
    inside = np.prod(np.sin(np.pi * mesh.points), axis=1, keepdims=True)
    rod = vv.ThermoelasticSolid(
        mesh=vv.Mesh(mesh.points + 0.15 * inside, mesh.cells, face_sets=mesh.face_sets),
        material=vv.NeoHooke(shear=shear, bulk=1e4 * shear),
        formulation=formulation,
        heat=vv.Heat(conductivity=1e-9, capacity=c, reference=reference, moduli_slope=1 / reference),
    )
    sides = [vv.SymmetryPlane(solid=rod, nodes=f"{'xyz'[k]}0", normal=np.eye(3)[k]) for k in range(3)]
    end = vv.Prescribed(solid=rod, nodes="x1", motion=(f"{stretch - 1} * t", None, None))
    system = vv.System([rod, *sides, end])
    vv.simulate(system, until=1.0, step=0.1, scheme=vv.BackwardEuler())
    W = 0.5 * shear * (stretch**2 + 2 / stretch - 3)
    warmed = reference * np.expm1(W / (reference * c))
    assert rod.temperatures(system.x) - reference == pytest.approx(warmed, rel=1e-3)
    volumes = np.linalg.det(rod.fields(system.x).F)
    assert volumes == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("plane", [False, True])
def test_free_energies_of_users_do_not_lock_with_f_bar(plane: bool) -> None:
    """Both laws, and the motion and warmth of the same energy in the core, nearly incompressible."""
    shear, lame, c, T0, coupling = 10.0, 5e3, 0.2, 20.0, 1.5

    def free(C: Any, T: Any) -> Any:
        J2 = C[0] * (C[1] * C[2] - C[4] ** 2) - C[3] * (C[3] * C[2] - C[4] * C[5])
        log = np.log(J2 + C[5] * (C[3] * C[4] - C[1] * C[5])) / 2
        W = shear / 2 * (C[0] + C[1] + C[2] - 3 - 2 * log) + lame / 2 * log**2
        return W * T / T0 - coupling * (T - T0) * log + c * (T - T0 - T * np.log(T / T0))

    expansion = coupling / (3 * lame + 2 * shear)
    core = vv.Heat(conductivity=0.5, capacity=c, expansion=expansion, reference=T0, moduli_slope=1 / T0)
    mesh = distorted("hex8")
    if plane:
        square = vv.RectangleMesh(size=(1, 1), counts=(2, 2)).build()
        mesh = vv.Mesh(square.points + 0.05 * np.sin(3 * square.points[:, ::-1]), square.cells)

    def moved(scheme: vv.Scheme, **given: Any) -> tuple[list[Any], vv.Result]:
        body = vv.ThermoelasticSolid(
            mesh=mesh,
            formulation="F-bar",
            density=1.0,
            temperature=lambda X: T0 + 4 * X[:, 0] ** 2,
            velocity=lambda X: X[:, [1, 0, 2]] * (1, 1, 0),
            **given,
        )
        system = vv.System([body], vv.Newton(tolerance=1e-11))
        result = vv.simulate(system, until=0.1, step=0.01, scheme=scheme)
        ends = [body.displacements(system.x), body.temperatures(system.x) - T0, body.nodal_forces(system.x)]
        return ends, result

    own, _ = moved(vv.BDF2(), material=vv.NeoHooke(shear=shear, lame_lambda=lame), heat=core)
    heat = vv.UserHeat(function=free, conductivity=0.5, reference=T0)
    theirs, _ = moved(vv.BDF2(), heat=heat)
    for a, b in zip(own, theirs, strict=True):
        np.testing.assert_allclose(b, a, atol=1e-7 * np.abs(a).max())
    _, result = moved(vv.EnergyMomentum(), heat=heat)
    assert result.conservation()["energy"] < 1e-9
    assert np.min(np.diff(result.ledger["entropy"])) > 0
