"""Benchmarks of NAFEMS (The standard NAFEMS benchmarks, 1990; Selected benchmarks for natural frequency analysis)."""

from __future__ import annotations

import numpy as np
import pytest

import visviva as vv
from verification.solids import static

STEEL = {"young": 210e3, "poisson": 0.3}


def elliptic(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From the inner ellipse, 2 x 1, to the outer one, 3.25 x 2.75, along the angle v pi / 2."""
    angle = v * np.pi / 2
    return (2 + 1.25 * u) * np.cos(angle), (1 + 1.75 * u) * np.sin(angle)


def thick_plate() -> tuple[vv.Solid, vv.System]:
    """LE10: quarter of an elliptic plate with a hole, 0.6 thick, 1 MPa on top; the middle of its edge is held in z."""
    box = vv.BoxMesh(size=(1, 1, 1), counts=(10, 12, 4), cell="hex20").build()
    x, y = elliptic(box.points[:, 0] ** 1.5, box.points[:, 1])
    places = np.column_stack([x, y, 0.6 * box.points[:, 2] - 0.3])
    places[np.abs(places) < 1e-12] = 0.0
    mesh = vv.Mesh(places, box.cells, face_sets=box.face_sets)
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(**STEEL))
    rim = solid.nodes("x1")
    middle = rim[np.abs(solid.points[rim, 2]) < 1e-9]
    system = static(
        [
            solid,
            vv.SymmetryPlane(solid=solid, nodes=np.setdiff1d(solid.nodes("y0"), rim), normal=(0, 1, 0)),
            vv.SymmetryPlane(solid=solid, nodes=np.setdiff1d(solid.nodes("y1"), rim), normal=(1, 0, 0)),
            vv.Fixed(solid=solid, nodes=np.setdiff1d(rim, middle), directions=(True, True, False)),
            vv.Fixed(solid=solid, nodes=middle),
            vv.Traction(solid=solid, faces="z1", traction=(0, 0, -1.0)),
        ]
    )
    return solid, system


def test_le10_thick_plate() -> None:
    """Stress 22 at (2, 0, 0.3): -5.38 MPa; p-elements give -5.35 +- 0.03."""
    solid, system = thick_plate()
    stress = vv.FieldAt(solid=solid, field="cauchy", at=(2.0, 0.0, 0.3))(system)
    assert stress[1] == pytest.approx(-5.38, abs=0.04)
    assert stress[2] == pytest.approx(-1.0, abs=0.02)


def simply_supported_plate(cell: str, n: int) -> vv.System:
    """FV52: 10 x 10 x 1, E = 200e9, rho = 8000; edges of the lower face held in z."""
    mesh = vv.BoxMesh(size=(10, 10, 1), counts=(n, n, 1), cell=cell).build()
    X = mesh.points
    edge = (X[:, 2] < 1e-9) & ((np.abs(X[:, :2] - 5) > 5 - 1e-9).any(axis=1))
    solid = vv.Solid(mesh=mesh, material=vv.LinearElastic(young=200e9, poisson=0.3), density=8000.0)
    hold = vv.Fixed(solid=solid, nodes=np.flatnonzero(edge), directions=(False, False, True))
    return vv.System([solid, hold])


def test_fv52_solid_plate() -> None:
    """Three free motions in the plane, then 45.897, 109.44 twice, 167.89, 193.59 and 206.19 twice.

    The targets are those of thick plates; an edge held along its lower line is softer, the first mode by 2.4 %.
    """
    found = vv.modes(simply_supported_plate("hex20", 4), n=10).frequencies
    assert np.abs(found[:3]).max() < 1e-2
    assert found[3:] == pytest.approx([45.897, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19], rel=0.025)
