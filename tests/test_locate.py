"""Places on surfaces and lines in space, as those in solids are looked at in test_probe.py and test_coupling.py."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.mesh.locate import locate


def turned(mesh: Any) -> vv.Mesh:
    """Out of the plane, by a rotation that mixes all directions."""
    from scipy.spatial.transform import Rotation

    made = mesh.build()
    X = np.pad(made.points, ((0, 0), (0, 3 - made.points.shape[1])))
    return vv.Mesh(X @ Rotation.from_rotvec([0.4, -0.7, 0.3]).as_matrix().T, made.cells)


@pytest.mark.parametrize("cell", ["quad4", "quad9", "tri3", "tri6"])
def test_places_on_surfaces_are_found(cell: Any) -> None:
    """They were refused as lying in no element, unless a node is there."""
    mesh = turned(vv.RectangleMesh(size=(2, 1), counts=(5, 3), cell=cell))
    low = vv.RectangleMesh(size=(2, 1), counts=(5, 3), cell=cell).build().points
    corner, along, up = (
        mesh.points[int(np.argmin(np.linalg.norm(low - p, axis=1)))] for p in ((0, 0), (2, 0), (0, 1))
    )
    for a, b in ((0.13, 0.77), (0.5, 0.02), (1.0, 0.4)):
        place = corner + a * (along - corner) + b * (up - corner)
        nodes, N = locate(mesh, place)
        assert N.sum() == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(N @ mesh.points[nodes], place, atol=1e-12)


def test_places_beside_a_line_are_refused() -> None:
    mesh = vv.LineMesh(points=[(0, 0, 0), (1, 2, 0)], count=4).build()
    nodes, N = locate(mesh, np.array([0.3, 0.6, 0.0]))
    np.testing.assert_allclose(N @ mesh.points[nodes], [0.3, 0.6, 0.0], atol=1e-12)
    with pytest.raises(vv.InputError, match="lies in none of its elements; the nearest node is number 2"):
        locate(mesh, np.array([0.8, 0.8, 0.0]))
