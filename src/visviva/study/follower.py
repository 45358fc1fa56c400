"""The other processes' part in writing the files of a run, which the first process does."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from visviva.base.world import by_first, world
from visviva.output.states import StateFile
from visviva.output.tables import Table
from visviva.study.forecast import Forecast
from visviva.study.recorder import Recorder
from visviva.study.study import measured

Array = NDArray[np.float64]


class Follower(Recorder):
    """Takes part in all that is evaluated for the files of a run, which the first process writes."""

    def keep(self) -> None:
        """States are in the files."""

    def write_row(self, row: Array) -> None:
        """Evaluate the probes."""
        self.books.ledger.rows.clear()  # which are in the files, too
        measured(self.study)

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
        self.outbox.check()
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
        by_first("write the summary", lambda: None)
        files, result, ledger = self.files, self.result, self.books.ledger
        shapes = [r.shape for r in result.records[0]]
        result.kept = StateFile.written(files.states, len(self.study.system.x), shapes, of_states)
        result.directory = files
        ledger.rows.clear()
        ledger.file = Table.written(files.ledger, ledger.names, of_ledger)
