"""Meshes cut open along nodes: notches and cracks that are there from the start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.mesh.cells import Ints
from visviva.mesh.faces import Faces, boundary, corner_rows, union

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

LIPS = "slit0", "slit1"
"""Names of the sets of faces that a cut leaves."""


def opened(mesh: Mesh, along: Ints, beyond: Ints) -> Mesh:
    """The mesh whose nodes `along` are twice there; the cells `beyond` have the second ones.

    Raises
    ------
    InputError
        If that separates nothing: no nodes are given, or those cells have none of them. If a set of nodes has the
        name of a lip.
    """
    double = np.arange(mesh.n_nodes)
    double[along] = mesh.n_nodes + np.arange(len(along))
    is_beyond = np.zeros(mesh.n_cells, dtype=bool)
    is_beyond[beyond] = True
    cells, first, taken = {}, 0, np.zeros(mesh.n_nodes + len(along), dtype=bool)
    for name, rows in mesh.cells.items():
        turned = is_beyond[first : first + len(rows), None]
        cells[name] = np.where(turned, double[rows], rows)
        taken[cells[name]] = True
        first += len(rows)
    for name in LIPS:
        if name in mesh.node_sets:
            raise InputError(
                f"Mesh: opened names the lips of cuts {LIPS[0]!r} and {LIPS[1]!r}, and there is a set of nodes "
                f"{name!r}: give that another name"
            )
    if not len(along) or not taken[along].all() or not taken[mesh.n_nodes :].all():
        raise InputError(
            "Mesh: opened separates nothing: there must be nodes along the cut, and each needs cells on both sides"
        )
    faces = {name: _faces(found, double, is_beyond) for name, found in mesh.face_sets.items()}
    for name, lip in zip(LIPS, _lips(mesh, cells, along, is_beyond), strict=True):
        faces[name] = union([faces[name], lip]) if name in faces else lip
    nodes = {name: np.union1d(found, double[found]) for name, found in mesh.node_sets.items()}
    points = np.concatenate([mesh.points, mesh.points[along]])
    return replace(mesh, points=points, cells=cells, face_sets=faces, node_sets=nodes)


def _lips(
    mesh: Mesh, cells: Mapping[str, Ints], along: Ints, is_beyond: NDArray[np.bool_]
) -> tuple[Faces, Faces]:
    """Faces that bound the open mesh, and did not bound the closed one: of cells that keep them, and beyond."""
    of = np.concatenate([np.arange(mesh.n_nodes), along])
    known, bound = set(corner_rows(mesh.boundary())), boundary(cells)
    closed = Faces({name: of[rows] for name, rows in bound.cells.items()}, bound.owners)
    is_new = np.array([row not in known for row in corner_rows(closed)], dtype=bool)
    owners = np.concatenate([np.zeros(0, dtype=np.int64), *bound.owners.values()])
    return bound.where(is_new & ~is_beyond[owners]), bound.where(is_new & is_beyond[owners])


def _faces(faces: Faces, double: Ints, is_beyond: NDArray[np.bool_]) -> Faces:
    cells = {
        name: np.where(is_beyond[faces.owners[name]][:, None], double[rows], rows)
        for name, rows in faces.cells.items()
    }
    return Faces(cells, faces.owners)
