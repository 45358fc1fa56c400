"""Commands of the command line that show what a run left."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from visviva.cli_options import (
    CameraText,
    Cmap,
    Deform,
    Diagram,
    Directory,
    ExportFile,
    Field,
    Format,
    Outline,
    Range,
    SizeText,
    Vectors,
    whole,
)
from visviva.scene.commands import looks, shown

if TYPE_CHECKING:
    from visviva.output.directory import RunDirectory


def aim(files: RunDirectory, out: Path | None, usual: Path, *more: Path) -> tuple[Path, bool]:
    """What to write, and whether that replaces a file the user named; in the directory it must be of the run."""
    from visviva.output.manifest import claim

    if out is None:
        claim(files, usual, *more)
        return usual, False
    return out, out.exists()


def told(file: Path, replaces: bool) -> str:
    """The file that was written, and whether another one had its name."""
    return f"{file} (in place of the file that was there)" if replaces else str(file)


def plot(
    directory: Directory,
    /,
    *,
    out: Annotated[
        Path | None, Parameter(help="Directory for the plots; that of the run if not given.")
    ] = None,
    format: Annotated[Literal["png", "pdf", "svg"], Parameter(help="What is written.")] = "png",
) -> None:
    """Plot energies, the error of the balance and all probes of a run."""
    from visviva.output.directory import RunDirectory
    from visviva.study.drawings import plot_energies, plot_probes

    files = RunDirectory.open(directory)
    there = set((out or files.path).glob("*"))
    for file in (plot_energies(files, out, format), plot_probes(files, out, format)):
        if file is not None:
            print(told(file, out is not None and file in there))


def movie(
    directory: Directory,
    /,
    *,
    out: Annotated[
        Path | None, Parameter(help="*.mp4 or *.gif; movie.mp4 in the directory if not given.")
    ] = None,
    fps: Annotated[int, Parameter(converter=whole, help="Frames per second.")] = 25,
    speed: Annotated[
        float | None,
        Parameter(
            help="Seconds of motion per second of movie, 1 if not given; of paths states, 10 if not given."
        ),
    ] = None,
    field: Field = None,
    outline: Outline = False,
    camera: CameraText = None,
    size: SizeText = None,
    limits: Range = None,
    cmap: Cmap = "viridis",
    deform: Deform = 1.0,
    vectors: Vectors = "",
    diagram: Diagram = "",
) -> None:
    """Turn a run into a movie."""
    from visviva.output.directory import RunDirectory
    from visviva.output.movie import movie as make_movie
    from visviva.study.progress import counting_bar

    files = RunDirectory.open(directory)
    target, replaces = aim(files, out, files.movie)
    with counting_bar("movie") as show:
        make_movie(
            files.trajectory,
            target,
            fps=fps,
            speed=speed,
            field=shown(files.trajectory, field),
            outline=outline,
            progress=show,
            **looks(camera, size, limits, cmap, deform, vectors, diagram),
        )
    print(told(target, replaces))


def picture(
    directory: Directory,
    /,
    *,
    out: Annotated[Path | None, Parameter(help="*.png; picture.png in the directory if not given.")] = None,
    time: Annotated[
        float | Literal["max"] | None,
        Parameter(help="Moment to draw; the end if not given, max when the field is largest."),
    ] = None,
    field: Field = None,
    outline: Outline = False,
    camera: CameraText = None,
    size: SizeText = None,
    limits: Range = None,
    cmap: Cmap = "viridis",
    deform: Deform = 1.0,
    vectors: Vectors = "",
    diagram: Diagram = "",
    transparent: Annotated[bool, Parameter(negative="", help="Without a background.")] = False,
) -> None:
    """Draw one moment of a run."""
    from visviva.output.directory import RunDirectory
    from visviva.output.picture import snapshot

    files = RunDirectory.open(directory)
    target, replaces = aim(files, out, files.picture)
    look = looks(camera, size, limits, cmap, deform, vectors, diagram)
    look |= {"field": shown(files.trajectory, field), "outline": outline, "transparent": transparent}
    snapshot(files.trajectory, target, time=time, **look)
    print(told(target, replaces))


def html(
    directory: Directory,
    /,
    *,
    out: Annotated[Path | None, Parameter(help="*.html; motion.html in the directory if not given.")] = None,
    size: Annotated[float, Parameter(help="Megabytes the page may have; frames are thinned to that.")] = 20.0,
) -> None:
    """Turn a run into one page that browsers play without a network."""
    from visviva.output.page import write_page
    from visviva.study.progress import counting_bar

    replaces = out is not None and out.exists()
    with counting_bar("page") as show:
        file = write_page(directory, out, largest=int(1e6 * size), progress=show)
    print(told(file, replaces))


def export(
    directory: Directory,
    /,
    *,
    format: Format = "pvd",
    out: ExportFile = None,
) -> None:
    """Write a run with its components as blocks by their names, for ParaView and others."""
    from visviva.output.directory import RunDirectory
    from visviva.output.named_blocks import write_blocks
    from visviva.output.pvd import write_pvd
    from visviva.study.progress import counting_bar

    files = RunDirectory.open(directory)
    write, name = (write_pvd, "trajectory.pvd") if format == "pvd" else (write_blocks, "blocks.vtkhdf")
    usual = files.path / name
    target, replaces = aim(files, out, usual, *([usual.with_suffix("")] if format == "pvd" else []))
    with counting_bar(format) as show:
        file = write(files.trajectory, target, progress=show)
    print(told(file, replaces))


def view(
    directory: Directory,
    /,
    *,
    live: Annotated[bool, Parameter(negative="", help="Follow a run that is going on.")] = False,
    port: Annotated[
        int, Parameter(converter=whole, help="Where the page is served; 0 for any free one.")
    ] = 0,
    browser: Annotated[bool, Parameter(help="Open a browser, where there is one.")] = True,
    window: Annotated[bool, Parameter(negative="", help="A window of PyVista in place of a page.")] = False,
    field: Field = None,
) -> None:
    """Show a run as a page in the browser, served on this machine alone until Ctrl-C; nothing can be changed by it."""
    from visviva.output.directory import RunDirectory
    from visviva.output.viewer import has_screen, show

    trajectory = RunDirectory.open(directory).trajectory
    colored = shown(trajectory, field)
    if window:
        show(trajectory, field=colored)
        return
    import webbrowser

    from visviva.output.page_server import PageServer, RunPages

    with PageServer(RunPages(directory, live, colored), port=port) as server:
        print(
            f"{server.address}\n(Ctrl-C ends it; on another machine: ssh -L PORT:127.0.0.1:PORT, the same PORT)"
        )
        sys.stdout.flush()
        if browser and has_screen():  # browsers of terminals would take this one
            webbrowser.open(server.address)
        with suppress(KeyboardInterrupt):
            server.serve_forever()
