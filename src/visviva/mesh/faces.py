"""Faces of cells: sets of them, the boundary, matching of faces by their corners."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.arguments import Named, number, vector
from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Array, Ints
from visviva.mesh.geometry import centres, equal_rows, normals, volumes

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh


def corner_rows(faces: Faces) -> list[tuple[int, ...]]:
    """Faces by their sorted corners."""
    return [
        tuple(row)
        for kind, rows in faces.cells.items()
        for row in np.sort(rows[:, : CELLS[kind].n_corners], axis=1).tolist()
    ]


@dataclass(frozen=True, eq=False)
class Faces(metaclass=Named):
    """A set of faces of cells; edges if the cells are plane.

    Parameters
    ----------
    cells : mapping of str to array of int, (m, k)
        Nodes by type of face, so ordered that the face looks out of its cell: the normal of a face in space
        is ``dX/dxi x dX/deta``, that of an edge in the plane ``(dy, -dx)/dxi``.
    owners : mapping of str to array of int, (m,)
        Number of the cell that each face belongs to, counted through all types of the mesh.

    Examples
    --------
    >>> from visviva import BoxMesh
    >>> mesh = BoxMesh(size=(2, 1, 1), counts=(2, 1, 1)).build()
    >>> right = mesh.faces("x1")
    >>> right.cells["quad4"].tolist(), right.owners["quad4"].tolist(), right.area(mesh.points)
    ([[2, 5, 11, 8]], [1], 1.0)
    """

    cells: Mapping[str, Ints]
    owners: Mapping[str, Ints]

    def __post_init__(self) -> None:
        if not (isinstance(self.cells, Mapping) and isinstance(self.owners, Mapping)):
            raise InputError("Faces: cells and owners are mappings from types of faces")
        for name, rows in self.cells.items():
            shape, owners = np.shape(rows), np.shape(self.owners.get(name, ()))
            if name not in CELLS or shape != (*owners, CELLS[name].n_nodes):
                raise InputError(
                    f"Faces: faces {name!r} of shape {shape} do not fit owners of shape {owners}"
                )

    @property
    def n_faces(self) -> int:
        """Number of faces of all types."""
        return sum(len(owner) for owner in self.owners.values())

    @property
    def nodes(self) -> Ints:
        """Their nodes in ascending order."""
        return np.unique(np.concatenate([np.zeros(0, np.int64), *(c.ravel() for c in self.cells.values())]))

    def centres(self, points: Array) -> Array:
        """Positions (n_faces, d) of their centres."""
        return centres(points, self.cells)

    def area(self, points: Array) -> float:
        """Their area; length of edges."""
        return float(volumes(points, self.cells).sum())

    def where(self, chosen: NDArray[np.bool_]) -> Self:
        """The faces that are chosen by a mask (n_faces,)."""
        parts = np.split(chosen, np.cumsum([len(owner) for owner in self.owners.values()])[:-1])
        kept = [(name, part) for name, part in zip(self.cells, parts, strict=True) if part.any()]
        return type(self)(
            {name: self.cells[name][part] for name, part in kept},
            {name: self.owners[name][part] for name, part in kept},
        )

    def near(self, points: Array, place: ArrayLike, within: float) -> Self:
        """The faces whose centre is not farther from a place (d,) than a distance; others raise an error.

        Examples
        --------
        >>> from visviva import BoxMesh
        >>> mesh = BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)).build()
        >>> mesh.boundary().near(mesh.points, (0.5, 0.5, 1.0), within=0.1).n_faces
        1
        """
        at = vector("Faces.near", "place", place, points.shape[1])
        return self.where(
            np.linalg.norm(self.centres(points) - at, axis=1) <= number("Faces.near", "within", within)
        )

    def facing(self, points: Array, direction: ArrayLike, within: float = 45.0) -> Self:
        """The faces whose outward normal is within an angle, in degrees, of a direction (d,); others raise an error.

        Examples
        --------
        >>> from visviva import BoxMesh
        >>> mesh = BoxMesh(size=(4, 1, 1), counts=(4, 1, 1)).build()
        >>> top = mesh.boundary().facing(mesh.points, (0, 0, 1))
        >>> mesh.with_faces("top", top).faces("top").area(mesh.points)
        4.0
        """
        towards = vector("Faces.facing", "direction", direction, points.shape[1])
        if not towards.any():
            raise InputError(f"Faces.facing: direction = {direction!r} has no length")
        towards /= np.abs(towards).max()
        least = np.cos(np.radians(number("Faces.facing", "within", within)))
        return self.where(normals(points, self.cells) @ (towards / np.linalg.norm(towards)) >= least)

    def renumbered(self, nodes: Ints, owners: Ints) -> Self:
        """The same faces after node i has become ``nodes[i]`` and cell j ``owners[j]``."""
        return type(self)(
            {name: nodes[cells] for name, cells in self.cells.items()},
            {name: owners[cells] for name, cells in self.owners.items()},
        )


def chosen_faces(mesh: Mesh, chosen: str | Faces, label: str) -> Faces:
    """Faces of a mesh by the name of their set, 'all' for the whole boundary, or as given.

    Raises
    ------
    InputError
        If there is no such set, or none in it; `label` says whose mesh it is.
    """
    if isinstance(chosen, Faces):
        found = chosen
    elif chosen == "all" and chosen not in mesh.face_sets:
        found = mesh.boundary()
    elif chosen in mesh.node_sets and chosen not in mesh.face_sets:
        raise InputError(f"{label}: {chosen!r} is a set of nodes, but a set of faces is needed")
    else:
        found = mesh.faces(chosen)
    if found.n_faces == 0:
        raise InputError(f"{label}: the set of faces {chosen!r} is empty")
    return found


def chosen_nodes(mesh: Mesh, chosen: str | Faces | ArrayLike, label: str) -> Ints:
    """Nodes (k,) of a mesh by the name of a set of nodes or faces, 'all', `Faces`, or their numbers.

    Raises
    ------
    InputError
        If there is no such set or node, or none in it; `label` says whose mesh it is.
    """
    if isinstance(chosen, str):
        everything = chosen == "all" and chosen not in {*mesh.node_sets, *mesh.face_sets}
        found = np.arange(mesh.n_nodes) if everything else mesh.nodes(chosen)
    else:
        found = np.unique(np.asarray(getattr(chosen, "nodes", chosen), dtype=np.int64))
    if len(found) == 0:
        raise InputError(f"{label}: the set of nodes {chosen!r} is empty")
    if found[0] < 0 or found[-1] >= mesh.n_nodes:
        raise InputError(f"{label}: there is no node {found[0 if found[0] < 0 else -1]}")
    return found


def stacked(parts: Iterable[Faces]) -> Faces:
    """All faces of several sets that have none in common."""
    listed = list(parts)
    names = dict.fromkeys(name for part in listed for name in part.cells)
    return Faces(
        {name: np.concatenate([part.cells[name] for part in listed if name in part.cells]) for name in names},
        {
            name: np.concatenate([part.owners[name] for part in listed if name in part.cells])
            for name in names
        },
    )


def union(parts: Iterable[Faces]) -> Faces:
    """All faces of several sets; what is in several of them is there once."""
    every, once = stacked(parts), {}
    for name, nodes in every.cells.items():
        first, _ = equal_rows(np.column_stack([every.owners[name], np.sort(nodes, axis=1)]))
        once[name] = np.sort(first)
    return Faces(
        {name: every.cells[name][rows] for name, rows in once.items()},
        {name: every.owners[name][rows] for name, rows in once.items()},
    )


def all_faces(cells: Mapping[str, Ints]) -> Faces:
    """Every face of every cell, also those between cells twice."""
    nodes: dict[str, list[Ints]] = {}
    owners: dict[str, list[Ints]] = {}
    start = 0
    for name, rows in cells.items():
        for face in CELLS[name].faces:
            nodes.setdefault(face.type, []).append(rows[:, face.nodes])
            owners.setdefault(face.type, []).append(np.arange(start, start + len(rows)))
        start += len(rows)
    return Faces(
        {name: np.concatenate(part) for name, part in nodes.items()},
        {name: np.concatenate(part) for name, part in owners.items()},
    )


def boundary(cells: Mapping[str, Ints]) -> Faces:
    """Faces that belong to one cell only."""
    every = all_faces(cells)
    single = [np.zeros(0, dtype=bool)]
    for name, nodes in every.cells.items():
        _, group = equal_rows(np.sort(nodes[:, : CELLS[name].n_corners], axis=1))
        single.append(np.bincount(group)[group] == 1)
    return every.where(np.concatenate(single))
