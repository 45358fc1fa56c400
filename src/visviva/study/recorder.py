"""The files of a run and what goes into them while it marches."""

from __future__ import annotations

import math
import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visviva.analysis.march import advance, begin, present
from visviva.base.arguments import whole
from visviva.base.deadline import Deadline, TimeLimit
from visviva.base.errors import InputError, RunError, VisvivaError
from visviva.base.world import by_first, world
from visviva.output.beside import Beside, Outbox
from visviva.output.checkpoint import Record
from visviva.output.directory import RunDirectory
from visviva.output.labels import Labels
from visviva.output.states import StateFile
from visviva.output.tables import Table
from visviva.output.vtkhdf import TrajectoryWriter
from visviva.results.ledger import Bookkeeper
from visviva.results.naming import labels_of, ledger_units, up_of, with_clock
from visviva.results.result import Result
from visviva.study import restart
from visviva.study.forecast import DIGITS, Forecast
from visviva.study.origin import Origin
from visviva.study.profile import Profile
from visviva.study.progress import progress_bar
from visviva.study.shown import draw
from visviva.study.study import Study, measured, probe_columns
from visviva.study.summary import steps_of, summary

Array = NDArray[np.float64]

MOST_ROWS = 20_000
MOST_KEPT = 64e6  # bytes of states kept in their file
SPEED = 2e8
"""Bytes per second that disks write, roughly."""
WORTH = 1e6
"""Bytes of a frame with a state from which on they are written beside the computation; less is sooner written."""


@dataclass(frozen=True)
class Cadence:
    """Every how many steps something is written or kept."""

    frames: int
    rows: int
    states: int

    @staticmethod
    def of(study: Study, frames_per_second: float) -> Cadence:
        """Not more frames than asked for, at least a hundred of them, at most a thousand."""
        duration = study.until - study.system.time
        n_steps = max(duration / study.step, 1.0)
        apart = max(duration / 1000, min(1 / frames_per_second, duration / 100))
        kept = 16.0 * len(study.system.x) * n_steps
        return Cadence(
            frames=max(1, round(apart / study.step)),
            rows=math.ceil(n_steps / MOST_ROWS),
            states=math.ceil(kept / MOST_KEPT),
        )

    @property
    def steps(self) -> tuple[int, int, int]:
        """The numbers of steps of all three."""
        return self.frames, self.rows, self.states

    @staticmethod
    def all(every: int) -> Cadence:
        """A cadence that writes everything at this interval of steps."""
        every = whole("run", "every", every)
        return Cadence(every, every, every)


