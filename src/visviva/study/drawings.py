"""Plots, pictures and movie of a finished run; what cannot be drawn is told and costs nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from visviva.base.errors import InputError, shortened
from visviva.output.directory import RunDirectory
from visviva.output.manifest import claim
from visviva.output.trajectory import Trajectory
from visviva.study.progress import counting_bar
from visviva.study.study import Study

Counting = Callable[[int, int], None]


def draw_run(study: Study, files: RunDirectory, *, movies: bool = True) -> list[str]:
    """Draw energies, probes, pictures and, if the study wants one and `movies`, the movie.

    Returns
    -------
    list of str
        What could not be drawn and why, one line each; the run itself is complete without.
    """
    complaints: list[str] = []
    with spared(files.energy_plot.name, complaints):
        plot_energies(files)
    with spared(files.probes_plot.name, complaints):
        plot_probes(files)
    if files.trajectory.exists():
        with spared("pictures", complaints):
            draw_pictures(study, files, complaints, movies=movies)
    return complaints


def plot_energies(files: RunDirectory, folder: Path | None = None, kind: str = "png") -> Path:
    """Energies and the error of their balance; the file that was written."""
    from visviva.output.plot import energy_plot

    file = placed(files, files.energy_plot, folder, kind)
    energy_plot(files.ledger, file, labels=files.read_labels())
    return file


def plot_probes(files: RunDirectory, folder: Path | None = None, kind: str = "png") -> Path | None:
    """All probes; the file that was written, none if there are no probes."""
    from visviva.output.plot import probes_plot
    from visviva.output.tables import read_table

    series = read_table(files.probes)
    if len(series) < 2:
        return None
    file = placed(files, files.probes_plot, folder, kind)
    probes_plot(series, file, labels=files.read_labels())
    return file


def placed(files: RunDirectory, usual: Path, folder: Path | None, kind: str) -> Path:
    """The file in a folder, else in the directory of the run, where it must be of the run."""
    file = (folder or files.path) / usual.with_suffix(f".{kind}").name
    if folder is None:
        claim(files, file)
    return file


def draw_pictures(study: Study, files: RunDirectory, complaints: list[str], *, movies: bool) -> None:
    """The end, the moments that the study names, and the movie."""
    from visviva.output.movie import movie
    from visviva.output.picture import snapshot

    with Trajectory(files.trajectory) as motion:
        options: dict[str, Any] = {
            "field": next((name for name in study.stored if name in motion.fields), ""),
            "trails": [s.name for s in motion.surfaces if s.name in study.trails],
            **study.pictures.options,
        }
        reached = float(motion.times[-1])
    early = [m for m in study.moments if m <= reached + 1e-6 * study.step]  # times add up with rounding
    complaints += [
        f"no picture at {m:g}: the motion ends at {reached:g}" for m in study.moments if m not in early
    ]
    due = [(files.picture, None), *((files.picture_at(m), m) for m in early)]
    with counting_bar("pictures") as show:
        for k, (png, moment) in enumerate(due):
            show(k, len(due))
            with spared(png.name, complaints):
                claim(files, png)
                snapshot(files.trajectory, png, time=moment, **options)
    if study.movie and movies:
        file = files.movie if find_spec("imageio_ffmpeg") else files.movie.with_suffix(".gif")
        with spared(file.name, complaints), counting_bar("movie") as show:
            claim(files, file)
            movie(files.trajectory, file, progress=show, **options)


@contextmanager
def spared(what: str, complaints: list[str]) -> Iterator[None]:
    """Turn what goes wrong inside into a complaint: a picture that fails must not take a finished run with it."""
    try:
        yield
    except Exception as error:
        kind = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
        complaints.append(shortened(f"{what} could not be drawn ({kind}{' '.join(str(error).split())})"))
