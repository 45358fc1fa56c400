"""Periodic meshes: nodes of opposite faces share their unknowns, and places beyond them are those of their images."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, RunError
from visviva.mesh.faces import Faces, corner_rows
from visviva.mesh.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Meshed(Protocol):
    """An object with a mesh and a name."""

    grid: Mesh

    @property
    def label(self) -> str:
        """Name used in messages."""
        ...


def refuse_periodic(label: str, body: Meshed, pairs: Sequence[tuple[str, str]], faces: Faces) -> None:
    """Refuse conditions on faces that are periodic: they bound nothing.

    Raises
    ------
    InputError
    """
    rows = set(corner_rows(faces)) if pairs else set()
    for name in {name: None for pair in pairs for name in pair}:
        if shared := rows.intersection(corner_rows(body.grid.faces(name))):
            place = body.grid.points[list(min(shared))].mean(axis=0).round(9).tolist()
            raise InputError(
                f"{label}: the face at {place} is one of the periodic faces {name!r} of {body.label}, beyond which it "
                "goes on: there is nothing to act on. Leave such faces out, or the pair"
            )


def refuse_apart(label: str, what: str, number: Ints, values: Array, time: float, size: float = 0.0) -> None:
    """Refuse values (k, ...) that are given to nodes of one `number` (k,) and differ, as images are one node.

    By rounding, of the values or of this `size`, they may.

    Raises
    ------
    RunError
    """
    _, once, inverse = np.unique(number, return_index=True, return_inverse=True)
    apart = np.abs(values - values[once][inverse])
    if apart.max(initial=0.0) > 1e-9 * np.abs(values).max(initial=size):
        raise RunError(
            f"{label}: at t = {time:g} its {what} differs by {apart.max():.6g} between nodes of periodic faces that "
            "are one: give both the same"
        )


def translation(mesh: Mesh, first: str, second: str) -> Array:
    """By what a set of faces is moved onto another (d,)."""
    a, b = (mesh.points[mesh.faces(name).nodes] for name in (first, second))
    return np.asarray(b.mean(axis=0) - a.mean(axis=0))


def partners(mesh: Mesh, first: str, second: str, label: str) -> Ints:
    """Pairs (n, 2) of nodes of two sets of faces that a translation takes onto each other.

    Raises
    ------
    InputError
        If there is no such translation.
    """
    from scipy.spatial import cKDTree

    a, b = mesh.faces(first).nodes, mesh.faces(second).nodes
    shift = translation(mesh, first, second)
    size = float(np.ptp(mesh.points, axis=0).max())
    distance, near = cKDTree(mesh.points[b]).query(mesh.points[a] + shift)
    if len(a) != len(b) or distance.max() > 1e-8 * size or len(np.unique(near)) < len(b):
        raise InputError(
            f"{label}: the nodes of {first!r} ({len(a)}) moved by {shift.round(6).tolist()} do not meet those of "
            f"{second!r} ({len(b)}); periodic faces need equal meshes"
        )
    return np.column_stack([a, b[near]])


def numbering(mesh: Mesh, pairs: Sequence[tuple[str, str]], label: str) -> tuple[Ints, int]:
    """Numbers (n_nodes,) that nodes standing for each other share, and how many there are.

    Examples
    --------
    >>> from visviva import RectangleMesh
    >>> numbering(RectangleMesh(size=(1, 1), counts=(2, 1)).build(), [("x0", "x1")], "mesh")[0].tolist()
    [0, 1, 0, 2, 3, 2]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not pairs:
        return np.arange(mesh.n_nodes), mesh.n_nodes
    edges = np.concatenate([partners(mesh, *pair, label) for pair in pairs])
    graph = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(mesh.n_nodes,) * 2)
    count, group = connected_components(graph, directed=False)
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))  # in the order of the nodes
    return rank[inverse].astype(np.int64), int(count)


def differences(leaders: Ints, size: int) -> Any:
    """Rows (k, size) of the ones that follow others, less the `leaders` (size,) of theirs, as a sparse matrix.

    Examples
    --------
    >>> differences(np.array([0, 1, 0]), 3).toarray().tolist()
    [[-1.0, 0.0, 1.0]]
    """
    import scipy.sparse as sp

    followers, unit = np.flatnonzero(leaders != np.arange(size)), sp.eye_array(size, format="csr")
    return sp.csr_array(unit[followers] - unit[leaders[followers]])


class Periods:
    """Translations (m, d) that take a periodic mesh onto its continuation; none of other meshes.

    Examples
    --------
    >>> from visviva import RectangleMesh
    >>> mesh = RectangleMesh(size=(2, 1), counts=(2, 1)).build()
    >>> next(Periods(mesh, [("x0", "x1")]).images(np.array([(0.5, 0.5), (-3.5, 0.5)]))).tolist()
    [[0.5, 0.5], [0.5, 0.5]]
    """

    def __init__(self, mesh: Mesh, pairs: Sequence[tuple[str, str]]) -> None:
        shifts = np.zeros((0, mesh.points.shape[1]))
        for pair in pairs:
            more = np.vstack([shifts, translation(mesh, *pair)])
            shifts = (
                more if np.linalg.matrix_rank(more) == len(more) else shifts
            )  # faces side by side share theirs
        self.shifts = shifts
        self._low, self._high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        self._middle = 0.5 * (self._low + self._high)

    def images(self, places: Array, middle: Array | None = None) -> Iterator[Array]:
        """Places (n, d) moved by whole periods: nearest to a `middle`, by default of the mesh, then beside."""
        turns = np.round(
            (places - (self._middle if middle is None else middle)) @ np.linalg.pinv(self.shifts)
        )
        for step in sorted(itertools.product((0, -1, 1), repeat=len(self.shifts)), key=np.count_nonzero):
            yield places - (turns + step) @ self.shifts

    def copies(self, points: Array, reach: float) -> Array:
        """All images (m, d) of points (n, d) that the mesh, or what is nearer to it than `reach`, holds."""
        if not len(self.shifts):
            return points
        found = np.vstack(list(self.images(points)))
        near = (found > self._low - reach) & (found < self._high + reach)
        return np.asarray(found[near.all(axis=1)])
