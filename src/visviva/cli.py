"""The command line: ``visviva run crane`` and what belongs to it."""

from __future__ import annotations

import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from functools import partial, wraps
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, CycloptsError, Parameter

from visviva.base.deadline import left_of
from visviva.base.errors import InputError, VisvivaError, shortened
from visviva.base.interrupt import exit_code
from visviva.base.processes import end_all, is_first, n_told
from visviva.base.world import World, by_first, is_joined, joined, world
from visviva.cli_options import (
    Compress,
    Every,
    Fields,
    Force,
    Model,
    NoLock,
    NoMovie,
    NoPictures,
    Out,
    Outside,
    Overwrite,
    PetscOptions,
    Profiled,
    Project,
    Resume,
    Saving,
    SchemeText,
    Settings,
    Step,
    Threads,
    TimeGiven,
    Tolerance,
    Trust,
    Until,
)
from visviva.cli_shown import export, html, movie, picture, plot, view
from visviva.scene.commands import (
    FAILED,
    as_before,
    compose,
    execute,
    introduce,
    named_models,
    refuse_earlier_run,
    say,
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


def alone(shows: Callable[..., None]) -> Callable[..., None]:
    """The same command, which of several processes the first one does: two that write one file break it."""

    @wraps(shows)
    def shown(*given: Any, **more: Any) -> None:
        by_first(shows.__name__, partial(shows, *given, **more))

    return shown


for shows in (plot, movie, picture, html, export, view):
    app.command(alone(shows))


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
    petsc: PetscOptions = None,
    time_limit: TimeGiven = None,
    profile: Profiled = False,
    every: Every = None,
    fields: Fields = None,
    compress: Compress = False,
    save_every: Saving = 5.0,
    overwrite: Overwrite = False,
    no_lock: NoLock = False,
    no_movie: NoMovie = False,
    no_pictures: NoPictures = False,
    trust: Trust = False,
    allow_outside: Outside = False,
) -> int:
    """Run an example or a scene file and print an audit of what was conserved."""
    from visviva.base.processes import refuse_unaware
    from visviva.base.threads import use_threads
    from visviva.scene.gallery import assignments

    refuse_unaware()
    use_threads(threads)
    if resume and overwrite:
        raise InputError("--resume and --overwrite exclude each other: continue that run, or delete it")
    directory = out or Path("runs") / Path(model).name  # a scene's ending keeps it from an example's
    changes = {"until": until, "step": step, "scheme": scheme, "adaptive": adaptive, "fields": fields}
    changes["petsc"] = petsc
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
        "time_limit": left_of(time_limit),
        "profile": profile,
        "compress": compress,
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
    """Compose an example or a scene file and check it without running; what run would refuse is refused."""
    from visviva.scene.gallery import assignments
    from visviva.study.run import rehearse

    source = compose(model, assignments(settings), {}, trust=trust, allow_outside=allow_outside)
    print(source.study.title or source.name)
    print(source.study.system.check())
    sys.stdout.flush()
    rehearse(source.study)
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
def schema() -> None:
    """Print the JSON Schema of scene files, for editors."""
    import json

    from visviva.scene.schema import scene_schema

    print(json.dumps(scene_schema(), indent=2))


OPTIONAL = {
    "pyvista": ("view", "better pictures, meshes of results"),
    "imageio_ffmpeg": ("view", "mp4 movies"),
    "trimesh": ("mesh", "bodies from surface meshes"),
    "meshio": ("mesh", "mesh files"),
    "gmsh": ("gmsh", "CAD files"),
    "mkl": ("mkl", "PARDISO, a faster sparse solver"),
    "pyamg": ("amg", "iterative solvers"),
    "sectionproperties": ("sections", "beams of any cross section"),
    "pandas": ("tables", "tables of results"),
}
"""Packages that are needed for some things alone, their extra, and what for."""


@app.command
def info() -> None:
    """Print version, instruction set and optional packages."""
    import platform
    from importlib.util import find_spec

    from visviva import _core
    from visviva.base.threads import told
    from visviva.linear.choice import mkl_library

    print(f"visviva {_version()}, Python {platform.python_version()}, {platform.platform()}")
    print(f"instruction set of the core: {_core.instruction_set()}; {told()}")
    for package, (extra, use) in OPTIONAL.items():
        has = bool(mkl_library()) if package == "mkl" else find_spec(package) is not None
        print(f"{package}: {'found' if has else f'not installed, pip install visviva[{extra}]'} ({use})")


def _version() -> str:
    from visviva import __version__

    return __version__


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and give the exit code: 0, 2 for bad input, 1 for failures, 130 on Ctrl-C, 75 out of time.

    With ``--debug`` anywhere errors are raised, so that Python tells where they come from.
    """
    given = sys.argv[1:] if arguments is None else list(arguments)
    tokens = [token for token in given if token != DEBUG]
    if len(tokens) < len(given):
        with speaking(world()):
            return command(tokens)
    try:
        with speaking(world()):
            return command(tokens)
    except KeyboardInterrupt as interrupt:
        if not is_joined():
            end_all(exit_code(interrupt))
        return exit_code(interrupt)
    except BrokenPipeError:  # who reads has seen enough, as in `visviva examples | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left must not fail at exit
        return FAILED
    except CycloptsError as error:
        return failed(f"{one_line(error)} (see visviva --help)", BAD_INPUT)
    except InputError as error:
        return failed(str(error), BAD_INPUT)
    except ImportError as error:  # VISVIVA_ISA, or an optional package
        return failed(one_line(error), BAD_INPUT)
    except VisvivaError as error:
        return failed(str(error), FAILED)
    except OSError as error:  # names that no file can have, no permission
        return failed(one_line(error), BAD_INPUT)
    except MemoryError:
        return failed(
            "there is not enough memory: take a coarser mesh, fewer steps, or a larger machine", FAILED
        )
    except Exception as error:
        return failed(
            f"{UNEXPECTED}, {type(error).__name__}: {one_line(error)}; {DEBUG} tells where, please report it",
            FAILED,
        )


@contextmanager
def speaking(those: World) -> Iterator[None]:
    """Of several processes the first one prints."""
    if those.rank == 0:
        yield
        return
    warnings.simplefilter("ignore")
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
        yield


def failed(message: str, code: int) -> int:
    """Tell of an error, once if it is that of all processes; else it ends the others, too. Returns the exit code."""
    if not is_joined() and n_told() > 1:  # they may wait for this one
        if not is_first():
            time.sleep(1.0)  # where all fail by the same, the first has told it, and ended them
        say(message)
        end_all(code)
        return code
    those = joined()
    if (meet := those.meets()) and not those.differs(message):
        if those.rank == 0 and is_first():  # of processes that do not know of each other, too
            say(message)
        return code
    say(f"process {those.rank} of {those.size}: {message}")
    if not meet:
        those.abort(code)
    return code


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
