"""A run is resumed with what it was run with: whatever was edited is refused by its name."""

from __future__ import annotations

import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.output import RunDirectory
from visviva.study.fingerprint import changes, fingerprint
from visviva.study.run import run

STRENGTH = 1.0


def steady(t: float) -> float:
    return STRENGTH * t


def study(mesh: Path, **edits: Any) -> vv.Study:
    """A block on springs and a ball, with everything that can be edited from outside."""
    given = {
        "young": 100.0, "density": 1.0, "gravity": 9.81, "mass": 2.0, "formulation": "displacement", "stiffness": 5.0,
        "tolerance": 1e-12, "linear": None, "step": 0.01, "scheme": vv.EnergyMomentum(), "adaptive": None,
        "push": lambda t: 2 * t, "pull": steady, "shape": (0.0, 1.0), "fields": ("energy",), "probe": 0.0,
        "table": [[0, 0], [1, 1]], "order": 1, "wind": types.FunctionType(steady.__code__, {"STRENGTH": 1.0}),
        "drag": 0.1,
    } | edits  # fmt: skip

    def dragged(t: float, x: Any, v: Any) -> Any:
        return -given_drag * v

    given_drag = given["drag"]
    block = vv.Solid(
        mesh=vv.MeshFile(mesh), material=vv.NeoHooke(young=given["young"], poisson=0.3), density=given["density"],
        formulation=given["formulation"], velocity=(0, 0, given["shape"][0]), name="block",
    )  # fmt: skip
    ball = vv.PointMass(mass=given["mass"], position=(3, 0, 0), name="ball")
    spring = vv.Spring(a=ball.point(), b=block.point((1, 1, 1)), stiffness=given["stiffness"], name="spring")
    times = {"push": given["push"], "pull": given["pull"], "table": given["table"], "wind": given["wind"]}
    loads = [vv.Force(on=ball, force=(1, 0, 0), times=f, name=name) for name, f in times.items()]
    drag = vv.GeneralizedForce(of=[ball], force=dragged, name="drag")
    gravity = vv.Gravity(acceleration=(0, 0, -given["gravity"]), name="gravity")
    parts = [block, ball, spring, *loads, drag, gravity, vv.Fixed(solid=block, nodes="z0", name="clamp")]
    newton = vv.Newton(tolerance=given["tolerance"], linear=given["linear"])
    system = vv.System(parts[:: given["order"]], newton=newton)
    offset = given["probe"]
    probes = {"height": lambda s: ball.point().position.value(s.x)[2] + offset}
    return vv.Study(
        system,
        0.02,
        given["step"],
        given["scheme"],
        probes,
        fields=given["fields"],
        adaptive=given["adaptive"],
    )


def box(path: Path, height: float = 1.0) -> Path:
    vv.BoxMesh(size=(1, 1, height), counts=(1, 1, 1)).build().write(path)
    return path


EDITS: dict[str, tuple[dict[str, Any], str]] = {
    "stiffness": ({"stiffness": 6.0}, "Spring 'spring': stiffness was 5, is 6"),
    "material": (
        {"young": 101.0},
        r"Solid 'block': material was NeoHooke\(young=100, .* is NeoHooke\(young=101, ",
    ),
    "density": ({"density": 1.1}, "Solid 'block': density was 1, is 1.1"),
    "formulation": (
        {"formulation": "enhanced"},
        "Solid 'block': formulation was 'displacement', is 'enhanced'",
    ),
    "mass": ({"mass": 3.0}, "PointMass 'ball': mass was 2, is 3"),
    "gravity": ({"gravity": 1.62}, "Gravity 'gravity': acceleration"),
    "velocity": ({"shape": (0.5, 1.0)}, "Solid 'block': velocity"),
    "lambda": ({"push": lambda t: 3 * t}, "Force 'push': times"),
    "default": ({"push": lambda t, k=2: k * t}, "Force 'push': times"),
    "closure": ({"drag": 0.2}, "GeneralizedForce 'drag': force"),
    "global": ({"wind": types.FunctionType(steady.__code__, {"STRENGTH": 2.0})}, "Force 'wind': times"),
    "table": ({"table": [[0, 0], [1, 2]]}, "Force 'table': times"),
    "tolerance": ({"tolerance": 1e-11}, "Newton: tolerance was 1e-12, is 1e-11"),
    "linear solver": ({"linear": vv.Direct("eigen")}, "Newton: linear was None, is Direct"),
    "step": ({"step": 0.005}, "study: step was 0.01, is 0.005"),
    "scheme": (
        {"scheme": vv.GeneralizedAlpha(rho=0.5)},
        r"study: scheme was .*, is GeneralizedAlpha\(rho=0.5\)",
    ),
    "adaptive": ({"adaptive": vv.Adaptive(tolerance=1e-4)}, "study: adaptive was None, is Adaptive"),
    "fields": ({"fields": ("energy", "pressure")}, "study: fields"),
    "probe": ({"probe": 1.0}, "study: probe height was function"),
    "order": ({"order": -1}, "system: order of components"),
}


