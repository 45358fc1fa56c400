"""Meshes written to files, with their sets."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.convert import cell_numbers
from visviva.mesh.node_orders import written_order
from visviva.mesh.write_abaqus import write_abaqus

HOLD_SETS = (".vtu", ".vtk", ".msh", ".inp", ".med", ".xdmf", ".xmf")

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh


def load_meshio() -> Any:
    """The optional package meshio, imported where it is first needed."""
    try:
        import meshio
    except ImportError as error:
        raise InputError('a mesh file needs the package meshio: pip install "visviva[mesh]"') from error
    return meshio


def write(mesh: Mesh, path: Path) -> None:
    """Write a mesh in the format that its ending says."""
    if not path.parent.is_dir():
        raise InputError(f"{path} cannot be written: there is no folder {path.parent}")
    if path.suffix.lower() == ".inp":
        with in_place_of(path) as new:
            write_abaqus(mesh, new)
        return
    meshio = load_meshio()
    gmsh = path.suffix.lower() == ".msh"
    legacy = path.suffix.lower() == ".vtk"  # where names are written without blanks
    if path.suffix.lower() == ".med":
        made = _grouped(meshio, mesh)
    else:
        made = _tagged(meshio, mesh) if gmsh else _marked(meshio, mesh, quote if legacy else str)
    for block, kind in zip(made.cells, mesh.cells, strict=False):  # those of lower dimension are the same
        block.data = written_order(path.suffix.lower(), kind, block.data)
    try:
        with in_place_of(path) as new:
            meshio.write(new, made, file_format="gmsh22" if gmsh else None)
    except ModuleNotFoundError as error:
        raise InputError(
            f"meshio writes *{path.suffix} by another package: pip install {error.name}"
        ) from error
    except (Exception, SystemExit) as error:  # its writers raise many kinds, or exit
        raise InputError(
            f"meshio cannot write {path} ({type(error).__name__}: {error}); .vtu, .msh, .inp and .med hold all sets"
        ) from error
    lost = sorted({*mesh.node_sets, *mesh.face_sets, *mesh.cell_sets})
    if lost and path.suffix.lower() not in HOLD_SETS:
        text = f"{path} cannot hold all sets of the mesh ({', '.join(lost)}); .vtu, .msh, .inp and .med can"
        warnings.warn(text, stacklevel=3)


@contextmanager
def in_place_of(path: Path) -> Iterator[Path]:
    """A path of this name in a folder of its own; what is written there takes its place when the block succeeds.

    So a file is complete at every moment, however many processes write it; some formats take several files.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".") as folder:
        yield Path(folder) / path.name
        for file in Path(folder).iterdir():
            os.replace(file, path.parent / file.name)


def _marked(meshio: Any, mesh: Mesh, encoded: Callable[[str], str]) -> Any:
    """With sets as arrays of zeros and ones; sets of faces are cells of their own, each face once."""
    numbers = cell_numbers(mesh.cells)
    blocks = [(CELLS[name].meshio, rows) for name, rows in mesh.cells.items()]
    parts = [(name, kind, rows) for name, s in mesh.face_sets.items() for kind, rows in s.cells.items()]
    blocks += [(CELLS[kind].meshio, rows) for _, kind, rows in parts]
    cell_data = {
        name: [np.isin(own, members).astype(np.int8) for own in numbers.values()]
        + [np.zeros(len(rows), np.int8) for _, _, rows in parts]
        for name, members in {**dict.fromkeys(mesh.face_sets, np.zeros(0)), **mesh.cell_sets}.items()
    }
    for k, (name, _, rows) in enumerate(parts):
        cell_data[name][len(mesh.cells) + k] = np.ones(len(rows), np.int8)
    nodes = np.arange(mesh.n_nodes)
    point_data = {name: np.isin(nodes, members).astype(np.int8) for name, members in mesh.node_sets.items()}
    on_points = {encoded(name): data for name, data in point_data.items()}
    on_cells = {encoded(name): data for name, data in cell_data.items()}
    return meshio.Mesh(_in_space(mesh), blocks, point_data=on_points, cell_data=on_cells)


