"""Reading a trajectory file back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from visviva.errors import InputError
from visviva.output.layout import FORMAT
from visviva.output.surface import Surface


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

    Raises
    ------
    InputError
        If the file is missing or was not written by visviva.
    """

    def __init__(self, path: str | Path) -> None:
        import h5py

        self.path = Path(path)
        try:
            self._file = h5py.File(path, "r")
        except OSError as error:
            raise InputError(f"{path}: cannot be read as a trajectory ({error})") from error
        own = self._file.get("visviva")
        if own is None or own.attrs.get("format") != FORMAT:
            self._file.close()
            raise InputError(f"{path}: is no trajectory of this version of visviva")
        self._root = self._file["VTKHDF"]
        self.times: NDArray[np.float64] = self._root["Steps/Values"][()]
        self._ends: NDArray[np.int64] = np.cumsum(own["point_counts"][()])
        self.surfaces = _surfaces(own, self._root, self._ends)

    def points(self, step: int) -> list[NDArray[np.float64]]:
        """Points of every surface at a step, (n, 3) each, in m."""
        n_points = int(self._ends[-1])
        together = self._root["Points"][step * n_points : (step + 1) * n_points]
        return np.split(together, self._ends[:-1])

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
        n_points = int(self._ends[-1])
        together = self._root["PointData"][name][step * n_points : (step + 1) * n_points]
        return np.split(together, self._ends[:-1])

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
        group = self._root.get(f"{kind}Data", {})
        return {name: (data.shape[1:] or (1,))[0] for name, data in group.items() if name != "component"}

    def values(self, start: int, stop: int) -> dict[str, NDArray[np.float64]]:
        """All that is stored for the steps from `start` to `stop`, row after row."""
        streams = {"time": self._root["Steps/Values"], "points": self._root["Points"]}
        for kind in ("Point", "Cell"):
            streams |= {f"{kind}/{name}": self._root[f"{kind}Data"][name] for name in self.widths(kind)}
        n_rows = {name: self._rows_per_step(name) for name in streams}
        return {name: data[start * n_rows[name] : stop * n_rows[name]] for name, data in streams.items()}

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
        return len(self._root["Types"]) if stream.startswith("Cell/") else int(self._ends[-1])


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
