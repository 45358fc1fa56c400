"""Meshes written as Abaqus input files (.inp), and how its elements are called."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from visviva.base.errors import InputError
from visviva.mesh.cells import CELLS
from visviva.mesh.convert import cell_numbers
from visviva.mesh.faces import Faces

if TYPE_CHECKING:
    from visviva.mesh.mesh import Mesh

SOLID = {"4": "tet4", "6": "wedge6", "8": "hex8", "10": "tet10", "20": "hex20", "27": "hex27"}
PLANE = {"3": "tri3", "4": "quad4", "6": "tri6", "8": "quad8", "9": "quad9"}
WRITTEN = {name: f"C3D{n}" for n, name in SOLID.items()} | {name: f"CPE{n}" for n, name in PLANE.items()}
WRITTEN |= {"line2": "B31", "line3": "B32"}
WRITTEN["quad9"] = "M3D9"  # Abaqus has no plane element of nine nodes
# Places of the nodes of a C3D27 in the order of VTK: the cell's middle comes first, then those of S1 to S6.
HEX27 = np.array([*range(20), 26, 24, 23, 25, 21, 22, 20])
LINE3 = np.array([0, 2, 1])  # of a B32: its middle is the second
PLACES = {"hex27": HEX27, "line3": LINE3}


def write_abaqus(mesh: Mesh, path: Path) -> None:
    """Write a mesh with all its sets; elements are named C3D..., CPE... and B3...."""
    lines = ["*NODE"]
    lines += [", ".join([str(k + 1), *map(repr, x)]) for k, x in enumerate(mesh.points.tolist())]
    numbers = cell_numbers(mesh.cells)
    for name, rows in mesh.cells.items():
        if name not in WRITTEN:
            raise InputError(f"Abaqus files of visviva cannot hold cells {name}; write .vtu or .msh")
        nodes = rows[:, np.argsort(PLACES[name])] if name in PLACES else rows
        lines.append(f"*ELEMENT, TYPE={WRITTEN[name]}")
        for row in (np.column_stack([numbers[name], nodes]) + 1).tolist():
            lines += _wrapped(row)
    for name, members in mesh.node_sets.items():
        lines += [f'*NSET, NSET="{name}"', *_wrapped((members + 1).tolist())]
    for name, members in mesh.cell_sets.items():
        lines += [f'*ELSET, ELSET="{name}"', *_wrapped((members + 1).tolist())]
    for name, faces in mesh.face_sets.items():
        lines += [f'*SURFACE, TYPE=ELEMENT, NAME="{name}"', *_labels(mesh, faces)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _wrapped(numbers: list[int]) -> list[str]:
    """Lines of at most sixteen numbers; a comma at the end goes on."""
    rows = [numbers[k : k + 16] for k in range(0, len(numbers), 16)]
    return [", ".join(map(str, row)) + ("," if row is not rows[-1] else "") for row in rows]


def _labels(mesh: Mesh, faces: Faces) -> list[str]:
    """Lines ``element, Sk`` of faces."""
    lines = []
    for kind, nodes in faces.cells.items():
        for name, numbers in cell_numbers(mesh.cells).items():
            mine = np.isin(faces.owners[kind], numbers)
            owners = faces.owners[kind][mine]
            given = np.sort(nodes[mine], axis=1)
            for k, local in enumerate(CELLS[name].faces):
                if local.type == kind:
                    own = np.sort(mesh.cells[name][owners - numbers[0]][:, local.nodes], axis=1)
                    lines += [f"{owner + 1}, S{k + 1}" for owner in owners[(own == given).all(axis=1)]]
    return lines
