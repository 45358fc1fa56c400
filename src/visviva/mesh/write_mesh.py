"""Meshes written to files, with their sets."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS, Ints
from visviva.mesh.convert import cell_numbers
from visviva.mesh.node_orders import written_order
from visviva.mesh.write_abaqus import write_abaqus

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
        write_abaqus(mesh, path)
        return
    meshio = load_meshio()
    gmsh = path.suffix.lower() == ".msh"
    legacy = path.suffix.lower() == ".vtk"  # where names are written without blanks
    made = _tagged(meshio, mesh) if gmsh else _marked(meshio, mesh, quote if legacy else str)
    for block, kind in zip(made.cells, mesh.cells, strict=False):  # those of lower dimension are the same
        block.data = written_order(path.suffix.lower(), kind, block.data)
    try:
        meshio.write(path, made, file_format="gmsh22" if gmsh else None)
    except ModuleNotFoundError as error:
        raise InputError(
            f"meshio writes *{path.suffix} by another package: pip install {error.name}"
        ) from error
    except (Exception, SystemExit) as error:  # its writers raise many kinds, or exit
        raise InputError(
            f"meshio cannot write {path} ({type(error).__name__}: {error}); .vtu, .msh and .inp hold all sets"
        ) from error


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


def _in_space(mesh: Mesh) -> Any:
    """Points (n, 3), as most formats want them."""
    return np.pad(mesh.points, ((0, 0), (0, 3 - mesh.points.shape[1])))
