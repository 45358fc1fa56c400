"""Steps shared by the commands of the command line: composing, resuming, introducing and checking a study."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visviva.base.deadline import TimeLimit
from visviva.base.errors import InputError
from visviva.base.interrupt import exit_code
from visviva.base.threads import told
from visviva.base.world import world

if TYPE_CHECKING:
    from visviva.results.result import Result
    from visviva.scene.gallery import Source

FAILED = 1
TIME_IS_UP = 75  # EX_TEMPFAIL of sysexits.h: try again
SCENES = (".yaml", ".yml", ".toml")


def compose(model: str, parameters: dict[str, Any], given: dict[str, Any], **allowed: bool) -> Source:
    """The study that was asked for, with end time, step and scheme as given, and what its scene may do."""
    from visviva.scene.gallery import compose_example

    if Path(model).suffix == ".py":
        from visviva.scene.gallery import compose_file

        source = compose_file(model, parameters)
    elif Path(model).suffix in SCENES or os.sep in model:
        from visviva.scene.reading import compose_scene

        source = compose_scene(model, parameters, **allowed)
    else:
        source = compose_example(model, parameters)
    if "until" in given:
        source.study.until = given["until"]
    if "step" in given:
        source.study.step = given["step"]
    if "scheme" in given:
        from visviva.scene.reading import scheme_of_text

        source.study.scheme = scheme_of_text(given["scheme"])
    if "adaptive" in given:
        from visviva.analysis.adaptive import Adaptive

        source.study.adaptive = Adaptive(tolerance=given["adaptive"])
    if "fields" in given:
        source.study.fields = tuple(name.strip() for name in given["fields"].split(",") if name.strip())
    if "petsc" in given:
        from visviva.linear.petsc import Petsc

        system = source.study.system
        system.newton = replace(system.newton, linear=Petsc(given["petsc"]))
    return source


def as_before(
    directory: Path, given: dict[str, Any], parameters: dict[str, Any], force: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arguments of an earlier run, but for its end time; with `force` those given now."""
    from visviva.output.directory import RunDirectory
    from visviva.study.restart import notes_of

    earlier = notes_of(RunDirectory.open(directory).state)["study"]
    for key, value in parameters.items():
        if earlier["parameters"].get(key) != value and not force:
            raise InputError(
                f"{directory}: was run without --set {key}={value}; resume with what it was run with, or go on with "
                "--force if the change is meant"
            )
    kept = {key: value for key, value in earlier["given"].items() if key != "until"}
    return kept | given, earlier["parameters"] | parameters


def refuse_earlier_run(directory: Path) -> None:
    """A new run must not mix with an older one."""
    from visviva.output.directory import RunDirectory
    from visviva.output.manifest import refuse_others

    files = RunDirectory(directory)
    refuse_others(files)
    if earlier := files.earlier:
        raise InputError(
            f"{directory}: already holds a run ({earlier[0].name}); continue it with --resume, "
            "choose another directory with --out DIR, or delete it with --overwrite"
        )


def introduce(source: Source, project: bool) -> None:
    """Title and size of a system."""
    from visviva.analysis.march import prepare

    system = source.study.system
    prepare(system, source.study.scheme, project=project)
    report = system.report
    assert report is not None
    n, m, f = report.n_coordinates, report.n_constraints, report.degrees_of_freedom
    redundant = f", {len(report.redundant)} constraints are redundant" if report.redundant else ""
    print(source.study.title or source.name)
    print(
        f"unknown coordinates n = {n}, constraints m = {m}, {f} degrees of freedom{redundant}; {told()}",
        flush=True,
    )


def shown(trajectory: Path, field: str | None) -> str:
    """The field that was asked for, or the velocity where something flows, or what says most of solids."""
    from visviva.output.coloring import Coloring, first_field
    from visviva.output.trajectory import Trajectory

    if field is not None:
        return field
    with Trajectory(trajectory) as motion:
        if "velocity" in motion.fields and Coloring("velocity", 0, 1).streams(
            motion, float(motion.times[-1])
        ):
            return "velocity"
        return first_field(motion.fields)


def looks(
    camera: str | None,
    size: str | None,
    limits: str | None,
    cmap: str,
    deform: float,
    vectors: str,
    diagram: str,
) -> dict[str, Any]:
    """Options of pictures from the texts of a command line."""
    found: dict[str, Any] = {"cmap": cmap, "deform": deform, "vectors": vectors, "diagram": diagram}
    if camera is not None and camera.isalpha():
        found["camera"] = camera
    elif camera is not None:
        v = numbers("--camera", camera, 9, "a name, or x,y,z of the eye, of the target, and of what is up")
        found["camera"] = (v[:3], v[3:6], v[6:])
    if size is not None:
        width, height = numbers("--size", size.replace("x", ","), 2, "WIDTHxHEIGHT")
        found["size"] = (int(width), int(height))
    if limits is not None:
        found["limits"] = tuple(numbers("--range", limits, 2, "LOW,HIGH"))
    return found


def numbers(option: str, text: str, n: int, wanted: str) -> list[float]:
    """So many numbers with commas between."""
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != n:
        raise InputError(f"{option} {text!r}: write {wanted}")
    return found


def execute(
    source: Source, directory: Path, *, pictures: bool = True, movies: bool = True, **options: Any
) -> int:
    """Run a study with these options of `visviva.study.run`, and tell of it; returns the exit code."""
    from visviva.study.run import run

    try:
        result = run(source.study, directory, pictures=False, tell=print, **options)
    except KeyboardInterrupt as interrupt:
        where = f"stopped at t = {source.study.system.time:.6g}; continue with --resume"
        if world().rank == 0:
            say(f"{where} (state and files are in {directory})")
        return exit_code(interrupt)
    except TimeLimit as stopped:
        if world().rank == 0:
            say(f"{stopped}; continue with --resume (state and files are in {directory})")
        return TIME_IS_UP
    result.audit()
    passed = report_check(source, result)
    if pictures and world().rank == 0:
        illustrate(source, directory, movies)
    print(f"files are in {directory}")
    return 0 if passed else FAILED


def illustrate(source: Source, directory: Path, movies: bool) -> None:
    """Draw plots, pictures and movie, and tell what could not be drawn."""
    from visviva.output.directory import RunDirectory
    from visviva.study import drawings

    sys.stdout.flush()
    try:
        for complaint in drawings.draw_run(source.study, RunDirectory(directory), movies=movies):
            say(complaint)
    except KeyboardInterrupt:
        say(f"drawing was stopped; the run is complete, visviva plot, picture and movie draw {directory}")


def report_check(source: Source, result: Result) -> bool:
    """Execute an example's check and say how it went."""
    if source.check is None:
        return True
    try:
        source.check(result)
    except AssertionError as error:
        if world().rank == 0:
            say(f"check of {source.name} failed: {error}")
        return False
    print(f"check of {source.name} passed")
    return True


def say(message: str) -> None:
    """A line to standard error."""
    print(f"visviva: {message}", file=sys.stderr)


def named_models(tokens: list[str]) -> Iterator[str]:
    """Descriptions of the examples and Python files that stand in a command line."""
    from visviva.scene.gallery import described, example, example_names
    from visviva.scene.user_file import load

    for token in tokens[1:]:
        if token.replace("-", "_") in example_names():
            yield described(example(token), token)
        elif token.endswith(".py"):
            yield described(load(token), token)
