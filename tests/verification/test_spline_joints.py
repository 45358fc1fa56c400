"""Patches of splines against conforming meshes: cut patches, rings, corners and edges; and what would stay open."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.test_spline_patches import reversed_patch, turned
from visviva.mesh import convert

Array = NDArray[np.float64]
RUBBER = vv.NeoHooke(young=100.0, poisson=0.3)
ONCE = [0.0, 0.0, 1.0, 1.0]


def block(*at: float, size: Sequence[float] = (1, 1, 1), counts: Sequence[int] = (2, 2, 2)) -> vv.SplinePatch:
    """Plain elements."""
    d = len(at)
    return vv.SplineBox(size=size[:d], counts=counts[:d], degree=1, origin=at).parts()[0]


def quad(*corners: tuple[float, float]) -> vv.SplinePatch:
    """Four plain elements between four corners, counted anticlockwise."""
    a, b, c, d = np.array(corners, dtype=float)
    return vv.SplinePatch(degrees=(1, 1), knots=(ONCE, ONCE), control=np.array([[a, d], [b, c]])).refined(2)


def plain(blocks: Sequence[vv.SplinePatch]) -> vv.Solid:
    """The same elements in a mesh whose nodes are one where they are in one place."""
    mesh = convert.welded(convert.joined([b.sampled(1)[0] for b in blocks]), 1e-9)
    return vv.Solid(mesh=mesh, material=RUBBER, density=1.0, formulation="displacement")


def on(mesh: Any, **options: Any) -> vv.SplineSolid:
    return vv.SplineSolid(mesh=mesh, **({"material": RUBBER, "density": 1.0} | options))


def frequencies(solid: Any) -> Array:
    """Of what is free, without rigid motions."""
    system = vv.System([solid])
    return np.asarray(vv.modes(system, n=12).frequencies)[3 if solid.dimension == 2 else 6 :]


# --- a side along two others ------------------------------------------------------------------------------------
LONG = block(0, 0, size=(1, 2), counts=(2, 4))
OTHERS = (block(1, 0), block(1, 1), block(0, -1), block(1, -1))
"""Joined to each other and to the long one, which lies along two of them."""


@pytest.mark.parametrize("turn", [lambda p: p, reversed_patch, turned], ids=["straight", "half", "quarter"])
def test_a_side_along_two_others_is_refused(turn: Any) -> None:
    with pytest.raises(vv.InputError) as refused:
        vv.SplinePatches(patches=(turn(block(0, 0, size=(1, 2))), *OTHERS))
    assert re.search(
        r"side .. of patch 0 and side x0 of patch 1 lie on each other at \[1.0, ", str(refused.value)
    )
    assert "cut patch 0 at [1.0, 1.0] (SplinePatch.cut)" in str(refused.value)


def test_a_side_along_two_others_is_refused_in_space() -> None:
    parts = block(0, 0, 0, size=(1, 2, 1)), block(1, 0, 0), block(1, 1, 0)
    with pytest.raises(
        vv.InputError, match=r"side x1 of patch 0 and side x0 of patch 1 .* cut patch 0 at \[1.0, 1.0"
    ):
        vv.SplinePatches(patches=(*parts, block(0, -1, 0), block(1, -1, 0)))


def test_what_is_cut_is_joined() -> None:
    """As what is meshed in one."""
    patches = (*LONG.cut(1, 1.0), *OTHERS)
    np.testing.assert_allclose(
        frequencies(on(vv.SplinePatches(patches=patches))), frequencies(plain(patches)), rtol=1e-8
    )


def test_curved_sides_are_compared_by_their_places() -> None:
    """An arc along two others of other knots and degrees, and sides that are nearly the same."""
    inner, outer = arc(0, 5, 1.0), arc(0, 5, 2.0).cut(1, 0.37)
    with pytest.raises(vv.InputError, match=r"side x1 of patch 0 and side x0 of patch 1 lie on each other"):
        vv.SplinePatches(patches=(inner, *outer))
    shifted = replace(block(1, 0), control=block(1, 0).control + np.array([1e-7, 0.0]))
    with pytest.raises(
        vv.InputError, match=r"lie on each other at .* up to 1.0e-07, .* move their control points"
    ):
        vv.SplinePatches(patches=(block(0, 0), shifted))


# --- rings ------------------------------------------------------------------------------------------------------
CIRCLE = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], dtype=float)
WEIGHTS = np.array([1, 0.5**0.5] * 4 + [1.0])


def arc(first: int, last: int, radius: float, thickness: float = 1.0, spans: int = 2) -> vv.SplinePatch:
    """Quarters of a ring from its inner radius outwards, those of some control points of the circle."""
    n = (last - first) // 2
    knots = np.sort(np.concatenate([[0.0], np.repeat(np.arange(n + 1.0) / n, 2), [1.0]]))
    line = CIRCLE[first:last]
    patch = vv.SplinePatch(
        degrees=(1, 2),
        knots=(ONCE, knots),
        control=np.stack([radius * line, (radius + thickness) * line]),
        weights=np.outer([1, 1], WEIGHTS[first:last]),
    )
    return patch.refined(spans)


QUARTERS = tuple(arc(k, k + 3, 1.0) for k in (0, 2, 4, 6))


@pytest.mark.parametrize(
    "mesh",
    [
        lambda: arc(0, 9, 1.0),
        lambda: vv.SplinePatches(patches=(arc(0, 9, 1.0),)),
        lambda: vv.SplinePatches(patches=(arc(0, 5, 1.0), arc(4, 9, 1.0))),
        lambda: vv.SplinePatches(patches=arc(0, 9, 1.0).cut(0, 0.5)),
    ],
    ids=["one", "one as several", "two halves", "one within another"],
)
def test_rings_are_closed(mesh: Any) -> None:
    """One that ends where it begins, halves whose arcs share both ends, and whole rings one in another."""
    ring, four = on(mesh()), on(vv.SplinePatches(patches=QUARTERS))
    assert vv.System([ring]).n_coordinates == vv.System([four]).n_coordinates
    assert ring.grid.n_nodes == four.grid.n_nodes
    np.testing.assert_allclose(frequencies(ring), frequencies(four), rtol=1e-8)


def test_a_thin_ring_swings_as_hoppe_says() -> None:
    r"""``omega^2 = E I / (rho A R^4) n^2 (n^2 - 1)^2 / (n^2 + 1)`` with n = 2 (Hoppe 1871), bent without shear."""
    thin, material = 0.05, vv.NeoHooke(young=100.0, poisson=0.0)
    ring = on(arc(0, 9, 1.0 - thin / 2, thin, 20), material=material, plane="stress")
    omega = np.sqrt(100.0 * thin**2 / 12 * 4 * 9 / 5)
    assert 2 * np.pi * frequencies(ring)[:2] == pytest.approx([omega, omega], rel=5e-3)


def test_a_ring_in_space_is_closed() -> None:
    """Drawn along z, and its knots unclamped there: phases take it for smooth from one end to the other."""
    flat = arc(0, 9, 1.0)
    z = np.arange(5.0)
    control = np.concatenate(
        [
            np.repeat(flat.control[:, :, None], 5, axis=2),
            np.broadcast_to(z[:, None], (*flat.control.shape[:2], 5, 1)),
        ],
        axis=3,
    )
    tube = vv.SplinePatch(
        degrees=(1, 2, 1),
        knots=(*flat.knots, np.arange(-1.0, 6.0)),
        control=control,
        weights=np.repeat(flat.weights[:, :, None], 5, axis=2),
        wrapped=(2,),
    )
    body = vv.CahnHilliard(
        mesh=tube,
        free_energy=vv.DoubleWell(barrier=1.0),
        gradient_energy=3.0,
        concentration=0.5,
        periodic=[("z0", "z1")],
    )
    n = flat.control[..., 0].size - flat.control.shape[0]
    assert vv.System([body]).x.size == 2 * 4 * n
    solid = on(tube)
    assert vv.System([solid]).n_coordinates == 3 * 5 * n


# --- corners and edges ------------------------------------------------------------------------------------------
PINCHED = [(0, 0), (-1, 0), (-1, 1), (-1, 2), (0, 2), (1, 2), (1, 1)]
"""Squares, each beside the next; the first and the last share a corner alone."""


@pytest.mark.parametrize("dimension", [2, 3])
def test_corners_and_edges_are_joined(dimension: int) -> None:
    blocks = tuple(block(*at, *[0.0] * (dimension - 2)) for at in PINCHED)
    joined = on(vv.SplinePatches(patches=blocks))
    np.testing.assert_allclose(frequencies(joined), frequencies(plain(blocks)), rtol=1e-8)


def test_a_corner_on_a_side_is_refused() -> None:
    """Where nodes of both lie: a diamond that touches the middle of a square's side, both held by a frame."""
    frame = [
        quad((0, 1), (1, 1), (2.5, 3), (0, 3)),
        quad((0, 3), (2.5, 3), (2.5, 4), (0, 4)),
        quad((2.5, 3), (5, 3), (5, 4), (2.5, 4)),
        quad((2, 1), (3, 0.5), (5, 3), (2.5, 3)),
    ]
    patches = (block(0, 0), quad((1, 0.5), (2, 0), (3, 0.5), (2, 1)), *frame)
    with pytest.raises(vv.InputError, match=re.escape("touch at [1.0, 0.5] and are not joined")):
        on(vv.SplinePatches(patches=patches))


