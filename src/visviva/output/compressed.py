"""Trajectories compressed once they are complete."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from visviva.base.errors import InputError
from visviva.output.safe_files import replacing, reporting
from visviva.output.trajectory import Trajectory

LEVEL = 4
"""Of gzip: higher ones take far longer for little."""
CHUNK = 1 << 17
"""Numbers of a chunk at most; a step of less is one chunk."""


def compress(path: Path) -> None:
    """Put a trajectory with the same contents in the place of a complete one, its values compressed by gzip.

    All that reads trajectories, ParaView too, reads it as before; what appends to it expands it again. What runs
    write while they march is not compressed, for HDF5 cannot append compressed values so that a process may die
    at any moment.

    Raises
    ------
    InputError
        If the file is no trajectory, or the disk has not room for both files.
    RunError
        If it cannot be written; the trajectory is as it was.
    """
    import h5py

    with Trajectory(path) as earlier:
        n_steps = len(earlier.times)
    size, free = path.stat().st_size, shutil.disk_usage(path.parent).free
    if free < size:  # HDF5 does not survive a full disk
        raise InputError(
            f"{path}: cannot be compressed, which takes up to {size / 1e9:.3g} GB more for a while; "
            f"{free / 1e9:.3g} GB are free"
        )
    with (
        reporting(path),
        replacing(path) as temporary,
        h5py.File(path, "r", locking=False) as old,
        h5py.File(temporary, "w", libver="v110") as new,
    ):
        _copy(old, new, n_steps)


def _copy(old: Any, new: Any, n_steps: int) -> None:
    """A group with all that is in it; large values are compressed."""
    import h5py

    for key, value in old.attrs.items():
        new.attrs.create(key, value, dtype=old.attrs.get_id(key).dtype)
    for name, item in old.items():
        if isinstance(item, h5py.Group):
            _copy(item, new.create_group(name), n_steps)
        elif item.dtype.kind == "f" and len(item) > n_steps > 0 and len(item) % n_steps == 0:
            _compress(item, new, name, len(item) // n_steps)
        else:
            old.copy(item, new, name)


def _compress(item: Any, new: Any, name: str, rows: int) -> None:
    width = item.shape[1] if item.ndim > 1 else 1
    chunk = (max(1, min(rows, CHUNK // width)), *item.shape[1:])
    kept = new.create_dataset(
        name, item.shape, item.dtype, chunks=chunk, compression="gzip", compression_opts=LEVEL, shuffle=True
    )
    for key, value in item.attrs.items():
        kept.attrs.create(key, value, dtype=item.attrs.get_id(key).dtype)
    for start in range(0, len(item), rows):
        kept[start : start + rows] = item[start : start + rows]
