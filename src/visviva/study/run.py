"""Runs a study into a directory: trajectory, books, probes, restart state, summary and pictures."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visviva.analysis.march import begin, checked_times
from visviva.base.arguments import number, positive
from visviva.base.deadline import Deadline
from visviva.base.errors import InputError
from visviva.base.interrupt import deferred_interrupt
from visviva.base.processes import refuse_unaware
from visviva.base.world import by_first, world
from visviva.output.directory import RunDirectory
from visviva.results.result import Result
from visviva.study.profile import Profile, profile_text
from visviva.study.study import Study, probe_columns
from visviva.system import agreement
from visviva.system.turn import alone

if TYPE_CHECKING:
    from visviva.study.recorder import Recorder


def run(
    study: Study,
    directory: str | Path,
    *,
    resume: bool = False,
    force: bool = False,
    overwrite: bool = False,
    progress: bool = True,
    frames_per_second: float = 50.0,
    every: int | None = None,
    save_every: float = 5.0,
    pictures: bool = True,
    movies: bool = True,
    project: bool = False,
    lock: bool = True,
    time_limit: float | None = None,
    profile: bool = False,
    compress: bool = False,
    tell: Callable[[str], None] | None = None,
    notes: Mapping[str, Any] | None = None,
) -> Result:
    """Run a study and leave everything in a directory.

    The directory then holds ``trajectory.vtkhdf``, ``ledger.csv``, ``probes.csv``, ``state.h5``,
    ``summary.json``, ``labels.json`` (names and units), ``energy.png``, ``probes.png`` and ``picture.png``, with
    pictures of the study's moments and a movie if it wants them. Ctrl-C and termination (SIGTERM) take effect between
    two steps; files are closed and the state saved before `KeyboardInterrupt` goes on. One process at a time writes
    into a directory, others may read all the while.

    Parameters
    ----------
    study : Study
    directory : path
        Made if missing; must not hold a run yet unless `resume`.
    resume : bool
        Continue the run in the directory from its last saved state, to the same bits as an unbroken run, unless the
        end time cut its last step. The study must be composed in the same way; only its end time, texts and wishes
        for pictures may differ.
    force : bool
        With `resume`: go on although arguments have changed, if the unknowns are the same. The summary says when
        and what.
    overwrite : bool
        Delete the files of an earlier run in the directory, once nothing is left to refuse.
    progress : bool
        Show a progress bar where there is a terminal.
    frames_per_second : float
        Most frames of the trajectory per second of simulated time.
    every : int
        Write tables and trajectory, and keep the state, every so many steps; by default all are as fine as is useful.
    save_every : float
        Seconds of wall time between saves of the state.
    pictures : bool
        Draw plots, pictures and movie at the end. What cannot be drawn is warned of, and spoils nothing else.
    movies : bool
        Make the movie, too, if the study wants one: it often takes longer than the run.
    project : bool
        Accept an initial state that is moved far to fit the constraints; see `simulate`.
    lock : bool
        Refuse to write where another process does; False is for file systems without locks, where nobody else sees to
        it that no two runs write into one directory.
    time_limit : float
        Seconds by the clock after which the run has to be over, its state saved: it stops where another step might take
        too long. Of several processes those of the first one count.
    profile : bool
        Time the phases of the run, for the summary.
    compress : bool
        Compress the trajectory at the end, which is written plainly until then; all that reads it reads it as before.
    tell : callable
        Called with texts about the run: what its files will take, before the first step, if that is much; the table
        of the phases at its end, however it ends.
    notes : mapping
        What the summary shall say about the origin of the study, by name.

    Raises
    ------
    InputError
        If the directory cannot be used, the study does not fit the run in it, or several processes were launched that
        do not know of each other.
    TimeLimit
        If the time is nearly over; the run can be resumed. It is a `RunError`.
    RunError
        If a step fails or a file cannot be written; what was computed so far is kept and can be resumed.

    Examples
    --------
    >>> import tempfile, visviva as vv
    >>> ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
    >>> study = vv.Study(vv.System([ball]), until=0.1, step=0.01, probes={"place": ball.point().position})
    >>> result = run(study, tempfile.mkdtemp() + "/ball")
    >>> result.statistics.steps
    10
    """
    from visviva.study.follower import Follower
    from visviva.study.recorder import Cadence, Recorder

    refuse_unaware()
    refuse_mixed(resume, force, overwrite)
    refuse_paces(save_every, frames_per_second)
    settle_times(study)
    system = study.system
    recorded = {"every": every, "save_every": save_every, "resume": resume}
    refuse_other_records(study, str(directory), time_limit, **recorded)
    deadline = end_of(time_limit)
    chosen, said = None if every is None else Cadence.all(every), dict(notes or {})
    if resume:
        files = RunDirectory.open(directory)
    else:
        refuse_early_end(study)
        files = RunDirectory(Path(directory))
    is_first = world().rank == 0  # which writes
    recording: type[Recorder] = Recorder if is_first else Follower
    with ExitStack() as held:
        by_first(f"write into {directory}", lambda: held.enter_context(files.writing(lock)))
        if resume:
            recorder = recording.resume(study, files, force, said)
            recorder.cadence = chosen or recorder.cadence
        else:
            cadence = chosen or Cadence.of(study, frames_per_second)
            recorder = recording.start(study, files, cadence, said, project, overwrite)
        announce(recorder, tell)
        with alone(system), recorder, deferred_interrupt() as interrupted, profiled(recorder, profile, tell):
            stopped = lambda: int(world().largest(interrupted()))  # noqa: E731
            recorder.march(stopped, progress and is_first, save_every, deadline)
        recorder.finish()
        if compress:
            by_first("compress the trajectory", partial(compressed, files))
        if pictures:
            by_first("draw the run", partial(illustrate, study, files, movies))
    return recorder.result


def compressed(files: RunDirectory) -> None:
    """Compress the trajectory, if there are shapes in it."""
    from visviva.output.compressed import compress

    if files.trajectory.exists():
        compress(files.trajectory)


def illustrate(study: Study, files: RunDirectory, movies: bool) -> None:
    """Draw plots, pictures and movie; what cannot be drawn is warned of."""
    from visviva.study import drawings

    for complaint in drawings.draw_run(study, files, movies=movies):
        warnings.warn(complaint, stacklevel=4)  # where the run is called


def announce(recorder: Recorder, tell: Callable[[str], None] | None) -> None:
    """Note what files will take, and tell of it if it is much."""
    forecast = recorder.forecast()
    recorder.notes["output"] = asdict(forecast)
    if tell is not None and forecast.is_large:
        tell(str(forecast))


@contextmanager
def profiled(recorder: Recorder, wanted: bool, tell: Callable[[str], None] | None) -> Iterator[None]:
    """Time the phases of what is done inside, if that is wanted, and tell of them."""
    if not wanted:
        yield
        return
    recorder.profile = Profile(recorder.study.system)
    try:
        yield
    finally:
        recorder.profile.stop()
        if tell is not None:
            tell(profile_text(recorder.profile.figures()))


def refuse_mixed(resume: bool, force: bool, overwrite: bool) -> None:
    """Refuse wishes that exclude each other."""
    if force and not resume:
        raise InputError("force=True goes with resume=True: a new run has nothing to differ from")
    if overwrite and resume:
        raise InputError(
            "overwrite=True and resume=True exclude each other: delete the earlier run, or continue it"
        )


def refuse_paces(save_every: float, frames_per_second: float) -> None:
    """Refuse what is no number of seconds or of frames."""
    if not number("run", "save_every", save_every) >= 0:
        raise InputError(f"save_every = {save_every} is not a number of seconds")
    positive("run", "frames_per_second", frames_per_second)


def refuse_other_records(study: Study, directory: str, time_limit: float | None, **wishes: object) -> None:
    """Refuse runs that other processes are to record otherwise."""
    recorded = {"directory": directory, "probes": list(study.probes), "has_limit": time_limit is not None}
    wishes |= recorded | {"fields": study.fields}
    agreement.refuse_different_arguments("run", until=study.until, step=study.step, **wishes)


def end_of(time_limit: float | None) -> Deadline | None:
    """The end of the time given; of several processes that of the first one, by its clock."""
    if time_limit is None:
        return None
    return Deadline(positive("run", "time_limit", world().first(time_limit)))


def settle_times(study: Study) -> None:
    """Refuse what cannot be a step or an end; they may have been changed since the study was made."""
    study.until, study.step = checked_times(study.until, study.step, study.system.time)
    if not math.isfinite(study.until):
        raise InputError(f"end time until = {study.until} is not a finite number")


def refuse_early_end(study: Study) -> None:
    """Refuse an end that is not after the start."""
    if not study.until > study.system.time:
        raise InputError(f"end time until = {study.until} is not after the start at {study.system.time:g}")
    study.system.clock.refuse_short(study.until, study.step, study.system.stepper.is_given)


def rehearse(study: Study) -> None:
    """Refuse what `run` refuses before its first step (times, start, pictures, probes); writes nothing."""
    from visviva.study.shown import draw

    settle_times(study)
    refuse_early_end(study)
    begin(study.system, study.scheme, step=study.step)
    draw(study)
    probe_columns(study)
