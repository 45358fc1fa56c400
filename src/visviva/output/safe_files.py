"""Writing files so that neither a full disk nor a killed process leaves something unreadable."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from visviva.base.errors import InputError, RunError, VisvivaError


@contextmanager
def reporting(path: Path, kept_until: float | None = None) -> Iterator[None]:
    """Turn an `OSError`, or what h5py raises instead, into a `RunError` that names the file and what stays readable.

    Parameters
    ----------
    path
        File being written.
    kept_until
        Time up to which the file stays valid, or None where nothing was written yet.
    """
    try:
        yield
    except VisvivaError:
        raise
    except (OSError, RuntimeError) as error:
        number = getattr(error, "errno", None)
        reason = os.strerror(number) if number else str(error)
        kept = "" if kept_until is None else f"; what it holds up to t = {kept_until!r} stays readable"
        raise RunError(f"cannot write {path}: {reason}{kept}") from error


def called(file: str | Path, what: str, *endings: str) -> Path:
    """The path, if its ending says what is going to be written.

    Raises
    ------
    InputError
        If it says something else: programs would refuse the file, or show nothing.
    """
    path = Path(file)
    if path.suffix.lower() not in endings:
        raise InputError(f"{path}: {what} are written as {', '.join(endings)}")
    return path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path` that takes its place, durably, when the block succeeds.

    At every moment `path` holds either the old or the new content, complete. Its folder is made if there is none.
    """
    temporary = path.with_name(f".{path.name}.new")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield temporary
        with open(temporary, "rb") as written:
            os.fsync(written.fileno())
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise


def holds(path: Path, descriptor: int) -> bool:
    """Whether an open file is the one that has the name now."""
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False


def settle(path: Path, descriptor: int) -> None:
    """Make sure that what is written outlives a loss of power, and is in the file that has the name now.

    Raises
    ------
    RunError
        If it is not, so that what was written is lost or elsewhere.
    """
    os.fsync(descriptor)
    if not holds(path, descriptor):
        raise RunError(f"{path} was moved, removed or replaced while the run wrote it: put it back to go on")


def write_at(descriptor: int, data: bytes | memoryview, offset: int) -> None:
    """Write all of `data` at byte `offset` of an open file; raise `OSError` if the disk is full."""
    view = memoryview(data).cast("B")
    while len(view):
        written = os.pwrite(descriptor, view, offset)
        view, offset = view[written:], offset + written
