"""Files that meshes and shapes are read from, and where they may be."""

from __future__ import annotations

from pathlib import Path

from visviva.base.errors import InputError


def existing(file: Path) -> Path:
    """The file if there is one, else `InputError`; names that no file can have are none."""
    try:
        found = file.is_file()
    except (OSError, ValueError):  # too long, or with characters of no name
        found = False
    if not found:
        raise InputError(f"there is no mesh file {file}: check the path, relative to {Path.cwd()}")
    return file


def refuse_outside(file: Path, folder: Path | None) -> None:
    """Refuse a file that is not in a folder, links followed; without a folder nothing is refused."""
    try:
        inside = folder is None or file.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a link to itself is a RuntimeError before Python 3.13
        inside = False
    if not inside:
        raise InputError(
            f"{file} is outside the scene's folder {folder}: move it there, or allow it by --allow-outside (in "
            "Python read_scene(..., allow_outside=True))"
        )
