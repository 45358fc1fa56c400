"""Flow on unstructured meshes from files: between plates, exact with quadratic velocities, converging with linear."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]

SCRIPT = """
SetFactory("Built-in");
Point(1) = {0, 0, 0, SIZE}; Point(2) = {3, 0, 0, SIZE}; Point(3) = {3, 1, 0, SIZE}; Point(4) = {0, 1, 0, SIZE};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Curve("walls") = {1, 3}; Physical Curve("end") = {2}; Physical Curve("inlet") = {4};
Physical Surface("water") = {1};
"""


def by_gmsh(folder: Path, n: int) -> Path:
    """Triangles of the size 1/n by Gmsh."""
    pytest.importorskip("gmsh")
    (folder / "channel.geo").write_text(SCRIPT.replace("SIZE", str(1 / n)))
    return folder / "channel.geo"


def by_delaunay(folder: Path, n: int) -> Path:
    """Triangles about points that are scattered inside, in a file of Abaqus."""
    from scipy.spatial import Delaunay

    x, y = (c.ravel() for c in np.meshgrid(np.linspace(0, 3, 3 * n + 1), np.linspace(0, 1, n + 1)))
    inside = (x > 0) & (x < 3) & (y > 0) & (y < 1)
    moved = np.random.default_rng(n).uniform(-0.3 / n, 0.3 / n, (len(x), 2)) * inside[:, None]
    points = np.stack([x, y], axis=1) + moved
    mesh = vv.Mesh(points, {"tri3": Delaunay(points).simplices})
    for name, where in (
        ("walls", lambda X: np.isin(X[:, 1], (0, 1))),
        ("inlet", lambda X: X[:, 0] == 0),
        ("end", lambda X: X[:, 0] == 3),
    ):
        mesh = mesh.with_faces(name, where)
    mesh.write(folder / "channel.inp")
    return folder / "channel.inp"


def parabola(t: float, X: Array) -> Array:
    return 4 * X[:, 1:2] * (1 - X[:, 1:2]) * np.array([1.0, 0.0, 0.0])


def errors(path: Path, elements: str) -> tuple[float, float]:
    """Root mean squares at the nodes of the errors of velocity and pressure."""
    fluid = vv.Fluid(mesh=vv.MeshFile(path, trust=True), density=2.0, viscosity=0.05, elements=elements)
    ends = [
        vv.VelocityBoundary(fluid=fluid, faces="inlet", velocity=parabola),
        vv.Outlet(fluid=fluid, faces="end", pressure=0.3),
    ]
    system = vv.System([fluid, vv.NoSlip(fluid=fluid, faces="walls"), *ends])
    vv.quasi_static(system, until=1.0, step=1.0)
    v = fluid.velocities(system.x, system.v) - parabola(0.0, fluid.points)
    p = fluid.pressures(system.x) - (0.3 + 0.4 * (3.0 - fluid.points[:, 0]))
    return float(np.sqrt(np.mean(np.sum(v**2, axis=1)))), float(np.sqrt(np.mean(p**2)))


@pytest.mark.parametrize("source", [by_gmsh, by_delaunay])
def test_quadratic_velocities_are_exact(source: object, tmp_path: Path) -> None:
    assert callable(source)
    assert max(errors(source(tmp_path, 4), "P2P1")) < 1e-11


@pytest.mark.parametrize("source", [by_gmsh, by_delaunay])
def test_stabilised_triangles_converge(source: object, tmp_path: Path) -> None:
    assert callable(source)
    coarse, fine = (errors(source(tmp_path, n), "P1P1") for n in (16, 32))
    assert np.all(np.log2(np.array(coarse) / fine) > [1.6, 1.2])
    assert max(fine) < 0.004
