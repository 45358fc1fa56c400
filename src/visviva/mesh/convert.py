"""Meshes from meshes: joined, welded, of second order, renumbered. Sets follow."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.base.errors import InputError, nearest
from visviva.mesh.cells import CELLS, Array, Cell, Ints, cell_type
from visviva.mesh.faces import Faces, union
from visviva.mesh.geometry import equal_rows

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh


def names(mappings: Iterable[Mapping[str, Any]]) -> list[str]:
    """Keys of all mappings, in order, each once."""
    return list(dict.fromkeys(name for mapping in mappings for name in mapping))


def cell_numbers(cells: Mapping[str, Ints]) -> dict[str, Ints]:
    """Numbers (m,) of the cells by type."""
    ends = np.cumsum([len(rows) for rows in cells.values()])
    return {
        name: np.arange(end - len(rows), end) for (name, rows), end in zip(cells.items(), ends, strict=True)
    }


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes in one, nodes and cells one after another, sets of the same name united."""
    if len({m.points.shape[1] for m in meshes}) > 1:
        raise InputError("a mesh in the plane cannot be merged with one in space")
    starts = np.cumsum([0, *(m.n_nodes for m in meshes)])
    shifted = [
        {name: rows + start for name, rows in m.cells.items()}
        for m, start in zip(meshes, starts, strict=False)
    ]
    cells = {
        t: np.concatenate([part[t] for part in shifted if t in part]) for t in names(m.cells for m in meshes)
    }
    owners = _owners_after_joining(meshes, cells)
    nodes = [np.arange(m.n_nodes) + start for m, start in zip(meshes, starts, strict=False)]
    moved = [
        [(name, s.renumbered(n, o)) for name, s in m.face_sets.items()]
        for m, n, o in zip(meshes, nodes, owners, strict=True)
    ]
    face_names = names(m.face_sets for m in meshes)
    return replace(
        meshes[0],
        points=np.concatenate([m.points for m in meshes]),
        cells=cells,
        node_sets=_united([m.node_sets for m in meshes], nodes),
        face_sets={name: union(s for part in moved for n, s in part if n == name) for name in face_names},
        cell_sets=_united([m.cell_sets for m in meshes], owners),
    )


def _owners_after_joining(meshes: Sequence[Mesh], cells: Mapping[str, Ints]) -> list[Ints]:
    """For every mesh, the numbers (n_cells,) of its cells in the joined mesh."""
    first = {name: int(rows[0]) for name, rows in cell_numbers(cells).items()}
    found = []
    for mesh in meshes:
        parts = []
        for name, rows in mesh.cells.items():
            parts.append(np.arange(first[name], first[name] + len(rows)))
            first[name] += len(rows)
        found.append(np.concatenate([np.zeros(0, np.int64), *parts]))
    return found


def _united(sets: Sequence[Mapping[str, Ints]], numbers: Sequence[Ints]) -> dict[str, Ints]:
    pairs = list(zip(sets, numbers, strict=True))
    return {k: np.unique(np.concatenate([n[s[k]] for s, n in pairs if k in s])) for k in names(sets)}


def with_nodes_numbered(mesh: Mesh, points: Array, new: Ints) -> Mesh:
    """The mesh with other points after node i has become ``new[i]``; -1 for nodes that no cell uses."""
    same = np.arange(mesh.n_cells)
    kept = {name: new[nodes] for name, nodes in mesh.node_sets.items()}
    return replace(
        mesh,
        points=points,
        cells={name: new[rows] for name, rows in mesh.cells.items()},
        node_sets={name: np.unique(nodes[nodes >= 0]) for name, nodes in kept.items()},
        face_sets={name: faces.renumbered(new, same) for name, faces in mesh.face_sets.items()},
    )


def welded(mesh: Mesh, distance: float) -> Mesh:
    """Nodes closer than a distance become one, at the place of the first of them."""
    from scipy.spatial import cKDTree

    return united(mesh, *cKDTree(mesh.points).query_pairs(distance, output_type="ndarray").T)


def united(mesh: Mesh, i: Ints, j: Ints) -> Mesh:
    """Nodes of pairs (m,) become one, at the place of the first of them."""
    group = groups(mesh.n_nodes, i, j)
    _, first = np.unique(group, return_index=True)
    kept = np.sort(first)
    rank = np.empty(len(first), dtype=np.int64)
    rank[group[kept]] = np.arange(len(kept))
    return with_nodes_numbered(mesh, mesh.points[kept], rank[group])


