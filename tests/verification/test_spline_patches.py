"""Patches of splines that are joined: the space of one patch with a knot of full multiplicity, rings, refusals."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv
from verification.test_splines import mixture, ring

Array = NDArray[np.float64]


def half(n: int, degree: int, first: float) -> vv.SplinePatch:
    return vv.SplineBox(size=(1, 1), counts=(n, n), degree=degree, origin=(first, 0)).parts()[0]


def reversed_patch(patch: vv.SplinePatch) -> vv.SplinePatch:
    """Turned by half a turn in its parameters."""
    knots = [t[-1] + t[0] - np.flip(t) for t in map(np.asarray, patch.knots)]
    return replace(patch, knots=knots, control=patch.control[::-1, ::-1])


def turned(patch: vv.SplinePatch) -> vv.SplinePatch:
    """Turned by a quarter: its first direction is along y."""
    control = patch.control.transpose(1, 0, 2)[:, ::-1]
    return replace(patch, knots=patch.knots[::-1], degrees=patch.degrees[::-1], control=control)


def creased(n: int, degree: int) -> vv.SplinePatch:
    """One patch, continuous without its slope at x = 1."""
    one, two = half(n, degree, 0.0), half(n, degree, 1.0)
    knots = np.concatenate([one.knots[0][:-1], 1 + two.knots[0][degree + 1 :]])
    return replace(
        one, knots=(knots, one.knots[1]), control=np.concatenate([one.control, two.control[1:]], axis=0)
    )


def wave(X: Array) -> Array:
    return np.asarray(0.5 + 0.3 * np.cos(4 * X[:, 0] + 1) * np.cos(3 * X[:, 1]))


@pytest.mark.parametrize("turn", [lambda p: p, reversed_patch, turned], ids=["straight", "half", "quarter"])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_two_patches_are_one_with_a_crease(degree: int, turn: Any) -> None:
    n, ends = 4, []
    joined = vv.SplinePatches(patches=(half(n, degree, 0.0), turn(half(n, degree, 1.0))))
    for mesh in (creased(n, degree), joined):
        body = mixture(mesh, concentration=wave)
        system = vv.System([body])
        vv.simulate(system, until=0.1, step=0.02)
        at = np.lexsort(np.round(body.points, 9).T)
        ends.append((body.points[at], body.values(system.x)[at], body.energies(system.x), system.x.size))
    np.testing.assert_allclose(ends[0][0], ends[1][0], atol=1e-12)
    np.testing.assert_allclose(ends[0][1], ends[1][1], atol=1e-9)
    np.testing.assert_allclose(ends[0][2], ends[1][2], rtol=1e-9)
    assert ends[0][3] == ends[1][3]


def whole_ring() -> vv.SplinePatches:
    """Four quarters between radius 1 and 2."""
    quarter = ring().refined(4)
    turns = [np.linalg.matrix_power([[0.0, -1.0], [1.0, 0.0]], k) for k in range(4)]
    return vv.SplinePatches(patches=[replace(quarter, control=quarter.control @ Q.T) for Q in turns])


def test_a_ring_of_four_patches() -> None:
    body = mixture(whole_ring(), concentration=lambda X: 0.5 + 0.2 * X[:, 0])
    system = vv.System([body])
    assert sorted(body.grid.face_sets) == [f"{k}.{side}" for k in range(4) for side in ("x0", "x1")]
    assert body.integral(system.x) == pytest.approx(0.5 * 3 * np.pi, rel=1e-6)
    outer = sum(float(t.size.sum()) for k in range(4) for t in body.space.walls(body.faces(f"{k}.x1")))
    assert outer == pytest.approx(4 * np.pi, rel=1e-6)
    result = vv.simulate(system, until=0.2, step=0.02)
    assert body.integral(system.x) == pytest.approx(0.5 * 3 * np.pi, rel=1e-6)
    assert np.all(np.diff(result.ledger["potential_stored"]) < 0)
    assert result.conservation()["energy"] < 1e-10
    # what is symmetric stays so, across all joints
    x, c = body.points, body.values(system.x)
    mirrored = np.array([np.argmin(np.linalg.norm(x - [p[0], -p[1], 0], axis=1)) for p in x])
    np.testing.assert_allclose(c, c[mirrored], atol=1e-9)


def test_walls_of_joined_patches() -> None:
    """A concentration held at a side of one patch, and one at a side of the other: in between it is linear at rest."""
    patches = (half(3, 2, 0.0), turned(half(3, 2, 1.0)))
    body = mixture(
        vv.SplinePatches(patches=patches),
        free_energy=vv.PolynomialEnergy(coefficients=(0.0, 0.0, 1.0)),
        gradient_energy=1e-10,
    )
    ends = [name for name in body.grid.face_sets if np.ptp(body.points[body.nodes(name)][:, 0]) < 1e-9]
    values = [float(body.points[body.nodes(name)][0, 0]) for name in ends]
    held = [
        vv.PrescribedConcentration(body=body, nodes=name, value=0.3 + 0.2 * x)
        for name, x in zip(ends, values, strict=True)
    ]
    system = vv.System([body, *held])
    assert sorted(values) == [0.0, 2.0]
    vv.simulate(system, until=50.0, step=5.0, scheme=vv.BackwardEuler())
    np.testing.assert_allclose(body.values(system.x), 0.3 + 0.2 * body.points[:, 0], atol=1e-6)


@pytest.mark.parametrize("nodes", [[1], range(8)], ids=["a node within a span", "a part of a side"])
def test_walls_are_held_whole(nodes: Sequence[int]) -> None:
    """Splines that nodes depend on reach beyond them: 0.5 held at one node would be 0.625 beside it."""
    body = mixture(vv.SplineBox(size=(8, 8), counts=(8, 8), degree=2))
    with pytest.raises(
        vv.InputError, match=f"to hold {len(nodes)} of its nodes would hold others beside them"
    ):
        vv.PrescribedConcentration(body=body, nodes=list(nodes), value=0.5)


def test_boxes_in_space() -> None:
    """The second box has its directions permuted."""
    one = vv.SplineBox(size=(1, 1, 1), counts=(2, 3, 2), degree=2).parts()[0]
    two = replace(
        one,
        knots=[one.knots[k] for k in (1, 2, 0)],
        control=(one.control + np.array([1.0, 0.0, 0.0])).transpose(1, 2, 0, 3),
    )
    body = mixture(vv.SplinePatches(patches=(one, two)), concentration=lambda X: 0.4 + 0.1 * X[:, 0])
    system = vv.System([body])
    assert system.x.size == 2 * (4 * 5 * 4 + 3 * 5 * 4)
    assert body.integral(system.x) == pytest.approx(2 * 0.5, rel=1e-12)
    result = vv.simulate(system, until=0.04, step=0.02)
    assert result.conservation()["energy"] < 1e-10


def moved(patch: vv.SplinePatch, at: tuple[int, int]) -> vv.SplinePatch:
    control = patch.control.copy()
    control[at] += [0.05, 0.0]
    return replace(patch, control=control)


LEFT, RIGHT = half(3, 2, 0.0), half(3, 2, 1.0)


@pytest.mark.parametrize(
    ("patches", "words"),
    [
        (
            (LEFT, moved(RIGHT, (0, 2))),
            "side x1 of patch 0 and side x0 of patch 1 have the same corners, but control",
        ),
        ((LEFT, half(4, 2, 1.0)), "(5,) and (6,) control points of degrees [2] and [2]; give both the same"),
        ((LEFT, replace(RIGHT, weights=1 + RIGHT.control[..., 1])), "but other weights"),
        (
            (LEFT, replace(RIGHT, knots=(RIGHT.knots[0], [0, 0, 0, 0.2, 0.7, 1, 1, 1]))),
            "but other knots",
        ),
        ((LEFT, half(3, 2, 1.5)), "patch 1 is not joined to patch 0"),
        ((), "give one or more patches"),
    ],
)
def test_sides_that_do_not_match(patches: Any, words: str) -> None:
    with pytest.raises(vv.InputError, match=re.escape(words)):
        vv.SplinePatches(patches=patches)


def test_refusals_of_joined_patches() -> None:
    joined = vv.SplinePatches(patches=(LEFT, RIGHT))
    with pytest.raises(vv.InputError, match="needs splines whose first derivatives are continuous"):
        mixture(joined, form="direct")
    with pytest.raises(vv.InputError, match="periodic sides are those of one patch"):
        mixture(joined, periodic=[("x0", "x1")])
