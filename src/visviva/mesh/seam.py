"""Two meshes welded where they meet, each as it is by itself: cuts stay open, and what is apart stays so."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.convert import groups, joined, united
from visviva.mesh.faces import all_faces

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

Mask = NDArray[np.bool_]
Sides = tuple[dict[tuple[int, ...], dict[tuple[int, ...], list[int]]], ...]
"""Of both meshes: their faces by the places of their corners, each by its corners."""


def welded_across(first: Mesh, second: Mesh, distance: float) -> Mesh:
    """Both as one, nodes of one closer than a distance to those of the other being the same.

    Where a mesh has several nodes at a place, as beside a cut, faces tell: what goes on is a face of one that lies on a
    face of the other. So two nodes of one mesh become one only where faces of both go on, as the tip of a cut does.

    Raises
    ------
    InputError
        If no faces tell which of several nodes go on.
    """
    from scipy.spatial import cKDTree

    both, n = joined([first, second]), first.n_nodes
    i, j = np.sort(cKDTree(both.points).query_pairs(distance, output_type="ndarray"), axis=1).T
    i, j = np.stack([i, j])[:, (i < n) & (j >= n)]
    place = groups(both.n_nodes, i, j)
    here = np.stack(
        [np.bincount(place[:n], minlength=len(place)), np.bincount(place[n:], minlength=len(place))]
    )
    crowded = (here.min(axis=0) > 0) & (here.max(axis=0) > 1)
    told = _told(both, n, place, crowded) if crowded.any() else np.zeros((2, 0), dtype=np.int64)
    _refuse_untold(both, n, np.where(crowded[place], place, -1), told, distance)
    plain = ~crowded[place[i]]
    return united(both, np.append(i[plain], told[0]), np.append(j[plain], told[1]))


def _told(both: Mesh, n: int, place: Ints, crowded: Mask) -> Ints:
    """Pairs (2, m) of nodes at crowded places that faces of both meshes share, if each has one such face."""
    first, second = _sides(both, n, place, crowded)
    pairs = [
        (a, b)
        for key in first.keys() & second.keys()
        if len(set(key)) == len(key) and len(first[key]) == len(second[key]) == 1
        for row in first[key].values()
        for other in second[key].values()
        for a, b in _same(row, other, place)
    ]
    return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2).T


def _sides(both: Mesh, n: int, place: Ints, crowded: Mask) -> Sides:
    """Faces with a node at a crowded place."""
    sides: Sides = {}, {}
    for kind, rows in all_faces(both.cells).cells.items():
        corners = rows[:, : CELLS[kind].n_corners]
        near = crowded[place[rows]].any(axis=1)
        keys = np.sort(place[corners[near]], axis=1).tolist()
        own = np.sort(corners[near], axis=1).tolist()
        for key, its, row in zip(keys, own, rows[near].tolist(), strict=True):
            sides[int(row[0] >= n)].setdefault(tuple(key), {})[tuple(its)] = row
    return sides


def _same(row: list[int], other: list[int], place: Ints) -> Iterator[tuple[int, int]]:
    """Nodes of two faces that are at one place."""
    at = {int(place[node]): node for node in row}
    return ((at[place[node]], node) for node in other if place[node] in at)


def _refuse_untold(both: Mesh, n: int, place: Ints, told: Ints, distance: float) -> None:
    """Refuse places, of nodes (-1 for none), with nodes of both meshes that go on in none of the other."""
    left = place.copy()
    left[told.ravel()] = -1
    untold = np.intersect1d(left[:n], left[n:])
    if len(untold := untold[untold >= 0]):
        node = int(np.flatnonzero(left == untold[0])[0])
        raise InputError(
            f"Mesh: merged cannot tell which nodes near {np.round(both.points[node], 6).tolist()} are to become one: "
            f"a mesh has several of them within weld = {distance:g}, and no face of one mesh alone lies there on one "
            "of the other; weld what is to be one first, cut it afterwards, or take a smaller distance"
        )
