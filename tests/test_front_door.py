"""The command line as those see it who come first: a file of their own, help with parameters, pictures that fail."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from visviva.cli import main
from visviva.output import RunDirectory, stage

Run = Callable[..., tuple[int, str, str]]

MODEL = '''
"""A ball on a spring."""
import visviva as vv
from lengths import LENGTH

def study(mass: float = 1.0, stiffness: float = 100.0):
    ball = vv.PointMass(mass=mass, position=(LENGTH, 0, 0), name="ball")
    ground = vv.Ground()
    spring = vv.Spring(a=ground, b=ball, stiffness=stiffness)
    probes = {f"probe{k}": vv.Position(of=ball) for k in range(9)}
    return vv.Study(vv.System([ground, ball, spring]), until=0.2, step=0.02, probes=probes, units="SI", title="Ball")

def check(result):
    result.assert_conserved("energy")
'''


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs a command line in a directory with a model; gives exit code, output, errors."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.py").write_text(MODEL)
    (tmp_path / "lengths.py").write_text("LENGTH = 2.0")

    def call(*arguments: Any) -> tuple[int, str, str]:
        code = main([str(a) for a in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return call


def test_a_file_of_the_user_runs(cli: Run, tmp_path: Path) -> None:
    code, out, err = cli("run", "model.py", "--set", "mass=2", "--no-pictures")
    assert (code, err) == (0, "")
    assert "check of model.py passed" in out
    files = RunDirectory.open("runs/model.py")
    assert files.read_summary()["parameters"] == {"mass": 2.0}
    assert not files.picture.exists()
    assert str(tmp_path) not in sys.path
    assert cli("run", "model.py", "--resume", "--until", 0.4, "--no-pictures")[0] == 0
    assert "did you mean 'mass'" in cli("run", "model.py", "--set", "mas=2", "--overwrite")[2]
    assert "4 degrees" not in cli("check", "model.py")[1]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (None, "there is no such file"),
        ("x = 1", "has no function study"),
        ("def study(): return 3", "what study() returns is a vv.Study, not 3"),
        ("a = 1\nimport nothing_of_this_name", "own.py:2: ModuleNotFoundError"),
        ("def study(:", "own.py:1: SyntaxError"),
        ("def study(mass): return mass", "needs a value for 'mass': --set mass=VALUE"),
    ],
)
def test_files_that_are_no_models_are_refused(cli: Run, tmp_path: Path, text: str | None, told: str) -> None:
    if text is not None:
        (tmp_path / "own.py").write_text(text)
    code, _, err = cli("run", "own.py")
    assert code == 2
    assert told in err
    assert not (tmp_path / "runs").exists()


def test_parameters_are_listed(cli: Run) -> None:
    for command in (["examples", "crane"], ["run", "crane", "--help"]):
        code, out, _ = cli(*command)
        assert code == 0
        assert "omega" in out
        assert "float = 1.32" in out
    assert "--no-movie" in out
    assert "stiffness  float = 100.0" in cli("run", "model.py", "--help")[1]
    assert "did you mean 'crane'" in cli("examples", "crnae")[2]


def test_plots_show_all_probes_and_nothing_is_lost(
    cli: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from visviva.output import plot

    monkeypatch.setitem(plot.STYLE, "svg.fonttype", "none")
    assert cli("run", "model.py")[0] == 0
    folder = tmp_path / "runs" / "model.py"
    before = {name: (folder / name).read_bytes() for name in ("energy.png", "probes.png")}
    code, out, _ = cli("plot", "runs/model.py")
    assert (code, out.splitlines()) == (0, ["runs/model.py/energy.png", "runs/model.py/probes.png"])
    assert {
        name: (folder / name).read_bytes() for name in before
    } == before  # title and units are there again
    assert cli("plot", "runs/model.py", "--format", "svg", "--out", ".")[0] == 0
    drawing = (tmp_path / "probes.svg").read_text()
    assert all(f">probe{k}<" in drawing for k in range(9))
    assert ">energy [J]<" in (tmp_path / "energy.svg").read_text()


def test_files_are_what_their_names_say(cli: Run, tmp_path: Path) -> None:
    """Folders are made, and what would not open is refused: a png called pdf, an mp4 called avi."""
    run = "runs/model.py"
    assert cli("run", "model.py", "--no-pictures")[0] == 0
    for command, begins, file in [
        (["plot", run, "--format", "pdf", "--out", "a/b"], b"%PDF", "a/b/energy.pdf"),
        (["picture", run, "--size", "160x100", "--out", "c/d/p.PNG"], b"\x89PNG", "c/d/p.PNG"),
        (["movie", run, "--size", "160x100", "--fps", 20, "--out", "e/m.gif"], b"GIF8", "e/m.gif"),
        (["html", run, "--out", "f/p.html"], b"<!DOCTYPE html>", "f/p.html"),
        (["export", run, "--format", "blocks", "--out", "g/b.vtkhdf"], b"\x89HDF", "g/b.vtkhdf"),
    ]:
        code, out, err = cli(*command)
        assert (code, err) == (0, "")
        assert file in out
        assert (tmp_path / file).read_bytes().startswith(begins)
    for command, name, told in [
        (["picture", run], "p.pdf", "pictures are written as .png"),
        (["movie", run], "m.avi", "movies are written as .mp4, .gif"),
        (["html", run], "p.txt", "pages are written as .html, .htm"),
        (["export", run], "b.vtkhdf", "by component and moment are written as .pvd"),
        (["export", run, "--format", "blocks"], "b.pvd", "named blocks are written as .vtkhdf, .hdf"),
    ]:
        code, _, err = cli(*command, "--out", name)
        assert code == 2
        assert f"{name}: " in err
        assert told in err
        assert not (tmp_path / name).exists()


def test_pictures_that_fail_cost_no_audit(cli: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a pyvista that imports, matplotlib draws; where nothing draws, a line says so behind the audit."""
    monkeypatch.setattr(stage, "can_render", lambda: True)
    monkeypatch.setitem(sys.modules, "visviva.output.stage_pyvista", None)
    code, out, err = cli("run", "model.py")
    assert (code, err) == (0, "")
    assert RunDirectory.open("runs/model.py").picture.exists()
    monkeypatch.setitem(sys.modules, "visviva.output.stage_matplotlib", None)
    code, out, err = cli("run", "model.py", "--overwrite")
    assert code == 0
    assert "energy balance closes to" in out
    assert "picture.png could not be drawn" in err


