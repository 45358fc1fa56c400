"""The mesh: nodes, cells by type, named sets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.arguments import FrozenDict, Named, place, refuse_other
from visviva.base.errors import InputError, nearest
from visviva.base.html import table
from visviva.mesh import convert, cut, faces, quality
from visviva.mesh.cells import Array, Ints, cell_type
from visviva.mesh.faces import Faces
from visviva.mesh.geometry import centres, volumes
from visviva.mesh.seam import welded_across
from visviva.mesh.write_mesh import write

Predicate = Callable[[Array], NDArray[np.bool_]]


@dataclass(frozen=True, eq=False)
class Mesh(metaclass=Named):
    """Nodes, cells by type and named sets of nodes, faces and cells; methods return new meshes.

    Parameters
    ----------
    points : array_like, (n_nodes, 3) or (n_nodes, 2)
        Positions of the nodes.
    cells : mapping of str to array_like of int, (m, k)
        Nodes of the cells by type: line2, line3, line4, tri3, tri6, quad4, quad8, quad9, tet4, tet10, hex8, hex20,
        hex27, wedge6. Nodes are ordered as in VTK (a wedge begins with the triangle that looks anticlockwise
        from the other one). Cells are numbered through all types in the order of the mapping.
    node_sets : mapping of str to array_like of int
    face_sets : mapping of str to Faces
    cell_sets : mapping of str to array_like of int

    Raises
    ------
    InputError
        If types, shapes or numbers do not fit. Geometry is looked at by `check` alone.

    Examples
    --------
    >>> mesh = Mesh([(0, 0), (2, 0), (2, 1), (0, 1)], {"quad4": [(0, 1, 2, 3)]})
    >>> mesh = mesh.with_faces("right", lambda X: X[:, 0] > 1.99)
    >>> mesh.volume, mesh.faces("right").cells["line2"].tolist(), mesh.nodes("right").tolist()
    (2.0, [[1, 2]], [1, 2])
    """

    points: Array
    cells: Mapping[str, Ints]
    node_sets: Mapping[str, Ints] = field(default_factory=dict)
    face_sets: Mapping[str, Faces] = field(default_factory=dict)
    cell_sets: Mapping[str, Ints] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _check_types(self)
        points = _array("points of a mesh", self.points).astype(np.float64, order="C")
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise InputError(f"points of a mesh are an array (n, 3) or (n, 2), not {points.shape}")
        if not np.isfinite(points).all():
            k = int(np.argmin(np.isfinite(points).all(axis=1)))
            raise InputError(f"point {k} of a mesh is not finite: {points[k].tolist()}")
        n, put = len(points), object.__setattr__
        put(self, "points", _fixed(points))
        put(self, "cells", FrozenDict({name: _cells(name, rows, n) for name, rows in self.cells.items()}))
        node_sets = {k: _numbers(f"node set {k!r}", s, n) for k, s in self.node_sets.items()}
        put(self, "node_sets", FrozenDict(node_sets))
        put(self, "face_sets", FrozenDict(self.face_sets))
        sets = self.cell_sets.items()
        put(self, "cell_sets", FrozenDict({k: _numbers(f"cell set {k!r}", s, self.n_cells) for k, s in sets}))

    def _repr_html_(self) -> str:
        rows = [("nodes", self.n_nodes), *((cell, len(nodes)) for cell, nodes in self.cells.items())]
        sets = {
            "sets of nodes": self.node_sets,
            "sets of faces": self.face_sets,
            "sets of cells": self.cell_sets,
        }
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        box = [(f"{c}", f"{a:.6g} to {b:.6g}") for c, a, b in zip("xyz", low, high, strict=False)]
        return table(
            [*rows, *box, *((what, ", ".join(named)) for what, named in sets.items() if named)], title="Mesh"
        )

    def __deepcopy__(self, memo: dict[int, Any]) -> Mesh:
        """Itself: meshes do not change."""
        return self

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(rows)} {name}" for name, rows in self.cells.items())
        sets = ", ".join([*self.node_sets, *self.face_sets, *self.cell_sets])
        return f"<Mesh: {self.n_nodes} nodes, {cells or 'no cells'}; sets: {sets or 'none'}>"

    # --- sizes ----------------------------------------------------------------------------------------------
    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells of all types."""
        return sum(len(rows) for rows in self.cells.values())

    @property
    def dimension(self) -> int:
        """Dimension of the cells: 3 for solids, 2 for plane or curved surfaces, 1 for lines."""
        return max((cell_type(name).dimension for name in self.cells), default=0)

    @property
    def volume(self) -> float:
        """Volume; area or length of meshes of lower dimension."""
        return float(self.volumes.sum())

    @cached_property
    def volumes(self) -> Array:
        """Volume of every cell (n_cells,)."""
        return volumes(self.points, self.cells)

    @property
    def centres(self) -> Array:
        """Centre of every cell (n_cells, d)."""
        return centres(self.points, self.cells)

    @property
    def bounding_box(self) -> Array:
        """Least and greatest coordinates (2, d)."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])

    # --- sets -----------------------------------------------------------------------------------------------
    def nodes(self, name: str) -> Ints:
        """Nodes of a set of nodes, or of the faces of a set of faces.

        Raises
        ------
        InputError
            With the nearest valid name.
        """
        if name in self.node_sets:
            return self.node_sets[name]
        if name in self.face_sets:
            return self.face_sets[name].nodes
        known = {**self.node_sets, **self.face_sets}
        raise InputError(f"the mesh has no set of nodes or faces {name!r}{nearest(name, known)}")

    def faces(self, name: str) -> Faces:
        """A set of faces.

        Raises
        ------
        InputError
            With the nearest valid name.
        """
        if name not in self.face_sets:
            raise InputError(f"the mesh has no set of faces {name!r}{nearest(name, self.face_sets)}")
        return self.face_sets[name]

    def cell_set(self, name: str) -> Ints:
        """Numbers of the cells of a set.

        Raises
        ------
        InputError
            With the nearest valid name.
        """
        if name not in self.cell_sets:
            raise InputError(f"the mesh has no set of cells {name!r}{nearest(name, self.cell_sets)}")
        return self.cell_sets[name]

    @cached_property
    def _boundary(self) -> Faces:
        return faces.boundary(self.cells)

    def boundary(self) -> Faces:
        """All faces that belong to one cell only."""
        return self._boundary

    def surface(self, name: str) -> Mesh:
        """The faces of a set as a mesh of their own: a surface in space, or lines in a plane.

        Examples
        --------
        >>> from visviva import SphereMesh
        >>> SphereMesh(radius=1, counts=(2, 1), cell="hex27").build().surface("outer")
        <Mesh: 386 nodes, 96 quad9; sets: none>
        """
        found = self.faces(name)
        place = np.full(self.n_nodes, -1, dtype=np.int64)
        place[found.nodes] = np.arange(len(found.nodes))
        return Mesh(self.points[found.nodes], {kind: place[rows] for kind, rows in found.cells.items()})

    def select_nodes(self, predicate: Predicate) -> Ints:
        """Nodes for which a function of positions (n, d) gives True (n,).

        Examples
        --------
        >>> from visviva import BoxMesh
        >>> BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)).build().select_nodes(lambda X: X[:, 2] > 0.5).tolist()
        [4, 5, 6, 7]
        """
        return np.flatnonzero(_chosen(predicate, self.points))

    def select_faces(self, predicate: Predicate) -> Faces:
        """Faces of the boundary for whose centres (m, d) a function gives True (m,)."""
        return self.boundary().where(_chosen(predicate, self.boundary().centres(self.points)))

    def select_cells(self, predicate: Predicate) -> Ints:
        """Cells for whose centres (m, d) a function gives True (m,)."""
        return np.flatnonzero(_chosen(predicate, self.centres))

    def with_nodes(self, name: str, nodes: Predicate | ArrayLike) -> Mesh:
        """The mesh with a further set of nodes, given by numbers or by a function of positions."""
        numbers = self.select_nodes(nodes) if callable(nodes) else np.asarray(nodes)
        return replace(self, node_sets={**self.node_sets, name: numbers})

    def with_faces(self, name: str, chosen: Predicate | Faces) -> Mesh:
        """The mesh with a further set of faces, given or chosen on the boundary by their centres."""
        if not (isinstance(chosen, Faces) or callable(chosen)):
            raise InputError(
                f"Mesh: faces are given as Faces or by a function of their centres, not by {chosen!r}"
            )
        found = chosen if isinstance(chosen, Faces) else self.select_faces(chosen)
        return replace(self, face_sets={**self.face_sets, name: found})

    def with_cells(self, name: str, cells: Predicate | ArrayLike) -> Mesh:
        """The mesh with a further set of cells, given by numbers or by a function of their centres."""
        numbers = self.select_cells(cells) if callable(cells) else np.asarray(cells)
        return replace(self, cell_sets={**self.cell_sets, name: numbers})

    # --- other meshes ---------------------------------------------------------------------------------------
    def moved(self, by: ArrayLike) -> Mesh:
        """The mesh moved by a vector (d,)."""
        return replace(self, points=self.points + self._vector("by", by))

    def rotated(self, angle: float, axis: ArrayLike = (0, 0, 1), about: ArrayLike | None = None) -> Mesh:
        """The mesh rotated by an angle in radians about an axis through a point; a plane mesh in its plane.

        Examples
        --------
        >>> mesh = Mesh([(0, 0), (2, 0), (2, 1), (0, 1)], {"quad4": [(0, 1, 2, 3)]})
        >>> mesh.rotated(np.pi / 2).bounding_box.round(12).tolist()
        [[-1.0, 0.0], [0.0, 2.0]]
        """
        from scipy.spatial.transform import Rotation

        d = self.points.shape[1]
        centre = np.zeros(d) if about is None else self._vector("about", about)
        direction = place("Mesh", "axis", axis)
        if not (np.any(direction) and np.isfinite(angle)):
            raise InputError(
                f"a mesh cannot be rotated by {angle!r} about {axis!r}: give an angle and a direction"
            )
        unit = direction / np.linalg.norm(direction)
        R = Rotation.from_rotvec(angle * unit).as_matrix()[:d, :d]
        return replace(self, points=(self.points - centre) @ R.T + centre)

    def scaled(self, factor: ArrayLike, about: ArrayLike | None = None) -> Mesh:
        """The mesh scaled by a positive factor, or one for every direction (d,), about a point."""
        given = _array("the factors of a mesh", factor)
        if not (
            np.all(given > 0) and np.isfinite(given).all() and given.shape in ((), (self.points.shape[1],))
        ):
            raise InputError(f"a mesh cannot be scaled by {factor!r}: give positive factors")
        centre = np.zeros(self.points.shape[1]) if about is None else self._vector("about", about)
        return replace(self, points=(self.points - centre) * given + centre)

    def _vector(self, what: str, given: ArrayLike) -> Array:
        """Finite numbers (d,)."""
        found: Array = np.asarray(_array(f"Mesh: {what}", given), dtype=float)
        if found.shape != (self.points.shape[1],) or not np.isfinite(found).all():
            raise InputError(f"Mesh: {what} is {self.points.shape[1]} finite numbers, not {given!r}")
        return found

    def merged(self, other: Mesh, weld: float | None = None) -> Mesh:
        """Both meshes as one, sets of the same name united.

        Parameters
        ----------
        other : Mesh
        weld : float, optional
            Distance below which nodes of one mesh become those of the other; without it the meshes stay apart. Beside
            a cut (`opened`), where one has several nodes at a place, faces that lie on each other tell which: cuts
            go on in cuts, and end where they meet what is whole.

        Raises
        ------
        InputError
            If no faces tell which of several nodes at a place become one.
        """
        refuse_other("Mesh", "other", other, Mesh, "a mesh")
        return convert.joined([self, other]) if weld is None else welded_across(self, other, weld)

    def quadratic(self, cell: str) -> Mesh:
        """The mesh with cells of second order, new nodes in the middle of edges, faces and cells.

        Parameters
        ----------
        cell : str
            New type: tri6, quad8, quad9, tet10, hex20 or hex27, for cells tri3, quad4, tet4 or hex8.

        Examples
        --------
        >>> from visviva import BoxMesh
        >>> BoxMesh(size=(1, 1, 1), counts=(2, 1, 1)).build().quadratic("hex20")
        <Mesh: 32 nodes, 2 hex20; sets: x0, x1, y0, y1, z0, z1>
        """
        return convert.quadratic(self, cell)

    def opened(self, along: Predicate, beyond: Predicate) -> Mesh:
        """The mesh cut open: nodes are doubled where `along` says so of positions, cells `beyond` have the second ones.

        The end of a cut, where its faces meet, is not `along` it. Its lips are the sets of faces ``slit0`` and, of the
        cells `beyond`, ``slit1``, of all cuts together.

        Examples
        --------
        >>> from visviva import RectangleMesh
        >>> plate = RectangleMesh(size=(2, 2), counts=(2, 2)).build()
        >>> plate.opened(lambda X: (X[:, 1] == 1) & (X[:, 0] < 1), lambda X: X[:, 1] > 1)
        <Mesh: 10 nodes, 4 quad4; sets: x0, x1, y0, y1, slit0, slit1>
        """
        return cut.opened(self, self.select_nodes(along), self.select_cells(beyond))

    def without_orphans(self) -> Mesh:
        """The mesh without nodes that belong to no cell."""
        return convert.without_orphans(self)

    def renumbered(self) -> Mesh:
        """The mesh with nodes and cells so numbered that neighbours are close: reverse Cuthill-McKee."""
        return convert.renumbered(self)

    # --- quality, files -------------------------------------------------------------------------------------
    def quality(self) -> Array:
        """Least scaled Jacobian of every cell (n_cells,): 1 is best, 0 degenerate, below 0 inverted."""
        return quality.scaled_jacobians(self)

    def check(self) -> Mesh:
        """Return the mesh if elements can be built on it.

        Raises
        ------
        InputError
            For inverted or degenerate cells, with number and place, nodes that belong to no cell, nodes that
            are twice in a cell, points that are not finite, cells of several dimensions.
        """
        quality.check(self)
        return self

    def write(self, path: str | Path) -> None:
        """Write a file in the format of its ending: ``.vtu``, ``.vtk``, ``.msh``, ``.inp``, ``.med`` or one of meshio.

        Sets are written with these, so that `MeshFile` finds them again; others lose them, and a warning names them.
        The file is complete at every moment; several processes may write it at once, or each its own.
        """
        write(self, Path(path))


def _fixed(array: Any) -> Any:
    array.flags.writeable = False
    return array


def _check_types(mesh: Mesh) -> None:
    """Refuse what is no mapping from names, and sets of faces that are none."""
    for what in ("cells", "node_sets", "face_sets", "cell_sets"):
        given = getattr(mesh, what)
        if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
            raise InputError(f"Mesh: {what} is a mapping from names, not {given!r}")
    for name, found in mesh.face_sets.items():
        if not isinstance(found, Faces):
            raise InputError(f"Mesh: face set {name!r} is Faces(cells, numbers), not {found!r}")


def _array(what: str, given: Any) -> Any:
    """An array of numbers."""
    try:
        found = np.array(given, order="C")
    except ValueError:  # rows of several lengths
        found = np.array(None)
    if found.dtype.kind not in "iuf":
        raise InputError(f"{what} are not an array of numbers: {given!r}")
    return found


def _numbers(what: str, given: ArrayLike, n: int) -> Ints:
    """Numbers of nodes or cells: integers from 0 to n - 1."""
    found = _array(what, given)
    if found.size == 0:
        found = found.astype(np.int64)
    if not np.issubdtype(found.dtype, np.integer):
        raise InputError(f"{what} holds {found.dtype} instead of whole numbers")
    if found.size and (found.min() < 0 or found.max() >= n):
        raise InputError(f"{what} names number {found.max() if found.min() >= 0 else found.min()} of {n}")
    return np.asarray(_fixed(found.astype(np.int64)))


def _cells(name: str, rows: ArrayLike, n: int) -> Ints:
    found = _numbers(f"the nodes of the cells {name}", rows, n)
    k = cell_type(name).n_nodes
    if found.ndim != 2 or found.shape[1] != k:
        raise InputError(f"cells of type {name} are an array (m, {k}), not {found.shape}")
    return found


def _chosen(predicate: Predicate, points: Array) -> NDArray[np.bool_]:
    found = np.asarray(predicate(points))
    if found.shape != (len(points),) or found.dtype != bool:
        raise InputError(
            f"the function gives {found.dtype} {found.shape} for points {points.shape}: "
            f"it has to give one True or False for each, ({len(points)},), e.g. lambda X: X[:, 0] < 1e-9"
        )
    return found
