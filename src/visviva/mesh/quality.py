"""Checks of mesh quality: which cells cannot carry elements, where and why."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Array, Cell, Ints
from visviva.mesh.geometry import chunks, jacobians, measure
from visviva.mesh.quadrature import stiffness_rule

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

DEGENERATE = 1e-10  # scaled Jacobian below which a cell has no volume but for round-off

ALONG = 9  # sites of a line


def _sites(cell: Cell) -> Array:
    """Points at which Jacobians are evaluated: quadrature points, then corners; of lines one after another."""
    if cell.dimension == 1:
        return np.linspace(-1, 1, ALONG)[:, None]
    return np.concatenate([stiffness_rule(cell.name).points, cell.nodes[: cell.n_corners]])


def _scaled(points: Array, nodes: Ints, cell: Cell) -> Array:
    """Jacobians (m, sites) over the product of the lengths of their columns.

    Of lines and of surfaces in space where they fold back negative.
    """
    J = jacobians(points, nodes, cell.dN(_sites(cell)))
    lengths = np.sqrt(np.square(J).sum(axis=2)).prod(axis=2)
    best = np.prod([np.linalg.norm(column) for column in _ideal(cell)])
    return np.asarray(_directed(J, points, nodes) / np.where(lengths > 0, lengths, 1.0) * best)


def _directed(J: Array, points: Array, nodes: Ints) -> Array:
    """Determinants (m, sites); of lines and of surfaces in space the part along the site before, or the corners."""
    d, dimension = J.shape[2:]
    if dimension == 1:
        own = J[..., 0]
        along = np.concatenate([own[:, 1:2], own[:, :-1]], axis=1)
    elif d > dimension:
        a, b, c = (points[nodes[:, k]] for k in (0, 1, 2))
        own, along = np.cross(J[..., 0], J[..., 1]), np.cross(b - a, c - a)[:, None]
    else:
        return measure(J)
    size = np.linalg.norm(along, axis=2, keepdims=True)
    return np.asarray(np.sum(own * (along / np.where(size > 0, size, 1.0)), axis=2))


def _ideal(cell: Cell) -> Array:
    """Edges (by rows) of the equilateral cell, scaled to determinant one: the best there is."""
    if cell.family.corners[0][0] < 0:  # products of lines
        return np.eye(cell.dimension)
    corners = np.array([[1, 0, 0], [0.5, 0.75**0.5, 0], [0.5, 1 / 12**0.5, (2 / 3) ** 0.5]])
    if cell.n_corners == 6:
        corners = np.array([[1, 0, 0], [0.5, 0.75**0.5, 0], [0, 0, 1]])
    rows = corners[: cell.dimension, : cell.dimension]
    return np.asarray(rows / np.linalg.det(rows) ** (1 / cell.dimension))


def scaled_jacobians(mesh: Mesh) -> Array:
    """Least scaled Jacobian of every cell (n_cells,)."""
    found = [np.zeros(0)]
    for name, nodes in mesh.cells.items():
        found += [_scaled(mesh.points, part, CELLS[name]).min(axis=1) for part in chunks(nodes)]
    return np.concatenate(found)


def check(mesh: Mesh) -> None:
    """Refuse a mesh on which no elements can be built."""
    _check_numbers(mesh)
    check_shape(mesh)


def _check_numbers(mesh: Mesh) -> None:
    if not mesh.n_cells:
        raise InputError("the mesh has no cells")
    dimensions = {name: CELLS[name].dimension for name in mesh.cells}
    if len(set(dimensions.values())) > 1:
        parts = ", ".join(f"{len(mesh.cells[name])} {name} ({d}D)" for name, d in dimensions.items())
        raise InputError(
            f"the mesh mixes cells of several dimensions: {parts}; keep those of one, and the others as sets "
            "of faces"
        )
    bad = np.flatnonzero(~np.isfinite(mesh.points).all(axis=1))
    if len(bad):
        raise InputError(
            f"{_several(len(bad), 'point', 'of the mesh')} not finite, the first is node {bad[0]}"
        )
    for name, nodes in mesh.cells.items():
        ordered = np.sort(nodes, axis=1)
        twice = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        if len(twice):
            raise InputError(
                f"{_several(len(twice), 'cell', f'of type {name}')} collapsed, with a node twice, the first is "
                f"{_cell(mesh, name, int(twice[0]))}, nodes {nodes[twice[0]].tolist()}: mesh the place "
                "without collapsed cells"
            )
        _check_copies(mesh, name, ordered)
    used = np.zeros(mesh.n_nodes, dtype=bool)
    for nodes in mesh.cells.values():
        used[nodes] = True
    if not used.all():
        first = int(np.flatnonzero(~used)[0])
        raise InputError(
            f"{_several(int((~used).sum()), 'node', 'of the mesh')} in no cell, the first is node {first} at "
            f"{_place(mesh.points[first])}: delete them with mesh.without_orphans()"
        )


def _check_copies(mesh: Mesh, name: str, ordered: Ints) -> None:
    """Refuse cells of the same nodes: they would have stiffness and mass twice."""
    place = np.lexsort(ordered.T)
    same = np.flatnonzero((ordered[place[1:]] == ordered[place[:-1]]).all(axis=1))
    if len(same):
        a, b = sorted(place[same[0] : same[0] + 2].tolist())
        raise InputError(
            f"{_several(len(same), 'cell', f'of type {name}')} there twice: {_cell(mesh, name, b)} has the nodes of "
            f"{_cell(mesh, name, a)}; delete the copies, which would have their stiffness and mass twice"
        )


def check_shape(mesh: Mesh) -> None:
    """Refuse cells that are inside out, fold back or have no size."""
    for name, nodes in mesh.cells.items():
        found = np.concatenate([_scaled(mesh.points, part, CELLS[name]) for part in chunks(nodes)])
        bad = np.flatnonzero(found.min(axis=1) <= DEGENERATE)
        if len(bad):
            first = int(bad[0])
            site = int(found[first].argmin())
            raise InputError(
                f"{_several(len(bad), 'cell', f'of type {name}')} inverted or degenerate, the first is "
                f"{_cell(mesh, name, first)}: its scaled Jacobian is {found[first, site]:.3g} at "
                f"{_place(_position(mesh, name, nodes[first], site))}. "
                + _advice(CELLS[name], bool((found[bad].max(axis=1) < 0).all()), len(bad) == len(nodes))
            )


def _advice(cell: Cell, all_negative: bool, every: bool) -> str:
    if all_negative and every:
        return "All are inside out: their nodes are not in the order of VTK, or the mesh is a mirror image"
    if cell.n_corners < cell.n_nodes:
        return "Move the nodes in the middle of edges towards the middle, refine there, or use straight edges"
    return "Mesh the place anew, or move its nodes"


def _several(n: int, what: str, which: str) -> str:
    """Beginning of a sentence: how many are what follows."""
    return f"{n} {what}s {which} are" if n > 1 else f"1 {what} {which} is"


def _place(point: Array) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def _cell(mesh: Mesh, name: str, row: int) -> str:
    names = list(mesh.cells)
    start = sum(len(mesh.cells[before]) for before in names[: names.index(name)])
    return f"cell {start + row}"


def _position(mesh: Mesh, name: str, nodes: Ints, site: int) -> Array:
    return np.asarray(CELLS[name].N(_sites(CELLS[name])[[site]])[0] @ mesh.points[nodes])
