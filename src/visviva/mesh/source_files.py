"""Files that meshes and shapes are read from, and where they may be."""

from __future__ import annotations

from pathlib import Path

from visviva.base.errors import InputError

MAX_DEPTH = 20  # of files that include each other


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


def included(file: Path, by: Path, folder: Path | None, depth: int) -> Path:
    """A file that another one includes, refused if that goes too deep or leads out of a folder."""
    if depth > MAX_DEPTH:
        raise InputError(f"{file} is included more than {MAX_DEPTH} deep: does it include itself?")
    try:
        refuse_outside(existing(file), folder)
    except InputError as error:
        raise InputError(f"{by} includes what does not exist or is outside: {error}") from None
    return file
