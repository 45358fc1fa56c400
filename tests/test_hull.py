"""Closed surfaces of shells and plane beams, by which they are seen to pass through each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from coarse import start

import visviva as vv
from visviva.contact.hull import hull_of


def plate_and_strip(width: float, cells: int, speed: float, **strip: Any) -> tuple[vv.Shell, vv.Shell]:
    """A square plate of so many cells a side that moves over a strip below it, from end to end."""
    section = vv.HomogeneousSection(thickness=0.02, young=1e7, density=1e3)

    def sheet(mesh: Any, z: float, name: str, **options: Any) -> vv.Shell:
        flat = mesh.build()
        points = np.pad(flat.points[:, :2], ((0, 0), (0, 1)), constant_values=z)
        raised = vv.Mesh(points, flat.cells, face_sets=flat.face_sets)
        return vv.Shell(mesh=raised, section=section, name=name, **options)

    upper = vv.RectangleMesh(size=(1, 1), counts=(cells, cells), origin=(-0.5, -0.5))
    lower = vv.RectangleMesh(size=(width, 1), counts=(1, 8), origin=(-width / 2, -0.5))
    return sheet(upper, 0.0, "plate", velocity=(speed, 0, -0.5)), sheet(lower, -0.1, "strip")


@pytest.mark.parametrize(
    ("width", "cells", "speed"), [(0.1, 2, 1.0), (0.2, 2, 1.0), (0.1, 4, 0.35), (0.2, 4, 0.8)]
)
@pytest.mark.parametrize("faces", [{}, {"first_faces": "lower"}])
@pytest.mark.parametrize("step", [0.01, 0.1])
def test_shells_that_come_between_vertices_of_shells_later_fail(
    width: float, cells: int, speed: float, faces: Any, step: float
) -> None:
    """They have no depth but their thickness, through which what lay between vertices fell freely."""
    plate, strip = plate_and_strip(width, cells, speed)
    contact = vv.Contact(first=plate, second=strip, formulation="node-to-segment", **faces)
    held = [vv.Clamped(solid=strip, nodes=ends) for ends in ("y0", "y1")]
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .* 'plate' alone touch .*'mortar'"):
        vv.simulate(vv.System([plate, strip, *held, contact]), until=0.6, step=step)


@pytest.mark.parametrize("speed", [0.3, 1.0])
def test_plane_beams_that_come_between_vertices_of_others_later_fail(speed: float) -> None:
    section = vv.RectangleSection(width=0.02, height=0.02, young=1e7, density=1e3)

    def line(start: Any, end: Any, count: int, **options: Any) -> vv.PlaneBeam:
        return vv.PlaneBeam(mesh=vv.LineMesh(points=[start, end], count=count), section=section, **options)

    bar = line((-0.5, 0, 0), (0.5, 0, 0), 4, velocity=(speed, -0.5, 0))
    post = line((0, -0.5, 0), (0, -0.1, 0), 8)
    contact = vv.Contact(first=bar, second=post, formulation="node-to-segment")
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .* alone touch"):
        vv.simulate(
            vv.System([bar, post, vv.Clamped(solid=post, nodes="start"), contact]), until=0.6, step=0.01
        )


@pytest.mark.parametrize("branches", [False, True])
def test_hulls_of_shells_are_closed_at_kinks_and_branches(branches: bool) -> None:
    """By the divergence theorem; at a kink half of the cell that stands, as its sides meet where others go on."""
    points = [(x, y, 0.0) for x in (0.0, 0.5, 1.0) for y in (0.0, 1.0)] + [
        (1, 0, 1),
        (1, 1, 1),
        (1.5, 0, 0),
        (1.5, 1, 0),
    ]
    cells = [[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]] + ([[4, 8, 9, 5]] if branches else [])
    section = vv.HomogeneousSection(thickness=0.02, young=1e6, poisson=0.3, density=1e3)
    used = points if branches else points[:8]
    shell = vv.Shell(mesh=vv.Mesh(used, {"quad4": cells}), section=section, kinks="rigid")
    strip = plate_and_strip(0.1, 2, 0.0)[1]  # is watched beside either
    start([shell, strip, vv.Contact(first=shell, second=strip, formulation="node-to-segment")], None)
    hull = hull_of(shell)
    assert hull is not None
    a, b, c, d = (hull.places[hull.facets[:, k]] for k in range(4))
    areas = 0.5 * np.cross(c - a, d - b)
    np.testing.assert_allclose(areas.sum(axis=0), 0, atol=1e-15)
    assert np.einsum("mi,mi->", areas, a + b + c + d) / 12 == pytest.approx((2.5 if branches else 1.5) * 0.02)


def with_fin(mesh: Any, height: float) -> vv.Mesh:
    """A flat mesh with cells that stand on its middle line."""
    flat = mesh.build()
    flat_points = np.pad(flat.points[:, :2], ((0, 0), (0, 1)))
    row = np.flatnonzero(np.abs(flat_points[:, 0]) < 1e-9)
    row = row[np.argsort(flat_points[row, 1])]
    new = len(flat_points) + np.arange(len(row))
    points = np.concatenate([flat_points, flat_points[row] + [0, 0, height]])
    fin = np.column_stack([row[:-1], row[1:], new[1:], new[:-1]])
    return vv.Mesh(points, {"quad4": np.concatenate([flat.cells["quad4"], fin])})


@pytest.mark.parametrize("cells", [2, 4])
@pytest.mark.parametrize("speed", [0.35, 1.0])
def test_shells_with_branches_fail_as_others_do(cells: int, speed: float) -> None:
    """They had no closed surface, and fell through each other between their vertices."""
    section = vv.HomogeneousSection(thickness=0.02, young=1e7, density=1e3)

    def shell(mesh: Any, name: str, **options: Any) -> vv.Shell:
        return vv.Shell(mesh=mesh, section=section, kinks="rigid", name=name, **options)

    wide = vv.RectangleMesh(size=(1, 1), counts=(cells, cells), origin=(-0.5, -0.5))
    slim = with_fin(vv.RectangleMesh(size=(0.1, 1), counts=(2, 8), origin=(-0.05, -0.5)), -0.3)
    low = vv.Mesh(slim.points - [0, 0, 0.1], slim.cells)
    plate, strip = shell(with_fin(wide, 0.5), "plate", velocity=(speed, 0, -0.5)), shell(low, "strip")
    ends = np.flatnonzero(np.abs(np.abs(strip.points[:, 1]) - 0.5) < 1e-9)
    contact = vv.Contact(first=plate, second=strip, formulation="node-to-segment")
    with pytest.raises(vv.StepFailure, match=r"sink into each other by .* 'plate' alone touch"):
        vv.simulate(
            vv.System([plate, strip, vv.Clamped(solid=strip, nodes=ends), contact]), until=0.6, step=0.01
        )
