"""The trajectory file: the shapes of all components over time, as one VTKHDF file for ParaView."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visviva.base.errors import InputError
from visviva.output import layout as _layout
from visviva.output.labels import Labels
from visviva.output.safe_files import holds, replacing, reporting, settle
from visviva.output.surface import Surface
from visviva.output.trajectory import Trajectory

ROOM_AT_FIRST = 1 << 20  # bytes of values for which a file has room unless told how many steps will come


class TrajectoryWriter:
    """Writes the moving shapes step by step; the file is complete and readable after every step.

    The mesh is stored once, the points of every step in double precision. A process that is killed at
    any moment leaves a file with all steps appended so far, which ParaView opens as it is, also while
    the run goes on: no locks are taken, and whoever reads sees the steps complete so far. Steps beyond
    the room reserved at first move the file into one with twice the room.

    Parameters
    ----------
    path
        File to write, by custom ``*.vtkhdf``; it appears with the first step.
    surfaces
        One per component, in the order in which the points will come.
    n_steps
        Number of steps expected; saves copying while the file grows.
    labels
        Names and units of what will come.

    Raises
    ------
    InputError
        If there is nothing to draw, or two surfaces share a name.

    Examples
    --------
    >>> import tempfile, numpy
    >>> path = tempfile.mkdtemp() + "/trajectory.vtkhdf"
    >>> rope = Surface("rope", [[0, 0, 0], [0, 0, -1]], [[0, 1]])
    >>> with TrajectoryWriter(path, [rope]) as writer:
    ...     for time in (0.0, 0.1, 0.2):
    ...         writer.append(time, [rope.points * (1 + time)])
    >>> Trajectory(path).times.tolist()
    [0.0, 0.1, 0.2]
    """

    def __init__(
        self, path: str | Path, surfaces: Sequence[Surface], n_steps: int = 0, labels: Labels | None = None
    ) -> None:
        self.path, self.surfaces, self.n_steps = Path(path), tuple(surfaces), 0
        names = [surface.name for surface in self.surfaces]
        if not names or len(set(names)) < len(names):
            raise InputError(f"{path}: a trajectory needs surfaces with different names, got {names}")
        self._expected, self._labels = n_steps, labels
        self._widths: tuple[dict[str, int], dict[str, int]] = ({}, {})
        self._layout: _layout.Layout | None = None
        self._descriptor = -1
        self._last_time: float | None = None

    @classmethod
    def reopen(cls, path: str | Path, keep_until: float, n_steps: int = 0) -> Self:
        """Continue an existing file after dropping the steps with a time above `keep_until`.

        Parameters
        ----------
        path
            File written before, by a run that ended in any way.
        keep_until
            Time of the state from which the run resumes, in s.
        n_steps
            Number of steps expected in all.

        Raises
        ------
        InputError
            If the file is missing or is no trajectory of visviva.
        """
        with Trajectory(path) as earlier:
            writer = cls(path, earlier.surfaces, n_steps, earlier.labels)
            writer._widths = earlier.widths("Point"), earlier.widths("Cell")
            n_kept = int(np.searchsorted(earlier.times, keep_until, side="right"))
            if n_kept:
                writer._last_time = float(earlier.times[n_kept - 1])
                with reporting(writer.path, writer._last_time):
                    writer._rebuild(writer._capacity(n_kept), _blocks(earlier, n_kept))
        return writer

    def append(
        self,
        time: float,
        points: Sequence[ArrayLike],
        point_data: Mapping[str, ArrayLike] | None = None,
        cell_data: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        """Write one step.

        Parameters
        ----------
        time
            In s, above that of the step before.
        points
            Current points of every surface, (n, 3) each, in m.
        point_data, cell_data
            Further quantities over all points and over all cells, (n_total,) or (n_total, k); the first
            step says which there are.

        Raises
        ------
        InputError
            If a shape or name differs from that of the first step, or time does not increase.
        RunError
            If the file cannot be written; the steps before stay readable.
        """
        values = self._values(time, points, point_data or {}, cell_data or {})
        with reporting(self.path, self._last_time):
            if self._layout is None:
                self._widths = self._sizes(point_data or {}, cell_data or {})
                self._rebuild(self._capacity(0), [values])
            else:
                self._add(self._layout, values)
        self._last_time = float(time)

    @property
    def n_bytes(self) -> int:
        """Bytes of a step; 0 before the first one."""
        return 0 if self._layout is None else sum(s.n_bytes for s in self._layout.streams.values())

    def sync(self) -> None:
        """Make sure that what is written outlives a loss of power."""
        if self._descriptor >= 0:
            with reporting(self.path, self._last_time):
                settle(self.path, self._descriptor)

    def close(self) -> None:
        """Close the file, giving back the room that was not needed; closing twice is harmless."""
        if self._layout is None or self._descriptor < 0:
            return
        if self._layout.capacity > self.n_steps and holds(self.path, self._descriptor):
            with suppress(OSError, InputError), Trajectory(self.path) as written:  # without it, as good
                self._rebuild(self.n_steps, _blocks(written, self.n_steps))
        os.close(self._descriptor)
        self._descriptor = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _values(
        self,
        time: float,
        points: Sequence[ArrayLike],
        point_data: Mapping[str, ArrayLike],
        cell_data: Mapping[str, ArrayLike],
    ) -> dict[str, NDArray[Any]]:
        """Check and gather the values of a step under the names of their streams."""
        if self._last_time is not None and not time > self._last_time:
            raise InputError(f"{self.path}: time {time} does not follow {self._last_time}")
        current = [np.asarray(array, dtype=np.float64) for array in points]
        if [array.shape for array in current] != [surface.points.shape for surface in self.surfaces]:
            raise InputError(f"{self.path}: the points of a step must have the shapes of the surfaces")
        values: dict[str, NDArray[Any]] = {
            "time": np.array([time], np.float64),
            "points": np.concatenate(current),
        }
        values |= {
            f"Point/{name}": np.array(data, np.float64, order="C") for name, data in point_data.items()
        }
        values |= {f"Cell/{name}": np.array(data, np.float64, order="C") for name, data in cell_data.items()}
        values["checksums"] = _layout.checksums(values, 1)
        if self._layout is not None:
            expected = {name: stream.shape for name, stream in self._layout.streams.items()}
            found = {name: array.shape for name, array in values.items()}
            if found != expected:
                raise InputError(f"{self.path}: a step holds {found}, the first step held {expected}")
        return values

    def _sizes(
        self, point_data: Mapping[str, ArrayLike], cell_data: Mapping[str, ArrayLike]
    ) -> tuple[dict[str, int], dict[str, int]]:
        """Numbers of components of the further quantities, after a look at their shapes."""
        n_points = sum(len(surface.points) for surface in self.surfaces)
        n_cells = sum(len(block) for surface in self.surfaces for block in surface.cells)
        return _widths(self.path, point_data, n_points), _widths(self.path, cell_data, n_cells)

    def _capacity(self, n_steps: int) -> int:
        """Number of steps to reserve room for when there are `n_steps`."""
        if self._expected > n_steps:
            return self._expected
        n_points = sum(len(surface.points) for surface in self.surfaces)
        return max(2 * n_steps, 16, ROOM_AT_FIRST // (24 * n_points))

    def _add(self, layout: _layout.Layout, values: Mapping[str, NDArray[Any]]) -> None:
        if self.n_steps == layout.capacity:
            with Trajectory(self.path) as earlier:
                self._rebuild(self._capacity(self.n_steps), chain(_blocks(earlier, self.n_steps), [values]))
            return
        layout.write(self._descriptor, self.n_steps, values)
        layout.commit(self._descriptor, self.n_steps + 1)
        self.n_steps += 1

    def _rebuild(self, capacity: int, blocks: Iterable[Mapping[str, NDArray[Any]]]) -> None:
        """Put a file with room for `capacity` steps and the given ones in it in the place of the old one."""
        descriptor, n_steps = -1, 0
        try:
            with replacing(self.path) as temporary:
                layout = _layout.create(temporary, self.surfaces, *self._widths, capacity, self._labels)
                descriptor = os.open(temporary, os.O_RDWR)
                for values in blocks:
                    layout.write(descriptor, n_steps, values)
                    n_steps += len(values["time"])
                layout.commit(descriptor, n_steps)
        except BaseException:
            if descriptor >= 0:
                os.close(descriptor)
            raise
        if self._descriptor >= 0:
            os.close(self._descriptor)
        self._layout, self._descriptor, self.n_steps = layout, descriptor, n_steps


def _blocks(earlier: Trajectory, n_steps: int, at_once: int = 64) -> Iterator[dict[str, NDArray[Any]]]:
    """Read the first `n_steps` steps in blocks of a bounded size."""
    for start in range(0, n_steps, at_once):
        stop = min(start + at_once, n_steps)
        values = earlier.values(start, stop)
        yield values | {"checksums": _layout.checksums(values, stop - start)}


def _widths(path: Path, data: Mapping[str, ArrayLike], n_rows: int) -> dict[str, int]:
    widths = {}
    for name, array in data.items():
        shape = np.shape(array)
        if len(shape) not in (1, 2) or shape[0] != n_rows or name == "component" or set("./") & set(name):
            raise InputError(
                f"{path}: quantity {name!r} of shape {shape} cannot be stored, needs {n_rows} rows"
            )
        widths[name] = 1 if len(shape) == 1 else shape[1]
    return widths