@pytest.fixture(scope="module")
def earlier(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A directory with a run, and the mesh file."""
    place = tmp_path_factory.mktemp("earlier")
    mesh = box(place / "box.inp")
    run(study(mesh), place / "run", pictures=False)
    return place / "run", mesh


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_is_refused_by_name(edit: str, earlier: tuple[Path, Path]) -> None:
    directory, mesh = earlier
    changed, named = EDITS[edit]
    with pytest.raises(vv.InputError, match=named):
        run(study(mesh, **changed), directory, resume=True, pictures=False)


def test_an_edited_mesh_file_is_refused(earlier: tuple[Path, Path]) -> None:
    directory, mesh = earlier
    with pytest.raises(vv.InputError, match=r"Solid 'block': mesh was MeshFile\(path=file with digest"):
        run(study(box(mesh.with_name("other.inp"), 1.001)), directory, resume=True, pictures=False)


def test_the_same_again_is_accepted(earlier: tuple[Path, Path]) -> None:
    """Composed anew, from a copy of the mesh file with another name, with numbers given in another way."""
    directory, mesh = earlier
    again = study(box(mesh.with_name("copy.inp")), mass=2, table=((0.0, 0.0), (1.0, 1.0)))
    again.title, again.moments = "other words", (0.01,)
    assert run(again, directory, resume=True, pictures=False).statistics.steps == 2


def test_forced_changes_go_on_and_are_told(tmp_path: Path) -> None:
    mesh = box(tmp_path / "box.inp")
    run(study(mesh), tmp_path / "run", pictures=False)
    other = study(mesh, stiffness=6.0, scheme=vv.Midpoint())
    other.until = 0.05
    result = run(other, tmp_path / "run", resume=True, force=True, pictures=False)
    assert result.statistics.steps == 5
    (forced,) = RunDirectory.open(tmp_path / "run").read_summary()["forced"]
    assert forced["time"] == pytest.approx(0.02)
    assert forced["changes"] == [
        "study: scheme was EnergyMomentum(), is Midpoint()",
        "Spring 'spring': stiffness was 5, is 6",
    ]
    more = study(mesh, stiffness=6.0, scheme=vv.Midpoint())
    more.until = 0.06
    run(more, tmp_path / "run", resume=True, pictures=False)  # the changed study is now that of the run
    assert len(RunDirectory.open(tmp_path / "run").read_summary()["forced"]) == 1


def test_a_refused_resume_leaves_no_trace(tmp_path: Path) -> None:
    """What was forced is noted last: a damaged trajectory is found before."""
    mesh = box(tmp_path / "box.inp")
    run(study(mesh), tmp_path / "run", pictures=False)
    files = RunDirectory.open(tmp_path / "run")
    noted = files.arguments.read_bytes()
    files.probes.write_text("nothing\n")
    other = study(mesh, stiffness=6.0)
    other.until = 0.05
    with pytest.raises(vv.InputError, match="probes"):
        run(other, tmp_path / "run", resume=True, force=True, pictures=False)
    assert files.arguments.read_bytes() == noted


def test_force_takes_no_other_unknowns(tmp_path: Path) -> None:
    def chain(n: int) -> vv.Study:
        return vv.Study(vv.System([vv.PointMass(mass=1.0, velocity=(1, 0, 0)) for _ in range(n)]), 0.02, 0.01)

    run(chain(2), tmp_path / "run", pictures=False)
    with pytest.raises(vv.InputError, match="another system"):
        run(chain(3), tmp_path / "run", resume=True, force=True, pictures=False)
    with pytest.raises(vv.InputError, match="goes with resume=True"):
        run(chain(2), tmp_path / "new", force=True, pictures=False)


def test_runs_of_earlier_versions_are_refused_by_name(tmp_path: Path) -> None:
    mesh = box(tmp_path / "box.inp")
    run(study(mesh), tmp_path / "run", pictures=False)
    (tmp_path / "run" / "arguments.json").unlink()
    with pytest.raises(vv.InputError, match=r"does not note what it was run with .* visviva 0\.1"):
        run(study(mesh), tmp_path / "run", resume=True, pictures=False)


def test_what_cannot_be_compared_is_named(tmp_path: Path) -> None:
    with open(tmp_path / "log", "w") as log:

        def logged(t: float, x: Any, v: Any) -> Any:
            log.write("")
            return 0 * x

        ball = vv.PointMass(mass=1.0, velocity=(1, 0, 0), name="ball")
        force = vv.GeneralizedForce(of=[ball], force=logged, name="wind")
        run(vv.Study(vv.System([ball, force]), 0.02, 0.01), tmp_path / "run", pictures=False)
    (named,) = RunDirectory.open(tmp_path / "run").read_summary()["untold_arguments"]
    assert named == "GeneralizedForce 'wind': force (a TextIOWrapper cannot be compared)"


CODE = "def f(t):\n    return {0}\n\ndef g(t):\n    return f(t) + 1\n"


@pytest.mark.parametrize("inner", ["2 * t", "max([2.0, t])", "(lambda s: 2 * s)(t)"])
def test_functions_called_by_functions(inner: str) -> None:
    """Code is compared without comments and names of files, but with all that it calls."""

    def told(text: str) -> dict[str, dict[str, str]]:
        names: dict[str, Callable[[float], float]] = {}
        exec(text, names)
        ball = vv.PointMass(mass=1.0, name="ball")
        load = vv.Force(on=ball, force=(1, 0, 0), times=names["g"], name="push")
        return fingerprint(vv.Study(vv.System([ball, load]), 1.0, 0.1))[0]

    text = CODE.format(inner)
    assert changes(told(text), told("# a comment\n" + text)) == []
    (change,) = changes(told(text), told(text.replace("2", "3")))
    assert change.startswith("Force 'push': times was")


def test_large_meshes_take_no_time() -> None:
    """Bytes are hashed at some hundred megabytes per second at least: no loop over nodes."""
    import time

    mesh = vv.Mesh(np.random.default_rng(0).normal(size=(1_000_000, 3)), {"tet4": [(0, 1, 2, 3)]})
    ball = vv.PointMass(mass=1.0)
    study = vv.Study(vv.System([ball]), 1.0, 0.1, probes={"mesh": lambda s: mesh.n_nodes})
    start = time.process_time()
    fingerprint(study)
    assert time.process_time() - start < 0.5  # 24 MB
