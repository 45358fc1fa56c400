"""The HDF5 skeleton of a trajectory: everything of a VTKHDF file but the values of the steps."""

from __future__ import annotations

import io
import json
import math
import os
import struct
import sys
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import RunError
from visviva.output.labels import Labels
from visviva.output.safe_files import write_at
from visviva.output.surface import Surface

if TYPE_CHECKING:
    from typing_extensions import Buffer

FORMAT = "visviva trajectory 2"
WITHOUT_CHECKSUMS = "visviva trajectory 1"  # of version 0.1, still read
PAGE = 4096
UNSET = 0x7E57_C0DE_5EED_1234  # stands where the number of steps will be, so that its place can be found


@dataclass(frozen=True)
class Stream:
    """A quantity stored once per step: where in the file, and the shape of one step's values."""

    offset: int
    shape: tuple[int, ...]

    @property
    def n_bytes(self) -> int:
        """Bytes of one step."""
        return 8 * math.prod(self.shape)


@dataclass(frozen=True)
class Layout:
    """Index in the file for a step.

    HDF5 itself cannot append so that a process may die at any moment: it changes several blocks of
    its bookkeeping in an order of its own. Here all bookkeeping for `capacity` steps is written
    beforehand, the values of a step go into room reserved for them, and one write within one page
    (`commit`) then makes the step count.
    """

    capacity: int
    streams: Mapping[str, Stream]
    page_offset: int
    page: bytearray
    count_places: tuple[tuple[int, int], ...]

    def write(self, descriptor: int, step: int, values: Mapping[str, NDArray[np.float64]]) -> None:
        """Write the values of one or more steps, beginning with `step`, into their reserved room."""
        for name, stream in self.streams.items():
            write_at(descriptor, values[name].data, stream.offset + step * stream.n_bytes)

    def commit(self, descriptor: int, n_steps: int) -> None:
        """Make the file hold `n_steps` steps, by one write that a signal cannot tear."""
        for place, factor in self.count_places:
            struct.pack_into("<q", self.page, place, factor * n_steps)
        os.pwrite(descriptor, self.page, self.page_offset)


def create(
    path: Path,
    surfaces: Sequence[Surface],
    point_data: Mapping[str, int],
    cell_data: Mapping[str, int],
    capacity: int,
    labels: Labels | None = None,
) -> Layout:
    """Write a file with room for `capacity` steps and none in it yet.

    Parameters
    ----------
    path
        File to write.
    surfaces
        The static mesh.
    point_data, cell_data
        Numbers of components of further quantities per point and per cell.
    capacity
        Number of steps to reserve room for; the room is a hole in the file until it is written.
    labels
        Names and units of what is in it, for attributes.
    """
    # composed in memory, since HDF5 does not survive a full disk: h5py raises, and crashes later
    image = _Image()
    streams, headers = _compose(image, surfaces, point_data, cell_data, capacity, labels or Labels())
    with open(path, "wb") as file:
        file.write(image.getvalue())
        file.truncate(image.end)
    return _locate(path, capacity, streams, headers)


class _Image(io.BytesIO):
    """A file in memory that keeps its head only and notes how long it should become."""

    end = 0
    head = sys.maxsize

    def truncate(self, size: int | None = None, /) -> int:
        self.end = self.end if size is None else size
        return self.end

    def write(self, data: Buffer, /) -> int:
        return len(memoryview(data)) if self.tell() >= self.head else super().write(data)