def test_the_api_warns_of_pictures_that_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import visviva as vv
    from visviva.study.run import run

    monkeypatch.setattr(stage, "can_render", lambda: False)
    monkeypatch.setitem(sys.modules, "visviva.output.stage_matplotlib", None)
    ball = vv.PointMass(mass=1.0)
    with pytest.warns(UserWarning, match="picture.png could not be drawn"):
        result = run(vv.Study(vv.System([ball]), 0.1, 0.1), tmp_path / "r")
    assert result.statistics.steps == 1


def test_pages_of_the_gallery_keep_double_backticks() -> None:
    import importlib.util

    path = Path(__file__).parents[1] / "docs" / "make_gallery.py"
    sys.path.insert(0, str(path.parent))
    try:
        spec = importlib.util.spec_from_file_location("make_gallery", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(path.parent))
    assert module.literal("`a` and ``--set b`` and `c`") == "``a`` and ``--set b`` and ``c``"


def test_completion_of_the_shell(cli: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from visviva.cli import app

    if not hasattr(app, "register_install_completion_command"):
        pytest.skip("Cyclopts 3")
    monkeypatch.setenv("HOME", str(tmp_path))
    code, _, err = cli("--install-completion", "--shell", "bash", "--output", tmp_path / "v.bash")
    assert (code, err) == (0, "")
    assert "no-movie" in (tmp_path / "v.bash").read_text()