# --- knots that stand once at the ends ----------------------------------------------------------------------------
def unclamped(first: float) -> vv.SplinePatch:
    """One quadratic span of length 1, by control points at -1/2, 1/2, 3/2 from its begin."""
    control = np.array([[(first + x, y) for y in (0, 1)] for x in (-0.5, 0.5, 1.5)])
    return vv.SplinePatch(degrees=(2, 1), knots=(np.arange(6.0), ONCE), control=control)


def test_unclamped_patches_are_joined_where_they_end() -> None:
    joined = vv.SplinePatches(patches=(unclamped(0.0), unclamped(1.0)))
    box = vv.SplineBox(size=(1, 1), counts=(1, 1), degree=2).parts()[0]
    np.testing.assert_allclose(joined.patches[0].control[:, 0], box.control[:, 0], atol=1e-15)
    solid = on(joined)
    assert vv.System([solid]).n_coordinates == 2 * 5 * 2
    held = vv.System([solid, vv.Fixed(solid=solid, nodes="0.x0")])
    assert held.n_coordinates == 2 * (5 * 2 - 2)
    with pytest.raises(vv.InputError, match="patch 1 is not joined to patch 0"):
        vv.SplinePatches(patches=(unclamped(0.0), unclamped(2.0)))


def test_clamping_and_cutting_leave_the_shape() -> None:
    rng = np.random.default_rng(2)
    for p in (1, 2, 3, 4):
        n = p + 4
        patch = vv.SplinePatch(
            degrees=(p, 2),
            knots=(np.arange(n + p + 1.0), np.arange(7.0)),
            control=rng.normal(size=(n, 4, 2)),
            weights=rng.uniform(0.5, 2.0, (n, 4)),
        )
        xi = np.stack([rng.uniform(p, n, 20), rng.uniform(2, 4, 20)], axis=1)
        clamped = patch.clamped((0, 1))
        np.testing.assert_allclose(clamped.at(xi), patch.at(xi), atol=1e-13)
        np.testing.assert_allclose(
            clamped.at([(p, 2), (n, 4)]), clamped.control[[0, -1], [0, -1]], atol=1e-13
        )
        for at in (p + 1.0, p + 1.7):
            one, two = patch.cut(0, at)
            less = xi[:, 0] < at
            np.testing.assert_allclose(one.at(xi[less]), patch.at(xi[less]), atol=1e-13)
            np.testing.assert_allclose(two.at(xi[~less]), patch.at(xi[~less]), atol=1e-13)


