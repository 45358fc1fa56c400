"""One writer at a time: a lock of the operating system on the directory of a run."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from visviva.base.errors import InputError

try:
    import fcntl
except ImportError:  # where there is no flock there is no lock
    fcntl = None  # type: ignore[assignment]

NAME = ".lock"


@contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Hold the lock of a directory; the system releases it when the process ends in whatever way.

    The file stays, for to delete it would let two writers lock two files. What it holds, process and host, is for
    messages alone.

    Raises
    ------
    InputError
        If another process, or another run of this one, writes there, or the file system knows no locks.
    """
    if fcntl is None:
        yield
        return
    descriptor = os.open(directory / NAME, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(descriptor, 200, 0).decode(errors="replace").strip() or "another process"
            raise InputError(
                f"{directory}: is being written by {holder}; wait for it, stop it, or choose another directory"
            ) from None
        except OSError as error:
            raise InputError(
                f"{directory}: its file system knows no locks ({error.strerror}); choose another directory, or say "
                "lock=False (--no-lock) and see yourself that no two runs write there at once"
            ) from error
        with suppress(OSError):  # on a full disk the lock holds without its message
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, f"process {os.getpid()} on {socket.gethostname()}\n".encode(), 0)
        yield
    finally:
        with suppress(OSError):  # at once, even if a child process has inherited the descriptor
            fcntl.flock(descriptor, fcntl.LOCK_UN)
        os.close(descriptor)
