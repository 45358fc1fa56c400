"""A full disk ends a run with a message and leaves what was written before."""

import errno
import os
import subprocess

import numpy as np
import pytest

from output.scenes import SCENE, moved
from visviva.base.errors import RunError
from visviva.output import (
    Record,
    Surface,
    Table,
    Trajectory,
    TrajectoryWriter,
    load_state,
    read_table,
    save_state,
)
from visviva.output import safe_files as files


def full_disk(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def disk_with_room_for(n_bytes, monkeypatch):
    """From now on `n_bytes` can be written, the last write only in part, as a real disk does it."""
    room, real = n_bytes, os.pwrite

    def limited(descriptor, data, offset):
        nonlocal room
        fitting = memoryview(data)[:room]
        if not len(fitting):
            full_disk()
        room -= len(fitting)
        return real(descriptor, fitting, offset)

    monkeypatch.setattr(os, "pwrite", limited)


def test_trajectory_on_a_full_disk_keeps_its_steps(tmp_path, monkeypatch):
    path = tmp_path / "t.vtkhdf"
    writer = TrajectoryWriter(path, SCENE)
    for k in range(3):
        writer.append(k / 2, moved(k / 2))
    disk_with_room_for(1000, monkeypatch)
    with pytest.raises(
        RunError, match=r"t\.vtkhdf: No space left on device; what it holds up to t = 1\.5 stays"
    ):
        [writer.append(k / 2, moved(k / 2)) for k in range(3, 100)]
    writer.close()
    with Trajectory(path) as motion:
        assert motion.times.tolist() == [0.0, 0.5, 1.0, 1.5]


def test_table_on_a_full_disk_keeps_its_rows(tmp_path, monkeypatch):
    table = Table(tmp_path / "l.csv", ["time", "x"])
    table.append([0.25, 1 / 3])
    disk_with_room_for(30, monkeypatch)
    with pytest.raises(
        RunError, match=r"l\.csv: No space left on device; what it holds up to t = 0\.5 stays"
    ):
        [table.append([k / 4, 1 / 3]) for k in range(2, 9)]
    assert (tmp_path / "l.csv").read_text() == "time,x\n0.25,0.3333333333333333\n0.5,0.3333333333333333\n"


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 300 kB, where one may be mounted."""
    place = tmp_path / "small"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=300k", "none", str(place)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("no permission to mount a small file system")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def test_real_full_disk(small_disk):
    writer = TrajectoryWriter(small_disk / "t.vtkhdf", SCENE)
    table = Table(small_disk / "l.csv", ["time", "x"])
    save_state(small_disk / "s.h5", [Record("ball", 1, {"q": np.arange(1000.0)}, {"time": 0.0})])
    step = 0

    def run_on():
        nonlocal step
        while True:
            writer.append(float(step), moved(step))
            table.append([step, 1 / 3])
            step += 1

    with pytest.raises(RunError, match="No space left on device"):
        run_on()
    with pytest.raises(RunError, match="No space left on device"):
        save_state(small_disk / "s.h5", [Record("ball", 1, {"q": np.zeros(50_000)}, {"time": 1.0})])
    with pytest.raises(RunError, match="No space left on device"):
        TrajectoryWriter(small_disk / "new.vtkhdf", [Surface("big", np.zeros((20_000, 3)), [[0]])]).append(
            0.0, [np.zeros((20_000, 3))]
        )
    writer.close()
    with Trajectory(small_disk / "t.vtkhdf") as motion:
        assert len(motion.times) in (step, step + 1)
    assert len(read_table(small_disk / "l.csv")["time"]) == step
    assert load_state(small_disk / "s.h5")["ball"].values == {"time": 0.0}
    assert not list(small_disk.glob(".*"))


def test_failed_save_keeps_the_older_state(tmp_path, monkeypatch):
    path = tmp_path / "s.h5"
    save_state(path, [Record("ball", 1, {"q": np.ones(3)}, {"time": 1.0})])
    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(RunError, match="No space left"):
        save_state(path, [Record("ball", 1, {"q": np.zeros(3)}, {"time": 2.0})])
    assert load_state(path)["ball"].values == {"time": 1.0}
    assert [file.name for file in tmp_path.iterdir()] == ["s.h5"]


def test_replacing_is_all_or_nothing(tmp_path):
    target = tmp_path / "file"
    target.write_text("old")

    def fail_on_the_way():
        with files.replacing(target) as temporary:
            temporary.write_text("ha")
            assert target.read_text() == "old"
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_on_the_way()
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]
