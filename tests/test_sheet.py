"""What of a body in a fluid is thin, and what that costs."""

from __future__ import annotations

import numpy as np
import pytest
from immersed_parts import carried, part, thin
from numpy.typing import NDArray

import visviva as vv
from visviva.flow import sheet

Array = NDArray[np.float64]


def layer(dimension: int, thickness: float) -> Array:
    """Three layers of points, askew."""
    axes = [np.linspace(0, thickness, 3), *[np.linspace(0, 1, 17)] * (dimension - 1)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, dimension)
    turn = np.linalg.qr(np.arange(1.0, dimension**2 + 1).reshape(dimension, -1) + np.eye(dimension))[0]
    return np.asarray(points @ turn.T)


def by_hand(points: Array, at: Array, edge: float) -> Array:
    """The projections (m, d, d) onto normals, place by place with all points."""

    def mean(x: Array, values: Array) -> Array:
        far = ((points - x) ** 2).sum(axis=1) / (sheet.AROUND * edge) ** 2
        weight = np.where(far < 1, (1 - far) ** 2, 0.0)
        return np.tensordot(weight, values, 1) / max(weight.sum(), 1e-300)

    own = []
    for x in points:
        middle = mean(x, points)
        size, axes = np.linalg.eigh(mean(x, np.einsum("ni,nj->nij", points - middle, points - middle)))
        is_thin = 12 * size[0] < edge**2 and size[1] > 4 * abs(size[0])
        own.append(np.outer(axes[:, 0], axes[:, 0]) * is_thin)
    found = []
    for x in at:
        share, axes = np.linalg.eigh(mean(x, np.array(own)))
        found.append(np.outer(axes[:, -1], axes[:, -1]) * (share[-1] > 0.5))
    return np.array(found)


@pytest.mark.parametrize("at_once", [50, sheet.AT_ONCE])
@pytest.mark.parametrize(("dimension", "thickness"), [(2, 0.02), (2, 0.3), (3, 0.02), (3, 0.3)])
def test_normals_by_hand(
    dimension: int, thickness: float, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sheet, "AT_ONCE", at_once)
    points = layer(dimension, thickness)
    at = points[::7] + 0.07
    found = sheet.normals(points, at, 0.1)
    np.testing.assert_allclose(found[:, :, None] * found[:, None, :], by_hand(points, at, 0.1), atol=1e-9)
    assert (np.abs(found).max(axis=1) > 0).any() == (thickness < 0.1)


def test_pairs_at_once_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 10.6 thousand nodes, each with thousands around, all pairs together took 3.5 GB."""
    monkeypatch.setattr(sheet, "AT_ONCE", 1000)
    counts = np.random.default_rng(1).integers(0, 400, 5000)
    parts = list(sheet._parts(counts))
    np.testing.assert_array_equal(np.concatenate([np.arange(5000)[p] for p in parts]), np.arange(5000))
    assert max(counts[p].sum() for p in parts) < 1000 + 400


@pytest.mark.parametrize("scene", [carried, thin])
def test_thick_bodies_are_not_looked_at_in_steps(scene: object, monkeypatch: pytest.MonkeyPatch) -> None:
    parts, looked = scene(n=12), []  # type: ignore[operator]
    fluid = part(parts, vv.Fluid)
    blind = fluid.blind
    monkeypatch.setattr(fluid, "blind", lambda *given: (looked.append(given), blind(*given)))
    system = vv.System(parts)
    system.step(0.01, vv.BackwardEuler())
    assert bool(looked) == part(parts, vv.Immersed).may_be_thin == (scene is thin)
