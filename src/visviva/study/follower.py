"""The other processes' part in writing the files of a run, which the first process does."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.march import begin
from visviva.base.world import world
from visviva.output.directory import RunDirectory
from visviva.output.states import StateFile
from visviva.output.tables import Table
from visviva.study import restart
from visviva.study.forecast import Forecast
from visviva.study.origin import Origin
from visviva.study.recorder import Cadence, Recorder
from visviva.study.study import Study, measure, probe_columns

Array = NDArray[np.float64]


class Follower(Recorder):
    """Takes part in all that is evaluated for the files of a run, which the first process writes."""

    def open(self, overwrite: bool) -> None:
        """Evaluate what the first process writes at the start."""
        probe_columns(self.study)
        self.write_row(np.zeros(0))
        self.write_frame()
        self.save()

    @classmethod
    def resume(cls, study: Study, files: RunDirectory, force: bool, notes: dict[str, Any]) -> Recorder:
        """Go to the last state that the first process has saved."""
        kept = restart.notes_of(files.state)
        changed = Origin.read(files).resumed(files, study, force)[1]
        result, books = begin(study.system, study.scheme, project=True, step=study.step)
        restart.load(files.state, result, books, bool(changed))
        probe_columns(study)
        follower = cls(study, files, result, books, Origin({}, []))
        follower.cadence, follower.saved_time = Cadence(**kept["cadence"]), study.system.time
        return follower

    def keep(self) -> None:
        """States are in the files."""

    def write_row(self, row: Array) -> None:
        """Evaluate the probes."""
        self.books.ledger.rows.clear()  # which are in the files, too
        for probe in self.study.probes.values():
            measure(self.study.system, probe)

    def write_frame(self) -> None:
        """Evaluate the shapes."""
        if self.drawing.surfaces:
            system = self.study.system
            self.drawing.points(system.x)
            self.drawing.values(system.x, system.v)

    def save(self) -> None:
        """Evaluate what belongs to the state."""
        with suppress(Exception):  # as where it is written
            self.study.system.forces_of_step()
        self.saved_time = self.study.system.time

    def __enter__(self) -> Follower:
        return self

    def forecast(self) -> Forecast:
        """Evaluate what the first process times; nothing is written here."""
        self.drawing.values(self.study.system.x, self.study.system.v)
        return Forecast(frames=0, states=0, rows=0, frame=0, state=0, row=0, seconds=0.0, free=1)

    def finish(self) -> None:
        """The first process writes the summary; what it has kept is read from its files from now on."""
        of_states, of_ledger = world().first(None)
        files, result, ledger = self.files, self.result, self.books.ledger
        shapes = [r.shape for r in result.records[0]]
        result.kept = StateFile.written(files.states, len(self.study.system.x), shapes, of_states)
        result.directory = files
        ledger.rows.clear()
        ledger.file = Table.written(files.ledger, ledger.names, of_ledger)