def _compose(
    image: _Image,
    surfaces: Sequence[Surface],
    point_data: Mapping[str, int],
    cell_data: Mapping[str, int],
    capacity: int,
    labels: Labels,
) -> tuple[dict[str, Stream], list[int]]:
    """Compose all but the values of the steps. Returns the streams and the addresses of two headers."""
    import h5py

    # the oldest file format: no checksums over its bookkeeping, readable by every HDF5
    with h5py.File(image, "w", libver=("earliest", "v110")) as file:
        root, steps = file.create_group("VTKHDF"), file.create_group("VTKHDF/Steps")
        steps.attrs["NSteps"] = np.int64(UNSET)
        values = _reserve(steps, "Values", (capacity,), np.float64)
        counts = _reserve(root, "NumberOfPoints", (capacity,), np.int64)
        root.attrs["Version"] = np.array([2, 2], dtype=np.int64)
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        n_points, n_cells = _write_mesh(file, root, surfaces, capacity)
        _write_offsets(steps, n_points, capacity)
        streamed = {"time": values, "points": _reserve(root, "Points", (capacity * n_points, 3), np.float64)}
        for kind, sizes, count in (("Point", point_data, n_points), ("Cell", cell_data, n_cells)):
            for name, width in sizes.items():
                streamed[f"{kind}/{name}"] = _stream(root, kind, name, (capacity * count, width), capacity)
        own = file["visviva"]
        own.attrs["static"] = checksum_of_mesh(root, own)
        streamed["checksums"] = _reserve(own, "checksums", (capacity, len(streamed)), np.int64)
        counts[:] = n_points
        _write_labels(root, own, labels)
        file.flush()
        image.head = len(image.getbuffer())  # all that follows is allocated and left as a hole
        streams = {name: _place(dataset, capacity) for name, dataset in streamed.items()}
        return streams, [h5py.h5o.get_info(dataset.id).addr for dataset in (values, counts)]


def _write_labels(root: Any, own: Any, labels: Labels) -> None:
    """Names and units: those of each field beside it, all of them for ourselves."""
    data = root.get("PointData", {})
    for name in (name for name in data if name in labels.fields):
        data[name].attrs["long_name"] = labels.fields[name]
        data[name].attrs["units"] = labels.field_units.get(name, "")
    shown = {name: labels.fields[name] for name in data if name in labels.fields}
    units = {name: labels.field_units[name] for name in shown if name in labels.field_units}
    parts = {name: labels.parts[name] for name in data if name in labels.parts}
    noted = replace(labels, columns={}, fields=shown, field_units=units, parts=parts).noted()
    own.attrs["labels"] = json.dumps(noted)
    root["Points"].attrs["units"] = labels.unit("length")
    root["Steps/Values"].attrs["units"] = labels.unit("time")


def checksums(values: Mapping[str, NDArray[Any]], n_steps: int) -> NDArray[np.int64]:
    """Checksums (n_steps, n_streams) of the values of some steps, in the alphabet's order of their names."""
    rows = [np.ascontiguousarray(values[name]).reshape(n_steps, -1) for name in sorted(values)]
    return np.array([[zlib.crc32(row[k].data) for row in rows] for k in range(n_steps)], dtype=np.int64)


def checksum_of_mesh(root: Any, own: Any) -> int:
    """Checksum of all that a file holds once."""
    parts = [root[name][()] for name in ("Connectivity", "Offsets", "Types", "CellData/component")]
    parts += [own[name][()] for name in ("point_counts", "reference_points")]
    names = "\n".join(own["names"].asstr()[()])
    return zlib.crc32(b"".join(part.tobytes() for part in parts) + names.encode())


def _reserve(group: Any, name: str, shape: tuple[int, ...], dtype: type) -> Any:
    """Create the header of a dataset; its room is allocated later, and never filled."""
    import h5py

    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    return group.create_dataset(name, shape, dtype=dtype, dcpl=properties)