def _tagged(meshio: Any, mesh: Mesh) -> Any:
    """With sets as physical groups of Gmsh; a cell in several sets is written once for each."""
    names = [*mesh.cell_sets, *mesh.face_sets, *mesh.node_sets]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"two sets of the mesh are called {twice!r}, which a Gmsh file cannot hold")
    tag = {name: k + 1 for k, name in enumerate(names)}
    blocks, tags = [], []
    for name, rows in mesh.cells.items():
        for chosen, values in _tags(cell_numbers(mesh.cells)[name], mesh.cell_sets, tag):
            blocks.append((CELLS[name].meshio, rows[chosen]))
            tags.append(values)
    for name, faces in mesh.face_sets.items():
        blocks += [(CELLS[kind].meshio, rows) for kind, rows in faces.cells.items()]
        tags += [np.full(len(rows), tag[name]) for rows in faces.cells.values()]
    for name, members in mesh.node_sets.items():
        blocks.append(("vertex", members[:, None]))
        tags.append(np.full(len(members), tag[name]))
    dims = [mesh.dimension] * len(mesh.cell_sets) + [mesh.dimension - 1] * len(mesh.face_sets)
    dims += [0] * len(mesh.node_sets)
    field_data = {name: np.array([tag[name], dim]) for name, dim in zip(names, dims, strict=True)}
    data = {"gmsh:physical": tags, "gmsh:geometrical": [part.copy() for part in tags]}
    return meshio.Mesh(_in_space(mesh), blocks, cell_data=data, field_data=field_data)


def _tags(numbers: Ints, sets: Mapping[str, Ints], tag: Mapping[str, int]) -> Iterator[tuple[Ints, Ints]]:
    """Rows of cells and their tags: all cells once, then those that are in a second set."""
    values = np.zeros(len(numbers), np.int64)
    again = []
    for name, members in sets.items():
        rows = np.flatnonzero(np.isin(numbers, members))
        free = rows[values[rows] == 0]
        values[free] = tag[name]
        second = np.setdiff1d(rows, free)
        again.append((second, np.full(len(second), tag[name])))
    yield np.arange(len(numbers)), values
    yield from (pair for pair in again if len(pair[0]))


def _grouped(meshio: Any, mesh: Mesh) -> Any:
    """With sets as groups of MED: all cells, faces and nodes are there once, and their family says in which groups."""
    names = list(dict.fromkeys([*mesh.cell_sets, *mesh.face_sets]))
    blocks, inside = [], []
    for kind, numbers in cell_numbers(mesh.cells).items():
        blocks.append((CELLS[kind].meshio, mesh.cells[kind]))
        inside.append(_members(numbers, [mesh.cell_sets.get(name, ()) for name in names]))
    for kind in dict.fromkeys(kind for faces in mesh.face_sets.values() for kind in faces.cells):
        parts = [mesh.face_sets[name].cells.get(kind) if name in mesh.face_sets else None for name in names]
        rows = np.concatenate([part for part in parts if part is not None])
        first, which = np.unique(np.sort(rows, axis=1), axis=0, return_index=True, return_inverse=True)[1:]
        blocks.append((CELLS[kind].meshio, rows[first]))
        ends = np.cumsum([0, *(0 if part is None else len(part) for part in parts)])
        inside.append(_members(np.arange(len(first)), [which[a:b] for a, b in pairwise(ends)]))
    tags, groups = _families(names, np.concatenate(inside))
    split = np.split(-tags, np.cumsum([len(part) for part in inside])[:-1])
    marked = _members(np.arange(mesh.n_nodes), list(mesh.node_sets.values()))
    point_tags, point_groups = _families(list(mesh.node_sets), marked)
    data: dict[str, Any] = {"point_data": {"point_tags": point_tags}, "cell_data": {"cell_tags": split}}
    made = meshio.Mesh(mesh.points, blocks, **data)
    made.cell_tags, made.point_tags = {-tag: some for tag, some in groups.items()}, point_groups
    return made


def _members(numbers: Ints, sets: Sequence[Any]) -> Any:
    """Which sets (m, sets) numbers are in."""
    return np.array([np.isin(numbers, members) for members in sets], bool).reshape(-1, len(numbers)).T


def _families(names: Sequence[str], inside: Any) -> tuple[Ints, dict[int, list[str]]]:
    """Families (m,) by the groups that members are in, 0 for none, and their groups."""
    kinds, which = np.unique(inside, axis=0, return_inverse=True)
    numbers = np.where(kinds.any(axis=1), np.cumsum(kinds.any(axis=1)), 0)
    found = {
        int(n): [name for name, is_in in zip(names, row, strict=True) if is_in]
        for n, row in zip(numbers, kinds, strict=True)
        if n
    }
    return numbers[which.ravel()], found


def _in_space(mesh: Mesh) -> Any:
    """Points (n, 3), as most formats want them."""
    return np.pad(mesh.points, ((0, 0), (0, 3 - mesh.points.shape[1])))
