"""Meshes welded where they meet: cells are joined as those of a mesh that was cut as a whole, and no others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import visviva as vv

Array = NDArray[np.float64]
Predicate = Callable[[Array], NDArray[np.bool_]]
WELD = 1e-9


def joints(mesh: vv.Mesh) -> list[list[tuple[float, ...]]]:
    """For every node the centres of the cells that share it."""
    found: list[list[tuple[float, ...]]] = [[] for _ in range(mesh.n_nodes)]
    for rows in mesh.cells.values():
        for row in rows:
            for node in row:
                found[node].append(tuple(np.round(mesh.points[row].mean(axis=0), 6).tolist()))
    return sorted(sorted(cells) for cells in found)


def half(x: float) -> vv.Mesh:
    return vv.RectangleMesh(size=(0.5, 1), counts=(2, 4), origin=(x, 0)).build()


def level(X: Array) -> NDArray[np.bool_]:
    return np.asarray((np.abs(X[:, 1] - 0.5) < 1e-9) & (X[:, 0] < 0.75))


def over(X: Array) -> NDArray[np.bool_]:
    return np.asarray(X[:, 1] > 0.5)


def under(X: Array) -> NDArray[np.bool_]:
    return np.asarray(X[:, 1] < 0.5)


@pytest.mark.parametrize("sides", [(over, over), (over, under), (under, over)])
@pytest.mark.parametrize("cell", ["quad4", "quad9"])
def test_cuts_go_on_in_cuts_whichever_lip_was_named_first(
    sides: tuple[Predicate, Predicate], cell: str
) -> None:
    """By the names of lips the lower left was joined to the upper right, and the other way round."""
    halves = [half(x) if cell == "quad4" else half(x).quadratic(cell) for x in (0.0, 0.5)]
    after = halves[0].merged(halves[1], weld=WELD).opened(level, over)
    left, right = (mesh.opened(level, side) for mesh, side in zip(halves, sides, strict=True))
    assert joints(left.merged(right, weld=WELD)) == joints(after)


def test_a_cut_goes_on_in_the_half_that_is_turned() -> None:
    """The usual way to a crack in the middle."""

    def middle(X: Array) -> NDArray[np.bool_]:
        return np.asarray((np.abs(X[:, 1] - 0.5) < 1e-9) & (np.abs(X[:, 0] - 0.5) < 0.3))

    cut = half(0.0).opened(middle, over)
    whole = cut.merged(cut.rotated(np.pi, about=(0.5, 0.5)), weld=WELD)
    assert joints(whole) == joints(half(0.0).merged(half(0.5), weld=WELD).opened(middle, over))


def test_a_cut_ends_where_it_meets_what_is_whole() -> None:
    """Both of its lips go on there: their node is the tip."""
    after = half(0.0).merged(half(0.5), weld=WELD).opened(lambda X: level(X) & (X[:, 0] < 0.4), over)
    for pair in ((half(0.0).opened(level, over), half(0.5)), (half(0.5), half(0.0).opened(level, over))):
        assert joints(pair[0].merged(pair[1], weld=WELD)) == joints(after)


def test_a_cut_stays_open_where_one_lip_alone_goes_on() -> None:
    cut = half(0.0).opened(level, over)
    upper = vv.RectangleMesh(size=(0.5, 0.5), counts=(2, 2), origin=(0.5, 0.5)).build()
    whole = half(0.0).merged(upper, weld=WELD).opened(level, over)
    assert joints(cut.merged(upper, weld=WELD)) == joints(whole)


def test_cuts_that_cross_stay_open_in_space_too() -> None:
    """A weld elsewhere made one node of the four in the middle of a cross."""
    plate = vv.BoxMesh(size=(1, 1, 0.25), counts=(4, 4, 1)).build()
    for a, b in ((0, 1), (1, 0)):
        plate = plate.opened(
            lambda X, a=a, b=b: (np.abs(X[:, b] - 0.5) < 1e-9) & (np.abs(X[:, a] - 0.5) < 0.3),
            lambda X, b=b: X[:, b] > 0.5,
        )
    block = vv.BoxMesh(size=(1, 1, 0.25), counts=(4, 4, 1), origin=(1, 0, 0)).build()
    assert plate.merged(block, weld=WELD).n_nodes == plate.n_nodes + block.n_nodes - 10
    lid = plate.moved((0, 0, 0.25))
    stacked = plate.merged(lid, weld=WELD)
    assert stacked.n_nodes == plate.n_nodes * 3 // 2
    assert stacked.boundary().n_faces == 2 * plate.boundary().n_faces - 2 * 16


def test_what_is_apart_stays_so_unless_both_go_on() -> None:
    """Two blocks side by side, apart, and one on top of one of them, or of both."""
    apart = half(0.0).merged(half(0.5))
    one, both = (
        vv.RectangleMesh(size=(w, 1), counts=(n, 4), origin=(0, 1)).build() for w, n in ((0.5, 2), (1, 4))
    )
    assert apart.merged(one, weld=WELD).n_nodes == apart.n_nodes + one.n_nodes - 3
    assert apart.merged(both, weld=WELD).n_nodes == apart.n_nodes + both.n_nodes - 6


def test_what_no_faces_tell_is_refused() -> None:
    """A corner that touches the mouth of a cut, and lines at a node that is there twice."""
    cut = half(0.0).opened(level, over)
    tip = vv.Mesh([(0.5, 0.5), (1, 0.4), (1, 0.6)], {"tri3": [(0, 1, 2)]})
    lines = vv.LineMesh(points=[(0, 0, 0), (1, 0, 0)], count=2).build()
    twice = lines.merged(lines.moved((1, 0, 0)))
    for first, second in ((cut, tip), (tip, cut), (twice, lines.rotated(np.pi / 2, about=(1, 0, 0)))):
        with pytest.raises(vv.InputError, match=r"cannot tell which nodes near .* are to become one"):
            first.merged(second, weld=WELD)


@pytest.mark.parametrize("cell", ["hex20", "hex27"])
def test_slits_one_cell_wide_stay_open_by_the_middles_of_their_edges(cell: Any) -> None:
    """Only these are there twice: no face with a corner there told, and the weld was refused."""

    def low(X: np.ndarray) -> np.ndarray:
        return (np.abs(X[:, 1] - 0.5) < 1e-9) & (np.abs(X[:, 0] - 0.375) < 0.1)

    parts = [
        vv.BoxMesh(size=(1, 1, 0.5), counts=(4, 4, 2), origin=(0, 0, z)).build().quadratic(cell)
        for z in (0, 0.5)
    ]
    whole = parts[0].merged(parts[1], weld=WELD).opened(low, lambda X: X[:, 1] > 0.5)
    halves = [part.opened(low, lambda X: X[:, 1] > 0.5) for part in parts]
    assert joints(halves[0].merged(halves[1], weld=WELD)) == joints(whole)
