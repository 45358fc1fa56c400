"""Plots, pictures, movies and files of a result."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.base.html import Markup, sparkline, table
from visviva.base.world import by_first, world
from visviva.output.directory import RunDirectory
from visviva.results.audit import course, figures, judgements
from visviva.results.looking_back import tabulated, units_of_columns
from visviva.results.naming import labels_of, up_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from visviva.output.labels import Labels
    from visviva.output.page import Page
    from visviva.results.result import Result


@dataclass(frozen=True, repr=False)
class Picture:
    """A picture that notebooks show.

    Attributes
    ----------
    data : bytes
        As in a file.
    path : Path or None
        The file that was written.
    """

    data: bytes
    path: Path | None = None

    def __repr__(self) -> str:
        return f"Picture({self.path or f'{len(self.data)} bytes'})"

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        if self.data.startswith(b"\x89PNG"):
            return {"image/png": self.data}
        return (
            {"image/svg+xml": self.data.decode()}
            if b"<svg" in self.data[:2000]
            else {"text/plain": repr(self)}
        )


def made(file: str | Path | None, draw: Callable[[Path], object]) -> Picture:
    """What is drawn into the file, or a temporary one, by the first process."""

    def drawn() -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.png" if file is None else Path(file)
            draw(path)
            return path.read_bytes()

    return Picture(by_first(f"draw {file or 'a picture'}", drawn), None if file is None else Path(file))


def labels(result: Result, columns: Mapping[str, str] | None = None) -> Labels:
    """Title of what a result shows."""
    return labels_of(result.system.units, result.scheme, columns=columns, up=up_of(result.system))


def plot_of(result: Result, file: str | Path | None, probes: Mapping[str, Any]) -> Picture:
    """Energies, and probes below."""
    from visviva.output.plot import overview

    ledger = dict(zip(result.ledger.names, result.ledger.table.T, strict=True))
    series = tabulated(result, probes)
    named = labels(result, units_of_columns(result, probes, result.system.units))
    return made(file, lambda path: overview(ledger, series, path, labels=named))


@contextmanager
def trajectory(result: Result, file: object, options: Mapping[str, Any]) -> Iterator[Path]:
    """The trajectory of a run in a directory, or a temporary one of the kept states, with what is to be drawn."""
    with world().doing(f"draw {file or 'a picture'}"), _trajectory(result, options) as path:
        yield path


@contextmanager
def _trajectory(result: Result, options: Mapping[str, Any]) -> Iterator[Path]:
    diagram = options.get("diagram")
    asked = [options.get("field"), options.get("vectors"), f"diagram_{diagram}" if diagram else None]
    wanted = [str(name) for name in asked if name]
    written = None if result.directory is None else result.directory.trajectory
    if written is not None and by_first("find fields", partial(has_fields, written, wanted)):
        yield written
        return
    from visviva.measure.names import usual_fields

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trajectory.vtkhdf"
        write_trajectory(result, path, dict.fromkeys((*usual_fields(result.system), *wanted)))
        yield path


def has_fields(file: Path, wanted: Sequence[str]) -> bool:
    """Whether a trajectory is there, and all these fields in it."""
    from visviva.output.trajectory import Trajectory

    if not file.exists():
        return False
    with Trajectory(file) as stored:
        return set(wanted) <= set(stored.fields)


def picture_of(result: Result, file: str | Path | None, **options: Any) -> Picture:
    """A moment of the motion."""
    from visviva.output.picture import snapshot

    with trajectory(result, file, options) as motion:
        return made(file, lambda path: snapshot(motion, path, **options))


def movie_of(result: Result, file: str | Path, **options: Any) -> Path:
    """A movie of the motion."""
    from visviva.output.movie import movie

    with trajectory(result, file, options) as motion:
        by_first(f"draw {file}", partial(movie, motion, file, **options))
    return Path(file)


def view_of(result: Result, *, window: bool = False, **options: Any) -> Page | None:
    """The motion as a page, opened where there is a screen and no notebook; or in a window."""
    from visviva.output.page import Page, write_page
    from visviva.output.viewer import has_screen, show

    if window:
        with trajectory(result, "a window", options) as motion:
            by_first("show a window", partial(show, motion, **options))
        return None
    with world().doing("write a page"), tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run"
        write_directory(result, path)
        page = Page(by_first("write a page", lambda: write_page(path, **options).read_text(encoding="utf-8")))
    if world().rank == 0 and has_screen() and "ipykernel" not in sys.modules:
        page.open()
    return page


def write_trajectory(result: Result, path: str | Path, fields: Iterable[str] | None = None) -> None:
    """The kept states as a file for ParaView, pictures and movies: evaluated by all processes, written by the first."""
    from visviva.measure.names import usual_fields
    from visviva.output.vtkhdf import TrajectoryWriter
    from visviva.results.drawing import Drawing

    drawing = Drawing(result.system, fields=tuple(usual_fields(result.system) if fields is None else fields))
    grow = bool((np.diff(result.times) > 0).all())
    times = (result.times if grow else np.arange(len(result.times), dtype=float)).tolist()
    with TrajectoryWriter(path, drawing.surfaces, len(times), labels(result)) as writer:  # opens nothing yet
        for time, x, v, records in zip(times, result.states, result.rates, result.records, strict=False):
            frame = time, drawing.points(x), drawing.values(x, v, records)
            by_first("write a frame", partial(writer.append, *frame))


def write_directory(result: Result, path: str | Path, fields: Sequence[str] | None = None) -> None:
    """Trajectory, tables, names and figures in a directory, like those of a run but for its restart state."""
    from visviva.results.drawing import Drawing

    files = by_first(f"write {path}", partial(RunDirectory.create, path))
    units = units_of_columns(result, result.recorded.probes, result.system.units)
    named = labels(result, units)
    by_first(f"write {files.labels}", lambda: files.write_labels(named))
    result.ledger.to_csv(files.ledger)
    result.to_csv(files.probes)
    told = {"scheme": str(result.scheme), "end_time": result.ledger.last("time"), **figures(result)}
    by_first(f"write {files.summary}", lambda: files.write_summary(told))
    if Drawing(result.system).surfaces:
        write_trajectory(result, files.trajectory, fields)


def html_of(result: Result) -> str:
    """Audit, energies over time and recorded histories, for notebooks."""
    first, *others = course(result)
    rows = [(judged.what, judged.figures, judged.verdict) for judged in judgements(result)]
    ledger = result.ledger
    names = ["kinetic", *(f"potential_{p}" for p in ledger.potentials), "total", "imbalance"]
    lines: list[tuple[Any, ...]] = [(name.replace("_", " "), sparkline(ledger[name])) for name in names]
    lines += [
        (n, sparkline(values))
        for n, values in tabulated(result, result.recorded.probes).items()
        if n != "time"
    ]
    told = Markup("<br>".join(map(str, others)))
    return table(rows, title=first) + table([(told,)]) + table(lines)
