"""The command line: ``visviva run crane`` and what belongs to it."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import App, CycloptsError, Parameter

from visviva.base.errors import InputError, VisvivaError, shortened
from visviva.base.interrupt import exit_code
from visviva.cli_options import (
    CameraText,
    Cmap,
    Deform,
    Diagram,
    Directory,
    Every,
    Field,
    Force,
    Model,
    NoLock,
    NoMovie,
    NoPictures,
    Out,
    Outline,
    Outside,
    Overwrite,
    Project,
    Range,
    Resume,
    Saving,
    SchemeText,
    Settings,
    SizeText,
    Step,
    Threads,
    Tolerance,
    Trust,
    Until,
    Vectors,
    whole,
)
from visviva.scene.commands import (
    FAILED,
    as_before,
    compose,
    execute,
    introduce,
    looks,
    named_models,
    refuse_earlier_run,
    say,
    shown,
)

BAD_INPUT = 2
DEBUG = "--debug"
UNEXPECTED = "an error that is not expected"

app = App(
    name="visviva",
    help="Energy-momentum conserving mechanics: bodies, joints and forces as one system, with an audit. "
    "With --debug anywhere on the line Python tells where an error comes from.",
    version=lambda: _version(),
    suppress_keyboard_interrupt=False,
    help_format="plaintext",
)
if hasattr(app, "register_install_completion_command"):  # since Cyclopts 4
    app.register_install_completion_command()


@app.command
def run(
    model: Model,
    /,
    *,
    out: Out = None,
    until: Until = None,
    step: Step = None,
    scheme: SchemeText = None,
    adaptive: Tolerance = None,
    settings: Settings = [],  # noqa: B006  (cyclopts copies)
    project: Project = False,
    resume: Resume = False,
    force: Force = False,
    threads: Threads = None,
    every: Every = None,
    save_every: Saving = 5.0,
    overwrite: Overwrite = False,
    no_lock: NoLock = False,
    no_movie: NoMovie = False,
    no_pictures: NoPictures = False,
    trust: Trust = False,
    allow_outside: Outside = False,
) -> int:
    """Run an example or a scene file and print an audit of what was conserved."""
    from visviva.base.threads import use_threads
    from visviva.scene.gallery import assignments

    use_threads(threads)
    if resume and overwrite:
        raise InputError(
            "--resume and --overwrite exclude each other: continue the earlier run, or delete it"
        )
    directory = out or Path("runs") / Path(model).name  # a scene's ending keeps it from an example's
    changes = {"until": until, "step": step, "scheme": scheme, "adaptive": adaptive}
    given = {key: value for key, value in changes.items() if value is not None}
    parameters = assignments(settings)
    if resume:
        given, parameters = as_before(directory, given, parameters, force)
    elif not overwrite:
        refuse_earlier_run(directory)
    source = compose(model, parameters, given, trust=trust, allow_outside=allow_outside)
    introduce(source, project or resume)
    notes = {"study": source.name, "parameters": parameters, "given": given}
    files: dict[str, Any] = {
        "every": every,
        "save_every": save_every,
        "overwrite": overwrite,
        "lock": not no_lock,
    }
    going_on = {"resume": resume, "force": force, "project": project}
    drawn = {"pictures": not no_pictures, "movies": not no_movie}
    return execute(source, directory, notes=notes, **drawn, **files, **going_on)


@app.command
def check(
    model: Model,
    /,
    *,
    settings: Settings = [],  # noqa: B006
    trust: Trust = False,
    allow_outside: Outside = False,
) -> int:
    """Compose an example or a scene file and check it without running."""
    from visviva.scene.gallery import assignments

    source = compose(model, assignments(settings), {}, trust=trust, allow_outside=allow_outside)
    print(source.study.title or source.name)
    print(source.study.system.check())
    return 0


@app.command
def examples(
    name: Annotated[str | None, Parameter(help="Tell about this one, and its parameters.")] = None, /
) -> None:
    """List the examples, or tell what one of them is and takes."""
    from visviva.scene.gallery import described, example, example_names, first_line

    if name is not None:
        print(described(example(name), name))
        return
    names = example_names()
    width = max(map(len, names))
    for name in names:
        print(f"{name:{width}}  {first_line(example(name))}")


@app.command
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
    for file in (plot_energies(files, out, format), plot_probes(files, out, format)):
        if file is not None:
            print(file)


@app.command
def movie(
    directory: Directory,
    /,
    *,
    out: Annotated[
        Path | None, Parameter(help="*.mp4 or *.gif; movie.mp4 in the directory if not given.")
    ] = None,
    fps: Annotated[int, Parameter(converter=whole, help="Frames per second.")] = 25,
    speed: Annotated[float, Parameter(help="Seconds of motion per second of movie.")] = 1.0,
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
    target = out or files.movie
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
    print(target)


@app.command
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
    target = out or files.picture
    look = looks(camera, size, limits, cmap, deform, vectors, diagram)
    look |= {"field": shown(files.trajectory, field), "outline": outline, "transparent": transparent}
    snapshot(files.trajectory, target, time=time, **look)
    print(target)


@app.command
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

    with counting_bar("page") as show:
        file = write_page(directory, out, largest=int(1e6 * size), progress=show)
    print(file)


@app.command
def export(
    directory: Directory,
    /,
    *,
    format: Annotated[
        Literal["pvd"], Parameter(help="pvd: a *.pvd with a *.vtu per component and moment.")
    ] = "pvd",
    out: Annotated[
        Path | None, Parameter(help="*.pvd; trajectory.pvd in the directory if not given.")
    ] = None,
) -> None:
    """Write a run for programs that do not read its trajectory.vtkhdf, with names of components such as xx."""
    from visviva.output.directory import RunDirectory
    from visviva.output.pvd import write_pvd
    from visviva.study.progress import counting_bar

    files = RunDirectory.open(directory)
    with counting_bar(format) as show:
        file = write_pvd(files.trajectory, out or files.trajectory.with_suffix(f".{format}"), progress=show)
    print(file)


@app.command
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


@app.command
def schema() -> None:
    """Print the JSON Schema of scene files, for editors."""
    import json

    from visviva.scene.schema import scene_schema

    print(json.dumps(scene_schema(), indent=2))


@app.command
def info() -> None:
    """Print version, instruction set and optional packages."""
    import platform
    from importlib.util import find_spec

    from visviva import _core
    from visviva.base.threads import told

    print(f"visviva {_version()}, Python {platform.python_version()}, {platform.platform()}")
    print(f"instruction set of the core: {_core.instruction_set()}; {told()}")
    for package, use in (("pyvista", "viewer and better pictures"), ("imageio_ffmpeg", "mp4 movies"),
                         ("trimesh", "bodies from surface meshes"), ("meshio", "mesh files")):  # fmt: skip
        print(f"{package}: {'found' if find_spec(package) else 'not installed'} ({use})")


def _version() -> str:
    from visviva import __version__

    return __version__


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 2 for bad input, 1 for a failed run, 130 on Ctrl-C.

    With ``--debug`` anywhere errors are raised, so that Python tells where they come from.
    """
    given = sys.argv[1:] if arguments is None else list(arguments)
    tokens = [token for token in given if token != DEBUG]
    if len(tokens) < len(given):
        return command(tokens)
    try:
        return command(tokens)
    except KeyboardInterrupt as interrupt:
        return exit_code(interrupt)
    except BrokenPipeError:  # who reads has seen enough, as in `visviva examples | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left must not fail at exit
        return FAILED
    except CycloptsError as error:
        say(f"{one_line(error)} (see visviva --help)")
        return BAD_INPUT
    except InputError as error:
        say(str(error))
        return BAD_INPUT
    except ImportError as error:  # VISVIVA_ISA, or an optional package
        say(one_line(error))
        return BAD_INPUT
    except VisvivaError as error:
        say(str(error))
        return FAILED
    except OSError as error:  # names that no file can have, no permission
        say(one_line(error))
        return BAD_INPUT
    except MemoryError:
        say("there is not enough memory: take a coarser mesh, fewer steps, or a larger machine")
        return FAILED
    except Exception as error:
        say(f"{UNEXPECTED}, {type(error).__name__}: {one_line(error)}; {DEBUG} tells where, please report it")
        return FAILED


def command(tokens: list[str]) -> int:
    """Run the command that the tokens give; returns the exit code."""
    if tokens[:1] == ["run"] and set(tokens) & HELP and (model := next(iter(named_models(tokens)), None)):
        print(f"{model}\n")  # before the options that all models have
    code = app(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    sys.stdout.flush()
    return code if isinstance(code, int) else 0


HELP = {"--help", "-h"}


def one_line(error: Exception) -> str:
    """Message of an error, cut to one line of bounded length."""
    return shortened(" ".join(str(error).split()))
