"""The flying L of Simo & Tarnow: three columns of cells, two of them loaded, no supports."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import visviva as vv
from verification.solids import Array

DATA = Path(__file__).parents[1] / "data"
FORCE = np.array([256.0, 512.0, 768.0])
MU = 997.5


def mesh() -> vv.Mesh:
    """Four cubes and more: legs 0..6 along x and 0..10 along y, 3 thick."""
    parts = [
        ((3, 3, 3), (0, 0, 0)),
        ((3, 3, 3), (3, 0, 0)),
        ((3, 3.5, 3), (0, 3, 0)),
        ((3, 3.5, 3), (0, 6.5, 0)),
    ]
    boxes = [vv.BoxMesh(size=size, counts=(1, 1, 1), origin=at).build() for size, at in parts]
    whole = vv.Mesh(boxes[0].points, boxes[0].cells)
    for box in boxes[1:]:
        whole = whole.merged(vv.Mesh(box.points, box.cells), weld=1e-6)
    assert (whole.n_nodes, whole.n_cells, round(whole.volume, 12)) == (20, 4, 117.0)
    return whole.with_faces("top", lambda X: X[:, 1] > 10 - 1e-9).with_faces(
        "right", lambda X: X[:, 0] > 6 - 1e-9
    )


def flying(material: vv.Material, density: float, duration: float, tolerance: float = 1e-12) -> vv.System:
    """The L with its dead tractions, a hat in time."""
    solid = vv.Solid(mesh=mesh(), material=material, density=density, name="L")
    hat = f"max(0, min(t, {duration} - t))"
    top = vv.Traction(solid=solid, faces="top", traction=FORCE / 9, times=hat)
    right = vv.Traction(solid=solid, faces="right", traction=-FORCE / 9, times=hat)
    return vv.System([solid, top, right], vv.Newton(tolerance=tolerance))


def variant(which: str) -> vv.System:
    """Soft and light (a) or stiff and heavy (b)."""
    if which == "a":
        return flying(vv.MooneyRivlin(c10=5 / 12 * MU, c01=MU / 12, bulk=0.0), 10.0, 1.0)
    return flying(vv.MooneyRivlin(c10=5 / 6 * MU, c01=MU / 6, bulk=1e4), 100.0, 5.0)


def observed(system: vv.System) -> Array:
    """Energy, angular momentum (3,), positions of the nodes (0, 10, 3), (6, 0, 0), (3, 10, 0), (6, 0, 3): (16,)."""
    solid = next(c for c in system.components if isinstance(c, vv.Solid))
    x, v = solid.positions(system.x), solid.velocities(system.x, system.v)
    M = mass_matrix(solid)
    kinetic = 0.5 * np.einsum("ac,ab,bc->", v, M, v)
    strain = sum(float((w * solid.fields(system.x).energy).sum()) for w in solid.volumes)
    J = np.cross(x, M @ v).sum(axis=0)
    places = [(0, 10, 3), (6, 0, 0), (3, 10, 0), (6, 0, 3)]
    nodes = [int(np.argmin(np.linalg.norm(solid.points - p, axis=1))) for p in places]
    return np.concatenate([[kinetic + strain], J, x[nodes].ravel()])


def mass_matrix(solid: vv.Solid) -> Array:
    """Consistent mass (n, n) of cuboids, integrated in closed form."""
    M = np.zeros((solid.grid.n_nodes, solid.grid.n_nodes))
    line = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    for nodes, volume in zip(solid.grid.cells["hex8"], solid.grid.volumes, strict=True):
        X = solid.points[nodes]
        high = (X.mean(axis=0) < X).astype(int)
        local = np.prod([line[high[:, c]][:, high[:, c]] for c in range(3)], axis=0)
        M[np.ix_(nodes, nodes)] += solid.density * volume * local
    return M