# --- quadrature ---------------------------------------------------------------------------------------------------
def uneven(ratio: float) -> vv.SplinePatch:
    """A unit square of one span with weights greater by a factor where x is 0: its functions are bilinear in x, y."""
    control = np.array([[(0.0, 0.0), (0.0, 1.0)], [(1.0, 0.0), (1.0, 1.0)]])
    weights = np.array([[ratio, ratio], [1.0, 1.0]])
    return vv.SplinePatch(degrees=(1, 1), knots=(ONCE, ONCE), control=control, weights=weights)


def test_uneven_weights_leave_a_bilinear_element() -> None:
    solid, given = on(uneven(3.0)), plain([replace(uneven(3.0), weights=None)])
    assert solid.mass == pytest.approx(1.0, rel=1e-6)
    np.testing.assert_allclose(frequencies(solid), frequencies(given), rtol=5e-5)
    joined = on(vv.SplinePatches(patches=(uneven(3.0), block(1, 0, counts=(1, 1)))))
    assert joined.volume(vv.System([joined]).x) == pytest.approx(2.0, rel=1e-6)
    with pytest.raises(
        vv.InputError, match=re.escape("weights from 1 to 1000 of a patch of splines are too uneven")
    ):
        on(uneven(1000.0))


@pytest.mark.parametrize("name", ["degree 4", "weights"])
def test_even_tractions_on_a_side(name: str) -> None:
    """Force on each control point: the integral of a B-spline, ``(t[i + p + 1] - t[i]) / (p + 1)``."""
    box = vv.SplineBox(size=(2, 1), counts=(2, 1), degree=4)
    solid = on(box if name == "degree 4" else uneven(3.0))
    knots = box.parts()[0].knots[0]
    exact = (knots[5:] - knots[:-5]) / 5 if name == "degree 4" else np.array([0.5, 0.5])
    total = np.zeros(solid.splines.size)
    for part in solid.face_points(solid.faces("y0")):
        np.add.at(total, part.nodes, np.einsum("mq,mqk->mk", part.size, part.N))
    loaded = np.flatnonzero(solid.splines.control[:, 1] == 0)
    np.testing.assert_allclose(total[loaded], exact, rtol=1e-8)


