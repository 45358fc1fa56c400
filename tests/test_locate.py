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


def test_the_nearest_of_several_layers_is_found() -> None:
    """The first cell within a tenth of its size was taken: the lower of two layers, and the first leg of a hairpin."""
    layer = vv.RectangleMesh(size=(2, 2), counts=(2, 2)).build()
    points = [np.c_[layer.points[:, :2], np.full(len(layer.points), z)] for z in (0.0, 0.06)]
    quads = layer.cells["quad4"]
    both = vv.Mesh(np.vstack(points), {"quad4": np.vstack([quads, quads + len(layer.points)])})
    for z in (0.0, 0.06, 0.05):
        nodes, N = locate(both, np.array([0.5, 0.7, z]))
        np.testing.assert_allclose(N @ both.points[nodes], [0.5, 0.7, 0.0 if z == 0 else 0.06], atol=1e-12)


def test_the_nearest_part_is_found_whatever_the_size_of_its_cells() -> None:
    """Distances were compared in sizes of cells: places of a tube were told of the coarse plate below it."""
    plate = vv.RectangleMesh(size=(3, 3), counts=(3, 3)).build()
    n, gap = 20, 0.004
    fine = vv.RectangleMesh(size=(np.pi, 3), counts=(n, 30)).build()
    angle = fine.points[:, 0] - np.pi / 2

    def on_tube(angle: Any, y: Any) -> Any:
        return np.stack(
            np.broadcast_arrays(1.5 + 0.3 * np.sin(angle), y, gap + 0.3 - 0.3 * np.cos(angle)), axis=-1
        )

    n_plate = len(plate.points)
    points = np.vstack([np.pad(plate.points, ((0, 0), (0, 1))), on_tube(angle, fine.points[:, 1])])
    cells = np.vstack([plate.cells["quad4"], fine.cells["quad4"] + n_plate])
    both = vv.Mesh(points, {"quad4": cells})
    for k in range(n):
        nodes, _ = locate(both, on_tube((k + 0.5) * np.pi / n - np.pi / 2, 1.45))
        assert nodes.min() >= n_plate


def test_places_outside_a_bend_are_at_its_edge() -> None:
    """What lies on neither plane is beyond both where these lean away; beside a flat rim it lies nowhere."""
    bent = vv.Mesh([(0, 0, 0), (1, 0, 0), (2, -0.4, 0)], {"line2": [[0, 1], [1, 2]]})
    normal = np.array([0.0, 1, 0]) + np.array([0.4, 1, 0]) / np.hypot(0.4, 1)
    nodes, N = locate(bent, np.array([1.0, 0, 0]) + 0.01 * normal)
    np.testing.assert_allclose(N @ bent.points[nodes], [1, 0, 0], atol=1e-12)
    with pytest.raises(vv.InputError, match="lies in none"):
        locate(bent, np.array([-0.01, 0, 0]))


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_places_on_a_true_cylinder_are_found(cell: Any) -> None:
    flat = vv.RectangleMesh(size=(np.pi / 2, 1), counts=(6, 3), cell=cell).build()
    angle = flat.points[:, 0]
    tube = vv.Mesh(np.c_[np.cos(angle), np.sin(angle), flat.points[:, 1]], flat.cells)
    for a, z in np.random.default_rng(1).uniform((0, 0), (np.pi / 2, 1), (40, 2)):
        place = np.array([np.cos(a), np.sin(a), z])
        nodes, N = locate(tube, place)
        assert np.linalg.norm(N @ tube.points[nodes] - place) < (np.pi / 12) ** 2 / 8 * 1.01  # of the chord
