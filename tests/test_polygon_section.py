"""Sections of polygons against closed forms; what is said of warping; what is refused."""

from __future__ import annotations

import sys
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

pytest.importorskip("sectionproperties")
Array = NDArray[np.float64]
COARSE: Any = {"triangles": 150}


def rectangle(w: float, h: float) -> Array:
    return np.array([(-w / 2, -h / 2), (w / 2, -h / 2), (w / 2, h / 2), (-w / 2, h / 2)])


@cache
def channel() -> vv.PolygonSection:
    """Open to the right; the line is in the middle of its web."""
    t = 0.05
    outline = [(-t, -1), (1, -1), (1, -1 + t), (t, -1 + t), (t, 1 - t), (1, 1 - t), (1, 1), (-t, 1)]
    with pytest.warns(UserWarning, match="open thin-walled"):
        return vv.PolygonSection(outline=outline, young=1e6, poisson=0.3)


def test_a_rectangle_is_the_one_of_closed_forms() -> None:
    section = vv.PolygonSection(outline=rectangle(0.3, 0.8), young=3.0, density=7.0, **COARSE)
    exact = vv.RectangleSection(width=0.3, height=0.8, young=3.0, density=7.0)
    np.testing.assert_allclose(section.stiffness_matrix(), exact.stiffness_matrix(), rtol=2e-4, atol=1e-6)
    for found, expected in zip(section.inertia(), exact.inertia(), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_turned_one_has_turned_stiffness() -> None:
    c, s = np.cos(0.4), np.sin(0.4)
    turn = np.array([(c, -s, 0), (s, c, 0), (0, 0, 1)])
    both = np.kron(np.eye(2), turn)
    plain, turned = (
        vv.PolygonSection(outline=points, young=3.0, **COARSE).stiffness_matrix()
        for points in (rectangle(0.3, 0.8), rectangle(0.3, 0.8) @ turn[:2, :2].T)
    )
    np.testing.assert_allclose(turned, both @ plain @ both.T, atol=2e-5)


def test_a_moved_one_couples_what_it_must() -> None:
    """Strains of its own axis are those of the line and the arm: C = A' C A."""
    a, b = 0.2, -0.5
    arm = np.eye(6)  # strains at the centroid of those at the line
    arm[0, 5], arm[1, 5], arm[2, 3], arm[2, 4] = -b, a, b, -a
    centred = vv.PolygonSection(outline=rectangle(0.3, 0.8), young=3.0, density=7.0, **COARSE)
    moved = vv.PolygonSection(outline=np.add(rectangle(0.3, 0.8), (a, b)), young=3.0, density=7.0, **COARSE)
    np.testing.assert_allclose(
        moved.stiffness_matrix(), arm.T @ centred.stiffness_matrix() @ arm, rtol=1e-4, atol=1e-6
    )
    np.testing.assert_allclose(moved.inertia().centre, (a, b), atol=1e-12)


def test_a_triangle() -> None:
    """Equilateral, of unit sides: J = sqrt(3) / 80, and shear acts at the centroid."""
    corners = [(0, 0), (1, 0), (0.5, np.sqrt(0.75))]
    c = vv.PolygonSection(outline=corners, young=1.0, **COARSE).constants
    assert c.torsion == pytest.approx(np.sqrt(3) / 80, rel=1e-4)
    np.testing.assert_allclose(c.shear_centre, (0.5, np.sqrt(3) / 6), atol=1e-4)


def test_a_hole_makes_a_box() -> None:
    """Bredt's formula of thin walls, with webs that take the shear; no word of warping."""
    wide, thin = rectangle(1.0, 2.0), rectangle(0.96, 1.96)
    c = vv.PolygonSection(outline=wide, holes=[thin], young=1.0).constants
    exact = vv.BoxSection(width=1.0, height=2.0, thickness=0.02, young=1.0)
    assert c.area == pytest.approx(exact.area)
    assert c.torsion == pytest.approx(exact.torsion(), rel=1e-2)


def test_the_shear_centre_of_a_channel() -> None:
    """Of thin walls, from the middle of the web away from the flanges; here the web is twice as thick."""
    t, b, h = 0.05, 1.0, 2.0 - 0.05
    I = (2 * t) * h**3 / 12 + 2 * b * t * (h / 2) ** 2
    e = t * b**2 * h**2 / (4 * I)
    np.testing.assert_allclose(channel().constants.shear_centre, (-e, 0), atol=0.03 * e)


def test_a_channel_that_is_pushed_at_its_shear_centre_does_not_twist() -> None:
    mesh = vv.LineMesh(points=[(0, 0, 0), (20, 0, 0)], count=8, cell="line3")
    twists = []
    for a in (0.0, channel().constants.shear_centre[0]):
        beam = vv.Beam(mesh=mesh, section=channel(), first=(0, 1, 0))
        push = vv.Force(on=beam.point((20, a, 0)), force=(0, 0, 1e-6))
        system = vv.System([beam, vv.Clamped(solid=beam, nodes="start"), push])
        vv.quasi_static(system, until=1.0, step=1.0)
        twists.append(float(beam.directors(system.x)[-1, 0, 2]))
    arm = -channel().constants.shear_centre[0]
    G = 1e6 / 2.6
    assert twists[0] == pytest.approx(1e-6 * arm * 20 / (G * channel().constants.torsion), rel=1e-3)
    assert abs(twists[1]) < 1e-4 * abs(twists[0])


def test_profiles_that_warp_say_so() -> None:
    """Over the length sqrt(E I_w / G J), I_w = I_flanges h^2 / 4."""
    profile = {"width": 0.1, "height": 0.21, "flange": 0.01, "web": 0.006, "young": 2e11, "poisson": 0.3}
    J = (2 * 0.1 * 0.01**3 + 0.2 * 0.006**3) / 3
    length = np.sqrt(2.6 * 2 * 0.01 * 0.1**3 / 12 * 0.2**2 / 4 / J)
    with pytest.warns(UserWarning, match=f"within about {length:.3g} of places"):
        vv.ISection(**profile)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"outline": [(0, 0), (1, 1), (1, 0), (0, 1)]}, "crosses itself"),
        ({"outline": [(0, 0), (1, 0)]}, "three corners"),
        ({"outline": rectangle(1, 1), "holes": [rectangle(1, 1) + 2]}, "not within it"),
        ({"outline": rectangle(1, 1), "young": -1.0}, "young"),
    ],
)
def test_refused(options: Any, message: str) -> None:
    with pytest.raises(vv.InputError, match=message):
        vv.PolygonSection(**({"young": 1.0} | options))


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sectionproperties", None)
    with pytest.raises(vv.InputError, match=r"visviva\[sections\]"):
        vv.PolygonSection(outline=rectangle(1, 1), young=1.0)
