"""Reading a trajectory file back."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.labels import Labels
from visviva.output.layout import FORMAT, WITHOUT_CHECKSUMS, checksum_of_mesh, checksums
from visviva.output.surface import Surface

UNREADABLE = (OSError, KeyError, ValueError, TypeError, RuntimeError, IndexError, AttributeError)
"""Errors that h5py raises on damaged files."""


class Trajectory:
    """The moving shapes of a run, read from the file which `TrajectoryWriter` wrote.

    The file may still be growing: what is seen are the steps complete at the time of opening.

    Parameters
    ----------
    path
        A ``trajectory.vtkhdf``.

    Attributes
    ----------
    times : (n_steps,) array
        In s.
    surfaces : tuple of Surface
        Reference points and cells of every component.
    labels : Labels
        Names and units of what it holds.

    Raises
    ------
    InputError
        If the file is missing, damaged (also later, when damaged steps are read) or was not written by visviva.
    """

    def __init__(self, path: str | Path) -> None:
        import h5py

        self.path = Path(path)
        try:
            self._file = h5py.File(path, "r", locking=False)  # who reads must not hinder who writes
        except OSError as error:
            raise InputError(f"{path}: cannot be read as a trajectory ({error})") from error
        try:
            self._look()
        except UNREADABLE as error:
            self._file.close()
            raise InputError(f"{path}: is damaged ({error})") from error
        except InputError:
            self._file.close()
            raise

    def _look(self) -> None:
        """Read all but the values of the steps."""
        own = self._file.get("visviva")
        found = None if own is None else own.attrs.get("format")
        if found not in (FORMAT, WITHOUT_CHECKSUMS):
            raise InputError(f"{self.path}: is no trajectory of this version of visviva")
        root = self._file["VTKHDF"]
        self.times: NDArray[np.float64] = root["Steps/Values"][()]
        self._ends: NDArray[np.int64] = np.cumsum(own["point_counts"][()])
        self._n_cells = len(root["Types"])
        self._streams = {"time": root["Steps/Values"], "points": root["Points"]}
        for kind in ("Point", "Cell"):
            data = root.get(f"{kind}Data", {})
            self._streams |= {f"{kind}/{name}": data[name] for name in data if name != "component"}
        self._checksums = own["checksums"] if found == FORMAT else None
        if self._checksums is not None and checksum_of_mesh(root, own) != own.attrs["static"]:
            raise InputError(f"{self.path}: is damaged (its mesh is not what was written)")
        self.surfaces = _surfaces(own, root, self._ends)
        self.labels = Labels.of(json.loads(own.attrs.get("labels", "{}")))

    def moment(self, time: float) -> str:
        """Text of a time in a picture."""
        return self.labels.moment(time, float(self.times[-1] - self.times[0]))

    def _read(self, stream: str, start: int, stop: int) -> NDArray[np.float64]:
        """Stored records of a stream for the steps from `start` to `stop`, if they are what was written."""
        n = self._rows_per_step(stream)
        try:
            values: NDArray[np.float64] = self._streams[stream][start * n : stop * n]
            if self._checksums is None:
                return values
            stored = self._checksums[start:stop, sorted(self._streams).index(stream)]
        except UNREADABLE as error:
            raise InputError(
                f"{self.path}: is damaged from t = {self.times[start]:g} on ({error})"
            ) from error
        for bad in np.flatnonzero(checksums({stream: values}, stop - start)[:, 0] != stored):
            time = self.times[start + int(bad)]
            raise InputError(f"{self.path}: is damaged: {stream} at t = {time:g} are not what was written")
        return values

    def points(self, step: int) -> list[NDArray[np.float64]]:
        """Points of every surface at a step, (n, 3) each, in m."""
        return np.split(self._read("points", step, step + 1), self._ends[:-1])

    def points_at(self, time: float) -> list[NDArray[np.float64]]:
        """Points of every surface at any time, linear between the steps and held beyond the ends."""
        return self._between(time, self.points)

    @property
    def fields(self) -> dict[str, int]:
        """Stored quantities per point: their numbers of components by name."""
        return self.widths("Point")

    def field(self, name: str, step: int) -> list[NDArray[np.float64]]:
        """Values (n,) or (n, components) of a quantity on every surface at a step; NaN where it has none.

        Raises
        ------
        InputError
            If there is no such quantity.
        """
        if name not in self.fields:
            known = f"there are {', '.join(self.fields)}" if self.fields else "none is stored"
            raise InputError(f"{self.path}: no field is called {name!r}; {known}")
        return np.split(self._read(f"Point/{name}", step, step + 1), self._ends[:-1])

    def field_at(self, name: str, time: float) -> list[NDArray[np.float64]]:
        """Values of a quantity at any time, linear between the steps and held beyond the ends."""
        return self._between(time, lambda step: self.field(name, step))

    def chosen_steps(self, n_steps: int = 100) -> list[int]:
        """At most `n_steps` steps spread over the motion."""
        spread = np.linspace(0, len(self.times) - 1, n_steps).round().astype(int)
        return [int(step) for step in np.unique(spread)]

    def _between(
        self, time: float, values: Callable[[int], list[NDArray[np.float64]]]
    ) -> list[NDArray[np.float64]]:
        place = float(np.interp(time, self.times, np.arange(len(self.times))))
        before = int(place)
        weight = place - before
        if weight == 0.0:
            return values(before)
        ends = zip(values(before), values(before + 1), strict=True)
        return [(1 - weight) * early + weight * late for early, late in ends]

    def cloud(self, n_steps: int = 100) -> NDArray[np.float64]:
        """Points of at most `n_steps` steps spread over the motion, (n, 3), to fit a camera to."""
        return np.concatenate([points for step in self.chosen_steps(n_steps) for points in self.points(step)])

    def centres(self, names: Sequence[str]) -> dict[int, NDArray[np.float64]]:
        """Paths (n_steps, 3) of the mean points of the named surfaces, by the number of the surface.

        Raises
        ------
        InputError
            If there is no such surface.
        """
        known = [surface.name for surface in self.surfaces]
        for name in names:
            if name not in known:
                raise InputError(f"{self.path}: no surface is called {name!r}; there are {', '.join(known)}")
        steps = [self.points(step) for step in range(len(self.times))] if names else []
        return {k: np.array([points[k].mean(axis=0) for points in steps]) for k in map(known.index, names)}

    def widths(self, kind: str) -> dict[str, int]:
        """Numbers of components of the stored quantities per ``Point`` or per ``Cell``."""
        data = {n.removeprefix(f"{kind}/"): d for n, d in self._streams.items() if n.startswith(f"{kind}/")}
        return {name: (d.shape[1:] or (1,))[0] for name, d in data.items()}

    def values(self, start: int, stop: int) -> dict[str, NDArray[np.float64]]:
        """All that is stored for the steps from `start` to `stop`, row after row."""
        return {name: self._read(name, start, stop) for name in self._streams}

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _rows_per_step(self, stream: str) -> int:
        if stream == "time":
            return 1
        return self._n_cells if stream.startswith("Cell/") else int(self._ends[-1])


def _surfaces(own: Any, root: Any, ends: NDArray[np.int64]) -> tuple[Surface, ...]:
    names = own["names"].asstr()[()]
    reference = np.split(own["reference_points"][()], ends[:-1])
    starts = ends - own["point_counts"][()]
    cells: list[list[NDArray[np.int64]]] = [[] for _ in names]
    types: list[list[int]] = [[] for _ in names]
    for component, kind, block in _runs(root):
        cells[component].append(block - starts[component])
        types[component].append(kind)
    return tuple(Surface(*parts) for parts in zip(names, reference, cells, types, strict=True))


def _runs(root: Any) -> Iterator[tuple[int, int, NDArray[np.int64]]]:
    """Runs of cells of one component and type: its number, VTK's number of the type, points (m, k)."""
    connectivity, offsets = root["Connectivity"][()], root["Offsets"][()]
    keys = np.column_stack([root["CellData/component"][()], root["Types"][()], np.diff(offsets)])
    if not len(keys):
        return
    first = np.flatnonzero(np.any(np.diff(keys, axis=0), axis=1)) + 1
    for start, stop in pairwise([0, *first, len(keys)]):
        component, kind, size = keys[start].tolist()
        yield component, kind, connectivity[offsets[start] : offsets[stop]].reshape(-1, size)
