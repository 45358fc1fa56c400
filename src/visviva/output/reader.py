"""A run read back from its directory: tables, names and units, the motion as meshes of PyVista."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.base.errors import InputError
from visviva.output.directory import RunDirectory
from visviva.output.labels import Labels
from visviva.output.numbers_out import dataframe
from visviva.output.tables import LOAD, read_table
from visviva.output.trajectory import Trajectory

Array = NDArray[np.float64]


def read(path: str | Path) -> StoredRun:
    """Open what a run, or `Result.write`, has left in a directory; the run may be going on.

    Raises
    ------
    InputError
        If there is no run.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
    >>> study = vv.Study(vv.System([ball]), until=0.2, step=0.1, probes={"place": vv.Position(of=ball)}, units="SI")
    >>> _ = vv.run(study, tempfile.mkdtemp() + "/ball", pictures=False)
    >>> stored = vv.read(_.directory.path)
    >>> stored.probes["place_x"].round(9).tolist(), stored.labels.column("place_x")
    ([0.0, 0.1, 0.2], 'place_x [m]')
    """
    return StoredRun(RunDirectory.open(path))


class StoredRun:
    """A run in a directory; what is read is what is there when it is asked for.

    Parameters
    ----------
    files : RunDirectory

    Attributes
    ----------
    files : RunDirectory
    """

    def __init__(self, files: RunDirectory) -> None:
        self.files = files
        self._time: float | None = None

    def __repr__(self) -> str:
        return f"StoredRun({self.files.path})"

    # --- numbers --------------------------------------------------------------------------------------------
    @property
    def ledger(self) -> dict[str, Array]:
        """Columns (n,) of the ledger by name."""
        return read_table(self.files.ledger)

    @property
    def probes(self) -> dict[str, Array]:
        """Columns (n,) of the probes by name."""
        return read_table(self.files.probes)

    @property
    def labels(self) -> Labels:
        """Names and units."""
        return self.files.read_labels()

    @property
    def summary(self) -> dict[str, Any]:
        """Figures of the whole run, once it is complete."""
        return self.files.read_summary()

    def to_dataframe(self, what: str = "probes") -> Any:
        """The probes, or the ``ledger``, as a table of pandas with the times as index."""
        if what not in ("probes", "ledger"):
            raise InputError(f"StoredRun.to_dataframe: there are 'probes' and the 'ledger', not {what!r}")
        columns = getattr(self, what)
        called = "time" if self.labels.clock == "time" else LOAD
        return dataframe({called if name == "time" else name: of for name, of in columns.items()})

    # --- the motion, by the names that readers of PyVista use -----------------------------------------------
    @cached_property
    def motion(self) -> Trajectory:
        """The trajectory."""
        return Trajectory(self.files.trajectory)

    @property
    def time_values(self) -> list[float]:
        """Times of the frames."""
        return [float(t) for t in self.motion.times]

    @property
    def active_time_value(self) -> float:
        """Time that `read` is about; the first until it is set."""
        return self.time_values[0] if self._time is None else self._time

    def set_active_time_value(self, time: float) -> None:
        """Choose a time between the first and the last frame; between frames everything is interpolated."""
        first, last = self.time_values[0], self.time_values[-1]
        if not first <= time <= last:
            raise InputError(f"{self.files.path}: has no time {time:g}; it goes from {first:g} to {last:g}")
        self._time = time

    def read(self) -> Any:
        """Meshes of PyVista by the names of components, with all fields, at the active time."""
        return blocks(self.motion, self.active_time_value)


def blocks(motion: Trajectory, time: float) -> Any:
    """A MultiBlock of PyVista with one unstructured grid per component.

    Raises
    ------
    InputError
        If PyVista is not installed.
    """
    try:
        import pyvista
    except ImportError as error:
        raise InputError("meshes of PyVista need: pip install 'visviva[view]'") from error
    found, points = pyvista.MultiBlock(), motion.points_at(time)
    fields = {name: motion.field_at(name, time) for name in motion.fields}
    for k, surface in enumerate(motion.surfaces):
        cells = [np.insert(block, 0, block.shape[1], axis=1).ravel() for block in surface.cells]
        types = [
            np.full(len(b), kind, np.uint8) for b, kind in zip(surface.cells, surface.types, strict=True)
        ]
        grid = pyvista.UnstructuredGrid(np.concatenate(cells), np.concatenate(types), points[k])
        for name, parts in fields.items():
            if not np.isnan(parts[k]).all():
                grid.point_data[name] = parts[k]
        found.append(grid, surface.name)
    return found
