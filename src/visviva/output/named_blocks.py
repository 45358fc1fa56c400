"""A motion as one .vtkhdf of named blocks, one per component, for ParaView's tree of blocks."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from visviva.base.errors import InputError
from visviva.output.safe_files import called, replacing, reporting
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory

VERSION = 2, 2
"""Of the format VTKHDF."""


def write_blocks(
    trajectory: str | Path, file: str | Path, *, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Write a motion as a ``MultiBlockDataSet`` of VTKHDF with a block for each component, by its name.

    ``trajectory.vtkhdf`` itself is one grid of all components, as only that can be read at any moment of a run: the
    number of its steps stands in one place. A block holds the fields that its component has. VTK 9.7 reads it, and with
    that PyVista and ParaView; readers of 2024 did not know blocks that change in time, for those there is `write_pvd`.

    Parameters
    ----------
    trajectory
        A ``trajectory.vtkhdf``.
    file
        To write, another one.
    progress
        Called with the number of moments done and of all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the file is the trajectory itself.
    RunError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> parts = [vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball"), vv.PointMass(mass=2.0, name="bob")]
    >>> folder = tempfile.mkdtemp()
    >>> vv.simulate(vv.System(parts), until=0.2, step=0.1).write(folder + "/trajectory.vtkhdf")
    >>> write_blocks(folder + "/trajectory.vtkhdf", folder + "/blocks.vtkhdf").name
    'blocks.vtkhdf'
    """
    import h5py

    target = called(file, "named blocks", ".vtkhdf", ".hdf")
    with Trajectory(trajectory) as motion:
        if target.exists() and os.path.samefile(target, motion.path):
            raise InputError(f"{target}: is the trajectory itself; name another file")
        with reporting(target), replacing(target) as temporary, h5py.File(temporary, "w") as stored:
            root = _typed(stored.create_group("VTKHDF", track_order=True), "MultiBlockDataSet")
            named = root.create_group("Assembly", track_order=True)
            blocks = [_typed(root.create_group(f"block{k}"), "UnstructuredGrid") for k in _numbers(motion)]
            for k, (block, surface) in enumerate(zip(blocks, motion.surfaces, strict=True)):
                named[_link(k, surface.name)] = h5py.SoftLink(block.name)
                _write_still(block, surface, motion.times)
            for step in range(len(motion.times)):
                _write_moment(blocks, motion, step)
                if progress is not None:
                    progress(step + 1, len(motion.times))
    return target


def _numbers(motion: Trajectory) -> range:
    return range(len(motion.surfaces))


def _typed(group: Any, kind: str) -> Any:
    group.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    group.attrs["Type"] = np.bytes_(kind)
    return group


def _link(k: int, name: str) -> str:
    """Name of a link; HDF5 takes slashes and dots alone for paths."""
    return name.replace("/", "\N{DIVISION SLASH}") if name.strip(".") else f"component {k}"


def _write_still(block: Any, surface: Surface, times: Any) -> None:
    """Write the parts that do not change: cells, and where the values of every step begin."""
    n, n_steps = len(surface.points), len(times)
    sizes = np.concatenate([np.full(len(cells), cells.shape[1]) for cells in surface.cells])
    kinds = [np.full(len(c), kind) for c, kind in zip(surface.cells, surface.types, strict=True)]
    block["Connectivity"] = np.concatenate([cells.ravel() for cells in surface.cells]).astype(np.int64)
    block["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    block["Types"] = np.concatenate(kinds).astype(np.uint8)
    for name, count in (
        ("NumberOfPoints", n), ("NumberOfCells", len(sizes)), ("NumberOfConnectivityIds", sizes.sum())
    ):  # fmt: skip
        block[name] = np.full(n_steps, count, dtype=np.int64)
    steps, zeros = block.create_group("Steps"), np.zeros(n_steps, dtype=np.int64)
    steps.attrs["NSteps"] = np.int64(n_steps)
    steps["Values"], steps["NumberOfParts"] = times, zeros + 1
    for name in ("PartOffsets", "CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = zeros if name == "PartOffsets" else zeros[:, None]
    steps["PointOffsets"] = n * np.arange(n_steps)
    block.create_dataset("Points", (n_steps * n, 3), dtype=np.float64)


def _write_moment(blocks: list[Any], motion: Trajectory, step: int) -> None:
    """Points and fields of a step; a field begins where its component first has values."""
    for block, points in zip(blocks, motion.points(step), strict=True):
        _put(block["Points"], step, points)
    for name in motion.fields:
        for block, values in zip(blocks, motion.field(name, step), strict=True):
            if f"PointData/{name}" not in block and np.isfinite(values).any():
                _begin(block, name, values, motion)
            if f"PointData/{name}" in block:
                _put(block[f"PointData/{name}"], step, values)


def _begin(block: Any, name: str, values: Any, motion: Trajectory) -> None:
    n_steps, n = len(motion.times), len(values)
    shape = (n_steps * n, *values.shape[1:])
    data = block.create_dataset(f"PointData/{name}", shape, dtype=np.float64, fillvalue=np.nan)
    data.attrs["long_name"], data.attrs["units"] = (
        motion.labels.fields.get(name, name), motion.labels.field_units.get(name, "")
    )  # fmt: skip
    block[f"Steps/PointDataOffsets/{name}"] = n * np.arange(n_steps)


def _put(data: Any, step: int, values: Any) -> None:
    data[step * len(values) : (step + 1) * len(values)] = values
