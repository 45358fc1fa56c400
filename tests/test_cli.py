"""The command line: what it prints, what it leaves, and how it refuses."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import visviva as vv
from visviva.base.threads import told
from visviva.cli import OPTIONAL, main
from visviva.output import RunDirectory, Trajectory, load_state, read_table
from visviva.scene.gallery import example, example_names

SCENE = Path(__file__).parent.parent / "examples" / "four_bar.yaml"
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Drawing takes seconds; one test does it."""
    if "pictures" not in request.fixturenames:
        monkeypatch.setattr("visviva.study.drawings.draw_run", lambda *_, **__: [])


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs a command line in an empty directory; gives exit code, output, errors."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: Any) -> tuple[int, str, str]:
        code = main([str(a) for a in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return call


@pytest.fixture
def pictures() -> None:
    """Asks for pictures to be drawn."""


def test_solids_are_drawn_in_colours(cli: Run, tmp_path: Path) -> None:
    code, out, err = cli(
        "run", "cantilever", "--set", "motion=static", "--set", "counts=[4, 1, 1]", "--out", "c"
    )
    assert "Cantilever in equilibrium" in out, err
    for name, options in (("a", []), ("b", ["--field", "von_mises"]), ("c", ["--field", "", "--outline"])):
        assert cli("picture", "c", "--out", f"{name}.png", *options)[0] == 0
    code, _, err = cli("movie", "c", "--out", "m.gif", "--fps", 4)
    assert (code, err) == (0, "")
    first, second, third = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert first == second  # what is stored of solids is shown unless something else is asked for
    assert first != third
    assert "too many components" in cli("picture", "c", "--field", "cauchy")[2]


def test_run_crane_leaves_everything(cli: Run, tmp_path: Path, pictures: None) -> None:
    code, out, err = cli("run", "crane", "--until", 0.5)
    assert (code, err) == (0, "")
    assert "unknown coordinates n = 42, constraints m = 37, 5 degrees of freedom" in out
    assert "energy balance closes to" in out
    assert "check of crane passed" in out
    files = RunDirectory.open("runs/crane")
    for file in set(files.files) - {files.movie, files.page}:
        assert file.stat().st_size > 500, file
    summary = files.read_summary()
    assert summary["coordinates"] == 42
    assert summary["degrees_of_freedom"] == 5
    assert summary["steps"] == 50
    assert f"; {told()}\n" in out
    assert summary["threads"] == vv.use_threads()
    assert summary["conservation"]["energy"] < 1e-9
    assert summary["given"] == {"until": 0.5}
    assert summary["versions"]["visviva"] == vv.__version__
    probes, ledger = read_table(files.probes), read_table(files.ledger)
    assert len(probes["time"]) == len(ledger["time"]) == 51
    assert {"crane_angle", "load_x", "load_z", "rope_force_z"} <= set(probes)
    with Trajectory(files.trajectory) as trajectory:
        assert [s.name for s in trajectory.surfaces] == ["girder", "trolley", "winch", "load", "rope"]
        np.testing.assert_allclose(trajectory.times, np.linspace(0, 0.5, 51), atol=1e-12)
        load = trajectory.surfaces[3]
        ball = trajectory.points(50)[3].mean(axis=0)
        np.testing.assert_allclose(ball, [probes[f"load_{c}"][-1] for c in "xyz"], atol=1e-12)
        np.testing.assert_allclose(
            np.ptp(trajectory.points(50)[3], axis=0), np.ptp(load.points, axis=0), atol=1e-12
        )
        np.testing.assert_allclose(trajectory.points(50)[4][1], ball, atol=1e-12)
        girder = trajectory.points(50)[0]
        np.testing.assert_allclose(girder.mean(axis=0), 0, atol=1e-12)
        assert np.linalg.norm(girder[1] - girder[0]) == pytest.approx(np.linalg.norm(
            trajectory.surfaces[0].points[1] - trajectory.surfaces[0].points[0]))  # fmt: skip
    for command in (["plot", "runs/crane"], ["movie", "runs/crane", "--out", "m.gif", "--fps", 4]):
        assert cli(*command)[0] == 0
    assert (tmp_path / "m.gif").stat().st_size > 1000
    assert (files.path / "probes.png").exists()


def test_settings_reach_the_parameters(cli: Run) -> None:
    code, _, _ = cli(
        "run", "crane", "--set", "omega=0.5", "--set", "winch=locked", "--until", 0.1, "--step", 2e-2
    )
    assert code == 0
    summary = RunDirectory.open("runs/crane").read_summary()
    assert summary["parameters"] == {"omega": 0.5, "winch": "locked"}
    assert (summary["step"], summary["constraints"]) == (0.02, 38)


def test_schemes_by_name(cli: Run) -> None:
    code, out, _ = cli("run", "pendulum", "--until", 0.1, "--scheme", "GeneralizedAlpha(rho=0.5)")
    assert "GeneralizedAlpha(rho=0.5)" in out
    assert code in (0, 1)  # the check of energy may refuse a scheme that dissipates


def test_scene_files_run_with_changes(cli: Run) -> None:
    code, out, _ = cli("run", SCENE, "--until", 0.1, "--set", "crank.mass=2.5", "--out", "here")
    assert code == 0
    assert "Four-bar with motor" in out
    assert RunDirectory.open("here").read_summary()["parameters"] == {"crank.mass": 2.5}
    assert cli("run", SCENE, "--out", "here", "--resume", "--until", 0.2)[0] == 0
    assert read_table("here/ledger.csv")["time"][-1] == pytest.approx(0.2)


def test_resume_ends_where_the_scene_says(cli: Run) -> None:
    """Whatever end the run was given before."""
    scene = Path("short.yaml")
    scene.write_text(Path(SCENE).read_text(encoding="utf-8"), encoding="utf-8")
    assert cli("run", scene, "--until", 0.05, "--set", "run.until=0.1", "--out", "here")[0] == 0
    assert read_table("here/ledger.csv")["time"][-1] == pytest.approx(0.05)
    assert cli("run", scene, "--out", "here", "--resume")[0] == 0
    assert read_table("here/ledger.csv")["time"][-1] == pytest.approx(0.1)


def test_resume_takes_what_the_run_was_given(cli: Run) -> None:
    base = ["run", "crane", "--set", "omega=0.7", "--step", 0.02, "--scheme", "Midpoint"]
    whole_code, _, _ = cli(*base, "--until", 0.4, "--out", "whole")
    cli(*base, "--until", 0.2, "--out", "split")
    code, out, _ = cli("run", "crane", "--resume", "--until", 0.4, "--out", "split")
    assert code == whole_code  # 1: this scheme does not pass the crane's check
    assert "Midpoint()" in out
    assert Path("whole/ledger.csv").read_bytes() == Path("split/ledger.csv").read_bytes()
    assert Path("whole/probes.csv").read_bytes() == Path("split/probes.csv").read_bytes()
    whole, split = RunDirectory.open("whole").read_summary(), RunDirectory.open("split").read_summary()
    different = ("seconds", "given", "output")  # what a resumed run foretells is the rest
    assert {k: v for k, v in whole.items() if k not in different} == {
        k: v for k, v in split.items() if k not in different
    }
    code, _, err = cli("run", "crane", "--resume", "--set", "omega=0.8", "--out", "split")
    assert code == 2
    assert "omega" in err


def test_listing_commands(cli: Run) -> None:
    code, out, _ = cli("examples")
    assert code == 0
    assert all(name in out for name in example_names())
    code, out, _ = cli("check", "crane")
    assert code == 0
    assert "tangents" in out
    code, out, _ = cli("info")
    assert vv.__version__ in out
    extras = tomllib.loads((Path(__file__).resolve().parents[1] / "pyproject.toml").read_text())["project"][
        "optional-dependencies"
    ]
    assert {extra for extra, _ in OPTIONAL.values()} == extras.keys() - {"test", "lint", "docs"}
    assert all(f"{package}: " in out for package in OPTIONAL)
    code, out, _ = cli("schema")
    assert "RigidBody" in json.loads(out)["$defs"]
    code, out, _ = cli("run", "--help")
    assert code == 0
    assert "--resume" in out


BAD: list[tuple[list[Any], str]] = [
    (["run", "crne"], "no example or file 'crne'; did you mean 'crane'"),
    (["run", "crane", "--set", "omga=1"], "no parameter 'omga'; did you mean 'omega'"),
    (["run", "crane", "--set", "omega"], "write it as key=value"),
    (["run", "crane", "--set", "omega=fast"], "omega = 'fast'"),
    (["run", "crane", "--set", "winch=loose"], "choose 'free' or 'locked'"),
    (["run", "crane", "--set", "length=-1"], "length -1 is not positive"),
    (["run", "crane", "--step", "0"], "step = 0.0 is not a positive number"),
    (["run", "crane", "--step", "nan"], "step = nan is not a positive number"),
    (["run", "crane", "--until", "-1"], "until = -1.0 is not after"),
    (["run", "crane", "--until", "inf"], "until = inf"),
    (["run", "crane", "--step", "small"], "small"),
    (["run", "crane", "--scheme", "Midpont"], "did you mean 'Midpoint'"),
    (["run", "crane", "--scheme", "GeneralizedAlpha(roh=1)"], "did you mean 'rho'"),
    *(
        (["run", "crane", "--scheme", scheme], "write it as NAME or NAME(key=value)")
        for scheme in (
            "Midpoint(1)",
            "Midpoint()()",
            "Midpoint(",
            "Midpoint;",
            "GeneralizedAlpha(0.8)",
            "[Midpoint]",
            "",
            "GeneralizedAlpha(rho)",
            "Midpoint\0",
            "Midpoint() or BDF2",
            "vv.Midpoint",
            "(" * 5000,
        )
    ),
    (["run", "crane", "--scheme", "GeneralizedAlpha(rho=0.1, rho=0.2)"], "given twice"),
    (["run", "crane", "--scheme", "Midpoint(**{})"], "unknown key"),
    (
        ["run", "crane", "--scheme", "GeneralizedAlpha(rho='high')"],
        "rho: .*valid number".replace(".*", "input should be a "),
    ),
    (["run", "crane", "--step", "1e-300"], "step = 1e-300 is too small"),
    (["run", "crane", "--untill", "1"], "--untill"),
    (["run", "crane", "--resume"], "holds no run"),
    (["run", "none.yaml"], "no such file"),
    (["run"], "MODEL"),
    (["rnu", "crane"], "rnu"),
    (["plot", "nowhere"], "holds no run"),
    (["movie", "nowhere"], "holds no run"),
    (["check", "crne"], "did you mean 'crane'"),
]


def test_reader_may_stop_listening() -> None:
    command = [sys.executable, "-m", "visviva", "examples"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 1


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=lambda a: " ".join(map(str, a)) if a else None)
def test_bad_input_exits_with_2_and_a_line(arguments: list[Any], message: str, cli: Run) -> None:
    code, _, err = cli(*arguments)
    assert code == 2
    assert message in err
    assert len(err.strip().splitlines()) <= 2
    assert "Traceback" not in err
    assert not Path("runs").exists()


def test_directory_that_holds_a_run_is_refused(cli: Run) -> None:
    assert cli("run", "crane", "--until", 0.02)[0] == 0
    before = Path("runs/crane/ledger.csv").read_bytes()
    code, _, err = cli("run", "crane")
    assert code == 2
    assert "already holds a run" in err
    assert "--resume" in err
    assert Path("runs/crane/ledger.csv").read_bytes() == before


def test_files_of_users_in_the_directory_of_a_run_stay(cli: Run) -> None:
    """Those called like files of runs too: refused where they would be replaced, else left alone."""
    for name in ("picture-lab.png", "energy.pdf", "movie.gif", "trajectory.pvd"):
        Path(name).write_text("mine")
    Path("probes.csv").write_text("mine")
    for more in ([], ["--overwrite"]):
        code, _, err = cli("run", "pendulum", "--until", 0.02, "--out", ".", *more)
        assert (code, "probes.csv is there already, and is of no run" in err) == (2, True), err
    Path("probes.csv").rename("measured.csv")
    assert cli("run", "pendulum", "--until", 0.02, "--out", ".")[0] in (0, 1)
    for command in (["plot", ".", "--format", "pdf"], ["export", "."]):
        code, _, err = cli(*command)
        assert (code, "was not made of this run" in err) == (2, True), err
    assert cli("run", "pendulum", "--until", 0.02, "--out", ".", "--overwrite")[0] in (0, 1)
    for name in ("picture-lab.png", "energy.pdf", "movie.gif", "trajectory.pvd", "measured.csv"):
        assert Path(name).read_text() == "mine"


def test_files_that_are_replaced_are_told(cli: Run) -> None:
    assert cli("run", "pendulum", "--until", 0.02)[0] in (0, 1)
    Path("a.html").write_text("mine")
    for file, more in (("a.html", " (in place of the file that was there)"), ("b.html", "")):
        assert cli("html", "runs/pendulum", "--out", file)[:2] == (0, f"{file}{more}\n")
    for _ in range(2):  # of the run itself
        assert cli("html", "runs/pendulum")[:2] == (0, "runs/pendulum/motion.html\n")


def test_an_earlier_run_is_overwritten_on_request(cli: Run) -> None:
    assert cli("run", "pendulum", "--until", 0.05)[0] in (0, 1)
    Path("runs/pendulum/notes.txt").write_text("mine")
    code, _, err = cli("run", "pendulum", "--overwrite", "--scheme", "Midpont")
    assert (code, Path("runs/pendulum/state.h5").exists()) == (2, True)  # what cannot be run deletes nothing
    code, _, err = cli("run", "pendulum", "--overwrite", "--until", "-1")
    assert (code, Path("runs/pendulum/state.h5").exists()) == (2, True)
    assert cli("run", "pendulum", "--until", 0.1, "--overwrite")[0] in (0, 1)
    assert read_table("runs/pendulum/ledger.csv")["time"][-1] == pytest.approx(0.1)
    assert Path("runs/pendulum/notes.txt").read_text() == "mine"
    code, _, err = cli("run", "pendulum", "--overwrite", "--resume")
    assert (code, "exclude each other" in err) == (2, True)


def test_scenes_and_examples_of_one_name_have_their_own_directories(cli: Run) -> None:
    assert cli("run", "four_bar", "--until", 0.05)[0] in (0, 1)
    assert cli("run", SCENE, "--until", 0.05)[0] == 0
    assert RunDirectory.open("runs/four_bar.yaml").read_summary()["study"] == "four_bar.yaml"


def test_directory_that_cannot_be_written(cli: Run) -> None:
    Path("file").write_text("")
    code, _, err = cli("run", "crane", "--out", "file/crane")
    assert code == 2
    assert "choose another directory" in err


def test_full_disk_is_a_failed_run_that_resumes(cli: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cli("run", "crane", "--until", 0.3, "--out", "whole")[0] == 0
    written, real = [0], os.pwrite

    def full(descriptor: int, data: Any, offset: int) -> int:
        written[0] += 1
        if written[0] > 60:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(descriptor, data, offset)

    monkeypatch.setattr(os, "pwrite", full)
    code, _, err = cli("run", "crane", "--until", 0.3, "--out", "split")
    assert code == 1
    assert "No space left on device" in err
    monkeypatch.setattr(os, "pwrite", real)
    assert len(read_table("split/ledger.csv")["time"]) < 31
    assert cli("run", "crane", "--resume", "--until", 0.3, "--out", "split")[0] == 0
    assert Path("whole/ledger.csv").read_bytes() == Path("split/ledger.csv").read_bytes()


def test_failed_step_keeps_state_and_files(cli: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """No step of the crane converges with a single iteration."""
    scene = Path("crane.yaml")
    source = SCENE.with_name("crane.yaml").read_text()
    scene.write_text(source + "newton: {max_iterations: 1}\n")
    code, _, err = cli("run", scene)
    assert code == 1
    assert "failed" in err
    assert "smaller step" in err
    assert load_state("runs/crane.yaml/state.h5")["stepper"].values["time"] == 0.0
    assert len(read_table("runs/crane.yaml/ledger.csv")["time"]) == 1


@pytest.mark.parametrize(
    ("wish", "probe"),
    [
        ("pictures: { field: von_mises }", ""),
        ("", "bad: { Formula: { formula: 1/0*p_x, of: { p: { Position: { of: ball } } } } }"),
    ],
)
def test_what_run_refuses_check_refuses(cli: Run, tmp_path: Path, wish: str, probe: str) -> None:
    """In the same words: check passed what run then refused."""
    file = tmp_path / "scene.yaml"
    text = "system: { ball: { PointMass: { mass: 1, velocity: [1, 0, 0] } } }\nrun: { until: 1, step: 0.1 }\n"
    file.write_text(f"{text}{wish}\n" + (f"probes: {{ {probe} }}\n" if probe else ""))
    told = [cli("check", file), cli("run", file, "--out", tmp_path / "run")]
    assert [code for code, _, _ in told] == [2, 2]
    assert told[0][2] == told[1][2] != ""


def test_failed_check_exits_with_1(cli: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def check(result: vv.Result) -> None:
        result.assert_conserved("momentum_z")

    monkeypatch.setattr(example("crane"), "check", check)
    code, _, err = cli("run", "crane", "--until", 0.1)
    assert code == 1
    assert "momentum_z is not conserved" in err


def test_ctrl_c_exits_with_130_and_resumes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = [
        sys.executable,
        "-m",
        "visviva",
        "run",
        "crane",
        "--step",
        "0.0005",
        "--out",
        str(tmp_path / "c"),
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    ledger = tmp_path / "c" / "ledger.csv"
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (ledger.exists() and ledger.read_bytes().count(b"\n") > 20):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "--resume" in err
    assert "Traceback" not in err
    stopped = float(load_state(tmp_path / "c" / "state.h5")["stepper"].values["time"])
    assert 0 < stopped < 2
    assert read_table(ledger)["time"][-1] == stopped
    code = main([*command[3:5], "--resume", "--until", str(round(stopped, 4) + 0.05), *command[7:]])
    assert code == 0, capsys.readouterr().err
    assert read_table(ledger)["time"][-1] > stopped


def test_importing_stays_cheap() -> None:
    """Neither the package nor its start may load what only commands need."""
    code = "import sys, visviva; print([m for m in sys.modules if m.split('.')[0] in %r])"
    heavy = ("scipy", "cyclopts", "rich", "yaml", "h5py", "matplotlib", "pyvista")
    out = subprocess.run(
        [sys.executable, "-c", code % (heavy,)], capture_output=True, text=True, check=True
    ).stdout
    assert out.strip() == "[]"


def test_no_traceback_reaches_the_user_but_for_debugging(cli: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise KeyError("a line\nand " + "x" * 5000)

    monkeypatch.setattr("visviva.study.run.run", broken)
    code, out, err = cli("run", "pendulum")
    assert code == 1
    assert "Traceback" not in err + out
    assert "an error that is not expected, KeyError: " in err
    assert "--debug" in err
    assert len(err.splitlines()) == 1
    assert len(err) < 600
    for arguments in (["--debug", "run", "pendulum"], ["run", "pendulum", "--debug"]):
        with pytest.raises(KeyError):
            main(arguments)
    with pytest.raises(vv.InputError):
        main(["check", "nothing", "--debug"])


@pytest.mark.parametrize("size", ["0x0", "-3x5", "100000x10"])
def test_sizes_that_nothing_draws_are_refused(
    size: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "pendulum", "--until", "0.1", "--out", str(tmp_path / "r"), "--no-pictures"]) == 0
    assert main(["picture", str(tmp_path / "r"), f"--size={size}"]) == 2
    assert "pixels wide and high" in capsys.readouterr().err


def test_an_empty_directory_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "pendulum", "--out", ""]) == 2
    assert "the path is empty" in " ".join(capsys.readouterr().err.split())


def test_threads_are_chosen(cli: Run) -> None:
    before = vv.use_threads()
    try:
        code, out, err = cli(
            "run", "pendulum", "--until", 0.02, "--threads", 1, "--out", "p", "--no-pictures"
        )
        assert (code, err) == (0, "")
        assert "; 1 thread\n" in out
        assert RunDirectory.open("p").read_summary()["threads"] == 1
    finally:
        vv.use_threads(before)
    assert (
        "use_threads: n = 0 is not a whole number" in cli("run", "pendulum", "--threads", 0, "--out", "q")[2]
    )
