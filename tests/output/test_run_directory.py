"""The directory of a run, its restart state and summary."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from visviva.base.errors import InputError
from visviva.output import Record, RunDirectory, load_state, save_state
from visviva.output.manifest import NAME, claim


def test_state_is_bit_faithful(tmp_path):
    rng = np.random.default_rng(3)
    arrays = {
        "q": rng.integers(0, 2**63, 1000).view(np.float64),  # any bit pattern, also NaNs with payload
        "history/lambda": rng.normal(size=(3, 4, 5)),
        "count": np.array(7, dtype=np.int32),
        "flags": np.array([True, False]),
        "empty": np.zeros((0, 3)),
    }
    attributes = {"time": 0.1 + 0.2, "step": 2**53 + 1, "scheme": "EnergyMomentum(h=0.01) ä", "done": True}
    save_state(tmp_path / "s.h5", [Record("one", 1), Record("two", 3, arrays, attributes)])
    records = load_state(tmp_path / "s.h5")
    assert {name: record.version for name, record in records.items()} == {"one": 1, "two": 3}
    found, found_attributes = records["two"].arrays, records["two"].values
    assert found.keys() == arrays.keys()
    for name, array in arrays.items():
        assert found[name].dtype == array.dtype
        assert found[name].shape == array.shape
        assert found[name].tobytes() == array.tobytes()
    assert found_attributes == attributes


def test_state_of_others_is_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(InputError, match="was not written by visviva"):
        load_state(tmp_path / "other.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["format"] = "visviva state 99"
    with pytest.raises(InputError, match=r"visviva state 99.*visviva state 7"):
        load_state(tmp_path / "other.h5")
    (tmp_path / "text.h5").write_text("hello")
    for name in ("text.h5", "missing.h5"):
        with pytest.raises(InputError, match="not a readable state"):
            load_state(tmp_path / name)


def test_run_directory(tmp_path):
    run = RunDirectory.create(tmp_path / "deep" / "crane")
    assert run.trajectory == tmp_path / "deep" / "crane" / "trajectory.vtkhdf"
    assert [file.name for file in run.files] == [
        "trajectory.vtkhdf",
        "ledger.csv",
        "probes.csv",
        "summary.json",
        "state.h5",
        "states.npy",
        "arguments.json",
        "labels.json",
        "energy.png",
        "probes.png",
        "picture.png",
        "movie.mp4",
        "motion.html",
    ]
    RunDirectory.create(run.path)  # still empty
    with pytest.raises(InputError, match="holds no run"):
        RunDirectory.open(run.path)
    (run.path / "notes.txt").write_text("mine")
    save_state(run.state, [])
    assert RunDirectory.open(run.path) == run
    with pytest.raises(InputError, match=r"already holds a run \(state.h5\)"):
        RunDirectory.create(run.path)
    claim(run, run.picture_at(0.5), run.path / "energy.pdf", run.path / "trajectory")
    claim(run, run.picture_at(0.5))  # again
    (run.path / "trajectory").mkdir()
    for later in ("picture-0.5.png", "energy.pdf", "trajectory/000-00001.vtu"):  # made of the run before
        (run.path / later).write_text("old")
    for mine in USERS:
        (run.path / mine).write_text("mine")
    with pytest.raises(
        InputError, match=r"movie.gif is there already, and was not made of this run: .*--out"
    ):
        claim(run, run.path / "movie.gif")
    RunDirectory.create(run.path, overwrite=True)
    left = {str(file.relative_to(run.path)) for file in run.path.rglob("*") if file.is_file()}
    assert left == {"notes.txt", NAME, *USERS}
    assert all((run.path / mine).read_text() == "mine" for mine in USERS)


USERS = ("picture-lab.png", "probes.svg", "movie.gif", "blocks.vtkhdf", "trajectory/other.vtu")


@pytest.mark.parametrize("overwrite", [False, True])
def test_folders_without_a_run_keep_everything(tmp_path, overwrite):
    """Files of users that are called like those of runs are never removed, and what would be replaced is refused."""
    (tmp_path / "trajectory").mkdir()
    for mine in USERS:
        (tmp_path / mine).write_text("mine")
    (tmp_path / "movie.mp4").write_text("mine")
    with pytest.raises(InputError, match=r"movie\.mp4 is there already, and is of no run: .*choose another"):
        RunDirectory.create(tmp_path, overwrite)
    (tmp_path / "movie.mp4").rename(tmp_path / "film.mp4")
    RunDirectory.create(tmp_path, overwrite)
    assert all((tmp_path / mine).read_text() == "mine" for mine in (*USERS, "film.mp4"))


def test_a_manifest_reaches_nothing_outside(tmp_path):
    """Neither by going up, nor by a full path, nor through a link."""
    run, folder = RunDirectory.create(tmp_path / "run"), tmp_path / "mine"
    folder.mkdir()
    (run.path / "link").symlink_to(folder)
    names = ["../mine/a", str(folder / "b"), "link/c"]
    for name in "abc":
        (folder / name).write_text("mine")
    run.write_json(run.path / NAME, {"format": "visviva files 1", "files": names})
    RunDirectory.create(run.path, overwrite=True)
    assert sorted(file.name for file in folder.iterdir()) == ["a", "b", "c"]


def test_a_motion_alone_can_be_looked_at(tmp_path):
    """Such as one that was copied from another machine."""
    (tmp_path / "trajectory.vtkhdf").write_text("")
    assert RunDirectory.open(tmp_path).path == tmp_path


def test_runs_of_earlier_versions_are_overwritten(tmp_path):
    """They have no manifest; their ledger and state tell them."""
    for name in ("ledger.csv", "state.h5", "summary.json", "picture-lab.png"):
        (tmp_path / name).write_text("old")
    with pytest.raises(InputError, match=r"already holds a run \(ledger.csv\)"):
        RunDirectory.create(tmp_path)
    RunDirectory.create(tmp_path, overwrite=True)
    assert {file.name for file in tmp_path.iterdir()} == {NAME, "picture-lab.png"}


def test_run_directory_must_be_writable(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/visviva")):
        with pytest.raises(InputError, match="cannot be written"):
            RunDirectory.create(path)
    if os.geteuid():
        (tmp_path / "locked").mkdir(mode=0o555)
        with pytest.raises(InputError, match="cannot be written"):
            RunDirectory.create(tmp_path / "locked")


def test_summary_takes_numpy_and_is_strict_json(tmp_path):
    run = RunDirectory.create(tmp_path)
    run.write_summary(
        {
            "steps": np.int64(200),
            "error": np.float64(1 / 3),
            "momentum": np.array([1.0, np.nan]),
            "ok": np.bool_(True),
            "path": tmp_path,
            "nested": {1: (np.float32(0.5), None)},
        }
    )
    text = run.summary.read_text()
    assert json.loads(text, parse_constant=pytest.fail) == {
        "steps": 200,
        "error": 1 / 3,
        "momentum": [1.0, None],
        "ok": True,
        "path": str(tmp_path),
        "nested": {"1": [0.5, None]},
    }
    assert run.read_summary()["steps"] == 200


def test_importing_output_is_cheap():
    """Files, pictures and plots load their libraries when they are used."""
    code = "import sys, visviva.output; print(*{name.split('.')[0] for name in sys.modules})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"h5py", "matplotlib", "pyvista", "vtkmodules", "scipy", "yaml"} & set(run.stdout.split())