# --- refusals -----------------------------------------------------------------------------------------------------
def test_refusals() -> None:
    square = block(0, 0)
    with pytest.raises(vv.InputError, match="both patches lie on the same side of it, one over the other"):
        vv.SplinePatches(patches=(square, square))
    pole = quad((0, 0), (1, 0), (1, 1), (0, 0))
    with pytest.raises(vv.InputError, match=r"side x0 of patch 0 is a single point, \[0.0, 0.0\]"):
        on(pole)
    with pytest.raises(vv.InputError, match=re.escape("the knot 0.5 of direction 0 stands more than 1")):
        vv.SplinePatch(degrees=(1, 1), knots=([0, 0, 0.5, 0.5, 1, 1], ONCE), control=np.zeros((4, 2, 2)))
    with pytest.raises(vv.InputError, match=re.escape("cut(0, 1) is not between 0 and 1")):
        quad((0, 0), (1, 0), (1, 1), (0, 1)).cut(0, 1.0)


def wrapped(knots: Any, control: Array, weights: Array | None = None) -> vv.SplinePatch:
    return vv.SplinePatch(degrees=(2, 1), knots=(knots, ONCE), control=control, weights=weights, wrapped=(0,))


def test_what_is_wrapped_goes_on_as_it_begins() -> None:
    """Else functions of both ends, taken for one, would be no smooth ones."""
    given = vv.SplineBox(size=(6, 1), counts=(6, 1), degree=2).parts([0])[0]
    control, knots = given.control[:, :2], given.knots[0]
    wrapped(knots, control)
    clamped = np.clip(np.arange(-2.0, 9.0), 0, 6)
    with pytest.raises(vv.InputError, match="direction 0, but its last knots are not those"):
        wrapped(clamped, control)
    with pytest.raises(vv.InputError, match="its last control points are not"):
        wrapped(knots, control * [[[1.0, 1.0]]] + 0.1 * control**2)
    with pytest.raises(vv.InputError, match="its last weights are not"):
        wrapped(knots, control, 1.0 + 0.1 * np.arange(16.0).reshape(8, 2))
    with pytest.raises(vv.InputError, match="needs 5 control points to be wrapped, not 4"):
        wrapped(knots[:7], control[:4])
    with pytest.raises(vv.InputError, match="wrapped has direction 2 of 2"):
        replace(given, wrapped=(2,))
