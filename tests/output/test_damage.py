"""Damaged files are named, whatever happened to them, and readers and writers do not hinder each other."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import visviva as vv
from output.scenes import SCENE, moved
from visviva.cli import main
from visviva.examples import pendulum
from visviva.output import Trajectory, TrajectoryWriter, load_state, read_table
from visviva.study.run import run

FILES = ["state.h5", "ledger.csv", "probes.csv", "trajectory.vtkhdf", "states.npy", "arguments.json"]


def study(until: float) -> vv.Study:
    return pendulum.study(until=until, step=0.01)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A run to 0.1, and the same run to 0.2."""
    place = tmp_path_factory.mktemp("whole")
    for name, until in (("half", 0.1), ("whole", 0.2)):
        run(study(until), place / name, pictures=False)
    return place / "half", place / "whole"


def flipped(data: bytes, rng: np.random.Generator) -> bytes:
    at, bit = int(rng.integers(len(data))), 1 << int(rng.integers(8))
    return data[:at] + bytes([data[at] ^ bit]) + data[at + 1 :]


def cut(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: int(rng.integers(len(data)))]


def blanked(data: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(len(data)))
    return data[:at] + bytes(min(512, len(data) - at)) + data[at + 512 :]


def replaced(data: bytes, rng: np.random.Generator) -> bytes:
    return b"something else\n"


@pytest.mark.parametrize("damage", [flipped, cut, blanked, replaced])
@pytest.mark.parametrize("name", FILES)
def test_a_damaged_file_is_named(name: str, damage: Any, whole: tuple[Path, Path], tmp_path: Path) -> None:
    """Resuming refuses it by name, or the damage lay where nothing was and the run goes on to the same bits."""
    half, full = whole
    rng = np.random.default_rng(7)
    for k in range(1 if damage is replaced else 8):
        directory = tmp_path / str(k)
        shutil.copytree(half, directory)
        file = directory / name
        file.write_bytes(damage(file.read_bytes(), rng))
        refusal = ""
        try:
            run(study(0.2), directory, resume=True, pictures=False)
        except vv.InputError as error:
            refusal = str(error)
        if refusal:
            assert name in refusal or "was run with something else" in refusal
            continue
        assert name in ("trajectory.vtkhdf", "states.npy", "arguments.json", "state.h5")
        assert damage is not replaced
        for table in ("ledger.csv", "probes.csv"):
            assert (directory / table).read_bytes() == (full / table).read_bytes()
        with (
            Trajectory(directory / "trajectory.vtkhdf") as a,
            Trajectory(full / "trajectory.vtkhdf") as b,
        ):
            assert a.times.tolist() == b.times.tolist()
            for step in range(len(a.times)):
                np.testing.assert_array_equal(np.concatenate(a.points(step)), np.concatenate(b.points(step)))


@pytest.mark.parametrize("name", FILES)
def test_a_missing_file_is_named(name: str, whole: tuple[Path, Path], tmp_path: Path) -> None:
    shutil.copytree(whole[0], tmp_path / "run")
    (tmp_path / "run" / name).unlink()
    with pytest.raises(vv.InputError, match=name):
        run(study(0.2), tmp_path / "run", resume=True, pictures=False)


@pytest.mark.parametrize(("command", "name"), [("plot", "ledger.csv"), ("picture", "trajectory.vtkhdf")])
def test_commands_name_damaged_files(
    command: str, name: str, whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(3)
    for damage in (replaced, lambda data, rng: b"", lambda data, rng: bytes(len(data))):
        directory = tmp_path / "run"
        shutil.copytree(whole[0], directory, dirs_exist_ok=True)
        (directory / name).write_bytes(damage((directory / name).read_bytes(), rng))
        code = main([command, str(directory)])
        err = capsys.readouterr().err
        assert (code, len(err.splitlines())) == (2, 1)
        assert name in err


def test_a_changed_frame_is_told_when_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "t.vtkhdf"
    with TrajectoryWriter(path, SCENE) as writer:
        for k in range(5):
            writer.append(0.1 * k, moved(0.1 * k))
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Points"][3 * len(np.concatenate(moved(0.0)))] += 1e-12
    with Trajectory(path) as motion:
        np.testing.assert_array_equal(np.concatenate(motion.points(2)), np.concatenate(moved(0.1 * 2)))
        with pytest.raises(vv.InputError, match=r"t\.vtkhdf: is damaged: points at t = 0\.3"):
            motion.points(3)
    with pytest.raises(vv.InputError, match="is damaged"):
        TrajectoryWriter.reopen(path, keep_until=0.4)
    assert TrajectoryWriter.reopen(path, keep_until=0.2).n_steps == 3


VIEWER = """
import fcntl, sys, time, h5py
from visviva.output import Trajectory, load_state, read_table
seen, directory = 0, sys.argv[1]
file = directory + "/trajectory.vtkhdf"
print("looking", flush=True)
while True:
    if sys.argv[2] == "locked":  # as by a program that wants the file for itself
        held = open(file, "rb")
        fcntl.flock(held, fcntl.LOCK_EX)
        time.sleep(0.02)
    with Trajectory(file) as motion:
        assert len(motion.times) >= seen
        seen = len(motion.times)
        for step in (0, seen // 2, seen - 1):
            assert motion.points(step)[0].any()
    if sys.argv[2] == "open":
        with h5py.File(file, "r") as plain:
            assert plain["VTKHDF/Steps"].attrs["NSteps"] >= seen
    saved = load_state(directory + "/state.h5")["stepper"].values["time"]
    assert saved <= read_table(directory + "/ledger.csv")["time"][-1]
    print(seen, flush=True)
"""


@pytest.mark.parametrize("how", ["open", "locked"])
def test_a_viewer_and_the_writer_do_not_hinder_each_other(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process reads all files over and over while they are written, in files that grow by moving."""
    run(pendulum.study(until=0.02, step=0.01), tmp_path, pictures=False)
    with subprocess.Popen(
        [sys.executable, "-c", VIEWER, str(tmp_path), how],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as viewer:  # fmt: skip
        assert viewer.stdout is not None
        assert viewer.stdout.readline() == "looking\n"
        end = time.monotonic() + 2.0
        until = 0.02
        monkeypatch.setattr("visviva.output.vtkhdf.ROOM_AT_FIRST", 0)
        while time.monotonic() < end:
            until += 0.5
            run(pendulum.study(until=until, step=0.01), tmp_path, resume=True, save_every=0.0, pictures=False)
        assert viewer.poll() is None
        viewer.kill()
        printed, errors = viewer.communicate()
    assert errors == ""
    assert int(printed.split()[-1]) > 3
    assert read_table(tmp_path / "ledger.csv")["time"][-1] == pytest.approx(until)
    assert load_state(tmp_path / "state.h5")["stepper"].values["time"] == pytest.approx(until)
