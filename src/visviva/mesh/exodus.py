"""Names in files of Exodus II that meshio does not read: cells, their blocks, sets of sides, nameless sets of nodes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import Ints
from visviva.mesh.collect import Collection

FACES = {
    "hex": (2, 3, 4, 5, 0, 1),
    "tet": (1, 2, 3, 0),
    "wedge": (2, 3, 4, 0, 1),
    "quad": (0, 1, 2, 3),
    "tri": (0, 1, 2),
}
"""Which face of a cell is the first, second ... side of Exodus, by the names of cells without their numbers."""


SHAPES = {
    "hex": ("HEX", "HEXAHEDRON"),
    "tetra": ("TET", "TETRA"),
    "wedge": ("WEDGE",),
    "pyramid": ("PYRAMID",),
    "quad": ("QUAD", "SHELL"),
    "tri": ("TRI", "TRIANGLE", "TRISHELL"),
    "bar": ("BAR", "BEAM", "TRUSS", "ROD", "EDGE"),
}
SHORT = {"TETRA4": "TETRA", "WEDGE6": "WEDGE", "PYRAMID5": "PYRAMID", "BAR3": "BEAM3"}
"""What meshio calls cells by other names than those made of shape and number of nodes."""
READ = ("HEX8", "HEX20", "HEX27", "TETRA4", "TETRA10", "WEDGE6", "PYRAMID5", "QUAD4", "QUAD8", "QUAD9", "TRI3",
        "TRI6", "BAR2", "BAR3")  # fmt: skip


def rename_cells(path: Path) -> None:
    """Call the cells of a file as meshio does: the standard leaves open whether it is TET4, TETRA or tetra4.

    Raises
    ------
    InputError
        For cells that meshio does not read.
    """
    import netCDF4

    shapes = {name: shape for shape, names in SHAPES.items() for name in names}
    with netCDF4.Dataset(path, "a") as file:
        for key in [key for key in file.variables if key.removeprefix("connect").isdigit()]:
            block = file.variables[key]
            given, n = str(block.elem_type).strip("\0 "), block.shape[1]
            shape = shapes.get(given.upper().rstrip("0123456789"), "")
            name = f"{'tri' if (shape, n) in (('quad', 3), ('quad', 6)) else shape}{n}".upper()
            if name not in READ:
                raise InputError(f"its block {key.removeprefix('connect')} holds cells {given} of {n} nodes; "
                                 f"known are {', '.join(READ)}")  # fmt: skip
            block.elem_type = SHORT.get(name, name)


def with_names(read: Collection, path: Path) -> Collection:
    """The mesh read by meshio, with a group for every named block and side set of the file."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        _add_blocks(read, file)
        for k, name in _sets(file, "node_ns", "ns_names", "nodes"):
            read.node_sets[name] = np.unique(np.asarray(file.variables[f"node_ns{k}"][:], np.int64) - 1)
        for k, name in _sets(file, "elem_ss", "ss_names", "sides"):
            cells, sides = (
                np.asarray(file.variables[f"{what}_ss{k}"][:], np.int64) - 1 for what in ("elem", "side")
            )
            read.sides[name] = list(_sides_of(read, name, cells, sides, file))
    return read


def _sets(file: Any, key: str, names: str, what: str) -> Iterator[tuple[int, str]]:
    """Numbers and names of what has a variable of its own, such as elem_ss1."""
    given = _words(file, names)
    numbers = sorted(
        int(v.removeprefix(key)) for v in file.variables if v.removeprefix(key).isdigit() and key in v
    )
    for k in numbers:
        name = given[k - 1] if k <= len(given) else ""
        yield k, name or f"{what}{k}"


def _words(file: Any, key: str) -> list[str]:
    if key not in file.variables:
        return []
    return [b"".join(row).split(b"\0")[0].decode(errors="replace").strip() for row in file.variables[key][:]]


def _blocks(read: Collection, file: Any) -> Iterator[tuple[int, int, int, int]]:
    """Number of each block that has cells, its place among those of meshio, and where its cells begin in the file.

    And where they begin in what is read: meshio has blocks in the order in which they are stored.
    """
    stored = [int(name.removeprefix("connect")) for name in file.variables if name.startswith("connect")]
    begins, first = np.cumsum([0, *map(len, read.blocks)]).tolist(), 0
    for number in sorted(stored):
        place = stored.index(number)
        yield number, place, first, begins[place]
        first += len(read.blocks[place])


def _add_blocks(read: Collection, file: Any) -> None:
    named = _words(file, "eb_names")
    for number, place, _, start in _blocks(read, file):
        name = named[number - 1] if number <= len(named) else ""
        read.groups[name or f"block{number}"] = np.arange(start, start + len(read.blocks[place]))


def _sides_of(read: Collection, name: str, cells: Ints, sides: Ints, file: Any) -> Iterator[tuple[Ints, int]]:
    """Cells with the number of their face; sides 1, 2 of shells and triangles in space are themselves: left out."""
    found, in_space = np.zeros(len(cells), dtype=bool), file.dimensions["num_dim"].size == 3
    for number, place, first, start in _blocks(read, file):
        kind, n = read.types[place], len(read.blocks[place])
        called = str(file.variables[f"connect{number}"].elem_type).upper()
        is_shell = "SHELL" in called or (in_space and kind.startswith("tri"))
        faces = (None, None) * is_shell + FACES.get(kind.rstrip("0123456789"), ())
        inside = (cells >= first) & (cells < first + n)
        found |= inside
        for side in np.unique(sides[inside]).tolist():
            if side >= len(faces):
                raise InputError(f"its set of sides {name!r} has side {side + 1} of a {kind}")
            face = faces[side]
            if face is not None:
                yield cells[inside & (sides == side)] - first + start, face
    if not found.all():
        raise InputError(f"its set of sides {name!r} has element {cells[~found][0] + 1}, which is not there")