class Recorder:
    """The files of a run and what goes into them while it marches."""

    def __init__(
        self, study: Study, files: RunDirectory, result: Result, books: Bookkeeper, origin: Origin
    ) -> None:
        self.study, self.files, self.result, self.books, self.origin = study, files, result, books, origin
        self.drawing = draw(study)
        self.cadence = Cadence(1, 1, 1)
        self.notes: dict[str, Any] = {}
        self.ledger: Table | None = None
        self.probes: Table | None = None
        self.states: StateFile | None = None
        self.rows = 0  # written to both tables; times need not grow
        self.is_written = True  # whether all files hold all that is due up to the present state
        self.saved_time: float | None = None  # of the state from which the run can be resumed
        self._saved = 0.0
        self._cost = 0.0
        self.outbox = Outbox()
        self.trajectory: TrajectoryWriter | None = None
        self.profile: Profile | None = None  # if somebody wants to know

    # --- opening --------------------------------------------------------------------------------------------
    @classmethod
    def start(
        cls,
        study: Study,
        files: RunDirectory,
        cadence: Cadence,
        notes: dict[str, Any],
        project: bool = False,
        overwrite: bool = False,
    ) -> Recorder:
        """Begin a new run."""
        origin = Origin.of(study)
        result, books = begin(study.system, study.scheme, project=project, step=study.step)
        recorder = cls(study, files, result, books, origin)
        recorder.cadence, recorder.notes = cadence, notes
        recorder.open(overwrite)
        return recorder

    def open(self, overwrite: bool) -> None:
        """Open the files of a new run and write the initial state into them."""
        columns = probe_columns(self.study)
        by_first(f"begin a run in {self.files.path}", partial(self._make, columns, overwrite))
        with self.closed_on_failure():
            self.write_all(self.books.ledger.rows.pop(), (True, True, True))
            self.books.ledger.file = self.ledger
            self.save()
            by_first("write the first state", lambda: self.files.starting.unlink())

    def _make(self, columns: Mapping[str, str], overwrite: bool) -> None:
        """Make directory and files of a new run."""
        study, books = self.study, self.books
        self.files = self.result.directory = files = RunDirectory.create(self.files.path, overwrite)
        with self.closed_on_failure():
            files.begin()
            self.origin.write(files)
            labels = self.write_labels(columns)
            self.ledger = Table(
                files.ledger, ledger_units(books.ledger.names, study.system.units, study.scheme)
            )
            self.probes = Table(files.probes, with_clock(columns, study.scheme))
            if self.drawing.surfaces:
                n_frames = int((study.until - study.system.time) / study.step / self.cadence.frames) + 3
                self.trajectory = TrajectoryWriter(files.trajectory, self.drawing.surfaces, n_frames, labels)
            shapes = [r.shape for r in self.result.records[0]]
            self.result.kept = self.states = StateFile(files.states, len(study.system.x), shapes)

    @classmethod
    def resume(cls, study: Study, files: RunDirectory, force: bool, notes: dict[str, Any]) -> Recorder:
        """Open the files of an earlier run at its last saved state."""
        kept = restart.notes_of(files.state)
        origin, changed = by_first(
            f"compare with the run in {files.path}",
            lambda: Origin.read(files).resumed(
                files, study, force
            ),  # functions may ask who calls them, to print
        )
        # as in the run, which settles the solver
        result, books = begin(study.system, study.scheme, project=True, step=study.step)
        restart.load(files.state, result, books, bool(changed))
        now = study.system.time
        if study.scheme.has_growing_time and study.until < now - 1e-6 * study.step:
            raise InputError(
                f"end time until = {study.until} is before t = {now:g}, which the run in {files.path} has reached"
            )
        recorder = cls(study, files, result, books, origin)
        recorder.cadence, recorder.notes = Cadence(**kept["cadence"]), kept["study"]
        if changed:
            recorder.notes |= notes
            origin.forced.append({"time": now, "changes": changed})
        recorder.rows, recorder.saved_time = kept["rows"], now
        columns = probe_columns(study)
        by_first(f"go on with the run in {files.path}", partial(recorder._reopen, kept, columns, changed))
        return recorder

    def _reopen(self, kept: Mapping[str, Any], columns: Mapping[str, str], changed: Sequence[str]) -> None:
        """Open the files at the last saved state, of which this is `kept`."""
        study, files, books, result = self.study, self.files, self.books, self.result
        rows, sums = self.rows, kept["checksums"]
        with self.closed_on_failure():
            self.ledger = Table.reopen(files.ledger, books.ledger.names, rows, sums["ledger"])
            self.probes = Table.reopen(files.probes, list(columns), rows, sums["probes"])
            books.ledger.file, shapes = self.ledger, [r.shape for r in result.records[0]]
            self.states = StateFile.reopen(
                files.states, len(study.system.x), shapes, kept["states"], sums["states"]
            )
            result.kept, result.directory = self.states, files
            books.ledger.rows.clear()
            if self.drawing.surfaces:
                self.trajectory = TrajectoryWriter.reopen(files.trajectory, self.clock)
                if self.trajectory.n_steps != kept["frames"]:
                    raise InputError(
                        f"{files.trajectory}: is damaged ({self.trajectory.n_steps} frames up to t = "
                        f"{study.system.time:g}, {kept['frames']} were written); put back a copy, or start anew"
                    )
            if changed:  # last of all: what is refused leaves no trace
                self.origin.write(files)
            self.write_labels(columns)

    def write_labels(self, columns: Mapping[str, str]) -> Labels:
        """Note names and units of what the files hold."""
        study = self.study
        labels = labels_of(
            study.system.units, study.scheme, study.title, columns=columns, up=up_of(study.system)
        )
        self.files.write_labels(labels)
        return labels

    @contextmanager
    def closed_on_failure(self) -> Iterator[None]:
        """Close the files if what is done inside fails."""
        try:
            yield
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self) -> Recorder:
        assert self.states is not None
        if self.states.n_bytes + (self.trajectory.n_bytes if self.trajectory else 0) >= WORTH:
            self.outbox.by = Beside()
        return self

    def __exit__(self, *_: object) -> None:
        self.outbox.close()
        for file in (self.ledger, self.probes, self.trajectory, self.states):
            if file is not None:
                file.close()

    # --- marching -------------------------------------------------------------------------------------------
    def march(
        self, interrupted: Any, progress: bool, save_every: float, deadline: Deadline | None = None
    ) -> None:
        """March to the end, writing as the cadence says; whatever happens, the last state is saved."""
        study, steps, row = self.study, self.result.statistics, None
        if self.is_complete():
            return
        try:
            with progress_bar(study, self.books.ledger, progress) as show:
                for row in advance(
                    self.result, self.books, until=study.until, step=study.step, adaptive=study.adaptive
                ):
                    with nullcontext() if self.profile is None else self.profile.writing():
                        self.write(steps.steps, row)
                        self.save_now_and_then(save_every)
                    show(row)
                    self.stop_if_due(interrupted(), deadline)
            if row is not None and not self.is_complete():  # a path of statics may end before
                self.write_all(row, [steps.steps % n != 0 for n in self.cadence.steps])
            self.save()
            self.outbox.wait()
        except Exception as error:  # a second Ctrl-C interrupts anywhere, and what stands then is not saved
            with suppress(VisvivaError):  # the first error counts; an older state is still there
                if self.is_written and world().meets():
                    self.save()
                    self.outbox.wait()
            if isinstance(error, RunError):
                error.args = (
                    f"{error}; the run can be resumed from t = {self.saved_time!r}",
                    *error.args[1:],
                )
            raise

    def stop_if_due(self, signal: int, deadline: Deadline | None) -> None:
        """Stop where a signal came, or where the time given is nearly over."""
        if signal:
            self.save()
            self.outbox.wait()
            raise KeyboardInterrupt(signal)
        if deadline is not None and world().first(deadline.is_near(self._cost)) and not self.is_complete():
            raise TimeLimit(f"the time given is nearly over at t = {self.study.system.time:.6g}")

    def is_complete(self) -> bool:
        """Whether there is nothing left to march."""
        return self.study.system.clock.has_reached(self.study.until)

    def write(self, step: int, row: Array) -> None:
        """Write and keep what is due after a step, after the last one all."""
        last = self.is_complete()
        self.write_all(row, [last or step % n == 0 for n in self.cadence.steps])

    def write_all(self, row: Array, due: Sequence[bool]) -> None:
        """Write those of frame, row and state that are due."""
        frame, books, state = due
        self.is_written = False
        if state:
            self.keep()
        if books:
            self.write_row(row)
        if frame:
            self.write_frame()
        self.outbox.check()
        self.is_written = True

    def keep(self) -> None:
        """Keep the present state; what is written later has copies."""
        time, x, v, records = present(self.study.system)
        self.outbox.do(
            partial(self.result.kept.append, time, x.copy(), v.copy(), [r.copy() for r in records])
        )

    def write_row(self, row: Array) -> None:
        """Books and probes of the present state."""
        assert self.ledger is not None
        assert self.probes is not None
        self.outbox.do(partial(self.ledger.append, row.copy()))
        self.rows += 1
        values = np.concatenate([[self.study.system.time], *measured(self.study)])
        self.outbox.do(partial(self.probes.append, values))

    def write_frame(self) -> None:
        """The shapes at the present state."""
        if self.trajectory is not None:
            system = self.study.system
            points = [np.array(part) for part in self.drawing.points(system.x)]
            values = {name: np.array(v) for name, v in self.drawing.values(system.x, system.v).items()}
            self.outbox.do(partial(self.trajectory.append, self.clock, points, values))

    @property
    def clock(self) -> float:
        """Time of the frames: that of the system, or the number of steps where it need not grow."""
        growing = self.study.scheme.has_growing_time
        return self.study.system.time if growing else float(self.result.statistics.steps)

    def save_now_and_then(self, seconds: float) -> None:
        """Save the state if it is due; seldom enough that saving costs little."""
        if world().first(time.perf_counter() - self._saved >= max(seconds, 20 * self._cost)):
            self.save()

    def save(self) -> None:
        """Save the state, after what goes with it."""
        start, study = time.perf_counter(), self.study
        notes = {
            **steps_of(study),
            "until": study.until,
            "cadence": asdict(self.cadence),
            "study": self.notes,
            "rows": self.rows,
        }
        records = restart.records_of(self.result, self.books)
        self.outbox.do(partial(self.write_state, records, notes, study.system.time, start))
        self.outbox.check()
        self._saved = time.perf_counter()

    def write_state(self, records: list[Record], notes: dict[str, Any], now: float, start: float) -> None:
        """Write a state when all that goes with it is on the disk."""
        ledger, probes, trajectory, kept = self.ledger, self.probes, self.trajectory, self.states
        assert ledger is not None
        assert probes is not None
        assert kept is not None
        ledger.sync()  # the state must not outlive what it goes with
        probes.sync()
        kept.sync()
        if trajectory is not None:
            trajectory.sync()
        notes["frames"] = trajectory.n_steps if trajectory else 0
        notes["states"] = kept.count
        notes["checksums"] = {"ledger": ledger.checksum, "probes": probes.checksum, "states": kept.checksum}
        restart.write(self.files.state, records, notes)
        self.saved_time, self._cost = now, time.perf_counter() - start

    def forecast(self) -> Forecast:
        """Forecast of the size of the files, from the first frame, state and row."""
        assert self.states is not None
        assert self.ledger is not None
        assert self.probes is not None
        system, frame = self.study.system, self.trajectory.n_bytes if self.trajectory else 0
        start = time.perf_counter()
        self.drawing.values(system.x, system.v)
        seconds = time.perf_counter() - start + frame / SPEED
        n = max((self.study.until - self.study.system.time) / self.study.step, 1.0)
        frames, rows, states = (math.ceil(n / every) + 1 for every in self.cadence.steps)
        columns = len(self.ledger.columns) + len(self.probes.columns)
        return Forecast(
            frames=frames,
            states=states,
            rows=rows,
            frame=frame,
            state=self.states.n_bytes,
            row=DIGITS * columns,
            seconds=seconds * frames,
            free=shutil.disk_usage(self.files.path).free,
        )

    # --- the end --------------------------------------------------------------------------------------------
    def finish(self) -> None:
        """Write the summary of a complete run, and tell other processes what has been written."""
        assert self.states is not None
        assert self.ledger is not None
        world().first((self.states.extent, self.ledger.extent))
        files, study = self.files, self.study
        origin: dict[str, Any] = {"untold_arguments": self.origin.untold, "forced": self.origin.forced}
        if self.profile is not None:
            origin["profile"] = self.profile.figures()
        by_first(
            "write the summary", lambda: files.write_summary(summary(study, self.result, self.notes | origin))
        )
