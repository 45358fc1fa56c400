"""CAD files, which Gmsh reads by their named format and meshes, in a process of its own."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from pathlib import Path

from visviva.base.errors import InputError
from visviva.mesh import cad_worker

FORMATS = {".step": "step", ".stp": "step", ".iges": "iges", ".igs": "iges", ".brep": "brep"}
UNITS = {"mm": 1.0, "cm": 0.1, "m": 1e-3, "in": 1 / 25.4, "ft": 1 / 304.8}
"""A millimetre, to which all lengths are converted as they are read, in units of length."""
HEAD = 1000
"""Bytes at the start of a file that tell its format."""
MARKS = {"step": b"ISO-10303-21", "brep": b"CASCADE Topology"}
REFERENCES = (b"DOCUMENT_FILE", b"EXTERNALLY_DEFINED", b"EXTERNAL_SOURCE")
"""Words of STEP by which a file names others to be read with it."""


def meshed(
    path: Path, target: Path, *, size: float | None, order: int, unit: str | None, alone: bool
) -> Path:
    """Write the mesh of a CAD file; with `alone` one that names other files is refused.

    Raises
    ------
    InputError
        If the size of cells is not given, the file is not of the format of its ending, or cannot be meshed.
    """
    kind = FORMATS[path.suffix.lower()]
    if size is None:
        raise InputError(
            "a CAD file is a shape to be meshed: say the size of its cells, MeshFile(..., size=...)"
        )
    if kind == "brep" and unit is not None:
        raise InputError(
            "files *.brep know no unit of length: leave out unit, and scale the mesh where it is to be"
        )
    _refuse_others(path, kind, alone)
    scale = 1.0 if kind == "brep" else UNITS[unit or "mm"]
    ordered = {
        "path": str(path.absolute()), "target": str(target), "format": kind, "size": size / scale, "order": order,
        "unit": scale,
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-P", cad_worker.__file__, json.dumps(ordered)],
        capture_output=True, text=True, errors="replace", check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    _refuse_failure(done)
    return target


def _refuse_failure(done: subprocess.CompletedProcess[str]) -> None:
    """Refuse what the program could not mesh, or found damaged."""
    said, found = done.stderr.strip().splitlines(), re.search(r"ERR [^*\x1b]*", done.stdout)
    if done.returncode == 0 and found is None:
        return
    if done.returncode == 1 and said:
        raise InputError(said[-1])
    if found is not None:
        raise InputError(f"its reader finds it damaged ({found[0].strip()}): export it again")
    what = "did not end with it" if done.returncode == -signal.SIGALRM else "broke down over it"
    raise InputError(f"Gmsh {what}: is the shape whole and closed?")


def _refuse_others(path: Path, kind: str, alone: bool) -> None:
    """Refuse what is not of the format that its ending says, and what names other files."""
    data = path.read_bytes()
    head = data[:HEAD]
    if not (MARKS[kind] in head if kind in MARKS else head[72:73] == b"S"):
        raise InputError(f"it does not begin as files *{path.suffix.lower()} do")
    if not _is_whole(kind, data):
        raise InputError(
            f"it does not end as files *{path.suffix.lower()} do: it is damaged, export it again"
        )
    if alone and kind == "step" and any(word in data for word in REFERENCES):
        raise InputError(
            "it names other files, which may be outside the scene's folder: export it as one file, or allow it by "
            "--allow-outside (in Python read_scene(..., allow_outside=True))"
        )


def _is_whole(kind: str, data: bytes) -> bool:
    """Whether a file has its end; that of IGES tells how many lines each of its sections has."""
    if kind == "step":
        return b"END-ISO-10303-21" in data[-HEAD:]
    if kind == "brep":
        return True  # the reader breaks down over others
    lines = [line for line in data.splitlines() if line.strip()]
    counts = re.findall(rb"([SGDP])\s*(\d+)", lines[-1][:72])
    return lines[-1][72:73] == b"T" and all(
        sum(line[72:73] == section for line in lines) == int(n) for section, n in counts
    )
