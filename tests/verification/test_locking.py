"""Cook's membrane and patches in plane stress and in the formulations against locking.

Numbers of fixed meshes are those of independent programs (moofeKIT's own tests; p-finite elements for the converged
values), so they hold digit by digit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

COOK = ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))


def settled(*components: Any) -> vv.System:
    """The system in equilibrium under the loads of t = 1."""
    system = vv.System(components)
    vv.quasi_static(system, until=1.0, step=1.0)
    return system


def cook(cell: str, n: int, material: vv.Material, load: float = 1.0, **options: Any) -> float:
    """Vertical displacement of (48, 52) under the shear force `load` on the right edge."""
    mesh = vv.QuadrilateralMesh(corners=COOK, counts=(n, n), cell=cell)
    solid = vv.Solid(mesh=mesh, material=material, **options)
    pull = vv.Traction(solid=solid, faces="x1", traction=(0.0, load / 16, 0.0), times="t")
    system = settled(solid, vv.Fixed(solid=solid, nodes="x0"), pull)
    X = solid.points
    right = np.flatnonzero(np.isclose(X[:, 0], 48.0))
    order = right[np.argsort(X[right, 1])]
    middle = np.interp(52.0, X[order, 1], solid.displacements(system.x)[order, 1])
    return float(middle)


# --- plane stress -------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("cell", "n", "expected"),
    [
        ("quad4", 4, 18.29917),
        ("quad4", 8, 22.07918),
        ("quad4", 16, 23.43041),
        ("quad9", 2, 23.28866),
        ("quad9", 4, 23.83975),
        ("quad9", 8, 23.92539),
        ("quad8", 4, 23.7083),
    ],
)
def test_cook_plane_stress(cell: str, n: int, expected: float) -> None:
    material = vv.LinearElastic(young=1.0, poisson=1 / 3)
    tolerance = 6e-6 if cell != "quad8" else 6e-5
    assert cook(cell, n, material, plane="stress") == pytest.approx(expected, abs=tolerance)


def test_saint_venant_in_plane_stress() -> None:
    """moofeKIT's membrane of finite strains: E = 1, traction 1/16, four by four bilinear elements."""
    material = vv.SaintVenantKirchhoff(young=1.0, poisson=1 / 3)
    assert cook("quad4", 4, material, plane="stress") == pytest.approx(13.5356, abs=6e-5)


LATERAL = [
    (0.5, 1.210767391, -0.9353520569),
    (1.5, 0.8801745918, 0.3782801764),
    (3.0, 0.6881110295, 1.093141437),
]


@pytest.mark.parametrize(("stretch", "lateral", "stress"), LATERAL)
def test_homogeneous_plane_stress(stretch: float, lateral: float, stress: float) -> None:
    """A sheet pulled in its plane is a bar: both lateral stretches and the force in closed form."""
    sheet = vv.Solid(
        mesh=vv.RectangleMesh(size=(1, 1), counts=(1, 1)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        plane="stress",
    )
    system = settled(
        sheet,
        vv.SymmetryPlane(solid=sheet, nodes="x0", normal=(1, 0, 0)),
        vv.SymmetryPlane(solid=sheet, nodes="y0", normal=(0, 1, 0)),
        vv.Prescribed(
            solid=sheet, nodes="x1", motion=(f"t*{stretch - 1}", None, None), directions=(True, False, False)
        ),
    )
    fields = sheet.fields(system.x)
    assert fields.F[0, :, 1, 1] == pytest.approx(lateral, abs=1e-9)
    assert fields.F[0, :, 2, 2] == pytest.approx(lateral, abs=1e-9)
    assert fields.first_piola[0, :, 0, 0] == pytest.approx(stress, abs=1e-9)
    assert fields.cauchy[0, :, 2, 2] == pytest.approx(0.0, abs=1e-14)