def _place(dataset: Any, capacity: int) -> Stream:
    dataset[(0,) * dataset.ndim] = 0  # allocates the room
    return Stream(dataset.id.get_offset(), (dataset.shape[0] // capacity, *dataset.shape[1:]))


def _write_mesh(file: Any, root: Any, surfaces: Sequence[Surface], capacity: int) -> tuple[int, int]:
    """Write the cells once; every step refers to them. Returns the numbers of points and cells."""
    starts = np.cumsum([0, *(len(surface.points) for surface in surfaces)])
    blocks = [(k, block + starts[k]) for k, surface in enumerate(surfaces) for block in surface.cells]
    sizes = np.concatenate([np.full(len(block), block.shape[1]) for _, block in blocks] or [np.zeros(0)])
    component = np.concatenate([np.full(len(block), k) for k, block in blocks] or [np.zeros(0)])
    kinds = [(kind, len(block)) for s in surfaces for kind, block in zip(s.types, s.cells, strict=True)]
    types = np.repeat(*np.array(kinds, dtype=np.int64).reshape(-1, 2).T).astype(np.uint8)
    connectivity = np.concatenate([block.ravel() for _, block in blocks] or [np.zeros(0)])
    root["Connectivity"] = connectivity.astype(np.int64)
    root["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    root["Types"] = types
    root["NumberOfCells"] = np.full(capacity, len(sizes), dtype=np.int64)
    root["NumberOfConnectivityIds"] = np.full(capacity, len(connectivity), dtype=np.int64)
    root["CellData/component"] = component.astype(np.int64)
    _write_names(file, root, surfaces, capacity)
    return int(starts[-1]), len(sizes)


def _write_names(file: Any, root: Any, surfaces: Sequence[Surface], capacity: int) -> None:
    """Write the names, as ASCII for VTK and in full, with the reference points, for ourselves."""
    import h5py

    plain = [surface.name.encode("ascii", "backslashreplace") for surface in surfaces]
    root.create_dataset("FieldData/component_names", data=plain, dtype=h5py.string_dtype("ascii"))
    root["Steps/FieldDataOffsets/component_names"] = np.zeros(capacity, dtype=np.int64)
    root["Steps/FieldDataSizes/component_names"] = np.tile(
        np.array([1, len(plain)], dtype=np.int64), (capacity, 1)
    )
    own = file.create_group("visviva")
    own.attrs["format"] = FORMAT
    own.create_dataset("names", data=[surface.name for surface in surfaces], dtype=h5py.string_dtype("utf-8"))
    own["point_counts"] = np.array([len(surface.points) for surface in surfaces], dtype=np.int64)
    own["reference_points"] = np.concatenate([surface.points for surface in surfaces])


def _write_offsets(steps: Any, n_points: int, capacity: int) -> None:
    zeros = np.zeros(capacity, dtype=np.int64)
    for name in ("PartOffsets", "CellOffsets", "ConnectivityIdOffsets", "CellDataOffsets/component"):
        steps[name] = zeros
    steps["NumberOfParts"] = zeros + 1
    steps["PointOffsets"] = np.arange(capacity, dtype=np.int64) * n_points


def _stream(root: Any, kind: str, name: str, shape: tuple[int, int], capacity: int) -> Any:
    per_step = shape[0] // capacity
    root[f"Steps/{kind}DataOffsets/{name}"] = np.arange(capacity, dtype=np.int64) * per_step
    return _reserve(root.require_group(f"{kind}Data"), name, shape if shape[1] > 1 else shape[:1], np.float64)


def _locate(path: Path, capacity: int, streams: Mapping[str, Stream], datasets: Sequence[int]) -> Layout:
    """Find the bytes that say how many steps there are: one attribute, and extent and size of two datasets.

    All of them must lie in one page, which makes their common change atomic for whoever reads the
    file after the process was killed.
    """
    with open(path, "r+b") as file:
        head = file.read(4 * PAGE)
        places = [(head.find(struct.pack("<q", UNSET)), 1)]
        for header in datasets:
            extent = head.find(struct.pack("<qq", capacity, capacity), header)  # now, and at most
            size = head.find(struct.pack("<q", 8 * capacity), extent)
            places += [(extent, 1), (extent + 8, 1), (size, 8)]
        start, stop = min(places)[0], max(places)[0] + 8
        if start < 0 or start // PAGE != (stop - 1) // PAGE:
            raise RunError(f"{path}: the installed HDF5 arranges files in an unknown way; please report this")
        relative = tuple((place - start, factor) for place, factor in places)
        layout = Layout(capacity, streams, start, bytearray(head[start:stop]), relative)
        layout.commit(file.fileno(), 1)
    _verify(path, 1)
    return layout


def _verify(path: Path, n_steps: int) -> None:
    """Read the file back through HDF5, to be sure that the right bytes were found."""
    import h5py

    with h5py.File(path, "r", locking=False) as file:
        steps, counts = file["VTKHDF/Steps"], file["VTKHDF/NumberOfPoints"]
        found = [steps.attrs["NSteps"], len(steps["Values"]), len(counts)]
        sizes = [data.id.get_storage_size() for data in (steps["Values"], counts)]
    if found != 3 * [n_steps] or sizes != 2 * [8 * n_steps]:
        raise RunError(f"{path}: the installed HDF5 arranges files in an unknown way; please report this")
