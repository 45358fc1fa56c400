"""Contents of a mesh file, and the mesh made of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError, nearest
from visviva.mesh.cells import CELLS, Array, Ints
from visviva.mesh.convert import cell_numbers
from visviva.mesh.faces import Faces, all_faces, boundary, union
from visviva.mesh.geometry import equal_rows
from visviva.mesh.mesh import Mesh

VERTEX = "vertex"  # a single node among the cells of a file


def dimension_of(kind: str) -> int:
    """Dimension of a type of cell, 0 of a vertex."""
    return 0 if kind == VERTEX else CELLS[kind].dimension


@dataclass
class Collection:
    """Cells of any dimension as a file lists them, with named groups.

    Attributes
    ----------
    points : array, (n, 2) or (n, 3)
    types, blocks : list of str, list of array of int (m, k)
        Cells by blocks of one type; entries of all blocks are counted through.
    groups : dict of str to array of int
        Entries by name.
    node_sets : dict of str to array of int
    sides : dict of str to list of (entries, number of the face or None)
        Sets of faces of cells; None stands for those on the boundary.
    """

    points: Array
    types: list[str] = field(default_factory=list)
    blocks: list[Ints] = field(default_factory=list)
    groups: dict[str, Ints] = field(default_factory=dict)
    node_sets: dict[str, Ints] = field(default_factory=dict)
    sides: dict[str, list[tuple[Ints, int | None]]] = field(default_factory=dict)

    def mesh(self) -> Mesh:
        """The mesh of the cells of highest dimension.

        Groups of these become sets of cells, groups of their faces sets of faces, the rest sets of nodes.
        """
        dimension = max(map(dimension_of, self.types), default=0)
        if dimension == 0:
            raise InputError("there are no cells in it")
        cells, number = self._cells(dimension)
        face_sets = {
            name: union(self._side(cells, number, *part) for part in s) for name, s in self.sides.items()
        }
        cell_sets, node_sets = {}, dict(self.node_sets)
        for name, entries in self.groups.items():
            inside = number[entries] >= 0
            if inside.any():
                cell_sets[name] = np.unique(number[entries[inside]])
            faces, lower = self._lower(cells, dimension, entries[~inside], name)
            if faces.n_faces:
                face_sets[name] = faces
            if len(lower):
                node_sets[name] = lower
        return Mesh(self._flat(dimension), cells, node_sets, face_sets, cell_sets)

    def part(self, name: str) -> Collection:
        """Collected mesh without the cells outside a group, but for those of lower dimension between its nodes.

        Raises
        ------
        InputError
            If there is no such group of cells.
        """
        if name not in self.groups:
            raise InputError(f"there is no group of cells {name!r} in it{nearest(name, self.groups)}")
        dimensions = np.repeat([dimension_of(t) for t in self.types], list(map(len, self.blocks)))
        chosen = np.isin(np.arange(len(dimensions)), self.groups[name])
        kept = chosen | ((dimensions < dimensions[chosen].max()) & self._between_nodes_of(chosen))
        new = np.cumsum(kept) - 1
        starts = np.cumsum([0, *map(len, self.blocks)])
        blocks = [rows[kept[k : k + len(rows)]] for rows, k in zip(self.blocks, starts, strict=False)]
        types = [kind for kind, rows in zip(self.types, blocks, strict=True) if len(rows)]
        groups = {label: new[entries[kept[entries]]] for label, entries in self.groups.items()}
        rows = [rows for rows in blocks if len(rows)]
        used = np.unique(np.concatenate([part.ravel() for part in rows]))
        node_sets = {label: nodes for label, nodes in self.node_sets.items() if np.isin(nodes, used).any()}
        inside = {k: [(new[e[kept[e]]], face) for e, face in parts] for k, parts in self.sides.items()}
        sides = {k: [(e, face) for e, face in parts if len(e)] for k, parts in inside.items()}
        return Collection(
            self.points, types, rows, groups, node_sets, {k: parts for k, parts in sides.items() if parts}
        )

    def _between_nodes_of(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """For every cell, whether all of its nodes belong to chosen ones."""
        starts = np.cumsum([0, *map(len, self.blocks)])
        used = np.zeros(len(self.points), dtype=bool)
        for rows, k in zip(self.blocks, starts, strict=False):
            used[rows[chosen[k : k + len(rows)]]] = True
        return np.concatenate([used[rows].all(axis=1) for rows in self.blocks])

    def _cells(self, dimension: int) -> tuple[dict[str, Ints], Ints]:
        """Cells by type, the same cell once, and the number of the cell for every entry or -1."""
        starts = np.cumsum([0, *map(len, self.blocks)])
        number = np.full(starts[-1], -1)
        cells: dict[str, Ints] = {}
        total = 0
        for name in dict.fromkeys(t for t in self.types if dimension_of(t) == dimension):
            which = [k for k, t in enumerate(self.types) if t == name]
            rows = np.concatenate([self.blocks[k] for k in which])
            entries = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in which])
            first, group = equal_rows(np.sort(rows, axis=1))
            kept = np.sort(first)
            cells[name] = rows[kept]
            number[entries] = total + np.searchsorted(kept, first[group])
            total += len(kept)
        return cells, number

    def _lower(self, cells: dict[str, Ints], dimension: int, entries: Ints, label: str) -> tuple[Faces, Ints]:
        """The faces among the entries of a group, and the nodes of what is still lower."""
        starts = np.cumsum([0, *map(len, self.blocks)])
        faces, nodes = [], [np.zeros(0, np.int64)]
        for k in np.unique(np.searchsorted(starts, entries, side="right") - 1):
            rows = self.blocks[k][entries[(entries >= starts[k]) & (entries < starts[k + 1])] - starts[k]]
            if dimension_of(self.types[k]) == dimension - 1 > 0:
                faces.append(match(cells, self.types[k], rows, label))
            else:
                nodes.append(rows.ravel())
        return union(faces), np.unique(np.concatenate(nodes))

    def _side(self, cells: dict[str, Ints], number: Ints, entries: Ints, face: int | None) -> Faces:
        """A face of each of the entries."""
        owners = number[entries]
        if face is None:
            free = boundary(cells)
            return free.where(np.isin(np.concatenate(list(free.owners.values())), owners))
        found = []
        for name, numbers in cell_numbers(cells).items():
            mine = owners[np.isin(owners, numbers)]
            if len(mine):
                if face >= len(CELLS[name].faces):
                    raise InputError(f"a cell {name} has no side S{face + 1}")
                local = CELLS[name].faces[face]
                nodes = cells[name][mine - numbers[0]][:, local.nodes]
                found.append(Faces({local.type: nodes}, {local.type: mine}))
        return union(found)

    def _flat(self, dimension: int) -> Array:
        """Points of the plane, if plane cells lie in z = 0."""
        flat = dimension == 2 and self.points.shape[1] == 3 and not np.any(self.points[:, 2])
        return self.points[:, :2] if flat else self.points


def match(cells: dict[str, Ints], kind: str, rows: Ints, label: str) -> Faces:
    """Faces of cells that have the same corners as cells of lower dimension.

    Raises
    ------
    InputError
        If one of them is no face of any cell.
    """
    n_corners = CELLS[kind].n_corners
    every = all_faces(cells)
    parts = {t: nodes[:, :n_corners] for t, nodes in every.cells.items() if CELLS[t].n_corners == n_corners}
    corners = np.concatenate([*parts.values(), rows[:, :n_corners]])
    n_faces = len(corners) - len(rows)
    first, group = equal_rows(np.sort(corners, axis=1))
    found = first[group[n_faces:]]
    if len(found) and found.max() >= n_faces:
        missing = rows[np.flatnonzero(found >= n_faces)[0]]
        raise InputError(
            f"the {kind} with the nodes {missing.tolist()} in {label!r} is no face of any cell; to read those "
            f"alone, say MeshFile(..., part={label!r})"
        )
    chosen = np.zeros(n_faces, dtype=bool)
    chosen[found] = True
    return Faces({t: every.cells[t] for t in parts}, {t: every.owners[t] for t in parts}).where(chosen)
