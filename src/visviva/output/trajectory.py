"""Reading a trajectory file back."""

from __future__ import annotations

from collections.abc import Sequence
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
        place = float(np.interp(time, self.times, np.arange(len(self.times))))
        before = int(place)
        weight = place - before
        if weight == 0.0:
            return self.points(before)
        ends = zip(self.points(before), self.points(before + 1), strict=True)
        return [(1 - weight) * early + weight * late for early, late in ends]

    def cloud(self, n_steps: int = 100) -> NDArray[np.float64]:
        """Points of at most `n_steps` steps spread over the motion, (n, 3), to fit a camera to."""
        chosen = np.unique(np.linspace(0, len(self.times) - 1, n_steps).round().astype(int))
        return np.concatenate([points for step in chosen for points in self.points(int(step))])

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
    cells = np.split(root["Connectivity"][()], root["Offsets"][1:-1])
    owner = root["CellData/component"][()]
    starts = ends - own["point_counts"][()]
    own_cells: list[list[NDArray[np.int64]]] = [[] for _ in names]
    for cell, component in zip(cells, owner, strict=False):  # an empty mesh still splits into one piece
        own_cells[component].append(cell - starts[component])
    parts = zip(names, reference, own_cells, strict=True)
    return tuple(Surface(name, points, _by_size(cells)) for name, points, cells in parts)


def _by_size(cells: Sequence[NDArray[np.int64]]) -> list[NDArray[np.int64]]:
    """Stack runs of equal cells into blocks, keeping their order."""
    blocks: list[list[NDArray[np.int64]]] = []
    for cell in cells:
        if not blocks or len(blocks[-1][0]) != len(cell):
            blocks.append([])
        blocks[-1].append(cell)
    return [np.stack(block) for block in blocks]
