"""Cook's membrane: on each mesh the displacement that other programs publish, and its limit.

Large strains: the case of the deal.II gallery and of solids4foam (mu = 422.5 kPa, nu = 0.3, plane strain, shear
62.5 kPa, mm): Q1 8.638, 12.07, 13.86, 14.49 and Q2 14.30, 14.65, 14.71, 14.73 for 2, 4, 8, 16 elements per side;
own digits beyond, limit 14.7413. Blatz-Ko and the membrane in space: moofeKIT's tests, 12.6413, 5.8617, 16.3295.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from reference import enhanced

import visviva as vv
from verification.solids import COOK, displacement, static

MU, NU = 0.4225, 0.3
SHEAR = 0.0625


def membrane(material: vv.Material, cell: str, n: int, shear: float, step: float = 0.25) -> float:
    """Vertical displacement of (48, 52), clamped on the left, sheared on the right."""
    mesh = vv.QuadrilateralMesh(corners=COOK, counts=(n, n), cell=cell)
    solid = vv.Solid(mesh=mesh, material=material)
    clamp = vv.Fixed(solid=solid, nodes="x0")
    load = vv.Traction(solid=solid, faces="x1", traction=(0, shear, 0), times="t")
    system = static([solid, clamp, load], step=step)
    return float(displacement(system, solid, (48, 52))[1])


def split() -> vv.Material:
    """W = mu/2 (J^(-2/3) tr C - 3) + kappa/4 (J^2 - 1 - 2 ln J)."""
    return vv.NeoHooke(shear=MU, poisson=NU, isochoric=True, volumetric="simo")


def logarithmic() -> vv.Material:
    """W = mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J."""
    return vv.NeoHooke(shear=MU, poisson=NU)


@pytest.mark.parametrize(
    ("material", "cell", "n", "published"),
    [
        (split, "quad4", 2, 8.63837),
        (split, "quad4", 4, 12.07123),
        (split, "quad9", 2, 14.30176),
        (split, "quad9", 4, 14.64937),
        (logarithmic, "quad4", 2, 8.68149),
        (logarithmic, "quad4", 4, 12.02088),
        (logarithmic, "quad9", 2, 14.06896),
        (logarithmic, "quad9", 4, 14.41181),
    ],
)
def test_large_strains_mesh_by_mesh(
    material: Callable[[], vv.Material], cell: str, n: int, published: float
) -> None:
    assert membrane(material(), cell, n, SHEAR) == pytest.approx(published, abs=6e-6)


@pytest.mark.parametrize(
    ("cell", "n", "published"),
    [("quad4", 8, 13.86), ("quad4", 16, 14.49), ("quad9", 8, 14.71), ("quad9", 16, 14.73)],
)
def test_large_strains_on_finer_meshes(cell: str, n: int, published: float) -> None:
    assert membrane(split(), cell, n, SHEAR) == pytest.approx(published, abs=0.005)


@pytest.mark.parametrize(("cell", "value"), [("quad4", 12.641285), ("quad9", 15.226174)])
def test_blatz_ko(cell: str, value: float) -> None:
    found = membrane(vv.BlatzKo(young=1.0, poisson=1 / 3), cell, 4, 1 / 16)
    assert found == pytest.approx(value, abs=2e-6)


def test_small_strains_converge_to_the_limit() -> None:
    """Plane strain, E = 1, nu = 1/3, force 1: u_y(48, 52) = 21.52457 by p-elements graded to the corners.

    The clamped corner (0, 44) is singular: errors of uniform meshes fall about like h^1.3, whatever the elements.
    """
    steel = vv.LinearElastic(young=1.0, poisson=1 / 3)
    errors = 21.52457 - np.array([membrane(steel, "quad9", n, 1 / 16, step=1.0) for n in (4, 8, 16, 32)])
    assert np.all(errors > 0), "a model of displacements is too stiff"
    assert np.all(errors[1:] < 0.5 * errors[:-1])
    assert errors[-1] < 1e-3 * 21.52457


@pytest.mark.parametrize(
    ("cell", "published"),
    [("hex8", 5.86169), ("hex20", 16.198), ("hex27", 16.32952)],
)
def test_membrane_in_space(cell: str, published: float) -> None:
    """4 x 1 x 4 cells, thickness 4, E = 2261, nu = 0.4955, traction 100: u_z of the corner (48, 4, 60)."""
    box = vv.BoxMesh(size=(1, 4, 1), counts=(4, 1, 4), cell=cell).build()
    u, v = box.points[:, 0], box.points[:, 2]
    x, z = 48 * u, 44 * u + v * (44 + (16 - 44) * u)
    mesh = vv.Mesh(np.column_stack([x, box.points[:, 1], z]), box.cells, face_sets=box.face_sets)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=2261.0, poisson=0.4955))
    clamp = vv.Fixed(solid=solid, nodes="x0")
    system = static([solid, clamp, vv.Traction(solid=solid, faces="x1", traction=(0, 0, 100.0))])
    found = displacement(system, solid, (48, 4, 60))[2]
    assert found == pytest.approx(published, abs=6e-4 if cell == "hex20" else 6e-6)


def test_enhanced_elements_are_those_of_simo_and_armero() -> None:
    """Written once more in NumPy, they agree to rounding in finite strains."""
    assert enhanced.ours(2) == pytest.approx(enhanced.Membrane(2, transposed=False).deflection(), rel=1e-12)
