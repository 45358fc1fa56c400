"""Which files in a directory are of the run in it: no others are ever removed, or replaced without a word."""

from __future__ import annotations

import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from visviva.base.errors import InputError

if TYPE_CHECKING:
    from visviva.output.directory import RunDirectory

NAME = ".files.json"
FORMAT = "visviva files 1"
PIECE = re.compile(r"\d{3,}-\d{5,}\.vtu")
"""Names of pieces of motions, in folders of theirs."""


def own(run: RunDirectory) -> tuple[Path, ...]:
    """Files of the run in a directory: those in its manifest; without one, all that have a run's names."""
    manifest = run.path / NAME
    if not manifest.exists():
        has_state = run.state.exists() or run.labels.exists()
        return run.files if run.starting.exists() or (run.ledger.exists() and has_state) else ()
    noted, inside = run.read_json(manifest), run.path.resolve()
    if noted.get("format") != FORMAT:
        raise InputError(f"{manifest}: is not of this version; choose another directory")
    named = [run.path / str(name) for name in noted.get("files", ())]
    return tuple(file for file in named if file.parent.resolve() == inside and file.name != "..")


def note(run: RunDirectory, files: Iterable[Path]) -> None:
    """Write the manifest."""
    run.write_json(run.path / NAME, {"format": FORMAT, "files": [file.name for file in files]})


def claim(run: RunDirectory, *files: Path) -> None:
    """Note files or folders in the directory, before they are written, as made of the run.

    Raises
    ------
    InputError
        If one is there already that is not of the run.
    """
    before = own(run)
    new = [file for file in files if file not in before]
    for file in new:
        if file.exists():
            raise InputError(
                f"{file} is there already, and was not made of this run: move it, or give another name by --out"
            )
    if new:
        note(run, (*before, *new))


def refuse_others(run: RunDirectory) -> None:
    """Refuse a directory in which a new run would replace files that are of no run."""
    before = own(run)
    others = [file.name for file in run.files if file.exists() and file not in before]
    if others:
        there = (
            "is there already, and is of no run" if len(others) == 1 else "are there already, and of no run"
        )
        raise InputError(
            f"{run.path}: {', '.join(others)} {there}: move what is yours, or choose another directory"
        )


def remove(made: Path) -> None:
    """Remove a file of a run, or the pieces of a motion in a folder of it, which goes if nothing else is in there."""
    if not made.is_dir() or made.is_symlink():
        made.unlink(missing_ok=True)
        return
    for piece in made.iterdir():
        if PIECE.fullmatch(piece.name):
            piece.unlink()
    with suppress(OSError):
        made.rmdir()