def groups(n: int, i: Ints, j: Ints) -> Ints:
    """Numbers (n,) from 0 of what pairs (m,) of n things join."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, group = connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(n, n)), directed=False)
    return np.asarray(group, dtype=np.int64)


def without_orphans(mesh: Mesh) -> Mesh:
    """Nodes that belong to no cell are dropped."""
    used = np.zeros(mesh.n_nodes, dtype=bool)
    for rows in mesh.cells.values():
        used[rows] = True
    new = np.where(used, np.cumsum(used) - 1, -1)
    return with_nodes_numbered(mesh, mesh.points[used], new)


def renumbered(mesh: Mesh) -> Mesh:
    """Nodes in the order of reverse Cuthill and McKee, cells by their least node."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    n = mesh.n_nodes
    pairs = [(np.repeat(np.arange(len(c)), c.shape[1]), c.ravel(), len(c)) for c in mesh.cells.values()]
    graph = coo_array((n, n)).tocsr()
    for cell, node, m in pairs:
        member = coo_array((np.ones(len(node)), (cell, node)), shape=(m, n)).tocsr()
        graph = graph + member.T @ member
    order = reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True)
    new = np.empty(n, dtype=np.int64)
    new[order] = np.arange(n)
    return _with_cells_sorted(with_nodes_numbered(mesh, mesh.points[order], new))


def _with_cells_sorted(mesh: Mesh) -> Mesh:
    numbers = cell_numbers(mesh.cells)
    orders = {name: np.argsort(rows.min(axis=1), kind="stable") for name, rows in mesh.cells.items()}
    new = np.empty(mesh.n_cells, dtype=np.int64)
    for name, order in orders.items():
        new[numbers[name][order]] = numbers[name]
    same = np.arange(mesh.n_nodes)
    return replace(
        mesh,
        cells={name: rows[orders[name]] for name, rows in mesh.cells.items()},
        face_sets={name: faces.renumbered(same, new) for name, faces in mesh.face_sets.items()},
        cell_sets={name: np.sort(new[cells]) for name, cells in mesh.cell_sets.items()},
    )


def quadratic(mesh: Mesh, cell: str) -> Mesh:
    """The mesh with cells of second order; new nodes lie in the middle of groups of corners."""
    target = cell_type(cell)
    possible = [c.name for c in CELLS.values() if c.middles]
    if cell not in possible:
        raise InputError(f"{cell} is not of second order{nearest(cell, possible)}")
    sources = [name for name in mesh.cells if CELLS[name].family != target.family or CELLS[name].middles]
    if sources:
        linear = next(c.name for c in CELLS.values() if c.family == target.family)
        raise InputError(f"cells {', '.join(sources)} cannot become {cell}: that takes {linear}")
    ((_, corners),) = mesh.cells.items()
    groups = [[corners[:, list(g)] for g in target.middles]]
    faces = [(name, kind, rows) for name, s in mesh.face_sets.items() for kind, rows in s.cells.items()]
    kinds = {CELLS[f.type].n_corners: CELLS[f.type] for f in target.faces}
    for _, kind, rows in faces:
        groups.append([rows[:, list(g)] for g in kinds[CELLS[kind].n_corners].middles])
    numbers, points = _middles(mesh.points, groups)
    sets: dict[str, tuple[dict[str, Ints], dict[str, Ints]]] = {}
    for (name, kind, rows), middle in zip(faces, numbers[1:], strict=True):
        new = kinds[CELLS[kind].n_corners].name
        cells, owners = sets.setdefault(name, ({}, {}))
        cells[new] = np.column_stack([rows, *middle])
        owners[new] = mesh.face_sets[name].owners[kind]
    return replace(
        mesh,
        points=points,
        cells={cell: np.column_stack([corners, *numbers[0]])},
        node_sets=_with_middles(mesh, target, corners, numbers[0]),
        face_sets={name: Faces(*parts) for name, parts in sets.items()},
    )


def _with_middles(mesh: Mesh, target: Cell, corners: Ints, numbers: Sequence[Ints]) -> dict[str, Ints]:
    """Sets of nodes with the new nodes between their nodes."""
    found = {}
    for name, nodes in mesh.node_sets.items():
        member = np.zeros(mesh.n_nodes, dtype=bool)
        member[nodes] = True
        inside = [
            m[member[corners[:, list(g)]].all(axis=1)] for g, m in zip(target.middles, numbers, strict=True)
        ]
        found[name] = np.unique(np.concatenate([nodes, *inside]))
    return found


def _middles(points: Array, parts: Sequence[Sequence[Ints]]) -> tuple[list[list[Ints]], Array]:
    """Numbers (m,) of new nodes for each group of corners (m, k); the same corners share theirs."""
    flat = [group for part in parts for group in part]
    numbers: list[Ints] = [np.zeros(0, np.int64)] * len(flat)
    grown = [points]
    for size in sorted({group.shape[1] for group in flat}):
        which = [k for k, group in enumerate(flat) if group.shape[1] == size]
        rows = np.sort(np.concatenate([flat[k] for k in which]), axis=1)
        first, group = equal_rows(rows)
        start = sum(map(len, grown))
        grown.append(points[rows[first]].mean(axis=1))
        split = np.split(start + group, np.cumsum([len(flat[k]) for k in which])[:-1])
        for k, shared in zip(which, split, strict=True):
            numbers[k] = shared
    result, at = [], 0
    for part in parts:
        result.append(numbers[at : at + len(part)])
        at += len(part)
    return result, np.concatenate(grown)
